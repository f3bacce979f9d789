//! A TARGET file as a fit takes it: the commands, and what counts of each channel.

mod encoder;
mod rest;

use std::ops::Range;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Command;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::RecordedSample;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::component::operator::{self, hysteresis};
use pneudrive_sim::component::sensors::calibration::Calibration;
use pneudrive_sim::follow::{Followed, Reading, Timing, follow, follow_within};
use pneudrive_sim::key::Typed;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Rig};

use pneudrive_evaluate::replay::parameters::Header;
use pneudrive_evaluate::replay::samples;

use encoder::independent;
pub(super) use rest::{FEWEST_AT_REST, NotAtRest};
use rest::{counts_of_yield, samples_at_rest};

/// What is compared, and in what unit it is shown.
pub const CHANNELS: [(&str, &str); 4] =
    [("position", "mm"), ("pressure 1", "kPa"), ("pressure 2", "kPa"), ("spool", "mm")];

/// The keys of an initial state that sensors measure.
const KEYS_OF_START: [&str; 3] =
    [keys::test::POSITION_M.key.path, keys::test::PRESSURE_1_PA.key.path, keys::test::PRESSURE_2_PA.key.path];

/// The temperatures that the last move has left, which no sensor measures.
const AIR_OF_START: [&Typed<f64>; 2] = [&keys::test::TEMPERATURE_1_K, &keys::test::TEMPERATURE_2_K];

/// The dry friction of a load, and the part of the file's that may be left of it: it is known to a factor of two.
const DRY_FRICTION: [&str; 4] = [
    keys::friction::STATIC_EXTEND_N.key.path,
    keys::friction::COULOMB_EXTEND_N.key.path,
    keys::friction::STATIC_RETRACT_N.key.path,
    keys::friction::COULOMB_RETRACT_N.key.path,
];
const MIN_FRICTION: f64 = 0.5;

/// A dither may shake a load so many times as far as that of the model: what it does depends on all that a fit has to find.
const SHAKEN_FURTHER: f64 = 2.0;

/// A measured period may be off by this part: more is no drift of a clock.
const MAX_PERIOD_ERROR: f64 = 0.5;

/// Variance up to which a converter is taken to have no noise of its own, squares of a count.
const ROUNDING_ALONE: f64 = 0.15;

/// Quantities of an initial state: those that are measured, the temperatures, and the side of the hysteresis on which the last command
/// has left the spool.
pub const STARTS: usize = KEYS_OF_START.len() + AIR_OF_START.len() + 1;

/// The places of the pressures among them.
pub(super) const PRESSURES: [usize; 2] = [1, 2];

/// The places of the temperatures.
pub(super) const AIR: Range<usize> = KEYS_OF_START.len()..KEYS_OF_START.len() + AIR_OF_START.len();

/// The place of the side of the hysteresis.
pub(super) const SIDE: usize = STARTS - 1;

/// Whether a spool remembers its last command: one without hysteresis does not, and a dither wider than that makes it forget.
#[must_use]
pub(super) fn remembers(rig: &Rig) -> bool {
    rig.get(&keys::operator::MODEL).is_solenoid()
        && 1e3 * hysteresis::half_width(rig) > rig.get(&keys::dither::DITHER_MM)
}

/// Samples to either side over which the speed of a drive is formed. That of a spool is formed over one: it stops
/// at once.
const HALF_WIDTH: usize = 8;

/// The golden ratio less 1.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Fewest samples of a record.
pub(super) const FEWEST_OF_A_RECORD: usize = 50;

/// Why there is no fit without pressures, and what to do.
pub const NEEDS_PRESSURES: &str = "a fit needs both pressures. From the position alone mass, friction and load, discharge, lap and null of the valve, tubes, dead volumes, leakage, supply pressure and the air at the start cannot be told apart. Put a pressure transmitter at each chamber for the identification (sensors.pressure = true); both may come off again afterwards";

/// A channel in counts.
#[derive(Clone, Debug, Default)]
pub struct Channel {
    /// What was read at each sample.
    pub measured: Vec<f64>,
    /// The samples that count, in order.
    pub taken: Vec<usize>,
    /// SI at 0 counts, with what rounding takes off in the mean.
    pub offset: f64,
    /// SI per count.
    pub scale: f64,
    /// The noise that the rest at its beginning shows.
    pub rest: Rest,
}

/// Scatter around a straight line, counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rest {
    /// Sum of the squares.
    pub squares: f64,
    /// Samples less the two numbers of the line.
    pub freedom: f64,
}

/// A record.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Where it comes from, for messages.
    pub name: String,
    /// When its samples were taken and its commands driven.
    pub timing: Timing,
    /// The commands, one for each sample.
    pub commands: Vec<Command>,
    /// The channels, in the order of [`CHANNELS`].
    pub channels: [Channel; CHANNELS.len()],
    /// Position, m, and pressures, Pa, of the first sample.
    pub start: [f64; KEYS_OF_START.len()],
}

impl Rest {
    /// Of readings at equal distances: around a straight line, or of a spool and pressures that follow a dither, in
    /// their sixth differences, in which white noise has 924 times its variance and a slow swing none.
    fn of(readings: &[f64], dithered: bool) -> Rest {
        if dithered { Rest::of_differences(readings) } else { Rest::of_line(readings) }
    }

    fn of_line(readings: &[f64]) -> Rest {
        let n = readings.len() as f64;
        let mean = readings.iter().sum::<f64>() / n;
        let from_middle = |k: usize| k as f64 - 0.5 * (n - 1.0);
        let steepness = readings.iter().enumerate().map(|(k, y)| from_middle(k) * y).sum::<f64>()
            / (n * (n * n - 1.0) / 12.0);
        let off = |(k, y): (usize, &f64)| (y - mean - steepness * from_middle(k)).powi(2);
        Rest { squares: readings.iter().enumerate().map(off).sum(), freedom: n - 2.0 }
    }

    fn of_differences(readings: &[f64]) -> Rest {
        const SIXTH: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        const VARIANCE: f64 = 924.0;
        // Neighbouring differences share readings: 924^2 over the sum of their squared correlations.
        const INDEPENDENT: f64 = VARIANCE * VARIANCE / 2_704_156.0;
        let difference = |seven: &[f64]| seven.iter().zip(SIXTH).map(|(y, weight)| y * weight).sum::<f64>();
        let differences = readings.windows(SIXTH.len()).map(difference);
        let squares = differences.map(|difference| difference * difference / VARIANCE).sum::<f64>();
        let n = readings.len().saturating_sub(SIXTH.len() - 1) as f64;
        Rest { squares: INDEPENDENT * squares, freedom: INDEPENDENT * n }
    }

    /// Whether there is no noise but that of rounding: then readings at rest repeat one error.
    fn is_rounding(&self) -> bool {
        self.squares < ROUNDING_ALONE * self.freedom
    }
}

impl Channel {
    /// What the model's reading would be in counts.
    #[must_use]
    pub fn counts(&self, si: f64) -> f64 {
        (si - self.offset) / self.scale
    }
}

/// The reading of a channel, SI.
#[must_use]
pub fn reading(of: &Reading, channel: usize) -> f64 {
    match channel {
        0 => of.position,
        1 | 2 => of.pressures[channel - 1],
        _ => of.spool,
    }
}

impl Recording {
    /// The record of a file, for the model `rig`.
    ///
    /// # Errors
    /// When it is not whole, not of decimation 1, too short, or of another kind of drive.
    pub fn of(name: &str, file: &TargetFile, rig: &Rig) -> Result<Recording> {
        Recording::read(name, file, rig).with_context(|| format!("{name} cannot be fitted"))
    }

    fn read(name: &str, file: &TargetFile, rig: &Rig) -> Result<Recording> {
        let recorded = samples(file)?;
        let header = Header::of(file)?.parameters;
        let parameter = |id: u16| header.get(id).unwrap_or(0);
        let stepper = parameter(id::STEPPER) != 0;
        if stepper != (rig.get(&keys::operator::MODEL) == operator::OperatorKind::Stepper) {
            bail!("it and the rig file do not have the same drive stage (operator.model)");
        }
        if recorded.len() < FEWEST_OF_A_RECORD {
            bail!("it has {} samples; a fit needs at least {FEWEST_OF_A_RECORD}", recorded.len());
        }
        if let Some(missing) = ["pressure_1", "pressure_2"].iter().find(|name| file.is_unknown(name)) {
            bail!("it has no {missing}: {NEEDS_PRESSURES}");
        }
        let timing = timing(file.period_us()?, parameter(id::PERIOD_US), parameter(id::DELAY_US))?;
        let commands: Vec<Command> = recorded.iter().map(|sample| command(sample, stepper)).collect();
        let scales = Scales::of(file)?;
        let dithered =
            rig.get(&keys::operator::MODEL).is_solenoid() && rig.get(&keys::dither::DITHER_MM) > 0.0;
        let shaken = if dithered { scales.counts_of_dither(&recorded[0], rig, timing, &commands) } else { 0 };
        let rest = samples_at_rest(&recorded, counts_of_yield(rig) + encoder::noise(rig) + shaken)?;
        let full_scale = f64::from((1u32 << parameter(id::SENSOR_BITS)) - 1);
        let mut channels = Converters { scales, full_scale, rest, dithered }.channels(&recorded, rig);
        if stepper || file.is_unknown("spool") {
            // SPLLOC is the requested position, not a measured one.
            channels[3].taken.clear();
        }
        let start = [0, 1, 2].map(|c| channels[c].offset + channels[c].measured[0] * channels[c].scale);
        Ok(Recording { name: name.to_owned(), timing, commands, channels, start })
    }

    /// The initial state of a rig of which sensors with these errors read what is `off` the one that was measured, in counts, and
    /// of which the air is `off` the file's, with the side of its hysteresis behind them: its values, each with its key.
    pub fn start(
        &self,
        rig: &Rig,
        off: [f64; STARTS],
        calibration: &Calibration,
    ) -> impl Iterator<Item = (&'static str, f64)> + use<> {
        let read: [f64; KEYS_OF_START.len()] =
            std::array::from_fn(|i| self.start[i] + off[i] * self.channels[i].scale);
        let values = if calibration.is_exact() {
            read
        } else {
            let (position, [one, two]) = calibration.true_values(read[0], [read[1], read[2]]);
            [position, one, two]
        };
        let air = AIR_OF_START.map(|key| rig.get(key));
        let air = [0, 1].map(|i| (AIR_OF_START[i].key.path, air[i] + off[AIR.start + i]));
        let side = remembers(rig).then_some((keys::hysteresis::HYSTERESIS_SIDE.key.path, off[SIDE]));
        KEYS_OF_START.into_iter().zip(values).chain(air).chain(side)
    }

    /// What the sensors of `rig` would read under the first `samples` commands; no more than `most` evaluations of the
    /// model's equations are spent on it. What was spent is told with it.
    ///
    /// # Errors
    /// When the rig cannot be integrated, or takes more evaluations.
    pub fn follow(
        &self,
        rig: &Rig,
        accuracy: Accuracy,
        samples: usize,
        most: u64,
    ) -> (Result<Vec<Reading>>, u64) {
        let Followed { mut readings, evaluations, failed } =
            follow_within(rig, accuracy, self.timing, &self.commands[..samples], most);
        if let Some(failed) = failed {
            return (Err(failed.into()), evaluations);
        }
        if readings.len() < samples {
            let error = anyhow!("it takes more than {most} evaluations of the model's equations");
            return (Err(error), evaluations);
        }
        let calibration = Calibration::of_rig(rig);
        if !calibration.is_exact() {
            readings.iter_mut().for_each(|reading| *reading = calibration.read(reading));
        }
        (Ok(readings), evaluations)
    }
}

/// A measured period, and the period and delay that were asked for, us.
fn timing(measured: f64, asked: i32, delay: i32) -> Result<Timing> {
    if (measured / f64::from(asked)).ln().abs() > MAX_PERIOD_ERROR {
        bail!("its header has a measured period of {measured} us, and {asked} us was asked for");
    }
    let timing = Timing { period_us: measured.round() as u64, delay_us: u64::try_from(delay)? };
    if timing.period_us <= timing.delay_us {
        bail!("its header has a period of {} us and a delay of {delay} us", timing.period_us);
    }
    Ok(timing)
}

/// What the counts of a record are: SI at 0 counts and SI per count.
#[derive(Clone, Copy, Debug)]
struct Scales {
    /// Per count alone.
    position: f64,
    pressure: [f64; 2],
    spool: [f64; 2],
}

impl Scales {
    fn of(file: &TargetFile) -> Result<Scales> {
        Ok(Scales {
            position: 1e-3 * file.positive("mm_per_count")?,
            pressure: [file.number("pressure_offset_pa")?, file.positive("pressure_scale_pa")?],
            spool: [1e-3 * file.number("spool_offset_mm")?, 1e-3 * file.positive("spool_scale_mm")?],
        })
    }

    /// How far a dither may shake a load at rest, counts: by what it does to that of the model under the first of the commands,
    /// with as little dry friction as it may have.
    fn counts_of_dither(
        &self,
        first: &RecordedSample,
        rig: &Rig,
        timing: Timing,
        commands: &[Command],
    ) -> i32 {
        let pressure = |raw: i16| self.pressure[0] + self.pressure[1] * f64::from(raw);
        let position = self.position * f64::from(first.position);
        let start = [position, pressure(first.pressure_1), pressure(first.pressure_2)];
        let friction =
            DRY_FRICTION.iter().filter_map(|path| Some((*path, MIN_FRICTION * rig.number_at(path)?)));
        let values: Vec<_> = KEYS_OF_START.into_iter().zip(start).chain(friction).collect();
        let held = commands.iter().take_while(|command| command.counts == commands[0].counts).count();
        let followed = rig
            .with_numbers(&values)
            .map(|loose| follow(&loose, Accuracy::default(), timing, &commands[..held]));
        let Ok(Ok(readings)) = followed else { return 0 };
        let moved = readings.iter().map(|reading| (reading.position - readings[0].position).abs());
        (SHAKEN_FURTHER * moved.fold(0.0, f64::max) / self.position).ceil() as i32
    }
}

/// The converters of a record.
struct Converters {
    scales: Scales,
    full_scale: f64,
    /// Samples at rest.
    rest: usize,
    dithered: bool,
}

impl Converters {
    fn channels(&self, recorded: &[RecordedSample], rig: &Rig) -> [Channel; CHANNELS.len()] {
        let Scales { position, pressure, spool } = self.scales;
        let counts = |of: fn(&RecordedSample) -> i32| -> Vec<f64> {
            recorded.iter().map(|sample| f64::from(of(sample))).collect()
        };
        let at_rest = |readings: &[f64]| Rest::of(&readings[..self.rest], self.dithered);
        [
            encoder::channel(counts(|sample| sample.position), position, at_rest, rig),
            self.channel(counts(|sample| sample.pressure_1.into()), pressure),
            self.channel(counts(|sample| sample.pressure_2.into()), pressure),
            self.channel(counts(|sample| sample.spool.into()), spool),
        ]
    }

    fn channel(&self, measured: Vec<f64>, [offset, scale]: [f64; 2]) -> Channel {
        // A reading at an end of the converter's range is unknown.
        let within = |k: &usize| measured[*k] > 0.0 && measured[*k] < self.full_scale;
        let rest = Rest::of(&measured[..self.rest], self.dithered);
        let all = if rest.is_rounding() { independent(&measured, 1) } else { (0..measured.len()).collect() };
        let taken = all.into_iter().filter(within).collect();
        Channel { taken, rest, measured, offset, scale }
    }
}

/// SPLLOC is noted before the pulse of the sample's output.
fn command(sample: &RecordedSample, stepper: bool) -> Command {
    let step = if stepper { (sample.command - sample.spool).signum() as i8 } else { 0 };
    Command { counts: sample.command, step, drive_enable: true }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance of the rounding at the samples that are taken.
    fn rounding(path: impl Fn(usize) -> f64) -> (f64, f64, usize) {
        let positions: Vec<f64> = (0..4000).map(path).collect();
        let counts: Vec<f64> = positions.iter().map(|position| position.floor()).collect();
        let errors: Vec<f64> =
            independent(&counts, HALF_WIDTH).iter().map(|&k| counts[k] + 0.5 - positions[k]).collect();
        let n = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / n;
        (mean, errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / n, errors.len())
    }

    #[test]
    fn a_drive_that_creeps_is_not_always_seen_at_the_edge_of_a_count() {
        let (mean, variance, samples) = rounding(|k| 0.3 + 0.0731 * k as f64);
        assert!(samples > 150, "{samples}");
        assert!(mean.abs() < 0.06, "{mean}");
        assert!((variance * 12.0 - 1.0).abs() < 0.2, "{variance}");
    }

    #[test]
    fn of_a_fast_drive_every_sample_counts() {
        let (mean, variance, samples) = rounding(|k| 3.307 * k as f64);
        assert!(samples > 3900 && mean.abs() < 0.02 && (variance * 12.0 - 1.0).abs() < 0.1);
    }

    #[test]
    fn the_noise_of_a_rest_is_found_on_a_slope_and_under_a_dither() {
        // Even noise of a variance of 1 from multiples of the golden ratio.
        let noise = |k: usize| ((k * k) as f64 * 0.618_033_988_749_895).fract() * 12f64.sqrt();
        let sloping: Vec<f64> = (0..4000).map(|k| 0.3 * k as f64 + noise(k)).collect();
        let dithered: Vec<f64> =
            sloping.iter().enumerate().map(|(k, y)| y + 100.0 * (0.2 * k as f64).sin()).collect();
        for rest in [Rest::of(&sloping, false), Rest::of(&dithered, true)] {
            let variance = rest.squares / rest.freedom;
            assert!((variance - 1.0).abs() < 0.1, "{variance}");
        }
    }

    #[test]
    fn a_rest_counts_once() {
        let (_, _, samples) = rounding(|k| if k < 2000 { 5.3 } else { 7.9 });
        assert_eq!(samples, 2);
    }

    /// A light load on a cylinder of 40 mm bore, whose valve has a dither, with a part of its dry friction and of the amplitude.
    fn shaken(friction: f64, amplitude: f64) -> Rig {
        let keys = format!(
            "[actuator]\nbore_m = 0.04\nstroke_m = 0.1\nrod_diameter_m = 0.0\nresidual_volume_1_m3 = 1.3e-5\nresidual_volume_2_m3 = 9.5e-6\n[load]\nmass_kg = 1.0\nstatic_extend_n = {}\ncoulomb_extend_n = {}\nstatic_retract_n = {}\ncoulomb_retract_n = {}\n[operator]\nmodel = \"solenoid-empirical\"\ndither_mm = {}\n[controller]\nloop = \"open\"\n[test]\nposition_m = 0.05\n",
            22.8 * friction,
            8.6 * friction,
            36.0 * friction,
            10.9 * friction,
            0.2 * amplitude
        );
        Rig::read("shaken", &keys).expect("valid")
    }

    /// How many of 31 samples under the null count as rest by the file's rig, of a load that moves by `counts` more than that of
    /// `real`.
    fn samples_at_rest_of(real: &Rig, counts: i32) -> Option<usize> {
        let (file, timing) = (shaken(1.0, 1.0), Timing { period_us: 1300, delay_us: 500 });
        let commands = [Command { counts: 0, step: 0, drive_enable: true }; 31];
        let scales = Scales { position: 1e-5, pressure: [0.0, 244.2], spool: [0.0, 1.0] };
        let sample = |(k, reading): (usize, &Reading)| RecordedSample {
            position: (reading.position / scales.position) as i32 + if k > 5 { counts } else { 0 },
            pressure_1: (reading.pressures[0] / scales.pressure[1]) as i16,
            pressure_2: (reading.pressures[1] / scales.pressure[1]) as i16,
            ..RecordedSample::default()
        };
        let readings = follow(real, Accuracy::default(), timing, &commands).expect("a run");
        let recorded: Vec<RecordedSample> = readings.iter().enumerate().map(sample).collect();
        assert!(recorded[15].position.abs_diff(recorded[0].position) > 20, "its dither shakes it");
        samples_at_rest(&recorded, scales.counts_of_dither(&recorded[0], &file, timing, &commands)).ok()
    }

    #[test]
    fn a_load_that_its_dither_shakes_no_further_than_it_may_is_at_rest() {
        for (friction, amplitude) in [(1.0, 1.0), (0.9, 1.1), (1.1, 1.1), (0.9, 0.9), (1.1, 0.9)] {
            let rest = samples_at_rest_of(&shaken(friction, amplitude), 0);
            assert_eq!(rest, Some(31), "{friction} of the file's friction, {amplitude} of its dither");
        }
        assert_eq!(samples_at_rest_of(&shaken(1.0, 1.0), 1000), None, "something else moves it");
    }

    /// As a cylinder does: 13 mm within 20 samples.
    #[test]
    fn a_rest_counts_once_even_where_a_fast_start_follows() {
        let position = |k: usize| 12448.13 + 2.7 * (k as f64 - 49.5).max(0.0).powi(2);
        let counts: Vec<f64> = (0..70).map(|k| position(k).floor()).collect();
        let at_rest = independent(&counts, HALF_WIDTH).iter().filter(|&&k| k < 50).count();
        assert_eq!(at_rest, 1);
    }
}
