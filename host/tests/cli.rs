//! The command line as a user meets it: what it prints, what it leaves, how it ends.

use std::fs;
use std::process::Command;

use pneudrive_records::target::TargetFile;

use crate::program::{exists, folder, ok, transcript, unhurried_rig, virtual_rig, with_line};

#[test]
fn the_demo_does_the_whole_job_and_numbers_its_records() {
    let folder = folder();
    let printed = ok(folder.path(), "demo");
    exists(folder.path(), &["TARGET01.DAT", "run.json", "trace.csv", "report.html"]);
    for channel in ["position", "pressure 1", "pressure 2", "spool", "command", "error"] {
        let row =
            printed.lines().find(|line| line.starts_with(channel)).expect("a row in the deviation table");
        let figures: Vec<f64> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        assert!(figures.iter().any(|figure| *figure != 0.0), "the spread makes a difference: {row}");
    }
    let report = std::fs::read_to_string(folder.path().join("report.html")).expect("the report");
    for who in ["The virtual rig", "The simulation"] {
        let told = format!("{who} settles within 0.05 mm after ");
        assert!(printed.contains(&told) && report.contains(&told), "{printed}");
    }
    ok(folder.path(), "demo");
    exists(folder.path(), &["TARGET02.DAT"]);
}

#[test]
fn the_same_seed_demonstrates_the_same() {
    let folder = folder();
    ok(folder.path(), "demo --seed 5");
    ok(folder.path(), "demo --seed 5");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("written");
    assert_eq!(read("TARGET01.DAT"), read("TARGET02.DAT"));
}

#[test]
fn without_arguments_the_help_says_where_to_start() {
    let folder = folder();
    let printed = transcript(folder.path(), "");
    assert!(printed.contains("Start with: pneudrive demo") && printed.ends_with("= 2"), "{printed}");
}

#[test]
fn wrong_use_ends_with_2_and_what_is_not_there_or_says_no_with_a_code_of_its_own() {
    let folder = folder();
    for (arguments, code) in [
        ("fly", 2),
        ("simulate servo-b", 2),
        ("simulate servo-b --out . --tolerance 5", 2),
        ("demo --spread 80%", 2),
        ("rig check nothing.toml", 3),
        ("overlay TARGET07.DAT run", 3),
        ("replay TARGET07.DAT", 3),
        ("replay", 2),
        ("device --port tcp://127.0.0.1:1 info", 4),
        ("device --port tcp://127.0.0.1 info", 2),
        ("device --port tcp://127.0.0.1:99999 info", 2),
        ("eval run --from nan", 2),
        ("virtual servo-b --listen udp:3", 2),
        ("simulate servo-b --out . --set load.mass_kg", 2),
        ("virtual servo-b --listen pty --set controller.model=continuous", 1),
    ] {
        assert!(transcript(folder.path(), arguments).ends_with(&format!("= {code}")), "{arguments}");
    }
}

/// Once the number was taken for an argument that nobody knows.
#[test]
fn a_negative_number_is_judged_as_a_number() {
    let folder = folder();
    for (arguments, says) in [
        ("eval run --tolerance -1", "invalid value '-1' for '--tolerance-mm <MM>': must be more than 0"),
        (
            "tune servo-b --out x --settled -0.5",
            "invalid value '-0.5' for '--tolerance-mm <MM>': must be above 0",
        ),
        ("simulate servo-b --out x --change -0.1", "invalid value '-0.1' for '--change <X>'"),
        ("sweep s.toml --threads -2", "invalid value '-2' for '--threads <N>'"),
        ("monitor --port pty:x --every -1", "invalid value '-1' for '--every <S>'"),
    ] {
        let printed = transcript(folder.path(), arguments);
        assert!(printed.contains(says) && printed.ends_with("= 2"), "{arguments}: {printed}");
    }
}

#[test]
fn a_rig_is_armed_stopped_and_configured_from_the_command_line() {
    let folder = folder();
    let rig = virtual_rig("servo-b-tuned");
    let port = rig.port();
    let device = |action: &str| transcript(folder.path(), &format!("device --port {port} {action}"));

    assert!(device("info").contains("board       virtual rig\n"));
    assert!(device("status").starts_with("mode        disarmed\nreferenced  yes\n"));
    assert!(device("arm").starts_with("armed"));
    assert!(device("status").starts_with("mode        armed\n"));
    assert!(device("config set velocity_gain 7").contains("disarm it first"));
    assert!(device("stop").starts_with("stopped"));
    assert!(device("status").starts_with("mode        fault stop: a stop was requested\n"));
    assert!(device("disarm").contains("the fault stays until `device arm`"));
    assert!(device("arm").starts_with("armed"));
    assert!(device("disarm").starts_with("disarmed"));

    assert_eq!(device("config get velocity_gain"), "velocity_gain = 2000\n= 0");
    assert_eq!(device("config set gain_profile[3] 2000"), "gain_profile[3] = 2000\n= 0");
    assert_eq!(device("config get gain_profile[3]"), "gain_profile[3] = 2000\n= 0");
    assert!(
        device("config set velocity_gain 70000")
            .contains("controller.velocity_gain = 70000 is out of range: 0 to 65535")
    );
    assert!(device("config get nonsense").contains("there is no parameter nonsense"));
    assert!(device("config get gain_profile[256]").contains("gain_profile has the entries 0 to 255"));
    assert!(device("config import servo-b-tuned").starts_with("loaded"));
}

#[test]
fn a_test_is_run_recorded_and_overlaid_from_the_command_line() {
    let folder = folder();
    let rig = virtual_rig("servo-b-tuned");
    let port = rig.port();
    let run = "servo-b-tuned --set test.duration_s=0.4";
    let printed = transcript(folder.path(), &format!("run {run} --port {port}"));
    assert!(printed.contains("servo-b-tuned: done\nthe drive holds its last setpoint"), "{printed}");
    assert!(
        transcript(folder.path(), &format!("record --port {port}")).contains("TARGET01.DAT: 308 samples")
    );
    ok(folder.path(), &format!("simulate {run} --out sim"));
    let printed = ok(folder.path(), "overlay TARGET01.DAT sim --out page.html");
    exists(folder.path(), &["page.html"]);
    let position = printed.lines().find(|line| line.starts_with("position")).expect("a row");
    let figures: Vec<f64> = position.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(figures[3] <= 0.01206, "the rig is its model: within a count of the encoder: {position}");
}

/// A TARGET file with another command at a sample, and the CRC of these data.
fn with_command(text: &str, k: usize, command: i16) -> String {
    let mut file = TargetFile::from_text(text).expect("a TARGET file");
    file.samples[k].1.command = command;
    file.seal();
    file.to_text()
}

/// A folder with the record of a run, TARGET01.DAT.
fn recorded() -> tempfile::TempDir {
    let folder = folder();
    let rig = virtual_rig("servo-b-tuned");
    let run = "servo-b-tuned --set test.duration_s=0.4";
    ok(folder.path(), &format!("run {run} --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    folder
}

#[test]
fn a_record_is_replayed_and_the_sample_where_it_parts_is_shown() {
    let folder = recorded();
    assert_eq!(
        transcript(folder.path(), "replay TARGET01.DAT"),
        "TARGET01.DAT: 308 samples, every command as recorded\n\
         it ends with sample 307, which does not trip the controller: the test was over, the recorder was full, \
         or the drive was stopped from outside\n= 0"
    );

    let text = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written");
    fs::write(folder.path().join("other.dat"), with_command(&text, 250, 77)).expect("written");
    assert_eq!(
        transcript(folder.path(), "replay other.dat"),
        "                                        recorded               replayed
       k    position    P1    P2  command  error  spool  command  error
     247        8317  1330  1357     2048   8067   3482     2048   8067
     248        8343  1332  1352     2048   8041   3762     2048   8041
     249        8374  1332  1347     2048   8010   3765     2048   8010
>    250        8410  1332  1343       77   7974   3765     2048   7974
     251        8451  1331  1339     2048   7933   3765     2048   7933
     252        8496  1329  1336     2048   7888   3765     2048   7888
     253        8547  1326  1334     2048   7837   3765     2048   7837
! error: other.dat: sample 250: command 77 recorded, 2048 replayed (1 of 308 samples differ)\n= 7"
    );
}

#[test]
fn a_record_that_cannot_be_replayed_is_refused_and_an_unknown_parameter_named() {
    let folder = recorded();
    let text = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written");
    fs::write(folder.path().join("damaged.dat"), text.replace("\n1,", "\n1,1")).expect("written");
    let printed = transcript(folder.path(), "replay damaged.dat");
    assert!(
        printed.starts_with("! error: damaged.dat: it is damaged, truncated or changed: the CRC is"),
        "{printed}"
    );
    let thin = with_line(&text, "decimation", Some("2"));
    fs::write(folder.path().join("thin.dat"), thin).expect("written");
    assert_eq!(
        transcript(folder.path(), "replay thin.dat"),
        "! error: thin.dat: its decimation is 2: the controller ran on samples that are not in the file; record \
         the run again with test.decimation=1, or stream it with --every 1\n= 1"
    );
    let newer = with_line(&text, "param.jerk_limit", Some("4"));
    fs::write(folder.path().join("newer.dat"), newer).expect("written");
    let printed = transcript(folder.path(), "replay newer.dat");
    assert!(
        printed.contains("! note: jerk_limit: in the file, but this version does not know it"),
        "{printed}"
    );
    assert!(printed.ends_with("= 0"), "{printed}");
}

#[test]
fn a_run_with_other_parameters_than_the_file_says_so() {
    let folder = folder();
    let rig = virtual_rig("servo-b");
    let run = format!("run servo-b-tuned --set test.duration_s=0.05 --port {}", rig.port());
    let printed = transcript(folder.path(), &run);
    assert!(printed.contains("! note: the rig's parameters differ from servo-b-tuned"), "{printed}");
    let printed = transcript(folder.path(), &format!("{run} --config"));
    assert!(!printed.contains("note:") && printed.ends_with("= 0"), "{printed}");
}

#[test]
fn damaged_and_foreign_files_are_refused_by_what_is_wrong_with_them() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    let printed = |arguments: &str| {
        let printed = transcript(folder.path(), arguments);
        assert!(printed.ends_with("= 1"), "{printed}");
        printed
    };
    write("empty.dat", "");
    write("foreign.dat", "hello\n");
    assert!(
        printed("overlay empty.dat empty.dat").contains("error: empty.dat: the file ends before its data")
    );
    assert!(printed("overlay foreign.dat empty.dat").contains("error: foreign.dat: line 1: expected"));
    ok(folder.path(), "simulate servo-b --set test.duration_s=0.01 --out run");
    let trace = fs::read_to_string(folder.path().join("run/trace.csv")).expect("written");
    write("run/trace.csv", &trace[..trace.len() - 40]);
    assert!(printed("overlay run run").contains("trace.csv: line 9: expected 18 numbers"));
    write("run/run.json", "{");
    assert!(printed("overlay run run").contains("run.json is not JSON"));
}

#[test]
fn a_port_that_is_not_there_is_named_with_what_to_do() {
    let folder = folder();
    let printed = transcript(folder.path(), "device --port tcp://127.0.0.1:1 info");
    assert!(printed.contains("cannot reach a rig at tcp://127.0.0.1:1; is one listening there"), "{printed}");
    let printed = transcript(folder.path(), "device --port /dev/no-such-port info");
    assert!(printed.contains("cannot open /dev/no-such-port"), "{printed}");
}

#[test]
fn someone_who_is_no_rig_is_noticed() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    let silent = std::thread::spawn(move || listener.accept());
    let folder = folder();
    let printed = transcript(folder.path(), &format!("device --port tcp://127.0.0.1:{port} info"));
    assert!(printed.contains("no answer from") || printed.contains("the link to"), "{printed}");
    assert!(printed.ends_with("= 4"), "{printed}");
    let _ = silent.join();
}

#[cfg(unix)]
#[test]
fn a_virtual_rig_on_a_pty_is_talked_to_by_its_name() {
    use std::io::{BufRead, BufReader};
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    let mut rig = command
        .args(["virtual", "servo-b", "--listen", "pty", "--fast", "--spread", "10%", "--seed", "3"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("the program runs");
    let mut line = String::new();
    BufReader::new(rig.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line");
    let port = line.trim().rsplit(' ').next().expect("a port").to_owned();
    let folder = folder();
    let printed = transcript(folder.path(), &format!("device --port {port} status"));
    rig.kill().expect("it runs");
    let _ = rig.wait();
    assert!(printed.starts_with("mode        disarmed\n"), "{line}{printed}");
}

/// Once its steps were taken for the counts of a sensor: -1.25 mm, for every stepper rig.
#[test]
fn the_spool_of_a_stepper_is_not_compared_as_if_a_sensor_had_measured_it() {
    let (folder, rig) = (folder(), virtual_rig("servo-a-tuned"));
    let port = rig.port();
    ok(folder.path(), &format!("run servo-a-tuned --config --port {port}"));
    ok(folder.path(), &format!("record --port {port}"));
    ok(folder.path(), "simulate servo-a-tuned --out sim --no-report");
    let printed = ok(folder.path(), "overlay TARGET01.DAT sim");
    assert!(
        printed.contains("\npressure 2 ") && printed.contains("\ncommand ") && !printed.contains("\nspool "),
        "{printed}"
    );
}

/// The first firmware has no parameter `stepper`, and no line of it in its records.
#[test]
fn a_record_of_a_rig_that_knows_of_no_steppers_has_the_spool_of_its_sensor() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    ok(folder.path(), &format!("run servo-b-tuned --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let path = folder.path().join("TARGET01.DAT");
    let text = std::fs::read_to_string(&path).expect("a record");
    let older = with_line(&text, "param.stepper", None);
    assert_ne!(older, text);
    std::fs::write(&path, older).expect("written");
    ok(folder.path(), "simulate servo-b-tuned --out sim --no-report");
    assert!(ok(folder.path(), "overlay TARGET01.DAT sim").contains("\nspool "));
}

/// Once `run` started as soon as it had armed, and nothing was there from before.
#[test]
fn a_run_is_started_once_what_it_wants_from_before_is_recorded() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let port = rig.port();
    let test = "--set test.pre_trigger=60 --set test.duration_s=0.2 --set test.moves=[[0.0,8200]]";
    ok(folder.path(), &format!("run servo-b-tuned --port {port} {test}"));
    ok(folder.path(), &format!("record --port {port}"));
    let text = std::fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("a record");
    assert!(text.contains("\n# pre_trigger = 60\n"), "{text:.1500}");
}

/// Once half a trace was evaluated as if it were the whole.
#[test]
fn a_trace_that_was_cut_at_the_end_of_a_line_is_refused() {
    let folder = folder();
    ok(folder.path(), "simulate servo-a --out out --no-report");
    let path = folder.path().join("out/trace.csv");
    let text = std::fs::read_to_string(&path).expect("written");
    let part: String = text.lines().take(500).map(|line| format!("{line}\n")).collect();
    std::fs::write(&path, part).expect("written");
    let printed = transcript(folder.path(), "eval out");
    assert!(printed.contains("trace.csv has 499 of the 2385 rows of its run: it is truncated"), "{printed}");
}

/// Once a rig file that was cut by a full disk came with exit code 0.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    let full = std::fs::File::options().write(true).open("/dev/full").expect("a full device");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    let output = command.args(["rig", "show", "servo-b"]).stdout(full).output().expect("it runs");
    let printed = String::from_utf8(output.stderr).expect("UTF-8");
    assert!(printed.starts_with("error: cannot write to standard output"), "{printed}");
    assert_eq!(output.status.code(), Some(8));
}

/// Once the rig had forgotten its record before the file was tried.
#[test]
fn a_stream_that_cannot_be_written_leaves_the_last_record_on_the_rig() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let port = rig.port();
    ok(folder.path(), &format!("run servo-b-tuned --port {port}"));
    let printed =
        transcript(folder.path(), &format!("run servo-b-tuned --port {port} --stream none/run.csv"));
    assert!(printed.contains("cannot make none/run.csv") && printed.ends_with("= 3"), "{printed}");
    ok(folder.path(), &format!("record --port {port}"));
    assert!(folder.path().join("TARGET01.DAT").exists());
    ok(folder.path(), &format!("device --port {port} disarm"));
    ok(folder.path(), &format!("device --port {port} arm"));
    let printed = transcript(folder.path(), &format!("record --port {port}"));
    assert!(printed.contains("is armed: it has no record until a run has made one"), "{printed}");
}

/// Ctrl-C is how a run without an end ends: the drive is disarmed, the file is whole, nothing has failed.
#[cfg(unix)]
#[test]
fn a_run_until_stopped_ends_with_ctrl_c() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let path = folder.path().join("run.csv");
    let run = format!("run servo-b-tuned --port {} --until-stopped --stream run.csv", rig.port());
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder.path()).args(run.split_whitespace());
    let program = command.stdout(std::process::Stdio::piped()).spawn().expect("the program runs");
    // More than the 4389 samples that the board's memory holds, each line 20 bytes at least.
    while std::fs::metadata(&path).map_or(0, |file| file.len()) < 20 * 5000 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let interrupt = format!("kill -INT {}", program.id());
    assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    let output = program.wait_with_output().expect("it was started");
    let printed = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(output.status.success(), "{printed}");
    assert!(printed.ends_with("servo-b-tuned: interrupted, the drive is disarmed\n"), "{printed}");
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.contains("\n# samples = ") && text.contains("\n# missing = 0\n# crc32 = "), "{printed}");
    let status = ok(folder.path(), &format!("device --port {} status", rig.port()));
    assert!(status.starts_with("mode        disarmed\n"), "{status}");
}
