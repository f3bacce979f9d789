//! Differential evolution (Storn and Price 1997, DE/current-to-best/1/bin): a population in the unit cube that
//! learns its steps from its own spread.
//!
//! ```text
//! trial_j = x_j + F (best_j - x_j) + F (a_j - b_j)     with probability C, and for one j at least; else x_j
//! ```
//!
//! with a new random F for each trial. A trial replaces its parent if it is not worse, so its evaluation can stop once it
//! is worse. A whole generation is evaluated at once.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// The size of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Candidates per generation.
    pub population: usize,
    /// Generations.
    pub generations: usize,
    /// Seed: the same seed tries the same candidates.
    pub seed: u64,
}

impl Budget {
    /// Candidates and generations for eleven numbers.
    pub const OF_GAINS: [usize; 2] = [24, 25];

    /// Candidates and generations of a search on a rig, unless others are requested: a law that knows its drive has three
    /// numbers to search, other laws have eleven.
    #[must_use]
    pub fn usual(rig: &Rig) -> [usize; 2] {
        if rig.knows_its_drive() { [8, 6] } else { Budget::OF_GAINS }
    }

    /// Most runs of a search whose candidates make this many runs each.
    #[must_use]
    pub fn runs(&self, each: usize) -> usize {
        self.population * self.generations * each
    }
}

/// Range of F, and C.
const SCALE: [f64; 2] = [0.4, 0.9];
const CROSSING: f64 = 0.8;

/// The result.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The last generation, the best candidate first.
    pub population: Vec<Vec<f64>>,
    /// The least cost of each generation.
    pub history: Vec<f64>,
}

/// Looks for the least cost in the unit cube of `dimensions`, from `start` on and, as far as that does not reach,
/// from anywhere. `costs` is given candidates, and for each the cost above which it does not matter.
pub fn search(
    dimensions: usize,
    budget: &Budget,
    start: &[Vec<f64>],
    mut costs: impl FnMut(&[Vec<f64>], &[f64]) -> Vec<f64>,
) -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(budget.seed);
    let mut share = || unit_interval(&mut random);
    let anywhere = budget.population.saturating_sub(start.len());
    let drawn: Vec<Vec<f64>> = (0..anywhere).map(|_| (0..dimensions).map(|_| share()).collect()).collect();
    let mut population: Vec<Vec<f64>> = start.iter().take(budget.population).cloned().chain(drawn).collect();
    let mut cost = costs(&population, &vec![f64::INFINITY; population.len()]);
    let mut history = Vec::new();
    for generation in 0..budget.generations {
        if generation > 0 {
            let best = population[least(&cost)].clone();
            let trials: Vec<Vec<f64>> =
                (0..population.len()).map(|parent| trial(&population, parent, &best, &mut share)).collect();
            let found = costs(&trials, &cost);
            for (place, (trial, found)) in trials.into_iter().zip(found).enumerate() {
                if found <= cost[place] {
                    (population[place], cost[place]) = (trial, found);
                }
            }
        }
        history.push(cost[least(&cost)]);
    }
    let mut order: Vec<usize> = (0..population.len()).collect();
    order.sort_by(|&a, &b| cost[a].total_cmp(&cost[b]));
    let population = order.into_iter().map(|place| population[place].clone()).collect();
    Outcome { population, history }
}

fn least(cost: &[f64]) -> usize {
    (0..cost.len()).min_by(|&a, &b| cost[a].total_cmp(&cost[b])).unwrap_or(0)
}

fn trial(population: &[Vec<f64>], parent: usize, best: &[f64], share: &mut impl FnMut() -> f64) -> Vec<f64> {
    let mut below = |end: usize| ((share() * end as f64) as usize).min(end - 1);
    let (a, b, certain) = (below(population.len()), below(population.len()), below(best.len()));
    let scale = SCALE[0] + (SCALE[1] - SCALE[0]) * share();
    let x = &population[parent];
    (0..best.len())
        .map(|j| {
            if share() < CROSSING || j == certain {
                reflected(x[j] + scale * (best[j] - x[j]) + scale * (population[a][j] - population[b][j]))
            } else {
                x[j]
            }
        })
        .collect()
}

/// Back into the unit interval, as by mirrors at its ends.
fn reflected(x: f64) -> f64 {
    let folded = x.rem_euclid(2.0);
    if folded > 1.0 { 2.0 - folded } else { folded }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Budget = Budget { population: 20, generations: 60, seed: 3 };

    /// A bent valley, and a wall beside it.
    fn cost(x: &[f64]) -> f64 {
        let valley = 100.0 * (x[1] - x[0] * x[0]).powi(2) + (x[0] - 0.7).powi(2) + (x[2] - 0.2).powi(2);
        if x[2] > 0.5 { 1e3 } else { valley }
    }

    fn costs(candidates: &[Vec<f64>], _: &[f64]) -> Vec<f64> {
        candidates.iter().map(|x| cost(x)).collect()
    }

    #[test]
    fn the_bottom_of_a_bent_valley_is_found() {
        let outcome = search(3, &BUDGET, &[], costs);
        for (found, bottom) in outcome.population[0].iter().zip([0.7, 0.49, 0.2]) {
            assert!((found - bottom).abs() < 1e-3, "{outcome:?}");
        }
        assert!(outcome.history.is_sorted_by(|a, b| a >= b), "it never gets worse");
        assert_eq!(outcome.history.len(), BUDGET.generations);
    }

    #[test]
    fn a_seed_finds_the_same_and_a_start_is_gone_on_from() {
        let outcome = search(3, &BUDGET, &[], costs);
        assert_eq!(outcome, search(3, &BUDGET, &[], costs));
        let on = search(3, &Budget { generations: 1, ..BUDGET }, &outcome.population, costs);
        assert_eq!(on.population[0], outcome.population[0]);
    }

    #[test]
    fn a_candidate_is_told_what_it_must_beat() {
        let outcome = search(3, &BUDGET, &[], |candidates, limits| {
            candidates.iter().zip(limits).map(|(x, limit)| cost(x).min(*limit + 1.0)).collect()
        });
        assert_eq!(outcome, search(3, &BUDGET, &[], costs), "what is above its limit does not matter");
    }

    #[test]
    fn no_candidate_leaves_the_cube() {
        assert_eq!([-0.25, 0.0, 0.5, 1.0, 1.25, 2.5].map(reflected), [0.25, 0.0, 0.5, 1.0, 0.75, 0.5]);
    }
}
