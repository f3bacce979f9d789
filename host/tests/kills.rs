//! Either side is killed at any byte of a `record`: what is left is never a broken TARGET file, and the next
//! call goes on to the whole record. Other commands are killed at any time: what they have begun, the next call removes.
//!
//! Fifty kills each, or as many as `PNEUDRIVE_KILLS` says (`cargo xtask soak-link`).

use std::collections::BTreeSet;
use std::fs;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use pneudrive_link::client::Client;
use pneudrive_protocol::RecordedSample;
use pneudrive_records::target::TargetFile;

use pneudrive_session::record::{Watch, to_folder, to_memory};
use pneudrive_session::state;

use crate::program::{folder, ok, transcript, virtual_rig};
use crate::simulated_link::{Random, SimulatedRig, any_samples, cases};

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
    files.sort();
    files
}

fn samples_of(path: &Path) -> Vec<RecordedSample> {
    TargetFile::read(path).expect("a whole file").samples.into_iter().map(|(_, sample)| sample).collect()
}

fn record(client: &mut Client, folder: &Path) -> anyhow::Result<(PathBuf, TargetFile)> {
    to_folder(client, folder, &mut |_, _| Ok(()))
}

/// What the system has not written when a program or the power goes: the end of the part file.
fn tear(folder: &Path, random: &mut Random) {
    for part in files(folder, ".part") {
        let bytes = fs::read(&part).expect("there");
        let kept = bytes.len() - random.below(bytes.len().min(700) + 1);
        fs::write(&part, &bytes[..kept]).expect("written");
    }
}

/// Records until it comes to an end, killed after so many bytes each time; how often it was.
fn record_under_kills(rig: &SimulatedRig, folder: &Path, random: &mut Random) -> u32 {
    for kills in 0.. {
        rig.change(|simulation| simulation.breaks_in(1 + random.below(30_000)));
        match rig.connect().and_then(|mut client| record(&mut client, folder)) {
            Ok((path, _)) => {
                assert_eq!(path.file_name().expect("a name"), "TARGET01.DAT");
                return kills;
            }
            Err(error) => {
                let text = format!("{error:#}");
                assert!(
                    text.contains("the simulated rig broke") || text.contains("cannot write to"),
                    "{text}"
                );
                assert!(files(folder, ".DAT").is_empty(), "a file that is not whole");
            }
        }
        if random.below(2) == 0 {
            tear(folder, random);
        }
    }
    unreachable!("chunks that came stay")
}

#[test]
fn a_record_that_was_killed_at_any_byte_is_gone_on_with_to_the_whole_file() {
    let mut random = Random(11);
    let (mut kills, mut records) = (0, 0);
    while kills < cases("PNEUDRIVE_KILLS", 50) {
        let folder = folder();
        let count = 1 + random.below(4389);
        let samples = any_samples(&mut random, count);
        let rig = SimulatedRig::with_record(&samples);
        kills += record_under_kills(&rig, folder.path(), &mut random);
        assert_eq!(samples_of(&folder.path().join("TARGET01.DAT")), samples);
        assert!(files(folder.path(), ".part").is_empty() && files(folder.path(), "partial").is_empty());
        records += 1;
    }
    println!("{kills} kills of the host at any byte; {records} records, each whole in the end");
}

#[test]
fn nothing_that_came_before_a_kill_is_asked_for_again() {
    let (mut random, folder) = (Random(3), folder());
    let rig = SimulatedRig::with_record(&any_samples(&mut random, 4389));
    rig.change(|simulation| {
        // Its CRC is there.
        simulation.rest(700);
        simulation.breaks_in(40_000);
    });
    rig.connect().and_then(|mut client| record(&mut client, folder.path())).expect_err("killed");
    rig.connect().and_then(|mut client| record(&mut client, folder.path())).expect("a good line");
    let carried = rig.change(|simulation| simulation.down.carried);
    // The whole record, what the rig says of itself and of it twice, and what was on its way.
    assert!(carried < 63_300 + 2 * 1700 + 8 * 470, "{carried} bytes came");
}

/// As the studio and the Python package record: what has arrived lies in the folder of states until the record is whole.
#[test]
fn a_record_that_goes_to_no_folder_is_resumed_as_well() {
    let mut random = Random(4);
    let samples = any_samples(&mut random, 4389);
    let rig = SimulatedRig::with_record(&samples);
    let part = state::file("the simulated rig", "part").expect("a folder of states");
    rig.change(|simulation| {
        simulation.rest(700);
        simulation.breaks_in(40_000);
    });
    let record = |watch: &mut Watch<'_>| rig.connect().and_then(|mut client| to_memory(&mut client, watch));
    let broken = format!("{:#}", record(&mut |_, _| Ok(())).expect_err("killed"));
    assert!(broken.contains("record again to resume") && part.exists(), "{broken}");
    let mut first = None;
    let ended = record(&mut |done, all| {
        first = first.or((all > 0).then_some(done));
        if done > 3000 { anyhow::bail!("enough") } else { Ok(()) }
    });
    assert!(format!("{:#}", ended.expect_err("the caller has ended it")).ends_with(": enough"));
    assert!(first.is_some_and(|there| there > 2000), "{first:?} samples were there");
    let (_, file) = record(&mut |_, _| Ok(())).expect("a good line");
    let whole: Vec<RecordedSample> = file.samples.into_iter().map(|(_, sample)| sample).collect();
    assert!(whole == samples && !part.exists());
    let carried = rig.change(|simulation| simulation.down.carried);
    assert!(carried < 63_300 + 3 * 1700 + 2 * 8 * 470, "{carried} bytes came");
}

#[test]
fn a_rig_that_is_killed_takes_its_record_with_it_and_no_piece_of_it_gets_into_the_next() {
    let mut random = Random(12);
    let kills = cases("PNEUDRIVE_KILLS", 50);
    for _ in 0..kills {
        let folder = folder();
        let [one, other] = [(); 2].map(|()| {
            let count = 1 + random.below(3000);
            any_samples(&mut random, count)
        });
        let rig = SimulatedRig::with_record(&one);
        let limit = 1 + random.below(60_000);
        rig.change(|simulation| simulation.restarts_in(limit, &other));
        // The rig may be killed in the first call, in the second, or between them.
        let calls = [(); 3].map(|()| rig.connect().and_then(|mut client| record(&mut client, folder.path())));
        let failed: Vec<String> =
            calls.iter().filter_map(|call| call.as_ref().err().map(|error| format!("{error:#}"))).collect();
        assert!(
            failed.iter().all(|text| text.contains("the record changed while it was read")),
            "{failed:?}"
        );
        assert!(failed.len() <= 1 && files(folder.path(), ".DAT").len() == 3 - failed.len(), "{failed:?}");
        for file in files(folder.path(), ".DAT") {
            let samples = samples_of(&file);
            assert!(samples == one || samples == other, "{} is of neither run", file.display());
        }
    }
    println!("{kills} kills of the rig at any byte; every file is one run");
}

/// Relays bytes to and from a rig, and says when so many have come from it.
fn proxy(rig: &str, bytes: usize) -> (String, Receiver<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let name = format!("tcp://{}", listener.local_addr().expect("bound"));
    let rig = TcpStream::connect(rig.trim_start_matches("tcp://")).expect("the rig listens");
    let (say, reached) = channel();
    std::thread::spawn(move || {
        let (program, _) = listener.accept().expect("the program connects");
        let (mut up, mut to_rig) = (program.try_clone().expect("a copy"), rig.try_clone().expect("a copy"));
        std::thread::spawn(move || {
            let _ = std::io::copy(&mut up, &mut to_rig);
            // The program has gone: the relay ends, too.
            let _ = to_rig.shutdown(Shutdown::Both);
        });
        relay(rig, program, bytes, &say);
    });
    (name, reached)
}

fn relay(mut rig: TcpStream, mut program: TcpStream, mut bytes: usize, say: &Sender<()>) {
    let mut buffer = [0; 512];
    while let Ok(count @ 1..) = rig.read(&mut buffer) {
        if program.write_all(&buffer[..count]).is_err() {
            break;
        }
        bytes = bytes.saturating_sub(count);
        if bytes == 0 {
            let _ = say.send(());
        }
    }
}

/// The program itself, by the signal that nothing can catch.
#[test]
fn a_program_that_is_killed_while_it_records_leaves_no_broken_file_and_the_next_one_goes_on() {
    let rig = virtual_rig("servo-b-tuned");
    let folder = folder();
    ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=4 --port {}", rig.port()));
    let (mut random, mut kills, mut records) = (Random(5), 0, 0);
    let wanted = cases("PNEUDRIVE_KILLS", 50);
    while kills < wanted {
        let (port, reached) = proxy(rig.port(), 1 + random.below(50_000));
        let mut program = Command::new(env!("CARGO_BIN_EXE_pneudrive"))
            .current_dir(folder.path())
            .args(["record", "--port", &port])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program runs");
        // Either that many bytes come, or the program ends before and the proxy with it.
        let _ = reached.recv();
        let _ = program.kill();
        let ended = program.wait().expect("it was started");
        kills += u32::from(ended.code().is_none());
        let whole = files(folder.path(), ".DAT");
        if !whole.is_empty() {
            assert_eq!(samples_of(&whole[0]).len(), 3077);
            whole.iter().for_each(|file| fs::remove_file(file).expect("there"));
            records += 1;
        }
    }
    assert!(transcript(folder.path(), &format!("record --port {}", rig.port())).contains("3077 samples"));
    println!("{wanted} programs killed; {records} records before the last, each whole");
}

/// Every file below a folder, by its path within.
fn tree(folder: &Path) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = entry.file_name().expect("a name").to_string_lossy().into_owned();
        names.insert(name.clone());
        if entry.is_dir() {
            names.extend(tree(&entry).into_iter().map(|below| format!("{name}/{below}")));
        }
    }
    names
}

const SWEEP: &str = "rig = \"servo-b\"\n[set]\ntest.moves = [[0.0, 10000]]\ntest.duration_s = 0.1\n[vary]\n\
    load.mass_kg = [1, 2]\n[metrics]\nair = \"air_l\"\n";

/// Commands that leave files, with the folder and the names of these.
const LEAVE: [(&str, &str, &[&str]); 8] = [
    ("simulate servo-b --set test.duration_s=0.1 --out out", "out", &["trace.csv", "run.json"]),
    ("eval run --out page.html --csv channels.csv", ".", &["page.html", "channels.csv"]),
    ("overlay run run --out page.html", ".", &["page.html"]),
    ("characterise servo-b flow-gain --out out", "out", &["flow-gain.csv", "flow-gain.html"]),
    ("ladder servo-b --set test.duration_s=0.02 --ensemble 1 --out out", "out", &["ladder.html"]),
    ("sweep s.toml --out out", "out", &["sweep.csv", "sweep.html"]),
    ("tune servo-b-tuned --generations 0 --draws 1 --out out", "out", &["tuned.toml", "tune.html"]),
    ("study impulse --starts 1 --out out", "out", &["impulse.html"]),
];

/// A folder with what these commands read.
fn to_read() -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("s.toml"), SWEEP).expect("written");
    ok(folder.path(), "simulate servo-b --set test.duration_s=0.1 --ensemble 1 --no-report --out run");
    folder
}

/// A number that no process of any system has.
const NOBODY: u32 = u32::MAX;

#[cfg(target_os = "linux")]
#[test]
fn what_a_killed_program_has_begun_to_write_the_next_one_removes_and_says_so() {
    for (command, place, names) in LEAVE {
        let folder = to_read();
        let place = folder.path().join(place);
        fs::create_dir_all(&place).expect("a folder");
        let left: Vec<PathBuf> = match command.starts_with("simulate") {
            true => vec![place.join(format!(".pneudrive-next-{NOBODY}"))],
            false => names.iter().map(|name| place.join(format!(".{name}.{NOBODY}.partial"))).collect(),
        };
        for path in &left {
            let made =
                if command.starts_with("simulate") { fs::create_dir(path) } else { fs::write(path, "half") };
            made.expect("made");
        }
        let printed = transcript(folder.path(), command);
        assert!(printed.ends_with("= 0"), "{printed}");
        for path in left {
            assert!(!path.exists(), "{} is still there", path.display());
        }
        let told = printed.lines().filter(|line| line.contains("interrupted program")).count();
        assert_eq!(told, if command.starts_with("simulate") { 1 } else { names.len() }, "{printed}");
    }
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn a_command_that_is_killed_at_any_time_and_called_again_leaves_what_an_undisturbed_one_leaves() {
    let mut random = Random(21);
    let (mut killed, kills) = (0, cases("PNEUDRIVE_KILLS", 50) / LEAVE.len() as u32 + 1);
    for (command, ..) in LEAVE {
        let folder = to_read();
        let begun = Instant::now();
        ok(folder.path(), command);
        let (lasted, undisturbed) = (begun.elapsed(), tree(folder.path()));
        let folder = to_read();
        for _ in 0..kills {
            let mut program = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
            program.current_dir(folder.path()).args(command.split_whitespace());
            let mut program = program.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs");
            // Files are written in the last part of its time.
            let share = 0.3 + 0.8 * random.below(1000) as f64 / 1000.0;
            std::thread::sleep(lasted.mul_f64(share));
            program.kill().expect("it was started");
            killed += u32::from(program.wait().expect("it was started").code().is_none());
        }
        ok(folder.path(), command);
        assert_eq!(tree(folder.path()), undisturbed, "{command}");
    }
    assert!(killed > 0, "no program was killed before its end");
    println!("{killed} programs killed; no file of theirs is left");
}

/// Once a pipe was waited at for ever, and a link followed to somebody else's file, which was emptied.
#[cfg(unix)]
#[test]
fn a_part_file_that_is_a_pipe_or_a_link_is_refused_and_what_the_link_leads_to_stays() {
    let rig = virtual_rig("servo-b-tuned");
    let folder = folder();
    ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=0.1 --port {}", rig.port()));
    let mut client = Client::connect(rig.port()).expect("a rig");
    let part = format!("TARGET-{:08x}.part", client.record_head().expect("a record").crc32);
    drop(client);
    let (part, mine) = (folder.path().join(part), folder.path().join("mine"));
    fs::write(&mine, "mine").expect("written");
    let refused = |what: &str| {
        let printed = transcript(folder.path(), &format!("record --port {}", rig.port()));
        assert!(
            printed.contains("it is not a regular file") && printed.ends_with("= 1"),
            "{what}: {printed}"
        );
        fs::remove_file(&part).expect("there");
    };
    std::os::unix::fs::symlink(&mine, &part).expect("a link");
    refused("a link");
    assert!(Command::new("mkfifo").arg(&part).status().expect("mkfifo").success());
    refused("a pipe");
    assert_eq!(fs::read_to_string(&mine).expect("there"), "mine");
    ok(folder.path(), &format!("record --port {}", rig.port()));
    assert!(files(folder.path(), ".part").is_empty());
}
