//! Faults of the encoder and of the converters, applied to samples.
//!
//! ```text
//! count = (count, or from its loss on that of the last sample before) + sum of the jumps so far
//! raw   = 0 from the instant on at which a sensor comes off
//! ```
//!
//! A fault counts from the first sample at or after it. An encoder that is lost from the start keeps its first count.

use pneudrive_controller::Sample;

use super::{FaultEvent, FaultKind, OpenSensor};

/// The faults of the sensors, and the count that a lost encoder keeps.
#[derive(Clone, Debug, Default)]
pub(crate) struct SensorFaults {
    events: Vec<FaultEvent>,
    /// Of the encoder, without jumps.
    last_count: Option<i32>,
}

impl SensorFaults {
    /// The events in the sensors.
    pub fn new(events: &[FaultEvent]) -> SensorFaults {
        let events = events.iter().copied().filter(|event| !event.is_of_plant()).collect();
        SensorFaults { events, last_count: None }
    }

    /// Applies the faults to the sample taken at `us`.
    #[inline]
    pub fn corrupt(&mut self, us: u64, sample: &mut Sample) {
        if !self.events.is_empty() {
            *sample = self.apply(us, *sample);
        }
    }

    fn apply(&mut self, us: u64, sample: Sample) -> Sample {
        let kinds = || self.events.iter().filter(|event| event.at_us <= us).map(|event| event.kind);
        let lost = kinds().any(|kind| kind == FaultKind::EncoderLoss);
        let count = if lost { self.last_count.unwrap_or(sample.position) } else { sample.position };
        let mut spoilt = Sample { position: count, ..sample };
        for kind in kinds() {
            match kind {
                FaultKind::EncoderJump { counts } => {
                    spoilt.position = spoilt.position.saturating_add(counts);
                }
                FaultKind::SensorOpen(OpenSensor::Pressure1) => spoilt.pressure_1 = 0,
                FaultKind::SensorOpen(OpenSensor::Pressure2) => spoilt.pressure_2 = 0,
                FaultKind::SensorOpen(OpenSensor::Spool) => spoilt.spool = 0,
                _ => {}
            }
        }
        self.last_count = Some(count);
        spoilt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at 0, 10, 20 ... us of an axis at 100, 101, 102 ... counts.
    fn spoilt(events: &[(u64, FaultKind)], samples: u64) -> Vec<Sample> {
        let events: Vec<FaultEvent> =
            events.iter().map(|&(at_us, kind)| FaultEvent { at_us, kind }).collect();
        let mut faults = SensorFaults::new(&events);
        let sample = |k: u64| Sample {
            position: 100 + k as i32,
            pressure_1: 7,
            pressure_2: 8,
            spool: 9,
            home_switch: false,
        };
        (0..samples)
            .map(|k| {
                let mut sample = sample(k);
                faults.corrupt(10 * k, &mut sample);
                sample
            })
            .collect()
    }

    fn counts(events: &[(u64, FaultKind)], samples: u64) -> Vec<i32> {
        spoilt(events, samples).iter().map(|sample| sample.position).collect()
    }

    #[test]
    fn a_lost_encoder_keeps_the_count_of_the_sample_before() {
        assert_eq!(counts(&[(15, FaultKind::EncoderLoss)], 4), [100, 101, 101, 101]);
        assert_eq!(counts(&[(20, FaultKind::EncoderLoss)], 4), [100, 101, 101, 101]);
        assert_eq!(counts(&[(0, FaultKind::EncoderLoss)], 3), [100, 100, 100]);
    }

    #[test]
    fn jumps_add_up_on_a_live_encoder_and_on_a_lost_one() {
        let jump = |counts| FaultKind::EncoderJump { counts };
        assert_eq!(counts(&[(10, jump(50)), (21, jump(-7))], 4), [100, 151, 152, 146]);
        assert_eq!(counts(&[(20, jump(50)), (10, FaultKind::EncoderLoss)], 3), [100, 100, 150]);
        assert_eq!(counts(&[(0, jump(i32::MAX))], 1), [i32::MAX], "it stops at the end of its range");
    }

    #[test]
    fn an_open_sensor_reads_zero_and_the_others_go_on() {
        let open = |sensor| spoilt(&[(10, FaultKind::SensorOpen(sensor))], 2);
        let read = |sample: &Sample| (sample.pressure_1, sample.pressure_2, sample.spool);
        for (sensor, after) in [
            (OpenSensor::Pressure1, (0, 8, 9)),
            (OpenSensor::Pressure2, (7, 0, 9)),
            (OpenSensor::Spool, (7, 8, 0)),
        ] {
            let samples = open(sensor);
            assert_eq!((read(&samples[0]), read(&samples[1])), ((7, 8, 9), after));
        }
    }
}
