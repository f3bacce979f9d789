//! Slow moves by hand, to a place or by a stretch: a test whose setpoint goes in small steps, within the reach of the drive.

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;

/// Rate of jogging unless another is chosen, mm/s.
pub const JOG_MM_PER_S: f64 = 10.0;

/// Rate of a move to a place, mm/s.
pub const GO_MM_PER_S: f64 = 50.0;

/// How far one test of jogging goes, mm; a button that is held longer has another one follow.
pub const JOG_REACH_MM: f64 = 30.0;

/// Most steps of a move: a test has room for 64.
const MAX_STEPS: f64 = 60.0;

/// Shortest time of a step, s.
const STEP_S: f64 = 0.05;

/// How long the drive has to settle before its test is over, s.
const SETTLING_S: f64 = 0.2;

/// A drive that is to be moved, and where it stands.
#[derive(Debug)]
pub struct Standing {
    /// Its parameters.
    pub there: RigParameters,
    /// Where it stands, mm.
    pub from_mm: f64,
}

impl Standing {
    /// The drive of a rig file that messages call `name`.
    ///
    /// # Errors
    /// When the counts of the drive have another length than those of the rig file, or it does not answer.
    pub fn of(client: &mut Client, name: &str, rig: &Rig) -> Result<Standing> {
        let there = client.parameters()?;
        let length = id::ENCODER_PM_PER_COUNT;
        if there.values.get(length) != rig.parameters().get(length) {
            let key = keys::encoder::MM_PER_COUNT.path;
            return Err(Failure::Refused.error(format!(
                "{key} of the drive is not that of {name}: name the drive's own rig file; nothing was changed"
            )));
        }
        let from = Units::of(&there).millimetres(client.status()?.position);
        let from_mm = from.context("the rig does not tell how long a count of its encoder is")?;
        Ok(Standing { there, from_mm })
    }
}

/// The rig with a test that moves the setpoint at a constant rate from one place to another, mm. A place beyond the
/// stroke becomes the end of the stroke.
///
/// ```
/// use pneudrive_session::slow_move::slow_move;
/// use pneudrive_sim::Rig;
///
/// let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
/// let moves = slow_move(&rig, 60.0, 80.0, 10.0)?.moves();
/// let (first, last) = (moves[0], moves[moves.len() - 1]);
/// assert!(first.0 == 0.0 && (1.9..2.0).contains(&last.0), "20 mm at 10 mm/s");
/// assert_eq!(last.1, (80.0 / 0.01205) as i64, "counts of 0.01205 mm");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// The test that moves a drive with these parameters from where it stands to a place, mm.
///
/// # Errors
/// When the place is out of its reach, or the loop is open.
pub fn go(rig: &Rig, there: &RigParameters, from_mm: f64, to_mm: f64) -> Result<Rig> {
    let [least, most] = reachable(rig, there);
    if !(least..=most).contains(&to_mm) {
        return Err(Failure::Refused.error(format!(
            "{to_mm} mm is out of reach: the drive goes from {least:.1} to {most:.1} mm; nothing was changed"
        )));
    }
    slow_move(rig, from_mm, to_mm, GO_MM_PER_S)
}

/// The test that moves a drive with these parameters on from where it stands, mm; below 0: towards the retracted end. Beyond an
/// end of its reach it goes no further that way, and never the other way.
///
/// # Errors
/// When the loop is open.
pub fn jog(rig: &Rig, there: &RigParameters, from_mm: f64, by_mm: f64, mm_per_s: f64) -> Result<Rig> {
    let [least, most] = reachable(rig, there);
    let to_mm = from_mm + by_mm.clamp(-JOG_REACH_MM, JOG_REACH_MM);
    let to_mm = if by_mm < 0.0 { to_mm.max(least).min(from_mm) } else { to_mm.min(most).max(from_mm) };
    slow_move(rig, from_mm, to_mm, mm_per_s)
}

/// The range of a drive with these parameters in closed loop, mm: within its stroke and its soft limits.
fn reachable(rig: &Rig, there: &RigParameters) -> [f64; 2] {
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

    fn there(rig: &Rig) -> RigParameters {
        RigParameters { values: rig.parameters(), lacking: Vec::new() }
    }

    /// Where a test ends, mm.
    fn end_mm(test: &Rig) -> f64 {
        test.moves().last().expect("a move").1 as f64 * 0.01205
    }

    #[test]
    fn a_place_out_of_reach_is_refused_by_the_ends_of_stroke_and_drive() {
        let limited = rig().with_settings(&["safety.end_max_mm=200".to_owned()]).expect("valid");
        for (there, to_mm, most) in [(there(&rig()), 301.0, "300.0"), (there(&limited), 201.0, "200.0")] {
            let refusal = go(&rig(), &there, 100.0, to_mm).expect_err("out of reach").to_string();
            assert!(refusal.contains(&format!("the drive goes from 0.0 to {most} mm")), "{refusal}");
        }
        let test = go(&rig(), &there(&limited), 100.0, 120.0).expect("within reach");
        assert!((end_mm(&test) - 120.0).abs() < 0.02);
    }

    #[test]
    fn a_jog_ends_at_the_end_of_the_reach_and_never_goes_the_other_way() {
        let limited = there(&rig().with_settings(&["safety.end_max_mm=200".to_owned()]).expect("valid"));
        for (from_mm, by_mm, to_mm) in [
            (100.0, 5.0, 105.0),
            (100.0, -5.0, 95.0),
            (100.0, 80.0, 130.0),
            (190.0, 30.0, 200.0),
            (210.0, 30.0, 210.0),
        ] {
            let test = jog(&rig(), &limited, from_mm, by_mm, JOG_MM_PER_S).expect("a test");
            assert!((end_mm(&test) - to_mm).abs() < 0.02, "{from_mm} by {by_mm}: {}", end_mm(&test));
        }
    }
}
