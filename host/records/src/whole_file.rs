//! Files that are written whole or not at all, even if the program is killed or the power fails.
//!
//! ```text
//! stage    .NAME.PID.partial   beside the file: written, and brought to the disk
//! place    NAME                by one rename; the folder is brought to the disk, too
//! ```
//!
//! A file that a killed program has staged is removed, with a note, by the next program that writes the same file.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// The end of the name of a staged file.
const ENDING: &str = ".partial";

/// Writes a file whole or not at all. A device or a pipe is written to, not replaced.
///
/// # Errors
/// When it cannot be written.
pub fn put(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
    let pieces: &[&[u8]] = &[content.as_ref()];
    let written = match is_device(path) {
        true => File::options().write(true).open(path).and_then(|mut device| write(&mut device, pieces)),
        false => replace(path, pieces),
    };
    written.with_context(|| format!("cannot write {}", path.display()))
}

/// Whether a path is neither a file nor a folder.
pub fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

fn replace(path: &Path, pieces: &[&[u8]]) -> io::Result<()> {
    let path = &behind_links(path)?;
    let name = path.file_name().ok_or(ErrorKind::InvalidInput)?;
    let folder = folder_of(path);
    let staged = Staged::write(folder, name, pieces)?;
    if let Ok(there) = fs::metadata(path) {
        fs::set_permissions(staged.path(), there.permissions())?;
    }
    fs::rename(staged.path(), path)?;
    sync_folder(folder);
    Ok(())
}

/// The file that a link leads to, however many there are: the link stays, and its file is replaced.
pub(crate) fn behind_links(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MAX_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = folder_of(&path).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("its links lead to each other"))
}

/// The folder that a file is in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn write(file: &mut File, pieces: &[&[u8]]) -> io::Result<()> {
    pieces.iter().try_for_each(|piece| file.write_all(piece))
}

/// Writes a new file of this program alone, and brings it to the disk; nothing is left of one that cannot be completed.
///
/// # Errors
/// When the disk does not accept it.
pub(crate) fn write_new(path: &Path, pieces: &[&[u8]]) -> io::Result<()> {
    // A file of this name is of an earlier program with our number, or a trap: a link is not followed.
    let _ = fs::remove_file(path);
    let mut file = File::create_new(path)?;
    let written = write(&mut file, pieces).and_then(|()| file.sync_all());
    written.inspect_err(|_| {
        let _ = fs::remove_file(path);
    })
}

/// The process number of this program, which is part of the names of staged files. On a system without one (wasm),
/// nothing can be staged either.
pub fn own_number() -> u32 {
    if cfg!(target_family = "wasm") { 0 } else { std::process::id() }
}

/// A file that is complete and on the disk, and does not have its name yet. It is removed if it is dropped before.
#[derive(Debug)]
pub struct Staged {
    path: PathBuf,
}

impl Staged {
    /// Stages the content of the file of that name in a folder.
    ///
    /// # Errors
    /// When the disk does not accept it.
    pub fn write(folder: &Path, name: impl AsRef<OsStr>, pieces: &[&[u8]]) -> io::Result<Staged> {
        let prefix = format!(".{}.", name.as_ref().to_string_lossy());
        remove_leftovers(folder, &prefix);
        let path = folder.join(format!("{prefix}{}{ENDING}", own_number()));
        write_new(&path, pieces)?;
        Ok(Staged { path })
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // If it was placed, it is gone already.
        let _ = fs::remove_file(&self.path);
    }
}

/// Removes the files that programs have staged for this one and that no longer run.
fn remove_leftovers(folder: &Path, prefix: &str) {
    let number = |name: &str| name.strip_prefix(prefix)?.strip_suffix(ENDING)?.parse::<u32>().ok();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let Some(number) = number(&entry.file_name().to_string_lossy()) else { continue };
        if !may_run(number, &entry.path()) && fs::remove_file(entry.path()).is_ok() {
            log::info!("removed {}, left by an interrupted program", entry.path().display());
        }
    }
}

/// Whether the program with this number, which has staged a file, may still be running. Where the system does not say,
/// the program of a file less than an hour old counts as running.
pub fn may_run(number: u32, staged: &Path) -> bool {
    if cfg!(target_os = "linux") {
        return Path::new(&format!("/proc/{number}")).exists();
    }
    let age = fs::metadata(staged).and_then(|data| data.modified()).ok().and_then(|then| then.elapsed().ok());
    age.is_none_or(|age| age.as_secs() < 3600)
}

/// Brings the names in a folder to the disk, if the system can.
pub fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|file| file.sync_all());
    }
}

/// Opens a file to read and append, or creates it. It must be a regular file: a link could lead to another user's file,
/// and a pipe has no end.
///
/// # Errors
/// When it is not a regular file, or cannot be opened.
pub fn open_to_add(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.read(true).append(true).create(true);
    #[cfg(unix)]
    {
        use nix::fcntl::OFlag;
        use std::os::unix::fs::OpenOptionsExt;
        // Without waiting for the other end of a pipe.
        options.custom_flags((OFlag::O_NOFOLLOW | OFlag::O_NONBLOCK).bits());
    }
    let opened = options.open(path);
    match &opened {
        Ok(file) if file.metadata()?.is_file() => opened,
        Err(_) if fs::symlink_metadata(path).is_ok_and(|there| there.is_file()) => opened,
        Err(error) if error.kind() == ErrorKind::NotFound => opened,
        Err(_) if fs::symlink_metadata(path).is_err() => opened,
        _ => Err(io::Error::new(
            ErrorKind::InvalidInput,
            "it is not a regular file, but a link, a pipe, a device or a folder; move it away",
        )),
    }
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

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
        assert!(made.success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe)
        });
        put(&pipe, "text").expect("written");
        assert_eq!(reader.join().expect("a reader").expect("text"), "text");
        assert!(!fs::metadata(&pipe).expect("there").is_file());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_keeps_its_link_and_its_mode_when_it_is_replaced() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        fs::create_dir(place("shared")).expect("a folder");
        fs::write(place("shared/mine.toml"), "old").expect("written");
        fs::set_permissions(place("shared/mine.toml"), fs::Permissions::from_mode(0o600)).expect("a mode");
        symlink("shared/mine.toml", place("link")).expect("a link");
        symlink("link", place("mine.toml")).expect("a link");
        put(&place("mine.toml"), "new").expect("written");
        assert!(fs::symlink_metadata(place("mine.toml")).expect("there").is_symlink());
        assert_eq!(fs::read_to_string(place("shared/mine.toml")).expect("there"), "new");
        let mode = fs::metadata(place("shared/mine.toml")).expect("there").permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        symlink("nowhere.toml", place("dangling")).expect("a link");
        put(&place("dangling"), "new").expect("written");
        assert_eq!(fs::read_to_string(place("nowhere.toml")).expect("there"), "new");
        symlink("round", place("round")).expect("a link");
        let told = format!("{:#}", put(&place("round"), "new").expect_err("no end"));
        assert!(told.ends_with("its links lead to each other"), "{told}");
    }

    #[test]
    fn a_file_that_cannot_be_placed_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir_all(folder.path().join("page.html/inside")).expect("a folder in its place");
        let error = put(&folder.path().join("page.html"), "text").expect_err("a folder is there");
        assert!(error.to_string().starts_with("cannot write "), "{error}");
        assert_eq!(names(folder.path()), ["page.html"], "the folder alone");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_killed_program_has_staged_is_removed_and_that_of_a_running_one_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let stay = [".page.html.1.partial", ".other.html.4294967295.partial", ".page.html.mine.partial"];
        for name in stay.into_iter().chain([".page.html.4294967295.partial"]) {
            fs::write(folder.path().join(name), "half").expect("written");
        }
        put(&folder.path().join("page.html"), "text").expect("written");
        let mut expected: Vec<&str> = stay.into_iter().chain(["page.html"]).collect();
        expected.sort_unstable();
        assert_eq!(names(folder.path()), expected);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_place_of_a_staged_file_is_not_followed() {
        let folder = tempfile::tempdir().expect("a folder");
        let mine = folder.path().join("mine");
        fs::write(&mine, "mine").expect("written");
        let trap = folder.path().join(format!(".page.html.{}.partial", std::process::id()));
        std::os::unix::fs::symlink(&mine, trap).expect("a link");
        put(&folder.path().join("page.html"), "text").expect("written");
        assert_eq!(fs::read_to_string(&mine).expect("there"), "mine");
        assert_eq!(names(folder.path()), ["mine", "page.html"]);
    }

    #[cfg(unix)]
    #[test]
    fn only_a_plain_file_is_added_to() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        fs::write(place("mine"), "mine").expect("written");
        std::os::unix::fs::symlink(place("mine"), place("link")).expect("a link");
        std::os::unix::fs::symlink(place("nowhere"), place("dangling")).expect("a link");
        fs::create_dir(place("folder")).expect("a folder");
        let made = std::process::Command::new("mkfifo").arg(place("pipe")).status().expect("mkfifo");
        assert!(made.success());
        for name in ["link", "dangling", "folder", "pipe"] {
            let error = open_to_add(&place(name)).expect_err("no plain file");
            assert!(error.to_string().contains("it is not a regular file"), "{name}: {error}");
        }
        open_to_add(&place("mine")).expect("a file").write_all(b", more").expect("added");
        assert_eq!(fs::read_to_string(place("mine")).expect("there"), "mine, more");
        assert!(open_to_add(&place("new")).is_ok() && !place("nowhere").exists());
        assert_eq!(open_to_add(&place("none/new")).expect_err("no folder").kind(), ErrorKind::NotFound);
    }
}
