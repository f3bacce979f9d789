//! A sine as the test of a rig.

use pneudrive_sim::component::encoder;
use pneudrive_sim::keys;

use crate::tuning::Variant;
use crate::tuning::trial::{DWELL_S, TaskMoves, Trial};
use pneudrive_evaluate::transient::Transient;

/// Amplitude, as a share of the stroke, and at most, mm.
const OF_STROKE: f64 = 0.2;
const LARGEST_MM: f64 = 60.0;

/// Number of swings of a sine, and of those that are left out.
const SWINGS: u32 = 3;
const LEFT_OUT: u32 = 1;

/// How long the test lasts, s.
pub(super) fn lasts_s(frequency_hz: f64) -> f64 {
    DWELL_S + f64::from(SWINGS) / frequency_hz
}

/// A sine, in the counts of its rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Its centre, counts.
    pub middle: i64,
    /// Amplitude, counts.
    pub amplitude: i64,
    /// Length of a count, mm.
    pub mm_per_count: f64,
    /// Start of the sine, s.
    pub begins_s: f64,
}

impl Sine {
    /// As it fits the stroke of a rig.
    pub(in crate::tuning) fn of(trial: &Trial, frequency_hz: f64) -> Sine {
        let mm_per_count = encoder::mm_per_count(&trial.rig);
        let [low, high] = trial.range_counts();
        let wanted_mm = LARGEST_MM.min(OF_STROKE * 1e3 * trial.rig.get(&keys::actuator::STROKE_M));
        let period_s = trial.rig.get(&keys::controller::PERIOD_S);
        Sine {
            frequency_hz,
            middle: i64::midpoint(low, high),
            amplitude: ((wanted_mm / mm_per_count).round() as i64).min((high - low) / 2),
            mm_per_count,
            begins_s: (DWELL_S / period_s).ceil() * period_s,
        }
    }

    /// Its centre, mm.
    #[must_use]
    pub fn middle_mm(&self) -> f64 {
        self.middle as f64 * self.mm_per_count
    }

    /// Amplitude, mm.
    #[must_use]
    pub fn amplitude_mm(&self) -> f64 {
        self.amplitude as f64 * self.mm_per_count
    }

    /// Its largest speed, mm/s.
    #[must_use]
    pub fn top_speed_mm_s(&self) -> f64 {
        std::f64::consts::TAU * self.frequency_hz * self.amplitude_mm()
    }

    /// Begin and end of the time in which it is measured, s.
    #[must_use]
    pub(crate) fn measured_s(&self) -> [f64; 2] {
        [LEFT_OUT, SWINGS].map(|swings| self.begins_s + f64::from(swings) / self.frequency_hz)
    }

    /// The test that it is.
    pub(in crate::tuning) fn course(&self) -> TaskMoves {
        let Sine { frequency_hz, middle, amplitude, .. } = self;
        TaskMoves {
            moves: keys::test::MOVE.setting(format_args!(
                "[{{profile=\"step\", to_counts={middle}}}, {{profile=\"sine\", at_s={DWELL_S:?}, to_counts={middle}, amplitude_counts={amplitude}, frequency_hz={frequency_hz:?}, cycles={SWINGS}}}]"
            )),
            duration_s: lasts_s(*frequency_hz),
            from: *middle,
        }
    }

    /// Its run on the rig of the file.
    ///
    /// # Errors
    /// Why it did not come to its end.
    pub fn transient(&self, trial: &Trial, gains: &[String]) -> Result<Transient, String> {
        let rig = trial.rig_on(&self.course(), gains, &Variant::NOMINAL);
        let rig = rig.map_err(|problems| problems.to_string())?;
        trial.measure(&rig, |run| Ok(Transient::of_simulation("", &rig, run)))
    }
}
