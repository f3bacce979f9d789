//! Plant and controller, joined as in `pneudrive simulate`.

use anyhow::Result;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::pulse;

use super::Choices;
use super::controller::{self, Controller, STOP, is_closed};
use super::plant::Plant;
use super::taken::{integer, switch};
use crate::signal::{Kind, Signal, Value};

/// The drive at a sample.
#[derive(Clone, Debug)]
pub struct DriveModel {
    controller: Controller,
    plant: Plant,
    /// Stroke per encoder count, m.
    pulse: f64,
}

/// Its inputs, in their order: where it shall be, and whether it shall stop.
pub fn inputs(rig: &Rig) -> Vec<Signal> {
    let setpoint = if is_closed(rig) {
        Signal {
            name: "setpoint_m",
            kind: Kind::Float64,
            meaning: "Where the drive shall be, from the retracted end; rounded to the nearest encoder count. Followed unless run_test is set.",
            range: None,
        }
    } else {
        controller::setpoint_counts()
    };
    vec![setpoint, STOP]
}

impl DriveModel {
    /// In the initial state of the rig's test.
    pub fn new(rig: &Rig, choices: Choices) -> Result<DriveModel> {
        let controller = Controller::new(rig, choices.run_test)?;
        Ok(DriveModel { controller, plant: Plant::new(rig, choices.seed)?, pulse: pulse(rig) })
    }

    /// From the present sample on it has the tunable values of another rig. Only the controller refuses any: it goes first.
    pub fn retune(&mut self, rig: &Rig) -> Result<()> {
        self.controller.retune(rig)?;
        self.plant.retune(rig);
        Ok(())
    }

    /// To the next sample.
    pub fn step(&mut self, inputs: &[Value]) -> Result<()> {
        let setpoint = match inputs.first() {
            // A position that no count can have is beyond every soft limit.
            Some(Value::Float(metres)) => (metres / self.pulse).round() as i32,
            _ => integer(inputs, 0),
        };
        let command = self.controller.take(&self.plant.sample(), setpoint, switch(inputs, 1))?;
        self.plant.advance(command)
    }

    /// The outputs of the plant, then those of the controller.
    pub fn outputs(&mut self) -> Result<Vec<Value>> {
        let mut all = self.plant.outputs()?;
        all.extend(self.controller.outputs());
        Ok(all)
    }
}
