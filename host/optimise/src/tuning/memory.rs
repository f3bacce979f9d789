//! What a search has computed so far, in a file: an interrupted search goes on from there, to the result that it would have had.
//!
//! ```text
//! pneudrive-tune 1
//! task 0123456789abcdef                         which task it is of
//! 0123456789abcdef 3f50624dd2f1a9fc:2:3 ...     what was asked, and of each candidate: mean cost (bits), place or -, runs
//! ```
//!
//! The file is replaced as a whole after each generation, so a kill loses one generation at most.

use std::collections::BTreeMap;
use std::fmt::{Debug, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, Result, bail};
use crc::{CRC_64_XZ, Crc};
use pneudrive_records::own_file::refuse_to_replace;
use pneudrive_records::whole_file::put;

use super::Task;
use super::cost::Cost;

/// The first line of the file.
const MARK: &str = "pneudrive-tune 1\n";

/// Its name in the folder of a result.
pub const NAME: &str = "tune.state";

/// The generations that are known already, by what was asked.
#[derive(Debug, Default)]
pub struct Memory {
    /// The file; None: nothing is stored.
    file: Option<PathBuf>,
    task: String,
    known: Mutex<BTreeMap<u64, Vec<Cost>>>,
}

impl Memory {
    /// In a folder, with what an interrupted search of the same task has left there.
    ///
    /// # Errors
    /// When the file there is of another task, or not ours.
    pub fn open(folder: &Path, task: &Task) -> Result<Memory> {
        let path = folder.join(NAME);
        refuse_to_replace(&path, MARK)?;
        let text = if path.exists() { std::fs::read_to_string(&path)? } else { String::new() };
        let own = format!("task {:016x}", digest(&(task, env!("CARGO_PKG_VERSION"))));
        let mut lines = text.lines().skip(1);
        if lines.next().is_some_and(|there| there != own) {
            bail!(
                "{} is of an interrupted search of another task, or by another version; delete it, or choose another folder (--out)",
                path.display()
            );
        }
        let known = lines.map(read).collect::<Option<_>>();
        let known = known.with_context(|| format!("{} is damaged; delete it", path.display()))?;
        Ok(Memory { file: Some(path), task: own, known: Mutex::new(known) })
    }

    /// Number of generations that are known already.
    #[must_use]
    pub fn generations(&self) -> usize {
        self.lock().len()
    }

    /// Removes the file once the search is over.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn end(self) -> Result<()> {
        match self.file.filter(|path| path.exists()) {
            Some(path) => {
                std::fs::remove_file(&path).with_context(|| format!("cannot remove {}", path.display()))
            }
            None => Ok(()),
        }
    }

    /// The costs that are stored for a question, if there are any.
    pub(super) fn recalled(&self, question: &impl Debug) -> Option<Vec<Cost>> {
        self.lock().get(&digest(question)).cloned()
    }

    /// Stores the costs for a question. A file that cannot be written costs no result.
    pub(super) fn keep(&self, question: &impl Debug, costs: &[Cost]) {
        let Some(path) = &self.file else { return };
        let mut known = self.lock();
        known.insert(digest(question), costs.to_vec());
        let lines = known.iter().map(|(question, costs)| line(*question, costs));
        let text = format!("{MARK}{}\n{}", self.task, lines.collect::<String>());
        if let Err(error) = put(path, &text) {
            log::warn!("an interrupted search could not go on from here: {error:#}");
        }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<u64, Vec<Cost>>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Numbers are written so that they read back in every bit.
fn digest(of: &impl Debug) -> u64 {
    Crc::<u64>::new(&CRC_64_XZ).checksum(format!("{of:?}").as_bytes())
}

fn line(question: u64, costs: &[Cost]) -> String {
    let mut line = format!("{question:016x}");
    for Cost { mean, given_up_at, runs } in costs {
        let place = given_up_at.map_or_else(|| "-".to_owned(), |place| place.to_string());
        let _ = write!(line, " {:016x}:{place}:{runs}", mean.to_bits());
    }
    line + "\n"
}

fn read(line: &str) -> Option<(u64, Vec<Cost>)> {
    let mut words = line.split(' ');
    let question = u64::from_str_radix(words.next()?, 16).ok()?;
    let cost = |word: &str| {
        let [mean, place, runs] = word.split(':').collect::<Vec<_>>().try_into().ok()?;
        Some(Cost {
            mean: f64::from_bits(u64::from_str_radix(mean, 16).ok()?),
            given_up_at: if place == "-" { None } else { Some(place.parse().ok()?) },
            runs: runs.parse().ok()?,
        })
    };
    Some((question, words.map(cost).collect::<Option<_>>()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COSTS: [Cost; 2] = [
        Cost { mean: 0.1 + 0.2, given_up_at: None, runs: 21 },
        Cost { mean: f64::INFINITY, given_up_at: Some(3), runs: 4 },
    ];

    #[test]
    fn a_line_reads_back_in_every_bit_and_a_damaged_one_does_not() {
        let written = line(7, &COSTS);
        let (question, costs) = read(written.trim_end()).expect("a line");
        assert_eq!(question, 7);
        assert_eq!(costs, COSTS);
        for end in 17..written.len() - 2 {
            assert!(read(&written[..end]).is_none_or(|(_, costs)| costs != COSTS), "{end}");
        }
        assert!(read("0000000000000007 3f:0").is_none() && read("x").is_none());
    }

    #[test]
    fn what_is_kept_nowhere_is_known_while_the_search_lasts_only() {
        let memory = Memory::default();
        memory.keep(&"a", &COSTS);
        assert_eq!((memory.recalled(&"a"), memory.generations()), (None, 0));
    }
}
