//! Plant, controller and drive, a sample at a time. Each lists its inputs and outputs in one order, and takes and gives
//! values in it.

mod controller;
mod drive;
mod plant;
mod taken;

use anyhow::Result;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::{Encoder, pulse, zero_counts};
use pneudrive_sim::keys;

use crate::part::Part;
use crate::signal::{Kind, Signal, Value};

use controller::Controller;
use drive::DriveModel;
use plant::Plant;

/// The data of a model besides its rig.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Choices {
    /// The controller runs the test of the rig, instead of following its input.
    pub run_test: bool,
    /// For the noise of the sensors.
    pub seed: u64,
}

/// A model at one of its samples.
#[derive(Clone, Debug)]
pub struct FmuModel(Which);

#[derive(Clone, Debug)]
enum Which {
    Plant(Box<Plant>),
    Controller(Box<Controller>),
    Drive(Box<DriveModel>),
}

impl FmuModel {
    /// A part of a rig at sample 0.
    ///
    /// # Errors
    /// When there is no such part of this rig, or the integration up to the first sample fails.
    pub fn new(part: Part, rig: &Rig, choices: Choices) -> Result<FmuModel> {
        part.check(rig)?;
        Ok(FmuModel(match part {
            Part::Plant => Which::Plant(Box::new(Plant::new(rig, choices.seed)?)),
            Part::Controller => Which::Controller(Box::new(Controller::new(rig, choices.run_test)?)),
            Part::Drive => Which::Drive(Box::new(DriveModel::new(rig, choices)?)),
        }))
    }

    /// To the next sample, with these inputs at the present one.
    ///
    /// # Errors
    /// When the integration fails, or the controller refuses its setpoint.
    pub fn step(&mut self, inputs: &[Value]) -> Result<()> {
        match &mut self.0 {
            Which::Plant(plant) => plant.step(inputs),
            Which::Controller(controller) => controller.step(inputs),
            Which::Drive(drive) => drive.step(inputs),
        }
    }

    /// Its outputs at the present sample.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn outputs(&mut self) -> Result<Vec<Value>> {
        match &mut self.0 {
            Which::Plant(plant) => plant.outputs(),
            Which::Controller(controller) => Ok(controller.outputs()),
            Which::Drive(drive) => drive.outputs(),
        }
    }

    /// From the present sample on it has the tunable values of another rig.
    ///
    /// # Errors
    /// When the controller refuses its gains.
    pub(crate) fn retune(&mut self, rig: &Rig) -> Result<()> {
        match &mut self.0 {
            Which::Plant(plant) => plant.retune(rig),
            Which::Controller(controller) => return controller.retune(rig),
            Which::Drive(drive) => return drive.retune(rig),
        }
        Ok(())
    }
}

/// The inputs of a part, in their order.
#[must_use]
pub fn inputs(part: Part, rig: &Rig) -> Vec<Signal> {
    match part {
        Part::Plant => plant::inputs(rig),
        Part::Controller => controller::inputs(rig),
        Part::Drive => drive::inputs(rig),
    }
}

/// The outputs of a part, in their order.
#[must_use]
pub fn outputs(part: Part, rig: &Rig) -> Vec<Signal> {
    match part {
        Part::Plant => plant::outputs(),
        Part::Controller => controller::outputs(rig),
        Part::Drive => [plant::outputs(), controller::outputs(rig)].concat(),
    }
}

/// The inputs of a part before they are set: the drive stands where the rig's test starts, and stays there.
#[must_use]
pub fn starts(part: Part, rig: &Rig) -> Vec<Value> {
    let counted = i64::from(Encoder::at_rest(rig, rig.get(&keys::test::POSITION_M)));
    let stands = counted + i64::from(zero_counts(rig));
    let start = |signal: Signal| match (signal.name, signal.kind) {
        ("setpoint_m", _) => Value::Float(stands as f64 * pulse(rig)),
        ("position_counts", _) => Value::Integer(counted),
        ("setpoint_counts", _) if controller::is_closed(rig) => Value::Integer(stands),
        (_, Kind::Float64) => Value::Float(0.0),
        (_, Kind::Boolean) => Value::Switch(false),
        (name, _) if name.starts_with("pressure_") => Value::Integer(sensor_middle(rig)),
        _ => Value::Integer(0),
    };
    inputs(part, rig).into_iter().map(start).collect()
}

/// A reading in the middle of a converter's range: neither an open nor a shorted sensor.
fn sensor_middle(rig: &Rig) -> i64 {
    1 << (rig.get(&keys::sensors::BITS) - 1)
}
