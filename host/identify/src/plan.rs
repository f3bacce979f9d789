//! The tests that a fit needs, run on a rig.
//!
//! First comes the movement test, which ends the plan if the drive does not move in the direction of the valve; then the
//! static test (stiction, hysteresis), the dynamic one (top speed and acceleration), and the tests to fit. Before each
//! of these the drive returns to its first position in closed loop.

use anyhow::{Context, Result, bail};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::{Rig, keys};

use super::moves::{self, Planned};
pub use super::recording::NEEDS_PRESSURES;
use super::recording::{NotAtRest, Recording};

/// A rig that tests can be run on.
pub trait TestRig {
    /// Runs a test to its end, in the loop that its rig file has, and disarms the drive.
    ///
    /// # Errors
    /// When the rig refuses it, trips, or stops answering.
    fn run(&mut self, test: &Rig) -> Result<()>;

    /// The transient of the last test, and the file that keeps it; `name` says which test it was.
    ///
    /// # Errors
    /// When the rig has none, stops answering, or the file cannot be written.
    fn record(&mut self, name: &str) -> Result<(String, TargetFile)>;

    /// Leaves the drive disarmed, its valve at the null, until the air in its chambers has come to rest.
    ///
    /// # Errors
    /// When the rig stops answering.
    fn settle(&mut self) -> Result<()> {
        Ok(())
    }

    /// The record of a test that an interrupted plan has made, and the file that keeps it.
    fn kept(&mut self, _name: &str) -> Option<(String, TargetFile)> {
        None
    }

    /// Keeps the record of a test for a plan that goes on behind this one, if it is interrupted.
    ///
    /// # Errors
    /// When that cannot be written.
    fn keep(&mut self, _name: &str, _file: &str) -> Result<()> {
        Ok(())
    }
}

/// Time to return to the position at which the plan began, s.
const RETURN_S: f64 = 1.5;

/// How often a test is run again whose record is refused.
const AGAIN: usize = 3;

/// A movement test with a shorter travel shows nothing, counts.
const MOVED: i32 = 40;
const UNMOVED: i32 = -MOVED;

/// Change of P_1 - P_2 that is a push, counts: far above noise.
const PUSH: i32 = 30;

/// What a plan has recorded.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What is fitted.
    pub fitted: Vec<Recording>,
    /// All records.
    pub all: Vec<Recording>,
}

impl Recorded {
    /// Adds a record for the figures; an unsuitable one is skipped.
    fn read_off(&mut self, recording: Result<Recording>) {
        match recording {
            Ok(recording) => self.all.push(recording),
            Err(error) => log::info!("a record gives no figures: {error:#}"),
        }
    }
}

/// Runs the tests on a rig whose piston stands at `count`; the rig file with either loop has the values that they are
/// made from. Notes go to the log.
///
/// # Errors
/// When a test cannot be run or recorded, or the drive does not move in the direction of the valve.
pub fn run(bench: &mut impl TestRig, closed: &Rig, open: &Rig, count: i32) -> Result<Recorded> {
    if !open.get(&keys::sensors::PRESSURE) {
        bail!("the rig has no pressure sensors (sensors.pressure = false): {NEEDS_PRESSURES}");
    }
    Plan { bench, closed, open, count }.run()
}

/// Opens the valve for a moment where the piston stands, at `count`, toward the end that is farther away, and refuses a drive that does not
/// move in the direction of the valve, pushed by the pressures that its sensors show: in closed loop it would run to an end.
///
/// # Errors
/// When the test cannot be run or recorded, or shows that.
pub fn check_direction(bench: &mut impl TestRig, open: &Rig, count: i32) -> Result<()> {
    let position = position_m(open, count);
    let (movement, direction) = match position > 0.5 * open.get(&keys::actuator::STROKE_M) {
        false => (moves::MOVEMENT, EXTEND),
        true => (moves::MOVEMENT_BACK, RETRACT),
    };
    let test = moves::test(open, position, movement)?;
    bench.run(&test.rig)?;
    let (path, file) = bench.record(test.name)?;
    check_movement(&test.before_it_brakes(file).samples, &direction)
        .with_context(|| format!("{path}, {}", test.name))
}

/// Where the piston stands, m.
fn position_m(rig: &Rig, count: i32) -> f64 {
    // At its stop a piston may read a few counts beyond the stroke.
    (encoder::middle(rig, f64::from(count)) * 1e-3 * mm_per_count(rig))
        .clamp(0.0, rig.get(&keys::actuator::STROKE_M))
}

struct Plan<'a, B> {
    bench: &'a mut B,
    /// The rig file with either loop.
    closed: &'a Rig,
    open: &'a Rig,
    /// The position at which the plan began.
    count: i32,
}

impl<B: TestRig> Plan<'_, B> {
    fn run(mut self) -> Result<Recorded> {
        let (open, position) = (self.open, position_m(self.open, self.count));
        let test = |test: moves::Test| moves::test(open, position, test);
        let movement = test(moves::MOVEMENT)?;
        let ramp = moves::ramp(open, position)?;
        if ramp.is_none() {
            log::info!(
                "the static test is skipped; the drive would travel too far while the valve opens slowly"
            );
        }
        let read_off: Vec<Planned> = ramp.into_iter().chain([test(moves::DYNAMIC)?]).collect();
        let fitted = moves::FITTED.map(test).into_iter().collect::<Result<Vec<_>>>()?;
        let of = |test: &Planned, name: &str, file: &TargetFile| Recording::of(name, file, &test.rig);
        // In closed loop a drive with swapped tubes would run away, so there is no return before this.
        let checked = |name: &str, file: &TargetFile| {
            check_movement(&file.samples, &EXTEND).with_context(|| name.to_owned())?;
            Ok(of(&movement, name, file))
        };
        let mut recorded = Recorded { fitted: Vec::new(), all: Vec::new() };
        recorded.read_off(self.record(&movement, checked)??);
        for test in &read_off {
            self.return_to_the_start(test)?;
            recorded.read_off(self.record(test, |name, file| Ok(of(test, name, file)))??);
        }
        for test in &fitted {
            let fitted = self.fitted(test)?;
            recorded.fitted.push(fitted);
        }
        recorded.all.extend(recorded.fitted.iter().cloned());
        Ok(recorded)
    }

    /// Runs a test and takes its record before it brakes, unless an interrupted plan has made one. Within: why it was not taken; it is not
    /// kept then.
    fn record<T>(
        &mut self,
        test: &Planned,
        take: impl Fn(&str, &TargetFile) -> Result<T>,
    ) -> Result<Result<T>> {
        let told = |path: &str| format!("{path}, {}", test.name);
        if let Some((path, file)) = self.bench.kept(test.name) {
            return Ok(take(&told(&path), &test.before_it_brakes(file)));
        }
        self.bench.run(&test.rig)?;
        let (path, file) = self.bench.record(test.name)?;
        let taken = take(&told(&path), &test.before_it_brakes(file));
        if taken.is_ok() {
            self.bench.keep(test.name, &path)?;
        }
        Ok(taken)
    }

    /// The record of a test from rest. Pressures change while the valve is at its null, and a load may let go of its place by that until
    /// they rest: then the test is run again behind a longer rest.
    fn fitted(&mut self, test: &Planned) -> Result<Recording> {
        let take = |name: &str, file: &TargetFile| Recording::of(name, file, &test.rig);
        self.return_to_the_start(test)?;
        let mut taken = self.record(test, take)?;
        for _ in 0..AGAIN {
            let Some(error) =
                taken.as_ref().err().filter(|error| error.chain().any(|cause| cause.is::<NotAtRest>()))
            else {
                break;
            };
            log::info!("{error:#}; it is run again once the air has come to rest");
            self.return_to_the_start(test)?;
            self.bench.settle()?;
            taken = self.record(test, take)?;
        }
        taken
    }

    /// Returns to the position at which the plan began, unless the test that follows is recorded already.
    fn return_to_the_start(&mut self, test: &Planned) -> Result<()> {
        if self.bench.kept(test.name).is_some() {
            return Ok(());
        }
        let return_move = self.return_move()?;
        self.bench.run(&return_move)
    }

    fn return_move(&self) -> Result<Rig> {
        let settings = [
            keys::test::MOVES.setting(format_args!("[[0.0, {}]]", self.count)),
            keys::test::DURATION_S.setting(RETURN_S),
        ];
        Ok(self.closed.with_test(&settings)?)
    }
}

/// A direction of the drive, in words.
struct Direction {
    /// 1: out, -1: in.
    sign: i32,
    asked: &'static str,
    goes: &'static str,
    goes_back: &'static str,
    /// The chamber that drives it, and the other.
    chambers: [u8; 2],
    /// How the encoder counts where it is turned, and what the piston does.
    counts_and_moves: [&'static str; 2],
}

const EXTEND: Direction = Direction {
    sign: 1,
    asked: "extend",
    goes: "extends",
    goes_back: "retracts",
    chambers: [1, 2],
    counts_and_moves: ["down", "out"],
};

const RETRACT: Direction = Direction {
    sign: -1,
    asked: "retract",
    goes: "retracts",
    goes_back: "extends",
    chambers: [2, 1],
    counts_and_moves: ["up", "in"],
};

/// Whether the drive has moved in the direction of the valve, pushed by the pressure of its chamber.
fn check_movement(samples: &[(i32, RecordedSample)], direction: &Direction) -> Result<()> {
    let (Some((_, first)), Some((_, last))) = (samples.first(), samples.last()) else {
        bail!("nothing was recorded");
    };
    let Direction { sign, asked, goes, goes_back, chambers: [driving, other], counts_and_moves } = direction;
    let travel = sign * (last.position - first.position);
    let push = sign * first_push(samples, first.command);
    match (travel, push) {
        (MOVED.., 1..) => Ok(()),
        (MOVED.., 0) => {
            log::info!(
                "the pressures vary too much before the movement test to show whether their sensors are swapped"
            );
            Ok(())
        }
        (..=UNMOVED, 0) => bail!(
            "the drive {goes_back} by {} counts on a command to {asked}, and the pressures vary too much beforehand to show why: swap the tubes of the valve's ports, or turn the encoder (encoder.polarity, or the wiring of one that is absolute), and start again",
            -travel
        ),
        (..=UNMOVED, ..=-1) => bail!(
            "the drive {goes_back} by {} counts on a command to {asked}, and chamber {other} is fed: the tubes of the valve's ports are swapped, or its polarity is wrong; correct this and start again",
            -travel
        ),
        (..=UNMOVED, 1..) => bail!(
            "the encoder counts {} by {} while chamber {driving} pushes the piston {}; change encoder.polarity, or the wiring of one that is absolute, and start again",
            counts_and_moves[0],
            -travel,
            counts_and_moves[1]
        ),
        (MOVED.., ..=-1) => bail!(
            "the drive {goes} by {travel} counts while the pressure of chamber {other} rises: the pressure sensors are swapped; correct this and start again"
        ),
        _ => bail!(
            "the drive moves by only {travel} counts with the valve wide open; check the air supply, the enable of the amplifier, the spool and the encoder"
        ),
    }
}

/// The change of P_1 - P_2, counts, by which pressures first leave what they were before the first command: that moves the
/// drive, and what comes later is the motion's own.
fn first_push(samples: &[(i32, RecordedSample)], resting: i16) -> i32 {
    let over =
        |(_, sample): &(i32, RecordedSample)| i32::from(sample.pressure_1) - i32::from(sample.pressure_2);
    let rest = samples.iter().take_while(|(_, sample)| sample.command == resting).count();
    let mean = samples[..rest].iter().map(over).sum::<i32>() / rest.max(1) as i32;
    // Under a dither, and where a drive creeps, pressures do not stand still before either.
    let restless = samples[..rest].iter().map(|sample| (over(sample) - mean).abs()).max().unwrap_or(0);
    let mut pushes = samples[rest..].iter().map(|sample| over(sample) - mean);
    pushes.find(|push| push.abs() >= PUSH + 2 * restless).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(travel: i32, push: i16) -> String {
        // Before the command pressures swing by 35 counts, as under a dither.
        verdict_under(travel, push, 35)
    }

    fn verdict_under(travel: i32, push: i16, swing: i16) -> String {
        told(travel, push, swing, &EXTEND)
    }

    fn told(travel: i32, push: i16, swing: i16, direction: &Direction) -> String {
        let sample = |k: i32| RecordedSample {
            position: 8000 + travel * k.max(0) / 20,
            pressure_1: 1500 + push * k.max(0) as i16 + if k < 0 { swing * (k % 2) as i16 } else { 0 },
            pressure_2: 1500,
            command: if k < 0 { 0 } else { 960 * direction.sign as i16 },
            ..RecordedSample::default()
        };
        let samples: Vec<(i32, RecordedSample)> = (-20..=20).map(|k| (k + 20, sample(k))).collect();
        check_movement(&samples, direction).map_or_else(|error| error.to_string(), |()| "right".to_owned())
    }

    #[test]
    fn each_way_of_going_wrong_has_its_cause() {
        assert_eq!(verdict(900, 20), "right");
        assert!(verdict(-900, -20).contains("tubes of the valve's ports are swapped"));
        assert!(verdict(-900, 20).contains("encoder.polarity"));
        assert!(verdict(900, -20).contains("sensors are swapped"));
        assert!(verdict(3, 20).contains("check the air supply"));
    }

    #[test]
    fn a_movement_back_is_judged_as_its_mirror_image() {
        let back = |travel, push| told(travel, push, 35, &RETRACT);
        assert_eq!(back(-900, -20), "right");
        assert!(
            back(900, 20).contains("extends by 900 counts on a command to retract, and chamber 1 is fed")
        );
        assert!(back(900, -20).contains("the encoder counts up by 900 while chamber 2 pushes the piston in"));
        assert!(back(-900, 20).contains("retracts by 900 counts while the pressure of chamber 1 rises"));
        assert!(back(-3, -20).contains("check the air supply"));
    }

    #[test]
    fn a_drive_that_moves_is_not_said_to_stand_because_its_pressures_swing() {
        assert_eq!(verdict_under(900, 5, 400), "right");
        assert!(verdict_under(-900, 5, 400).contains("vary too much"));
    }
}
