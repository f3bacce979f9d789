//! How firmly dry friction holds the load of a simulated run.

use pneudrive_records::run_folder::Holding;

/// Dry friction beside that at which the load breaks away.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionUse {
    /// The friction at each instant as a part of that at which the load breaks away in its direction: 1 or -1 there.
    pub used: Vec<f64>,
    /// The part that a change of 1 kPa in chambers 1 and 2 adds or takes at most.
    pub per_kpa: [f64; 2],
}

impl FrictionUse {
    /// The grip of frictions (N); None for a load that nothing holds.
    #[must_use]
    pub fn of(holding: &Holding, friction: impl Iterator<Item = f64>) -> Option<FrictionUse> {
        let [extend, retract] = holding.breakaway_n;
        let weakest = extend.min(retract);
        let used = |friction: f64| friction / if friction < 0.0 { retract } else { extend };
        (weakest > 0.0).then(|| FrictionUse {
            used: friction.map(used).collect(),
            per_kpa: holding.areas_m2.map(|area| 1e3 * area / weakest),
        })
    }

    /// Linear interpolation between two places.
    #[must_use]
    pub fn between(&self, first: usize, end: usize) -> FrictionUse {
        FrictionUse { used: self.used[first..end].to_vec(), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_is_a_part_of_that_at_which_the_load_breaks_away_in_its_direction() {
        let holding = Holding { breakaway_n: [80.0, 40.0], areas_m2: [2e-3, 1e-3] };
        let grip = FrictionUse::of(&holding, [20.0, -20.0, 0.0].into_iter()).expect("friction");
        assert_eq!(grip.used, [0.25, -0.5, 0.0]);
        assert_eq!(grip.per_kpa, [0.05, 0.025]);
        assert_eq!(grip.between(1, 2).used, [-0.5]);
        let smooth = Holding { breakaway_n: [0.0, 40.0], ..holding };
        assert_eq!(FrictionUse::of(&smooth, std::iter::empty()), None);
    }
}
