//! Several programs at one rig, and one that is killed: nothing runs that nobody asked for, and nothing is torn.
//!
//! Ten pairs of runs and 150 cut imports, or as many as `PNEUDRIVE_PAIRS` and `PNEUDRIVE_IMPORTS` say
//! (`cargo xtask soak-link`).

use std::io::Write;
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Parameters};
use pneudrive_link::client::Client;
use pneudrive_protocol::{MAX_FRAME, Mode, Request, RequestBody, encode};
use pneudrive_records::record::Record;
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;

use crate::program::{folder, ok, unhurried_rig, virtual_rig};
use crate::simulated_link::{Random, SimulatedRig, cases};

/// Two tests that share no setpoint but the first one.
const TESTS: [(&str, [i32; 3]); 2] = [("outward", [8192, 12_000, 14_000]), ("inward", [8192, 7000, 5000])];

fn write_test(folder: &Path, (name, [a, b, c]): (&str, [i32; 3])) {
    let text = format!(
        "name = \"{name}\"\n[test]\nmoves = [[0.0, {a}], [0.1, {b}], [0.2, {c}]]\nduration_s = 0.4\n"
    );
    std::fs::write(folder.join(format!("{name}.toml")), text).expect("written");
}

fn spawn(folder: &Path, arguments: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder).args(arguments.split_whitespace());
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program runs")
}

/// The setpoints of a record, in their order.
fn setpoints(record: &Record) -> Vec<i32> {
    let mut all: Vec<i32> =
        record.samples.iter().map(|sample| sample.position + i32::from(sample.error)).collect();
    all.dedup();
    all
}

/// What came of two programs that ran their tests at the same time.
#[derive(Debug, Default)]
struct Pairs {
    pairs: u32,
    /// Runs whose setpoints are those of neither test.
    asked_for_by_nobody: u32,
    /// Programs that said that their test had run, though another one had.
    wrong_successes: u32,
    successes: u32,
    refusals: u32,
}

fn run_a_pair(folder: &Path, figures: &mut Pairs) {
    let rig = virtual_rig("servo-b-tuned");
    let programs = TESTS.map(|(name, _)| spawn(folder, &format!("run {name}.toml --port {}", rig.port())));
    let succeeded = programs.map(|mut program| program.wait().expect("it was started").success());
    figures.pairs += 1;
    figures.successes += succeeded.iter().filter(|&&success| success).count() as u32;
    figures.refusals += succeeded.iter().filter(|&&success| !success).count() as u32;
    let mut client = Client::connect(rig.port()).expect("an answer");
    while client.status().expect("an answer").mode == Mode::Running {}
    let Ok(record) = client.record(|_, _| {}) else { return };
    let seen = setpoints(&record);
    let of_test = |(_, moves): &(&str, [i32; 3])| moves.starts_with(&seen);
    figures.asked_for_by_nobody += u32::from(!TESTS.iter().any(of_test));
    // The last run is that of a program that succeeded, if only one has.
    if succeeded[0] != succeeded[1] {
        let own = TESTS[usize::from(succeeded[1])].1;
        figures.wrong_successes += u32::from(seen != own);
    }
}

#[test]
fn two_programs_that_run_tests_at_the_same_time_run_the_test_of_one_or_of_none() {
    let (folder, mut figures) = (folder(), Pairs::default());
    TESTS.iter().for_each(|&test| write_test(folder.path(), test));
    for _ in 0..cases("PNEUDRIVE_PAIRS", 10) {
        run_a_pair(folder.path(), &mut figures);
    }
    println!("{figures:?}");
    assert_eq!((figures.asked_for_by_nobody, figures.wrong_successes), (0, 0), "{figures:?}");
}

/// Bytes in which the rig takes an import and answers it.
const NEAR_THE_END: usize = 64;

#[test]
fn an_import_that_is_cut_anywhere_leaves_the_old_configuration_or_the_new_one() {
    let (old, new) = (Parameters::default(), Rig::builtin("servo-a-tuned").expect("built in").parameters());
    let (mut random, mut mixtures, mut taken) = (Random(21), 0, 0);
    let imports = cases("PNEUDRIVE_IMPORTS", 150);
    let carried =
        |rig: &SimulatedRig| rig.change(|simulation| simulation.up.carried + simulation.down.carried);
    let whole = {
        let rig = SimulatedRig::with_record(&[]);
        rig.connect().expect("an answer").import_parameters(&new).expect("a good line");
        carried(&rig)
    };
    for number in 0..imports {
        let rig = SimulatedRig::with_record(&[]);
        let mut client = rig.connect().expect("an answer");
        // Every other one near its end, where it is taken.
        let at = if number % 2 == 0 { 1 + random.below(whole) } else { whole - random.below(NEAR_THE_END) };
        rig.change(|simulation| simulation.breaks_in(at));
        let result = client.import_parameters(&new);
        drop(client);
        rig.change(|simulation| simulation.breaks_in(usize::MAX / 2));
        let left = rig.connect().expect("an answer").parameters().expect("an answer").values;
        mixtures += u32::from(left != old && left != new);
        taken += u32::from(left == new);
        assert!(result.is_err() || left == new, "an import that succeeds is taken");
    }
    println!("{imports} imports cut: {taken} taken, {mixtures} mixtures");
    assert_eq!(mixtures, 0, "of {imports} imports");
    assert!(0 < taken && taken < imports, "cut before and after the import was taken: {taken} of {imports}");
}

#[test]
fn a_drive_whose_host_was_killed_is_stopped_though_another_program_looks_on() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let run = format!("run servo-b-tuned --set test.duration_s=30 --port {}", rig.port());
    let mut program = spawn(folder.path(), &run);
    let mut monitor = Client::connect(rig.port()).expect("an answer");
    while monitor.status().expect("an answer").index < 100 {
        std::thread::sleep(Duration::from_millis(20));
    }
    program.kill().expect("it runs");
    let killed = Instant::now();
    let _ = program.wait();
    let status = loop {
        std::thread::sleep(Duration::from_millis(50));
        let status = monitor.status().expect("an answer");
        if status.mode != Mode::Running || killed.elapsed() > Duration::from_secs(15) {
            break status;
        }
    };
    println!("{:?} {:.2} s after its host was killed", status.mode, killed.elapsed().as_secs_f64());
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::HostSilent.code()));
    assert!(killed.elapsed() < Duration::from_secs(3), "{:?}", killed.elapsed());
}

/// What becomes of a run beside which another program changes a parameter at one of these places.
fn run_beside_a_change(with_parameters: bool, changes_before: Option<&str>) -> Result<Mode, String> {
    let rig = SimulatedRig::with_record(&[]);
    let [mut one, mut other] = [(); 2].map(|()| rig.connect().expect("an answer"));
    let mut now = |place: &str| {
        if changes_before == Some(place) {
            other.set_parameters(id::VELOCITY_GAIN, &[77]).expect("disarmed");
        }
    };
    let test = Rig::read("servo-b", builtin("servo-b").expect("a built-in rig")).expect("a rig");
    one.reference(8192).expect("disarmed");
    let parameters = with_parameters.then(|| test.parameters());
    if !with_parameters {
        one.parameters().expect("those that are compared with the file's");
    }
    now("stating the test");
    one.prepare(&test, test.last_sample(), parameters.as_ref()).expect("disarmed");
    now("reading the parameters");
    one.parameters().expect("those of the stream's header");
    now("arming");
    one.arm().expect("disarmed");
    one.start().map_err(|error| error.to_string())?;
    Ok(one.status().expect("an answer").mode)
}

#[test]
fn a_test_runs_with_the_parameters_that_its_program_means_or_not_at_all() {
    let changed = Err("the simulated rig: another program has changed its parameters; run again".to_owned());
    for with_parameters in [true, false] {
        assert_eq!(run_beside_a_change(with_parameters, None), Ok(Mode::Running));
        for place in ["reading the parameters", "arming"] {
            assert_eq!(run_beside_a_change(with_parameters, Some(place)), changed, "before {place}");
        }
    }
    let stated = run_beside_a_change(true, Some("stating the test"));
    assert_eq!(stated, Ok(Mode::Running), "its own parameters come behind the other's");
    assert_eq!(run_beside_a_change(false, Some("stating the test")), changed);
}

/// A program that asks as fast as it can and reads no answer.
fn never_reads(port: &str) -> TcpStream {
    let mut stream = TcpStream::connect(port.trim_start_matches("tcp://")).expect("the rig listens");
    stream.set_write_timeout(Some(Duration::from_millis(20))).expect("a time-out");
    let mut asks = stream.try_clone().expect("a copy");
    std::thread::spawn(move || {
        let mut frame = [0; MAX_FRAME];
        let request = Request { sequence: 1, session: 1007, boot: 0, body: RequestBody::Info };
        let frame = encode(&request, &mut frame).expect("fits");
        let many: Vec<u8> = frame.repeat(100);
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(60) {
            match asks.write(&many) {
                Err(error) if !pneudrive_link::port::is_wait(&error) => break,
                _ => {}
            }
        }
    });
    stream.flush().expect("open");
    stream
}

#[test]
fn programs_that_never_read_do_not_slow_the_others() {
    let folder = folder();
    let timed = |deaf: usize| {
        let rig = unhurried_rig("servo-b-tuned");
        let _far_end: Vec<TcpStream> = (0..deaf).map(|_| never_reads(rig.port())).collect();
        // Until their buffers are full.
        std::thread::sleep(Duration::from_millis(if deaf > 0 { 1500 } else { 0 }));
        let begun = Instant::now();
        ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=2 --port {}", rig.port()));
        begun.elapsed().as_secs_f64()
    };
    let [alone, beside_one, beside_three] = [0, 1, 3].map(timed);
    println!(
        "run: {alone:.2} s alone, {beside_one:.2} s beside one that never reads, {beside_three:.2} s beside three"
    );
    assert!(
        beside_three < alone + 1.0,
        "{alone:.2} s alone, {beside_three:.2} s beside three that never read"
    );
}
