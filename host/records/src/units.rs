//! Figures of a device in mm, kPa and s, as far as its parameters give the scales; otherwise as they were sent.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

use crate::rig_info::RigParameters;

/// The scales of a device's raw numbers; None where unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Units {
    mm_per_count: Option<f64>,
    period_s: Option<f64>,
    /// Value per raw count, and value at a raw count of 0.
    kpa: Option<[f64; 2]>,
    spool_mm: Option<[f64; 2]>,
    open_loop: bool,
    stepper: bool,
    /// The rig has no pressure sensors, so its recorded pressures are not measurements.
    no_pressures: bool,
}

impl Units {
    /// The scales in the parameters of a rig.
    pub fn of(parameters: &RigParameters) -> Units {
        let RigParameters { values, lacking } = parameters;
        let known = |id: u16| values.get(id).filter(|_| !lacking.contains(&id)).map(f64::from);
        let full_scale = known(id::SENSOR_BITS).map(|bits| bits.exp2() - 1.0);
        let range = |min: u16, max: u16, unit: f64| {
            let (min, max) = (known(min)? / unit, known(max)? / unit);
            Some([(max - min) / full_scale?, min]).filter(|[scale, _]| *scale > 0.0)
        };
        Units {
            mm_per_count: known(id::ENCODER_PM_PER_COUNT).map(|pm| pm / 1e9),
            period_s: known(id::PERIOD_US).map(|us| us / 1e6),
            kpa: range(id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA, 1e3),
            spool_mm: range(id::SPOOL_MIN_NM, id::SPOOL_MAX_NM, 1e6),
            ..Units::raw(parameters)
        }
    }

    /// No scales: figures as the device sends them.
    pub fn raw(parameters: &RigParameters) -> Units {
        let is = |id: u16| parameters.values.get(id) == Some(1);
        Units {
            open_loop: is(id::OPEN_LOOP),
            stepper: is(id::STEPPER),
            no_pressures: lacks_pressures(&parameters.values),
            ..Units::default()
        }
    }

    /// A position or a distance of the encoder.
    pub fn length(&self, counts: i32) -> String {
        match self.millimetres(counts) {
            Some(mm) => format!("{mm:.3} mm"),
            None => format!("{counts} counts"),
        }
    }

    /// A place or a distance of the encoder, mm.
    pub fn millimetres(&self, counts: i32) -> Option<f64> {
        self.mm_per_count.map(|mm| f64::from(counts) * mm)
    }

    /// A raw pressure; None of a rig that measures none.
    pub fn raw_pressure(&self, raw: i16) -> Option<i16> {
        (!self.no_pressures).then_some(raw)
    }

    /// An absolute pressure, kPa; None of a rig that measures none.
    pub fn kilopascals(&self, raw: i16) -> Option<f64> {
        self.kpa.filter(|_| !self.no_pressures).map(|[scale, at_0]| f64::from(raw) * scale + at_0)
    }

    /// The position of the spool, mm; None of a stepper, which counts steps.
    pub fn spool_millimetres(&self, raw: i16) -> Option<f64> {
        self.spool_mm.filter(|_| !self.stepper).map(|[scale, at_0]| f64::from(raw) * scale + at_0)
    }

    /// The duration of this many samples, s.
    pub fn seconds(&self, samples: u32) -> Option<f64> {
        self.period_s.map(|period| f64::from(samples) * period)
    }

    /// The count nearest to a position; None if the scale is unknown, or the count is out of range.
    pub fn count_at(&self, mm: f64) -> Option<i32> {
        let count = (mm / self.mm_per_count?).round();
        (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count).then_some(count as i32)
    }

    /// A setpoint: a position or, in open loop, a command.
    pub fn setpoint(&self, counts: i32) -> String {
        if self.open_loop { self.command(counts) } else { self.length(counts) }
    }

    /// A command to the valve. The device does not know the volts of its amplifier.
    pub fn command(&self, counts: i32) -> String {
        let unit = if self.stepper { "steps" } else { "counts" };
        format!("{counts} {unit}")
    }

    /// An absolute pressure.
    pub fn pressure(&self, raw: i16) -> String {
        match self.kilopascals(raw) {
            _ if self.no_pressures => "not measured".to_owned(),
            Some(kpa) => format!("{kpa:.1} kPa"),
            None => format!("{raw} raw"),
        }
    }

    /// The position of the spool; of a stepper in steps.
    pub fn spool(&self, raw: i16) -> String {
        match self.spool_millimetres(raw) {
            _ if self.stepper => format!("{raw} steps"),
            Some(mm) => format!("{mm:.3} mm"),
            None => format!("{raw} raw"),
        }
    }

    /// The duration of this many samples.
    pub fn time(&self, samples: u32) -> String {
        match self.seconds(samples) {
            Some(seconds) => format!("{seconds:.3} s"),
            None => format!("{samples} samples"),
        }
    }
}

/// Whether a rig with these parameters has no pressure sensors.
#[must_use]
pub fn lacks_pressures(values: &Parameters) -> bool {
    values.get(id::PRESSURE_SENSORS) == Some(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(changes: &[(u16, i32)]) -> RigParameters {
        let mut values = Parameters::default();
        changes.iter().for_each(|&(id, value)| values.set(id, value).expect("in range"));
        RigParameters { values, lacking: Vec::new() }
    }

    #[test]
    fn figures_are_in_mm_kpa_and_s() {
        let units = Units::of(&parameters(&[]));
        assert_eq!(units.length(8192), "98.714 mm");
        assert_eq!(units.count_at(98.714), Some(8192));
        assert_eq!(
            (units.pressure(0), units.pressure(4095)),
            ("0.0 kPa".to_owned(), "1000.0 kPa".to_owned())
        );
        assert_eq!((units.spool(0), units.time(1000)), ("-1.250 mm".to_owned(), "1.300 s".to_owned()));
        assert_eq!(
            (units.setpoint(8192), units.command(-7)),
            ("98.714 mm".to_owned(), "-7 counts".to_owned())
        );
        let open = Units::of(&parameters(&[(id::OPEN_LOOP, 1)]));
        assert_eq!(open.setpoint(960), "960 counts", "a setpoint of an open loop is a command");
        assert_eq!(Units::of(&parameters(&[(id::STEPPER, 1)])).spool(-3), "-3 steps");
    }

    #[test]
    fn a_pressure_without_a_sensor_is_no_figure() {
        let without = parameters(&[(id::PRESSURE_SENSORS, 0)]);
        for units in [Units::of(&without), Units::raw(&without)] {
            assert_eq!(units.pressure(0), "not measured");
            assert_eq!((units.kilopascals(0), units.raw_pressure(0)), (None, None));
        }
        let units = Units::of(&parameters(&[]));
        assert_eq!((units.kilopascals(0), units.raw_pressure(0)), (Some(0.0), Some(0)));
    }

    #[test]
    fn where_a_scale_is_unknown_what_was_sent_is_said() {
        let raw = Units::raw(&parameters(&[]));
        assert_eq!((raw.length(8192), raw.pressure(7)), ("8192 counts".to_owned(), "7 raw".to_owned()));
        assert_eq!((raw.spool(7), raw.time(9)), ("7 raw".to_owned(), "9 samples".to_owned()));
        assert_eq!(raw.count_at(1.0), None);
        let empty = Units::of(&parameters(&[(id::PRESSURE_MIN_PA, 1_000_000)]));
        assert_eq!((empty.pressure(7), empty.length(0)), ("7 raw".to_owned(), "0.000 mm".to_owned()));
        let lacking = RigParameters { lacking: vec![id::ENCODER_PM_PER_COUNT], ..parameters(&[]) };
        assert_eq!(Units::of(&lacking).length(5), "5 counts", "a default is no measurement");
    }
}
