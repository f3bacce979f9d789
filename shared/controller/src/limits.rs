//! The limits of an axis: when the supervisor trips, and the soft limits that the user sets.
//!
//! | check | fault |
//! |---|---|
//! | the encoder steps too far in one sample | [`Fault::EncoderStep`] |
//! | a referenced axis leaves its stroke | [`Fault::PositionOutside`] |
//! | a raw pressure stays near an end of its converter for some samples | [`Fault::SensorRange`] |
//! | the valve is open, but the axis stands | [`Fault::NoMotion`] |
//! | the valve is at null, but the axis moves | [`Fault::MotionAtNull`] |
//!
//! The stall detector ([`StallDetector`]) watches a closed loop that runs or holds, and a homing run that leaves its stop
//! or looks for its switch. It notices swapped tubes (the cylinder runs into its end and stays there), a lost encoder
//! and a stuck spool. It sums the opening of the valve while the encoder stands:
//!
//! ```text
//! effort = min(|command - null|, half of the valve) - idle   a sample, while the encoder stands
//! trip:    sum of effort >= (half of the valve - idle) * no-motion time
//! time to trip = no-motion time * (half - idle) / (|command - null| - idle),   at least the no-motion time
//! ```
//!
//! The valve may be shut within the idle part. The idle part is `dead_zone_counts`, but at most a tenth of the
//! largest command.
//!
//! Motion at null is checked while the drive is armed, and after the moves of an open loop. It trips when the axis is
//! faster than a hundredth of the highest speed, or when it creeps far from where it came to rest.

use crate::estimator::Motion;
use crate::fault::Fault;
use crate::signal::Sample;
use crate::standstill::Standstill;

/// The limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The largest command to either side: counts of a DAC, steps of a stepper.
    pub largest_command: i16,
    /// Lowest position, counts: the retracted end less the margin.
    pub position_min: i32,
    /// Highest position, counts: the extended end plus the margin.
    pub position_max: i32,
    /// Furthest step of the encoder in one sample, counts.
    pub encoder_step: u32,
    /// Raw pressures from here down mean an open sensor; -1: none do. Without sensors, the smallest number.
    pub sensor_low: i16,
    /// Raw pressures from here up mean a shorted sensor; 32768: none do.
    pub sensor_high: i32,
    /// A pressure must stay there for this many samples.
    pub sensor_samples: u32,
    /// The stall detector.
    pub stall_detector: StallDetector,
    /// Limit of the motion with the valve at null in [`NULL_SAMPLES`], counts: at a hundredth of the highest speed.
    pub null_motion: u32,
    /// Limit of the creep with the valve at null, from where the axis came to rest, counts.
    pub null_drift: u32,
    /// A smaller distance from where the axis stood is not motion, counts.
    pub no_motion_counts: u32,
    /// Lower soft limit, counts. Setpoints beyond a soft limit are refused, and an open loop does not push beyond it.
    pub soft_min: i32,
    /// Upper soft limit, counts.
    pub soft_max: i32,
}

/// Motion at null is checked over this many samples.
pub const NULL_SAMPLES: u32 = 64;

/// The limit of creep at null, as a multiple of the limit within [`NULL_SAMPLES`].
pub(crate) const NULL_DRIFT: u32 = 4;

/// After a motion the axis may coast for this many samples before motion at null is checked: 1 s at 1.3 ms.
const COASTING_SAMPLES: i32 = 768;

/// The stall detector: the further the valve is open, the sooner a standing axis trips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StallDetector {
    /// Up to this distance from null the valve may be shut, counts or steps.
    pub idle: u32,
    /// Commands further from null than this count as this, counts or steps.
    pub full: u32,
    /// The sum of effort that a standing axis may reach without a trip; `u32::MAX`: it never trips.
    pub most: u32,
}

impl StallDetector {
    /// The detector that trips after `samples` when the valve is open by half or more. `largest`: largest command.
    #[must_use]
    pub fn of(samples: u32, largest: i16, dead_zone: u32) -> StallDetector {
        let largest = u32::from(largest.unsigned_abs());
        let idle = dead_zone.min(largest / 10);
        let full = (largest / 2).max(idle + 1);
        let effort = samples.saturating_mul(full - idle);
        StallDetector { idle, full, most: effort.checked_sub(1).unwrap_or(u32::MAX) }
    }

    /// The effort of one sample with this command; None if the valve may be shut.
    pub(crate) fn effort(&self, from_null: u32) -> Option<u32> {
        (from_null > self.idle).then(|| from_null.min(self.full) - self.idle)
    }
}

impl Limits {
    /// Whether a setpoint is within the soft limits.
    #[must_use]
    pub fn allows(&self, setpoint: i32) -> bool {
        self.soft_min <= setpoint && setpoint <= self.soft_max
    }

    /// The demand, limited to the range of the drive stage.
    #[must_use]
    pub fn command(&self, demand: i32) -> i16 {
        let largest = i32::from(self.largest_command);
        // Not clamp(): it panics if the limits have crossed, and this path must not panic.
        demand.min(largest).max(-largest) as i16
    }

    /// The demand of an open loop, limited so that it does not push beyond a soft limit.
    #[must_use]
    pub fn hold_back(&self, demand: i32, position: i32) -> i32 {
        let pushes_out =
            (position <= self.soft_min && demand < 0) || (position >= self.soft_max && demand > 0);
        if pushes_out { 0 } else { demand }
    }

    fn is_position(&self, position: i32) -> bool {
        self.position_min <= position && position <= self.position_max
    }

    fn are_pressures(&self, raw_1: i16, raw_2: i16) -> bool {
        let is_pressure = |raw: i16| self.sensor_low < raw && i32::from(raw) < self.sensor_high;
        is_pressure(raw_1) && is_pressure(raw_2)
    }
}

/// The inputs of the checks at one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence<'a> {
    pub motion: &'a Motion,
    pub input: &'a Sample,
    /// Whether the axis is referenced.
    pub referenced: bool,
    /// Distance of the command in force from null if it has to move the axis, else 0.
    pub from_null: u32,
}

/// The state of the checks from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Watch {
    bad_sensor: u32,
    standstill: Standstill,
    /// Where the axis came to rest with the valve at null; None while it may coast.
    stands_at: Option<i32>,
    /// Where the axis was when the present [`NULL_SAMPLES`] at null began, and how many of them have passed. The
    /// number is negative while the axis may coast.
    null_from: i32,
    null_samples: i32,
}

impl Watch {
    /// The fault at this sample, if any. The encoder comes first, because every other check relies on it.
    pub fn judge(&mut self, limits: &Limits, seen: &Evidence) -> Option<Fault> {
        if seen.motion.step > limits.encoder_step {
            Some(Fault::EncoderStep)
        } else if seen.referenced && !limits.is_position(seen.motion.position) {
            Some(Fault::PositionOutside)
        } else if self.sensor_is_bad(limits, seen.input) {
            Some(Fault::SensorRange)
        } else if self.stands(limits, seen) {
            Some(Fault::NoMotion)
        } else {
            None
        }
    }

    /// Whether a pressure has been out of range for too long.
    fn sensor_is_bad(&mut self, limits: &Limits, input: &Sample) -> bool {
        if limits.are_pressures(input.pressure_1, input.pressure_2) {
            self.bad_sensor = 0;
            return false;
        }
        self.bad_sensor = self.bad_sensor.saturating_add(1);
        self.bad_sensor >= limits.sensor_samples
    }

    /// The state when the valve has just come to null: the axis may coast.
    pub fn of_a_coasting_axis() -> Watch {
        Watch { null_samples: -COASTING_SAMPLES, ..Watch::default() }
    }

    /// The axis may coast from here on.
    pub fn coasts(&mut self) {
        self.null_samples = -COASTING_SAMPLES;
    }

    /// Whether the axis moves although its valve is at null. `open`: the spool is still on its way there.
    pub fn runs_away(&mut self, limits: &Limits, position: i32, open: bool) -> bool {
        if open || self.null_samples < 0 {
            self.stands_at = None;
        }
        if open || self.null_samples <= 0 {
            self.null_from = position;
        }
        let stands_at = *self.stands_at.get_or_insert(position);
        let next = self.null_samples.wrapping_add(1);
        self.null_samples = if next == NULL_SAMPLES as i32 { 0 } else { next };
        position.abs_diff(self.null_from) > limits.null_motion
            || position.abs_diff(stands_at) > limits.null_drift
    }

    /// Whether the axis has stood although the valve was open for long enough to move it.
    fn stands(&mut self, limits: &Limits, seen: &Evidence) -> bool {
        let Some(effort) = limits.stall_detector.effort(seen.from_null) else {
            self.standstill.restart(seen.motion.position);
            return false;
        };
        let sum = self.standstill.pushed(seen.motion.position, limits.no_motion_counts, effort);
        sum > limits.stall_detector.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn the_demand_is_limited_to_the_range_of_the_stage() {
        let limits = Config::default().limits;
        for (demand, counts) in
            [(0, 0), (2047, 2047), (2048, 2048), (2049, 2048), (-2049, -2048), (i32::MIN, -2048)]
        {
            assert_eq!(limits.command(demand), counts);
        }
        let stepper = Limits { largest_command: 40, ..limits };
        for (demand, steps) in [(0, 0), (40, 40), (41, 40), (-40, -40), (i32::MAX, 40), (i32::MIN, -40)] {
            assert_eq!(stepper.command(demand), steps);
        }
    }

    #[test]
    fn either_pressure_beyond_either_end_of_its_converter_is_none() {
        let limits = Limits { sensor_low: 10, sensor_high: 4000, ..Config::default().limits };
        assert!(limits.are_pressures(11, 3999) && limits.are_pressures(3999, 11));
        for bad in [i16::MIN, 10, 4000, i16::MAX] {
            assert!(!limits.are_pressures(bad, 2000), "{bad}");
            assert!(!limits.are_pressures(2000, bad), "{bad}");
        }
    }

    #[test]
    fn the_idle_part_of_a_valve_is_its_dead_zone_but_a_tenth_of_its_range_at_most() {
        assert_eq!(
            StallDetector::of(384, 2048, 102),
            StallDetector { idle: 102, full: 1024, most: 384 * 922 - 1 }
        );
        assert_eq!(StallDetector::of(384, 12, 102), StallDetector { idle: 1, full: 6, most: 384 * 5 - 1 });
        assert_eq!(
            StallDetector::of(10, 1, 102),
            StallDetector { idle: 0, full: 1, most: 9 },
            "a stage of one step"
        );
    }

    #[test]
    fn a_command_at_the_edge_of_the_idle_part_may_leave_the_valve_shut() {
        let stall_detector = StallDetector::of(384, 2048, 102);
        let efforts = [102, 103, 1024, 1025].map(|from_null| stall_detector.effort(from_null));
        assert_eq!(efforts, [None, Some(1), Some(922), Some(922)]);
    }

    #[test]
    fn an_axis_at_null_goes_no_further_than_allowed_from_where_it_no_longer_coasts() {
        let limits = Limits { null_motion: 10, ..Config::default().limits };
        let mut watch = Watch::of_a_coasting_axis();
        assert!((0..=COASTING_SAMPLES).all(|k| !watch.runs_away(&limits, 100 * k, false)));
        let rest = 100 * COASTING_SAMPLES;
        assert!(!watch.runs_away(&limits, rest + 10, false));
        assert!(watch.runs_away(&limits, rest + 11, false));
    }

    /// One count in every 16 samples: too slow for any window to see.
    #[test]
    fn an_axis_that_creeps_at_null_goes_no_further_than_allowed_from_where_it_came_to_stand() {
        let limits = Limits { null_motion: 10, null_drift: 40, ..Config::default().limits };
        for (mut watch, stands_from) in
            [(Watch::default(), 0), (Watch::of_a_coasting_axis(), COASTING_SAMPLES - 1)]
        {
            let position = |k: i32| 1000 + k / 16;
            let tripped = (0..3000).find(|&k| watch.runs_away(&limits, position(k), false));
            let crept = tripped.map(|k| position(k) - position(stands_from));
            assert_eq!(crept, Some(41));
        }
    }
}
