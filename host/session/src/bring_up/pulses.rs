//! Pulses: short commands, each an open-loop test that the board ends by itself, and the answers to them.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use pneudrive_controller::drive::MAX_COUNTS;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Move, Sequence};
use pneudrive_protocol::Mode;
use pneudrive_records::words;

use super::response::{Pair, Response, Window};
use super::signs::Signs;
use super::silence::Answered;
use super::{BringUp, Check};

/// The name of this check.
pub(super) const NAME: &str = "pulses";

/// How long a pulse lasts, s.
pub(super) const PULSE_S: f64 = 0.1;

/// `law` of a drive whose valve is either shut or open.
const ON_OFF: i32 = 3;

/// Recorded time before and after a pulse, s.
const BEFORE_S: f64 = 0.05;
const AFTER_S: f64 = 0.35;

/// Commands of the pulses, percent of the valve.
const LEVELS: [u8; 9] = [3, 5, 8, 12, 17, 23, 30, 40, 50];

/// A slide that has moved this far has answered, mm.
const ANSWER_MM: f64 = 0.5;

/// Beyond this distance no larger pulse is needed to see the pressures, mm.
const PLENTY_MM: f64 = 3.0;

/// Smallest change of a pressure and of the spool that counts as an answer, part of the converter's range.
const ANSWER_RAW: f64 = 0.002;

/// A channel that changes by less than this part of the other one has not answered.
const SILENT: f64 = 0.03;

/// The longest wait for the end of a pulse: an emulated rig is slower than the clock.
const END_WAIT: Duration = Duration::from_secs(20);

/// How long a stepper's spool may take to reach its null.
const WALK_TO_NULL: Duration = Duration::from_secs(2);

/// Time between two looks at a moving slide.
const LOOK: Duration = Duration::from_millis(5);

/// An unexpected end of a pulse.
pub(super) enum UnexpectedEnd {
    /// With this fault.
    Tripped(u8),
    /// Stopped by this program: the slide went too far.
    TooFar,
}

/// The result of a pulse, unless it ends unexpectedly.
pub(super) type Pulsed<T> = Result<Result<T, UnexpectedEnd>>;

/// The smallest changes that count as an answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thresholds {
    pub counts: f64,
    pub pressure: f64,
    pub spool: f64,
}

impl Thresholds {
    /// Whether slide or pressures have answered.
    pub fn heard(&self, pair: &Pair) -> bool {
        pair.counts().abs() >= self.counts
            || pair.pressures().iter().any(|change| change.abs() >= self.pressure)
    }

    /// Whether the slide went the same way for both commands, and equally far.
    fn creeps(&self, pair: &Pair) -> bool {
        let [out, back] = [pair.out.moved, pair.back.moved];
        let both = [out, back].iter().all(|travel| f64::from(*travel).abs() >= self.counts);
        both && out.signum() == back.signum() && pair.counts().abs() < self.counts
    }
}

impl BringUp<'_> {
    pub(super) fn is_stepper(&self) -> bool {
        self.parameter(id::STEPPER) == Some(1)
    }

    /// The largest command, counts of a converter or steps.
    pub(super) fn largest(&self) -> i32 {
        let largest = if self.is_stepper() { id::MAX_STEPS } else { id::MAX_COMMAND_COUNTS };
        // Firmware without the parameter has the widest range.
        self.parameter(largest).unwrap_or(i32::from(MAX_COUNTS))
    }

    /// A command of this percentage of the valve, from its null.
    pub(super) fn command(&self, percent: i32) -> i32 {
        let (largest, null) = (self.largest(), self.parameter(id::NULL_OFFSET_COUNTS).unwrap_or(0));
        let size = (largest * percent.abs() / 100).max(1) * percent.signum();
        (null + size).clamp(-largest, largest)
    }

    pub(super) fn thresholds(&self) -> Thresholds {
        let full_scale = f64::from(1u32 << self.parameter(id::SENSOR_BITS).unwrap_or(12).clamp(1, 15));
        let spool = if self.is_stepper() { 0.5 } else { ANSWER_RAW * full_scale };
        Thresholds {
            counts: f64::from(self.counts(ANSWER_MM).max(4)),
            pressure: ANSWER_RAW * full_scale,
            spool,
        }
    }

    pub(super) fn samples(&self, seconds: f64) -> u32 {
        let period_us = f64::from(self.parameter(id::PERIOD_US).unwrap_or(1300).max(1));
        (seconds * 1e6 / period_us).ceil().max(1.0) as u32
    }

    /// The commands up to the largest allowed one, percent.
    pub(super) fn levels(&self) -> impl Iterator<Item = i32> + use<> {
        let most = self.options.most_percent;
        LEVELS.into_iter().filter(move |level| *level <= most).map(i32::from)
    }

    fn is_on_off(&self) -> bool {
        self.parameter(id::LAW) == Some(ON_OFF)
    }

    /// How long a pulse lasts, s. A valve that is either shut or open is open for a part of the pulse.
    fn pulse_s(&self, percent: i32) -> f64 {
        if self.is_on_off() { PULSE_S * f64::from(percent.abs()) / 100.0 } else { PULSE_S }
    }

    /// A pulse of this percentage, in words.
    pub(super) fn pulse_in_words(&self, percent: i32) -> String {
        match self.is_on_off() {
            true => format!("{:.3} s with the valve open", self.pulse_s(percent)),
            false => format!("{PULSE_S} s with {percent} % of the valve"),
        }
    }

    /// The command of a pulse as the law gives it; an on-off valve gets its full command.
    fn pulse_command(&self, percent: i32) -> i32 {
        self.command(if self.is_on_off() { 100 * percent.signum() } else { percent })
    }

    /// Gives a command for a pulse. The drive is disarmed afterwards.
    fn pulse(&mut self, percent: i32) -> Pulsed<Response> {
        let null = self.parameter(id::NULL_OFFSET_COUNTS).unwrap_or(0);
        let from = self.samples(BEFORE_S);
        let until = from + self.samples(self.pulse_s(percent));
        let moves = [(0, null), (from, self.pulse_command(percent)), (until, null)];
        if let Err(surprise) = self.run(&moves, until + self.samples(AFTER_S))? {
            return Ok(Err(surprise));
        }
        let record = self.client.record(|_, _| {})?;
        // The air takes a little of the pulse to answer.
        let later = i64::from((until - from) / 4);
        let window = Window { from: i64::from(from) + later, until: i64::from(until) };
        Ok(Ok(Response::of(&record, window)))
    }

    /// A pulse out and one back.
    pub(super) fn pulses(&mut self, percent: i32) -> Pulsed<Pair> {
        let out = match self.pulse(percent)? {
            Ok(out) => out,
            Err(surprise) => return Ok(Err(surprise)),
        };
        Ok(self.pulse(-percent)?.map(|back| Pair { out, back }))
    }

    /// Runs commands from their samples on. The drive is disarmed afterwards, whatever happens.
    pub(super) fn run(&mut self, commands: &[(u32, i32)], last_sample: u32) -> Pulsed<()> {
        self.operator.goes_on()?;
        let mut sequence = Sequence::new(last_sample);
        for &(at_sample, command) in commands {
            if sequence.push(Move::step(at_sample, command)).is_err() {
                bail!("too many commands in one test");
            }
        }
        let decimation = last_sample.div_ceil(1000).clamp(1, u32::from(u16::MAX)) as u16;
        self.client.prepare_moves("bring-up", &sequence, decimation)?;
        // It is read before the start, which discards the sample.
        let from = self.client.status()?.position;
        self.client.arm()?;
        let followed =
            self.wait_for_null().and_then(|()| self.client.start()).and_then(|()| self.follow(from));
        self.client.disarm()?;
        followed
    }

    /// The spool of a stepper walks to mid-travel after arming.
    fn wait_for_null(&mut self) -> Result<()> {
        let begun = Instant::now();
        while self.is_stepper() && self.look()?.spool != 0 && begun.elapsed() < WALK_TO_NULL {
            std::thread::sleep(LOOK);
        }
        Ok(())
    }

    /// Follows a test to its end. A slide that goes too far from here is stopped.
    fn follow(&mut self, from: i32) -> Pulsed<()> {
        let reach = self.counts(self.options.reach_mm).unsigned_abs();
        let begun = Instant::now();
        while begun.elapsed() < END_WAIT {
            let status = self.look()?;
            match status.mode {
                Mode::Done => return Ok(Ok(())),
                Mode::Fault => return Ok(Err(UnexpectedEnd::Tripped(status.fault))),
                Mode::Running if status.index > 0 && status.position.abs_diff(from) > reach => {
                    self.client.stop()?;
                    return Ok(Err(UnexpectedEnd::TooFar));
                }
                Mode::Running => std::thread::sleep(LOOK),
                Mode::Disarmed | Mode::Armed | Mode::Homing => {
                    bail!("the pulse ended early; the rig was reset, or another program disarmed it")
                }
            }
        }
        bail!("the pulse did not end within {} s", END_WAIT.as_secs())
    }

    /// Pulses out and back, larger and larger, until the slide has moved, and the meaning of their signs.
    pub(super) fn check_pulses(&mut self, pushed: Option<i32>) -> Result<()> {
        let thresholds = self.thresholds();
        let plenty = f64::from(self.counts(PLENTY_MM));
        let (mut pair, mut reached) = (Pair::default(), 0);
        for level in self.levels() {
            self.operator.tell(&format!("pulse out and back: {}", self.pulse_in_words(level)));
            reached = level;
            pair = match self.pulses(level)? {
                Ok(pair) => pair,
                Err(surprise) => {
                    let did = format!("a pulse of {}", self.pulse_in_words(level));
                    self.note(surprised(NAME, &did, &surprise));
                    return Ok(());
                }
            };
            let moved = pair.counts().abs();
            let heard = !self.measures_pressures()
                || pair.pressures().iter().all(|change| change.abs() >= thresholds.pressure);
            if moved >= thresholds.counts && (heard || moved >= plenty) {
                break;
            }
        }
        let did = format!("pulses out and back, the largest of {}", self.pulse_in_words(reached));
        let judged = self.judge(&pair, pushed, &thresholds);
        let pressures = if self.measures_pressures() { " pressure 1 rises against pressure 2," } else { "" };
        let must = format!("positive command: counts go up,{pressures} spool goes to plus");
        self.note(Check::of(NAME, &did, self.words(&pair, &thresholds), &must, judged));
        Ok(())
    }

    /// A pair of answers in words.
    fn words(&self, pair: &Pair, thresholds: &Thresholds) -> String {
        let moved = pair.counts().round() as i32;
        let pressures = self.in_words(pair.pressures());
        let spool = match pair.spool() {
            _ if self.is_stepper() => "spool counted, not measured".to_owned(),
            change if change.abs() < thresholds.spool => "spool: no transducer seen".to_owned(),
            change => format!("spool {change:+.0} raw"),
        };
        format!("{moved:+} counts ({}){pressures}, {spool}", self.units.length(moved))
    }

    /// Changes of the pressures, after a comma.
    pub(super) fn in_words(&self, [one, two]: [f64; 2]) -> String {
        match self.measures_pressures() {
            true => format!(", pressures {one:+.0} and {two:+.0} raw"),
            false => ", pressures not measured".to_owned(),
        }
    }

    /// The problem with a pair of answers.
    fn judge(&self, pair: &Pair, pushed: Option<i32>, thresholds: &Thresholds) -> Vec<String> {
        let counts = sign_of(pair.counts(), thresholds.counts);
        let measured = self.measures_pressures();
        let [one, two] = pair.pressures();
        let pressures = sign_of(one - two, thresholds.pressure).filter(|_| measured);
        let spool = sign_of(pair.spool(), thresholds.spool).filter(|_| !self.is_stepper());
        if (pressures.is_some() || spool.is_some()) && thresholds.creeps(pair) {
            return vec![
                "the slide goes the same way whichever the command: a load that hangs, a valve far from its null (null_code, amplifier's zero), or a stuck spool"
                    .to_owned(),
            ];
        }
        let answered =
            Answered { counts: counts.is_some(), spool: spool.is_some(), by_hand: pushed.is_some() };
        let silence = if measured {
            answered.silence(pressures.is_some())
        } else {
            answered.silence_without_pressures()
        };
        if let Some(silence) = silence {
            return vec![silence.to_owned()];
        }
        let mut advice = Vec::new();
        for (name, change, other) in [("pressure 1", one, two), ("pressure 2", two, one)] {
            if measured && change.abs() < (SILENT * other.abs()).min(thresholds.pressure) {
                advice.push(format!(
                    "{name} does not change: its transmitter is not at its chamber, or its wire is stuck"
                ));
            }
        }
        if advice.is_empty() {
            advice = swaps(&Signs { pushed, counts, pressures, spool });
        }
        advice
    }
}

/// The sign of a change that counts as an answer.
fn sign_of(change: f64, threshold: f64) -> Option<i32> {
    (change.abs() >= threshold).then(|| change.signum() as i32)
}

/// The swaps that explain the signs, in words.
fn swaps(signs: &Signs) -> Vec<String> {
    let found = signs.explanations();
    match &found[..] {
        [only] => only.iter().map(|swap| swap.advice().to_owned()).collect(),
        several => {
            let sets = several.iter().map(|set| {
                let each: Vec<&str> = set.iter().map(|swap| swap.advice()).collect();
                each.join(", and ")
            });
            vec![format!("one of these: {}", sets.collect::<Vec<_>>().join("; OR "))]
        }
    }
}

/// The error for an unexpected end.
pub(super) fn surprised(name: &'static str, did: &str, surprise: &UnexpectedEnd) -> Check {
    let (saw, advice) = match surprise {
        UnexpectedEnd::TooFar => (
            format!("the slide went too far and was stopped (fault {})", words::fault_code_name(Fault::Stop.code())),
            "a larger command than the drive needs: lower --most, throttle the air, or check the stage of the converter"
                .to_owned(),
        ),
        UnexpectedEnd::Tripped(code) => (
            format!("the drive tripped: {} ({})", words::fault_code_name(*code), words::fault_meaning(*code)),
            "find the reason of the fault; `pneudrive device arm` clears it".to_owned(),
        ),
    };
    Check::of(name, did, saw, "it ends by itself, without a fault", vec![advice])
}
