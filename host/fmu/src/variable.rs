//! The variables of an FMU.
//!
//! | value reference | variable |
//! |---|---|
//! | 0 | time |
//! | from 1 | inputs of the model, in its order |
//! | from 100 | outputs of the model, in its order |
//! | 900, 901 | parameters that are not keys of the rig: run_test, seed |
//! | from 1000 | keys of the rig file, by their place in the list of all keys |
//!
//! A parameter has the name, the unit and the range of its key (`pneudrive rig explain KEY`). Keys of models that the rig
//! does not use are left out, and so is the sample period, which is fixed in modelDescription.xml.

use anyhow::{Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Key, Kind as KeyKind, Value as KeyValue, all_keys, unit};

use crate::model;
use crate::part::Part;
use crate::signal::{Kind, Signal, Value};
use crate::tunable::{GAINS, OF_RUNNING_PLANT};

/// The purpose of a variable.
#[derive(Clone, Copy, Debug)]
pub enum Role {
    /// The time of the simulation.
    Time,
    /// The input of the model at this place.
    Input(usize),
    /// The output of the model at this place.
    Output(usize),
    /// Whether the controller runs the test of the rig file, or follows its input.
    RunTest,
    /// The seed of the sensor noise.
    Seed,
    /// A key of the rig file.
    Key(&'static Key),
}

/// A variable of an FMU.
#[derive(Clone, Debug)]
pub struct Variable {
    /// With its unit at the end.
    pub name: &'static str,
    /// Value reference.
    pub reference: u32,
    /// Its purpose.
    pub role: Role,
    /// Its type.
    pub kind: Kind,
    /// Of inputs and parameters: the value unless another one is set.
    pub start: Option<Value>,
    /// Of inputs and parameters: the least and the most.
    pub range: Option<[Value; 2]>,
    /// Its meaning.
    pub meaning: &'static str,
}

const FIRST_INPUT: u32 = 1;
const FIRST_OUTPUT: u32 = 100;
const RUN_TEST: u32 = 900;
const SEED: u32 = 901;
const FIRST_KEY: u32 = 1000;

impl Variable {
    /// The unit of the name, as the rig files write it; "" for none.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self.role {
            Role::Time => "s",
            _ => unit(self.name.rsplit('.').next().unwrap_or(self.name)).1,
        }
    }

    /// Whether it may be set while the simulation runs, though it is a parameter.
    #[must_use]
    pub(crate) fn is_tunable(&self) -> bool {
        self.is_of_running_plant()
            || matches!(self.role, Role::Key(key) if GAINS.iter().any(|one| one.path == key.path))
    }

    /// Whether it is one of the plant.
    pub(crate) fn is_of_running_plant(&self) -> bool {
        matches!(self.role, Role::Key(key) if OF_RUNNING_PLANT.iter().any(|one| one.path == key.path))
    }

    /// Whether it is a parameter.
    #[must_use]
    pub fn is_parameter(&self) -> bool {
        matches!(self.role, Role::RunTest | Role::Seed | Role::Key(_))
    }

    /// Whether a value may be given to it.
    ///
    /// # Errors
    /// For an invalid number, and one out of range.
    pub fn check(&self, value: Value) -> Result<()> {
        if matches!(value, Value::Float(number) if !number.is_finite()) {
            bail!("{} must be a finite number, is {value}", self.name);
        }
        let inside = |[least, most]: [Value; 2]| match (least, value, most) {
            (Value::Float(least), Value::Float(value), Value::Float(most)) => (least..=most).contains(&value),
            (Value::Integer(least), Value::Integer(value), Value::Integer(most)) => {
                (least..=most).contains(&value)
            }
            _ => true,
        };
        match self.range {
            Some([least, most]) if !inside([least, most]) => {
                bail!("{} must be between {least} and {most}, is {value}", self.name)
            }
            _ => Ok(()),
        }
    }
}

/// All variables of an FMU, in the order of their references.
#[must_use]
pub fn variables(part: Part, rig: &Rig) -> Vec<Variable> {
    let mut all = vec![time()];
    all.extend(
        model::inputs(part, rig)
            .into_iter()
            .zip(model::starts(part, rig))
            .zip(FIRST_INPUT..)
            .enumerate()
            .map(|(place, ((signal, start), reference))| {
                of_signal(&signal, Role::Input(place), reference, Some(start))
            }),
    );
    all.extend(
        model::outputs(part, rig)
            .into_iter()
            .zip(FIRST_OUTPUT..)
            .enumerate()
            .map(|(place, (signal, reference))| of_signal(&signal, Role::Output(place), reference, None)),
    );
    all.extend(own_parameters(part));
    all.extend(all_keys().zip(FIRST_KEY..).filter_map(|(key, reference)| of_key(part, rig, key, reference)));
    all
}

fn time() -> Variable {
    Variable {
        name: "time",
        reference: 0,
        role: Role::Time,
        kind: Kind::Float64,
        start: None,
        range: None,
        meaning: "Time of the simulation.",
    }
}

fn of_signal(signal: &Signal, role: Role, reference: u32, start: Option<Value>) -> Variable {
    let &Signal { name, kind, meaning, range } = signal;
    let range = range.map(|ends| ends.map(Value::Integer));
    Variable { name, reference, role, kind, start, range, meaning }
}

fn own_parameters(part: Part) -> Vec<Variable> {
    let run_test = Variable {
        name: "run_test",
        reference: RUN_TEST,
        role: Role::RunTest,
        kind: Kind::Boolean,
        start: Some(Value::Switch(false)),
        range: None,
        meaning: "Whether the controller runs the moves of the rig's test; otherwise it follows the setpoint at its input.",
    };
    let seed = Variable {
        name: "seed",
        reference: SEED,
        role: Role::Seed,
        kind: Kind::Int32,
        start: Some(Value::Integer(0)),
        range: Some([0, i64::from(i32::MAX)].map(Value::Integer)),
        meaning: "What the noise of the sensors is drawn from.",
    };
    let of_controller = part.has_controller().then_some(run_test);
    of_controller.into_iter().chain(part.has_plant().then_some(seed)).collect()
}

/// Keys under `controller` and `test` that belong to the plant: when commands take effect, and the state at the start.
const OF_PLANT: [&str; 7] = [
    keys::controller::DELAY_S.key.path,
    keys::controller::START_S.key.path,
    keys::test::POSITION_M.key.path,
    keys::test::PRESSURE_1_PA.key.path,
    keys::test::PRESSURE_2_PA.key.path,
    keys::test::TEMPERATURE_1_K.key.path,
    keys::test::TEMPERATURE_2_K.key.path,
];

/// Whether a part uses a key.
fn concerns(part: Part, key: &Key) -> bool {
    let of_controller = ["controller", "safety", "test"].contains(&key.table());
    let of_plant = !of_controller || OF_PLANT.contains(&key.path);
    key.path != keys::controller::PERIOD_S.path
        && match part {
            Part::Plant => of_plant,
            // Lengths in counts, and ranges of readings.
            Part::Controller => of_controller || ["encoder", "sensors"].contains(&key.table()),
            Part::Drive => true,
        }
}

/// The parameter of a key, if it has a number and the part uses it.
fn of_key(part: Part, rig: &Rig, key: &'static Key, reference: u32) -> Option<Variable> {
    if !concerns(part, key) || !rig.uses(key) {
        return None;
    }
    let (kind, start, range) = match (rig.value(key.path)?, key.kind) {
        (KeyValue::Number(value), KeyKind::Number { min, max }) => {
            (Kind::Float64, Value::Float(*value), Some([min, max].map(Value::Float)))
        }
        (KeyValue::Integer(value), KeyKind::Integer { min, max }) => {
            let fits = [min, max].iter().all(|end| i32::try_from(*end).is_ok());
            let kind = if fits { Kind::Int32 } else { Kind::Int64 };
            (kind, Value::Integer(*value), Some([min, max].map(Value::Integer)))
        }
        (KeyValue::Switch(on), KeyKind::Switch) => (Kind::Boolean, Value::Switch(*on), None),
        _ => return None,
    };
    let role = Role::Key(key);
    Some(Variable { name: key.path, reference, role, kind, start: Some(start), range, meaning: key.meaning })
}
