//! The plant bus over two pipes in the emulator's folder, by semihosting: the processor stands still
//! until the emulator has read or written.

use core::ffi::CStr;
use core::fmt;

use pneudrive_app::plant_bus::{HELLO, Inputs, Outputs, Tempo, with_request_ticks};
use semihosting::fs::File;
use semihosting::io::{self, Read, Write};

/// From the plant to the board.
const INPUTS: &CStr = c"inputs";
/// From the board to the plant.
const OUTPUTS: &CStr = c"outputs";

/// Why the bus cannot go on.
#[derive(Debug)]
pub enum Error {
    /// A pipe is broken.
    Pipe(io::Error),
    /// The other side has another version of the bus.
    Version(u8),
}

impl From<io::Error> for Error {
    fn from(error: io::Error) -> Error {
        Error::Pipe(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Pipe(error) => write!(f, "a pipe is broken ({error})"),
            Error::Version(version) => {
                write!(f, "the plant speaks version {version}, this image {}: build it again", HELLO[3])
            }
        }
    }
}

/// The board's end of the bus.
pub struct PlantBus {
    inputs: File,
    outputs: File,
}

impl PlantBus {
    /// Opens the pipes and exchanges hellos.
    pub fn open() -> Result<PlantBus, Error> {
        let mut bus = PlantBus { outputs: File::create(OUTPUTS)?, inputs: File::open(INPUTS)? };
        bus.outputs.write_all(&HELLO)?;
        match bus.hello()? {
            HELLO => Ok(bus),
            hello => Err(Error::Version(hello[3])),
        }
    }

    /// The plant's hello, behind the answer to what was said before a reset: that may be in the pipe still.
    fn hello(&mut self) -> Result<[u8; HELLO.len()], Error> {
        let mut hello = [0; HELLO.len()];
        self.inputs.read_exact(&mut hello)?;
        for _ in 0..Inputs::BYTES {
            if hello[..3] == HELLO[..3] {
                break;
            }
            hello.rotate_left(1);
            self.inputs.read_exact(&mut hello[3..])?;
        }
        Ok(hello)
    }

    /// One turn of each side, with the ticks of the longest part of a request; None once the plant has gone.
    pub fn exchange(&mut self, outputs: Outputs, request: u32) -> Result<Option<(Inputs, Tempo)>, Error> {
        let mut bytes = outputs.to_bytes();
        with_request_ticks(&mut bytes, request);
        self.outputs.write_all(&bytes)?;
        let mut bytes = [0; Inputs::BYTES];
        match self.inputs.read_exact(&mut bytes) {
            Ok(()) => Ok(Some((Inputs::from_bytes(bytes), Tempo::of(&bytes)))),
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
            Err(error) => Err(error.into()),
        }
    }
}

/// Null and disabled, from wherever the program is; as far as the pipe still takes it.
pub fn switch_off() {
    if let Ok(mut outputs) = File::create(OUTPUTS) {
        let _ = outputs.write_all(&Outputs::OFF.to_bytes());
    }
}
