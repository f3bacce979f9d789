//! The law "cascade" with any model of a drive, on any samples: it neither overflows nor leaves its bounds. That it positions a drive is
//! shown on the twin, `sim/tests/cascade.rs`. On recorded samples it is held to its equations in real numbers, and to its bits.

mod kept;
mod oracle;
mod record;

use crate::bench::{ControllerBench, WIDE};
use oracle::Oracle;
use pneudrive_controller::Mode;
use pneudrive_controller::law::cascade::Cascade;
use pneudrive_controller::law::{Law, Running};
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_controller::{Config, Move, Sample, Sequence, State};
use record::{RECORDS, Record};

/// Positions within this change by less than the largest step of an encoder.
const FAR: i32 = 1 << 30;

/// Numbers that look random and are the same everywhere (xorshift).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// An end of the range or a number in it, as likely of any size.
    fn within(&mut self, min: i32, max: i32) -> i32 {
        let size = self.next() % 32;
        match self.next() % 4 {
            0 => min,
            1 => max,
            _ => ((self.next() >> size) as i32).clamp(min, max),
        }
    }

    /// A sample anywhere, or near the one before.
    fn sample(&mut self, before: Sample) -> Sample {
        let step = self.within(-1 << 20, 1 << 20) >> (self.next() % 32);
        let position = match self.next() % 50 {
            0 => self.within(-FAR, FAR),
            _ => before.position.saturating_add(step).clamp(-FAR, FAR),
        };
        let mut raw = |before: i16| match self.next() % 20 {
            // One below 0 is that of a converter which does not answer, and ends the run.
            0 => self.within(0, i32::from(i16::MAX) - 1) as i16,
            _ => before.saturating_add((self.next() % 9) as i16 - 4).clamp(0, i16::MAX - 1),
        };
        Sample {
            position,
            pressure_1: raw(before.pressure_1),
            pressure_2: raw(before.pressure_2),
            spool: raw(before.spool),
            ..before
        }
    }
}

fn law(state: &State) -> &Cascade {
    let Running::Cascade(law) = state.law() else { panic!("the law that was chosen") };
    law
}

/// What is learned is within the bounds that the law states, whatever it was shown.
fn keeps_its_bounds(law: &Cascade) -> bool {
    let load = law.load();
    (1 << 14..=5 << 15).contains(&load.mass)
        && (19_600..=2 << 16).contains(&load.friction)
        && load.viscous >= 0
        && law.motion().d.abs() <= 1 << 24
        && (1 << 15..=3 << 16).contains(&law.lag().pace)
}

#[test]
fn no_model_and_no_samples_make_it_overflow_or_leave_its_bounds() {
    let mut draws = Draws(0x9e37_79b9_7f4a_7c15);
    let mut taken = 0;
    for _ in 0..400 {
        let mut changes = WIDE.to_vec();
        changes.extend([(id::LAW, Law::Cascade as i32), (id::SENSOR_HIGH_RAW, 32_767)]);
        for line in
            TABLE.iter().filter(|line| ["cascade_", "kept_"].iter().any(|start| line.name.starts_with(start)))
        {
            let value =
                if draws.next().is_multiple_of(2) { line.default } else { draws.within(line.min, line.max) };
            changes.push((line.id, if line.id == id::CASCADE_STROKE { value.max(1) } else { value }));
        }
        changes.push((id::ADAPT, (draws.next() % 2) as i32));
        changes.push((id::PERIOD_US, [200, 1000, 1300, 100_000][(draws.next() % 4) as usize]));
        changes.extend([
            (id::DELAY_US, 50),
            (id::LATE_OUTPUT_US, 20),
            (id::LATE_SAMPLE_US, 50),
            (id::SENSOR_SAMPLES, 1),
        ]);
        if draws.next().is_multiple_of(4) {
            changes.extend([(id::STEPPER, 1), (id::MAX_STEPS, draws.within(1, 2048))]);
        }
        changes.push((id::ENCODER_PM_PER_COUNT, draws.within(1, i32::MAX)));
        let moves: Vec<(u32, i32)> = (0..6).map(|k| (k * 50, draws.within(-i32::MAX, i32::MAX))).collect();
        let mut bench = ControllerBench::running(&changes, &moves);
        let mut sample = Sample { pressure_1: 2000, pressure_2: 2000, ..Sample::default() };
        for _ in 0..300 {
            bench.take(sample);
            assert!(keeps_its_bounds(law(&bench.state)), "{:?}", law(&bench.state).load());
            sample = draws.sample(sample);
            taken += u32::from(bench.state.supervisor.mode() == Mode::Running);
        }
    }
    // A drive that has tripped shows nothing of its law.
    assert!(taken > 400 * 300 / 2, "the law took {taken} samples");
}

#[test]
fn a_law_without_a_model_is_refused() {
    let parameters = crate::bench::changed(&[(id::LAW, Law::Cascade as i32)]);
    let refused = Config::new(&parameters).expect_err("it knows nothing of its drive");
    assert!(refused.advice().contains("cascade_"), "{}", refused.advice());
}

/// A drive that is where it shall be, and whose pressures do not change, is left alone: no command but that of the valve's null.
#[test]
fn a_load_at_rest_is_held_with_a_shut_valve() {
    let changes = [WIDE.as_slice(), &[(id::LAW, Law::Cascade as i32), (id::CASCADE_STROKE, 25_000)]].concat();
    let mut bench = ControllerBench::armed(&changes, &[]);
    bench.sequence = Sequence::new(500);
    bench.sequence.push(Move::step(0, 1000)).expect("room");
    bench.state.start(&bench.config, &bench.sequence).expect("armed");
    // The force that balances the exhaust on a rodless cylinder: none.
    let rest = Sample { position: 1000, pressure_1: 2000, pressure_2: 2000, ..Sample::default() };
    for k in 0..400 {
        assert_eq!(bench.take(rest), 0, "sample {k}");
    }
}

/// A change of any rounding shows here, without the twin. After one that is meant, the example that recorded them records them again.
#[test]
fn on_recorded_samples_it_commands_what_it_did() {
    for (name, text) in RECORDS {
        let record = Record::read(text);
        let mut bench = record.bench();
        for (k, row) in record.rows.iter().enumerate() {
            assert_eq!(bench.take(row.sample()), row.command, "{name}, sample {k}");
        }
    }
}

/// The integers beside the equations in real numbers on the same samples: place (counts), speed (counts a sample), standing force (of
/// the supply's), mass, friction, lag of the valve (parts). Below 2 mm/s the friction of one sample can exceed the speed, and a rounding
/// grows tenfold with each: so the equations take over place and speed after each sample. What is learned they keep to the end.
/// Commands are alike but where a threshold falls to the other side. On bristles that happens in most turns and changes what follows:
/// that record is not among them.
#[test]
fn the_integers_are_the_equations() {
    for (name, text) in RECORDS.into_iter().filter(|(name, _)| *name != "bristles") {
        let record = Record::read(text);
        let (mut bench, mut oracle) = (record.bench(), Oracle::of(&record.parameters));
        let (mut worst, mut unlike) = ([0.0_f64; 6], 0);
        for row in &record.rows {
            let command = bench.take(row.sample());
            let exact = oracle.step(row.position, row.pressures, row.spool, row.setpoint);
            let (law, q16) = (law(&bench.state), |value: i32| f64::from(value) / 65_536.0);
            let differences = [
                law.motion().x as f64 / 65_536.0 - oracle.motion.x,
                q16(law.motion().v) - oracle.motion.v,
                f64::from(law.motion().d) / 16_777_216.0 - oracle.motion.d,
                q16(law.load().mass) - oracle.load.mass(),
                q16(law.load().friction) - oracle.load.friction(),
                q16(law.lag().pace) - oracle.lag.pace,
            ];
            for (worst, difference) in worst.iter_mut().zip(differences) {
                *worst = worst.max(difference.abs());
            }
            unlike += u32::from((command - exact).abs() > 3);
            (oracle.motion.x, oracle.motion.v) = (law.motion().x as f64 / 65_536.0, q16(law.motion().v));
            oracle.commanded(command);
        }
        let bounds = [1e-4, 5e-4, 1e-5, 1e-4, 1e-4, 1e-4];
        let holds = worst.iter().zip(bounds).all(|(worst, bound)| *worst < bound);
        let taken = record.rows.len() as u32;
        assert!(holds && unlike * 100 <= taken, "{name}: {worst:?}, {unlike} of {taken} commands");
    }
}
