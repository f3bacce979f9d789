//! The two pipes of a bus between this program and the image.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use nix::fcntl::OFlag;
use nix::sys::stat::Mode;

use crate::plant_server::{Bus, Hello};

/// This program's ends of a bus.
pub(super) struct Pipes {
    to_board: File,
    from_board: File,
    /// The path of `to_board`.
    path: PathBuf,
}

/// Writes nothing; keeps the opening of a pipe from blocking, and the pipe from ending before the emulator has opened it.
pub(super) struct OpenEnd(#[expect(dead_code, reason = "held open, not used")] File);

impl Pipes {
    /// Makes both pipes, named as the image opens them.
    pub(super) fn make(folder: &Path, to_board: &str, from_board: &str) -> Result<(Pipes, OpenEnd)> {
        let both = |name: &str| OpenOptions::new().read(true).write(true).open(folder.join(name));
        for name in [to_board, from_board] {
            nix::unistd::mkfifo(&folder.join(name), Mode::S_IRUSR | Mode::S_IWUSR)?;
        }
        let open_end = OpenEnd(both(from_board)?);
        let (path, from_board) = (folder.join(to_board), File::open(folder.join(from_board))?);
        Ok((Pipes { to_board: both(to_board)?, from_board, path }, open_end))
    }

    /// The two ends: to the board, and from it.
    pub(super) fn ends(self) -> (File, File) {
        (self.to_board, self.from_board)
    }

    /// Fills the bytes with the next ones from the board; false once it has gone.
    pub(super) fn fill(&mut self, bytes: &mut [u8]) -> Result<bool> {
        match self.from_board.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error).context("a bus of the emulated board broke"),
        }
    }
}

impl Bus for Pipes {
    fn hello(&mut self) -> Result<Option<Hello>> {
        self.read()
    }

    fn read<const N: usize>(&mut self) -> Result<Option<[u8; N]>> {
        let mut bytes = [0; N];
        Ok(self.fill(&mut bytes)?.then_some(bytes))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        Ok(self.to_board.write_all(bytes)?)
    }

    /// Discards the bytes that the board has not read.
    fn forget(&mut self) -> Result<()> {
        let mut options = OpenOptions::new();
        let mut pipe = options.read(true).custom_flags(OFlag::O_NONBLOCK.bits()).open(&self.path)?;
        // Reading ends with an empty pipe, not a closed one, as this program holds the other end, too.
        let _ = pipe.read_to_end(&mut Vec::new());
        Ok(())
    }
}
