//! `pneudrive run`.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::{Mode, Status, UNTIL_STOPPED};
use pneudrive_records::parameter_names::{Written, is_parameter};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::words;
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller;
use pneudrive_sim::component::operator;
use pneudrive_sim::keys;

use super::firmware_notes::{report_boots, report_missing};
use super::interrupts::Interrupts;
use super::progress::Progress;
use super::rig_source::load_rig;
use super::streaming::Streaming;
use crate::cli::Run;
use crate::exit::Exit;

/// How long a stepper's spool may take to mid-travel; after that, the rig refuses the start and says why.
const WALK_TO_NULL: Duration = Duration::from_secs(2);

pub(super) fn execute(arguments: &Run) -> Result<()> {
    let rig = load_rig(&arguments.rig, &arguments.settings)?;
    for setting in &arguments.settings {
        check_setting(setting, arguments.config)?;
    }
    let mut client = Client::connect(&arguments.port.port)?;
    let streaming = arguments.stream.as_deref().map(|path| (path, arguments.every));
    let last_sample = last_sample(arguments, &rig)?;
    run_test(&mut client, &rig, last_sample, arguments.config, streaming)?;
    if last_sample == UNTIL_STOPPED {
        say!("{}: ended by Ctrl-C, the drive is disarmed", rig.name());
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

/// The keys of a test that are downloaded. The other keys of `[test]` are for the simulator.
const OF_THE_TEST: [&str; 7] = [
    "test.moves",
    "test.targets",
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
    refuse_unready(&client.status()?)?;
    warn_of_other_hosts(client)?;
    report_boots(client);
    client.disarm()?;
    if !with_parameters {
        compare_parameters(&client.parameters()?.values, &rig.parameters(), rig.name())?;
    }
    if streaming.is_none() {
        warn_of_a_full_recorder(client, rig, last_sample)?;
    }
    client.prepare(rig, last_sample, with_parameters.then(|| rig.parameters()).as_ref())?;
    let parameters = client.parameters()?;
    report_missing(&parameters);
    let mut stream = streaming
        .map(|(path, every)| Streaming::begin(client, rig.name(), &parameters, path, every))
        .transpose()?;
    let interrupts = Interrupts::watch();
    client.arm()?;
    let ready = wait_for_null(client, rig, &interrupts)
        .and_then(|()| wait_for_samples_before(client, rig, &interrupts));
    if let Err(error) = ready.and_then(|()| client.start()) {
        client.disarm()?;
        stream.map_or(Ok(()), |stream| stream.end(client))?;
        return Err(error);
    }
    let followed = follow(client, last_sample, stream.as_mut(), &interrupts);
    // The file is ended first, whatever became of the run.
    let ended = stream.map_or(Ok(()), |stream| stream.end(client));
    interrupts.explain(followed).and(ended)
}

/// Refuses a rig that is already running, or in a fault.
fn refuse_unready(status: &Status) -> Result<()> {
    match status.mode {
        Mode::Running => Err(Exit::Refused
            .error("a run is already in progress; wait for its end, or stop it (`pneudrive device stop`)")),
        Mode::Fault => Err(Exit::Refused.error(format!(
            "the rig is in the fault {}: {}; make sure that it is safe, then clear the fault with `pneudrive device arm`",
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        ))),
        _ => Ok(()),
    }
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

/// Firmware before version 5 of the protocol obeys every host.
fn warn_of_other_hosts(client: &mut Client) -> Result<()> {
    if client.info()?.version < 5 {
        tell!(
            "note: its firmware obeys every program that talks to the rig, even one that runs another test, and takes a test move by move; let no other program use the rig"
        );
    }
    Ok(())
}

/// Waits until the armed rig has recorded the samples that the test needs from before its start. Status requests
/// tell the rig meanwhile that its owner is there.
fn wait_for_samples_before(client: &mut Client, rig: &Rig, interrupts: &Interrupts) -> Result<()> {
    let samples = rig.get(&keys::test::PRE_TRIGGER) * rig.get(&keys::test::DECIMATION).max(1);
    let period = Duration::from_micros(rig.period_us().get().into());
    let begin = Instant::now();
    while begin.elapsed() < period.saturating_mul(samples as u32) {
        if interrupts.look() {
            return Err(interrupts.not_begun());
        }
        client.status()?;
        std::thread::sleep(period.clamp(Duration::from_millis(5), Duration::from_millis(50)));
    }
    Ok(())
}

/// The spool of a stepper valve walks to mid-travel one step a sample; a start before that is refused.
fn wait_for_null(client: &mut Client, rig: &Rig, interrupts: &Interrupts) -> Result<()> {
    let begun = Instant::now();
    while begun.elapsed() < WALK_TO_NULL {
        if interrupts.look() {
            return Err(interrupts.not_begun());
        }
        if rig.get(&keys::operator::MODEL) != operator::Model::Stepper || client.status()?.spool == 0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

/// Notes how much of a long test the recorder will hold.
fn warn_of_a_full_recorder(client: &mut Client, rig: &Rig, last_sample: u32) -> Result<()> {
    // The recorder reserves its whole ring for samples from before the start.
    let before = rig.get(&keys::test::PRE_TRIGGER) as u32;
    let capacity = client.info()?.record_capacity.saturating_sub(before);
    let stored = last_sample / rig.get(&keys::test::DECIMATION).max(1) as u32 + 1;
    if last_sample == UNTIL_STOPPED {
        tell!("note: the recorder holds the first {capacity} samples; --stream writes all of them to a file");
    } else if stored > capacity {
        let least = last_sample.div_ceil(capacity.saturating_sub(1).max(1));
        tell!(
            "note: the recorder holds {capacity} of {stored} samples and stops when it is full; test.decimation={least} records the whole test"
        );
    }
    Ok(())
}

/// A parameter and its value as in a rig file.
fn formatted(id: u16, value: i32) -> String {
    Written::of(id).map_or_else(String::new, |written| format!("{} = {}", written.name, written.text(value)))
}

/// A parameter and its values on the rig and in the file.
fn in_both(id: u16, on_rig: i32, in_file: i32) -> String {
    Written::of(id).map_or_else(String::new, |written| {
        format!(
            "{} is {} on the rig, {} in the file",
            written.name,
            written.text(on_rig),
            written.text(in_file)
        )
    })
}

/// Whether a file sets no end position, as in open loop: an end position of the rig then only limits it further.
fn is_no_end_position(id: u16, in_file: i32) -> bool {
    [(id::END_MIN_COUNTS, -i32::MAX), (id::END_MAX_COUNTS, i32::MAX)].contains(&(id, in_file))
}

/// Notes which parameters of the rig differ from the file: the run uses those of the rig. A different loop or period
/// is refused, because the moves would mean something else.
fn compare_parameters(rig: &Parameters, file: &Parameters, name: &str) -> Result<()> {
    for id in [id::OPEN_LOOP, id::STEPPER, id::PERIOD_US, id::ON_ARRIVAL] {
        let (on_rig, in_file) = (rig.get(id), file.get(id));
        if on_rig != in_file {
            bail!(
                "{} on the rig and {} in {name}, so its moves would mean something else; --config downloads the parameters of the file",
                formatted(id, on_rig.unwrap_or(0)),
                formatted(id, in_file.unwrap_or(0))
            );
        }
    }
    let differences: Vec<String> = rig
        .iter()
        .zip(file.iter())
        .filter(|((_, on_rig), (_, in_file))| on_rig != in_file)
        .filter(|(_, (id, in_file))| !is_no_end_position(*id, *in_file))
        .map(|((id, on_rig), (_, in_file))| in_both(id, on_rig, in_file))
        .collect();
    if let Some(first) = differences.first() {
        let others = differences.len() - 1;
        let more = if others == 0 { String::new() } else { format!("; {others} more differ") };
        tell!(
            "note: the rig's parameters differ from {name} ({first}{more}); --config downloads those of the file"
        );
    }
    Ok(())
}
