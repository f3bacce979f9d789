//! Replaces the files of a run together or not at all, however the program ends.
//!
//! ```text
//! stage    .pneudrive-next-PID/   the new files, on the disk
//! commit   .pneudrive-next/       by one rename: from here on the new run is valid
//! place    each file moves into the folder; files of the old run that the new one does not have are removed
//! ```
//!
//! If a program ends before it has placed the files, the next one that writes or reads the folder does. Programs that
//! write at the same time wait for each other.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::{BAND, PAGE, RUN, TRACE};
use crate::whole_file::{behind_links, may_run, own_number, put, sync_folder, write_new};

/// Every file that a run may have in its folder.
const FILES: [&str; 4] = [TRACE, BAND, RUN, PAGE];

/// The set that is committed and not yet placed.
const NEXT: &str = ".pneudrive-next";

/// A new set of files for a folder.
#[derive(Debug)]
pub struct Replacement<'a> {
    folder: &'a Path,
    staged: PathBuf,
    committed: bool,
}

impl<'a> Replacement<'a> {
    /// Begins a set for a folder, which is created if needed.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn begin(folder: &'a Path) -> Result<Replacement<'a>> {
        let staged = folder.join(format!("{NEXT}-{}", own_number()));
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        if let Some(printed) = settle(folder)? {
            log::info!("{printed}");
        }
        remove(&staged)?;
        fs::create_dir(&staged)
            .with_context(|| format!("cannot write into the folder {}", folder.display()))?;
        Ok(Replacement { folder, staged, committed: false })
    }

    /// Adds a file, one of [`FILES`].
    ///
    /// # Errors
    /// When the disk does not take it.
    pub fn add(&mut self, name: &str, pieces: &[&[u8]]) -> Result<()> {
        debug_assert!(FILES.contains(&name));
        write_new(&self.staged.join(name), pieces)
            .with_context(|| format!("cannot write {}", self.folder.join(name).display()))
    }

    /// Makes the new set valid, and places it.
    ///
    /// # Errors
    /// When it cannot be placed: then the folder holds the old set, or the new one is placed by the next program.
    pub fn commit(mut self) -> Result<()> {
        let _lock = lock(self.folder)?;
        place(self.folder)?;
        sync_folder(&self.staged);
        fs::rename(&self.staged, self.folder.join(NEXT))
            .with_context(|| format!("cannot write into the folder {}", self.folder.display()))?;
        self.committed = true;
        sync_folder(self.folder);
        place(self.folder)
    }
}

impl Drop for Replacement<'_> {
    fn drop(&mut self) {
        if !self.committed {
            let _ = fs::remove_dir_all(&self.staged);
        }
    }
}

/// Completes the replacement of a folder's files: places the committed set of a killed program, and removes sets that
/// were not committed. Returns a note on that, if anything was done.
///
/// # Errors
/// When the folder needs to be written to and cannot be.
pub fn settle(folder: &Path) -> Result<Option<String>> {
    let left = leftovers(folder);
    if left.is_empty() {
        return Ok(None);
    }
    let _lock = lock(folder)?;
    let committed = folder.join(NEXT).exists();
    place(folder)?;
    // Under the lock no other program commits; the staged set of a running program stays.
    let dead = leftovers(folder).into_iter().filter(|path| !is_of_a_running_program(path));
    let removed = dead.map(|path| remove(&path)).collect::<Result<Vec<()>>>()?.len();
    Ok(match (committed, removed) {
        (true, _) => {
            Some(format!("{}: finished writing the run of an interrupted program", folder.display()))
        }
        (false, 0) => None,
        (false, _) => {
            Some(format!("{}: removed the unfinished run of an interrupted program", folder.display()))
        }
    })
}

fn leftovers(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(NEXT));
    ours.map(|entry| entry.path()).collect()
}

/// Whether the program whose number is in the name of a staged set may still be running.
fn is_of_a_running_program(staged: &Path) -> bool {
    let number = staged.to_string_lossy().rsplit_once('-').and_then(|(_, pid)| pid.parse::<u32>().ok());
    number.is_some_and(|number| may_run(number, staged))
}

/// Moves a file in the place of another one, whose link and mode stay.
fn move_over(new: &Path, path: &Path) -> io::Result<()> {
    let path = behind_links(path)?;
    if let (Ok(there), true) = (fs::metadata(&path), new.exists()) {
        fs::set_permissions(new, there.permissions())?;
    }
    match fs::rename(new, &path) {
        // The link leads to another disk.
        Err(error) if error.kind() == ErrorKind::CrossesDevices => {
            put(&path, &fs::read(new)?).map_err(io::Error::other)?;
            fs::remove_file(new)
        }
        done => done,
    }
}

/// Moves the committed files into the folder.
fn place(folder: &Path) -> Result<()> {
    let next = folder.join(NEXT);
    if !next.exists() {
        return Ok(());
    }
    // Files that have left the set have been placed, so the old run's other files are removed first.
    let marked = next.join(PLACING);
    if !marked.exists() {
        for name in FILES.into_iter().filter(|name| !next.join(name).exists()) {
            remove(&folder.join(name))?;
        }
        File::create(&marked).with_context(|| marked.display().to_string())?;
    }
    for name in FILES {
        match move_over(&next.join(name), &folder.join(name)) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(error).with_context(|| format!("cannot write {}", folder.join(name).display()));
            }
            _ => {}
        }
    }
    sync_folder(folder);
    remove(&next)
}

/// Marks a committed set whose removals are done.
const PLACING: &str = "placing";

fn remove(path: &Path) -> Result<()> {
    let is_folder = fs::symlink_metadata(path).is_ok_and(|data| data.is_dir());
    let removed = if is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    match removed {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", path.display()))
        }
        _ => Ok(()),
    }
}

/// Waits until no other program changes the folder. The lock is held as long as the returned file lives.
fn lock(folder: &Path) -> Result<Option<File>> {
    // Only Unix opens a folder as a file.
    if !cfg!(unix) {
        return Ok(None);
    }
    let file = File::open(folder).with_context(|| folder.display().to_string())?;
    file.lock().with_context(|| format!("cannot lock {}", folder.display()))?;
    Ok(Some(file))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        let mut names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    fn replace(folder: &Path, files: &[(&str, &str)]) {
        let mut set = Replacement::begin(folder).expect("begun");
        files.iter().for_each(|(name, text)| set.add(name, &[text.as_bytes()]).expect("written"));
        set.commit().expect("placed");
    }

    #[test]
    fn a_new_set_takes_the_place_of_the_old_one_and_no_file_of_it_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("mine.txt"), "mine").expect("written");
        replace(folder.path(), &[("trace.csv", "old"), ("band.csv", "old"), ("run.json", "old")]);
        replace(folder.path(), &[("trace.csv", "new"), ("run.json", "new")]);
        assert_eq!(names(folder.path()), ["mine.txt", "run.json", "trace.csv"]);
        assert_eq!(fs::read_to_string(folder.path().join("run.json")).expect("there"), "new");
    }

    /// Whatever was placed before the program was killed, the rest follows.
    #[test]
    fn a_set_that_was_committed_is_placed_by_the_next_program_from_wherever_it_stopped() {
        for placed in 0..4 {
            let folder = tempfile::tempdir().expect("a folder");
            replace(folder.path(), &[("trace.csv", "old"), ("band.csv", "old"), ("run.json", "old")]);
            let next = folder.path().join(NEXT);
            fs::create_dir(&next).expect("made");
            let new = ["trace.csv", "run.json"];
            new.iter().for_each(|name| fs::write(next.join(name), "new").expect("written"));
            if placed > 0 {
                fs::remove_file(folder.path().join("band.csv")).expect("removed first");
                fs::write(next.join(PLACING), "").expect("marked");
            }
            for name in new.iter().take(usize::max(placed, 1) - 1) {
                fs::rename(next.join(name), folder.path().join(name)).expect("placed");
            }
            let printed = settle(folder.path()).expect("settled");
            assert!(printed.is_some_and(|printed| printed.contains("finished")), "{placed}");
            assert_eq!(names(folder.path()), ["run.json", "trace.csv"], "{placed}");
            for name in new {
                assert_eq!(fs::read_to_string(folder.path().join(name)).expect("there"), "new", "{placed}");
            }
            assert_eq!(settle(folder.path()).expect("settled"), None);
        }
    }

    #[test]
    fn a_set_that_was_not_committed_is_removed_and_that_of_a_running_program_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        replace(folder.path(), &[("trace.csv", "old"), ("run.json", "old")]);
        let own = Replacement::begin(folder.path()).expect("begun");
        // No system has processes with such numbers.
        fs::create_dir(folder.path().join(format!("{NEXT}-4294967295"))).expect("made");
        let printed = settle(folder.path()).expect("settled");
        if cfg!(target_os = "linux") {
            assert!(printed.is_some_and(|printed| printed.contains("removed")), "of a program that is gone");
            assert_eq!(names(folder.path()).len(), 3, "the run, and the set on its way");
        }
        drop(own);
        assert!(!names(folder.path()).iter().any(|name| *name == format!("{NEXT}-{}", std::process::id())));
        assert_eq!(fs::read_to_string(folder.path().join("run.json")).expect("there"), "old");
    }
}
