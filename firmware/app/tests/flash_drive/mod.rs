//! A drive with flash, on a board whose rod stands still.

use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Board, Control};
use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Config, Mode, Sample};
use pneudrive_protocol::change::{Entry, PART_BYTES};

pub type Kept = FlashStore<RamFlash, Memory>;

/// A board whose rod stands still, with flash.
pub struct FlashBoard {
    pub position: i32,
    pub now_us: u64,
    pub store: Kept,
    /// Where the spool was, in memory that a reset leaves as it is.
    pub spool: Option<SpoolLocation>,
    /// Whether its encoder may be absolute.
    pub absolute: bool,
}

fn store_on(flash: RamFlash, memory: Memory) -> Kept {
    FlashStore::take_up(flash, RamFlash::layout(), memory).expect("it fits").0
}

impl Board for FlashBoard {
    type Store = Kept;

    fn store(&mut self) -> &mut Kept {
        &mut self.store
    }
    fn name(&self) -> &'static str {
        "with flash"
    }
    fn build(&self) -> &'static str {
        "test"
    }
    fn read_sensors(&mut self, _: &Config) -> Sample {
        Sample { position: self.position, pressure_1: 2000, pressure_2: 2000, ..Sample::default() }
    }
    fn drive(&mut self, _: &Config, _: Command) {}
    fn now_us(&self) -> u64 {
        self.now_us
    }
    fn host_clock_ms(&self) -> Option<u64> {
        None
    }
    fn may_know_position(&self) -> bool {
        self.absolute
    }
    fn keep_spool(&mut self, location: SpoolLocation) {
        self.spool = Some(location);
    }
    fn kept_spool(&self) -> Option<SpoolLocation> {
        self.spool
    }
}

pub struct DriveWithFlash {
    pub control: Box<Control>,
    pub board: FlashBoard,
}

impl DriveWithFlash {
    /// A drive that is switched on, with what is in its flash.
    pub fn on(flash: RamFlash) -> DriveWithFlash {
        DriveWithFlash::after(flash, None)
    }

    /// A drive after a reset that has left this of its spool.
    pub fn after(flash: RamFlash, spool: Option<SpoolLocation>) -> DriveWithFlash {
        DriveWithFlash::with_encoder(flash, spool, false)
    }

    /// The same of a board whose encoder may be absolute, or not.
    pub fn with_encoder(flash: RamFlash, spool: Option<SpoolLocation>, absolute: bool) -> DriveWithFlash {
        let store = store_on(flash, [0; MEMORY_BYTES]);
        let board = FlashBoard { position: 100, now_us: 0, store, spool, absolute };
        let mut drive = DriveWithFlash { control: Box::default(), board };
        drive.control.take_up(&mut drive.board);
        drive
    }

    /// Reset, with its memory kept.
    pub fn reset(&self) -> DriveWithFlash {
        DriveWithFlash::with_encoder(self.board.store.flash().clone(), self.board.spool, self.board.absolute)
    }

    /// Switched off and on again.
    pub fn power_cycle(&self) -> DriveWithFlash {
        DriveWithFlash::on(self.board.store.flash().clone())
    }

    pub fn samples(&mut self, count: u32) {
        for _ in 0..count {
            self.control.on_sample(&mut self.board);
            self.control.on_output(&mut self.board);
            self.board.now_us += 1300;
        }
    }

    /// Takes a test of one step.
    pub fn take_test(&mut self, last_sample: u32, target: i32) {
        let test = Entry::Test { name: "step", last_sample, round: 0, decimation: 1, pre_trigger: 0 };
        let mut room = [0; PART_BYTES];
        let entries = [test, Entry::Move { at_sample: 0, target }];
        let change = entries.map(|entry| entry.write(&mut room).expect("room").to_vec()).concat();
        self.control.take_change(&change).expect("disarmed");
    }

    pub fn set(&mut self, id: u16, value: i32) {
        self.control.set_parameters(id, [value].into_iter()).expect("taken");
    }

    pub fn get(&self, id: u16) -> i32 {
        self.control.parameters().get(id).expect("a parameter")
    }

    pub fn mode(&self) -> Mode {
        self.control.state().supervisor.mode()
    }
}

/// A drive with a stepper that has learned an offset of 7 steps, holds its last setpoint and has its spool open.
pub fn stepper_that_has_learned() -> DriveWithFlash {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    drive.control.at_null(&mut drive.board).expect("disarmed");
    drive.set(id::STEPPER, 1);
    drive.set(id::SCALE, 1);
    drive.set(id::LEARNING_GAIN, 1);
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    drive.take_test(9, 107);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(11);
    assert_eq!(drive.mode(), Mode::Done);
    assert_ne!(drive.control.state().spool_location().steps(), 0);
    drive
}
