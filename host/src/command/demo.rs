//! `pneudrive demo`: the whole job without hardware.

use std::path::{Path, PathBuf};

use anyhow::Result;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Motion, Move, moves, moves_of_run, to_json, tolerance_mm, verdict};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_link::client::Client;
use pneudrive_optimise::ensemble::run_ensemble;
use pneudrive_records::judged::{Judged, Spacing};
use pneudrive_records::own_file::make_writable;
use pneudrive_records::run_folder::{self, Numbered, StoredRun};
use pneudrive_records::target::TargetFile;
use pneudrive_records::words;
use pneudrive_report::Page;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_session::test_run::TestRun;
use pneudrive_sim::{Accuracy, Rig};
use serde_json::json;

use super::figures;
use super::overlay::overlay;
use super::record::record;
use super::rig_source::load_rig;
use super::run::run_test;
use super::simulate;
use crate::cli::Demo;
use crate::json;

/// Runs the test of `model` on the rig at `port` and records it.
fn on_the_rig(port: &str, model: &Rig, out: &Path) -> Result<(PathBuf, TargetFile)> {
    let mut client = Client::connect(port)?;
    let info = client.info()?;
    say!("   {} on {port}: {}", info.board, info.firmware);

    say!("2. the step test on it, over the real protocol");
    run_test(&mut client, TestRun::of(model), None)?;

    say!("3. its transient, recorded");
    let (path, target) = record(&mut client, out)?;
    client.disarm()?;
    say!("   {}: {} samples", path.display(), target.samples.len());
    Ok((path, target))
}

pub(super) fn execute(arguments: &Demo) -> Result<()> {
    make_writable(&arguments.out)?;
    let model = load_rig(&arguments.rig, &[])?;
    let existing = simulate::existing(arguments.overwrite);
    run_folder::refuse_other_rig(&arguments.out, &model, existing)?;
    let real = model.spread(arguments.spread, arguments.seed)?;
    let percent = 100.0 * arguments.spread;

    say!("1. a virtual rig: {} with true parameters within {percent} % of the file's", model.name());
    let pace = Pace { fast: true, live: false };
    let virtual_rig = VirtualRig::new(real, arguments.seed, pace)?;
    let rig = Background::start(virtual_rig, Listener::open("tcp:127.0.0.1:0")?);
    let recorded = on_the_rig(rig.port(), &model, &arguments.out);
    // An error of the rig is reported first: it explains the broken link that follows from it.
    rig.stop()?;
    let (target_path, target) = recorded?;

    say!("4. the same test, simulated from the rig file");
    let spacing = Spacing::default();
    let ensemble =
        run_ensemble(&model, Accuracy::of(&model), spacing, moves_of_run, |_, _| {}, CancelToken::NEVER)?;
    let judged = ensemble.nominal;
    for note in words::run(&model, &judged) {
        say!("   {note}");
    }

    say!("5. both on the same graphs");
    let page = page(arguments, &model, &judged, &ensemble.measured, (&target_path, &target))?;
    let moves = to_json(&ensemble.measured);
    json::figures(|| figures::run(&model, &judged, &moves));
    json::figures(|| json!({ "record": target_path, "recorded": target.samples.len() }));
    let pieces = |mark: &str, run: &Numbered| {
        page.of_run(run).text_in(&arguments.out, mark, arguments.pages.library())
    };
    run_folder::write(&arguments.out, &model, &judged, moves, Some(&pieces), existing)?;
    say!("open {} in a browser", arguments.out.join("report.html").display());
    Ok(())
}

/// The record and the simulation on the same graphs, below what the drive did in each.
fn page(
    arguments: &Demo,
    model: &Rig,
    judged: &Judged,
    measured: &[Vec<Move>],
    (target_path, target): (&Path, &TargetFile),
) -> Result<Page> {
    let percent = 100.0 * arguments.spread;
    let name = target_path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let simulated = Transient::of_run("simulated", &StoredRun::of_judged(model, judged));
    let recorded = Transient::of_target(&name, target)?;
    let tolerance = tolerance_mm(Some(model));
    let on_the_rig = moves(&recorded, &Motion::of(&recorded), None, tolerance);
    let results = [
        format!("The virtual rig {}.", verdict(&[on_the_rig], tolerance)),
        format!("The simulation {}.", simulate::sentence(judged, &verdict(measured, tolerance))),
    ];
    results.iter().for_each(|result| say!("   {result}"));
    say!("");
    let transients = [recorded, simulated];
    let tables = overlay(&transients)?;
    let [of_rig, of_simulation] = results;
    let notes = vec![
        of_rig,
        of_simulation,
        format!(
            "{name} was recorded on a virtual rig whose true parameters lie within {percent} % of the rig file's (seed {}), with noise on its sensors; the simulation knows only the rig file.",
            arguments.seed
        ),
        "A deviation is the simulation less the record. The band is that of the perturbed runs, not of the rig's parameters: a rig that differs from its file lies mostly outside.".to_owned(),
    ];
    let title = format!("{}: {name} and the simulation", model.name());
    Ok(report::page(&title, notes, &transients, tables))
}
