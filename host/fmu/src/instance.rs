//! A model in the states of the standard (FMI 3.0, 4.2): which calls are allowed when.
//!
//! ```text
//! instantiated --enter--> initialising --exit--> stepping --terminate--> terminated
//!       ^_________________________reset, from any state________________________|
//! ```
//!
//! Parameters may be set until the initialisation ends. The model is built then, or at the first call that needs it.
//! A step that fails leaves the instance in a state in which it can only be reset, or set back to a kept state.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, bail};
use pneudrive_sim::Rig;

use crate::model::{Choices, FmuModel};
use crate::part::Part;
use crate::signal::{Kind, Value};
use crate::variable::{Role, Variable, variables};

/// Where the rig file of an FMU is, below its resources.
pub const RIG_FILE: &str = "rig.toml";

/// The importer's view of one drive, or a part of one.
#[derive(Debug)]
pub struct Instance {
    fixed: Arc<Fixed>,
    now: Now,
    /// States that the importer keeps, by number.
    kept: BTreeMap<usize, Now>,
}

/// The constant data.
#[derive(Debug)]
struct Fixed {
    part: Part,
    rig: Rig,
    /// Variables in the order of their references.
    variables: Vec<Variable>,
    period_s: f64,
}

/// The contents of an FMU state.
#[derive(Clone, Debug)]
struct Now {
    phase: Phase,
    /// The parameters that were set, by reference.
    parameters: BTreeMap<u32, Value>,
    inputs: Vec<Value>,
    model: Option<Built>,
    /// Parameters were set since the model was built, or tuned last.
    untuned: bool,
    /// The outputs of the model, once they were requested.
    outputs: Option<Vec<Value>>,
    start_time: f64,
    /// Samples since the start time.
    k: u64,
    /// Time since the present sample, s.
    past: f64,
}

/// A model, and the rig that it was built for.
#[derive(Clone, Debug)]
struct Built {
    model: FmuModel,
    rig: Arc<Rig>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Instantiated,
    Initialising,
    Stepping,
    Terminated,
    Failed,
}

impl Phase {
    fn word(self) -> &'static str {
        match self {
            Phase::Instantiated => "instantiated, and not initialised yet",
            Phase::Initialising => "being initialised",
            Phase::Stepping => "running",
            Phase::Terminated => "terminated",
            Phase::Failed => "stopped by a failure: reset it, or set a state that was kept before",
        }
    }
}

/// The number of the next state that is kept. No two instances have one of the same number.
static NEXT_STATE: AtomicUsize = AtomicUsize::new(1);

impl Instance {
    /// The part of the rig file that a token names, with the resources of its FMU in `folder`.
    ///
    /// # Errors
    /// When the rig file cannot be read, or is not the token's.
    pub(crate) fn of_resources(token: &str, folder: &Path) -> Result<Instance> {
        let path = folder.join(RIG_FILE);
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Instance::new(Part::of_token(token, &text)?, Rig::read(RIG_FILE, &text)?)
    }

    /// A part of a rig.
    ///
    /// # Errors
    /// When there is no such part of this rig.
    pub fn new(part: Part, rig: Rig) -> Result<Instance> {
        part.check(&rig)?;
        let period_s = f64::from(rig.period_us().get()) / 1e6;
        let fixed = Fixed { part, variables: variables(part, &rig), rig, period_s };
        Ok(Instance { now: Now::of(&fixed), fixed: Arc::new(fixed), kept: BTreeMap::new() })
    }

    /// The first sample is at `start_time`, s; at 0 unless it is said.
    ///
    /// # Errors
    /// In another state than right after the instantiation, and so far from 0 that samples cannot be told apart.
    pub fn start_at(&mut self, start_time: f64) -> Result<()> {
        self.require(&[Phase::Instantiated], "initialised")?;
        if !start_time.is_finite() {
            bail!("the start time must be a finite number of seconds, is {start_time}");
        }
        if lost_at(start_time) > LOST_OF_PERIOD * self.fixed.period_s {
            bail!(
                "near a start time of {start_time} s numbers are too far apart for a sample every {} s; let it begin nearer to 0",
                self.fixed.period_s
            );
        }
        self.now.start_time = start_time;
        Ok(())
    }

    /// The initialisation begins; the first sample is at `start_time`, s.
    ///
    /// # Errors
    /// As [`Instance::start_at`].
    pub fn enter_initialisation(&mut self, start_time: f64) -> Result<()> {
        self.start_at(start_time)?;
        self.now.phase = Phase::Initialising;
        Ok(())
    }

    /// The initialisation ends; the next step is the first one.
    ///
    /// # Errors
    /// When no initialisation is on, or no valid rig comes of the parameters.
    pub fn exit_initialisation(&mut self) -> Result<()> {
        self.require(&[Phase::Initialising], "taken out of its initialisation")?;
        self.now.build(&self.fixed)?;
        self.now.phase = Phase::Stepping;
        Ok(())
    }

    /// The simulation is over.
    ///
    /// # Errors
    /// When none is on.
    pub fn terminate(&mut self) -> Result<()> {
        self.require(&[Phase::Stepping], "terminated")?;
        self.now.phase = Phase::Terminated;
        Ok(())
    }

    /// The state right after the instantiation. Kept states stay.
    pub fn reset(&mut self) {
        self.now = Now::of(&self.fixed);
    }

    /// Something has gone wrong in a way that leaves the state in doubt.
    pub fn fail(&mut self) {
        self.now.phase = Phase::Failed;
    }

    /// The present time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.now.start_time + self.now.k as f64 * self.fixed.period_s + self.now.past
    }

    /// From `time` (s), which is the present one, on by `step` (s). The model takes the samples in between; where a step ends
    /// between two samples, it stands at the last one.
    ///
    /// # Errors
    /// When the step begins elsewhere or is none, and when the model fails.
    pub fn step(&mut self, time: f64, step: f64) -> Result<()> {
        self.require(&[Phase::Stepping], "stepped")?;
        let period_s = self.fixed.period_s;
        // Times are sums of steps, and steps are differences of times: both have lost digits.
        let lost = lost_at(self.time());
        let is_present = (time - self.time()).abs() <= 1e-3 * period_s + lost;
        if !is_present {
            bail!("the step begins at {time} s, but the FMU is at {} s", self.time());
        }
        let samples = step / period_s;
        if !(samples > 0.0 && samples <= f64::from(u32::MAX)) {
            bail!("a step must last more than 0 s and at most {} samples, is {step} s", u32::MAX);
        }
        let ahead = time + step - (self.time() - self.now.past);
        let nearly = (1e-6 * samples * period_s).min(1e-3 * period_s) + lost;
        let samples = ((ahead + nearly) / period_s).floor();
        let past = ahead - samples * period_s;
        self.now.run(&self.fixed, samples as u64)?;
        self.now.past = if past <= nearly { 0.0 } else { past };
        Ok(())
    }

    /// The type of a variable; None for an unknown reference.
    #[must_use]
    pub fn kind(&self, reference: u32) -> Option<Kind> {
        self.fixed.place(reference).map(|variable| variable.kind)
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// For an unknown reference, another type, and before the initialisation.
    pub fn get(&mut self, reference: u32, kind: Kind) -> Result<Value> {
        let fixed = Arc::clone(&self.fixed);
        let variable = fixed.variable(reference, kind)?;
        self.require(
            &[Phase::Initialising, Phase::Stepping, Phase::Terminated],
            &format!("asked for {}", variable.name),
        )?;
        match variable.role {
            Role::Time => Ok(Value::Float(self.time())),
            Role::Input(place) => Ok(self.now.inputs[place]),
            Role::Output(place) => Ok(self.now.outputs(&fixed)?[place]),
            Role::RunTest | Role::Seed | Role::Key(_) => {
                self.now.parameter(variable).context("it has no value")
            }
        }
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// For an unknown reference, another type, a value out of range, and a variable that may not be set now.
    pub fn set(&mut self, reference: u32, kind: Kind, value: Value) -> Result<()> {
        let fixed = Arc::clone(&self.fixed);
        let variable = fixed.variable(reference, kind)?;
        self.require(
            &[Phase::Instantiated, Phase::Initialising, Phase::Stepping],
            &format!("given a value of {}", variable.name),
        )?;
        let runs = self.now.phase == Phase::Stepping;
        match variable.role {
            Role::Time | Role::Output(_) => bail!("{} cannot be set", variable.name),
            _ if runs && variable.is_parameter() && !variable.is_tunable() => {
                bail!("{} is fixed: set it before the initialisation ends", variable.name)
            }
            _ => variable.check(value)?,
        }
        self.now.put(variable, value);
        Ok(())
    }

    /// Keeps the present state, and returns its number.
    #[must_use]
    pub fn keep(&mut self) -> usize {
        let number = NEXT_STATE.fetch_add(1, Ordering::Relaxed);
        self.kept.insert(number, self.now.clone());
        number
    }

    /// Keeps the present state under the number of one that is kept.
    ///
    /// # Errors
    /// When this instance keeps no state of that number.
    pub fn keep_as(&mut self, number: usize) -> Result<()> {
        *self.kept.get_mut(&number).context(NOT_KEPT)? = self.now.clone();
        Ok(())
    }

    /// Goes back to a state that was kept.
    ///
    /// # Errors
    /// When this instance keeps no state of that number.
    pub fn restore(&mut self, number: usize) -> Result<()> {
        self.now = self.kept.get(&number).context(NOT_KEPT)?.clone();
        Ok(())
    }

    /// Keeps a state no longer.
    ///
    /// # Errors
    /// When this instance keeps no state of that number.
    pub fn forget(&mut self, number: usize) -> Result<()> {
        self.kept.remove(&number).context(NOT_KEPT).map(drop)
    }

    fn require(&self, phases: &[Phase], asked: &str) -> Result<()> {
        if !phases.contains(&self.now.phase) {
            bail!("the FMU cannot be {asked} now: it is {}", self.now.phase.word());
        }
        Ok(())
    }
}

/// More than this part of a sample period must not be lost between two doubles.
const LOST_OF_PERIOD: f64 = 0.1;

/// The error of sums and differences of times near one, s: some distances from a double to the next.
fn lost_at(time: f64) -> f64 {
    4.0 * (time.abs().next_up() - time.abs())
}

const NOT_KEPT: &str = "this state is not one that this instance keeps";

impl Fixed {
    fn place(&self, reference: u32) -> Option<&Variable> {
        let place = self.variables.binary_search_by_key(&reference, |variable| variable.reference).ok()?;
        self.variables.get(place)
    }

    fn variable(&self, reference: u32, kind: Kind) -> Result<&Variable> {
        let variable = self
            .place(reference)
            .with_context(|| format!("there is no variable with the value reference {reference}"))?;
        if variable.kind != kind {
            bail!("{} is a {}, not a {}", variable.name, variable.kind.word(), kind.word());
        }
        Ok(variable)
    }
}

impl Now {
    fn of(fixed: &Fixed) -> Now {
        let starts = fixed.variables.iter().filter(|variable| matches!(variable.role, Role::Input(_)));
        Now {
            phase: Phase::Instantiated,
            parameters: BTreeMap::new(),
            inputs: starts.filter_map(|variable| variable.start).collect(),
            model: None,
            untuned: false,
            outputs: None,
            start_time: 0.0,
            k: 0,
            past: 0.0,
        }
    }

    /// The present value of a parameter.
    fn parameter(&self, variable: &Variable) -> Option<Value> {
        self.parameters.get(&variable.reference).copied().or(variable.start)
    }

    fn put(&mut self, variable: &Variable, value: Value) {
        if let Role::Input(place) = variable.role {
            self.inputs[place] = value;
            return;
        }
        self.parameters.insert(variable.reference, value);
        self.outputs = None;
        self.untuned = self.phase == Phase::Stepping;
        if !self.untuned {
            self.model = None;
        }
    }

    /// The model of the parameters, built unless it is there. One that cannot be tuned stays as it was.
    fn build(&mut self, fixed: &Fixed) -> Result<&mut FmuModel> {
        let tuned = match &self.model {
            Some(built) if self.untuned => Some(self.tuned(fixed, &built.rig)?),
            _ => None,
        };
        if self.model.is_none() {
            self.model = Some(self.built(fixed)?);
        }
        let model = &mut self.model.as_mut().context("it was not built")?.model;
        if let Some(rig) = tuned {
            model.retune(&rig)?;
        }
        self.untuned = false;
        Ok(model)
    }

    /// The settings of keys that have another value than in a rig.
    fn settings(&self, fixed: &Fixed, rig: &Rig, which: impl Fn(&Variable) -> bool) -> Vec<String> {
        let of = |variable: &Variable| match (variable.role, self.parameter(variable)?) {
            (Role::Key(key), value) if rig.value(key.path).and_then(Value::of_key) != Some(value) => {
                Some(key.setting(value))
            }
            _ => None,
        };
        fixed.variables.iter().filter(|variable| which(variable)).filter_map(of).collect()
    }

    fn built(&self, fixed: &Fixed) -> Result<Built> {
        let mut choices = Choices::default();
        for variable in &fixed.variables {
            match (variable.role, self.parameter(variable)) {
                (Role::RunTest, Some(Value::Switch(on))) => choices.run_test = on,
                (Role::Seed, Some(Value::Integer(seed))) => choices.seed = seed.unsigned_abs(),
                _ => {}
            }
        }
        let settings = self.settings(fixed, &fixed.rig, |_| true);
        let rig = if settings.is_empty() { fixed.rig.clone() } else { fixed.rig.with_settings(&settings)? };
        Ok(Built { model: FmuModel::new(fixed.part, &rig, choices)?, rig: Arc::new(rig) })
    }

    /// The rig that a model was built for, with the present tunable parameters: the controller knows its own of them alone.
    fn tuned(&self, fixed: &Fixed, rig: &Rig) -> Result<Rig> {
        let of_plant = self.settings(fixed, rig, Variable::is_of_running_plant);
        let gains =
            self.settings(fixed, rig, |variable| variable.is_tunable() && !variable.is_of_running_plant());
        Ok(rig.with_settings(&gains)?.with_plant(&of_plant)?)
    }

    fn outputs(&mut self, fixed: &Fixed) -> Result<&[Value]> {
        let outputs = match self.outputs.take() {
            Some(outputs) => outputs,
            None => self.build(fixed)?.outputs()?,
        };
        Ok(self.outputs.insert(outputs))
    }

    fn run(&mut self, fixed: &Fixed, samples: u64) -> Result<()> {
        self.outputs = None;
        for _ in 0..samples {
            let inputs = std::mem::take(&mut self.inputs);
            let stepped = self.build(fixed).and_then(|model| model.step(&inputs));
            self.inputs = inputs;
            if let Err(error) = stepped {
                self.phase = Phase::Failed;
                return Err(error.context(format!("sample {}", self.k)));
            }
            self.k += 1;
        }
        Ok(())
    }
}
