//! The remaining error of a drive as its valve's null drifts (8.4).
//!
//! The thesis calls drift "a disastrous phenomenon on the control electronics and the pneumatic components" and leaves it
//! to a "time-dependent offset function". Here that is a null that moves at a constant speed. It is practically constant
//! during a test, so the rig's own test once every half an hour represents a shift of eight hours.

use pneudrive_sim::component::controller;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;
use std::cmp::Ordering;

use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::plant::Accuracy;
use pneudrive_sim::run::{Run, run};

pub(super) const ABOUT: &str = "error at rest over a shift, as the valve's null drifts (8.4)";

/// A test every half an hour of eight hours.
const TESTS: u32 = 16;
const HOURS: f64 = 8.0;

/// A drive is looked at for this long before its next move, s, or for a quarter of a shorter hold.
const LOOK_S: f64 = 0.2;

/// The direction of the move that a hold follows.
const DIRECTIONS: [(&str, Ordering); 2] =
    [("after an extension", Ordering::Greater), ("after a retraction", Ordering::Less)];

/// Each test runs from its own start and from four neighbouring ones, at these parts of the stroke from it. Within its
/// friction, such a small change may make a drive stop elsewhere.
const STARTS: [f64; 5] = [0.0, -1e-5, -5e-6, 5e-6, 1e-5];

/// The error of a drive that holds, mm: its mean from the test's own start, and between which errors it swings from any of
/// [`STARTS`]. Not a number where the drive does not come to hold from each of them.
#[derive(Clone, Copy, Debug)]
struct ErrorAtRest {
    mean: f64,
    lowest: f64,
    highest: f64,
}

impl ErrorAtRest {
    const NOT: ErrorAtRest = ErrorAtRest { mean: f64::NAN, lowest: f64::NAN, highest: f64::NAN };

    /// The same run once more, from another start.
    fn and(self, other: ErrorAtRest) -> ErrorAtRest {
        if self.mean.is_nan() || other.mean.is_nan() {
            return ErrorAtRest::NOT;
        }
        let (lowest, highest) = (self.lowest.min(other.lowest), self.highest.max(other.highest));
        ErrorAtRest { lowest, highest, ..self }
    }
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let rate = rig.get(&keys::valve::NULL_DRIFT_MM_PER_H);
    if rate == 0.0 {
        return Err(Unfit::NoPart(
            "its null does not drift (valve.null_drift_mm_per_h = 0); give a drift, for example with --set valve.null_drift_mm_per_h=0.01",
        ));
    }
    if rig.get(&keys::controller::LOOP) == controller::Loop::Open {
        return Err(Unfit::NoPart("its loop is open, so that it holds no position"));
    }
    let rig = rig.without_events();
    let hours: Vec<f64> = (0..=TESTS).map(|i| HOURS * f64::from(i) / f64::from(TESTS)).collect();
    let at_rest: Result<Vec<[ErrorAtRest; 2]>, Unfit> =
        hours.iter().map(|&hour| after(&rig, rate, hour)).collect();
    let at_rest = at_rest?;
    let counts = rate * HOURS / rig.get(&keys::valve::SPOOL_TRAVEL_MM) * 2048.0;
    let moved = [
        Figure::computed(format!("the null moves in {HOURS} h"), rate * HOURS, "mm"),
        Figure::computed(format!("the null moves in {HOURS} h"), counts, "counts of command"),
    ];
    Ok(Characteristic {
        notes: vec![
            "The rig's own test every half an hour, with the null where it has drifted to; errors are those of the last 0.2 s before the next move, their mean, and between which they swing from that start or from one of four within 1e-5 of the stroke. Each test begins with the null offset of the file: what a controller learns in one is not carried on to the next. Within its friction a drive stops somewhere else from another start, so that single curves jump. Where one has no value, the drive tripped from one of these starts or made no such move.".to_owned(),
        ],
        across: "time, h",
        graphs: vec![Graph { title: "error at rest, mm", series: series(&hours, &at_rest) }],
        figures: moved.into_iter().chain(figures(&at_rest, mm_per_count(&rig))).collect(),
        ..Characteristic::default()
    })
}

/// The remaining error of the rig's test when its null has drifted for this many hours.
fn after(rig: &Rig, rate: f64, hour: f64) -> Result<[ErrorAtRest; 2], Unfit> {
    let null = rig.get(&keys::valve::NULL_OFFSET_MM) + rate * hour;
    let Ok(rig) = rig.with_numbers(&[(keys::valve::NULL_OFFSET_MM.path, null)]) else {
        return Err(Unfit::NoPart("its null drifts out of the range of valve.null_offset_mm within a shift"));
    };
    let mut at_rest = from(&rig, STARTS[0])?;
    for &start in &STARTS[1..] {
        let next = from(&rig, start)?;
        at_rest = [at_rest[0].and(next[0]), at_rest[1].and(next[1])];
    }
    Ok(at_rest)
}

/// The remaining error of the rig's test if it starts this part of the stroke from its own start. At the end
/// of the stroke it starts there.
fn from(rig: &Rig, of_stroke: f64) -> Result<[ErrorAtRest; 2], Unfit> {
    let stroke = rig.get(&keys::actuator::STROKE_M);
    let start = (rig.get(&keys::test::POSITION_M) + of_stroke * stroke).clamp(0.0, stroke);
    let rig = rig.with_numbers(&[(keys::test::POSITION_M.path, start)]).expect("a place on the stroke");
    let run = run(&rig, Accuracy::of(&rig))?;
    Ok(DIRECTIONS.map(|(_, direction)| at_rest(&rig, &run, direction)))
}

/// The last hold of a run that follows a move in one direction.
fn at_rest(rig: &Rig, run: &Run, direction: Ordering) -> ErrorAtRest {
    if run.fault.is_some() {
        return ErrorAtRest::NOT;
    }
    let setpoint = |k: usize| run.observations[k].setpoint;
    let goes = |k: &usize| setpoint(*k).cmp(&setpoint(k - 1)) == direction;
    let Some(begin) = (1..run.observations.len()).rfind(goes) else {
        return ErrorAtRest::NOT;
    };
    let hold = &run.observations[begin..];
    let length = hold.iter().take_while(|seen| seen.setpoint == hold[0].setpoint).count();
    let look = (LOOK_S / rig.get(&keys::controller::PERIOD_S)) as usize;
    let last = look.min(length / 4).max(1);
    let mm = mm_per_count(rig);
    let errors = hold[length - last..length].iter().map(|seen| mm * f64::from(seen.error));
    ErrorAtRest {
        mean: errors.clone().sum::<f64>() / last as f64,
        lowest: errors.clone().fold(f64::INFINITY, f64::min),
        highest: errors.fold(f64::NEG_INFINITY, f64::max),
    }
}

fn series(hours: &[f64], at_rest: &[[ErrorAtRest; 2]]) -> Vec<Curve> {
    let of = |direction: usize, what: &str, y: fn(&ErrorAtRest) -> f64| {
        Curve::new(
            &format!("{}{what}", DIRECTIONS[direction].0),
            hours.to_vec(),
            at_rest.iter().map(|at_rest| y(&at_rest[direction])).collect(),
        )
    };
    let each = |direction| {
        [
            of(direction, "", |at_rest| at_rest.mean),
            of(direction, ", lowest", |at_rest| at_rest.lowest),
            of(direction, ", highest", |at_rest| at_rest.highest),
        ]
    };
    [0, 1].into_iter().flat_map(each).collect()
}

/// The error at the beginning and at the end of the shift, to within its swing from any of [`STARTS`] and a count of `count` mm.
fn figures(at_rest: &[[ErrorAtRest; 2]], count: f64) -> Vec<Figure> {
    let ends = [(0.0, at_rest[0]), (HOURS, at_rest[at_rest.len() - 1])];
    let mut figures = Vec::new();
    for (direction, (name, _)) in DIRECTIONS.iter().enumerate() {
        for (hour, at_rest) in ends {
            let ErrorAtRest { mean, lowest, highest } = at_rest[direction];
            if mean.is_finite() {
                let within = (highest - mean).max(mean - lowest) + count;
                figures.push(Figure::read(format!("error {name}, at {hour} h"), mean, within, "mm"));
            }
        }
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::super::Reading;
    use super::*;

    /// A proportional drive with oil on its slide and without friction in its valve: it rests where it asks for the null, at
    /// Kp / scale = 2 commands to a count of error.
    fn drifting(rate: f64) -> Rig {
        let text = format!(
            "[controller]\nlaw = \"proportional\"\nproportional_gain = 512\nvelocity_gain = 0\nacceleration_gain = 0\n\
             [operator]\nhysteresis_percent = 0\nstatic_friction_n = 0\ncoulomb_friction_n = 0\ndither_mm = 0\n\
             [load]\nviscous_n_s_per_m = 1000\nstatic_extend_n = 5\ncoulomb_extend_n = 5\nstatic_retract_n = 5\ncoulomb_retract_n = 5\n\
             [valve]\nnull_drift_mm_per_h = {rate:?}\n[test]\nduration_s = 6\nmoves = [[0.0, 8192], [0.3, 12000], [3.0, 8192]]\n"
        );
        Rig::read("drifting", &text).expect("a valid rig")
    }

    /// 0.01 mm/h in 8 h are 163.84 of 2048 commands to a travel of 1 mm, and half as many counts of 0.01205 mm.
    #[test]
    fn the_error_at_rest_grows_by_what_the_null_has_moved() {
        let found = measure(&drifting(0.01)).expect("a drive that holds");
        let by_hand = 163.84 / 2.0 * 0.01205;
        for series in found.graphs[0].series.iter().filter(|series| !series.name.contains(',')) {
            let (first, last) = (series.y[0], series.y[series.y.len() - 1]);
            assert!(
                (last - first - by_hand).abs() < 0.03 * by_hand,
                "{}: from {first} to {last} mm",
                series.name
            );
            let halfway = series.y[series.y.len() / 2];
            assert!((halfway - (first + last) / 2.0).abs() < 0.03 * by_hand, "{}: {halfway}", series.name);
        }
        let moved = found.figures[1].value().expect("a figure");
        assert!((moved - 163.84).abs() < 1e-9, "{moved}");
        for figure in &found.figures[2..] {
            let Reading::Read { within, .. } = figure.reading else { panic!("{figure:?}") };
            assert!(within >= 0.01205, "an encoder tells no less than a count: {figure:?}");
        }
    }

    /// Where a drive with dry friction stops depends on its start: a figure says so, or another start contradicts it.
    #[test]
    fn the_error_at_rest_from_a_start_next_to_it_is_within_what_is_told() {
        let rig = Rig::builtin("servo-b-tuned").expect("built in");
        let drifting = |start: f64| {
            let set = [("valve.null_drift_mm_per_h", 0.02), ("test.position_m", start)];
            measure(&rig.with_numbers(&set).expect("a valid rig")).expect("a drive that holds")
        };
        let start = rig.get(&keys::test::POSITION_M);
        let [own, next] = [start, start + 3e-6].map(drifting);
        assert_eq!(own.figures.len(), 6);
        for (own, next) in own.figures.iter().zip(&next.figures).skip(2) {
            let Reading::Read { value, within } = own.reading else { panic!("{own:?}") };
            let other = next.value().expect("read");
            assert!((other - value).abs() <= within, "{}: {value} +- {within}, and {other}", own.name);
        }
    }

    #[test]
    fn a_null_that_stays_and_a_loop_that_is_open_are_refused() {
        let open = "[controller]\nloop = \"open\"\n[valve]\nnull_drift_mm_per_h = 0.1\n";
        for rig in [drifting(0.0), Rig::read("open", open).expect("a valid rig")] {
            assert!(matches!(measure(&rig), Err(Unfit::NoPart(_))));
        }
    }
}
