//! The valve operator, which moves the spool: one model per file.
//!
//! | model | thesis | moves the spool |
//! |---|---|---|
//! | [`solenoid`] | L(2) = 1 | by the forces on it (6.33) |
//! | [`empirical`] | L(2) = 0 | as a damped oscillator (6.32) |
//! | [`stepper`] | L(2) = 2 | a step a pulse, at once |
//! | [`on_off`] | L(2) = 3 | to one of three places, within a switching time |
//! | [`stuck`] | | not at all: a fault turns any other model into this one |
//!
//! An operator gets a [`Request`] at each output and reports the position of its spool. Models with a moving mass
//! have two states, position and velocity, for the integrator. While the motion is known beforehand
//! (`operator/closed_form.rs`) these rest, and [`Operator::state`] gives the position. Everything else that they
//! remember (hysteresis, stiction, stops) is a mode, with a guard that tells how long it holds.

pub mod amplifier;
mod closed_form;
pub mod empirical;
pub mod hysteresis;
mod moving_hysteresis;
pub mod on_off;
pub mod request;
pub mod solenoid;
pub mod stepper;
pub mod stuck;

use pneudrive_controller::drive::{DacCode, MAX_CODE};

use crate::component::controller::{self, keys as controller_keys};
use crate::component::dither::{self, Dither};
use crate::key::{keys, words};
use crate::values::{Findings, Rig};
pub(crate) use closed_form::{FreeMotion, Limit, Met, Oscillator, Quantity, Search, rounding};
use empirical::Empirical;
use on_off::OnOff;
pub use request::{Request, within_range};
use solenoid::{Solenoid, SolenoidParameters};
use stepper::Stepper;
use stuck::Stuck;

words! {
    /// The model that moves the spool.
    pub enum OperatorKind {
        /// A proportional solenoid against a spring, by the forces on the spool.
        Solenoid = "solenoid",
        /// The same as a damped oscillator.
        Empirical = "solenoid-empirical",
        /// A stepper motor.
        Stepper = "stepper",
        /// An on-off valve of three places.
        OnOff = "on-off",
    }
}

impl OperatorKind {
    /// Whether it is a solenoid, under a dither.
    #[must_use]
    pub fn is_solenoid(self) -> bool {
        matches!(self, OperatorKind::Solenoid | OperatorKind::Empirical)
    }
}

keys! {
    MODEL: OperatorKind = choice("operator.model", "L(2)", "What moves the spool.");
    MAX_COMMAND_COUNTS: i64 = integer("operator.max_command_counts", 2048, 1, 2048, "", "Largest command of a converter to either side. A board arms only if its converter of 12 bits has a code for it: with null_code 2048 up to 2047.").of(&["solenoid", "solenoid-empirical", "on-off"]);
}

/// The largest command with codes on both sides of the middle of a board's converter.
pub const MAX_WITH_CODES: i64 = (MAX_CODE - DacCode::MIDDLE.get()) as i64;

/// The largest command of a rig's drive stage to either side: counts of a converter, or steps.
#[must_use]
pub fn largest_command(rig: &Rig) -> i64 {
    match rig.get(&keys::MODEL) {
        OperatorKind::Stepper => rig.get(&stepper::keys::MAX_STEPS),
        _ => rig.get(&keys::MAX_COMMAND_COUNTS),
    }
}

/// The constraints on an operator's keys.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let dithers = rig.get(&keys::MODEL) == OperatorKind::Solenoid && rig.get(&dither::keys::DITHER_MM) > 0.0;
    if dithers && rig.get(&dither::keys::DITHER_HZ) == 0.0 {
        let message = "a dither needs a frequency; write dither_mm = 0 for none";
        findings.note(&dither::keys::DITHER_HZ, message);
    }
    solenoid::check(rig, findings);
}

impl Operator {
    /// The operator of a rig.
    #[must_use]
    pub fn of(rig: &Rig) -> Operator {
        let dither = Dither::of(rig);
        match (rig.get(&keys::MODEL), rig.get(&controller_keys::MODEL)) {
            (OperatorKind::Solenoid, controller::ControllerKind::Continuous) => {
                Operator::Solenoid(Solenoid::with_moving_command(SolenoidParameters::of(rig, dither)))
            }
            _ => Operator::with_steps(rig, dither),
        }
    }

    /// The operator of a rig for commands that come in steps, under a dither.
    #[must_use]
    pub fn with_steps(rig: &Rig, dither: Dither) -> Operator {
        match rig.get(&keys::MODEL) {
            OperatorKind::Solenoid => Operator::Solenoid(Solenoid::new(SolenoidParameters::of(rig, dither))),
            OperatorKind::Empirical => Operator::Empirical(Empirical::of(rig, dither)),
            OperatorKind::Stepper => Operator::Stepper(Stepper::of(rig)),
            OperatorKind::OnOff => Operator::OnOff(OnOff::of(rig)),
        }
    }
}

/// Position (m) and velocity (m/s) of a moving spool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpoolState {
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
}

/// The course of a spool until its next instant, as far as it is known.
pub(crate) enum KnownMotion<'a> {
    /// It stands at least until then, and breaks away there if a guard is named: the operator's of this index.
    Stands(f64, Option<usize>),
    /// It moves freely, between these limits.
    Flies(&'a FreeMotion, [Limit; 2]),
    /// Its events have to be searched for.
    Unknown,
}

/// How a spool follows its command as long as nothing limits it: without hysteresis, dither, friction and stops.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SpoolLaw {
    /// At once: this many metres a count.
    Follows { per_count: f64 },
    /// As a damped mass: it tends to `per_count` (m) times the command, by its stiffness (1/s^2) and damping (1/s)
    /// over its mass (kg). A spool that feels no flow force has an infinite mass.
    Moves { per_count: f64, stiffness_per_mass: f64, damping_per_mass: f64, mass: f64 },
}

/// Guards that an operator has.
pub const GUARDS: usize = 2 + moving_hysteresis::GUARDS;

/// A valve operator with its modes.
#[derive(Clone, Debug)]
pub enum Operator {
    /// The analytical solenoid.
    Solenoid(Solenoid),
    /// The empirical solenoid.
    Empirical(Empirical),
    /// The stepper motor.
    Stepper(Stepper),
    /// The three-state valve.
    OnOff(OnOff),
    /// Any of them with a spool that is stuck.
    Stuck(Stuck),
}

impl Operator {
    /// Position and velocity of a moving spool at `t`, if `spool` is its state in the integrator. All other functions
    /// except [`Operator::derivative`] take this result.
    #[must_use]
    pub fn state(&self, t: f64, spool: SpoolState) -> SpoolState {
        match self {
            Operator::Solenoid(solenoid) => solenoid.state(t, spool),
            Operator::Empirical(empirical) => empirical.state(t, spool),
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => spool,
        }
    }

    /// The longest step (s) in which no guard can change its sign twice unseen.
    #[must_use]
    pub fn max_step(&self) -> f64 {
        match self {
            Operator::Solenoid(solenoid) => solenoid.max_step(),
            Operator::Empirical(empirical) => empirical.max_step(),
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => f64::INFINITY,
        }
    }

    /// Whether position and guards depend on the time alone until the next event. Then the integrator's states of the
    /// spool rest: [`Operator::derivative`] is zero.
    #[must_use]
    pub(crate) fn has_closed_form(&self) -> bool {
        match self {
            Operator::Solenoid(solenoid) => solenoid.has_closed_form(),
            Operator::Empirical(empirical) => empirical.flies(),
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => true,
        }
    }

    /// Its course after `t`, as far as it is known. A moving spool next passes one of the `edges` of the lands,
    /// unless it meets a limit of the operator first.
    pub(crate) fn course(&self, t: f64, spool: SpoolState, edges: &[Limit; 2]) -> KnownMotion<'_> {
        match self {
            Operator::Solenoid(solenoid) => solenoid.course(t, spool, edges),
            Operator::Stepper(_) | Operator::Stuck(_) => KnownMotion::Stands(f64::INFINITY, None),
            Operator::Empirical(_) | Operator::OnOff(_) => KnownMotion::Unknown,
        }
    }

    /// Brings its hysteresis up to `t`. While a spool is held no step ends at a branch of it, so that this comes before the
    /// hysteresis is read.
    pub(crate) fn catch_up(&mut self, t: f64) {
        if let Operator::Solenoid(solenoid) = self {
            solenoid.catch_up(t);
        }
    }

    /// Whether its spool stands until its next event.
    #[must_use]
    pub fn stands(&self, t: f64) -> bool {
        self.has_closed_form() && self.max_step().is_infinite() && self.next_time_event(t).is_infinite()
    }

    /// A request takes effect at `t`, under a flow force (N) on the spool.
    pub fn drive(&mut self, t: f64, spool: SpoolState, request: Request, flow_force: f64) {
        match self {
            Operator::Solenoid(solenoid) => solenoid.drive(t, spool, request, flow_force),
            Operator::Empirical(empirical) => empirical.drive(t, spool, request),
            Operator::Stepper(stepper) => stepper.drive(request),
            Operator::OnOff(on_off) => on_off.drive(t, request),
            Operator::Stuck(stuck) => stuck.drive(t, spool, request, flow_force),
        }
    }

    /// The spool stays where it is at `t`, whatever the request.
    pub fn stick(&mut self, t: f64, spool: SpoolState) {
        if !matches!(self, Operator::Stuck(_)) {
            *self = Operator::Stuck(Stuck::new(self.position(t, spool), self.clone()));
        }
    }

    /// The spool is at this position (m) from now on, whatever the operator does.
    pub(crate) fn hold(&mut self, position: f64) {
        match self {
            Operator::Stuck(stuck) => stuck.hold(position),
            other => *other = Operator::Stuck(Stuck::new(position, other.clone())),
        }
    }

    /// How its spool follows a small change of the command. None of an on-off valve, whose spool has three places and
    /// nothing between them, and of a spool that is stuck.
    pub(crate) fn spool_law(&self) -> Option<SpoolLaw> {
        match self {
            Operator::Solenoid(solenoid) => Some(solenoid.spool_law()),
            Operator::Empirical(empirical) => Some(empirical.spool_law()),
            Operator::Stepper(stepper) => Some(stepper.spool_law()),
            Operator::OnOff(_) | Operator::Stuck(_) => None,
        }
    }

    /// A demand that changes all the time, in counts of a DAC but not limited to their range (the
    /// continuous controller). Solenoids alone can follow one.
    pub fn follow(&mut self, demand: f64) {
        match self {
            Operator::Solenoid(solenoid) => solenoid.follow(demand),
            Operator::Empirical(empirical) => empirical.follow(within_range(demand)),
            Operator::Stuck(stuck) => stuck.follow(demand),
            Operator::Stepper(_) | Operator::OnOff(_) => {}
        }
    }

    /// The rate of the demand that it follows, counts/s.
    pub(crate) fn follow_rate(&mut self, rate: f64) {
        if let Operator::Solenoid(solenoid) = self {
            solenoid.follow_rate(rate);
        }
    }

    /// Whether it depends on the history of the demand, and so must be notified of its jumps.
    #[must_use]
    pub(crate) fn remembers_demand(&self) -> bool {
        matches!(self, Operator::Solenoid(solenoid) if solenoid.remembers_command())
    }

    /// Whether its guards ask for the rate of the demand.
    #[must_use]
    pub(crate) fn needs_rate(&self) -> bool {
        matches!(self, Operator::Solenoid(solenoid) if solenoid.needs_rate())
    }

    /// The demand (counts) that it follows, its rate (counts/s) or both jump at `t`.
    pub fn jump(&mut self, t: f64, spool: SpoolState, demand_and_rate: [f64; 2], flow_force: f64) {
        if let Operator::Solenoid(solenoid) = self {
            solenoid.jump(t, spool, demand_and_rate, flow_force);
        }
    }

    /// The spool position demanded by the request in force, m.
    #[must_use]
    pub fn commanded(&self) -> f64 {
        match self {
            Operator::Solenoid(solenoid) => solenoid.commanded(),
            Operator::Empirical(empirical) => empirical.commanded(),
            Operator::Stepper(stepper) => stepper.commanded(),
            Operator::OnOff(on_off) => on_off.commanded(),
            Operator::Stuck(stuck) => stuck.commanded(),
        }
    }

    /// Where the spool is, m.
    #[must_use]
    pub fn position(&self, t: f64, spool: SpoolState) -> f64 {
        match self {
            Operator::Solenoid(_) => spool.position,
            Operator::Empirical(empirical) => empirical.position(t, spool),
            Operator::Stepper(stepper) => stepper.position(),
            Operator::OnOff(on_off) => on_off.position(t),
            Operator::Stuck(stuck) => stuck.position(),
        }
    }

    /// Rates of position and velocity; zero for operators without a moving mass. The flow force (N)
    /// pushes against positive positions.
    #[must_use]
    pub fn derivative(&self, t: f64, spool: SpoolState, flow_force: f64) -> [f64; 2] {
        match self {
            Operator::Solenoid(solenoid) if !solenoid.flies() => {
                [spool.velocity, solenoid.acceleration(t, spool, flow_force)]
            }
            Operator::Empirical(empirical) if !empirical.flies() => {
                [spool.velocity, empirical.acceleration(spool)]
            }
            Operator::Solenoid(_) | Operator::Empirical(_) => [0.0; 2],
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => [0.0; 2],
        }
    }

    /// Not negative as long as the modes hold.
    #[must_use]
    pub fn guards(&self, t: f64, spool: SpoolState, flow_force: f64) -> [f64; GUARDS] {
        match self {
            Operator::Solenoid(solenoid) => solenoid.guards(t, spool, flow_force),
            Operator::Empirical(empirical) => empirical.guards(t, spool),
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => [1.0; GUARDS],
        }
    }

    /// Changes the mode whose guard has become negative at `t`.
    pub fn cross(&mut self, guard: usize, t: f64, spool: &mut SpoolState, flow_force: f64) {
        match self {
            Operator::Solenoid(solenoid) => solenoid.cross(guard, t, spool, flow_force),
            Operator::Empirical(empirical) => empirical.cross(guard, t, *spool),
            Operator::Stepper(_) | Operator::OnOff(_) | Operator::Stuck(_) => {}
        }
    }

    /// The next instant after `t` at which the operator changes by itself.
    #[must_use]
    pub fn next_time_event(&self, t: f64) -> f64 {
        match self {
            Operator::Solenoid(solenoid) => solenoid.next_time_event(),
            Operator::OnOff(on_off) => on_off.next_time_event(t),
            Operator::Empirical(_) | Operator::Stepper(_) | Operator::Stuck(_) => f64::INFINITY,
        }
    }

    /// Passes the instant `t` of [`Operator::next_time_event`]; at another one nothing happens.
    pub fn pass_instant(&mut self, t: f64, spool: SpoolState, flow_force: f64) {
        match self {
            Operator::Solenoid(solenoid) => solenoid.pass_instant(t, spool, flow_force),
            Operator::OnOff(on_off) => on_off.arrive(t),
            Operator::Empirical(_) | Operator::Stepper(_) | Operator::Stuck(_) => {}
        }
    }
}
