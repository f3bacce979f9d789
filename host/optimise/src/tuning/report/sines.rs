//! How sines are followed, as notes, tables and graphs.

use super::figures::{AFTER, BEFORE, EVERY, MISSED, REQUIRED, rounded};
use crate::tuning::Behaviour;
use crate::tuning::tracking::limit::{self, Following, Limit};
use crate::tuning::tracking::sine::Sine;
use crate::tuning::tracking::{Gains, Tracked, feeds_forward};
use crate::tuning::trial::Trial;
use pneudrive_evaluate::range::{Range, with_range};
use pneudrive_evaluate::transient::{COMMAND, POSITION, SETPOINT, Transient};
use pneudrive_report::{Curve, Figure, Look, Panel, Table};

impl Gains {
    /// The gains in words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Gains::OfFile => "of the file",
            Gains::Found => "found",
            Gains::FeedForward => "as much feed-forward as feedback",
        }
    }
}

impl Limit {
    /// The limit in words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Limit::Resolution => "resolution and dead band",
            Limit::Friction => "friction",
            Limit::ValveFlow => "valve flow",
            Limit::Law => "the law",
        }
    }

    /// Its figure for a run.
    fn seen(self, following: &Following) -> String {
        let percent = |share: f64| format!("{:.0} % of the squared error", 100.0 * share);
        match self {
            Limit::Resolution => format!("{} within dead band and count", percent(following.in_dead_band)),
            Limit::Friction => format!("{} while the piston stands", percent(following.standing)),
            Limit::ValveFlow => format!("{} with the valve fully open", percent(following.fully_open)),
            Limit::Law => format!("{} in step with the sine", percent(following.with_sine)),
        }
    }
}

/// The description of the sines, and the law's reaction to their motion.
#[must_use]
pub fn notes(trial: &Trial, behaviour: &Behaviour) -> Vec<String> {
    let Some(Tracked { sine, .. }) = behaviour.sines.first() else { return Vec::new() };
    let sines = format!(
        "The sines swing about {:.1} mm by {:.1} mm to either side: a fifth of the stroke, 60 mm at most, or as far as steps may go. They make three swings; the first one begins at full speed and is left out. Where more than half of the squared error arises, there is what limits the drive: within the dead band or a count, with the valve fully open, while the piston stands, or, if it moves and the valve could do more, by the law, where more than half of the squared error swings with the sine as well. It cannot be seen if none of these holds, or not in the run of the rig of the file and those of all its perturbed runs.",
        sine.middle_mm(),
        sine.amplitude_mm()
    );
    vec![sines, feed_forward(trial, behaviour)]
}

fn feed_forward(trial: &Trial, behaviour: &Behaviour) -> String {
    let with = behaviour.sines.iter().find(|one| one.gains == Gains::FeedForward);
    match with {
        None if trial.rig.knows_its_drive() => {
            "The law follows a profile by the profile's own speed and acceleration.".to_owned()
        }
        None if feeds_forward(&trial.rig) => {
            "The law has the feed-forward of the file; tune looks for none.".to_owned()
        }
        None => "The law has no feed-forward.".to_owned(),
        Some(one) => {
            let keys = one.settings.iter().filter(|setting| setting.contains("feed_forward"));
            let keys: Vec<&str> = keys.map(String::as_str).collect();
            format!(
                "Neither the gains of the file nor those found have feed-forward: the law opens the valve by an error alone, so the drive is behind a setpoint that moves. The last row of each sine shows the same gains with as much feed-forward as feedback, {}; it is not in tuned.toml, and tune does not look for a better one.",
                keys.join(", ")
            )
        }
    }
}

/// The errors along the sines, and their limits.
#[must_use]
pub fn errors(sines: &[Tracked]) -> Table {
    let draws = sines.first().map_or(0, |one| one.draws.len());
    let columns = [
        "sine".to_owned(),
        "gains".to_owned(),
        "rms error, mm".to_owned(),
        format!("in {draws} fresh draws"),
        "largest error, mm".to_owned(),
        format!("in {draws} fresh draws"),
        "behind, ms".to_owned(),
        "what limits it".to_owned(),
    ];
    let row = |one: &Tracked| {
        let ranged = |of: &dyn Fn(&Following) -> f64, decimals| with_range(&each(&one.runs, of), decimals);
        let spread = |of: &dyn Fn(&Following) -> f64| ends(&each(&one.draws, of));
        vec![
            name(&one.sine),
            one.gains.word().to_owned(),
            ranged(&|run| run.rms_mm, 2),
            spread(&|run| run.rms_mm),
            ranged(&|run| run.largest_mm, 2),
            spread(&|run| run.largest_mm),
            ranged(&|run| 1e3 * run.behind_s, 0),
            limited(one),
        ]
    };
    Table::new(
        "sines in mid-stroke; in brackets the range over the rig of the file and its perturbed runs",
        columns,
        sines.iter().map(row),
    )
}

/// Where the squared error arises.
#[must_use]
pub fn shares(sines: &[Tracked]) -> Table {
    let columns = [
        "sine",
        "gains",
        "within dead band or a count",
        "the valve is fully open",
        "it is not, and the piston stands",
        "the piston moves, the valve could do more",
        "of the whole: swings with the sine",
    ];
    let row = |one: &Tracked| {
        let percent =
            |of: &dyn Fn(&Following) -> f64| with_range(&each(&one.runs, &|run| 100.0 * of(run)), 0);
        vec![
            name(&one.sine),
            one.gains.word().to_owned(),
            percent(&|run| run.in_dead_band),
            percent(&|run| run.fully_open),
            percent(&|run| run.standing),
            percent(&Following::moving),
            percent(&|run| run.with_sine),
        ]
    };
    Table::new("where the squared error of the sines arises, % of it", columns, sines.iter().map(row))
}

fn name(sine: &Sine) -> String {
    format!("{} Hz, up to {:.0} mm/s", sine.frequency_hz, sine.top_speed_mm_s())
}

fn each(runs: &[Result<Following, String>], of: &dyn Fn(&Following) -> f64) -> Vec<Option<f64>> {
    runs.iter().map(|run| run.as_ref().ok().map(of)).collect()
}

/// The range over all draws.
fn ends(values: &[Option<f64>]) -> String {
    let range = Range::of(values);
    let Some([least, most]) = range.ends else { return "-".to_owned() };
    match range.lacking {
        0 => format!("{least:.2} to {most:.2}"),
        lacking => format!("{least:.2} to {most:.2}, none in {lacking}"),
    }
}

/// Its limit, and in how many draws it is the same.
fn limited(one: &Tracked) -> String {
    let nominal = match one.runs.first() {
        Some(Ok(nominal)) => nominal,
        Some(Err(why)) => return format!("it ends early: {why}"),
        None => return "-".to_owned(),
    };
    let Some(limit) = limit::common(&one.runs) else { return "cannot be seen".to_owned() };
    let same = one.draws.iter().flatten().filter(|draw| draw.limit() == Some(limit)).count();
    format!("{} ({}); in {same} of {} draws", limit.word(), limit.seen(nominal), one.draws.len())
}

/// A graph for each frequency, of the rig of the file.
pub(super) fn figures(trial: &Trial, behaviour: &Behaviour) -> Vec<Figure> {
    let of_one = behaviour.sines.chunk_by(|a, b| a.sine == b.sine);
    of_one.map(|sines| figure(trial, sines)).collect()
}

fn figure(trial: &Trial, sines: &[Tracked]) -> Figure {
    let runs: Vec<(Gains, Transient)> = sines
        .iter()
        .filter_map(|one| Some((one.gains, one.sine.transient(trial, &one.settings).ok()?)))
        .collect();
    let panel = |title: &str, of: &dyn Fn(&Transient, usize) -> f64| {
        let curves = runs.iter().map(|(gains, run)| drawn(gains.word(), colour(*gains), run, of));
        Panel::new(title, curves.collect())
    };
    let mut position = panel("position, mm", &|run, k| run.channels[POSITION][k]);
    if let Some((_, run)) = runs.first() {
        let asked = drawn("setpoint", REQUIRED, run, &|run, k| run.channels[SETPOINT][k]);
        position.curves.insert(0, Curve { look: Look::Dashed, ..asked });
    }
    let error = |run: &Transient, k: usize| run.channels[SETPOINT][k] - run.channels[POSITION][k];
    let heading = sines.first().map_or_else(String::new, |one| {
        format!(
            "a sine of {} Hz and {:.1} mm, on the rig of the file",
            one.sine.frequency_hz,
            one.sine.amplitude_mm()
        )
    });
    Figure {
        heading,
        ..Figure::over_time(vec![
            position,
            panel("error, mm", &error),
            panel("command, counts", &|run, k| run.channels[COMMAND][k]),
        ])
    }
}

fn colour(gains: Gains) -> &'static str {
    match gains {
        Gains::OfFile => BEFORE,
        Gains::Found => AFTER,
        Gains::FeedForward => MISSED,
    }
}

fn drawn(name: &str, colour: &'static str, run: &Transient, of: &dyn Fn(&Transient, usize) -> f64) -> Curve {
    let (x, y) =
        (0..run.time.len()).step_by(EVERY).map(|k| (rounded(run.time[k]), rounded(of(run, k)))).unzip();
    Curve { colour: Some(colour), ..Curve::new(name, x, y) }
}
