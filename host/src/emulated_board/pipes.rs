//! The two pipes of a bus between this program and the image.

use std::fs::{File, OpenOptions};
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use anyhow::Result;
use nix::fcntl::OFlag;
use nix::sys::stat::Mode;

/// This program's ends of a bus.
pub(super) struct Pipes {
    /// To the board.
    pub to_board: File,
    /// From the board.
    pub from_board: File,
    /// Writes nothing; keeps `from_board` from waiting for the emulator, or from ending before it has come.
    pub held: File,
}

impl Pipes {
    /// Makes both pipes, named as the image opens them.
    pub(super) fn make(folder: &Path, to_board: &str, from_board: &str) -> Result<Pipes> {
        let both = |name: &str| OpenOptions::new().read(true).write(true).open(folder.join(name));
        for name in [to_board, from_board] {
            nix::unistd::mkfifo(&folder.join(name), Mode::S_IRUSR | Mode::S_IWUSR)?;
        }
        let held = both(from_board)?;
        Ok(Pipes { to_board: both(to_board)?, from_board: File::open(folder.join(from_board))?, held })
    }
}

/// Takes out of a pipe what its reader has left there.
pub(super) fn drain(pipe: &PathBuf) -> Result<()> {
    let mut pipe = OpenOptions::new().read(true).custom_flags(OFlag::O_NONBLOCK.bits()).open(pipe)?;
    // It ends as empty: this program holds the other end, too.
    let _ = pipe.read_to_end(&mut Vec::new());
    Ok(())
}
