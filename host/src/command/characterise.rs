//! `pneudrive characterise`: measures on the bench of [`pneudrive_sim::characteristics`], draws and stores.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::characteristics::{CURVES, Characteristic, Curve as Wanted, Graph};

use super::eval::column;
use super::load_choice;
use crate::cli::{ALL, Characterise};
use crate::page::{Curve, Figure, GENERATOR, Page, Panel, Table};
use crate::run_folder::{make_writable, put, refuse_foreign};

/// Begins every CSV file of this command, so that writing it again replaces nothing else.
const CSV_MARK: &str = "graph,curve,";

pub(super) fn execute(arguments: &Characterise) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    make_writable(&arguments.out)?;
    let all = arguments.curve == ALL;
    let wanted: Vec<&Wanted> = CURVES.iter().filter(|curve| all || curve.name == arguments.curve).collect();
    for curve in &wanted {
        let [csv, html] = places(&arguments.out, curve);
        refuse_foreign(&csv, CSV_MARK)?;
        refuse_foreign(&html, GENERATOR)?;
    }
    for curve in wanted {
        match (curve.measure)(&rig) {
            Ok(found) => leave(&arguments.out, &rig, curve, &found)?,
            Err(unfit) if all => say!("{}: left out, as {unfit}", curve.name),
            Err(unfit) => bail!("{} has no {}: {unfit}", rig.name(), curve.name),
        }
    }
    Ok(())
}

fn places(folder: &Path, curve: &Wanted) -> [PathBuf; 2] {
    ["csv", "html"].map(|kind| folder.join(format!("{}.{kind}", curve.name)))
}

fn leave(folder: &Path, rig: &Rig, curve: &Wanted, found: &Characteristic) -> Result<()> {
    let [csv, html] = places(folder, curve);
    put(&csv, &to_csv(found))?;
    let table = table(found);
    page(rig, curve, found, &table).write(&html)?;
    say!("{}: {}\n{}{}, {}\n", curve.name, curve.about, table.to_text(), csv.display(), html.display());
    Ok(())
}

/// Header, then a line a point.
fn to_csv(found: &Characteristic) -> String {
    let mut text = format!("{CSV_MARK}{},value\n", column(found.across));
    for graph in &found.graphs {
        for series in &graph.series {
            for (x, y) in series.x.iter().zip(&series.y) {
                let value = if y.is_finite() { format!("{y:.9}") } else { String::new() };
                let _ = writeln!(text, "{},{},{x:.9},{value}", column(graph.title), cell(&series.name));
            }
        }
    }
    text
}

/// A text with commas in quotes.
fn cell(text: &str) -> String {
    if text.contains(',') { format!("\"{text}\"") } else { text.to_owned() }
}

fn table(found: &Characteristic) -> Table {
    // A value that rounds to zero has no sign.
    let rounded = |value: f64| (value * 1e4).round() / 1e4 + 0.0;
    let row = |figure: &pneudrive_sim::characteristics::Figure| {
        vec![figure.name.clone(), format!("{:.4}", rounded(figure.value)), figure.unit.to_owned()]
    };
    Table {
        heading: "figures".to_owned(),
        columns: ["", "value", "unit"].map(str::to_owned).to_vec(),
        rows: found.figures.iter().map(row).collect(),
    }
}

fn page(rig: &Rig, curve: &Wanted, found: &Characteristic, table: &Table) -> Page {
    let panel = |graph: &Graph| {
        let curves = graph.series.iter();
        let curves = curves.map(|series| Curve::new(&series.name, series.x.clone(), series.y.clone()));
        Panel::new(graph.title, curves.collect())
    };
    let about = curve.about.split(" (").next().unwrap_or(curve.about);
    Page {
        title: format!("{}: {about}", rig.name()),
        notes: std::iter::once(format!("Component test {}.", place_in_thesis(curve.about)))
            .chain(found.notes.clone())
            .collect(),
        tables: if table.rows.is_empty() { Vec::new() } else { vec![table.clone()] },
        // Each graph has a legend of its own.
        figures: found
            .graphs
            .iter()
            .map(|graph| Figure {
                heading: String::new(),
                across: found.across.to_owned(),
                logarithmic: found.logarithmic,
                panels: vec![panel(graph)],
            })
            .collect(),
    }
}

/// What stands in brackets behind the description of a curve.
fn place_in_thesis(about: &str) -> String {
    let place = about.split_once('(').map_or("", |(_, place)| place.trim_end_matches(')'));
    format!("of the thesis, {place}")
}
