//! How far the paths of a valve are open over its spool, as a data sheet tells it: as shares of their conductances.
//!
//! ```text
//! linear    a = c + (1 - c) z/(X_max - lap)  for z > 0,  c for z <= 0       z_1 = x - lap, z_2 = -x - lap
//! table     a = the curve through its points at +x/X_max (land 1) and -x/X_max (land 2)
//! ```
//!
//! c is the leakage of a shut path. The points of a table have any overlap and leakage in them; the curve between them is that
//! of [`crate::monotone`]. The third characteristic, that of lands with a sleeve and a spool, is an area (6.38).

use crate::monotone::Monotone;

/// A characteristic that a data sheet gives.
#[derive(Clone, Debug, PartialEq)]
pub enum Characteristic {
    /// In proportion to the opening.
    Linear {
        /// c, from 0 to below 1.
        leakage: f64,
    },
    /// Share of the conductance over spool/travel.
    Table(Monotone),
}

impl Characteristic {
    /// The share of its conductance that a path has with its edge open by `opening` (m) or shut, of a valve with a travel and
    /// a lap (m). Beyond the edge it goes on smoothly a little.
    pub(super) fn share(&self, opening: f64, is_open: bool, [travel, lap]: [f64; 2]) -> f64 {
        match self {
            Characteristic::Linear { leakage } if is_open => {
                leakage + (1.0 - leakage) * opening / (travel - lap)
            }
            Characteristic::Linear { leakage } => *leakage,
            Characteristic::Table(curve) => curve.at((opening + lap) / travel).0,
        }
    }
}

/// Whether the rows make a curve of shares that rises.
pub(super) fn check_table(rows: &[Vec<f64>]) -> Result<(), &'static str> {
    let within = |row: &Vec<f64>| (-100.0..=100.0).contains(&row[0]) && (0.0..=100.0).contains(&row[1]);
    if !rows.iter().all(within) {
        Err("the spool lies from -100 to 100 %, the conductance from 0 to 100 %")
    } else if rows.windows(2).any(|pair| pair[1][0] <= pair[0][0]) {
        Err("its rows stand in rising order of the spool")
    } else if rows.windows(2).any(|pair| pair[1][1] < pair[0][1]) {
        Err("the conductance of path 1 does not fall as the spool moves to positive")
    } else if rows.last().is_none_or(|row| row[1] != 100.0) {
        Err("its last row has 100 % of the conductance: C is that of the valve fully open")
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Travel 1 mm, overlap 0.1 mm.
    const SPOOL: [f64; 2] = [1e-3, 0.1e-3];

    #[test]
    fn a_linear_characteristic_goes_from_the_leakage_to_the_whole() {
        let linear = Characteristic::Linear { leakage: 0.02 };
        for (opening, is_open, share) in
            [(-0.5e-3, false, 0.02), (0.0, true, 0.02), (0.45e-3, true, 0.51), (0.9e-3, true, 1.0)]
        {
            assert!((linear.share(opening, is_open, SPOOL) - share).abs() < 1e-15, "{opening}");
        }
    }

    #[test]
    fn a_table_is_read_at_the_place_of_the_spool_whatever_the_lap() {
        let rows = [[-1.0, 0.01], [0.0, 0.01], [0.5, 0.4], [1.0, 1.0]];
        let [x, y] = [0, 1].map(|i| rows.iter().map(|row| row[i]).collect());
        let table = Characteristic::Table(Monotone::through(x, y));
        for (spool, share) in [(-0.7e-3, 0.01), (0.5e-3, 0.4), (1e-3, 1.0), (1.2e-3, 1.0)] {
            assert!((table.share(spool - SPOOL[1], true, SPOOL) - share).abs() < 1e-15, "{spool}");
        }
    }

    #[test]
    fn a_table_that_is_no_characteristic_is_refused_with_the_reason() {
        for (rows, says) in [
            (vec![vec![0.0, 1.0], vec![100.0, 90.0]], "100 %"),
            (vec![vec![0.0, 1.0], vec![0.0, 100.0]], "rising order"),
            (vec![vec![0.0, 2.0], vec![50.0, 1.0], vec![100.0, 100.0]], "does not fall"),
            (vec![vec![-120.0, 0.0], vec![100.0, 100.0]], "-100 to 100"),
        ] {
            assert!(check_table(&rows).expect_err("refused").contains(says), "{rows:?}");
        }
        assert!(check_table(&[vec![-5.0, 0.0], vec![100.0, 100.0]]).is_ok());
    }
}
