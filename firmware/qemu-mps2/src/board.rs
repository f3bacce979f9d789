//! The board as the application sees it: a sample that has come, a command that will go.

use pneudrive_app::Board;
use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::plant_bus::Next;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::FlashStore;
use pneudrive_controller::{Command, Config, Sample};

/// The emulated board. Its clock goes on by a period a sample: it is in lock step with the plant's.
#[derive(Debug)]
pub struct EmulatedBoard {
    sample: Sample,
    command: Command,
    begin: Option<Next>,
    now_us: u64,
    store: FlashStore<RamFlash, Memory>,
}

impl Default for EmulatedBoard {
    fn default() -> Self {
        let taken_up = FlashStore::take_up(RamFlash::default(), RamFlash::layout(), [0; MEMORY_BYTES]);
        EmulatedBoard {
            sample: Sample::default(),
            command: Command::OFF,
            begin: None,
            now_us: 0,
            store: taken_up.expect("the layout is that of this flash").0,
        }
    }
}

impl EmulatedBoard {
    /// Takes what the plant has sent.
    pub fn latch(&mut self, sample: Sample) {
        self.sample = sample;
    }

    /// What the drive stage does now.
    pub fn command(&self) -> Command {
        self.command
    }

    /// The beginning of a run, if one was asked for since the last call.
    pub fn run_begun(&mut self) -> Option<Next> {
        self.begin.take()
    }

    /// Time goes on, to the output or to the next sample.
    pub fn passes(&mut self, time_us: u32) {
        self.now_us += u64::from(time_us);
    }
}

impl Board for EmulatedBoard {
    type Store = FlashStore<RamFlash, Memory>;

    fn store(&mut self) -> &mut Self::Store {
        &mut self.store
    }

    fn name(&self) -> &'static str {
        "QEMU mps2-an386"
    }

    fn build(&self) -> &'static str {
        pneudrive_app::BUILD
    }

    fn read_sensors(&mut self, _: &Config) -> Sample {
        self.sample
    }

    fn drive(&mut self, _: &Config, command: Command) {
        self.command = command;
    }

    fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Silence means nothing here: time stands still between two samples.
    fn host_clock_ms(&self) -> Option<u64> {
        None
    }

    fn run_begins(&mut self, config: &Config) {
        let (period_us, delay_us) = (config.timing.period_us.get(), config.timing.delay_us.get());
        self.begin = Some(Next::Begin { period_us, delay_us });
    }

    fn starts_referenced(&self) -> bool {
        true
    }
}
