//! `pneudrive simulate`.

use std::time::Instant;

use anyhow::Result;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{moves_of_run, remarks, table, to_json, tolerance_mm, verdict};
use pneudrive_evaluate::recorded_test::{RigOfRecord, taken_from};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_optimise::ensemble::{Ensemble, run_ensemble};
use pneudrive_optimise::positioning::beside_bound;
use pneudrive_records::judged::Judged;
use pneudrive_records::move_points::Through;
use pneudrive_records::own_file::make_writable;
use pneudrive_records::run_folder::{self, Existing, Numbered, PageOf, StoredRun};
use pneudrive_records::words;
use pneudrive_report::{Page, Table};
use pneudrive_sim::{Recording, Rig, keys, run_recorded};
use serde_json::json;

use super::figures as told;
use super::progress::Progress;
use super::rig_source::{load_rig, load_rig_with, through_points};
use crate::cli::{RigChoice, Simulate};
use crate::exit::Exit;
use crate::json;

pub(super) fn execute(arguments: &Simulate) -> Result<()> {
    make_writable(&arguments.out)?;
    let RigOfRecord { rig, notes: origin } = rig_of(arguments)?;
    run_folder::refuse_other_rig(&arguments.out, &rig, existing(arguments.overwrite))?;
    let accuracy = arguments.integration.accuracy(&rig);
    let mut progress = Progress::new("simulating");
    let begin = Instant::now();
    let spacing = arguments.members.spacing();
    let ensemble = run_ensemble(
        &rig,
        accuracy,
        spacing,
        moves_of_run,
        |done, all| progress.at(done, all),
        CancelToken::NEVER,
    );
    let took = begin.elapsed();
    progress.done();
    let Ensemble { nominal: mut judged, measured: moves } = ensemble?;
    if let Some(columns) = &arguments.columns {
        // The same run again, now with the state of the valve at every row.
        judged.run = run_recorded(&rig, judged.accuracy, Recording { valve: true }, |_, _| {})?;
        judged.columns.extend(&columns.0);
    }
    let mut notes = words::run(&rig, &judged);
    notes.extend(origin);
    let table = table(&moves, tolerance_mm(Some(&rig)));
    let steps = moves.first().map(|own| beside_bound(&rig, own)).unwrap_or_default();
    let remarks = [steps, remarks(&moves)].concat();
    notes.extend(remarks.iter().cloned());
    let page = (!arguments.no_report).then(|| page(&rig, &judged, notes.clone(), table.clone()));
    let pieces = page.as_ref().map(|page| {
        |mark: &str, run: &Numbered| page.of_run(run).text_in(&arguments.out, mark, arguments.pages.library())
    });
    let number = run_folder::write(
        &arguments.out,
        &rig,
        &judged,
        to_json(&moves),
        pieces.as_ref().map(|pieces| pieces as PageOf<'_>),
        existing(arguments.overwrite),
    )?;
    json::figures(|| told::run(&rig, &judged, &to_json(&moves)));
    json::figures(|| json!({ "run": number, "took_ms": 1e3 * took.as_secs_f64(), "notes": notes }));
    say!("{}: {}", rig.name(), sentence(&judged, &verdict(&moves, tolerance_mm(Some(&rig)))));
    say!("{}, in {:.1} ms", notes[0], 1e3 * took.as_secs_f64());
    notes[1..notes.len() - remarks.len()].iter().for_each(|note| say!("{note}"));
    say!("{}\n{}", table.heading, table.to_text());
    remarks.iter().for_each(|remark| say!("{remark}"));
    let band = judged.band.as_ref().map_or("", |_| " band.csv,");
    let report = page.map_or("", |_| ", report.html");
    say!("{}: trace.csv,{band} run.json{report}; run {number}", arguments.out.display());
    if arguments.strict { strictly(&judged) } else { Ok(()) }
}

/// The rig with the test to run, and notes on the origin of the test.
fn rig_of(arguments: &Simulate) -> Result<RigOfRecord> {
    let RigChoice { rig, settings } = &arguments.rig;
    let mut rig = load_rig_with(rig, settings, arguments.points.is_some())?;
    if let Some(test) = &arguments.test {
        rig = rig.with_test_of(&load_rig(test, &[])?)?;
    }
    // A recorded test has no tolerance of its own.
    let own_mm = rig.is_set(&keys::test::TOLERANCE_MM).then(|| rig.get(&keys::test::TOLERANCE_MM));
    let RigOfRecord { rig, notes } = match (&arguments.from, &arguments.points) {
        (Some(from), _) => taken_from(from, &rig)?,
        (None, Some(table)) => {
            let Through { rig, notes } = through_points(&rig, table, &arguments.rig.settings)?;
            RigOfRecord { rig, notes }
        }
        (None, None) => RigOfRecord { rig, notes: Vec::new() },
    };
    let tolerance = arguments.tolerance_mm.or(own_mm).map(|mm| keys::test::TOLERANCE_MM.setting(mm));
    Ok(RigOfRecord { rig: rig.with_settings(tolerance.as_slice())?, notes })
}

/// The treatment of another rig's run, by `--overwrite`.
pub(super) fn existing(overwrite: bool) -> Existing {
    if overwrite { Existing::Overwrite } else { Existing::Keep }
}

/// The error of a run that `--strict` does not accept as a result.
fn strictly(judged: &Judged) -> Result<()> {
    if let Some((fault, k)) = judged.run.fault {
        return Err(
            Exit::Tripped.error(format!("the drive tripped at sample {k}: {}", words::fault_name(fault)))
        );
    }
    match judged.convergence.is_converged() {
        true => Ok(()),
        false => Err(Exit::Unconverged.error(words::convergence(&judged.convergence))),
    }
}

/// What the drive does, with what takes its worth from it first.
pub(super) fn sentence(judged: &Judged, verdict: &str) -> String {
    let trips = judged.run.fault.map(|(fault, _)| format!("trips with {}; ", words::fault_name(fault)));
    let doubt = (!judged.convergence.is_converged()).then_some("not converged, so this may be otherwise: ");
    [trips.as_deref(), doubt, Some(verdict)].into_iter().flatten().collect()
}

fn page(rig: &Rig, judged: &Judged, notes: Vec<String>, table: Table) -> Page {
    let transient = Transient::of_run("simulated", &StoredRun::of_judged(rig, judged));
    report::page(&format!("{}, simulated", rig.name()), notes, &[transient], vec![table])
}
