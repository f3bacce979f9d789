//! Files that users have stay readable: TARGET files, streams and run folders of version 1.
//!
//! WHAT STANDS IN tests/fixtures DOES NOT CHANGE. If a test fails, files that somebody has could no longer be read: take the
//! change back, and append instead. A new parameter is another header line, a new figure another key of run.json or column of
//! trace.csv, and files without it are read. Only what cannot be said so makes a version 2: then its reader stands beside
//! that of version 1, and its fixture beside this one.

use std::path::PathBuf;

use pneudrive_evaluate::replay::replay;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

/// The test servo-b-tuned of a tenth of a second, recorded by 0.1.0.
#[test]
fn a_target_file_of_version_1_is_read_replayed_and_written_again_as_it_is() {
    let path = fixture("TARGET-1.DAT");
    let file = TargetFile::read(&path).unwrap_or_else(|error| panic!("{error:#}"));
    assert_eq!((file.samples.len(), file.samples[0].0), (77, 0));
    let in_header = file.header.iter().filter(|(key, _)| key.starts_with("param.")).count();
    assert_eq!(in_header, 65, "what this file has, whatever the table has gained since");
    assert_eq!(file.to_text(), std::fs::read_to_string(&path).expect("there"));
    let replay = replay(&file).unwrap_or_else(|error| panic!("{error:#}"));
    assert_eq!(replay.first, None, "the commands are as recorded");
}

/// The same run, streamed.
#[test]
fn a_stream_of_version_1_is_read_and_replayed() {
    let file = TargetFile::read(&fixture("STREAM-1.txt")).unwrap_or_else(|error| panic!("{error:#}"));
    assert!(file.is_streamed() && file.samples.len() == 77);
    let replay = replay(&file).unwrap_or_else(|error| panic!("{error:#}"));
    assert_eq!(replay.first, None, "the commands are as recorded");
    assert_eq!(file.samples, TargetFile::read(&fixture("TARGET-1.DAT")).expect("whole").samples);
}

/// 31 samples of servo-b-tuned and seven perturbed runs, simulated by 0.1.0.
#[test]
fn a_run_folder_of_version_1_is_read() {
    let run = StoredRun::read(&fixture("run-1")).unwrap_or_else(|error| panic!("{error:#}"));
    assert_eq!((run.rig.as_str(), run.column("time_s").len()), ("servo-b-tuned", 31));
    let numbered = run.numbered.as_ref().expect("its number and date");
    assert_eq!((numbered.run, numbered.date.as_str()), (1, "1970-01-01T00:00:00Z"));
    assert_eq!((run.column("position_counts")[30], run.mm_per_count), (8192.0, 0.01205));
    assert!(run.band.is_some() && run.accuracy.is_some());
}

#[test]
fn a_stream_that_was_cut_is_read_with_a_note_of_what_nothing_covers() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = std::fs::read_to_string(fixture("STREAM-1.txt")).expect("there");
    let end = whole.find("# samples").expect("its end");
    for (text, note) in [(&whole[..], false), (&whole[..end], true)] {
        std::fs::write(folder.path().join("run.stream"), text).expect("written");
        let printed = crate::program::transcript(folder.path(), "replay run.stream");
        assert!(printed.ends_with("= 0"), "{printed}");
        assert_eq!(printed.contains("no checksum protects its samples"), note, "{printed}");
    }
}
