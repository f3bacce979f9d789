//! The board that the firmware runs on: its flash, its rod and its digital inputs.

use pneudrive_app::fault_log::Event;
use pneudrive_app::move_records::MoveRecords;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::storage::{ConfigStore, Load};
use pneudrive_app::store::NotStored;
use pneudrive_app::{Board, Store};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Config, Parameters, Sample};
use pneudrive_protocol::io::input;

use crate::flash::Flash;
use crate::mutant::Mutant;
use crate::pair::pair;

/// The flash with the stored configuration. The fault log is left out: nothing here asks for it or depends on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    slots: ConfigStore,
    pub(crate) flash: Flash,
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

/// Where the rod stands, counts.
pub(crate) const AT_STOP: i32 = 100;

/// As far as a homing run backs off from its stop, counts: the default of the parameters.
const BACK_OFF: i32 = 400;

/// A board whose rod stands at its stop, or off it while the valve extends it. Its pressures tell the run and the sample apart, so no two records are the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelBoard {
    /// What is kept through a reset.
    pub(crate) kept: Kept,
    pub(crate) now_us: u64,
    pub(crate) host_clock_ms: u64,
    /// Runs begun, also those before a reset.
    pub(crate) runs: i16,
    pub(crate) sampled: i16,
    extends: bool,
    /// The digital inputs.
    pub(crate) inputs: u8,
    /// With a defect: the number that was there as the start went on.
    latched: Option<u8>,
    mutant: Option<Mutant>,
}

impl ModelBoard {
    /// With this flash.
    pub(crate) fn new(flash: Flash, mutant: Option<Mutant>) -> ModelBoard {
        let kept = Kept::new(flash, mutant);
        let (extends, inputs, latched) = (false, 0, None);
        ModelBoard {
            kept,
            now_us: 0,
            host_clock_ms: 0,
            runs: 0,
            sampled: 0,
            extends,
            inputs,
            latched,
            mutant,
        }
    }

    /// After a reset: what is in flash is kept.
    pub(crate) fn reset(&self) -> ModelBoard {
        let Kept { flash, boot, .. } = &self.kept;
        let kept = Kept { flash: flash.powered(), boot: boot + 1, ..self.kept.clone() };
        ModelBoard { kept, now_us: 0, host_clock_ms: 0, extends: false, latched: None, ..self.clone() }
    }
}

impl Board for ModelBoard {
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
            position: if self.extends { AT_STOP + BACK_OFF } else { AT_STOP },
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
        Some(self.host_clock_ms).filter(|_| self.mutant != Some(Mutant::NeverMissesHost))
    }

    fn inputs(&mut self) -> u8 {
        let starts = self.inputs & input::START != 0;
        self.latched = self.latched.or(Some(self.inputs & input::NUMBER)).filter(|_| starts);
        match self.latched {
            Some(number) if self.mutant == Some(Mutant::ReadsNumberAtOnce) => {
                self.inputs & !input::NUMBER | number
            }
            _ => self.inputs,
        }
    }

    fn run_begins(&mut self, _: &Config) {
        self.runs += 1;
        self.sampled = 0;
    }
}
