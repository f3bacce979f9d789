//! TARGET files that were written by earlier versions stay readable. Add one with each version that changes
//! the format or the parameters; never change one.

mod program;

use std::path::PathBuf;

use pneudrive_evaluate::replay::replay;
use pneudrive_records::target::TargetFile;

/// File, samples, index of the first, parameters in its header.
const FILES: [(&str, usize, i32, usize); 6] = [
    // By the first version that recorded (966ae64), over protocol version 1.
    ("TARGET-1-first.DAT", 79, -2, 29),
    // By the first version with protocol version 3.
    ("TARGET-1-protocol-3.DAT", 77, 0, 54),
    // With protocol version 4: its first move comes late, and the setpoint is 0 until then.
    ("TARGET-1-protocol-4.DAT", 77, 0, 54),
    // The first format whose CRC covers the header.
    ("TARGET-2.DAT", 77, 0, 55),
    // A lost encoder while the valve is open by less than half, which trips a later controller within the record.
    ("TARGET-2-lost-encoder.DAT", 251, 0, 55),
    // Moves that end in the dead band and at the forced exit.
    ("TARGET-2-exits.DAT", 126, 0, 55),
];

#[test]
fn files_of_every_version_are_read_replayed_and_written_again_as_they_are() {
    for (name, samples, first_index, parameters) in FILES {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name);
        let file = TargetFile::read(&path).unwrap_or_else(|error| panic!("{error:#}"));
        assert_eq!((file.samples.len(), file.samples[0].0), (samples, first_index), "{name}");
        let in_header = file.header.iter().filter(|(key, _)| key.starts_with("param.")).count();
        assert_eq!(in_header, parameters, "{name}");
        assert_eq!(file.to_text(), std::fs::read_to_string(&path).expect("there"), "{name}");
        let replay = replay(&file).unwrap_or_else(|error| panic!("{name}: {error:#}"));
        assert_eq!(replay.first, None, "{name}: the commands are as recorded");
    }
}

/// Without a CRC, and with the first ones.
#[test]
fn streams_of_every_version_are_read_and_replayed() {
    for name in ["STREAM-1.txt", "STREAM-2.txt"] {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name);
        let file = TargetFile::read(&path).unwrap_or_else(|error| panic!("{error:#}"));
        assert!(file.is_streamed() && file.samples.len() == 77, "{name}");
        let replay = replay(&file).unwrap_or_else(|error| panic!("{name}: {error:#}"));
        assert_eq!(replay.first, None, "{name}: the commands are as recorded");
    }
}

/// What the CRC of an older file does not cover is told to whoever uses it.
#[test]
fn older_files_are_read_with_a_note_of_what_nothing_covers() {
    for (name, note) in [
        ("TARGET-1-protocol-4.DAT", Some("it is of format 1, whose CRC covers only the samples")),
        ("TARGET-2.DAT", None),
        ("STREAM-1.txt", Some("it is a stream of format 1, which has no CRC")),
        ("STREAM-2.txt", None),
    ] {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
        let printed = program::transcript(&folder, &format!("replay {name}"));
        assert!(printed.ends_with("= 0"), "{printed}");
        match note {
            Some(note) => assert!(printed.contains(&format!("! note: {name}: {note}")), "{printed}"),
            None => assert!(!printed.contains("CRC"), "{printed}"),
        }
    }
}
