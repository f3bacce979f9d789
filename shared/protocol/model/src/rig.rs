//! The rig: the firmware's own control half, recorder and stored configuration on a board of the model.
//!
//! Beside them stands what the properties are judged by, which the firmware knows nothing of: who has armed the drive
//! since the reset, what each run was, and what was saved last.

use std::borrow::{Borrow, BorrowMut};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use pneudrive_app::fault_log::Event;
use pneudrive_app::move_records::MoveRecords;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::recorder::recorded;
use pneudrive_app::storage::{ConfigStore, Load};
use pneudrive_app::store::NotStored;
use pneudrive_app::{Board, Control, Recorder, Store};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Config, Mode, Parameters, Sample};
use pneudrive_protocol::RecordedSample;

use crate::flash::Flash;
use crate::mutant::Mutant;

/// Time from a sample to the next, microseconds: the default of the parameters.
const PERIOD_US: u64 = 1300;

/// Longer than the silence after which an owner is gone (`host_silence_ms`, 500 by default).
const SILENCE_MS: u64 = 501;

/// The two parameters that the hosts change: those of velocity and acceleration gain.
pub type Pair = [i32; 2];

/// The pair in these parameters.
#[must_use]
pub fn pair(parameters: &Parameters) -> Pair {
    [id::VELOCITY_GAIN, id::ACCELERATION_GAIN].map(|id| parameters.get(id).unwrap_or(0))
}

/// A recorder that states share until one of them writes to it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shared(Arc<Recorder>);

impl Borrow<Recorder> for Shared {
    fn borrow(&self) -> &Recorder {
        &self.0
    }
}

impl BorrowMut<Recorder> for Shared {
    fn borrow_mut(&mut self) -> &mut Recorder {
        Arc::make_mut(&mut self.0)
    }
}

/// The flash with the stored configuration. The fault log is left out: nothing here asks for it or depends on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    slots: ConfigStore,
    flash: Flash,
    in_parts: bool,
    /// Boots so far. That those of a board are counted through any power cut is tested where they are
    /// (`firmware/app/tests/boots.rs`).
    boot: u32,
}

impl Kept {
    fn new(flash: Flash, mutant: Option<Mutant>) -> Kept {
        let slots = ConfigStore::new(&flash, RamFlash::layout().config).expect("the layout of this flash");
        Kept { slots, flash, in_parts: mutant == Some(Mutant::SavesInParts), boot: 0 }
    }
}

impl Store for Kept {
    fn load(&mut self) -> Load {
        self.slots.load(&mut self.flash)
    }

    fn boot(&self) -> u32 {
        self.boot
    }

    fn save(&mut self, parameters: &Parameters, records: &MoveRecords) -> Result<u32, NotStored> {
        if self.in_parts {
            let mut first_part = self.load().parameters;
            let [first, _] = pair(parameters);
            first_part.set(id::VELOCITY_GAIN, first).expect("in range");
            self.slots.save(&mut self.flash, &first_part, records).map_err(|_| NotStored)?;
        }
        self.slots.save(&mut self.flash, parameters, records).map_err(|_| NotStored)
    }

    fn log(&mut self, _: u8, _: u32, _: i32, _: u64) {}

    fn event(&self, _: usize) -> Option<Event> {
        None
    }

    fn events(&self) -> usize {
        0
    }

    fn flush(&mut self) -> Result<(), NotStored> {
        Ok(())
    }
}

/// A raw pressure that a sound sensor reads.
const SOUND: i16 = 1000;

/// As far as a homing run backs off from its stop, counts: the default of the parameters.
const BACK_OFF: i32 = 400;

/// A board whose rod stands at its stop, or off it while the valve extends it. Its pressures tell the run and the sample apart, so no two records are the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bench {
    /// What is kept through a reset.
    pub(crate) kept: Kept,
    now_us: u64,
    host_clock_ms: u64,
    /// Runs begun, also those before a reset.
    runs: i16,
    sampled: i16,
    extends: bool,
}

impl Board for Bench {
    type Store = Kept;

    fn store(&mut self) -> &mut Kept {
        &mut self.kept
    }

    fn name(&self) -> &'static str {
        "model"
    }

    fn build(&self) -> &'static str {
        "model"
    }

    fn read_sensors(&mut self, _: &Config) -> Sample {
        self.sampled += 1;
        Sample {
            position: if self.extends { 100 + BACK_OFF } else { 100 },
            pressure_1: SOUND + self.runs,
            pressure_2: SOUND + self.sampled,
            spool: 7,
            home_switch: false,
        }
    }

    fn drive(&mut self, _: &Config, command: Command) {
        self.extends = command.counts > 0;
    }

    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn host_clock_ms(&self) -> Option<u64> {
        Some(self.host_clock_ms)
    }

    fn run_begins(&mut self, _: &Config) {
        self.runs += 1;
        self.sampled = 0;
    }
}

/// A run as the board has seen it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Run {
    /// Name of its test.
    pub test: String,
    /// Its samples so far.
    pub samples: Vec<RecordedSample>,
}

/// The rig.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rig {
    /// The firmware's control half.
    pub control: Control<Shared>,
    /// What it runs on.
    pub board: Bench,
    /// The host whose request has armed the drive, or taken it over, since the reset; None if it was sent before.
    pub armed_by: Option<usize>,
    /// The runs, the one that is on last.
    pub runs: Arc<Vec<Run>>,
    /// What was saved last.
    pub saved: Pair,
}

/// Coarser than equality, which looks at everything.
impl Hash for Rig {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let supervisor = &self.control.state().supervisor;
        (supervisor.drives(), supervisor.moves(), self.armed_by, self.saved).hash(state);
        (self.board.host_clock_ms, self.board.now_us, self.board.runs, &self.runs).hash(state);
        (self.control.test().name(), pair(self.control.parameters())).hash(state);
        (Borrow::<Recorder>::borrow(&self.control.recorder).len(), self.control.owner(&self.board).session)
            .hash(state);
    }
}

impl Rig {
    /// A rig that was never saved to, with its axis referenced.
    #[must_use]
    pub fn new(mutant: Option<Mutant>) -> Rig {
        let kept = Kept::new(Flash::default(), mutant);
        let board = Bench { kept, now_us: 0, host_clock_ms: 0, runs: 0, sampled: 0, extends: false };
        let saved = pair(&Parameters::default());
        let rig = Rig { control: Control::default(), board, armed_by: None, runs: Arc::default(), saved };
        rig.reset()
    }

    /// The rig after a reset: what is in flash is kept.
    #[must_use]
    pub fn reset(&self) -> Rig {
        let Kept { flash, boot, .. } = &self.board.kept;
        let kept = Kept { flash: flash.powered(), boot: boot + 1, ..self.board.kept.clone() };
        let mut board = Bench { kept, now_us: 0, host_clock_ms: 0, extends: false, ..self.board.clone() };
        let mut control = Control::with_recorder(Shared::default());
        control.take_up(&mut board);
        control.set_referenced().expect("disarmed after a reset");
        Rig { control, board, armed_by: None, ..self.clone() }
    }

    /// A sample and its output, a period after the one before; of a homing run, all of them up to its end. That leaves
    /// nothing out: a request finds the same at each of them but for the counters of the run, and no record is made.
    #[must_use]
    pub fn sampled(&self) -> Rig {
        let mut rig = self.clone();
        rig.sample();
        while rig.homes() {
            rig.sample();
        }
        rig
    }

    fn sample(&mut self) {
        let rig = self;
        rig.board.now_us += PERIOD_US;
        rig.control.on_sample(&mut rig.board);
        rig.control.on_output(&mut rig.board);
        let seen = rig.control.state().observation();
        if seen.running {
            let sample = recorded(seen);
            if let Some(run) = Arc::make_mut(&mut rig.runs).last_mut() {
                run.samples.push(sample);
            }
        }
    }

    /// The rig after a time in which nobody was heard.
    #[must_use]
    pub fn left_alone(&self) -> Rig {
        let mut rig = self.clone();
        rig.board.host_clock_ms += SILENCE_MS;
        rig.sampled()
    }

    /// The power goes at the nth operation of the flash from now.
    pub fn cut_power_at(&mut self, nth: u8) {
        self.board.kept.flash.cut_power_at(nth);
    }

    /// Whether the power went.
    #[must_use]
    pub fn is_powered_off(&self) -> bool {
        self.board.kept.flash.is_powered_off()
    }

    /// Whether the cylinder is on its way.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.control.state().supervisor.moves()
    }

    /// Whether it is on its way to its stop.
    #[must_use]
    pub fn homes(&self) -> bool {
        self.control.state().supervisor.mode() == Mode::Homing
    }

    /// Whether the drive is enabled.
    #[must_use]
    pub fn drives(&self) -> bool {
        self.control.state().supervisor.drives()
    }

    /// Notes that a run has begun.
    pub(crate) fn note_run(&mut self) {
        let test = self.control.test().name().to_owned();
        Arc::make_mut(&mut self.runs).push(Run { test, samples: Vec::new() });
    }
}
