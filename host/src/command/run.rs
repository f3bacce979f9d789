//! `pneudrive run`.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::test_run;
use pneudrive_protocol::{Mode, Status, UNTIL_STOPPED};
use pneudrive_records::move_points::Through;
use pneudrive_records::parameter_names::is_parameter;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::stream_file::MAX_SAMPLES;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller;
use pneudrive_sim::keys;
use serde_json::json;

use super::interrupts::Interrupts;
use super::progress::Progress;
use super::rig_source::{load_rig, through_points};
use super::streaming::Streaming;
use crate::cli::Run;
use crate::json;

pub(super) fn execute(arguments: &Run) -> Result<()> {
    let rig = rig_of(arguments)?;
    let mut client = arguments.port.connect()?;
    let streaming = arguments.stream.as_deref().map(|path| (path, arguments.every));
    let last_sample = last_sample(arguments, &rig)?;
    if arguments.stream.is_some() {
        check_length(last_sample, arguments.every, &rig)?;
    }
    run_test(&mut client, &rig, last_sample, arguments.config, streaming)?;
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
    let rig = load_rig(&arguments.rig, &arguments.settings)?;
    for setting in &arguments.settings {
        check_setting(setting, arguments.config)?;
    }
    let Some(table) = &arguments.points else { return Ok(rig) };
    let Through { rig, notes } = through_points(&rig, table, &arguments.settings)?;
    notes.iter().for_each(|note| tell!("{note}"));
    Ok(rig)
}

/// The keys of a test that are downloaded. The other keys of `[test]` are for the simulator.
const OF_THE_TEST: [&str; 12] = [
    "test.move",
    "test.moves",
    "test.targets",
    "test.profile",
    "test.velocity_mm_s",
    "test.acceleration_mm_s2",
    "test.jerk_mm_s3",
    "test.duration_s",
    "test.repeat_every_s",
    "test.impulse",
    "test.decimation",
    "test.pre_trigger",
];

/// Keys that define the meaning of the moves: a rig with other values is refused.
const OF_THE_MOVES: [&str; 4] =
    ["controller.loop", "controller.period_s", "controller.exit_on_dead_band", "operator.model"];

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

/// Downloads the test of a rig (with its parameters, if asked for), arms, starts and follows it to this
/// sample; every Nth sample goes to a file, if one is given.
pub(super) fn run_test(
    client: &mut Client,
    rig: &Rig,
    last_sample: u32,
    with_parameters: bool,
    streaming: Option<(&Path, u16)>,
) -> Result<()> {
    if let Some((path, _)) = streaming {
        Streaming::check(client, path)?;
    }
    let parameters = test_run::prepare(client, rig, last_sample, with_parameters, streaming.is_some())?;
    let mut stream = streaming
        .map(|(path, every)| Streaming::begin(client, rig.name(), &parameters, path, every))
        .transpose()?;
    let interrupts = Interrupts::watch();
    let mut interrupted = || if interrupts.look() { Err(interrupts.not_begun()) } else { Ok(()) };
    if let Err(error) = test_run::start(client, rig, &mut interrupted) {
        stream.map_or(Ok(()), |stream| stream.end(client))?;
        return Err(error);
    }
    let followed = follow(client, last_sample, stream.as_mut(), &interrupts);
    // The file is ended first, whatever became of the run.
    let ended = stream.map_or(Ok(()), |stream| stream.end(client));
    interrupts.explain(followed).and(ended)
}

/// Follows a run to its end with a progress bar, and streams it if requested.
fn follow(
    client: &mut Client,
    last_sample: u32,
    stream: Option<&mut Streaming>,
    interrupts: &Interrupts,
) -> Result<Mode> {
    let mut progress = match last_sample {
        UNTIL_STOPPED => Progress::endless("running", "Ctrl-C ends the run"),
        _ => Progress::new("running"),
    };
    let progressed = |status: &Status| {
        progress.at(u64::from(status.index), u64::from(status.duration_samples));
        interrupts.look();
    };
    let followed = match stream {
        None => client.follow(interrupts.seen(), progressed).map(|status| status.mode),
        Some(stream) => client
            .follow_streamed(interrupts.seen(), progressed, |row| stream.take(row))
            .map(|(status, _)| status.mode),
    };
    progress.done();
    followed
}

/// Reports how long the drive holds without a host.
fn report_hold(parameters: &RigParameters) {
    let hold_ms = parameters.values.get(id::HOLD_MS).filter(|_| !parameters.lacking.contains(&id::HOLD_MS));
    match hold_ms {
        Some(ms) => say!("without a host, a rig in real time disarms after {} s", f64::from(ms) / 1e3),
        None => tell!("note: its firmware has no safety.hold_s, so it holds indefinitely"),
    }
}
