//! A powered board with its line, on a separate thread.

use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use nix::time::{ClockId, clock_gettime};
use pneudrive_sim::Rig;

use crate::bench::PinBench;
use crate::board::{Board, Stop};
use crate::image::Image;
use crate::line::Line;
use crate::peripheral::flash;
use crate::processor::Processor;
use crate::time::{Corner, MICROSECOND, MILLISECOND, Ticks};

/// How far the board goes between two looks at the line.
const TURN: Ticks = MILLISECOND;

/// A run may be this far ahead of a silent host: well below the silence that trips a drive. From there on it runs
/// slower than the wall clock by as much, as the host may be waiting for the PC.
const AHEAD: Ticks = 300 * MILLISECOND;
const SLOWER: u32 = 4;

/// Longest rest between two looks at the line.
const REST: Duration = Duration::from_micros(500);

/// Something that is done to the machine, on its thread.
pub type Job = Box<dyn FnOnce(&mut Machine) + Send>;

/// A board that has power, or had.
pub struct Machine {
    image: Image,
    rig: Rig,
    corner: Corner,
    processor: Processor,
    line: Line,
    /// The power is there.
    powered: bool,
    /// When the last whole request of the host came, by both clocks: one that noise has hit ends no silence.
    heard: (Ticks, Instant),
    /// Every byte of the host whose number is a multiple of this is hit by noise; None: none.
    noise: Option<u64>,
    bytes: u64,
    /// Nothing of what the host says comes through.
    cut: bool,
    /// The job to do once this many samples have been taken.
    due: Option<(u64, Job)>,
    /// When that was done.
    pub injected: Option<Ticks>,
    /// What the board and its plant have cost.
    pub cost: Cost,
}

/// What runs have cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Samples of the plant.
    pub samples: u64,
    /// Time of the PC's processor for them, with what the board did meanwhile.
    pub took: Duration,
}

impl Machine {
    /// A new board, with the image flashed and nothing else, before its first instruction.
    ///
    /// # Errors
    /// When the plant or the emulator cannot be set up.
    pub fn new(image: Image, rig: &Rig, corner: Corner, line: Line) -> Result<Machine> {
        let processor = powered(&image, rig, corner, vec![0xff; flash::BYTES])?;
        Ok(Machine {
            image,
            rig: rig.clone(),
            corner,
            processor,
            line,
            powered: true,
            heard: (0, Instant::now()),
            noise: None,
            bytes: 0,
            cut: false,
            due: None,
            injected: None,
            cost: Cost::default(),
        })
    }

    /// Takes the power away, if it is not gone yet, and gives it back: the flash is kept, the plant stands in its
    /// initial state.
    ///
    /// # Errors
    /// When the plant or the emulator cannot be set up.
    pub fn power_up(&mut self) -> Result<()> {
        let cells = self.board().flash.cells().to_vec();
        self.processor = powered(&self.image, &self.rig, self.corner, cells)?;
        self.line.hang_up();
        self.heard = (0, Instant::now());
        self.powered = true;
        Ok(())
    }

    /// The board.
    pub fn board(&self) -> std::cell::RefMut<'_, Board> {
        self.processor.board()
    }

    /// The processor goes on at an address, as after a broken pointer.
    ///
    /// # Errors
    /// When the emulator does not let it.
    pub fn jump(&mut self, address: u32) -> Result<()> {
        self.processor.jump(address)
    }

    /// Noise hits every nth byte of the host from now on; None: no byte.
    pub fn disturb(&mut self, every: Option<u64>) {
        self.noise = every;
    }

    /// The line is cut on its way to the board, or whole again.
    pub fn cut_line(&mut self, cut: bool) {
        self.cut = cut;
    }

    /// Does a job once this many samples of runs have been taken.
    pub fn inject_at(&mut self, sample: u64, job: Job) {
        self.due = Some((sample, job));
    }

    fn inject(&mut self) {
        let sampled = self.board().bench.sampled;
        if let Some((_, job)) = self.due.take_if(|(sample, _)| *sample <= sampled) {
            let now = self.board().now;
            self.injected = Some(now);
            job(self);
        }
    }

    /// Listens, goes on for a while, and talks.
    ///
    /// # Errors
    /// When the board does what no model knows, or the plant cannot be simulated.
    pub fn turn(&mut self) -> Result<()> {
        if !self.powered {
            sleep(REST);
            return Ok(());
        }
        self.inject();
        self.listen();
        if let Some(rest) = self.rest() {
            sleep(rest);
            return Ok(());
        }
        let until = self.board().now + TURN;
        let (begun, sampled) = (processor_time(), self.board().bench.sampled);
        let outcome = self.processor.run(until);
        let samples = self.board().bench.sampled - sampled;
        if samples > 0 {
            self.cost.samples += samples;
            self.cost.took += processor_time().saturating_sub(begun);
        }
        let unread = std::mem::take(&mut self.board().unread);
        self.line.say(&unread);
        match outcome {
            Ok(()) => {}
            Err(Stop::Reset(cause)) => self.processor.restart(cause)?,
            Err(Stop::Dark) => {
                self.powered = false;
                self.line.hang_up();
            }
            Err(Stop::Broken(told)) => return Err(anyhow!(told)),
        }
        Ok(())
    }

    fn listen(&mut self) {
        let mut bytes = self.line.heard();
        if self.cut {
            bytes.clear();
        }
        let mut board = self.processor.board();
        for byte in bytes {
            self.bytes += 1;
            if board.hear(byte, self.noise.is_some_and(|every| self.bytes.is_multiple_of(every))) {
                self.heard = (board.now, Instant::now());
            }
        }
    }

    /// How long the board waits for the host before it goes on; None: not at all. A run goes as fast as it can, but not
    /// so far ahead of the host that its silence would trip the drive; a board that does not move keeps the time of the
    /// wall.
    fn rest(&self) -> Option<Duration> {
        let (since, then) = self.heard;
        let board = self.board();
        let (ahead, slower) = if board.bench.lives() { (AHEAD, SLOWER) } else { (TURN, 1) };
        let board_time = Duration::from_micros((board.now - since).saturating_sub(ahead) / MICROSECOND);
        (slower * board_time)
            .checked_sub(then.elapsed())
            .filter(|rest| !rest.is_zero())
            .map(|rest| rest.min(REST))
    }
}

/// What this thread has had of the PC's processor: other programs do not count.
fn processor_time() -> Duration {
    clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).map_or(Duration::ZERO, Duration::from)
}

fn powered(image: &Image, rig: &Rig, corner: Corner, mut cells: Vec<u8>) -> Result<Processor> {
    image.flash(&mut cells);
    let bench = PinBench::new(rig).map_err(|broken| anyhow!("the plant of {}: {broken}", rig.name()))?;
    Processor::new(Board::new(cells, bench, corner))
}
