//! Steps and sines as the test of a rig, and what a run of them shows.
//!
//! A drive holds for 0.2 s. Then it makes three moves of [`MOVE_S`] each: there, back and there again, so that one run shows
//! the step of a drive that has not moved before and that after two moves. A sine swings about the middle of the stroke, four
//! times.

use anyhow::{Result, bail};
use pneudrive_evaluate::evaluation::{Motion, moves};
use pneudrive_evaluate::transient::{POSITION, Transient};
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::{Rig, Run, keys};

use super::arrival::{Arrival, BANDS_MM};
use super::draw::Place;

/// How long a drive holds before it moves, s.
pub const HOLD_S: f64 = 0.2;

/// How long a move lasts, s.
pub const MOVE_S: f64 = 3.0;

/// Moves of a run, and the place in it of the first one and of that after two others.
const MOVES: usize = 3;
pub(super) const FIRST: usize = 0;
pub(super) const AFTER_TWO: usize = 2;

/// Part of the stroke that steps keep away from its ends.
const MARGIN: f64 = 0.05;

/// The usual step, mm, and the part of the stroke that it takes at most.
const USUAL_MM: f64 = 60.0;
const OF_STROKE: f64 = 0.4;

/// Swings of a sine, and those that do not count.
const SWINGS: u32 = 4;
const LEFT_OUT: u32 = 1;

/// The air at the start of a test.
const AIR: [&str; 4] =
    ["test.pressure_1_pa", "test.pressure_2_pa", "test.temperature_1_k", "test.temperature_2_k"];

/// The usual step on a rig, mm: 60, or two fifths of a shorter stroke. A sine is as high from peak to peak.
#[must_use]
pub fn usual_step_mm(rig: &Rig) -> f64 {
    USUAL_MM.min(OF_STROKE * 1e3 * rig.get(&keys::actuator::STROKE_M))
}

/// A step there, back and there again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// Setpoint before the step, counts.
    pub from: i64,
    /// Target of the step, counts.
    pub to: i64,
}

impl Steps {
    /// A step of `step_mm` at a place between 5 and 95 % of the stroke, or between the soft limits.
    ///
    /// # Errors
    /// When it does not fit between them, or is shorter than a count.
    pub fn of(rig: &Rig, step_mm: f64, place: Place) -> Result<Steps> {
        let (count, [low, high]) = (mm_per_count(rig), range(rig));
        let step = (step_mm / count).round() as i64;
        if step < 1 || step > high - low {
            let [low, high] = [low, high].map(|counts| counts as f64 * count);
            bail!(
                "a step of {step_mm} mm is shorter than a count of {count} mm, or does not fit between {low:.1} and {high:.1} mm"
            );
        }
        let low = low + (place.along * (high - low - step) as f64).round() as i64;
        let ends = [low, low + step];
        let [from, to] = if place.extends { ends } else { [ends[1], ends[0]] };
        Ok(Steps { from, to })
    }

    /// A rig with them as its test.
    ///
    /// # Errors
    /// When the rig cannot have this test.
    pub fn on(&self, rig: &Rig) -> Result<Rig> {
        let Steps { from, to } = *self;
        let at = |n: u32| HOLD_S + f64::from(n) * MOVE_S;
        let moves = format!(
            "test.moves=[[0.0, {from}], [{:?}, {to}], [{:?}, {from}], [{:?}, {to}]]",
            at(0),
            at(1),
            at(2)
        );
        with_test(rig, moves, at(MOVES as u32), from)
    }

    /// How the moves of a run ended, by the true position.
    ///
    /// # Errors
    /// When the run does not show the moves.
    pub(super) fn arrivals(&self, rig: &Rig, run: &Run) -> Result<[Arrival; MOVES], String> {
        let transient = Transient::of_simulation("", rig, run);
        let tightest = BANDS_MM[BANDS_MM.len() - 1];
        let found = moves(&transient, &Motion::of(&transient), None, tightest);
        // The first one is the hold.
        let Some((_, seen)) = found.split_first().filter(|(_, seen)| seen.len() == MOVES) else {
            return Err(format!("it shows {} moves instead of {}", found.len(), MOVES + 1));
        };
        let (time, position) = (&transient.time, &transient.channels[POSITION]);
        let ends = [self.from, self.to].map(|counts| at_count(rig, counts));
        Ok(std::array::from_fn(|n| {
            let begin = time.partition_point(|t| *t < seen[n].start_s);
            let end = seen.get(n + 1).map_or(time.len(), |next| time.partition_point(|t| *t < next.start_s));
            let [from, to] = if n % 2 == 0 { ends } else { [ends[1], ends[0]] };
            Arrival::of(&time[begin..end], &position[begin..end], [from, to], seen[n].limit_cycle)
        }))
    }
}

/// A sine about the middle of the stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Its centre, counts.
    pub middle: i64,
    /// Amplitude, counts.
    pub amplitude: i64,
    /// Frequency, Hz.
    pub hz: f64,
}

impl Sine {
    /// A sine of this height.
    ///
    /// # Errors
    /// When it does not fit into the stroke.
    pub fn of(rig: &Rig, peak_to_peak_mm: f64, hz: f64) -> Result<Sine> {
        let [low, high] = range(rig);
        let amplitude = (peak_to_peak_mm / 2.0 / mm_per_count(rig)).round() as i64;
        if amplitude < 1 || 2 * amplitude > high - low {
            bail!("a sine of {peak_to_peak_mm} mm is lower than two counts, or does not fit into the stroke");
        }
        Ok(Sine { middle: i64::midpoint(low, high), amplitude, hz })
    }

    /// A rig with it as its test.
    ///
    /// # Errors
    /// When the rig cannot have this test.
    pub fn on(&self, rig: &Rig) -> Result<Rig> {
        let Sine { middle, amplitude, hz } = *self;
        let moves = format!(
            "test.move=[{{profile=\"step\", to_counts={middle}}}, {{profile=\"sine\", at_s={HOLD_S:?}, to_counts={middle}, amplitude_counts={amplitude}, frequency_hz={hz:?}, cycles={SWINGS}}}]"
        );
        with_test(rig, moves, HOLD_S + self.swings_s(SWINGS), middle)
    }

    /// The largest distance of the true position from the setpoint after the first period, mm.
    ///
    /// # Errors
    /// When the run is shorter than that.
    pub(super) fn largest_error_mm(&self, rig: &Rig, run: &Run) -> Result<f64, String> {
        let from = HOLD_S + self.swings_s(LEFT_OUT);
        let errors = run
            .rows
            .iter()
            .filter(|row| row.time >= from)
            .map(|row| (at_count(rig, row.observation.setpoint.into()) - 1e3 * row.plant.position).abs());
        errors.reduce(f64::max).ok_or_else(|| "it is shorter than a period".to_owned())
    }

    fn swings_s(&self, swings: u32) -> f64 {
        // Tests last whole microseconds.
        (1e6 * f64::from(swings) / self.hz).round() / 1e6
    }
}

/// The middle of a count, mm: where the drive is when the law sees no error.
pub(super) fn at_count(rig: &Rig, counts: i64) -> f64 {
    encoder::middle(rig, counts as f64) * mm_per_count(rig)
}

/// Between which setpoints all moves lie, counts.
pub(super) fn range(rig: &Rig) -> [i64; 2] {
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let low = rig.get(&keys::safety::END_MIN_MM).unwrap_or(0.0).max(MARGIN * stroke_mm);
    let high = rig.get(&keys::safety::END_MAX_MM).unwrap_or(stroke_mm).min((1.0 - MARGIN) * stroke_mm);
    [(low / mm_per_count(rig)).ceil() as i64, (high / mm_per_count(rig)).floor() as i64]
}

/// A rig at rest at a count, with the air of its file, and with these moves as its test.
pub(super) fn with_test(rig: &Rig, moves: String, duration_s: f64, from: i64) -> Result<Rig> {
    let air = AIR.iter().filter_map(|key| Some(format!("{key}={:?}", rig.number_at(key)?)));
    let own = [
        moves,
        format!("test.duration_s={duration_s:?}"),
        format!("test.position_m={:?}", 1e-3 * at_count(rig, from)),
        format!("{}=false", keys::controller::EXIT_ON_DEAD_BAND.path),
    ];
    Ok(rig.with_test(&own.into_iter().chain(air).collect::<Vec<_>>())?)
}
