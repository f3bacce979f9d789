//! A test on a rig: checked against the rig, downloaded, armed, started and followed to its end.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use crate::firmware_notes::{report_armed, report_boots, report_missing};
use crate::streaming::{Streamed, Streaming, ToFile};
use anyhow::{Result, bail};
use pneudrive_controller::law::Loop;
use pneudrive_controller::parameters::{KEPT, id};
use pneudrive_controller::{Config, Parameters};
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_protocol::{Mode, Status, UNTIL_STOPPED};
use pneudrive_records::parameter_names::Written;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;
use pneudrive_records::words;
use pneudrive_sim::Rig;
use pneudrive_sim::component::{controller as control, operator};
use pneudrive_sim::keys;

/// How long a stepper's spool may take to mid-travel; after that, the rig refuses the start and says why.
const WALK_TO_NULL: Duration = Duration::from_secs(2);

/// An axis that has stayed where it is for so long stands.
const STANDS: Duration = Duration::from_millis(100);

/// One that creeps on for so long is no longer waited for: the drive judges it once it is armed.
const WAIT_FOR_REST: Duration = Duration::from_secs(5);

/// How far a load may drift, as a part of the stroke, before a test in open loop: a planned one stays a tenth of the stroke away from the
/// ends.
const DRIFTS: f64 = 0.05;

/// How long the air in the chambers of a cylinder takes to come near to rest with the valve at its null, whose paths leak.
const AIR_RESTS: Duration = Duration::from_secs(4);

/// Asked again and again while the rig is waited for: an error ends the wait.
pub type Interrupted<'a> = dyn FnMut() -> Result<()> + 'a;

/// The test of a rig, as it is to be run on one.
#[derive(Clone, Copy, Debug)]
pub struct TestRun<'a> {
    /// The rig file.
    pub rig: &'a Rig,
    /// The last sample of the test; [`UNTIL_STOPPED`]: the test has no end of its own.
    pub last_sample: u32,
    /// Whether the parameters of the rig file are downloaded, too.
    pub with_parameters: bool,
}

impl<'a> TestRun<'a> {
    /// As it stands in the rig file, with the parameters of the drive.
    #[must_use]
    pub fn of(rig: &'a Rig) -> TestRun<'a> {
        TestRun { rig, last_sample: rig.last_sample(), with_parameters: false }
    }

    /// Makes it ready; a stream to a file begins.
    ///
    /// # Errors
    /// As for [`prepare`]; when the file is there already, or the rig has no streams.
    pub fn prepare(&self, client: &mut Client, to: Option<&ToFile>) -> Result<Prepared<'a>> {
        if let Some(to) = to {
            Streaming::check(&to.path)?;
        }
        let parameters = prepare(client, self.rig, self.last_sample, self.with_parameters, to.is_some())?;
        let begin = |to| Streaming::begin(client, self.rig.name(), &parameters, to);
        Ok(Prepared { rig: self.rig, stream: to.map(begin).transpose()? })
    }
}

/// A test that can be started.
pub struct Prepared<'a> {
    rig: &'a Rig,
    stream: Option<Streaming>,
}

/// The outcome of a run.
pub struct RunOutcome {
    /// The mode in which it ended; an error if it did not begin, or did not end as requested.
    pub ended: Result<Mode>,
    /// The file that it was streamed to, if that is complete.
    pub streamed: Option<Streamed>,
    /// Whether file and stream could be ended.
    pub stream_ended: Result<()>,
}

impl Prepared<'_> {
    /// Arms, starts and follows it; the file of the stream is complete then, whatever has become of the run. `interrupted` is
    /// asked until it starts; then `ends` ends it.
    pub fn run(
        self,
        client: &mut Client,
        ends: &AtomicBool,
        interrupted: &mut Interrupted<'_>,
        progressed: impl FnMut(&Status),
    ) -> RunOutcome {
        let mut stream = self.stream;
        let mut armed = |client: &mut Client| stream.as_mut().map_or(Ok(()), |stream| stream.renew(client));
        let started = start_armed(client, self.rig, interrupted, &mut armed);
        let ended = started.and_then(|()| match &mut stream {
            None => client.follow(ends, progressed),
            Some(stream) => {
                client.follow_streamed(ends, progressed, |row| stream.take(row)).map(|(status, _)| status)
            }
        });
        let (streamed, stream_ended) = stream.map_or((None, Ok(())), |stream| stream.end(client));
        RunOutcome { ended: ended.map(|status| status.mode), streamed, stream_ended }
    }
}

/// Sets the loop of a drive to that of a rig file, which a drive does disarmed alone.
///
/// # Errors
/// When it does not answer or refuses.
fn set_loop(client: &mut Client, rig: &Rig) -> Result<()> {
    client.disarm()?;
    let is_open = rig.get(&keys::controller::LOOP) == control::Loop::Open;
    client.set_parameters(id::OPEN_LOOP, &[is_open.into()])
}

/// Downloads the test of a rig, which ends with this sample, and its parameters if asked for. The drive is disarmed
/// then. Returns the parameters in force. Differences between rig and file go to the log.
///
/// # Errors
/// When the rig is running or in a fault, the moves would mean something else on it, or it refuses.
pub fn prepare(
    client: &mut Client,
    rig: &Rig,
    last_sample: u32,
    with_parameters: bool,
    is_streamed: bool,
) -> Result<RigParameters> {
    let status = client.status()?;
    refuse_unready(&status)?;
    report_boots(client);
    // A refusal changes nothing: a drive that holds its load goes on.
    let there = client.parameters()?;
    if with_parameters {
        let sent = RigParameters { values: rig.parameters(), lacking: Vec::new() };
        refuse_what_it_would(rig, &sent, will_be_referenced(&status, &there, &sent))?;
        client.refuse_unwatched(&sent.values)?;
    } else {
        compare_parameters(&there.values, &rig.parameters(), rig.name())?;
        refuse_what_it_would(rig, &there, status.referenced)?;
        client.refuse_unwatched(&there.values)?;
    }
    client.disarm()?;
    if !is_streamed {
        warn_of_a_full_recorder(client, rig, last_sample)?;
    }
    client.prepare(rig, last_sample, with_parameters.then(|| rig.parameters()).as_ref())?;
    let parameters = client.parameters()?;
    report_missing(&parameters);
    Ok(parameters)
}

/// Arms the drive and starts the test that was prepared, once the rig is ready. If it does not start, the drive is
/// disarmed.
///
/// # Errors
/// When the rig refuses, or `interrupted` says so.
pub fn start(client: &mut Client, rig: &Rig, interrupted: &mut Interrupted<'_>) -> Result<()> {
    start_armed(client, rig, interrupted, &mut |_| Ok(()))
}

/// The same; `armed` is called once the drive has taken over what its last run learned.
fn start_armed(
    client: &mut Client,
    rig: &Rig,
    interrupted: &mut Interrupted<'_>,
    armed: &mut dyn FnMut(&mut Client) -> Result<()>,
) -> Result<()> {
    report_armed(&client.arm()?);
    let ready = armed(client)
        .and_then(|()| wait_for_null(client, rig, interrupted))
        .and_then(|()| wait_for_samples_before(client, rig, interrupted));
    if let Err(error) = ready.and_then(|()| client.start()) {
        let error = tripped_before(&client.status()?).unwrap_or(error);
        client.disarm()?;
        return Err(error);
    }
    Ok(())
}

/// Why a drive that was armed is not any more; None if that is not because it tripped.
fn tripped_before(status: &Status) -> Option<anyhow::Error> {
    (status.mode == Mode::Fault).then(|| {
        Failure::Tripped.error(format!(
            "the drive tripped before the start: {} ({}); `pneudrive device arm` clears the fault",
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        ))
    })
}

/// Refuses a test in closed loop that a drive with these parameters would refuse to start, before anything is changed on it.
///
/// # Errors
/// When its axis is not `referenced`, or a setpoint lies beyond a soft limit.
pub fn refuse_what_it_would(rig: &Rig, parameters: &RigParameters, referenced: bool) -> Result<()> {
    let Ok(config) = Config::new(&parameters.values) else { return Ok(()) };
    if config.law.control_loop == Loop::Open {
        return Ok(());
    }
    if !referenced {
        return Err(Failure::Refused.error("the axis has not been referenced: home it first"));
    }
    let sequence = rig.sequence();
    let mut ends = sequence.moves().iter().flat_map(|next| next.extremes());
    let Some(beyond) = ends.find(|end| !config.limits.allows(*end)) else { return Ok(()) };
    let units = Units::of(parameters);
    let [beyond, least, most] =
        [beyond, config.limits.soft_min, config.limits.soft_max].map(|counts| units.length(counts));
    Err(Failure::Refused.error(format!(
        "the setpoint {beyond} lies beyond a soft limit of the drive, which goes from {least} to {most} (safety.end_min_mm, safety.end_max_mm)"
    )))
}

/// Whether the axis will be referenced once these parameters are in force: an absolute encoder is at once, and another one
/// loses its reference with what its counts mean.
fn will_be_referenced(status: &Status, there: &RigParameters, sent: &RigParameters) -> bool {
    let meaning = |of: &RigParameters| {
        [id::ENCODER_PM_PER_COUNT, id::ENCODER_INVERTED, id::ENCODER_MODEL].map(|id| of.values.get(id))
    };
    sent.values.absolute_zero().is_some() || status.referenced && meaning(there) == meaning(sent)
}

/// Refuses a rig that is already running, or in a fault.
///
/// # Errors
/// When it is.
pub fn refuse_unready(status: &Status) -> Result<()> {
    match status.mode {
        Mode::Homing | Mode::Running => Err(Failure::Refused
            .error("a run is already in progress; wait for its end, or stop it (`pneudrive device stop`)")),
        Mode::Fault => Err(Failure::Refused.error(format!(
            "the rig is in the fault {}: {}; make sure that it is safe, then clear the fault with `pneudrive device arm`",
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        ))),
        _ => Ok(()),
    }
}

/// Waits until the armed rig has recorded the samples that the test needs from before its start. Status requests
/// tell the rig meanwhile that its owner is there.
fn wait_for_samples_before(client: &mut Client, rig: &Rig, interrupted: &mut Interrupted<'_>) -> Result<()> {
    let samples = rig.get(&keys::test::PRE_TRIGGER) * rig.get(&keys::test::DECIMATION).max(1);
    let period = Duration::from_micros(rig.period_us().get().into());
    let begin = Instant::now();
    while begin.elapsed() < period.saturating_mul(samples as u32) {
        interrupted()?;
        client.status()?;
        std::thread::sleep(period.clamp(Duration::from_millis(5), Duration::from_millis(50)));
    }
    Ok(())
}

/// Waits for the spool of a stepper valve, which walks to mid-travel one step a sample; a start before that is refused.
///
/// # Errors
/// When the rig does not answer, or `interrupted` says so.
pub fn wait_for_null(client: &mut Client, rig: &Rig, interrupted: &mut Interrupted<'_>) -> Result<()> {
    let begun = Instant::now();
    while begun.elapsed() < WALK_TO_NULL {
        interrupted()?;
        if rig.get(&keys::operator::MODEL) != operator::OperatorKind::Stepper || client.status()?.spool == 0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

/// Makes a drive ready for a test: in its loop, disarmed and at rest, before one in open loop near where it was left (counts).
///
/// # Errors
/// When the rig does not answer or refuses, `interrupted` says so, or the load has drifted away: an open valve would drive it on into an
/// end.
pub fn ready_for(
    client: &mut Client,
    rig: &Rig,
    left_at: i32,
    interrupted: &mut Interrupted<'_>,
) -> Result<()> {
    set_loop(client, rig)?;
    wait_for_rest(client, interrupted)?;
    interrupted()?;
    if rig.get(&keys::controller::LOOP) == control::Loop::Closed {
        return Ok(());
    }
    let position = client.status()?.position;
    let units = Units::of(&client.parameters()?);
    let (Some(left_mm), Some(stands_mm)) = (units.millimetres(left_at), units.millimetres(position)) else {
        return Ok(());
    };
    if (stands_mm - left_mm).abs() > DRIFTS * 1e3 * rig.get(&keys::actuator::STROKE_M) {
        return Err(Failure::Refused.error(format!(
            "the piston was left at {left_mm:.1} mm and stands at {stands_mm:.1} mm: the load drifts while the valve is at its null; support it, or lay the axis level"
        )));
    }
    Ok(())
}

/// Waits until a disarmed axis stands, as the drive itself understands that (`no_motion_counts`): what a test has moved coasts, and would
/// trip the drive that is armed meanwhile.
///
/// # Errors
/// When the rig does not answer, or `interrupted` says so.
pub fn wait_for_rest(client: &mut Client, interrupted: &mut Interrupted<'_>) -> Result<()> {
    let tolerance = client.parameters()?.values.get(id::NO_MOTION_COUNTS).unwrap_or(0).unsigned_abs();
    let begun = Instant::now();
    let (mut at, mut since) = (client.status()?.position, begun);
    while since.elapsed() < STANDS && begun.elapsed() < WAIT_FOR_REST {
        interrupted()?;
        std::thread::sleep(Duration::from_millis(10));
        let position = client.status()?.position;
        if position.abs_diff(at) > tolerance {
            (at, since) = (position, Instant::now());
        }
    }
    Ok(())
}

/// Leaves a disarmed drive alone until the air in its chambers has come to rest.
///
/// # Errors
/// When the rig does not answer, or `interrupted` says so.
pub fn wait_for_air(client: &mut Client, interrupted: &mut Interrupted<'_>) -> Result<()> {
    let begun = Instant::now();
    while begun.elapsed() < AIR_RESTS {
        interrupted()?;
        std::thread::sleep(Duration::from_millis(50));
        client.status()?;
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
        log::info!("the recorder holds the first {capacity} samples; --stream writes all of them to a file");
    } else if stored > capacity {
        let least = last_sample.div_ceil(capacity.saturating_sub(1).max(1));
        log::info!(
            "the recorder holds {capacity} of {stored} samples and stops when it is full; test.decimation={least} records the whole test"
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

/// Whether a file sets no soft limit, as in open loop: a soft limit of the rig then only limits it further.
fn is_no_soft_limit(id: u16, in_file: i32) -> bool {
    [(id::END_MIN_COUNTS, -i32::MAX), (id::END_MAX_COUNTS, i32::MAX)].contains(&(id, in_file))
}

/// Notes which parameters of the rig differ from the file: the run uses those of the rig. A different loop or period
/// is refused, because the moves would mean something else.
fn compare_parameters(rig: &Parameters, file: &Parameters, name: &str) -> Result<()> {
    let closed = file.get(id::OPEN_LOOP) == Some(Loop::Closed as i32);
    let of_setpoints = closed.then_some(id::ENCODER_PM_PER_COUNT);
    for id in [id::OPEN_LOOP, id::STEPPER, id::PERIOD_US, id::ON_ARRIVAL].into_iter().chain(of_setpoints) {
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
        .filter(|((id, on_rig), (_, in_file))| on_rig != in_file && !KEPT.contains(id))
        .filter(|(_, (id, in_file))| !is_no_soft_limit(*id, *in_file))
        .map(|((id, on_rig), (_, in_file))| in_both(id, on_rig, in_file))
        .collect();
    if let Some(first) = differences.first() {
        let others = differences.len() - 1;
        let more = if others == 0 { String::new() } else { format!("; {others} more differ") };
        log::info!(
            "the rig's parameters differ from {name} ({first}{more}); --config downloads those of the file"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use pneudrive_records::target::TargetFile;
    use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};

    use super::*;

    #[test]
    fn a_drive_that_trips_between_arming_and_the_start_is_told_with_its_fault() {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let served = VirtualRig::new(rig.clone(), 1, Pace { fast: true, live: false }).expect("a rig");
        let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
        let mut client = Client::connect(served.port()).expect("it answers");
        prepare(&mut client, &rig, rig.last_sample(), false, false).expect("the test of its own file");
        let mut stopped = || Client::connect(served.port())?.stop();
        let error = start(&mut client, &rig, &mut stopped).expect_err("it does not run");
        assert!(format!("{error:#}").contains("tripped before the start: stop"), "{error:#}");
    }

    /// An open valve would drive it on into an end.
    #[test]
    fn a_load_that_has_drifted_is_not_driven_on_in_open_loop() {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let with_loop = |word: &str| rig.with_settings(&[format!("controller.loop={word}")]).expect("valid");
        let served = VirtualRig::new(rig.clone(), 1, Pace { fast: true, live: false }).expect("a rig");
        let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
        let mut client = Client::connect(served.port()).expect("it answers");
        let here = client.status().expect("it answers").position;
        // A sixth of the stroke of 300 mm, and a sixtieth.
        for (word, off_mm, refused) in [("open", 50.0, true), ("open", 5.0, false), ("closed", 50.0, false)] {
            let left_at = here - (off_mm / 0.01205) as i32;
            let ready = ready_for(&mut client, &with_loop(word), left_at, &mut || Ok(()));
            let told = ready.err().map_or(String::new(), |error| format!("{error:#}"));
            assert_eq!(told.contains("the load drifts"), refused, "{word}, {off_mm} mm: {told}");
        }
    }

    /// It was written before the drive was armed, and had the parameters of the run before.
    #[test]
    fn the_header_of_a_streamed_run_has_what_the_runs_before_have_learned() {
        let rig = Rig::builtin("press").expect("a built-in rig");
        let settings = ["controller.adapt=kept", "test.duration_s=0.6"].map(str::to_owned);
        let rig = rig.with_settings(&settings).expect("valid");
        let served = VirtualRig::new(rig.clone(), 1, Pace { fast: true, live: false }).expect("a rig");
        let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
        let mut client = Client::connect(served.port()).expect("it answers");
        let folder = tempfile::tempdir().expect("a folder");
        for armings in ["0", "1", "2"] {
            let path = folder.path().join(armings);
            let to = ToFile { path: path.clone(), every: 1 };
            let prepared = TestRun::of(&rig).prepare(&mut client, Some(&to)).expect("its own test");
            let ran = prepared.run(&mut client, &AtomicBool::new(false), &mut || Ok(()), |_| {});
            assert_eq!(ran.ended.expect("it ends"), Mode::Done);
            let file = TargetFile::read(&path).expect("a whole file");
            assert_eq!(file.get("param.kept_armings"), Some(armings));
            assert_eq!(file.samples.len() as u64, ran.streamed.expect("a file").samples);
        }
    }
}
