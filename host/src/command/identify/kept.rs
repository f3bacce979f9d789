//! What an interrupted plan has recorded: the next one of the same rig goes on behind it.
//!
//! ```text
//! pneudrive-plan 1
//! 8192                        where the plan began, counts
//! [("name", ...               all values of the rig file
//! movement\tTARGET01.DAT      a test, and its record in the same folder
//! ```

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use pneudrive_records::own_file::refuse_to_replace;
use pneudrive_records::target::TargetFile;
use pneudrive_records::whole_file::put;
use pneudrive_sim::Rig;

/// The first line.
const MARK: &str = "pneudrive-plan 1";

/// The name of the file, in the folder of the records.
const NAME: &str = "plan.state";

/// The records of a plan so far.
#[derive(Debug)]
pub(in crate::command) struct Kept {
    path: PathBuf,
    /// Where the plan began, counts.
    pub count: i32,
    rig: String,
    records: Vec<(String, String)>,
}

impl Kept {
    /// Those of an interrupted plan of this rig; without one, a plan that begins at `count`.
    pub fn open(folder: &Path, rig: &Rig, count: i32) -> Result<Kept> {
        let path = folder.join(NAME);
        refuse_to_replace(&path, MARK)?;
        let rig = format!("{:?}", rig.entries().map(|(key, value)| (key.path, value)).collect::<Vec<_>>());
        let is_there = |(_, file): &(String, String)| TargetFile::read(&folder.join(file)).is_ok();
        let there = fs::read_to_string(&path).ok().and_then(|text| read(&text, &rig));
        let there = there.filter(|(_, records)| records.iter().all(is_there));
        let (count, records) = there.unwrap_or((count, Vec::new()));
        Ok(Kept { path, count, rig, records })
    }

    /// The file that is removed to begin anew.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many tests are recorded.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// The record of a test; None if there is none that can be read.
    pub fn record(&self, test: &str) -> Option<(String, TargetFile)> {
        let (_, file) = self.records.iter().find(|(name, _)| name == test)?;
        Some((file.clone(), TargetFile::read(&self.path.with_file_name(file)).ok()?))
    }

    /// Keeps the record of a test.
    pub fn keep(&mut self, test: &str, file: &str) -> Result<()> {
        self.records.retain(|(name, _)| name != test);
        self.records.push((test.to_owned(), file.to_owned()));
        let records: String = self.records.iter().map(|(test, file)| format!("{test}\t{file}\n")).collect();
        put(&self.path, &format!("{MARK}\n{}\n{}\n{records}", self.count, self.rig))
    }

    /// The plan is over: the file goes, the records stay.
    pub fn end(self) -> Result<()> {
        match fs::remove_file(&self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            done => done.with_context(|| format!("cannot remove {}", self.path.display())),
        }
    }
}

/// Where the plan of this rig began, and its tests with their records.
fn read(text: &str, rig: &str) -> Option<(i32, Vec<(String, String)>)> {
    let mut lines = text.lines().skip(1);
    let count = lines.next()?.parse().ok()?;
    if lines.next()? != rig {
        return None;
    }
    let record = |line: &str| line.split_once('\t').map(|(test, file)| (test.to_owned(), file.to_owned()));
    Some((count, lines.map(record).collect::<Option<_>>()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: &str = include_str!("../../../tests/fixtures/TARGET-1.DAT");

    #[test]
    fn a_plan_of_another_rig_or_without_its_records_begins_anew_and_one_of_the_same_where_it_began() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = |name, count| {
            let rig = Rig::builtin(name).expect("a built-in rig");
            Kept::open(folder.path(), &rig, count).expect("a folder")
        };
        fs::write(folder.path().join("TARGET01.DAT"), RECORD).expect("written");
        let mut kept = open("press", 7);
        kept.keep("movement", "TARGET00.DAT").expect("written");
        assert_eq!(open("press", 9).len(), 0, "its record is not there");
        kept.keep("movement", "TARGET01.DAT").expect("written");
        let again = open("press", 9);
        assert_eq!((again.count, again.len()), (7, 1));
        assert!(again.record("movement").is_some() && again.record("static").is_none());
        let other = open("servo-b", 9);
        assert_eq!((other.count, other.len()), (9, 0));
        again.end().expect("removed");
        assert_eq!(open("press", 9).count, 9);
    }
}
