//! The results of a fit for the terminal, the page, other programs and the next simulation.

mod calibrated;
mod cells;
mod judged;
mod numbers;

use anyhow::Result;
use pneudrive_records::rig_text;
use pneudrive_sim::component::sensors::calibration::Calibration;
use pneudrive_sim::follow::Reading;
use pneudrive_sim::{Accuracy, Rig};
use toml_edit::{DocumentMut, value};

use super::causes::Explanation;
use super::parameter::Parameter;
use super::posterior::NORMAL_95;
use super::recording::{CHANNELS, Channel, Recording, STARTS, reading};
use super::{ConditionalEstimate, Estimate, Identification, Share, UNIDENTIFIABLE};
use calibrated::calibration;
use cells::{digits, table};
use judged::{Intervals, cut, not_testable, rounded, suspicious};
use pneudrive_report::{Curve, Figure, Look, Page, Panel, Table};

pub use numbers::{read_off, to_json, with_error};

/// First line of a fitted rig file: a file with it may be replaced.
pub const FITTED_MARK: &str = "# Fitted by pneudrive identify";

/// Format of the file of numbers.
pub const FORMAT: &str = "pneudrive-identification 1";

/// The most points of a curve, so that the page of a long record stays small.
const POINTS: usize = 4000;

/// All tables of a fit.
#[must_use]
pub fn tables(found: &Identification) -> Vec<Table> {
    let tables = [
        parameters(found),
        dependent(found),
        calibration(found),
        channels(found),
        causes(found),
        unidentifiable(found),
        assumed(found),
    ];
    let filled = tables.into_iter().filter(|table| !table.rows.is_empty());
    filled.chain([correlation(found)]).collect()
}

/// Parameter by parameter.
#[must_use]
pub fn parameters(found: &Identification) -> Table {
    let row = |estimate: &Estimate| {
        vec![
            estimate.parameter.key.path.to_owned(),
            digits(estimate.parameter.start),
            digits(estimate.value),
            format!("{:.2e}", estimate.standard_error),
            range(estimate.interval),
            paths(&estimate.rests_on),
        ]
    };
    let columns =
        ["parameter", "file", "estimate", "standard error", Intervals::of(found).heading(), "rests on"];
    table("parameters", &columns, found.estimates.iter().map(row).collect())
}

/// The estimates of parameters if the values that they rest on were exact.
#[must_use]
pub fn dependent(found: &Identification) -> Table {
    let row = |estimate: &Estimate| {
        let ConditionalEstimate { known, interval, .. } = estimate.conditional.as_ref()?;
        let rig = |path: &str| digits(found.rig.number_at(path).unwrap_or(f64::NAN));
        let exact: Vec<String> = known.iter().map(|(path, _)| format!("{path} = {}", rig(path))).collect();
        let by: Vec<String> = known.iter().map(|(path, by)| format!("{by:+.4} per {}", unit(path))).collect();
        Some(vec![estimate.parameter.key.path.to_owned(), exact.join(", "), range(*interval), by.join(", ")])
    };
    let then = if found.fits { "95 % interval then" } else { "interval then" };
    let columns = ["parameter", "if exact:", then, "changes by"];
    table("parameters that rest on others", &columns, found.estimates.iter().filter_map(row).collect())
}

/// The assumptions on values that intervals rest on, or that cannot be seen.
#[must_use]
pub fn assumed(found: &Identification) -> Table {
    let needed = |parameter: &&Parameter| {
        let path = parameter.key.path;
        let is_left_out = found.unidentifiable.iter().any(|one| one.parameter.key.path == path);
        is_left_out || found.estimates.iter().flat_map(|e| &e.rests_on).any(|share| share.path == path)
    };
    let fitted = found.estimates.iter().map(|e| &e.parameter);
    let all = fitted.chain(found.unidentifiable.iter().map(|u| &u.parameter)).chain(&found.assumed);
    let row = |parameter: &Parameter| {
        vec![parameter.key.path.to_owned(), digits(parameter.start), parameter.assumed_within()]
    };
    let columns = ["value", "file", "assumed within, one standard deviation"];
    table("assumed", &columns, all.filter(needed).map(row).collect())
}

fn range([low, high]: [f64; 2]) -> String {
    format!("{} to {}", digits(low), digits(high))
}

fn paths(shares: &[Share]) -> String {
    let paths: Vec<&str> = shares.iter().map(|share| share.path).collect();
    if paths.is_empty() { "the data".to_owned() } else { paths.join(", ") }
}

/// The unit of a key, or "1".
fn unit(path: &str) -> &'static str {
    pneudrive_sim::rig::find_key(path).map(|key| key.unit()).filter(|unit| !unit.is_empty()).unwrap_or("1")
}

/// Channel by channel, in counts.
#[must_use]
pub fn channels(found: &Identification) -> Table {
    let rows = CHANNELS.iter().zip(&found.channels).filter_map(|((name, _), fit)| {
        let fit = fit.as_ref()?;
        Some(vec![
            (*name).to_owned(),
            fit.samples.to_string(),
            format!("{:.2}", fit.before),
            format!("{:.3}", fit.after),
            format!("{:.3}", fit.noise),
            format!("{:+.3}", fit.correlation),
        ])
    });
    let columns = ["channel", "samples", "before", "after", "noise", "correlation of neighbours"];
    table("root mean square of the residuals, counts", &columns, rows.collect())
}

/// Effects that would explain the residuals.
#[must_use]
pub fn causes(found: &Identification) -> Table {
    let rows = found.causes.fitted.iter().map(|cause| {
        let value = cause.value.map_or_else(
            || cause.setting.clone(),
            |(_, error)| format!("{} +- {:.1e}", cause.setting, NORMAL_95 * error),
        );
        vec![
            cause.effect.name.to_owned(),
            format!("{:.0} %", 100.0 * cause.explained),
            verdict(cause).to_owned(),
            value,
            cause.effect.measure.to_owned(),
        ]
    });
    let columns = ["effect", "explains", "significant", "estimate", "how to measure it"];
    table("what would explain the residuals, one effect at a time", &columns, rows.collect())
}

fn verdict(cause: &Explanation) -> &'static str {
    match (cause.is_significant(), cause.as_good_as_best) {
        (true, true) if cause.leaves_noise => "yes",
        (true, true) => "yes, but leaves more than noise",
        (true, false) => "no: another explains more",
        (false, _) => "no: could be chance",
    }
}

/// The parameters that cannot be seen, and why.
#[must_use]
pub fn unidentifiable(found: &Identification) -> Table {
    let rows = found.unidentifiable.iter().map(|one| {
        let others = match one.confused_with.as_slice() {
            [] if one.over_prior == 1.0 => "no sample depends on it".to_owned(),
            [] => "nothing: the samples hardly depend on it".to_owned(),
            others => paths(others),
        };
        vec![one.parameter.key.path.to_owned(), digits(one.parameter.start), digits(one.value), others]
    });
    let columns = ["cannot be seen in these data", "file", "taken", "confused with"];
    table("unseen", &columns, rows.collect())
}

fn correlation(found: &Identification) -> Table {
    let paths: Vec<&str> = found.estimates.iter().map(|estimate| estimate.parameter.key.path).collect();
    let name = |path: &str| path.split_once('.').map_or(path, |(_, name)| name).to_owned();
    let columns = std::iter::once(String::new()).chain(paths.iter().map(|path| name(path)));
    let row = |(i, path): (usize, &&str)| {
        let cells = (0..paths.len()).map(|j| format!("{:+.2}", found.correlation[(i, j)]));
        std::iter::once(name(path)).chain(cells).collect()
    };
    Table::new("correlation of the estimates' errors", columns, paths.iter().enumerate().map(row))
}

/// Notes to read before the numbers are used.
#[must_use]
pub fn notes(found: &Identification) -> Vec<String> {
    let mut notes = Vec::new();
    if !found.converged {
        notes.push("The search did not converge: the estimates are those at its end, and their intervals mean little. Check the residuals; other starting values or other transients may help.".to_owned());
    }
    notes.extend(not_testable(found));
    if Intervals::of(found) == Intervals::Widened {
        notes.push("The residuals exceed the noise: the model does not explain these data, or another minimum explains them better. The intervals are not 95 % intervals: each is widened by what a model error as large as the residuals can do to the estimate. A model error that the estimates have absorbed is not included.".to_owned());
    }
    if let Some(best) = found.causes.fitted.first().filter(|cause| cause.is_significant()) {
        let rest = if best.leaves_noise {
            ""
        } else {
            " It leaves more than noise: it is not the whole cause, or not the cause."
        };
        notes.push(format!(
            "Of the effects that are not in the rig file, {} would explain most: {:.0} % of the misfit.{rest} Measure it as its table says; with `--set {}` the same records can be fitted again.",
            best.effect.name,
            100.0 * best.explained,
            best.setting.replace(' ', " --set ")
        ));
    }
    notes.extend(cut(found));
    notes.extend(rounded(found));
    notes.extend(suspicious(found));
    if found.estimates.iter().any(|estimate| !estimate.rests_on.is_empty()) {
        notes.push("Some intervals rest less on the data than on assumptions about other values: their table shows what each interval would be if those values were exact. Measure those, write them to the rig file, and leave them out of the fit.".to_owned());
    }
    if !found.unidentifiable.is_empty() {
        notes.push(format!(
            "A parameter that cannot be seen is as uncertain as the file's value, or nearly so: its standard error is above {:.0} % of the assumed one.",
            100.0 * UNIDENTIFIABLE
        ));
    }
    notes
}

/// The page; `read_off` is what the records show without a model of the air.
#[must_use]
pub fn page(
    rig: &Rig,
    recordings: &[Recording],
    accuracy: Accuracy,
    found: &Identification,
    read_off: Table,
) -> Page {
    let overlay = |(recording, start): (&Recording, &[f64; STARTS])| {
        let follow = |rig: &Rig| -> Result<_> {
            let started = rig
                .with_numbers(&recording.start(rig, *start, &Calibration::of_rig(rig)).collect::<Vec<_>>())?;
            recording.follow(&started, accuracy, recording.commands.len(), u64::MAX).0
        };
        Some(figure(recording, &follow(rig).ok()?, &follow(&found.rig).ok()?))
    };
    Page {
        title: format!("{}, identified", rig.name()),
        notes: notes(found),
        tables: tables(found).into_iter().chain([read_off]).collect(),
        figures: recordings.iter().zip(&found.starts).filter_map(overlay).collect(),
        ..Page::default()
    }
}

/// Why a fit is refused, if it is.
#[must_use]
pub fn refusal(found: &Identification) -> Option<String> {
    let rig = found.rig.name();
    match (found.fits, found.spectrum.is_testable()) {
        (true, _) => None,
        (false, true) => Some(format!("the model of {rig} does not explain the transients")),
        (false, false) => Some(format!("the transients have too few samples to judge the model of {rig}")),
    }
}

/// A record with the model before and after the fit, and the residuals.
#[must_use]
pub fn figure(recording: &Recording, before: &[Reading], after: &[Reading]) -> Figure {
    let period = 1e-6 * recording.timing.period_us as f64;
    let every = recording.commands.len().div_ceil(POINTS).max(1);
    let shown: Vec<usize> = (0..recording.commands.len()).step_by(every).collect();
    let time: Vec<f64> = shown.iter().map(|&k| k as f64 * period).collect();
    let mut panels = Vec::new();
    let mut residuals = Vec::new();
    for (c, (name, unit)) in CHANNELS.iter().enumerate() {
        let channel = &recording.channels[c];
        if channel.taken.is_empty() {
            continue;
        }
        let curve = |name: &str, look, of: &dyn Fn(usize) -> f64| Curve {
            look,
            ..Curve::new(name, time.clone(), shown.iter().map(|&k| of(k)).collect())
        };
        let si = |counts: f64| {
            (channel.offset + counts * channel.scale) * if c == 1 || c == 2 { 1e-3 } else { 1e3 }
        };
        let model = |of: &[Reading], k: usize| channel.counts(reading(&of[k], c));
        panels.push(Panel::new(
            &format!("{name}, {unit}"),
            vec![
                curve(&format!("{name} measured"), Look::Steps, &|k| si(channel.measured[k])),
                curve("before the fit", Look::Dashed, &|k| si(model(before, k))),
                curve("after the fit", Look::Line, &|k| si(model(after, k))),
            ],
        ));
        residuals.push(residual_panel(channel, c, name, after, period, every));
    }
    panels.extend(residuals);
    Figure { heading: recording.name.clone(), ..Figure::over_time(panels) }
}

fn residual_panel(
    channel: &Channel,
    c: usize,
    name: &str,
    after: &[Reading],
    period: f64,
    every: usize,
) -> Panel {
    let taken: Vec<usize> = channel.taken.iter().copied().step_by(every).collect();
    let time = taken.iter().map(|&k| k as f64 * period).collect();
    let rest = taken.iter().map(|&k| channel.measured[k] - channel.counts(reading(&after[k], c))).collect();
    let curve = Curve { look: Look::Points, ..Curve::new(&format!("{name} residual"), time, rest) };
    Panel::new(&format!("{name} residual, counts"), vec![curve])
}

/// The rig file with settings and estimates in it, each estimate with its interval as a comment.
///
/// # Errors
/// When the text is not TOML.
pub fn fitted(text: &str, settings: &[String], found: &Identification) -> Result<String> {
    let mut document: DocumentMut = rig_text::with_settings(text, settings, "set for the fit")?.parse()?;
    let mut set = |parameter: &Parameter, number: f64, comment: String| {
        let mut number = value(number);
        if let Some(number) = number.as_value_mut() {
            number.decor_mut().set_suffix(format!("  # {comment}; was {}", digits(parameter.start)));
        }
        rig_text::put(&mut document, parameter.key.path, number);
    };
    for estimate in &found.estimates {
        let rests = if estimate.rests_on.is_empty() {
            String::new()
        } else {
            format!(", resting on {}", paths(&estimate.rests_on))
        };
        let comment =
            format!("identified, {}: {}{rests}", Intervals::of(found).heading(), range(estimate.interval));
        set(&estimate.parameter, estimate.value, comment);
    }
    for one in found.unidentifiable.iter().filter(|one| one.value != one.parameter.start) {
        set(&one.parameter, one.value, "not seen in the data".to_owned());
    }
    for error in found.calibration.iter().filter(|error| error.value != error.parameter.start) {
        let tolerance = error.parameter.assumed_within();
        let seen = if error.is_seen() { "identified" } else { "not seen in the data" };
        let comment = format!("{seen}; tolerance {tolerance}");
        set(&error.parameter, error.value, comment);
    }
    Ok(format!("{FITTED_MARK}\n{document}"))
}
