//! Hysteresis of the operator (7.1.2.1, Fig. 7.6): the spool over a command that goes slowly up and down through its
//! range, without dither and with it.
//!
//! The width is read at mid-travel: how much more command the spool takes going up than coming down, to within a
//! count, and as a part of the rig's own range of commands. Without stiction and dither it is the width of the
//! magnetic loop, C(29).

use super::bench::{SpoolBench, decay_s};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_controller::drive::MAX_COUNTS;
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::component::dither::Dither;
use pneudrive_sim::component::operator;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "spool over command, up and down (7.1.2.1, Fig. 7.6)";

/// Commands from one end of the range to the other.
const LEVELS: i32 = 128;

/// The shortest time that each level is held, s.
const MIN_DWELL: f64 = 0.02;

/// A loop: commands and where the spool is, both m, a branch each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loop {
    /// From the lowest command to the highest.
    pub up: Vec<(f64, f64)>,
    /// From the highest command back to the lowest.
    pub down: Vec<(f64, f64)>,
}

impl Loop {
    /// Distance of the branches along the command where they pass `level`, m.
    #[must_use]
    pub fn width(&self, level: f64) -> Option<f64> {
        let passes = |branch: &[(f64, f64)]| {
            let pair = branch.windows(2).find(|pair| (pair[0].1 < level) != (pair[1].1 < level))?;
            let ((c0, x0), (c1, x1)) = (pair[0], pair[1]);
            Some(c0 + (c1 - c0) * (level - x0) / (x1 - x0))
        };
        Some(passes(&self.up)? - passes(&self.down)?)
    }
}

/// The loop of a rig's operator under a dither. `read` makes a reading of the spool positions over a
/// period of the dither; their mean is where the spool is.
///
/// # Errors
/// When the spool cannot be followed.
pub fn sweep(rig: &Rig, dither: Dither, mut read: impl FnMut(&[f64]) -> f64) -> Result<Loop, Unfit> {
    let [full, per_count] = range(rig);
    let counts = |level: i32| (full * f64::from(level) / f64::from(LEVELS)).round() as i16;
    let mut present = 0;
    let mut bench = SpoolBench::new(rig, Some(dither));
    let period = if dither.frequency_hz > 0.0 { 1.0 / dither.frequency_hz } else { MIN_DWELL };
    let dwell = period * (MIN_DWELL.max(decay_s(rig)) / period).ceil();
    let mut branch = |levels: &mut dyn Iterator<Item = i32>| -> Result<Vec<(f64, f64)>, Unfit> {
        let mut places = Vec::new();
        for level in levels {
            let (from, to) = (present, counts(level));
            // Count by count: a spool that overshoots a step would take the slack up by its overshoot.
            for gone in 1..=(to - from).abs() {
                bench.drive(from + gone * (to - from).signum());
                bench.watch(dwell / f64::from((to - from).abs()), 1)?;
            }
            present = to;
            bench.watch(dwell, 1)?;
            places.push((f64::from(to) * per_count, read(&bench.watch(period, 64)?)));
        }
        Ok(places)
    };
    branch(&mut (-LEVELS..=0).rev())?;
    Ok(Loop { up: branch(&mut (-LEVELS..=LEVELS))?, down: branch(&mut (-LEVELS..=LEVELS).rev())? })
}

/// The largest command of a rig's operator, and the spool's travel for one count, m.
fn range(rig: &Rig) -> [f64; 2] {
    let for_one = match rig.get(&keys::operator::MODEL) {
        operator::OperatorKind::Stepper => rig.get(&keys::stepper::MM_PER_STEP) * 1e-3,
        _ => rig.get(&keys::valve::SPOOL_TRAVEL_MM) * 1e-3 / f64::from(MAX_COUNTS),
    };
    [operator::largest_command(rig) as f64, for_one]
}

/// Resolution of the command, m: a count, or a step of a stepper.
pub(super) fn reading_m(rig: &Rig) -> f64 {
    range(rig)[1]
}

/// Mean of spool positions, m.
#[must_use]
pub fn mean(spool: &[f64]) -> f64 {
    spool.iter().sum::<f64>() / spool.len() as f64
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if rig.get(&keys::operator::MODEL) == operator::OperatorKind::OnOff {
        return Err(Unfit::NoPart("an on-off operator has three places and no loop"));
    }
    let own = Dither::of(rig);
    let mut found = Characteristic {
        notes: vec!["Each command is held until the spool has come to rest, or through a whole period of the dither, of which the mean is shown.".to_owned()],
        across: "command, mm",
        ..Characteristic::default()
    };
    let mut series = Vec::new();
    for (name, dither) in [("without dither", Dither { amplitude: 0.0, ..own }), ("with its dither", own)] {
        let found_loop = sweep(rig, dither, mean)?;
        if let Some(width) = found_loop.width(0.0) {
            let [full, per_count] = range(rig);
            let whole = 2.0 * full * per_count;
            let named = |what: &str| format!("width at mid-travel, {name}, {what}");
            let of_range = named(&format!("of the range of {} mm", (1e7 * whole).round() / 1e4));
            found.figures.extend([
                Figure::read(named("of command"), 1e3 * width, 1e3 * per_count, "mm"),
                Figure::read(of_range, 100.0 * width / whole, 100.0 * per_count / whole, "%"),
            ]);
        }
        series.extend(branches(&found_loop, name, 1e3));
    }
    found.graphs.push(Graph { title: "spool, mm", series });
    Ok(found)
}

/// Both branches as curves, in mm of command.
pub(super) fn branches(of: &Loop, name: &str, scale: f64) -> [Curve; 2] {
    [("up", &of.up), ("down", &of.down)].map(|(direction, branch)| {
        Curve::new(
            &format!("{direction}, {name}"),
            branch.iter().map(|place| place.0 * 1e3).collect(),
            branch.iter().map(|place| place.1 * scale).collect(),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Reading, servo_b as rig};
    use super::*;

    const STILL: Dither = Dither { amplitude: 0.0, frequency_hz: 50.0, phase_cycles: 0.0 };

    fn width(settings: &[&str], dither: Dither) -> f64 {
        sweep(&rig(settings), dither, mean)
            .expect("it can be followed")
            .width(0.0)
            .expect("it passes mid-travel")
    }

    const NO_STICTION: [&str; 2] = ["operator.static_friction_n=0", "operator.coulomb_friction_n=0"];

    #[test]
    fn without_stiction_and_dither_the_loop_is_as_wide_as_the_magnetic_hysteresis() {
        for percent in [5.0, 3.8] {
            let setting = format!("operator.hysteresis_percent={percent}");
            let found = width(&[&setting, NO_STICTION[0], NO_STICTION[1]], STILL);
            assert!((found - percent / 100.0 * 2e-3).abs() < 0.5e-6, "{percent} %: {found}");
        }
    }

    /// Of the rig's own range, whatever its travel.
    #[test]
    fn the_loop_of_a_spool_with_another_travel_is_a_part_of_its_own_range() {
        for travel_mm in [0.4, 1.0, 2.5] {
            let settings = [
                &format!("valve.spool_travel_mm={travel_mm}"),
                NO_STICTION[0],
                NO_STICTION[1],
                "operator.saturation_mm=10",
            ];
            let found = measure(&rig(&settings)).expect("a loop");
            let Reading::Read { value, within } = found.figures[1].reading else {
                panic!("{:?}", found.figures)
            };
            assert!((value - 5.0).abs() < within && within < 0.05, "{travel_mm} mm: {:?}", found.figures[1]);
            assert!(found.figures[1].name.ends_with(&format!("of the range of {} mm", 2.0 * travel_mm)));
        }
    }

    /// Its slack is behind the spool: one that overshoots (C(51), 0.26 of critical) takes some of it up.
    #[test]
    fn the_empirical_operator_has_the_same_loop_if_it_does_not_overshoot() {
        let found = width(&["operator.model=\"solenoid-empirical\"", "operator.damping_per_s=400"], STILL);
        assert!((found - 0.1e-3).abs() < 0.5e-6, "within a count: {found}");
    }

    /// (7.2): the total width is the magnetic loop, and the stiction over the force gain.
    #[test]
    fn stiction_widens_the_loop_by_no_more_than_its_force_takes() {
        let found = width(&[], STILL);
        let stiction = 2.0 * 3.0 / 25e3;
        assert!(found > 0.1e-3 + 0.5 * stiction && found <= 0.1e-3 + stiction + 16e-6, "{found}");
    }

    #[test]
    fn a_dither_beyond_the_slack_takes_most_of_the_loop_away() {
        let dither = Dither { amplitude: 0.2e-3, ..STILL };
        let (without, with) = (width(&[], STILL), width(&[], dither));
        assert!(with.abs() < 0.2 * without, "{without} {with}");
    }

    #[test]
    fn a_stepper_has_no_loop() {
        assert!(width(&["operator.model=\"stepper\""], STILL).abs() < 1e-12);
    }
}
