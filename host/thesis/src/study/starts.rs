//! The starts of a drive: its test at different positions on the stroke, and its dither at different phases.
//!
//! Whether a drive with stiction comes to rest depends on its position and on the phase of its dither, and the thesis
//! gives neither. So each drive of a study is run from many starts, and results are stated as a share of them.
//!
//! ```text
//! start 0      the rig as it is
//! start i      the whole test moved by 48 mm (2 u_i - 1), the dither's phase moved by 360 degrees v_i
//! ```
//!
//! u_i and v_i are the digits of i after the point in reverse order, to the bases 2 and 3 (Halton): they cover position
//! and phase evenly for any number of starts, and a larger set of starts contains the smaller one.

use anyhow::{Context, Result};
use pneudrive_optimise::ensemble::reversed;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;
use pneudrive_sim::rigfile::builtin;

use super::Variant;

/// Default number of starts of a study.
pub const STARTS: usize = 64;

/// The farthest that a test is moved, mm.
const MAX_OFFSET_MM: f64 = 48.0;

/// The rig of a variant at a start.
///
/// # Errors
/// When there is no such rig, or it refuses the settings.
pub fn at_start(variant: &Variant, start: usize) -> Result<Rig> {
    let text = builtin(variant.rig).with_context(|| format!("there is no built-in rig {}", variant.rig))?;
    let mut settings: Vec<String> = variant.settings.iter().map(|setting| (*setting).to_owned()).collect();
    let rig = Rig::read_with(variant.rig, text, &settings)?;
    if start == 0 {
        return Ok(rig);
    }
    settings.extend(moved(&rig, start));
    Ok(Rig::read_with(variant.rig, text, &settings)?)
}

/// The settings that move the test of a rig.
fn moved(rig: &Rig, start: usize) -> Vec<String> {
    let pulse_mm = mm_per_count(rig);
    // Whole counts, so that the drive keeps its position between two counts.
    let counts = (MAX_OFFSET_MM * (2.0 * reversed(start, 2) - 1.0) / pulse_mm).round();
    let position_m = rig.get(&keys::test::POSITION_M) + 1e-3 * pulse_mm * counts;
    let phase_deg = (rig.get(&keys::dither::DITHER_PHASE_DEG) + 360.0 * reversed(start, 3)) % 360.0;
    let moves: Vec<String> = rig
        .get(&keys::test::MOVES)
        .iter()
        .map(|(time, target)| format!("[{time:?}, {}]", target + counts as i64))
        .collect();
    vec![
        keys::test::POSITION_M.setting(format_args!("{position_m:?}")),
        keys::dither::DITHER_PHASE_DEG.setting(format_args!("{phase_deg:?}")),
        format!("{}=[{}]", keys::test::MOVES.path, moves.join(", ")),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::STUDIES;
    use super::*;

    const DRIVE: Variant = Variant { name: "thesis", rig: "servo-b-thesis", settings: &[] };

    #[test]
    fn the_first_start_is_the_rig_as_it_is_and_the_others_move_the_test_as_a_whole() {
        let own = at_start(&DRIVE, 0).expect("a rig");
        assert_eq!(own, Rig::builtin("servo-b-thesis").expect("built in"));
        let targets = |rig: &Rig| -> Vec<i64> {
            rig.get(&keys::test::MOVES).iter().map(|(_, target)| *target).collect()
        };
        for start in 1..16 {
            let rig = at_start(&DRIVE, start).expect("a rig");
            let by = targets(&rig)[0] - targets(&own)[0];
            assert!(targets(&rig).iter().zip(targets(&own)).all(|(moved, own)| moved - own == by));
            let moved_m = rig.get(&keys::test::POSITION_M) - own.get(&keys::test::POSITION_M);
            assert!((moved_m - by as f64 * 0.01205e-3).abs() < 1e-12, "{start}: {moved_m}");
            assert!(moved_m.abs() <= 0.0481, "{start}: {moved_m}");
        }
    }

    #[test]
    fn starts_cover_positions_and_phases_evenly() {
        for base in [2, 3] {
            let mut places: Vec<f64> = (0..16).map(|start| reversed(start, base)).collect();
            places.sort_by(f64::total_cmp);
            let widest = places.windows(2).map(|pair| pair[1] - pair[0]).fold(1.0 - places[15], f64::max);
            assert!(places[0] == 0.0 && widest < 2.0 / 16.0 + 1e-12, "{base}: {places:?}");
        }
    }

    #[test]
    fn every_drive_of_every_study_can_start_anywhere() {
        for variant in STUDIES.iter().flat_map(|study| study.variants) {
            for start in 0..64 {
                at_start(variant, start).unwrap_or_else(|error| panic!("{}, {start}: {error}", variant.name));
            }
        }
    }
}
