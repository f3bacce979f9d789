//! The rig: the firmware's own control half, recorder and stored configuration on a board of the model.
//!
//! Beside them stands what the properties are judged by, which the firmware knows nothing of: who has armed the drive
//! since the reset, what each run was, and what was saved last.

use std::borrow::{Borrow, BorrowMut};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use pneudrive_app::inputs::attend;
use pneudrive_app::recorder::recorded;
use pneudrive_app::{Control, Recorder};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Parameters};
use pneudrive_protocol::change::{Entry, PART_BYTES};
use pneudrive_protocol::session::INPUTS;
use pneudrive_protocol::{ProfiledMove, RecordedSample};

use crate::board::{AT_STOP, ModelBoard};
use crate::flash::Flash;
use crate::mutant::Mutant;
use crate::pair::{Pair, pair};
use crate::plc::{Plc, TIMES_MS, Wrong};
use crate::presence::{Missed, Presence, Time};

/// Time from a sample to the next, microseconds: the default of the parameters.
const PERIOD_US: u64 = 1300;

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
    pub board: ModelBoard,
    /// The host whose request has armed the drive, or taken it over, since the reset; None if it was sent before.
    pub armed_by: Option<usize>,
    /// The runs, the one that is on last.
    pub runs: Arc<Vec<Run>>,
    /// What was saved last.
    pub saved: Pair,
    /// The PLC at its inputs, if there is one.
    pub plc: Option<Plc>,
    /// How long the owner has been silent.
    pub presence: Presence,
}

/// Coarser than equality, which looks at everything.
impl Hash for Rig {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let supervisor = &self.control.state().supervisor;
        (supervisor.drives(), supervisor.moves(), self.armed_by, self.saved).hash(state);
        (self.board.host_clock_ms, self.board.now_us, self.board.runs, &self.runs).hash(state);
        let selector = self.control.selector();
        (selector.settled(), selector.outputs(), selector.number(), &self.plc, &self.presence).hash(state);
        (self.control.test().name(), pair(self.control.parameters())).hash(state);
        (Borrow::<Recorder>::borrow(&self.control.recorder).len(), self.control.owner(&self.board).session)
            .hash(state);
    }
}

impl Rig {
    /// A rig that was never saved to, with its axis referenced.
    #[must_use]
    pub fn new(mutant: Option<Mutant>) -> Rig {
        let board = ModelBoard::new(Flash::default(), mutant);
        let rig = Rig {
            control: Control::default(),
            board,
            armed_by: None,
            runs: Arc::default(),
            saved: pair(&Parameters::default()),
            plc: None,
            presence: Presence::default(),
        };
        rig.reset()
    }

    /// The same with a PLC at its inputs, and with two records that are stored, both to where the rod stands.
    #[must_use]
    pub fn with_plc(mutant: Option<Mutant>) -> Rig {
        let mut rig = Rig::new(mutant);
        for number in [1, 3] {
            let told = ProfiledMove { target: AT_STOP, ..ProfiledMove::default() };
            let entry = Entry::MoveRecord { number, bytes: &told.to_bytes() };
            let mut room = [0; PART_BYTES];
            rig.control.take_change(entry.write(&mut room).expect("room")).expect("disarmed");
        }
        let times = [TIMES_MS; 2].into_iter();
        rig.control.set_parameters(id::INPUT_DEBOUNCE_MS, times).expect("disarmed");
        rig.control.save_parameters(&mut rig.board).expect("the power stays on");
        rig.plc = Some(Plc::default());
        rig.reset()
    }

    /// The rig after a reset: what is in flash is kept.
    #[must_use]
    pub fn reset(&self) -> Rig {
        let mut board = self.board.reset();
        let mut control = Control::with_recorder(Shared::default());
        control.take_up(&mut board);
        control.set_referenced().expect("disarmed after a reset");
        let (plc, presence) = (self.plc.as_ref().map(Plc::reset), Presence::default());
        Rig { control, board, armed_by: None, plc, presence, ..self.clone() }
    }

    /// A sample and its output, a period after the one before; of a homing run, all of them up to its end. That leaves
    /// nothing out: a request finds the same at each of them but for the counters of the run, and no record is made. With a
    /// PLC its inputs are looked at behind the output; what is wrong with a record that they begin then.
    #[must_use]
    pub fn sampled(&self) -> (Rig, Option<Wrong>) {
        let mut rig = self.clone();
        rig.sample();
        while rig.homes() {
            rig.sample();
        }
        let wrong = rig.heed_inputs(self.is_tripped());
        rig.forget();
        (rig, wrong)
    }

    /// Forgets what does not matter any more: of a disabled drive its owner and how long that has been silent, of one that
    /// stands when its last sample was. Only times between samples of a run are judged, and they are exact here.
    pub(crate) fn forget(&mut self) {
        if !self.drives() {
            (self.armed_by, self.presence, self.board.host_clock_ms) = (None, Presence::default(), 0);
        }
        if !self.moves() {
            self.control.restart_clock();
            (self.board.now_us, self.board.sampled) = (0, 0);
        }
    }

    pub(crate) fn is_tripped(&self) -> bool {
        matches!(self.control.state().supervisor.mode(), Mode::Fault(_))
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

    /// The idle task looks at the inputs, of a drive that had tripped before the sample, or not. What is wrong with a record
    /// that it begins.
    fn heed_inputs(&mut self, had_tripped: bool) -> Option<Wrong> {
        let plc = self.plc.as_mut()?;
        plc.is_read();
        self.board.inputs = plc.contacts;
        let (moved, others_drive) = (self.moves(), self.drives() && !self.inputs_own());
        attend(&mut (&mut self.control, &mut self.board));
        let trips = self.is_tripped() && !had_tripped;
        let begins = !moved && self.moves();
        let name = self.control.test().name().to_owned();
        let plc = self.plc.as_mut()?;
        if trips {
            plc.trips();
        }
        if !begins {
            return None;
        }
        let wrong = plc.begins(&name);
        self.armed_by = None;
        self.note_run();
        wrong.or(others_drive.then_some(Wrong::Unasked))
    }

    /// The rig after a time in which nobody was heard, and a sample. What is wrong with it then.
    #[must_use]
    pub fn left_alone(&self, time: Time) -> (Rig, Option<Missed>) {
        let mut rig = self.clone();
        rig.board.host_clock_ms += time.ms();
        rig.presence.passes(time);
        let silent = rig.presence.is_silent();
        let (rig, _) = rig.sampled();
        let missed = self.missed(&rig, time, silent);
        (rig, missed)
    }

    /// What is wrong with the rig after a time and a sample; whether its owner had then been silent for too long.
    fn missed(&self, after: &Rig, time: Time, silent: bool) -> Option<Missed> {
        let tripped = after.control.state().supervisor.mode() == Mode::Fault(Fault::HostSilent);
        if time == Time::Hold && after.drives() {
            return Some(Missed::HoldsForGone);
        }
        match (self.moves(), silent) {
            (true, true) if after.moves() => Some(Missed::MovesForSilent),
            (true, false) if tripped => Some(Missed::TripsForHeard),
            _ => None,
        }
    }

    /// The rig with a contact of its PLC changed; no sample has seen that yet.
    #[must_use]
    pub fn toggled(&self, contact: u8) -> Rig {
        let mut rig = self.clone();
        rig.plc.iter_mut().for_each(|plc| plc.toggle(contact));
        rig
    }

    /// Whether a sample may change something: the drive moves, or the inputs have not been the same for long enough.
    #[must_use]
    pub fn samples_matter(&self) -> bool {
        self.moves() || self.plc.as_ref().is_some_and(Plc::is_settling)
    }

    /// Whether the digital inputs have enabled the drive: they are heard at every sample.
    #[must_use]
    pub fn inputs_own(&self) -> bool {
        self.drives() && self.control.owner(&self.board).session == INPUTS
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
