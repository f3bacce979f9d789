//! The sensor noise of a simulated rig, run by run.
//!
//! Every run has different noise, as on a real rig; the seed fixes the whole sequence:
//!
//! ```text
//! seed of run 1 = seed
//! seed of run n = mix(seed + (n - 1) 0x9e3779b97f4a7c15)      n > 1, modulo 2^64
//! ```
//!
//! with the mixing function of SplitMix64 (Steele, Lea and Flood 2014, figure 17).

/// The odd number nearest to 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The seeds of a rig's runs, in their order.
#[derive(Clone, Copy, Debug)]
pub struct RunSeeds {
    seed: u64,
    runs: u64,
}

impl RunSeeds {
    /// Those of a rig whose first run has this seed.
    #[must_use]
    pub fn new(seed: u64) -> RunSeeds {
        RunSeeds { seed, runs: 0 }
    }

    /// Runs that have begun.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Begins a run and returns its seed.
    pub fn begin(&mut self) -> u64 {
        self.runs += 1;
        if self.runs == 1 {
            self.seed
        } else {
            mix(self.seed.wrapping_add((self.runs - 1).wrapping_mul(GOLDEN)))
        }
    }
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runs_of_neighbouring_seeds_have_nothing_in_common() {
        let mut all: Vec<u64> = (0..50)
            .flat_map(|seed| {
                let mut seeds = RunSeeds::new(seed);
                (0..50).map(move |_| seeds.begin())
            })
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 2500);
    }
}
