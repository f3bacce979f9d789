//! What the law "cascade" knows of its drive, in engineering units: of a run, or of a record that is replayed.

use pneudrive_controller::State;
use pneudrive_controller::law::Running;
use pneudrive_controller::law::cascade::known::Known as Integers;

use crate::component::actuator::Actuator;
use crate::component::controller::{ControllerKind, Law, Loop};
use crate::component::encoder::pulse;
use crate::keys;
use crate::values::Rig;

impl Rig {
    /// Whether its law has a model of its drive.
    #[must_use]
    pub fn knows_its_drive(&self) -> bool {
        use keys::controller::{LAW, LOOP, MODEL};
        self.get(&LAW) == Law::Cascade
            && self.get(&LOOP) == Loop::Closed
            && self.get(&MODEL) == ControllerKind::Sampled
    }
}

/// What the law knows at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// 0 at rest, 1 on a trajectory of its own, 2 on a profile.
    pub stage: f64,
    /// Where the load shall be, m, and how fast, m/s.
    pub reference: f64,
    /// m/s.
    pub reference_velocity: f64,
    /// Estimated place, m, and speed, m/s.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// By the pressures, N.
    pub force: f64,
    /// That the law wants, N.
    pub wanted_force: f64,
    /// What stands against the load now, beside friction, N.
    pub opposing_force: f64,
    /// The same as it was learned, N.
    pub standing_force: f64,
    /// Learned mass, kg.
    pub mass: f64,
    /// Learned friction over that of the rig file.
    pub friction: f64,
    /// Learned lag of the valve, s.
    pub lag: f64,
    /// How many times the distance from its target at which the load may rest has doubled.
    pub looseness: f64,
}

/// The units of the law's integers, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// A count, m, and the sample period, s.
    count: f64,
    period: f64,
    /// Ps A1, N.
    force: f64,
    /// kg, and K_D/K_S of the spool, s, both of the rig file.
    mass: f64,
    lag: f64,
}

impl Units {
    /// Those of a rig whose law knows its drive: the values that the controller was given.
    #[must_use]
    pub fn of(rig: &Rig) -> Option<Units> {
        if !rig.knows_its_drive() {
            return None;
        }
        let rig = &*rig.nominal();
        Some(Units {
            count: pulse(rig),
            period: rig.get(&keys::controller::PERIOD_S),
            force: rig.get(&keys::supply::PRESSURE_PA) * Actuator::of(rig).area_1,
            mass: rig.get(&keys::load::MASS_KG),
            lag: rig.get(&keys::empirical::DAMPING_PER_S)
                / rig.get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2),
        })
    }

    /// What the law of a controller knows at its last sample; None before the first.
    #[must_use]
    pub fn known(&self, state: &State) -> Option<Known> {
        match state.law() {
            Running::Cascade(law) => law.known().map(|known| self.convert(&known)),
            _ => None,
        }
    }

    fn convert(&self, known: &Integers) -> Known {
        let part = |value: i32, bits: i32| f64::from(value) / 2.0_f64.powi(bits);
        let place = |q16: i64| q16 as f64 / 65_536.0 * self.count;
        let speed = |q16: i32| part(q16, 16) * self.count / self.period;
        let force = |q24: i32| part(q24, 24) * self.force;
        Known {
            stage: f64::from(known.stage as u8),
            reference: place(known.reference.0),
            reference_velocity: speed(known.reference.1),
            position: place(known.motion.0),
            velocity: speed(known.motion.1),
            force: force(known.force),
            wanted_force: force(known.wanted),
            opposing_force: force(known.against),
            standing_force: force(known.standing),
            mass: part(known.mass, 16) * self.mass,
            friction: part(known.friction, 16),
            lag: part(known.pace, 16) * self.lag,
            looseness: f64::from(known.looseness),
        }
    }
}
