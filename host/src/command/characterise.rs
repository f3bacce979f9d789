//! `pneudrive characterise`: runs the component tests of [`pneudrive_thesis::characteristics`] and writes their curves.

mod digits;
mod points;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Error, Result, anyhow, bail};
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_report::{Figure, Library, Page, Panel, Table};
use pneudrive_sim::{IntegrationError, Rig};
use pneudrive_thesis::characteristics::{
    CURVES, Characteristic, Curve as Wanted, Figure as Measured, Graph, Reading, Unfit,
};
use serde_json::json;

use digits::significant;
use points::Measurement;

use super::eval::column;
use super::figures;
use super::rig_source::load_choice;
use crate::cli::{ALL, Characterise};
use crate::json;

/// The start of every CSV file of this command, by which it recognises the files that it may replace.
const CSV_MARK: &str = "graph,curve,";

/// Significant digits in a CSV file: as many as the equations of the model are solved to.
const IN_FILES: i32 = 6;

pub(super) fn execute(arguments: &Characterise) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    make_writable(&arguments.out)?;
    let all = arguments.curve == ALL;
    if all && arguments.points.is_some() {
        bail!("--points goes with one curve: name it instead of {ALL}");
    }
    let wanted: Vec<&Wanted> = CURVES.iter().filter(|curve| all || curve.name == arguments.curve).collect();
    for curve in &wanted {
        let [csv, html] = places(&arguments.out, curve);
        refuse_to_replace(&csv, CSV_MARK)?;
        refuse_to_replace(&html, GENERATOR)?;
    }
    measure(arguments, &rig, &wanted)
}

/// Writes each of these curves. One that its test does not bring to its end keeps no other one from being written.
fn measure(arguments: &Characterise, rig: &Rig, wanted: &[&Wanted]) -> Result<()> {
    let all = arguments.curve == ALL;
    let (mut stopped, mut curves) = (Ok(()), Vec::new());
    for curve in wanted {
        match (curve.measure)(rig) {
            Ok(found) => {
                let measured = arguments.points.as_deref().map(|path| Measurement::of(path, &found));
                leave(
                    &arguments.out,
                    rig,
                    curve,
                    &found,
                    measured.transpose()?.as_ref(),
                    arguments.pages.library(),
                )?;
                let files = places(&arguments.out, curve).map(|path| path.display().to_string());
                curves.push(figures::characteristic(curve.name, &found, files));
            }
            Err(Unfit::Integration(error)) => stopped = stopped.and(Err(stops(rig, curve, &error))),
            Err(lacks) if all => say!("{}: skipped, as {lacks}", curve.name),
            Err(lacks) => bail!("{} has no {}: {lacks}", rig.name(), curve.name),
        }
    }
    json::figures(|| json!({ "rig": rig.name(), "curves": curves }));
    stopped
}

/// The error of a test that the bench could not complete. It does not mean that the rig lacks the component.
fn stops(rig: &Rig, curve: &Wanted, error: &IntegrationError) -> Error {
    anyhow!(
        "the test \"{}\" of {} stopped: {error}; try another value of the spool's friction or dither (--set KEY=VALUE)",
        curve.name,
        rig.name()
    )
}

fn places(folder: &Path, curve: &Wanted) -> [PathBuf; 2] {
    ["csv", "html"].map(|kind| folder.join(format!("{}.{kind}", curve.name)))
}

fn leave(
    folder: &Path,
    rig: &Rig,
    curve: &Wanted,
    found: &Characteristic,
    measured: Option<&Measurement>,
    library: Library,
) -> Result<()> {
    let [csv, html] = places(folder, curve);
    put(&csv, &to_csv(found))?;
    let mut table = table(found);
    table.rows.extend(measured.iter().flat_map(|measured| measured.rows()));
    page(rig, curve, found, &table, measured).write(&html, library)?;
    say!("{}: {}\n{}{}, {}\n", curve.name, curve.about, table.to_text(), csv.display(), html.display());
    Ok(())
}

/// A header, then one line per point.
fn to_csv(found: &Characteristic) -> String {
    let mut text = format!("{CSV_MARK}{},value\n", column(found.across));
    for graph in &found.graphs {
        for series in &graph.series {
            for (x, y) in series.x.iter().zip(&series.y) {
                let value = if y.is_finite() { significant(*y, IN_FILES) } else { String::new() };
                let (graph, x) = (column(graph.title), significant(*x, IN_FILES));
                let _ = writeln!(text, "{graph},{},{x},{value}", cell(&series.name));
            }
        }
    }
    text
}

/// A cell of a CSV file; in quotes if it contains a comma.
fn cell(text: &str) -> String {
    if text.contains(',') { format!("\"{text}\"") } else { text.to_owned() }
}

fn table(found: &Characteristic) -> Table {
    let row = |figure: &Measured| {
        let [value, within, unit] = digits(figure, found.across);
        vec![figure.name.clone(), value, within, unit.to_owned()]
    };
    Table::new("figures", ["", "value", "\u{b1}", "unit"], found.figures.iter().map(row))
}

/// A figure, its uncertainty and its unit, the numbers to the digits that are known. For a figure that was not found,
/// the interval on the axis `across` that was searched.
fn digits(figure: &Measured, across: &str) -> [String; 3] {
    let unit = figure.unit.to_owned();
    match figure.reading {
        Reading::Computed(value) => [significant(value, 4), String::new(), unit],
        Reading::Read { value, within } => {
            let decimals = (-within.max(1e-9).log10().floor()).max(0.0) as usize;
            // A value that rounds to zero has no sign.
            let scale = 10_f64.powi(decimals as i32);
            let rounded = (value * scale).round() / scale + 0.0;
            [format!("{rounded:.decimals$}"), format!("{within:.decimals$}"), unit]
        }
        Reading::NotBetween([from, to]) => {
            let (name, unit) = across.split_once(", ").unwrap_or((across, ""));
            let sought =
                format!("not seen, {name} {} to {} {unit}", significant(from, 3), significant(to, 3));
            [sought.trim_end().to_owned(), String::new(), String::new()]
        }
    }
}

fn page(
    rig: &Rig,
    curve: &Wanted,
    found: &Characteristic,
    table: &Table,
    measured: Option<&Measurement>,
) -> Page {
    let panel = |(i, graph): (usize, &Graph)| {
        let curves = graph.series.iter().cloned();
        let points = measured.filter(|_| i == 0).into_iter().flat_map(Measurement::curves);
        Panel::new(graph.title, curves.chain(points).collect())
    };
    let about = curve.about.split(" (").next().unwrap_or(curve.about);
    Page {
        title: format!("{}: {about}", rig.name()),
        notes: std::iter::once(format!("Component test {}.", place_in_thesis(curve.about)))
            .chain(found.notes.clone())
            .collect(),
        tables: if table.rows.is_empty() { Vec::new() } else { vec![table.clone()] },
        // Each graph has its own legend.
        figures: found
            .graphs
            .iter()
            .enumerate()
            .map(|graph| Figure {
                heading: String::new(),
                across: found.across.to_owned(),
                logarithmic: found.logarithmic,
                panels: vec![panel(graph)],
            })
            .collect(),
        ..Page::default()
    }
}

/// The section of the thesis, which the description of a curve ends with in brackets.
fn place_in_thesis(about: &str) -> String {
    let place = about.split_once('(').map_or("", |(_, place)| place.trim_end_matches(')'));
    if place.starts_with("ISO") { format!("by {place}") } else { format!("of the thesis, {place}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        characterise: Characterise,
    }

    /// The spool cannot be followed to the end of this test.
    const STOPS: Wanted = Wanted {
        measure: |_| Err(Unfit::Integration(IntegrationError::EventsPileUp { at_s: 14.7 })),
        ..CURVES[0]
    };

    #[test]
    fn a_test_that_stops_on_the_bench_is_not_a_part_that_the_rig_lacks() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().to_str().expect("a path in UTF-8");
        let line = Line::parse_from(["characterise", "servo-b-thesis", ALL, "--out", out]);
        let rig = Rig::builtin("servo-b-thesis").expect("a built-in rig");
        let land_area = CURVES.iter().find(|curve| curve.name == "land-area").expect("a curve");
        let error = measure(&line.characterise, &rig, &[&STOPS, land_area]).expect_err("one has stopped");
        let expected = format!(
            "the test \"{}\" of servo-b-thesis stopped: events pile up at t = 14.7 s: two modes switch to each other endlessly; try another value of the spool's friction or dither (--set KEY=VALUE)",
            STOPS.name
        );
        assert_eq!(error.to_string(), expected);
        assert!(folder.path().join("land-area.html").exists(), "the other one is written");
    }

    #[test]
    fn a_figure_has_the_digits_that_are_known() {
        let of = |reading| digits(&Measured { name: String::new(), reading, unit: "N" }, "time, s");
        let read = |value, within| of(Reading::Read { value, within });
        assert_eq!(read(181.7658, 0.9), ["181.8", "0.9", "N"]);
        assert_eq!(read(268.1, 1.3), ["268", "1", "N"]);
        assert_eq!(read(-0.000_01, 0.000_5), ["0.0000", "0.0005", "N"], "no sign of its own");
        assert_eq!(of(Reading::Computed(23.245_61)), ["23.25", "", "N"]);
        assert_eq!(of(Reading::Computed(0.0)), ["0.000", "", "N"]);
        assert_eq!(significant(1234.567, 4), "1235");
    }

    #[test]
    fn a_figure_that_is_not_found_tells_where_it_was_looked_for_in_the_unit_of_the_axis() {
        let force = Measured { name: String::new(), reading: Reading::NotBetween([9.912, 11.26]), unit: "N" };
        assert_eq!(digits(&force, "time, s"), ["not seen, time 9.91 to 11.3 s", "", ""]);
    }
}
