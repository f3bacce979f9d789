//! A test whose setpoint goes through the points of a table, in straight lines: it has the columns `time_s` and `position_mm`.
//!
//! A test has as many lines as the controller has moves. So points within a count of a line between two others are
//! left out, and the rest is checked against the limits of the test:
//!
//! ```text
//! v_i = (x_i - x_(i-1))/(t_i - t_(i-1))                  of line i; 0 before the first line and behind the last one
//! a_i = (v_(i+1) - v_i)/(time of the shorter line)       where they meet
//! ```

use anyhow::{Context, Result, bail, ensure};
use pneudrive_controller::sequencer::MAX_MOVES;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder;
use pneudrive_sim::key::Key;
use pneudrive_sim::{Rig, keys};
use pneudrive_tables::Table;

/// The columns.
const COLUMNS: [&str; 2] = ["time_s", "position_mm"];

/// After the last point the drive has this long to come to rest, s.
const REST_S: f64 = 0.5;

/// The settings of a rig's own test that other moves keep.
const KEPT: [&Key; 7] = [
    &keys::test::TRACE_PERIOD_S.key,
    &keys::test::DECIMATION.key,
    &keys::test::PRE_TRIGGER.key,
    &keys::test::PRESSURE_1_PA.key,
    &keys::test::PRESSURE_2_PA.key,
    &keys::test::TEMPERATURE_1_K.key,
    &keys::test::TEMPERATURE_2_K.key,
];

/// A point, and its line in the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    line: usize,
    time_s: f64,
    mm: f64,
}

/// A rig whose test goes through points.
#[derive(Clone, Debug)]
pub struct Through {
    /// The rig.
    pub rig: Rig,
    /// The remarks on the points, a sentence each.
    pub notes: Vec<String>,
}

/// The rig with a test that goes through the points of a table; `settings` of its test, as `key=value`, hold beside them.
///
/// # Errors
/// With the line that is no point, or that goes beyond the ends or the limits.
pub fn through(rig: &Rig, bytes: impl AsRef<[u8]>, settings: &[String]) -> Result<Through> {
    ensure!(
        rig.get(&keys::controller::LOOP) == Loop::Closed,
        "the points are positions, but controller.loop is open: its moves are valve commands"
    );
    let all = points_of(bytes)?;
    check_ends(rig, &all)?;
    let kept = straightened(&all, encoder::mm_per_count(rig));
    ensure!(
        kept.len() <= MAX_MOVES,
        "its {} points need {} straight lines to be within a count, and a test has {MAX_MOVES} at most; split the path, or give fewer points",
        all.len(),
        kept.len()
    );
    let period_s = rig.get(&keys::controller::PERIOD_S);
    if let Some(pair) = kept.windows(2).find(|pair| pair[1].time_s - pair[0].time_s < period_s) {
        bail!(
            "line {}: it comes {} s after line {}, less than a sample of {period_s} s; leave one of the two out",
            pair[1].line,
            pair[1].time_s - pair[0].time_s,
            pair[0].line
        );
    }
    let fastest = check_speed(rig, &kept)?;
    let hardest = check_acceleration(rig, &kept)?;
    let notes = vec![
        format!(
            "the setpoint goes through {} of {} points, the others are within a count of its straight lines",
            kept.len(),
            all.len()
        ),
        format!("it asks for {fastest:.1} mm/s and {hardest:.0} mm/s^2 at most"),
        format!("it begins with a step to {} mm", kept[0].mm),
    ];
    Ok(Through { rig: rig.with_test(&test_of(rig, &kept, settings))?, notes })
}

/// The test, as `key=value`.
fn test_of(rig: &Rig, points: &[Point], settings: &[String]) -> Vec<String> {
    let each: Vec<String> =
        points.iter().map(|point| format!("[{:?}, {:?}]", point.time_s, point.mm)).collect();
    let [first, last] = [points[0], points[points.len() - 1]];
    let half_count = encoder::middle(rig, 0.0) * encoder::mm_per_count(rig);
    let own = [
        keys::test::MOVE.setting(format_args!("[{{profile=\"points\", points=[{}]}}]", each.join(", "))),
        keys::test::DURATION_S.setting(format_args!("{:?}", (1e6 * (last.time_s + REST_S)).ceil() / 1e6)),
        keys::test::POSITION_M.setting(format_args!("{:?}", 1e-3 * (first.mm + half_count))),
    ];
    let kept = KEPT.into_iter().filter(|key| rig.is_set(key));
    let kept = kept.filter_map(|key| Some(key.setting(rig.value(key.path)?)));
    let of_test = settings.iter().filter(|setting| setting.trim_start().starts_with("test."));
    kept.chain(own).chain(of_test.cloned()).collect()
}

/// The points of a table, in order of time from 0 on.
fn points_of(bytes: impl AsRef<[u8]>) -> Result<Vec<Point>> {
    let [time, position] = COLUMNS;
    let table = Table::read_whole(bytes)
        .with_context(|| format!("it is no table of points, with the columns {}", COLUMNS.join(",")))?;
    let [Some(times), Some(positions)] = [table.find(&[time])?, table.find(&[position])?] else {
        bail!(
            "line {}: expected a header with the columns {}, found {}",
            table.head_line(),
            COLUMNS.join(", "),
            table.names().join(", ")
        );
    };
    let (times, positions) = (table.all_numbers(times)?, table.all_numbers(positions)?);
    let mut points: Vec<Point> = Vec::with_capacity(table.rows());
    for (row, (time_s, mm)) in times.into_iter().zip(positions).enumerate() {
        let point = Point { line: table.line(row), time_s, mm };
        check_time(points.last(), &point)?;
        points.push(point);
    }
    ensure!(points.len() > 1, "it has {} points; a path has two at least", points.len());
    Ok(points)
}

fn check_time(before: Option<&Point>, point: &Point) -> Result<()> {
    let Point { line, time_s, .. } = point;
    match before {
        None if *time_s != 0.0 => bail!(
            "line {line}: the first point is at {time_s} s; let it begin at 0 s, where the drive is to stand"
        ),
        Some(before) if *time_s <= before.time_s => bail!(
            "line {line}: {time_s} s is not after line {}, {} s; put the points in order of time",
            before.line,
            before.time_s
        ),
        _ => Ok(()),
    }
}

fn check_ends(rig: &Rig, points: &[Point]) -> Result<()> {
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let low = rig.get(&keys::safety::END_MIN_MM).unwrap_or(0.0).max(0.0);
    let high = rig.get(&keys::safety::END_MAX_MM).unwrap_or(stroke_mm).min(stroke_mm);
    match points.iter().find(|point| !(low..=high).contains(&point.mm)) {
        Some(Point { line, mm, .. }) => bail!(
            "line {line}: {mm} mm is not between the soft limits of {low} and {high} mm (safety.end_min_mm, safety.end_max_mm, actuator.stroke_m)"
        ),
        None => Ok(()),
    }
}

/// Those points that straight lines need which are within `near` of all others.
fn straightened(points: &[Point], near: f64) -> Vec<Point> {
    let (mut kept, mut from) = (vec![points[0]], 0);
    while from + 1 < points.len() {
        from = furthest(points, from, near);
        kept.push(points[from]);
    }
    kept
}

/// The furthest point to which a line from another point stays within `near` of all points between them.
fn furthest(points: &[Point], from: usize, near: f64) -> usize {
    let [mut least, mut most] = [f64::NEG_INFINITY, f64::INFINITY];
    let (begin, mut end) = (points[from], from + 1);
    for (place, point) in points.iter().enumerate().skip(from + 1) {
        let (time, travel) = (point.time_s - begin.time_s, point.mm - begin.mm);
        if (least..=most).contains(&(travel / time)) {
            end = place;
        }
        (least, most) = (least.max((travel - near) / time), most.min((travel + near) / time));
        if least > most {
            break;
        }
    }
    end
}

/// The speed of each line, mm/s.
fn speeds(points: &[Point]) -> impl Iterator<Item = f64> + '_ {
    points.windows(2).map(|pair| (pair[1].mm - pair[0].mm) / (pair[1].time_s - pair[0].time_s))
}

/// The largest speed, mm/s.
fn check_speed(rig: &Rig, points: &[Point]) -> Result<f64> {
    let limit = rig.get(&keys::test::VELOCITY_MM_S);
    for (pair, speed) in points.windows(2).zip(speeds(points)) {
        ensure!(
            speed.abs() <= limit,
            "line {}: {:.1} mm/s from line {} on are above test.velocity_mm_s = {limit}; give the path more time, or raise the limit with --set test.velocity_mm_s={:.0}",
            pair[1].line,
            speed.abs(),
            pair[0].line,
            speed.abs().ceil()
        );
    }
    Ok(speeds(points).map(f64::abs).fold(0.0, f64::max))
}

/// The largest acceleration where two lines meet, mm/s^2.
fn check_acceleration(rig: &Rig, points: &[Point]) -> Result<f64> {
    let limit = rig.get(&keys::test::ACCELERATION_MM_S2);
    let speeds: Vec<f64> = std::iter::once(0.0).chain(speeds(points)).chain([0.0]).collect();
    let mut hardest: f64 = 0.0;
    let times: Vec<f64> = points.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    for (place, point) in points.iter().enumerate() {
        let both =
            [place.checked_sub(1), Some(place)].into_iter().flatten().filter_map(|line| times.get(line));
        let shorter = both.copied().fold(f64::INFINITY, f64::min);
        let acceleration = ((speeds[place + 1] - speeds[place]) / shorter).abs();
        ensure!(
            acceleration <= limit,
            "line {}: the speed changes from {:.1} to {:.1} mm/s there, {acceleration:.0} mm/s^2 and above test.acceleration_mm_s2 = {limit}; round the corner with more points, or raise the limit with --set test.acceleration_mm_s2={:.0}",
            point.line,
            speeds[place],
            speeds[place + 1],
            acceleration.ceil()
        );
        hardest = hardest.max(acceleration);
    }
    Ok(hardest)
}

#[cfg(test)]
mod tests;
