//! TARGET files that were written by earlier versions stay readable. Add one with each version that changes
//! the format or the parameters; never change one.

use std::path::PathBuf;

use pneudrive::replay::replay;
use pneudrive::target::TargetFile;

/// File, samples, index of the first, parameters in its header.
const FILES: [(&str, usize, i32, usize); 3] = [
    // By the first version that recorded (966ae64), over protocol version 1.
    ("TARGET-1-first.DAT", 79, -2, 29),
    // By the first version with protocol version 3.
    ("TARGET-1-protocol-3.DAT", 77, 0, 54),
    // With protocol version 4: its first move comes late, and the setpoint is 0 until then.
    ("TARGET-1-protocol-4.DAT", 77, 0, 54),
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
