//! What a fit has found, for a terminal, a page, a program and the next simulation.

use anyhow::Result;
use pneudrive_sim::follow::Reading;
use serde_json::{Value, json};
use toml_edit::{DocumentMut, value};

use super::recording::{CHANNELS, Channel, Recording, reading};
use super::{Estimate, Identification, UNSEEN};
use crate::page::{Curve, Figure, Look, Panel, Table};
use crate::rig_text;

/// First line of a fitted rig file: such a file may be written anew.
pub const FITTED_MARK: &str = "# Fitted by pneudrive identify";

/// Format of the file of numbers.
pub const FORMAT: &str = "pneudrive-identification 1";

/// Samples between two points of a curve at least: a page of a long record stays small.
const POINTS: usize = 4000;

/// Four significant digits more than the standard error has meaning.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}")
}

/// All tables of a fit.
#[must_use]
pub fn tables(found: &Identification) -> Vec<Table> {
    let mut tables = vec![parameters(found), channels(found)];
    if !found.unseen.is_empty() {
        tables.push(unseen(found));
    }
    tables.push(correlation(found));
    tables
}

fn table(heading: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table { heading: heading.to_owned(), columns: columns.iter().map(ToString::to_string).collect(), rows }
}

/// Parameter by parameter.
#[must_use]
pub fn parameters(found: &Identification) -> Table {
    let row = |estimate: &Estimate| {
        let [low, high] = estimate.interval;
        vec![
            estimate.parameter.key.path.to_owned(),
            digits(estimate.parameter.start),
            digits(estimate.value),
            format!("{:.2e}", estimate.standard_error),
            format!("{} to {}", digits(low), digits(high)),
        ]
    };
    let columns = ["parameter", "file", "estimate", "standard error", "95 % interval"];
    table("parameters", &columns, found.estimates.iter().map(row).collect())
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

/// What is not seen, and why.
#[must_use]
pub fn unseen(found: &Identification) -> Table {
    let rows = found.unseen.iter().map(|unseen| {
        let others: Vec<&str> = unseen.confused_with.iter().map(|confusion| confusion.path).collect();
        let others =
            if others.is_empty() { "nothing: no sample depends on it".to_owned() } else { others.join(", ") };
        vec![unseen.parameter.key.path.to_owned(), digits(unseen.parameter.start), others]
    });
    let columns = ["cannot be seen in these data", "kept", "confused with"];
    table("unseen", &columns, rows.collect())
}

fn correlation(found: &Identification) -> Table {
    let paths: Vec<&str> = found.estimates.iter().map(|estimate| estimate.parameter.key.path).collect();
    let name = |path: &str| path.split_once('.').map_or(path, |(_, name)| name).to_owned();
    let columns = std::iter::once(String::new()).chain(paths.iter().map(|path| name(path))).collect();
    let row = |(i, path): (usize, &&str)| {
        let cells = (0..paths.len()).map(|j| format!("{:+.2}", found.correlation[(i, j)]));
        std::iter::once(name(path)).chain(cells).collect()
    };
    let rows = paths.iter().enumerate().map(row).collect();
    Table { heading: "correlation of the estimates' errors".to_owned(), columns, rows }
}

/// What has to be known before the numbers are used.
#[must_use]
pub fn notes(found: &Identification) -> Vec<String> {
    let mut notes = Vec::new();
    if !found.converged {
        notes.push("The search did not converge: the estimates are where it ended, and their intervals mean little. Look at the residuals; other starting values or other transients may help.".to_owned());
    }
    if !found.fits {
        notes.push("More remains than noise: the model does not explain these data, or another minimum does it better. Intervals do not tell how far the estimates are from the truth.".to_owned());
    }
    notes.push(if found.robust {
        "Residuals are correlated, so the model does not explain all that was measured; standard errors are those of Newey and West.".to_owned()
    } else {
        "Residuals are white; standard errors are those of the normal equations.".to_owned()
    });
    if !found.unseen.is_empty() {
        notes.push(format!(
            "A parameter whose standard error is above {:.0} % of its value, or of what is plausible, keeps the file's value.",
            100.0 * UNSEEN
        ));
    }
    notes
}

/// A record with the model before and after the fit, and what remains.
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

/// The numbers, for a program.
#[must_use]
pub fn to_json(found: &Identification, recordings: &[Recording]) -> Value {
    let estimate = |e: &Estimate| {
        json!({
            "key": e.parameter.key.path, "unit": e.parameter.key.unit(), "file": e.parameter.start,
            "estimate": e.value, "standard_error": e.standard_error, "interval_95": e.interval,
        })
    };
    let unseen = found.unseen.iter().map(|unseen| {
        let others = unseen.confused_with.iter().map(|c| json!({ "key": c.path, "part": c.part }));
        json!({ "key": unseen.parameter.key.path, "kept": unseen.parameter.start, "confused_with": others.collect::<Vec<_>>() })
    });
    let channels = CHANNELS.iter().zip(&found.channels).filter_map(|((name, _), fit)| {
        let fit = fit.as_ref()?;
        Some(json!({
            "channel": name, "samples": fit.samples, "rms_before_counts": fit.before,
            "rms_after_counts": fit.after, "noise_counts": fit.noise,
            "correlation_of_neighbours": fit.correlation,
        }))
    });
    json!({
        "format": FORMAT,
        "rig": found.rig.name(),
        "transients": recordings.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(),
        "converged": found.converged,
        "fits": found.fits,
        "runs": found.runs,
        "standard_errors": if found.robust { "newey-west" } else { "normal-equations" },
        "parameters": found.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "unseen": unseen.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "correlation": found.correlation.row_iter().map(|row| row.iter().copied().collect::<Vec<f64>>()).collect::<Vec<_>>(),
    })
}

/// The rig file with settings and estimates in it, each estimate with its interval as a comment.
///
/// # Errors
/// When the text is no TOML.
pub fn fitted(text: &str, settings: &[String], found: &Identification) -> Result<String> {
    let mut document: DocumentMut = rig_text::with_settings(text, settings, "set by hand")?.parse()?;
    for estimate in &found.estimates {
        let [low, high] = estimate.interval.map(digits);
        let mut number = value(estimate.value);
        if let Some(number) = number.as_value_mut() {
            let file = digits(estimate.parameter.start);
            number.decor_mut().set_suffix(format!("  # identified, 95 %: {low} to {high}; was {file}"));
        }
        rig_text::put(&mut document, estimate.parameter.key.path, number);
    }
    Ok(format!("{FITTED_MARK}\n{document}"))
}
