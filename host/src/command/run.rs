//! `pneudrive run`.

use std::time::Duration;

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Status, UNTIL_STOPPED};
use pneudrive_records::move_points::Through;
use pneudrive_records::parameter_names::is_parameter;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::stream_file::MAX_SAMPLES;
use pneudrive_session::streaming::{Streamed, ToFile};
use pneudrive_session::test_run::{RunOutcome, TestRun};
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller;
use pneudrive_sim::keys;
use serde_json::json;

use super::interrupts::Interrupts;
use super::progress::Progress;
use super::rig_source::{load_rig_with, through_points};
use crate::cli::Run;
use crate::json;

pub(super) fn execute(arguments: &Run) -> Result<()> {
    let rig = rig_of(arguments)?;
    let mut client = arguments.port.connect()?;
    let to = arguments.stream.clone().map(|path| ToFile { path, every: arguments.every });
    let last_sample = last_sample(arguments, &rig)?;
    if arguments.stream.is_some() {
        check_length(last_sample, arguments.every, &rig)?;
    }
    let test = TestRun { rig: &rig, last_sample, with_parameters: arguments.config };
    run_test(&mut client, test, to.as_ref())?;
    json::figures(
        || json!({ "rig": rig.name(), "ended_by": if last_sample == UNTIL_STOPPED { "Ctrl-C" } else { "the test" } }),
    );
    if last_sample == UNTIL_STOPPED {
        say!("{}: interrupted, the drive is disarmed", rig.name());
        return Ok(());
    }
    say!("{}: done", rig.name());
    if rig.get(&keys::controller::LOOP) == controller::Loop::Closed {
        say!("the drive holds its last setpoint; `pneudrive device disarm` releases it");
        report_hold(&client.parameters()?);
    }
    say!("next: pneudrive record --port {}", arguments.port.port);
    Ok(())
}

/// The rig with the test to run.
fn rig_of(arguments: &Run) -> Result<Rig> {
    let rig = load_rig_with(&arguments.rig, &arguments.settings, arguments.points.is_some())?;
    for setting in &arguments.settings {
        check_setting(setting, arguments.config)?;
    }
    let Some(table) = &arguments.points else { return Ok(rig) };
    let Through { rig, notes } = through_points(&rig, table, &arguments.settings)?;
    notes.iter().for_each(|note| tell!("{note}"));
    Ok(rig)
}

/// The keys of a test that are downloaded. The other keys of `[test]` are for the simulator.
const OF_THE_TEST: [&str; 14] = [
    keys::test::MOVE.key.path,
    keys::test::MOVES.key.path,
    keys::test::MOVES_MM.key.path,
    keys::test::TARGETS.key.path,
    keys::test::TARGETS_MM.key.path,
    keys::test::PROFILE.key.path,
    keys::test::VELOCITY_MM_S.key.path,
    keys::test::ACCELERATION_MM_S2.key.path,
    keys::test::JERK_MM_S3.key.path,
    keys::test::DURATION_S.key.path,
    keys::test::REPEAT_EVERY_S.key.path,
    keys::test::IMPULSE.key.path,
    keys::test::DECIMATION.key.path,
    keys::test::PRE_TRIGGER.key.path,
];

/// Keys that define the meaning of the moves: a rig with other values is refused.
const OF_THE_MOVES: [&str; 4] = [
    keys::controller::LOOP.key.path,
    keys::controller::PERIOD_S.key.path,
    keys::controller::EXIT_ON_DEAD_BAND.key.path,
    keys::operator::MODEL.key.path,
];

/// Refuses a setting that has no effect on a rig instead of ignoring it.
fn check_setting(setting: &str, with_parameters: bool) -> Result<()> {
    let key = setting.split('=').next().unwrap_or_default().trim();
    if key == "name" || OF_THE_TEST.contains(&key) || OF_THE_MOVES.contains(&key) {
        return Ok(());
    }
    match (is_parameter(key), with_parameters) {
        (true, true) => Ok(()),
        (true, false) => bail!(
            "--set {key}: a run downloads only the test; --config also downloads the controller's parameters"
        ),
        (false, _) => {
            bail!(
                "--set {key}: this key is not sent to a rig; it is for the simulator (`pneudrive simulate`)"
            )
        }
    }
}

/// The last sample of the test with the duration that the command line asks for.
fn last_sample(arguments: &Run, rig: &Rig) -> Result<u32> {
    if arguments.until_stopped {
        return Ok(UNTIL_STOPPED);
    }
    let Some(lasting) = arguments.lasting else { return Ok(rig.last_sample()) };
    let period = Duration::from_micros(rig.period_us().get().into());
    let last = u32::try_from(lasting.as_nanos() / period.as_nanos());
    last.ok().filter(|&last| last < UNTIL_STOPPED).with_context(|| {
        format!(
            "--for: at {} us per sample, a run can last at most {:.0} days; use --until-stopped for longer",
            period.as_micros(),
            f64::from(UNTIL_STOPPED) * period.as_secs_f64() / 86_400.0
        )
    })
}

/// Refuses a stream of more samples than any command reads, before anything moves.
fn check_length(last_sample: u32, every: u16, rig: &Rig) -> Result<()> {
    let (samples, most) = (u64::from(last_sample) / u64::from(every) + 1, MAX_SAMPLES as u64);
    let enough = u64::from(last_sample) / most + 1;
    let period_s = f64::from(rig.period_us().get()) / 1e6;
    match last_sample {
        UNTIL_STOPPED => {
            let hours = most as f64 * f64::from(every) * period_s / 3600.0;
            tell!(
                "note: after {hours:.1} h the stream has more than the {most} samples that a command reads; a larger --every makes it longer"
            );
        }
        _ if samples > most => bail!(
            "--stream: the run has {samples} samples for the file, and a command reads {most} at most; stream fewer of them with --every {enough}, or make the run shorter"
        ),
        _ => {}
    }
    Ok(())
}

/// Runs a test with a progress bar; it is streamed to a file, if one is given.
pub(super) fn run_test(client: &mut Client, test: TestRun<'_>, to: Option<&ToFile>) -> Result<()> {
    let prepared = test.prepare(client, to)?;
    let interrupts = Interrupts::watch();
    let mut progress = None;
    let begin = || match test.last_sample {
        UNTIL_STOPPED => Progress::endless("running", "Ctrl-C ends the run"),
        _ => Progress::new("running"),
    };
    let progressed = |status: &Status| {
        let bar = progress.get_or_insert_with(begin);
        bar.at(u64::from(status.index), u64::from(status.duration_samples));
        interrupts.look();
    };
    let mut goes_on = || if interrupts.look() { Err(interrupts.not_begun()) } else { Ok(()) };
    let RunOutcome { ended, streamed, stream_ended } =
        prepared.run(client, interrupts.seen(), &mut goes_on, progressed);
    progress.into_iter().for_each(Progress::done);
    streamed.iter().for_each(report_stream);
    interrupts.explain(ended).and(stream_ended)
}

/// Reports the samples and gaps of a stream.
fn report_stream(stream: &Streamed) {
    let Streamed { path, samples, missing } = stream;
    json::figures(|| json!({ "stream": { "file": path, "samples": samples, "missing": missing } }));
    let lost =
        if *missing == 0 { "none missing".to_owned() } else { format!("{missing} MISSING, see its gaps") };
    say!("{}: {samples} samples, {lost}", path.display());
}

/// Reports how long the drive holds without a host.
fn report_hold(parameters: &RigParameters) {
    let hold_ms = parameters.values.get(id::HOLD_MS).filter(|_| !parameters.lacking.contains(&id::HOLD_MS));
    match hold_ms {
        Some(ms) => say!("without a host, a rig in real time disarms after {} s", f64::from(ms) / 1e3),
        None => tell!("note: its firmware has no safety.hold_s, so it holds indefinitely"),
    }
}
