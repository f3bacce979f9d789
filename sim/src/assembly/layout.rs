//! The index of each state and each guard of the assembly: one list gives all indices.

use super::Parts;
use crate::component::friction::{self, States};
use crate::component::operator::{self, SpoolState};

/// A list of names, each with how many entries it has, becomes their places and the number of all.
macro_rules! layout {
    ($total:ident at $place:expr;) => {
        pub const $total: usize = $place;
    };
    ($total:ident at $place:expr; $(#[$about:meta])* $name:ident, $($rest:tt)*) => {
        $(#[$about])*
        pub const $name: usize = $place;
        layout! { $total at $place + 1; $($rest)* }
    };
    ($total:ident at $place:expr; $(#[$about:meta])* $name:ident: $count:expr, $($rest:tt)*) => {
        $(#[$about])*
        pub const $name: [usize; $count] = super::places($place);
        layout! { $total at $place + $count; $($rest)* }
    };
}

const fn places<const COUNT: usize>(first: usize) -> [usize; COUNT] {
    let mut places = [0; COUNT];
    let mut i = 0;
    while i < COUNT {
        places[i] = first + i;
        i += 1;
    }
    places
}

/// Places in the state vector, SI.
pub(crate) mod slot {
    use super::friction;

    layout! {
        COUNT at 0;
        POSITION,
        VELOCITY,
        MASS: 2,
        EXNER: 2,
        /// Pressure behind a lagged tube over that at its known end: supply, cylinder 1, cylinder 2.
        RATIO: 3,
        SPOOL,
        SPOOL_VELOCITY,
        /// Pressures of lagged sensors, Pa.
        SENSED: 2,
        /// The states of the friction model of the load.
        FRICTION: friction::STATES,
    }

    /// Mass and Exner pressure of the air in a receiver, in the places of lagged tubes: no drive has both. More than 16 states
    /// would cost all drives 4 %, as the compiler then copies them by a call.
    pub const RECEIVER: [usize; 2] = [RATIO[0], RATIO[1]];
}

/// Places among the guards that are read from the state.
pub(crate) mod guard {
    use super::operator;

    layout! {
        COUNT at 0;
        /// Stiction of the load.
        LOAD_FRICTION,
        /// Stops of the load, and spears of its cushions.
        LOAD_STOPS,
        /// The farther and the nearer end of the entry of the gain profile.
        PROFILE: 2,
        /// The edges of the lands.
        LANDS: 2,
        /// The operator's own.
        OPERATOR: operator::GUARDS,
    }

    /// The first guard of the spool: the edges of the lands, then the operator's.
    pub const SPOOL: usize = LANDS[0];
    /// The first guard of the operator.
    pub const FIRST_OF_OPERATOR: usize = OPERATOR[0];
}

/// Number of states.
pub(crate) const STATES: usize = slot::COUNT;
/// Position, velocity and air come first: they move alone where the spool has a closed form, nothing lags and the load's
/// friction has no states.
pub(crate) const CORE: usize = slot::RATIO[0];
/// The states of lagged tubes, or of a receiver, come next.
pub(crate) const LAGGED: usize = slot::SPOOL;
/// Then the states of the spool, of lagged sensors, and of the load's friction.
pub(crate) const USUAL: usize = slot::SENSED[0];
/// Guards read from the state.
pub(crate) const GUARDS: usize = guard::COUNT;
/// Guards that need the flows: the direction of the air in each port.
pub(crate) const END_GUARDS: usize = 2;
/// Guards of the spool.
pub(super) const SPOOL_GUARDS: usize = GUARDS - guard::SPOOL;

/// The state vector.
pub(crate) type StateVector = [f64; STATES];

/// The scale of each state, for the integrator's tolerance: m, m/s, kg and w (relative to themselves, hence small),
/// ratios of pressures, m, m/s, Pa.
const SCALE: StateVector = {
    let mut scale = [1.0; STATES];
    scale[slot::POSITION] = 0.1;
    scale[slot::MASS[0]] = 1e-5;
    scale[slot::MASS[1]] = 1e-5;
    scale[slot::SPOOL] = 1e-3;
    scale[slot::SENSED[0]] = 1e5;
    scale[slot::SENSED[1]] = 1e5;
    scale
};

/// The same, with the scales of a load's friction states, and of the air in a receiver and in a pocket.
pub(crate) fn scale_of(parts: &Parts) -> StateVector {
    let mut scale = SCALE;
    for (place, large) in slot::FRICTION.into_iter().zip(parts.load.friction.scale()) {
        scale[place] = *large;
    }
    if parts.receiver.is_some() {
        scale[slot::RECEIVER[0]] = scale[slot::MASS[0]];
    }
    if let Some([mass, exner]) = parts.cushions.map(|own| own.places) {
        (scale[mass], scale[exner]) = (scale[slot::MASS[0]], scale[slot::EXNER[0]]);
    }
    scale
}

/// The states of the load's friction.
#[inline(always)]
pub(super) fn friction_states(x: &StateVector) -> States {
    slot::FRICTION.map(|i| x[i])
}

/// The spool's part of the state.
pub(super) fn spool_state(x: &StateVector) -> SpoolState {
    SpoolState { position: x[slot::SPOOL], velocity: x[slot::SPOOL_VELOCITY] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_taken_once() {
        let single = [slot::POSITION, slot::VELOCITY, slot::SPOOL, slot::SPOOL_VELOCITY];
        let mut all =
            [&single[..], &slot::MASS, &slot::EXNER, &slot::RATIO, &slot::SENSED, &slot::FRICTION].concat();
        all.sort_unstable();
        assert_eq!(all, (0..STATES).collect::<Vec<_>>());
        let mut guards = vec![guard::LOAD_FRICTION, guard::LOAD_STOPS];
        guards.extend([&guard::PROFILE[..], &guard::LANDS, &guard::OPERATOR].concat());
        guards.sort_unstable();
        assert_eq!(guards, (0..GUARDS).collect::<Vec<_>>());
    }
}
