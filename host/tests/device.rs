//! `pneudrive device` on a virtual rig: homing, stored configuration, fault log.

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
#[cfg(unix)]
use std::process::{Command, Stdio};

use crate::program::{folder, transcript, unhurried_rig, virtual_rig, virtual_rig_of};
use pneudrive_sim::Rig;

#[test]
fn an_axis_that_is_homed_counts_from_its_stop() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    assert!(device("home").contains("the drive is not armed; arm it first"));
    assert!(device("status").starts_with("mode        disarmed\n"), "refused without a trip");
    device("arm");
    let printed = device("home");
    assert!(
        printed.starts_with("homed: the axis is at ") && printed.ends_with(" mm, armed\n= 0"),
        "{printed}"
    );
    assert!(device("status").starts_with("mode        armed\nreferenced  yes\n"));
    assert_eq!(device("faults"), "no faults\n= 0");
    assert!(device("stop").starts_with("stopped"));
    let faults = device("faults");
    assert!(faults.starts_with("reset    1 ") && faults.contains(" stop "), "{faults}");
    assert!(
        faults.contains(" s into the run  at ") && faults.contains(" mm  a stop was requested"),
        "{faults}"
    );
    assert_eq!(faults.lines().count(), 2, "one event and the exit code: {faults}");
}

/// Once Ctrl-C ended the program, and the cylinder went on to its stop.
#[cfg(unix)]
#[test]
fn ctrl_c_stops_a_homing_run() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let device = |what: &str| format!("device --port {} {what}", rig.port());
    transcript(folder.path(), &device("arm"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.args(device("home").split_whitespace()).stderr(Stdio::piped());
    let program = command.spawn().expect("the program runs");
    let homes = |_| transcript(folder.path(), &device("status")).starts_with("mode        homing\n");
    assert!((0..500).any(homes));
    let interrupt = format!("kill -INT {}", program.id());
    assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    let output = program.wait_with_output().expect("it was started");
    let printed = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(printed.contains("homing was stopped by Ctrl-C"), "{printed}");
    assert!(transcript(folder.path(), &device("status")).starts_with("mode        fault stop: "));
}

#[test]
fn a_disarmed_drive_has_no_setpoint() {
    let (folder, rig) = (folder(), virtual_rig("servo-b"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    let shown =
        |status: &str| ["setpoint ", "error ", "position "].map(|name| status.contains(&format!("\n{name}")));
    assert_eq!(shown(&device("status")), [false, false, true], "nothing controls it");
    device("arm");
    assert_eq!(shown(&device("status")), [true, true, true]);
}

#[test]
fn a_rig_without_faults_says_so() {
    let (folder, rig) = (folder(), virtual_rig("servo-b"));
    assert_eq!(transcript(folder.path(), &format!("device --port {} faults", rig.port())), "no faults\n= 0");
}

#[test]
fn parameters_are_stored_exported_and_taken_over_again() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    let info = device("info");
    assert!(info.contains(", never stored\n"), "{info}");
    assert!(info.contains("\noutputs     after 500 to 500 us: ") && info.contains(" exact\n"), "{info}");
    assert_eq!(device("config save"), "stored; they survive a reset\n= 0");
    assert!(device("info").contains(", stored 1 times\n"));
    device("config set velocity_gain 5");
    assert!(device("info").contains(", stored 1 times, changed since\n"));
    device("config export parameters.txt");
    device("config set velocity_gain 6");
    assert!(device("config import parameters.txt").starts_with("loaded"));
    assert_eq!(device("config get velocity_gain"), "velocity_gain = 5\n= 0");
    device("arm");
    assert!(device("config save").contains("disarm it first"));
    device("disarm");

    fs::write(folder.path().join("wrong.txt"), "period_us = 1300\nspeed = 3\n").expect("written");
    let printed = device("config import wrong.txt");
    assert!(printed.contains("wrong.txt: line 2: there is no parameter speed"), "{printed}");
    assert_eq!(device("config get velocity_gain"), "velocity_gain = 5\n= 0", "nothing was changed");

    let whole = fs::read_to_string(folder.path().join("parameters.txt")).expect("exported");
    fs::write(
        folder.path().join("cut.txt"),
        &whole[..whole.find("controller.velocity_gain").expect("a line")],
    )
    .expect("written");
    let printed = device("config import cut.txt");
    let all = whole.lines().filter(|line| line.contains(" = ")).count();
    let message = format!("cut.txt: its first line announces {all} parameters, and 6 are there");
    assert!(printed.contains(&message), "{printed}");
    fs::write(folder.path().join("nothing.txt"), "").expect("written");
    assert!(device("config import nothing.txt").contains("nothing.txt is empty"));
    assert_eq!(device("config set velocity_gain=5"), "velocity_gain = 5\n= 0", "as --set takes it");
    assert!(device("config set velocity_gain").contains("`device config set velocity_gain VALUE`"));
    assert!(device("config set velocity_gain 1.5").contains("\"1.5\" is not a whole number"));
    assert_eq!(device("config get velocity_gain"), "velocity_gain = 5\n= 0", "nothing was changed");
}

/// Once the device had names and units of its own: hold_ms, pressure_max_pa.
#[test]
fn parameters_have_the_names_the_units_and_the_words_of_rig_files() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    assert_eq!(device("config get safety.hold_s"), "safety.hold_s = 60 s\n= 0");
    assert_eq!(device("config set safety.hold_s 1.5"), "safety.hold_s = 1.5 s\n= 0");
    assert_eq!(device("config get hold_ms"), "hold_ms = 1500 ms\n= 0", "the name that it had, in its unit");
    assert_eq!(device("config set controller.loop open"), "controller.loop = open\n= 0");
    assert!(device("config set controller.loop ajar").contains("\"ajar\" is not one of closed, open"));
    assert!(
        device("config set safety.hold_s 0.0001").contains("the device stores it as a whole number of ms")
    );
    assert!(
        device("config set safety.hold_s 4000").contains("safety.hold_s = 4000 is out of range: 0 to 3600 s")
    );
    let list = device("config get");
    assert!(list.contains("\nencoder.mm_per_count ") && list.contains(" 0.01205 mm "), "{list}");
    device("config export parameters.txt");
    let text = fs::read_to_string(folder.path().join("parameters.txt")).expect("exported");
    assert!(text.contains("\nsafety.hold_s = 1.5\nsafety.late_output_us = "), "{text}");
    assert!(device("config import parameters.txt").starts_with("loaded"));
}

#[test]
fn figures_are_in_mm_kpa_and_s_and_in_counts_on_request() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    assert_eq!(device("reference 98.72mm"), "referenced: the axis is at 98.726 mm\n= 0");
    assert_eq!(device("reference 8193 --counts"), "referenced: the axis is at 8193 counts\n= 0");
    assert!(device("reference 98.72cm").contains("is not a whole number"));
    let printed = device("status");
    assert!(
        printed.contains("\nposition    98.726 mm\n") && printed.contains(" kPa\nspool       "),
        "{printed}"
    );
    let printed = device("status --counts");
    assert!(
        printed.contains("\nposition    8193 counts\n") && printed.contains(" raw\nspool       "),
        "{printed}"
    );
    let monitor = |more: &str| {
        transcript(folder.path(), &format!("monitor --port {} --every 0.01 --count 1{more}", rig.port()))
    };
    assert!(monitor("").contains(" 98.726 mm  error ") && monitor("").contains(" kPa  at 0.000 s"));
    assert!(
        monitor(" --counts").contains(" 8193 counts  error ")
            && monitor(" --counts").contains(" raw  at 0 samples")
    );
}

/// Once a setting that the rig is never told was passed over in silence.
#[test]
fn a_setting_that_the_test_of_a_rig_does_not_take_is_refused() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let run = |more: &str| {
        transcript(
            folder.path(),
            &format!("run servo-b-tuned --port {} --set test.duration_s=0.05 {more}", rig.port()),
        )
    };
    for key in ["load.mass_kg=9", "test.position_m=0.1", "supply.temperature_k=290"] {
        let printed = run(&format!("--config --set {key}"));
        assert!(
            printed.contains("this key is not sent to a rig") && printed.ends_with("= 1"),
            "{key}: {printed}"
        );
    }
    let printed = run("--set controller.velocity_gain=5");
    assert!(
        printed.contains("--set controller.velocity_gain: a run downloads only the test; --config"),
        "{printed}"
    );
    assert!(run("--set controller.velocity_gain=5 --config").ends_with("= 0"));
    assert!(run("--set controller.loop=open").contains("controller.loop = closed on the rig and"));
    let printed = run("--set test.decimation=2");
    assert!(printed.ends_with("= 0"), "{printed}");
}

#[test]
fn moves_that_wait_for_each_other_end_the_run_and_are_counted() {
    let (folder, rig) = (folder(), virtual_rig("servo-a-tuned"));
    let port = rig.port();
    let base = transcript(folder.path(), "rig show servo-a-tuned");
    let base = base
        .trim_end_matches("= 0")
        .replace("moves = [[0.0, 8192], [0.3, 16384], [1.72, 8192]]", "targets = [10000, 12000, 9000]");
    let base = base.replace("duration_s = 3.1", "duration_s = 9.0").replace(
        "scale = 65536 ",
        "exit_on_dead_band = true\nmonitoring_s = 0.05\ntolerance_counts = 30\nscale = 65536 ",
    );
    fs::write(folder.path().join("targets.toml"), base).expect("written");
    let printed = transcript(folder.path(), &format!("run targets.toml --config --port {port}"));
    assert!(printed.contains("servo-a-tuned: done"), "{printed}");
    let status = transcript(folder.path(), &format!("device --port {port} status"));
    assert!(status.contains("moves       number 3 arrived, 0 not reached\n"), "{status}");
}

#[test]
fn move_records_are_shown_set_loaded_and_stored() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    assert!(device("records show").starts_with("no records; "), "{}", device("records show"));
    let set = device("records set 3 to_mm=120.5 profile=s-curve velocity_mm_s=300 dwell_s=0.13");
    assert!(set.starts_with("3  to 120.500 mm, in ") && set.ends_with(" s, dwell 0.130 s\n= 0"), "{set}");
    let wrong = device("records set 3 to_mm=500");
    assert!(wrong.contains("lies beyond it") && wrong.ends_with("= 1"), "{wrong}");
    fs::write(
        folder.path().join("two.toml"),
        "[[record]]\nnumber = 1\nto_mm = 50\n\n[[record]]\nnumber = 2\nto_mm = 60\n",
    )
    .expect("written");
    let loaded = device("records load two.toml");
    assert!(loaded.starts_with("two.toml: 2 records are the table now"), "{loaded}");
    let shown = device("records show");
    assert!(shown.starts_with(" 1  to 49.995 mm, at once\n 2  to 59.997 mm, at once\nnot stored"), "{shown}");
    assert_eq!(device("records save"), "stored with the parameters; they survive a reset\n= 0");
    assert_eq!(device("records remove 1"), "there is no record 1 any more\n= 0");
    assert!(device("records show").starts_with(" 2  to 59.997 mm, at once\nnot stored"), "changed since");
    device("arm");
    assert!(device("records remove 2").contains("disarm"), "only while it is disarmed");
}

#[test]
fn the_inputs_of_a_virtual_rig_are_set_and_shown() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    let off = "inputs   number 0, start off, acknowledge off, run off, enable off\noutputs  ready off, ";
    assert!(device("io").starts_with(off), "{}", device("io"));
    let on = device("io enable=on run=on number=3");
    assert!(on.starts_with("inputs   number 3, start off, acknowledge off, run on, enable on\n"), "{on}");
    assert!((0..500).any(|_| device("io").contains("outputs  ready on, in position off, fault off")));
    device("io start=on");
    let refused = "refused  number 3: there is no record of this number";
    assert!((0..500).any(|_| device("io").contains(refused)), "{}", device("io"));
    for (wrong, says) in [
        ("number=16", "out of range: 0 (none), the number of a record, 1 to 14, or 15 (homing)"),
        ("stop=on", "there is no input stop; there are number, start, acknowledge, run, enable"),
        ("enable=1", "an input is on or off"),
        ("enable", "is no INPUT=VALUE"),
    ] {
        assert!(device(&format!("io {wrong}")).contains(says), "{}", device(&format!("io {wrong}")));
    }
}

/// Where the axis stands, mm.
fn position_mm(status: &str) -> f64 {
    let line =
        status.lines().find(|line| line.starts_with("position ")).unwrap_or_else(|| panic!("{status}"));
    let mm = line.split_whitespace().nth(1).and_then(|mm| mm.parse().ok());
    mm.unwrap_or_else(|| panic!("{line}"))
}

#[test]
fn a_drive_goes_to_a_place_and_jogs_by_a_stretch_within_its_reach() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    let went = device("go 120mm --rig servo-b-tuned");
    assert!(went.contains("the axis is at ") && went.contains("the drive holds"), "{went}");
    let off = (position_mm(&device("status")) - 120.0).abs();
    assert!(off < 3.0, "{}", device("status"));
    assert_eq!(went.contains(" mm from 119.99"), off > 0.2, "a miss is told: {went}");
    let before = position_mm(&device("status"));
    let jogged = device("jog 10mm --rig servo-b-tuned");
    assert!(jogged.ends_with("= 0"), "{jogged}");
    let by = position_mm(&device("status")) - before;
    assert!((by - 10.0).abs() < 4.0, "{by}");
    let jogged = device("jog -10mm --rig servo-b-tuned");
    assert!(jogged.ends_with("= 0") && position_mm(&device("status")) < before + by - 5.0, "{jogged}");
    for (wrong, code) in [("go 120", 2), ("go x", 2), ("jog 3", 2)] {
        let printed = device(&format!("{wrong} --rig servo-b-tuned"));
        assert!(
            printed.contains("is not a length such as 98.72mm") && printed.ends_with(&format!("= {code}")),
            "{printed}"
        );
    }
}

#[test]
fn a_refused_go_changes_nothing_on_the_drive() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let port = rig.port().to_owned();
    let device = |what: &str| transcript(folder.path(), &format!("device --port {port} {what}"));
    let mut owner = pneudrive_link::client::Client::connect(&port).expect("an answer");
    owner.arm().expect("it arms");
    fs::write(folder.path().join("fine.toml"), "[encoder]\nmm_per_count = 0.01\n").expect("written");
    let before = device("status");
    assert!(before.starts_with("mode        armed\n"), "{before}");
    for (refused, says) in [
        ("go 400mm --rig servo-b-tuned", "400 mm is out of reach: the drive goes from 0.0 to 300.0 mm"),
        ("go 120mm --rig fine.toml", "encoder.mm_per_count of the drive is not that of fine"),
        ("go 120mm --rig servo-b-tuned", "commands the drive"),
        ("jog 5mm --rig servo-b-tuned", "commands the drive"),
    ] {
        let printed = device(refused);
        assert!(printed.contains(says) && !printed.ends_with("= 0"), "{refused}: {printed}");
        let after = device("status");
        assert!(after.starts_with("mode        armed\n"), "{refused}: {after}");
        assert!((position_mm(&after) - position_mm(&before)).abs() < 0.5, "{refused}: {after}");
    }
    drop(owner);
}

/// A gauge of 10 bar at a supply of 6.5 bar: its lower end is a pressure that the drive has, its upper one is 1.47 times the
/// supply.
#[test]
fn a_drive_with_an_ordinary_gauge_is_armed() {
    let folder = folder();
    let drive = "--cylinder iso-15552-40 --stroke 350mm --mass 12kg --valve proportional-5-3-700 --supply 6.5bar(g) --no-questions";
    let sensors = ["--pressure-sensors", "0 to 10 bar(g)"];
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder.path()).args(["rig", "new", "lift.toml"]).args(drive.split(' ')).args(sensors);
    let output = command.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(folder.path().join("lift.toml")).expect("written");
    let rig = virtual_rig_of(pneudrive_sim::Rig::read("lift.toml", &text).expect("valid"));
    let armed = transcript(folder.path(), &format!("device --port {} arm", rig.port()));
    assert!(armed.ends_with("= 0"), "{armed}");
    // Of one that ends at the supply nothing tells an open wire.
    let short = text.replace("pressure_max_pa = 1", "pressure_max_pa = 750000 # 1");
    fs::write(folder.path().join("short.toml"), short).expect("written");
    let checked = transcript(folder.path(), "rig check short.toml --quick");
    assert!(checked.contains("is not armed without `--without sensor-range`"), "{checked}");
    assert!(checked.contains("are watched (sensors.pressure_max_pa)"), "{checked}");
    assert!(!transcript(folder.path(), "rig check lift.toml --quick").contains("--without"));
}

/// A drive that holds a load, armed without a check by who knows why; the next who moves it does not.
#[test]
fn a_move_that_is_refused_for_a_check_that_is_off_leaves_a_drive_that_holds() {
    let (folder, rig) = (folder(), virtual_rig("press"));
    let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
    device("config set no_motion_ms=0");
    let armed = transcript(folder.path(), &format!("device --port {} --without no-motion arm", rig.port()));
    assert!(armed.ends_with("= 0"), "{armed}");
    let refused = device("go 100mm --rig press");
    assert!(refused.contains("would never trip with: no-motion") && refused.ends_with("= 5"), "{refused}");
    assert!(device("status").starts_with("mode        armed\n"), "{}", device("status"));
}

/// 8.38 kg by its file, 11 kg by its plant.
#[test]
fn what_a_drive_has_learned_is_shown_in_units_and_forgotten_on_request() {
    let settings = ["controller.adapt=kept".to_owned()];
    let rig = Rig::builtin("press").expect("a built-in rig").with_settings(&settings).expect("valid");
    let heavier = rig.with_plant(&["load.mass_kg=11".to_owned()]).expect("a plant");
    let (folder, served) = (folder(), virtual_rig_of(heavier));
    let typed = |what: &str| transcript(folder.path(), &what.replace("PORT", served.port()));
    let learned = || typed("device --port PORT learned --rig press");
    assert!(
        learned().starts_with("kept of     0 armings\nmass        1.000 of the rig file, 8.38 kg\n"),
        "{}",
        learned()
    );
    assert!(typed("device --port PORT config save").ends_with("= 0"));
    assert!(typed("run press --port PORT").ends_with("= 0"));
    assert!(typed("device --port PORT arm").ends_with("= 0"));
    let kept = learned();
    assert!(kept.starts_with("kept of     1 armings\nmass        1.2"), "{kept}");
    assert!(kept.contains(" kg\n") && kept.contains(" N\n") && kept.contains(" ms\n"), "{kept}");
    assert!(!typed("device --port PORT status").contains("\nlearned "), "it has not changed");
    assert!(typed("device --port PORT learned --forget").contains("disarm"), "not while it is enabled");
    typed("device --port PORT disarm");
    let forgotten = typed("device --port PORT learned --forget");
    assert_eq!(forgotten, "forgotten: the next run begins with what the rig file says\n= 0");
    assert!(learned().starts_with("kept of     0 armings\n"));
}

/// It was dropped without a word.
#[test]
fn a_rig_file_for_what_is_forgotten_is_refused() {
    let refused = transcript(folder().path(), "device --port tcp://127.0.0.1:1 learned --forget --rig press");
    assert!(refused.contains("'--forget' cannot be used with '--rig <RIG>'"), "{refused}");
}

/// Passes one connection on to a rig, and counts the frames that go there: each ends with a zero.
fn frames_of(rig: &str, ask: impl FnOnce(&str)) -> usize {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    let to = TcpStream::connect(rig.trim_start_matches("tcp://")).expect("a rig");
    let (mut answers, mut requests) = (to.try_clone().expect("a handle"), to);
    let counted = std::thread::spawn(move || {
        let (mut host, _) = listener.accept().expect("a host");
        let mut back = host.try_clone().expect("a handle");
        std::thread::spawn(move || std::io::copy(&mut answers, &mut back));
        let (mut frames, mut bytes) = (0, [0; 4096]);
        loop {
            match host.read(&mut bytes) {
                Ok(0) | Err(_) => return frames,
                Ok(read) => {
                    frames += bytes[..read].iter().filter(|byte| **byte == 0).count();
                    requests.write_all(&bytes[..read]).expect("it listens");
                }
            }
        }
    });
    ask(&format!("tcp://{address}"));
    counted.join().expect("it counted")
}

/// It read all parameters twice, in blocks of 64.
#[test]
fn a_status_takes_few_requests() {
    let (folder, served) = (folder(), virtual_rig("press"));
    let status = |port: &str| {
        let shown = transcript(folder.path(), &format!("device --port {port} status"));
        assert!(shown.starts_with("mode        disarmed\n"), "{shown}");
    };
    let frames = frames_of(served.port(), status);
    assert!((5..=9).contains(&frames), "{frames}");
}
