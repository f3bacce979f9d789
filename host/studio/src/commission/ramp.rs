//! A slow move, as a setpoint in small steps.

use anyhow::{Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;

/// Rate of jogging, mm/s.
pub const JOG_MM_PER_S: f64 = 10.0;

/// Rate of a move to a place, mm/s.
pub const GO_MM_PER_S: f64 = 50.0;

/// Most steps of a move: a test has room for 64.
const MAX_STEPS: f64 = 60.0;

/// Shortest time of a step, s.
const STEP_S: f64 = 0.05;

/// How long the drive has to settle before its test is over, s.
const SETTLING_S: f64 = 0.2;

/// The rig with a test that moves the setpoint at a constant rate from one place to another, mm. A place beyond the
/// stroke becomes the end of the stroke.
///
/// # Errors
/// When the loop is open: such a test has no setpoints.
pub fn slow_move(rig: &Rig, from_mm: f64, to_mm: f64, mm_per_s: f64) -> Result<Rig> {
    if rig.get(&keys::controller::LOOP) == Loop::Open {
        bail!("the loop is open, so the drive cannot be moved to a place");
    }
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let [from_mm, to_mm] = [from_mm, to_mm].map(|mm| mm.clamp(0.0, stroke_mm));
    let mm_per_count = mm_per_count(rig);
    let lasts_s = (to_mm - from_mm).abs() / mm_per_s;
    let steps = (lasts_s / STEP_S).ceil().clamp(1.0, MAX_STEPS);
    let step = |number: u32| {
        let share = f64::from(number) / steps;
        let counts = ((from_mm + share * (to_mm - from_mm)) / mm_per_count) as i64;
        let at_s = ((f64::from(number) - 1.0) / steps * lasts_s * 1e3).round() / 1e3;
        format!("[{at_s:?}, {counts}]")
    };
    let moves: Vec<String> = (1..=steps as u32).map(step).collect();
    let duration_s = ((lasts_s + SETTLING_S) * 1e3).ceil() / 1e3;
    let test = [
        keys::test::MOVES.setting(format_args!("[{}]", moves.join(", "))),
        keys::test::DURATION_S.setting(format_args!("{duration_s:?}")),
    ];
    Ok(rig.with_test(&test)?)
}

/// The range of a drive with these parameters in closed loop, mm: within its stroke and its soft limits.
pub fn reachable(rig: &Rig, there: &RigParameters) -> [f64; 2] {
    let end = |id, otherwise: f64| {
        let counts = there.values.get(id).filter(|_| !there.lacking.contains(&id));
        counts.map_or(otherwise, |counts| f64::from(counts) * mm_per_count(rig))
    };
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    [end(id::END_MIN_COUNTS, 0.0).max(0.0), end(id::END_MAX_COUNTS, stroke_mm).min(stroke_mm)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        Rig::builtin("servo-b-tuned").expect("a built-in rig")
    }

    #[test]
    fn a_slow_move_ends_where_it_should_and_never_steps_faster_than_its_rate() {
        for [from, to, rate] in
            [[100.0, 130.0, 10.0], [250.0, 20.0, 50.0], [100.0, 100.2, 10.0], [50.0, 50.0, 10.0]]
        {
            let moves = slow_move(&rig(), from, to, rate).expect("a test").moves();
            let mm = |counts: i64| counts as f64 * 0.01205;
            let (last_s, last) = *moves.last().expect("a move");
            assert!((mm(last) - to).abs() < 0.02, "{last}");
            // To counts, and to milliseconds.
            let rounding = 0.0121 + rate * 1e-3;
            for (time, counts) in &moves {
                let ahead = (mm(*counts) - from).abs() - rate * time;
                // A step begins with the place that the setpoint has at its end.
                let largest = ((to - from).abs() / 60.0).max(rate * STEP_S) + rounding;
                assert!(ahead <= largest, "{ahead} mm ahead at {time} s");
            }
            assert!(moves.len() <= 60 && last_s <= (to - from).abs() / rate + 1e-9);
        }
    }

    #[test]
    fn a_move_beyond_the_stroke_ends_at_its_end() {
        let moves = slow_move(&rig(), 290.0, 400.0, 10.0).expect("a test").moves();
        let last = moves.last().expect("a move").1;
        assert!(last as f64 * 0.01205 <= 300.0 && last as f64 * 0.01205 > 299.9, "{last}");
    }

    #[test]
    fn an_open_loop_has_no_places() {
        let rig = Rig::read("open", "[controller]\nloop = \"open\"\n").expect("a rig");
        assert!(slow_move(&rig, 0.0, 1.0, 10.0).is_err());
    }
}
