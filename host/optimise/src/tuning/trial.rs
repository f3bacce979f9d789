//! The step on a rig: from somewhere on the stroke in either direction, and back.

use std::sync::Arc;

use anyhow::{Result, bail};
use pneudrive_records::judged::Spacing;
use pneudrive_records::rig_text;
use pneudrive_records::words::fault_name;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::keys;
use pneudrive_sim::rig::Problems;
use pneudrive_sim::rigfile::RigFile;
use pneudrive_sim::{Accuracy, Rig, Run};

use super::goal::{Goal, Performance};
use super::{Task, Variant};
use crate::ensemble::run_ensemble;
use crate::runners::Runners;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Doubt, LimitCycle, Motion, Move, moves};
use pneudrive_evaluate::transient::Transient;

/// Runs of the file's rig and its perturbed runs.
pub(super) const MEMBERS: usize = 8;

/// Before it moves, the drive holds for this long, s.
pub(super) const DWELL_S: f64 = 0.1;

/// The keys of a rig's own test for moves, rows and records: the step has its own.
const SCHEDULE: [&str; 11] = [
    "move",
    "moves",
    "moves_mm",
    "targets",
    "targets_mm",
    "profile",
    "repeat_every_s",
    "impulse",
    "trace_period_s",
    "decimation",
    "pre_trigger",
];

/// The perturbed runs that a finalist is checked with.
fn spacing() -> Spacing {
    Spacing { runs: MEMBERS, ..Spacing::default() }
}

/// A rig with the step as its test.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The rig of the file, with the step about the middle of its range.
    pub rig: Rig,
    /// Its file without a schedule, and its settings.
    file: RigFile,
    settings: Vec<String>,
    goal: Goal,
    range: StepRange,
    runners: Arc<Runners>,
}

/// Where a step may lie, and how far it goes, counts; and how long it has.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StepRange {
    low: i64,
    high: i64,
    step: i64,
    mm_per_count: f64,
    /// How long the drive has, there as well as back.
    time_s: f64,
}

/// The task of a drive on a rig.
pub(super) struct TaskMoves {
    /// Settings, as `key=value`.
    pub moves: String,
    /// Duration of the test, s.
    pub duration_s: f64,
    /// The first setpoint, counts. It starts half a count beside it, since a start on the edge of a count is ill-defined.
    pub from: i64,
}

impl Trial {
    /// The step of a task; `more` keys are set.
    ///
    /// # Errors
    /// When the step does not fit between the ends, or a key is wrong.
    pub fn of(task: &Task, more: &[String]) -> Result<Trial> {
        let is_schedule = |setting: &String| {
            let key = setting.split('=').next().unwrap_or_default().trim();
            SCHEDULE.iter().any(|name| key.strip_prefix("test.") == Some(name))
        };
        let typed = || task.settings.iter().chain(&task.fixed).chain(more);
        let settings: Vec<String> = typed().filter(|setting| !is_schedule(setting)).cloned().collect();
        // The lines of the file as it is are those that a message must name.
        let (name, text) = &task.source;
        let as_it_is = Rig::read_with(name, text, &typed().cloned().collect::<Vec<_>>());
        let without = |problems| as_it_is.clone().err().unwrap_or(problems);
        let text = rig_text::without(text, "test", &SCHEDULE).unwrap_or_else(|_| text.clone());
        let file = RigFile::read(name, &text);
        let bare = with_moves(&file, &unlimited(&settings), &keys::test::MOVES.setting("[[0.0, 0]]"))
            .map_err(without)?;
        let range = StepRange::of(&bare, task)?;
        let trial = Trial { rig: bare, file, settings, goal: task.goal, range, runners: Arc::default() };
        let rig = trial.rig_of(&[], &Variant::NOMINAL)?;
        Ok(Trial { rig, ..trial })
    }

    /// The step with these gains on a variant of the rig.
    #[must_use]
    pub fn run(&self, gains: &[String], variant: &Variant) -> Performance {
        self.transient(gains, variant).map_or_else(Performance::failed, |(_, moves)| self.performance(&moves))
    }

    /// The same: its transient, and its moves.
    ///
    /// # Errors
    /// Why it did not come to its end.
    pub fn transient(&self, gains: &[String], variant: &Variant) -> Result<(Transient, Vec<Move>), String> {
        let rig = self.rig_of(gains, variant).map_err(|problems| problems.to_string())?;
        self.measure(&rig, |run| self.measured(&rig, run))
    }

    /// The measurements of a run of a rig, as a draw.
    pub(super) fn measure<T>(
        &self,
        rig: &Rig,
        measure: impl FnOnce(&Run) -> Result<T, String>,
    ) -> Result<T, String> {
        let measured = self.runners.run(rig, Accuracy::of_draw(rig), |run| to_its_end(run, measure));
        measured.unwrap_or_else(|error| Err(error.to_string()))
    }

    /// The measurements of the runs of a rig and its perturbed runs, the rig first.
    pub(super) fn measure_members<T: Send>(
        rig: &Rig,
        measure: impl Fn(&Rig, &Run) -> Result<T, String> + Sync,
    ) -> Result<Vec<Result<T, String>>> {
        let measure = |rig: &Rig, run: &Run| to_its_end(run, |run| measure(rig, run));
        let ensemble =
            run_ensemble(rig, Accuracy::of(rig), spacing(), measure, |_, _| {}, CancelToken::NEVER)?;
        let failed = ensemble.nominal.lost.failed.into_iter().map(Err);
        Ok(ensemble.measured.into_iter().chain(failed).collect())
    }

    /// The step on the rig of the file and on its perturbed runs, the rig of the file first.
    ///
    /// # Errors
    /// When it cannot be simulated.
    pub fn members(&self, gains: &[String]) -> Result<Vec<Performance>> {
        self.members_of(gains, &Variant::NOMINAL)
    }

    /// The step on a variant of the rig and on its perturbed runs, the variant first.
    ///
    /// # Errors
    /// When it cannot be simulated.
    pub(crate) fn members_of(&self, gains: &[String], variant: &Variant) -> Result<Vec<Performance>> {
        let rig = self.rig_of(gains, variant)?;
        let runs = Trial::measure_members(&rig, |rig, run| self.measured(rig, run))?;
        let performance = |(_, moves): (Transient, Vec<Move>)| self.performance(&moves);
        Ok(runs.into_iter().map(|run| run.map_or_else(Performance::failed, performance)).collect())
    }

    /// The rig of the file with these gains.
    ///
    /// # Errors
    /// When a gain is out of its range.
    pub fn with(&self, gains: &[String]) -> Result<Rig, Problems> {
        self.rig_of(gains, &Variant::NOMINAL)
    }

    /// The result of a step there and back.
    #[must_use]
    pub fn performance(&self, moves: &[Move]) -> Performance {
        let steps: Vec<Move> = moves.iter().skip(1).map(|one| self.held(one)).collect();
        Performance::of(&steps.iter().collect::<Vec<_>>(), self.goal.step_mm, self.goal.time_s)
    }

    /// A move at whose end the law holds the load: it stands, and whatever leaks, the law keeps the force within what running
    /// friction holds, so that it does not jump. Under other laws a drive whose pressures change may.
    fn held(&self, one: &Move) -> Move {
        match one.limit_cycle {
            LimitCycle::Undecided(Doubt::Sticking { .. }) if self.rig.knows_its_drive() => Move {
                limit_cycle: LimitCycle::None { below_mm: one.range_mm, for_s: self.goal.time_s / 4.0 },
                ..one.clone()
            },
            _ => one.clone(),
        }
    }

    /// From where to where the step of a variant goes, mm.
    #[must_use]
    pub fn ends_mm(&self, variant: &Variant) -> [f64; 2] {
        self.range.setpoints(variant).map(|counts| counts as f64 * self.range.mm_per_count)
    }

    /// Between which setpoints every step lies, counts.
    pub(super) fn range_counts(&self) -> [i64; 2] {
        [self.range.low, self.range.high]
    }

    /// Between which positions every step lies, mm.
    #[must_use]
    pub fn range_mm(&self) -> [f64; 2] {
        [self.range.low, self.range.high].map(|counts| counts as f64 * self.range.mm_per_count)
    }

    fn measured(&self, rig: &Rig, run: &Run) -> Result<(Transient, Vec<Move>), String> {
        let transient = Transient::of_simulation("", rig, run);
        let moves = moves(&transient, &Motion::of(&transient), None, self.goal.settled_mm);
        Ok((transient, moves))
    }

    fn rig_of(&self, gains: &[String], variant: &Variant) -> Result<Rig, Problems> {
        self.rig_on(&self.range.step(variant), gains, variant)
    }

    /// A variant of the rig with these gains, whose test is this course.
    pub(super) fn rig_on(
        &self,
        course: &TaskMoves,
        gains: &[String],
        variant: &Variant,
    ) -> Result<Rig, Problems> {
        let middle = encoder::middle(&self.rig, course.from as f64);
        let own = [
            keys::test::DURATION_S.setting(format_args!("{:?}", course.duration_s)),
            keys::test::POSITION_M.setting(format_args!("{:?}", middle * self.range.mm_per_count / 1e3)),
        ];
        let settings: Vec<String> = self.settings.iter().chain(gains).cloned().chain(own).collect();
        with_moves(&self.file, &settings, &course.moves)?.with_plant(&variant.settings(&self.rig))
    }
}

/// The measurements of a run that comes to its end; otherwise its fault.
fn to_its_end<T>(run: &Run, measure: impl FnOnce(&Run) -> Result<T, String>) -> Result<T, String> {
    match run.fault {
        Some((fault, k)) => Err(format!("{} at sample {k}", fault_name(fault))),
        None => measure(run),
    }
}

/// The rig of a file with settings and moves, which are timed: none waits for an arrival.
fn with_moves(file: &RigFile, settings: &[String], moves: &str) -> Result<Rig, Problems> {
    let timed = [moves.to_owned(), keys::controller::EXIT_ON_DEAD_BAND.setting(false)];
    let settings: Vec<String> = settings.iter().cloned().chain(timed).collect();
    file.with(&settings)
}

/// Settings with which a rig is valid whatever its soft limits are: an open loop has no setpoints.
fn unlimited(settings: &[String]) -> Vec<String> {
    settings.iter().cloned().chain([keys::controller::LOOP.setting(Loop::Open.word())]).collect()
}

impl StepRange {
    /// Between the positions that are typed and the soft limits; from the ends of the stroke a step keeps the
    /// distance that it may overshoot by, or settle within.
    fn of(rig: &Rig, task: &Task) -> Result<StepRange> {
        let (mm, goal) = (mm_per_count(rig), &task.goal);
        let clear_mm = goal.settled_mm.max(goal.step_mm * goal.overshoot_percent / 100.0);
        let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
        let [lowest, highest] = task.between_mm;
        let ends = [lowest, rig.get(&keys::safety::END_MIN_MM)].into_iter().flatten();
        let low_mm = ends.fold(clear_mm, f64::max);
        let ends = [highest, rig.get(&keys::safety::END_MAX_MM)].into_iter().flatten();
        let high_mm = ends.fold(stroke_mm - clear_mm, f64::min);
        let range = StepRange {
            low: (low_mm / mm).ceil() as i64,
            high: (high_mm / mm).floor() as i64,
            step: (goal.step_mm / mm).round() as i64,
            mm_per_count: mm,
            time_s: goal.time_s,
        };
        if range.step > range.high - range.low {
            bail!(
                "a step of {} mm does not fit between {low_mm:.1} and {high_mm:.1} mm of the stroke of {stroke_mm:.0} mm; make it shorter (--step), or the range wider (--lowest, --highest, safety.end_min_mm, safety.end_max_mm)",
                goal.step_mm
            );
        }
        Ok(range)
    }

    /// The setpoints before and after the step of a variant, counts.
    fn setpoints(&self, variant: &Variant) -> [i64; 2] {
        let free = (self.high - self.low - self.step) as f64;
        let low = self.low + (variant.place * free).round() as i64;
        let ends = [low, low + self.step];
        if variant.extends { ends } else { [ends[1], ends[0]] }
    }

    fn step(&self, variant: &Variant) -> TaskMoves {
        let [from, to] = self.setpoints(variant);
        let (there, back) = (DWELL_S, DWELL_S + self.time_s);
        TaskMoves {
            moves: keys::test::MOVES
                .setting(format_args!("[[0.0, {from}], [{there:?}, {to}], [{back:?}, {from}]]")),
            duration_s: DWELL_S + 2.0 * self.time_s,
            from,
        }
    }
}
