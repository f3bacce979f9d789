//! `pneudrive commission`: a drive finds its constants, takes them over and shows what it does with them.
//!
//! ```text
//! parameters of the rig file -> direction -> middle of the stroke -> tests -> fit -> parameters of the fit -> trial moves -> report
//! ```
//!
//! Nothing moves in closed loop before a short stroke of the valve has shown that the drive goes where it should. The drive gets back
//! what it had where a step fails or is interrupted. Tests that were recorded before an interruption of the tests are not run again.

mod fit;

use std::io::{IsTerminal, stderr, stdin};
use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_controller::Parameters;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::{Motion, Move, moves, moves_of_run, tolerance_mm, verdict};
use pneudrive_evaluate::report;
use pneudrive_evaluate::transient::Transient;
use pneudrive_identify::moves::STOPS_FROM_END;
use pneudrive_identify::plan::NEEDS_PRESSURES;
use pneudrive_link::client::Client;
use pneudrive_optimise::ensemble::run_ensemble;
use pneudrive_records::judged::Spacing;
use pneudrive_records::own_file::make_writable;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_session::slow_move::{self, Standing};
use pneudrive_session::test_run::{TestRun, refuse_unready, wait_for_rest};
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::{self, mm_per_count};
use pneudrive_sim::{Accuracy, Rig, keys};
use serde_json::json;

use super::identify::FITTED;
use super::identify::bench::{check_direction, of_hanging_load};
use super::interrupts::Interrupts;
use super::overlay::overlay;
use super::record::record;
use super::rig_source::load_choice;
use super::run::run_test;
use super::simulate;
use crate::cli::Commission;
use crate::exit::Exit;
use crate::json;

/// The page in the folder.
const PAGE: &str = "commissioning.html";

/// Moves of the trial: there and back, twice.
const TRIALS: usize = 4;

/// From one of them to the next, s: long enough to see that the drive rests.
const EVERY_S: f64 = 3.0;

pub(super) fn execute(arguments: &Commission) -> Result<()> {
    let rig = load_choice(&arguments.rig)?;
    refuse_what_cannot_be_commissioned(arguments, &rig)?;
    ask(arguments, &rig)?;
    make_writable(&arguments.out)?;
    let mut client = arguments.port.connect()?;
    refuse_unready(&client.status()?)?;
    // Until the drive has back what it had, Ctrl-C does not end the program but the step.
    let interrupts = Interrupts::watch();
    client.disarm()?;
    let before = client.parameters()?.values;
    say!("1. the parameters of {}", rig.name());
    client.import_parameters(&rig.parameters())?;
    let done = steps(arguments, &rig, &mut client, &interrupts);
    let disarmed = client.disarm();
    if done.is_err() {
        give_back(&mut client, &before);
    }
    done.and(disarmed)
}

/// Refuses before anything moves what would be refused in the end.
fn refuse_what_cannot_be_commissioned(arguments: &Commission, rig: &Rig) -> Result<()> {
    if !rig.get(&keys::sensors::PRESSURE) {
        bail!("{} has no pressure sensors (sensors.pressure = false): {NEEDS_PRESSURES}", rig.name());
    }
    if rig.get(&keys::controller::LOOP) != Loop::Closed {
        bail!("{} has controller.loop = \"open\": a drive that is to position has a closed one", rig.name());
    }
    trial(rig, trial_mm(arguments, rig), u32::MAX).map(|_| ())
}

/// Asks before the cylinder moves.
fn ask(arguments: &Commission, rig: &Rig) -> Result<()> {
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let planned = format!(
        "the cylinder will move along its stroke of {stroke_mm:.0} mm: by a short stroke of the valve, to the middle, from there by up to {:.0} mm to either side with the valve fully open, as far as {} describes the drive, and in {TRIALS} trial moves by {:.0} mm; between these steps, and while the fit computes, it is disabled",
        (0.5 - STOPS_FROM_END) * stroke_mm,
        rig.name(),
        2.0 * trial_mm(arguments, rig),
    );
    let hanging = of_hanging_load(rig).map(|note| format!("{note}\n"));
    let announced = format!("{}{planned}", hanging.unwrap_or_default());
    if arguments.yes {
        tell!("{announced} (--yes)");
        return Ok(());
    }
    if !(stdin().is_terminal() && stderr().is_terminal()) {
        return Err(Exit::Usage.error(format!(
            "{announced}; nobody can answer here, and --yes lets it move without being asked"
        )));
    }
    match super::device::asked(&format!("{announced}. Is everybody clear of the whole stroke?")) {
        true => Ok(()),
        false => Err(Exit::Interrupted.error("nothing was moved")),
    }
}

/// Half of the distance of a trial move, mm.
fn trial_mm(arguments: &Commission, rig: &Rig) -> f64 {
    f64::from(arguments.trial) / 100.0 * 1e3 * rig.get(&keys::actuator::STROKE_M)
}

fn steps(arguments: &Commission, rig: &Rig, client: &mut Client, interrupts: &Interrupts) -> Result<()> {
    refuse_unreferenced(client)?;
    say!("2. whether it moves in the direction of its valve");
    check_direction(&arguments.rig, client, &arguments.out)?;
    say!("3. the middle of its stroke");
    to_the_middle(client, rig, interrupts)?;
    say!("4. the tests, and what they show");
    let (found, note) = fit::identified(arguments, rig, client, interrupts)?;
    say!("5. the parameters of what was found");
    client.disarm()?;
    client.import_parameters(&found.parameters())?;
    say!("6. trial moves");
    to_the_middle(client, &found, interrupts)?;
    let trial = trial(&found, trial_mm(arguments, rig), client.info()?.record_capacity)?;
    wait_for_rest(client, &mut || interrupts.refuse_if_seen())?;
    run_test(client, TestRun::of(&trial), None)?;
    client.disarm()?;
    let (path, target) = record(client, &arguments.out)?;
    judge(arguments, &trial, &path, &target, note)?;
    say!(
        "the drive forgets these parameters when it is reset; `pneudrive device --port {} config save` keeps them",
        client.port_name()
    );
    Ok(())
}

/// With these parameters an encoder may count from another place.
fn refuse_unreferenced(client: &mut Client) -> Result<()> {
    if client.status()?.referenced {
        return Ok(());
    }
    let device = format!("pneudrive device --port {}", client.port_name());
    Err(Exit::Failed.error(format!(
        "the drive does not know where it is: check its wires with `{device} bring-up`, give it the parameters of the rig file with `{device} config import`, and home it with `{device} home`"
    )))
}

/// Gives the drive the parameters back that it had.
fn give_back(client: &mut Client, parameters: &Parameters) {
    match client.import_parameters(parameters) {
        Ok(_) => tell!("the drive has the parameters again that it had before"),
        Err(error) => tell!("note: the drive keeps the parameters of the rig file: {error:#}"),
    }
}

fn to_the_middle(client: &mut Client, rig: &Rig, interrupts: &Interrupts) -> Result<()> {
    wait_for_rest(client, &mut || interrupts.refuse_if_seen())?;
    interrupts.refuse_if_seen()?;
    let Standing { there, from_mm } = Standing::of(client, rig.name(), rig)?;
    let middle_mm = 500.0 * rig.get(&keys::actuator::STROKE_M);
    let test = slow_move::go(rig, &there, from_mm, middle_mm)?;
    run_test(client, TestRun::of(&test), None)?;
    client.disarm()
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
fn judge(
    arguments: &Commission,
    trial: &Rig,
    path: &Path,
    target: &TargetFile,
    note: Option<String>,
) -> Result<()> {
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
    let Some((_, on_the_drive)) = on_the_drive.split_first().filter(|(_, moves)| moves.len() == TRIALS)
    else {
        bail!("{} does not show the {TRIALS} trial moves", path.display());
    };
    let off: Vec<&Move> = on_the_drive.iter().filter(|one| one.settling_s.is_none()).collect();
    let mut notes = vec![
        format!("The drive {}.", verdict(&[on_the_drive.to_vec()], tolerance)),
        format!(
            "Its twin with the values found {}.",
            simulate::sentence(&judged, &verdict(&ensemble.measured, tolerance))
        ),
    ];
    notes.extend(note);
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
            "{} of {TRIALS} trial moves do not settle within {tolerance} mm; {} shows them, and {} has what was found",
            off.len(),
            file.display(),
            arguments.out.join(FITTED).display()
        ))),
    }
}
