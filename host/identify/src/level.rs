//! Friction that differs between the directions as on an inclined drive.
//!
//! ```text
//! d_i   = s_i (found_i - file_i) = F + e_i      s = 1: stiction and Coulomb friction of extension, -1: of retraction
//! F     = sum of w_i d_i / sum of w_i           w_i = 1 / file_i^2: friction is known to a part of it
//! sigma = root of (sum of w_i (d_i - F)^2 / (n - 1))
//! t     = F root(sum of w_i) / sigma            Student's t of n - 1 degrees of freedom where there is no F
//! F     = m g sin(incline)
//!
//! m g sin(incline) = m g sin(fitted) + F                         of a fit that has an incline among its parameters
//! ```
//!
//! The weight of a load on an incline adds the same force to all four. A transient cannot distinguish it from friction that
//! really differs (docs/howto/identification.md); but four values that deviate from the file's by the same force, up in one
//! direction and down in the other, are seldom due to chance.

use nalgebra::DVector;
use pneudrive_sim::keys;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::found::Found;
use super::model::FittedModel;
use super::posterior::NORMAL_95;

/// m/s^2.
const GRAVITY: f64 = 9.806_65;

/// The four, each with its sign.
const FRICTIONS: [(&str, f64); 4] = [
    (keys::friction::STATIC_EXTEND_N.key.path, 1.0),
    (keys::friction::COULOMB_EXTEND_N.key.path, 1.0),
    (keys::friction::STATIC_RETRACT_N.key.path, -1.0),
    (keys::friction::COULOMB_RETRACT_N.key.path, -1.0),
];

/// Friction that is down to this part of the file's is gone: a larger force cannot take more.
const GONE: f64 = 0.1;

/// Fewest values that show a common force, and the least error of one, N.
const FEWEST: usize = 3;
const MIN_ERROR: f64 = 1e-3;

/// A common force is reported if chance gives one as clear less often than this.
const CHANCE: f64 = 0.01;

/// Difference in u for a slope.
const STEP: f64 = 1e-4;

/// What a drive that somebody has levelled may be off by, degrees, standard deviation.
pub(super) const LEVELLING_ERROR_DEG: f64 = 2.0;

/// An incline that would explain how friction differs from the file's, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incline {
    /// The angle, degrees; positive where extension goes up.
    pub degrees: f64,
    /// Ends of its 95 % interval.
    pub interval: [f64; 2],
    /// The common force, N.
    pub force: f64,
    /// Ends of its 95 % interval.
    pub forces: [f64; 2],
}

impl Incline {
    /// Ends of what friction of a key is less without the incline, N; None for another key.
    #[must_use]
    pub(crate) fn takes_from(&self, path: &str) -> Option<[f64; 2]> {
        let (_, sign) = FRICTIONS.iter().find(|(known, _)| *known == path)?;
        let [a, b] = self.forces.map(|force| sign * force);
        Some([a.min(b), a.max(b)])
    }
}

/// A force that several values have in common.
#[derive(Clone, Copy, Debug)]
struct Common {
    force: f64,
    error: f64,
    /// Degrees of freedom of the error.
    freedom: f64,
}

impl Common {
    /// How often values with no force in common have as large a one.
    fn chance(&self) -> f64 {
        let ratio = self.force.abs() / self.error.max(MIN_ERROR);
        StudentsT::new(0.0, 1.0, self.freedom).map_or(1.0, |t| 2.0 * t.sf(ratio))
    }

    /// Half the width of its 95 % interval.
    fn half_width(&self) -> f64 {
        let t = StudentsT::new(0.0, 1.0, self.freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
        self.error * t
    }
}

/// The force that file and found values have in common, each with its sign.
fn common(values: &[(f64, f64, f64)]) -> Common {
    let freedom = values.len() as f64 - 1.0;
    let off: Vec<(f64, f64)> =
        values.iter().map(|(sign, file, found)| (file.powi(-2), sign * (found - file))).collect();
    let weights: f64 = off.iter().map(|(weight, _)| weight).sum();
    let force = off.iter().map(|(weight, d)| weight * d).sum::<f64>() / weights;
    let scatter = off.iter().map(|(weight, d)| weight * (d - force).powi(2)).sum::<f64>() / freedom;
    Common { force, error: (scatter / weights).sqrt(), freedom }
}

/// The incline that a fit suggests, where it is more than a drive that was levelled has; None where the incline or a
/// constant force is fitted, or not all friction is.
pub(super) fn suggested(model: &FittedModel, u: &[f64]) -> Option<Incline> {
    let is_fitted = |path: &str| model.parameters.iter().any(|parameter| parameter.key.path == path);
    if is_fitted(keys::load::INCLINE_DEG.path) || is_fitted(keys::load::CONSTANT_FORCE_N.path) {
        return None;
    }
    let hung = Hung::at(model, u)?;
    if hung.common.chance() > CHANCE {
        return None;
    }
    let incline = hung.incline(hung.common.half_width());
    let file = model.rig.get(&keys::load::INCLINE_DEG);
    ((incline.degrees - file).abs() > 2.0 * LEVELLING_ERROR_DEG).then_some(incline)
}

/// The incline of a fit that has one among its parameters: with the force that its friction has in common. What the fit
/// leaves to friction instead does not matter. None where not all friction is fitted.
pub(super) fn fitted(model: &FittedModel, found: &Found) -> Option<Incline> {
    let u = &found.minimum.u;
    let hung = Hung::at(model, u)?;
    let mut slopes = DVector::zeros(u.len());
    for i in 0..model.parameters.len() {
        // An error of the weight is one of the angle, too: in N of the weight that was found.
        let force = |step: f64| {
            let mut u = u.clone();
            u[i] += step;
            Hung::at(model, &u).map(|there| (there.own + there.common.force) / there.weight * hung.weight)
        };
        slopes[i] = (force(STEP)? - force(-STEP)?) / (2.0 * STEP);
    }
    Some(hung.incline(hung.common.half_width().hypot(NORMAL_95 * found.error(model, &slopes))))
}

/// What pulls a load down its incline.
struct Hung {
    /// Its weight, N.
    weight: f64,
    /// The part of its weight by the incline of the rig, N.
    own: f64,
    /// What friction has in common besides.
    common: Common,
}

impl Hung {
    /// At a point; None where not all friction is fitted, or too much of it is gone.
    fn at(model: &FittedModel, u: &[f64]) -> Option<Hung> {
        let mut values = Vec::new();
        for (path, sign) in FRICTIONS {
            let place = model.parameters.iter().position(|parameter| parameter.key.path == path)?;
            let parameter = &model.parameters[place];
            values.push((sign, parameter.start, parameter.value(u[place])));
        }
        values.retain(|(_, file, found)| *found > GONE * file);
        if values.len() < FEWEST {
            return None;
        }
        let rig = model.rig_at(u).ok()?;
        let weight = GRAVITY * rig.get(&keys::load::MASS_KG);
        let own = weight * rig.get(&keys::load::INCLINE_DEG).to_radians().sin();
        Some(Hung { weight, own, common: common(&values) })
    }

    /// The incline that has all of the force, which is known to so many N either way.
    fn incline(&self, half_width: f64) -> Incline {
        let force = self.common.force;
        let degrees = |force: f64| ((self.own + force) / self.weight).clamp(-1.0, 1.0).asin().to_degrees();
        let forces = [force - half_width, force + half_width];
        Incline { degrees: degrees(force), interval: forces.map(degrees), force, forces }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: [f64; 4] = [70.0, 40.0, 40.0, 11.0];

    fn common_of(found: [f64; 4]) -> Common {
        let values: Vec<_> = (0..4).map(|i| (FRICTIONS[i].1, FILES[i], found[i])).collect();
        common(&values)
    }

    #[test]
    fn four_frictions_that_one_force_moves_tell_it() {
        let common = common_of([78.5, 47.0, 32.4, 3.4]);
        let Common { force, error, .. } = common;
        assert!((force - 7.6).abs() < 3.0 * error && error < 0.3, "{force} {error}");
        assert!(common.chance() < CHANCE);
    }

    #[test]
    fn an_incline_takes_from_friction_alone() {
        let incline = Incline { degrees: 30.0, interval: [29.0, 31.0], force: 7.8, forces: [7.6, 8.0] };
        assert_eq!(incline.takes_from("load.coulomb_extend_n"), Some([7.6, 8.0]));
        assert_eq!(incline.takes_from("load.coulomb_retract_n"), Some([-8.0, -7.6]));
        assert_eq!(incline.takes_from("valve.null_offset_mm"), None);
    }

    #[test]
    fn friction_that_is_stronger_one_way_by_parts_of_its_own_tells_no_force() {
        for found in [[84.0, 48.0, 36.0, 9.9], [77.0, 44.0, 44.0, 12.1], [63.0, 44.0, 36.0, 11.0]] {
            assert!(common_of(found).chance() > CHANCE, "{found:?}");
        }
    }
}
