//! Valve, tubes, cylinder, load and sensors.

use anyhow::Result;
use pneudrive_controller::{Command, Sample};
use pneudrive_sim::component::load::Load;
use pneudrive_sim::component::operator::OperatorKind;
use pneudrive_sim::plant::QUANTITIES;
use pneudrive_sim::{Accuracy, Rig, keys};

use super::taken::integer;
use crate::signal::{Kind, Signal, Value};
use crate::tunable::OF_RUNNING_PLANT;

/// The plant at a sample.
#[derive(Clone, Debug)]
pub struct Plant {
    plant: pneudrive_sim::Plant,
    period_us: u64,
    /// Number of the sample.
    k: u64,
    sample: Sample,
    /// [`tunable`], as they are now.
    tuned: [f64; OF_RUNNING_PLANT.len()],
}

/// Its inputs, in their order.
pub fn inputs(rig: &Rig) -> Vec<Signal> {
    let command = Signal {
        name: "command_counts",
        kind: Kind::Int32,
        meaning: "Valve command of this sample, driven controller.delay_s later; positive means extension, 0 is the null. DAC: counts; stepper: the spool location asked for.",
        range: Some([-2048, 2048]),
    };
    let step = Signal {
        name: "step",
        kind: Kind::Int32,
        meaning: "The pulse that the stepper is given at this sample's output.",
        range: Some([-1, 1]),
    };
    let of_stepper = (rig.get(&keys::operator::MODEL) == OperatorKind::Stepper).then_some(step);
    [command].into_iter().chain(of_stepper).collect()
}

const fn real(name: &'static str, meaning: &'static str) -> Signal {
    Signal { name, kind: Kind::Float64, meaning, range: None }
}

const fn whole(name: &'static str, meaning: &'static str) -> Signal {
    Signal { name, kind: Kind::Int32, meaning, range: None }
}

/// Its outputs, in their order: the quantities of the plant, then the readings of its sensors.
pub fn outputs() -> Vec<Signal> {
    QUANTITIES.iter().map(|quantity| real(quantity.name, quantity.meaning)).chain(READINGS).collect()
}

const READINGS: [Signal; 5] = [
    whole("position_counts", "What the encoder counts."),
    whole("pressure_1_raw", "Pressure in chamber 1 as converted."),
    whole("pressure_2_raw", "Pressure in chamber 2 as converted."),
    whole("spool_raw", "Spool displacement as converted."),
    Signal {
        name: "home_switch",
        kind: Kind::Boolean,
        meaning: "Whether the homing switch is closed; false without one.",
        range: None,
    },
];

/// The values that may change while it runs, the supply pressure first.
fn tunable(rig: &Rig) -> [f64; OF_RUNNING_PLANT.len()] {
    OF_RUNNING_PLANT.map(|key| rig.get(key))
}

impl Plant {
    /// In the initial state of the rig's test.
    pub fn new(rig: &Rig, seed: u64) -> Result<Plant> {
        let mut plant = pneudrive_sim::Plant::new(rig, Accuracy::of(rig), seed);
        let sample = plant.sample()?;
        Ok(Plant { plant, period_us: rig.period_us().get().into(), k: 0, sample, tuned: tunable(rig) })
    }

    /// The readings of the sensors at the present sample.
    pub fn sample(&self) -> Sample {
        self.sample
    }

    /// To the next sample, with this command in force from the output in between.
    pub fn advance(&mut self, command: Command) -> Result<()> {
        self.sample = self.plant.advance(command)?;
        self.k += 1;
        Ok(())
    }

    /// From the present sample on it has the supply pressure and the load of another rig.
    pub fn retune(&mut self, rig: &Rig) {
        let [pressure, load @ ..] = self.tuned;
        self.tuned = tunable(rig);
        let [new_pressure, new_load @ ..] = self.tuned;
        if new_pressure != pressure {
            self.plant.set_supply_pressure(new_pressure);
        }
        if new_load != load {
            self.plant.set_load(Load::of(rig));
        }
    }

    /// To the next sample with the command at its inputs.
    pub fn step(&mut self, inputs: &[Value]) -> Result<()> {
        let (counts, step) = (integer(inputs, 0), integer(inputs, 1));
        self.advance(Command { counts, step, drive_enable: true })
    }

    /// In the order of [`outputs`].
    pub fn outputs(&mut self) -> Result<Vec<Value>> {
        let seen = self.plant.look((self.k * self.period_us) as f64 / 1e6)?;
        let Sample { position, pressure_1, pressure_2, spool, home_switch } = self.sample;
        let real = QUANTITIES.iter().map(|quantity| Value::Float((quantity.of)(&seen)));
        let whole = [position, pressure_1.into(), pressure_2.into(), spool.into()];
        let whole = whole.map(|value| Value::Integer(value.into()));
        Ok(real.chain(whole).chain([Value::Switch(home_switch)]).collect())
    }
}
