//! Friction of the load: the models, and their interface to the drive. A model is a file and its line in `models!`.
//!
//! Positive means extension; friction counts positive against it. The static and the Coulomb force by direction are
//! common to all models.

mod coast;
pub mod dry;
pub mod lugre;

pub use coast::{Stop, coast};
pub use dry::{Contact, DryFriction};

use crate::key::{Key, keys, words};
use crate::values::{Findings, Rig};

keys! {
    FRICTION: FrictionKind = choice("load.friction", "", "Model of the friction.");
    STATIC_EXTEND_N: f64 = number("load.static_extend_n", 70.0, 0.0, 1e5, "C(46)", "Stiction, extending.").spread().vague();
    COULOMB_EXTEND_N: f64 = number("load.coulomb_extend_n", 40.0, 0.0, 1e5, "C(47)", "Coulomb friction, extending.").spread().vague();
    STATIC_RETRACT_N: f64 = number("load.static_retract_n", 40.0, 0.0, 1e5, "C(48)", "Stiction, retracting.").spread().vague();
    COULOMB_RETRACT_N: f64 = number("load.coulomb_retract_n", 11.0, 0.0, 1e5, "C(49)", "Coulomb friction, retracting.").spread().vague();
}

/// A body on its friction at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Mass, kg.
    pub mass: f64,
    /// Viscous friction, N s/m, which is among the applied forces.
    pub viscous: f64,
    /// All forces but the friction of the model, N.
    pub applied: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// The motion of the body.
    pub contact: Contact,
    /// The states of the model.
    pub states: States,
}

/// s: over which a force is differenced.
const MOMENT: f64 = 1e-7;

/// The interface of a friction model to the drive.
pub trait FrictionModel: Sized {
    /// The scale of each of its states, for the integrator's tolerance.
    const SCALE: &'static [f64] = &[];

    /// What they are called, with their units.
    const NAMES: &'static [&'static str] = &[];

    /// The friction of a rig's load.
    fn of(rig: &Rig) -> Self;

    /// The constraints on the keys of the model.
    fn check(_rig: &Rig, _findings: &mut Findings) {}

    /// The motion of a body at rest under a force (N), and the states.
    fn at_rest(&self, applied: f64) -> (Contact, States);

    /// The speed up to which a held body may creep, m/s: a faster one slides.
    fn creep(&self) -> f64 {
        0.0
    }

    /// The friction force, N.
    fn force(&self, body: &Body) -> f64;

    /// Its rate, N/s, for the acceleration of the body (m/s^2) and the rate of the applied force (N/s).
    fn force_rate(&self, body: &Body, acceleration: f64, applied_rate: f64) -> f64 {
        let rates = self.derivative(body);
        let force_in = |time: f64| {
            self.force(&Body {
                applied: body.applied + applied_rate * time,
                velocity: body.velocity + acceleration * time,
                states: std::array::from_fn(|i| body.states[i] + rates[i] * time),
                ..*body
            })
        };
        (force_in(MOMENT) - force_in(-MOMENT)) / (2.0 * MOMENT)
    }

    /// The derivatives of the states.
    fn derivative(&self, _body: &Body) -> States {
        States::default()
    }

    /// Not negative as long as the contact holds.
    fn guard(&self, _body: &Body) -> f64 {
        1.0
    }

    /// The contact after the guard has become negative under a force, N.
    fn after(&self, contact: Contact, _applied: f64) -> Contact {
        contact
    }
}

/// The constraints on the friction of a load, whatever its model.
fn check_forces(rig: &Rig, findings: &mut Findings) {
    let why = "a body that slips must not be held more than one that sticks";
    findings.not_above(rig, &keys::COULOMB_EXTEND_N, &keys::STATIC_EXTEND_N, why);
    findings.not_above(rig, &keys::COULOMB_RETRACT_N, &keys::STATIC_RETRACT_N, why);
}

/// Lists the models: each with its word in a rig file, its file and its type. Keys, checks and calls follow from the list.
macro_rules! models {
    ($($word:literal => $name:ident($file:ident::$model:ident), $about:literal;)+) => {
        words! {
            /// Kind of friction.
            pub enum FrictionKind {
                $(#[doc = $about] $name = $word,)+
            }
        }

        /// The friction of a load.
        #[derive(Clone, Copy, Debug)]
        pub enum Friction {
            $(#[doc = $about] $name($file::$model),)+
        }

        /// The most states that a model has.
        pub const STATES: usize = most(&[$(<$file::$model as FrictionModel>::SCALE.len()),+]);

        /// The keys of all models.
        pub(crate) static KEYS: &[&[&Key]] = &[keys::ALL, $($file::keys::ALL),+];

        /// The constraints on the friction of a load.
        pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
            check_forces(rig, findings);
            match rig.get(&keys::FRICTION) {
                $(FrictionKind::$name => <$file::$model as FrictionModel>::check(rig, findings),)+
            }
        }

        impl Friction {
            /// The scale of each state, for the integrator's tolerance.
            #[must_use]
            pub fn scale(&self) -> &'static [f64] {
                match self { $(Friction::$name(_) => <$file::$model as FrictionModel>::SCALE,)+ }
            }

            /// What each state is called, with its unit.
            #[must_use]
            pub fn state_names(&self) -> &'static [&'static str] {
                match self { $(Friction::$name(_) => <$file::$model as FrictionModel>::NAMES,)+ }
            }
        }

        // Each arm has a copy of the body, so that a model that takes it by its address costs the others nothing.
        impl FrictionModel for Friction {
            fn of(rig: &Rig) -> Friction {
                match rig.get(&keys::FRICTION) {
                    $(FrictionKind::$name => Friction::$name(FrictionModel::of(rig)),)+
                }
            }

            fn at_rest(&self, applied: f64) -> (Contact, States) {
                match self { $(Friction::$name(model) => FrictionModel::at_rest(model, applied),)+ }
            }

            fn creep(&self) -> f64 {
                match self { $(Friction::$name(model) => model.creep(),)+ }
            }

            #[inline(always)]
            fn force(&self, body: &Body) -> f64 {
                match self { $(Friction::$name(model) => FrictionModel::force(model, &{ *body }),)+ }
            }

            fn force_rate(&self, body: &Body, acceleration: f64, applied_rate: f64) -> f64 {
                match self { $(Friction::$name(model) => model.force_rate(body, acceleration, applied_rate),)+ }
            }

            #[inline(always)]
            fn derivative(&self, body: &Body) -> States {
                match self { $(Friction::$name(model) => model.derivative(&{ *body }),)+ }
            }

            #[inline(always)]
            fn guard(&self, body: &Body) -> f64 {
                match self { $(Friction::$name(model) => FrictionModel::guard(model, &{ *body }),)+ }
            }

            fn after(&self, contact: Contact, applied: f64) -> Contact {
                match self { $(Friction::$name(model) => FrictionModel::after(model, contact, applied),)+ }
            }
        }
    };
}

/// The states of a model: the first ones of these.
pub type States = [f64; STATES];

const fn most(counts: &[usize]) -> usize {
    let (mut most, mut i) = (0, 0);
    while i < counts.len() {
        most = if counts[i] > most { counts[i] } else { most };
        i += 1;
    }
    most
}

models! {
    "coulomb" => Coulomb(dry::DryFriction), "Stiction and Coulomb friction.";
    "lugre" => LuGre(lugre::LuGre), "Bristles under a film of lubricant.";
}
