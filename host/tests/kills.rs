//! Either side is killed at any byte of a `record`: what is left is never a broken TARGET file, and the next
//! call goes on to the whole record.
//!
//! Fifty kills each, or as many as `PNEUDRIVE_KILLS` says (`cargo xtask soak-link`).

mod program;
mod simulated_link;

use std::fs;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};

use pneudrive::command::record::record;
use pneudrive::target::TargetFile;
use pneudrive_protocol::RecordedSample;

use program::{folder, ok, transcript, virtual_rig};
use simulated_link::{Random, SimulatedRig, any_samples, cases};

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
    files.sort();
    files
}

fn samples_of(path: &Path) -> Vec<RecordedSample> {
    TargetFile::read(path).expect("a whole file").samples.into_iter().map(|(_, sample)| sample).collect()
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
