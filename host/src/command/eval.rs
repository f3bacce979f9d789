//! `pneudrive eval`.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Error, Result, anyhow, bail};
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{
    Chambers, Motion, Move, moves, refuse_other_rig, remarks, table, to_json, tolerance_mm,
};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::{CHANNELS, Transient};
use pneudrive_optimise::ensemble::{Ensemble, run_ensemble};
use pneudrive_records::judged::Spacing;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::run_folder::{StoredRun, is_trace, rig_of};
use pneudrive_records::whole_file::put;
use pneudrive_records::words;
use pneudrive_report::{Curve, Figure, Page, Panel};
use pneudrive_sim::{Accuracy, Rig, Run};
use serde_json::json;

use super::progress::Progress;
use super::rig_source::load_rig;
use crate::cli::{Eval, Interval};
use crate::json;

/// Names of the columns after the channels in a CSV file.
const MOTION: [&str; 2] = ["velocity, mm/s", "acceleration, mm/s^2"];

/// The start of every CSV file of this command, by which it recognises the files that it may replace.
const CSV_MARK: &str = "time_s,setpoint_mm";

pub(super) fn execute(arguments: &Eval) -> Result<()> {
    refuse_to_replace(&arguments.out, GENERATOR)?;
    if let Some(path) = &arguments.csv {
        refuse_to_replace(path, CSV_MARK)?;
    }
    let transient = interval(Transient::read(&arguments.file)?, &arguments.interval)?;
    let motion = Motion::of(&transient);
    let rig = rig_beside(arguments, &transient)?;
    let chambers = rig.as_ref().map(Chambers::of);
    let tolerance_mm = arguments.tolerance_mm.unwrap_or_else(|| tolerance_mm(rig.as_ref()));
    let own = moves(&transient, &motion, chambers.as_ref(), tolerance_mm);
    let (runs, rest) = with_ensemble(arguments, own, tolerance_mm)?;
    let table = table(&runs, tolerance_mm);
    let other_name = rig.as_ref().and_then(|rig| other_name(&transient, rig));
    let remarks: Vec<String> =
        remarks(&runs).into_iter().chain(cut_at_end(&transient)).chain(rest).chain(other_name).collect();
    json::figures(|| {
        json!({
            "name": transient.name, "runs": runs.len(), "tolerance_mm": tolerance_mm,
            "moves": to_json(&runs), "remarks": remarks,
        })
    });
    say!("{}\n{}", table.heading, table.to_text());
    remarks.iter().for_each(|remark| say!("{remark}"));
    if let Some(path) = &arguments.csv {
        write_csv(path, &transient, &motion)?;
        say!("{}", path.display());
    }
    let page = Page {
        title: format!("{}, evaluated", transient.name),
        notes: notes(&transient, chambers.as_ref()).into_iter().chain(remarks).collect(),
        tables: vec![table],
        figures: vec![Figure::over_time(panels(&transient, &motion))],
        runs: report::runs(std::slice::from_ref(&transient)),
    };
    page.write(&arguments.out, arguments.pages.library())?;
    say!("{}", arguments.out.display());
    Ok(())
}

/// The remark on the last move if `--to` cuts it off.
fn cut_at_end(transient: &Transient) -> Option<String> {
    let end = transient.time.last().filter(|_| transient.cut.at_end)?;
    Some(format!("The last move continues after {end:.4} s; its figures cover only the part before."))
}

/// The named rig, or else the rig of a run folder, if this program accepts its values.
///
/// # Errors
/// When the named rig is not that of the transient.
fn rig_beside(arguments: &Eval, transient: &Transient) -> Result<Option<Rig>> {
    match &arguments.rig {
        Some(named) => {
            let rig = load_rig(named, &[])?;
            refuse_other_rig(transient, &rig)?;
            Ok(Some(rig))
        }
        None if arguments.file.is_dir() => Ok(rig_of(&arguments.file).ok()),
        None => Ok(None),
    }
}

/// The remark on a transient and a rig with different names.
fn other_name(transient: &Transient, rig: &Rig) -> Option<String> {
    let (test, name) = (&transient.test, rig.name());
    let differ = !test.is_empty() && test != name;
    differ.then(|| {
        format!(
            "The test is called {test}, the rig {name}: the air figures are valid only if {name} has the same cylinder."
        )
    })
}

/// The moves of a transient and, for a run folder, those of the run's perturbed runs; with a remark on the basis of
/// the figures.
fn with_ensemble(
    arguments: &Eval,
    own: Vec<Move>,
    tolerance_mm: f64,
) -> Result<(Vec<Vec<Move>>, Option<String>)> {
    if !arguments.file.is_dir() {
        return match arguments.ensemble {
            None => Ok((vec![own], None)),
            Some(_) => bail!(
                "--ensemble needs the folder of a simulated run; {} is not one",
                arguments.file.display()
            ),
        };
    }
    let stored = StoredRun::read(&arguments.file)?;
    let spacing = stored.spacing.unwrap_or(Spacing { runs: 1, ..Spacing::default() });
    let spacing = Spacing { runs: arguments.ensemble.map_or(spacing.runs, usize::from), ..spacing };
    if spacing.runs == 1 {
        return Ok((vec![own], Some(ALONE.to_owned())));
    }
    // Another version may have accepted values that this one refuses.
    let Ok(rig) = rig_of(&arguments.file) else { return Ok((vec![own], Some(OTHER.to_owned()))) };
    let accuracy = stored.accuracy.unwrap_or(Accuracy::of(&rig));
    let mut progress = Progress::new("simulating its perturbed runs");
    let measure = |rig: &Rig, run: &Run| {
        let part = within(&Transient::of_run("", &StoredRun::of(rig, run)), &arguments.interval);
        moves(&part, &Motion::of(&part), Some(&Chambers::of(rig)), tolerance_mm)
    };
    let ensemble = run_ensemble(
        &rig,
        accuracy,
        spacing,
        measure,
        |done, all| progress.at(done, all),
        CancelToken::NEVER,
    );
    progress.done();
    let Ensemble { nominal, measured } = ensemble?;
    if is_trace(&arguments.file, &nominal.run)? {
        let lost = words::lost(&nominal.lost).map_or_else(String::new, |lost| format!(" {lost}."));
        let rest = format!(
            "Least and most are over {} runs whose mass and starting position differ by up to {:e} (of the mass, of the stroke).{lost}",
            measured.len(),
            spacing.relative
        );
        return Ok((measured, Some(rest)));
    }
    Ok((vec![own], Some(OTHER.to_owned())))
}

/// The remark on a run without perturbed runs.
const ALONE: &str = "These are figures of a single run; how much its perturbed runs differ is not known.";

/// The remark on a run that this version does not reproduce.
const OTHER: &str = "This program does not reproduce the run from its values: another version made it, or it was changed. The figures are of the stored trace alone.";

/// The note on air figures that are left out.
const NOT_FOLLOWED: &str = "Air is left out: fewer than six samples per period of the dither do not show how much air the dither lets in and out. Run or record it with a shorter sample period.";

/// The note on the air figures of a run whose rig is not known.
const NOT_CHECKED: &str = "This program does not accept the values of the run's rig: the air figures are valid only if there are at least six rows per period of the dither.";

/// The most samples on a page; such a page has 100 MB.
const MAX_ON_A_PAGE: usize = 250_000;

fn within(transient: &Transient, interval: &Interval) -> Transient {
    transient.between(interval.from.unwrap_or(f64::NEG_INFINITY), interval.to.unwrap_or(f64::INFINITY))
}

/// The part of a transient within an interval, which must have no gap.
///
/// # Errors
/// When the part is empty, has a gap, or is more than a page holds.
pub(super) fn interval(transient: Transient, interval: &Interval) -> Result<Transient> {
    let part = within(&transient, interval);
    if part.time.len() < 2 {
        match (transient.time.first(), transient.time.last()) {
            (Some(first), Some(last)) => bail!(
                "{} has fewer than two samples in this interval; it goes from {first:.4} s to {last:.4} s",
                transient.name
            ),
            _ => bail!("{} has no samples", transient.name),
        }
    }
    fits_on_a_page(&part)?;
    match part.gaps.first() {
        Some(gap) => Err(missing(&part, gap)),
        None => Ok(part),
    }
}

/// Refuses a transient too long for a page that a browser can open.
pub(super) fn fits_on_a_page(part: &Transient) -> Result<()> {
    if part.time.len() > MAX_ON_A_PAGE {
        bail!(
            "{} has {} samples in this interval, more than the {MAX_ON_A_PAGE} that fit on a page; choose a shorter one with --from and --to",
            part.name,
            part.time.len()
        );
    }
    Ok(())
}

/// The error for a gap.
pub(super) fn missing(transient: &Transient, [before, after]: &[f64; 2]) -> Error {
    anyhow!(
        "{}: samples are missing between {before:.4} s and {after:.4} s; choose an interval without a gap with --from and --to",
        transient.name
    )
}

fn notes(transient: &Transient, chambers: Option<&Chambers>) -> Vec<String> {
    let [v, a] = transient.windows;
    let mut notes = vec![format!(
        "Velocity and acceleration are the controller's own: differences over {v} and {a} samples of {:.4} ms.",
        1e3 * transient.period_s()
    )];
    let is_run = transient.inflow_kg_s.is_some();
    match chambers {
        Some(chambers) if !chambers.follows_dither(transient) => notes.push(NOT_FOLLOWED.to_owned()),
        None if is_run => notes.push(NOT_CHECKED.to_owned()),
        _ => {}
    }
    let has_pressures = transient.has_pressures();
    if is_run || chambers.is_some() && has_pressures {
        notes.push("Air is what enters the chambers, in litres at 20 \u{b0}C, 100 kPa and 65 % relative humidity (ANR, ISO 8778), with its minimum and maximum in brackets. Leakage of the valve to the exhaust is not included.".to_owned());
    }
    if !is_run {
        notes.push(if !has_pressures {
            "The pressures were not measured: no curve shows them, and the air used by the moves cannot be computed.".to_owned()
        } else if chambers.is_some() {
            "A record has no flows: its air is computed from pressures and positions, by the energy balance of chambers that exchange no heat with their walls.".to_owned()
        } else {
            "A record has no flows: to compute the air used by the moves, name the rig with --rig, which gives the cylinder."
                .to_owned()
        });
    }
    notes
}

/// The channels, with velocity and acceleration under the position.
fn panels(transient: &Transient, motion: &Motion) -> Vec<Panel> {
    let curve = |title: &str, values: &[f64]| {
        let name = title.split(',').next().unwrap_or(title);
        Panel::new(title, vec![Curve::new(name, transient.time.clone(), values.to_vec())])
    };
    let mut panels = report::panels(std::slice::from_ref(transient));
    panels.insert(1, curve(MOTION[0], &motion.velocity_mm_s));
    panels.insert(2, curve(MOTION[1], &motion.acceleration_mm_s2));
    panels
}

/// A header, then one line per sample; unknown values are left empty.
fn write_csv(path: &Path, transient: &Transient, motion: &Motion) -> Result<()> {
    let names = CHANNELS.iter().map(|(name, unit)| format!("{name}, {unit}"));
    let names: Vec<String> = names.chain(MOTION.map(str::to_owned)).map(|name| column(&name)).collect();
    let mut text = format!("time_s,{}\n", names.join(","));
    for (k, time) in transient.time.iter().enumerate() {
        let channels = transient.channels.iter().map(|channel| channel[k]);
        write!(text, "{time:.7}")?;
        for value in channels.chain([motion.velocity_mm_s[k], motion.acceleration_mm_s2[k]]) {
            let cell = if value.is_finite() { format!("{value:.6}") } else { String::new() };
            write!(text, ",{cell}")?;
        }
        text.push('\n');
    }
    put(path, &text)
}

/// The name of a column: `pressure_1_kpa` for `pressure 1, kPa`.
pub(super) fn column(title: &str) -> String {
    title.replace(", ", "_").replace([' ', '/'], "_").replace('^', "").replace('%', "percent").to_lowercase()
}
