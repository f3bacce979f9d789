//! `pneudrive commission`: a drive finds its constants, takes them over and shows what it does with them.
//!
//! ```text
//! parameters of the rig file -> home -> middle of the stroke -> tests -> fit -> parameters of the fit -> trial moves -> report
//! ```
//!
//! Each step that moves the cylinder is announced with how far it goes. What the drive had is put back where a step fails. A test that
//! was recorded before an interruption is not run again.

use std::io::{IsTerminal, stderr, stdin};
use std::path::Path;

use anyhow::{Context, Result};
use pneudrive_controller::Parameters;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Motion, Move, moves, moves_of_run, tolerance_mm, verdict};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_identify::moves::STOPS_FROM_END;
use pneudrive_link::client::Client;
use pneudrive_optimise::ensemble::run_ensemble;
use pneudrive_records::judged::Spacing;
use pneudrive_records::own_file::make_writable;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_session::drive;
use pneudrive_session::slow_move::{self, Standing};
use pneudrive_session::test_run::TestRun;
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::{Accuracy, Rig, keys};
use serde_json::json;

use super::identify;
use super::interrupts::Interrupts;
use super::overlay::overlay;
use super::record::record;
use super::rig_source::{load_choice, load_rig};
use super::run::run_test;
use super::simulate;
use crate::cli::{Commission, Identify};
use crate::exit::Exit;
use crate::json;

/// Names of files in the folder.
const PAGE: &str = "commissioning.html";

/// Moves of the trial: there and back, twice.
const TRIALS: usize = 4;

/// From one of them to the next, s.
const EVERY_S: f64 = 2.0;

pub(super) fn execute(arguments: &Commission) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    ask(arguments, &rig)?;
    make_writable(&arguments.out)?;
    let mut client = arguments.port.connect()?;
    client.disarm()?;
    let before = client.parameters()?.values;
    say!("1. the parameters of {}", rig.name());
    client.import_parameters(&rig.parameters())?;
    let done = steps(arguments, &rig, &mut client);
    let disarmed = client.disarm();
    if done.is_err() {
        give_back(&mut client, &before);
    }
    done.and(disarmed)
}

/// Asks before the cylinder moves.
fn ask(arguments: &Commission, rig: &Rig) -> Result<()> {
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let announced = format!(
        "the cylinder will move: a slow homing run if it has no reference, to the middle of its stroke of {stroke_mm:.0} mm, from there by up to {:.0} mm to either side with the valve fully open, and in {TRIALS} trial moves by {:.0} mm",
        (0.5 - STOPS_FROM_END) * stroke_mm,
        2.0 * trial_mm(arguments, rig),
    );
    if arguments.yes {
        tell!("{announced} (--yes)");
        return Ok(());
    }
    if !(stdin().is_terminal() && stderr().is_terminal()) {
        return Err(Exit::Usage.error(format!(
            "{announced}; nobody can answer here, and --yes lets it move without being asked"
        )));
    }
    match super::device::asked(&format!("{announced}. Is everybody clear of it?")) {
        true => Ok(()),
        false => Err(Exit::Interrupted.error("nothing was moved")),
    }
}

/// Half of the distance of a trial move, mm.
fn trial_mm(arguments: &Commission, rig: &Rig) -> f64 {
    f64::from(arguments.trial) / 100.0 * 1e3 * rig.get(&keys::actuator::STROKE_M)
}

fn steps(arguments: &Commission, rig: &Rig, client: &mut Client) -> Result<()> {
    say!("2. its reference, and the middle of its stroke");
    to_the_middle(client, rig)?;
    say!("3. the tests, and what they show");
    let found = identified(arguments)?;
    say!("4. the parameters of what was found");
    client.disarm()?;
    client.import_parameters(&found.parameters())?;
    say!("5. trial moves");
    to_the_middle(client, &found)?;
    let trial = trial(&found, trial_mm(arguments, rig), client.info()?.record_capacity)?;
    run_test(client, TestRun::of(&trial), None)?;
    let (path, target) = record(client, &arguments.out)?;
    judge(arguments, &trial, &path, &target)
}

/// Gives the drive the parameters back that it had.
fn give_back(client: &mut Client, parameters: &Parameters) {
    match client.import_parameters(parameters) {
        Ok(_) => tell!("the drive has the parameters again that it had before"),
        Err(error) => tell!("note: the drive keeps the parameters of the rig file: {error:#}"),
    }
}

fn to_the_middle(client: &mut Client, rig: &Rig) -> Result<()> {
    if !client.status()?.referenced {
        let interrupts = Interrupts::watch();
        let mut goes_on = || match interrupts.look() {
            false => Ok(()),
            true => Err(Exit::Interrupted.error("homing was stopped by Ctrl-C")),
        };
        drive::arm(client)?;
        drive::home(client, &mut goes_on)
            .or_else(|error| interrupts.explain(Err(error)).map(|_| drive::Homed::Moved))?;
    }
    let Standing { there, from_mm } = Standing::of(client, rig.name(), rig)?;
    let middle_mm = 500.0 * rig.get(&keys::actuator::STROKE_M);
    let test = slow_move::go(rig, &there, from_mm, middle_mm)?;
    run_test(client, TestRun::of(&test), None)?;
    client.disarm()
}

/// The rig file with what the tests of `identify --plan` show. The law of a rig that was only changed by numbers does not know them.
fn identified(arguments: &Commission) -> Result<Rig> {
    let plan = Identify::of_plan(&arguments.rig, &arguments.port.port, &arguments.out, arguments.pages);
    let (found, _) = identify::identified(&plan)?;
    match pneudrive_identify::report::refusal(&found) {
        None => load_rig(&arguments.out.join(identify::FITTED).to_string_lossy(), &[]),
        Some(refusal) => Err(Exit::NotBorneOut.error(refusal)),
    }
}

/// The rig with moves between two places beside the middle, mm, of which a recorder of this many samples holds all.
fn trial(rig: &Rig, to_either_side_mm: f64, capacity: u32) -> Result<Rig> {
    let middle_mm = 500.0 * rig.get(&keys::actuator::STROKE_M);
    let count = |mm: f64| (mm / mm_per_count(rig)) as i64;
    let moves: Vec<String> = (0..TRIALS)
        .map(|k| {
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            format!("[{:?}, {}]", 0.2 + EVERY_S * k as f64, count(middle_mm + side * to_either_side_mm))
        })
        .collect();
    let duration_s = 0.2 + EVERY_S * TRIALS as f64;
    let samples = duration_s * 1e6 / f64::from(rig.period_us().get()) + 2.0;
    let settings = [
        keys::test::MOVES.setting(format_args!("[[0.0, {}], {}]", count(middle_mm), moves.join(", "))),
        keys::test::DURATION_S.setting(duration_s),
        keys::test::DECIMATION.setting((samples / f64::from(capacity.max(1))).ceil()),
        keys::test::POSITION_M
            .setting(1e-3 * mm_per_count(rig) * encoder::middle(rig, count(middle_mm) as f64)),
    ];
    Ok(rig.with_test(&settings)?)
}

/// The rig as its encoder sees it, which judges the drive, too.
fn by_its_encoder(rig: &Rig) -> Result<Rig> {
    let exact = [&keys::encoder::SCALE_ERROR_PERCENT, &keys::encoder::OFFSET_ERROR_MM];
    Ok(rig.with_settings(&exact.map(|error| error.setting(0.0)))?)
}

/// What the drive did beside what the twin with the values found does, and whether it has positioned.
fn judge(arguments: &Commission, trial: &Rig, path: &Path, target: &TargetFile) -> Result<()> {
    let trial = &by_its_encoder(trial)?;
    let accuracy = Accuracy::of(trial);
    let ensemble =
        run_ensemble(trial, accuracy, Spacing::default(), moves_of_run, |_, _| {}, CancelToken::NEVER)?;
    let judged = ensemble.nominal;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let simulated = Transient::of_run("predicted", &StoredRun::of_judged(trial, &judged));
    let recorded = Transient::of_target(&name, target)?;
    let tolerance = tolerance_mm(Some(trial));
    let on_the_drive = moves(&recorded, &Motion::of(&recorded), None, tolerance);
    // The first one is no move: the drive holds in the middle.
    let on_the_drive = on_the_drive.get(1..).unwrap_or_default();
    let off: Vec<&Move> = on_the_drive.iter().filter(|one| one.settling_s.is_none()).collect();
    let notes = vec![
        format!("The drive {}.", verdict(&[on_the_drive.to_vec()], tolerance)),
        format!(
            "Its twin with the values found {}.",
            simulate::sentence(&judged, &verdict(&ensemble.measured, tolerance))
        ),
    ];
    notes.iter().for_each(|note| say!("{note}"));
    let transients = [recorded, simulated];
    let tables = overlay(&transients)?;
    let page = report::page(&format!("{}, commissioned", trial.name()), notes, &transients, tables);
    let file = arguments.out.join(PAGE);
    page.write(&file, arguments.pages.library()).context("the page")?;
    say!("{}", file.display());
    json::figures(|| json!({ "trial_moves": TRIALS, "trial_moves_off": off.len(), "report": file }));
    match off.is_empty() {
        true => Ok(()),
        false => Err(Exit::NotBorneOut.error(format!(
            "{} of {TRIALS} trial moves do not come to rest within {tolerance} mm; {} shows them",
            off.len(),
            file.display()
        ))),
    }
}
