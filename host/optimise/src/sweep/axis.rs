//! The quantities that vary from point to point, and their values.
//!
//! A Latin hypercube of `n` draws has, for each key, exactly one draw in each `n`th of its probability: the
//! `n`ths are shuffled, and a draw lies anywhere in its own. Each key has its own stream of random numbers. A normal
//! distribution comes from the inverse of `P(x) = erfc(-x / sqrt 2) / 2`, found by bisection.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// One thing that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The key, or the name of the factor.
    pub name: String,
    /// The keys whose values the levels multiply; empty if a level is the value of the key `name`.
    pub scaled: Vec<String>,
    /// Its levels, as in `--set`: one for each value, or for each draw.
    pub levels: Vec<String>,
    /// Whether the levels were drawn.
    pub drawn: bool,
    /// Whether its graph has a logarithmic axis.
    pub logarithmic: bool,
}

impl Axis {
    /// The settings of a level, as `key=value`.
    pub fn settings<'a>(&'a self, rig: &'a Rig, level: &'a str) -> impl Iterator<Item = String> + 'a {
        let own = self.scaled.is_empty().then(|| format!("{}={level}", self.name));
        let factor: f64 = level.parse().unwrap_or(f64::NAN);
        own.into_iter().chain(
            self.scaled
                .iter()
                .map(move |key| format!("{key}={:?}", factor * rig.number_at(key).unwrap_or(0.0))),
        )
    }

    /// The places of its levels on a graph: their values, or 0, 1, 2... of words.
    #[must_use]
    pub fn place(&self, level: &str) -> f64 {
        let index = || self.levels.iter().position(|other| other == level).map_or(f64::NAN, |at| at as f64);
        level.parse().unwrap_or_else(|_| index())
    }

    /// Whether its levels are words.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.levels.iter().any(|level| level.parse::<f64>().is_err())
    }
}

/// From one number to another, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// First.
    pub from: f64,
    /// Last.
    pub to: f64,
    /// How many, 2 at least.
    pub steps: usize,
    /// Whether neighbours have the same ratio instead of the same difference.
    pub logarithmic: bool,
}

impl Range {
    /// Its numbers. The ends are exact.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        let last = self.steps - 1;
        let between = |step: usize| {
            let share = step as f64 / last as f64;
            if self.logarithmic {
                self.from * libm::pow(self.to / self.from, share)
            } else {
                self.from + share * (self.to - self.from)
            }
        };
        (0..self.steps).map(|step| if step == last { self.to } else { between(step) }).collect()
    }
}

/// A distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Even between two numbers.
    Uniform {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
}

impl Distribution {
    /// The value below which a share of all draws lies.
    #[must_use]
    pub fn quantile(&self, share: f64) -> f64 {
        match *self {
            Distribution::Uniform { low, high } => low + share * (high - low),
            Distribution::Normal { mean, deviation } => mean + deviation * standard_normal(share),
        }
    }
}

/// Where the standard normal distribution reaches a share, between -9 and 9.
fn standard_normal(share: f64) -> f64 {
    let below = |x: f64| libm::erfc(-x / std::f64::consts::SQRT_2) / 2.0;
    let halved = (0..60).fold((-9.0, 9.0), |(low, high), _| {
        let middle = (low + high) / 2.0;
        if below(middle) < share { (middle, high) } else { (low, middle) }
    });
    (halved.0 + halved.1) / 2.0
}

/// How shares of a distribution are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    /// Number of shares.
    pub count: usize,
    /// Seed: the same seed draws the same shares.
    pub seed: u64,
    /// One in each `count`th, or anywhere each time.
    pub latin_hypercube: bool,
}

impl Draw {
    /// Shares from 0 to 1, of the key with this number.
    #[must_use]
    pub fn shares(&self, key: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(key);
        if !self.latin_hypercube {
            return (0..self.count).map(|_| unit_interval(&mut random)).collect();
        }
        let mut strata: Vec<usize> = (0..self.count).collect();
        for last in (1..self.count).rev() {
            let other = (unit_interval(&mut random) * (last + 1) as f64) as usize;
            strata.swap(last, other.min(last));
        }
        let within = |stratum: usize| (stratum as f64 + unit_interval(&mut random)) / self.count as f64;
        strata.into_iter().map(within).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_its_ends_and_even_steps_or_ratios() {
        let linear = Range { from: 1.0, to: 2.0, steps: 5, logarithmic: false };
        assert_eq!(linear.values(), [1.0, 1.25, 1.5, 1.75, 2.0]);
        let values = Range { from: 0.1, to: 1000.0, logarithmic: true, ..linear }.values();
        assert_eq!((values[0], values[4]), (0.1, 1000.0));
        assert!(values.windows(2).all(|pair| (pair[1] / pair[0] - 10.0).abs() < 1e-12), "{values:?}");
    }

    #[test]
    fn a_latin_hypercube_has_one_draw_in_each_stratum_and_keys_are_shuffled_apart() {
        let draw = Draw { count: 50, seed: 7, latin_hypercube: true };
        let strata =
            |key: u64| draw.shares(key).iter().map(|share| (share * 50.0) as usize).collect::<Vec<_>>();
        for key in 0..4 {
            let mut sorted = strata(key);
            sorted.sort_unstable();
            assert_eq!(sorted, (0..50).collect::<Vec<_>>());
        }
        assert!(strata(0) != strata(1) && strata(0) != (0..50).collect::<Vec<_>>());
        let other = Draw { seed: 8, ..draw };
        assert!(draw.shares(0) == draw.shares(0) && draw.shares(0) != other.shares(0));
    }

    #[test]
    fn draws_at_random_leave_strata_empty() {
        let shares = Draw { count: 50, seed: 7, latin_hypercube: false }.shares(0);
        let mut strata: Vec<usize> = shares.iter().map(|share| (share * 50.0) as usize).collect();
        strata.sort_unstable();
        strata.dedup();
        assert!(shares.iter().all(|share| (0.0..1.0).contains(share)) && strata.len() < 45);
    }

    #[test]
    fn the_normal_distribution_has_its_tabulated_quantiles() {
        // Abramowitz and Stegun, table 26.5.
        let normal = Distribution::Normal { mean: 10.0, deviation: 2.0 };
        for (share, x) in [(0.5, 0.0), (0.975, 1.959_963_985), (0.999, 3.090_232_306), (0.01, -2.326_347_874)]
        {
            assert!((normal.quantile(share) - (10.0 + 2.0 * x)).abs() < 1e-8, "{share}");
        }
        assert!(normal.quantile(0.0) > -9.0 && normal.quantile(1.0) < 29.0);
    }
}
