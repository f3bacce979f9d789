//! What brings the piston of a single-acting cylinder back, where the air does not ([`crate::component::actuator::vent`]):
//!
//! ```text
//! +-(F_const - k y + F_s - M g sin(incline)) > F_H        + with chamber 1 vented, - with chamber 2
//! ```
//!
//! The left side is linear in y, so that it is least at an end of the stroke. F_H is the stiction against the way back.

use super::Load;
use crate::component::actuator::{self, vent};
use crate::component::friction;
use crate::values::Rig;

/// What pushes the piston of a single-acting cylinder back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Return {
    /// The least force along the stroke, N: of springs, weight and constant force; negative where it pushes with the air.
    pub least: f64,
    /// The friction that holds the load, N.
    pub friction: f64,
}

impl Return {
    /// That of a rig's cylinder; None of a double-acting one.
    #[must_use]
    pub fn of(rig: &Rig) -> Option<Return> {
        let chamber = rig.get(&vent::keys::VENTED).chamber()?;
        let (sign, sticks) = match chamber {
            0 => (1.0, &friction::keys::STATIC_EXTEND_N),
            _ => (-1.0, &friction::keys::STATIC_RETRACT_N),
        };
        let load = Load::of(rig);
        let at = |position: f64| sign * load.standing_force(position);
        let least = at(0.0).min(at(rig.get(&actuator::keys::STROKE_M)));
        Some(Return { least, friction: rig.get(sticks) })
    }

    /// Whether the piston comes back from any place.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.least > self.friction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_returns_the_piston_is_the_least_force_along_the_stroke() {
        let of = |settings: &[&str]| {
            let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
            Return::of(&Rig::read_with("rig", "", &settings).unwrap_or_else(|problems| panic!("{problems}")))
        };
        let spring = ["actuator.return_spring_preload_n=90", "actuator.return_spring_stiffness_n_per_m=300"];
        assert_eq!(of(&[]), None);
        let retracts =
            [&spring[..], &["actuator.vented=chamber-2", "actuator.return_spring=retract"]].concat();
        let found = of(&retracts).expect("single-acting");
        assert!((found.least - 90.0).abs() < 1e-9 && found.is_complete(), "{found:?}");
        let extends = [&spring[..], &["actuator.vented=chamber-1", "actuator.return_spring=extend"]].concat();
        let found = of(&extends).expect("single-acting");
        assert!((found.least - 90.0).abs() < 1e-9 && found.is_complete(), "{found:?}");
        let alone = of(&["actuator.vented=chamber-2"]).expect("single-acting");
        assert!(alone.least == 0.0 && !alone.is_complete(), "{alone:?}");
        let turned = of(&["actuator.vented=chamber-1", "load.constant_force_n=-30"]).expect("single-acting");
        assert!((turned.least + 30.0).abs() < 1e-12 && !turned.is_complete(), "{turned:?}");
    }
}
