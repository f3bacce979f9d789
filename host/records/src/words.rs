//! The meaning of the controller's codes in words, with advice.

use pneudrive_controller::{Fault, Refusal};
use pneudrive_protocol::session::NO_BOOT;
use pneudrive_protocol::{Presence, RequestRefusal, code};
use pneudrive_sim::{Convergence, Rig, Run};

use crate::judged::{FailedMembers, Judged, Spacing};
use crate::parameter_names::Written;
use crate::untrusted::{NAME, SENTENCE, sanitised};

/// Whether a run is converged, and the evidence for it.
pub fn convergence(convergence: &Convergence) -> String {
    let error = length(convergence.error_m);
    let edge = convergence.closest_edge.map(|edge| {
        format!(
            "; the closest sampled position to another count was {} away at {:.4} s",
            length(edge.distance_m),
            edge.at_s
        )
    });
    let edge = edge.unwrap_or_default();
    match convergence.unconverged_from_s {
        None => format!("converged: positions are off by about {error}, as estimated{edge}"),
        Some(_) if convergence.error_m.is_infinite() => {
            "not converged: no run at another tolerance to compare with; choose another --tolerance"
                .to_owned()
        }
        Some(since) => format!(
            "not converged from {since:.4} s on: the exact transient may differ from there; positions are off by about {error}, as estimated{edge}; with a smaller --tolerance the run may converge"
        ),
    }
}

/// A line about a run, one about its convergence, and one about its perturbed runs.
pub fn run(rig: &Rig, judged: &Judged) -> Vec<String> {
    let lost = judged.band.as_ref().and_then(|_| lost(&judged.lost));
    let members = judged.band.as_ref().map(|_| {
        let Spacing { runs, relative } = judged.spacing;
        let members = if runs == 2 { "perturbed run" } else { "perturbed runs" };
        format!(
            "{} {members} whose mass and starting position differ by up to {relative:e} (of the mass, of the stroke)",
            runs - 1
        )
    });
    let first = [summary(rig, &judged.run), convergence(&judged.convergence)];
    first.into_iter().chain(members).chain(lost).collect()
}

/// One line about a run.
pub fn summary(rig: &Rig, run: &Run) -> String {
    let fault = run.fault.map_or(String::new(), |(fault, k)| {
        format!("; tripped at sample {k}: {} ({})", fault_name(fault), fault_meaning(fault.code()))
    });
    format!(
        "{}: {} samples of {} us, {} steps of the integrator{fault}",
        rig.name(),
        run.observations.len(),
        rig.period_us(),
        run.work.integrator.n_steps
    )
}

/// The failures among the perturbed runs of a run, if any.
pub fn lost(lost: &FailedMembers) -> Option<String> {
    let tripped = (!lost.tripped.is_empty()).then(|| {
        let mut names: Vec<&str> = lost.tripped.iter().map(|fault| fault_name(*fault)).collect();
        names.sort_unstable();
        names.dedup();
        format!("{} of them tripped: {}", lost.tripped.len(), names.join(", "))
    });
    let failed = lost.failed.first().map(|why| {
        format!(
            "{} of them cannot be simulated and are not in the ranges; the first: {why}",
            lost.failed.len()
        )
    });
    let both: Vec<String> = tripped.into_iter().chain(failed).collect();
    (!both.is_empty()).then(|| both.join("; "))
}

/// Names for a message: the first few of many.
pub fn few(names: &[&str]) -> String {
    match names {
        [first, second, third, _, more @ ..] => {
            format!("{first}, {second}, {third} and {} more", more.len() + 1)
        }
        names => names.join(", "),
    }
}

/// A small length in the unit that suits it.
fn length(metres: f64) -> String {
    match metres.abs() {
        size if size >= 1e-3 => format!("{:.3} mm", 1e3 * metres),
        size if size >= 1e-6 => format!("{:.2} um", 1e6 * metres),
        size if size >= 1e-9 => format!("{:.1} nm", 1e9 * metres),
        _ => format!("{:.2} nm", 1e9 * metres),
    }
}

/// A fault's name.
pub fn fault_name(fault: Fault) -> &'static str {
    match fault {
        Fault::Stop => "stop",
        Fault::PositionOutside => "position-outside",
        Fault::EncoderStep => "encoder-step",
        Fault::LateSample => "late-sample",
        Fault::HostSilent => "host-silent",
        Fault::CommandWhileDisarmed => "command-while-disarmed",
        Fault::SensorRange => "sensor-range",
        Fault::NoMotion => "no-motion",
        Fault::HomingFailed => "homing-failed",
        Fault::BadConfiguration => "bad-configuration",
        Fault::Watchdog => "watchdog",
        Fault::Panic => "panic",
        Fault::MotionAtNull => "motion-at-null",
        Fault::LateOutput => "late-output",
        Fault::ClockFailed => "clock-failed",
        Fault::WatchdogTried => "watchdog-tried",
        Fault::ModelAtBound => "model-at-bound",
        Fault::PressureDoubtful => "pressure-doubtful",
    }
}

/// The name of a fault code, including codes of later firmware.
pub fn fault_code_name(code: u8) -> String {
    Fault::from_code(code).map_or_else(|| format!("fault {code}"), |fault| fault_name(fault).to_owned())
}

/// The meaning of a fault.
pub fn fault_meaning(code: u8) -> &'static str {
    match Fault::from_code(code) {
        Some(Fault::Stop) => "a stop was requested",
        Some(Fault::PositionOutside) => "the position left the stroke by more than the margin",
        Some(Fault::EncoderStep) => "the encoder moved further in one sample than the drive can move",
        Some(Fault::LateSample) => "a sample came too late",
        Some(Fault::HostSilent) => "the host was silent for too long during a move or a homing run",
        Some(Fault::CommandWhileDisarmed) => "a run was requested while the drive was disarmed",
        Some(Fault::SensorRange) => "a pressure sensor reads out of range: it is open, or shorted",
        Some(Fault::NoMotion) => {
            "the valve is open and nothing moves: check for swapped tubes, the encoder, the spool, the supply"
        }
        Some(Fault::HomingFailed) => "the homing run found neither stop nor switch",
        Some(Fault::BadConfiguration) => "the stored configuration is damaged; load one and save it",
        Some(Fault::Watchdog) => "the watchdog has reset the board",
        Some(Fault::MotionAtNull) => {
            "the valve is at its null and the cylinder moves: check the spool (`pneudrive device valve`), the null offset, the amplifier"
        }
        Some(Fault::Panic) => "the firmware panicked and has reset the board",
        Some(Fault::LateOutput) => "an output came too late",
        Some(Fault::ClockFailed) => "the clock of the board's processor failed, and it has reset itself",
        Some(Fault::WatchdogTried) => {
            "the watchdog is tried: it is not fed, and must reset the board; arming the drive ends that"
        }
        Some(Fault::ModelAtBound) => {
            "what the law has learned of the drive is at its bound: mass, standing force or valve are not what the rig file says"
        }
        Some(Fault::PressureDoubtful) => {
            "the pressures contradict valve and motion: check the pressure sensors, their range, and whether they are swapped"
        }
        None => "a fault unknown to this version",
    }
}

/// Why the rig refused a request that it accepts in another state, by the code of its refusal, and the remedy.
fn not_now(of: u8) -> String {
    match Refusal::from_code(of) {
        Some(Refusal::NotArmed) => {
            "the drive is not armed; arm it first (`pneudrive device arm`)".to_owned()
        }
        Some(Refusal::Running) => {
            "a run is in progress; wait for its end, or stop it (`pneudrive device stop`)".to_owned()
        }
        Some(Refusal::NotReferenced) => {
            "the axis is not referenced, so closed loop is refused (`pneudrive device reference COUNTS`, or `pneudrive device home`)"
                .to_owned()
        }
        Some(Refusal::NotDisarmed) => {
            "the drive is enabled; disarm it first (`pneudrive device disarm`)".to_owned()
        }
        Some(Refusal::ValveNotAtNull) => {
            "the spool is still moving to mid-travel; try again in a moment".to_owned()
        }
        Some(Refusal::BeyondSoftLimit) => {
            "a setpoint lies beyond a soft limit (end_min_counts, end_max_counts)".to_owned()
        }
        Some(Refusal::NoConfiguration) => {
            "the stored configuration is damaged; load one (`pneudrive device config import RIG`) and save it (`pneudrive device config save`)".to_owned()
        }
        Some(Refusal::SpoolInDoubt) => {
            "the spool of the stepper valve was open at a reset; walk it back (`pneudrive device valve seek-null`), or set it to its null and say so (`pneudrive device valve at-null`)".to_owned()
        }
        Some(Refusal::SpoolLost) => {
            "since a reset it is not known where the spool of the stepper valve is; set it to its null and say so (`pneudrive device valve at-null`)".to_owned()
        }
        Some(Refusal::NoCode) => {
            "the board's converter has no code for the largest command; set max_command_counts (operator.max_command_counts of the rig file) to at most null_code and at most 4095 - null_code: 2047 for a null code of 2048".to_owned()
        }
        Some(Refusal::NoMoves) => "no test has been downloaded (`pneudrive run`)".to_owned(),
        None if of == code::TOKEN => {
            "it asks for a token; set PNEUDRIVE_TOKEN to the token that the rig was started with".to_owned()
        }
        None if of == code::HOST_WAS_SILENT => {
            "the drive had not heard from this program for longer than safety.host_silence_s, so it does not move; run again".to_owned()
        }
        None if of == code::INPUTS_ARE_PINS => {
            "the digital inputs of this board are pins; only a rig without pins takes them from a program".to_owned()
        }
        None if of == code::NO_WATCHDOG => "this board has no watchdog".to_owned(),
        None if of == code::IN_FAULT => {
            "the drive is in a fault; clear it first (`pneudrive device arm`, then `disarm`)".to_owned()
        }
        None if of == code::OWNED => "another host commands the drive".to_owned(),
        None => format!("refused for a reason unknown to this version (code {of})"),
    }
}

/// Why the rig refused, and the remedy.
pub fn refusal(refused: &RequestRefusal<'_>) -> String {
    match refused {
        RequestRefusal::NotNow(of) => not_now(*of),
        RequestRefusal::UnknownParameter { id } => format!("the firmware has no parameter {id}"),
        RequestRefusal::OutOfRange { id, value } => out_of_range(*id, *value),
        RequestRefusal::Inconsistent { advice } => {
            format!("the parameters are inconsistent: {}", sanitised(advice, SENTENCE))
        }
        RequestRefusal::TestTooLong => "the test is too long".to_owned(),
        RequestRefusal::MovesOutOfOrder => "the moves are not in order of time".to_owned(),
        RequestRefusal::TooManyMoves => "the test has more moves than the firmware holds".to_owned(),
        RequestRefusal::NoRecord => {
            "nothing has been recorded; run a test first (`pneudrive run`)".to_owned()
        }
        RequestRefusal::RecordRange { samples } => format!("the record has only {samples} samples"),
        RequestRefusal::NotStored => "the board could not write its flash".to_owned(),
        RequestRefusal::OtherRecord => "its record has changed; record again".to_owned(),
        RequestRefusal::Owned(owner) => owned(owner.presence, owner.host, owner.silent_ms),
        RequestRefusal::ChangeNotWhole => "a part of what was sent is missing; try again".to_owned(),
        RequestRefusal::OtherTest => {
            "another program has sent another test, or changed the parameters; run again".to_owned()
        }
        RequestRefusal::OtherBoot { number } => {
            let now = match *number {
                NO_BOOT => "it no longer counts its boots".to_owned(),
                number => format!("boot {number} now"),
            };
            format!(
                "the rig was reset since this program connected ({now}), and refuses requests from before the reset; run again"
            )
        }
        RequestRefusal::Unknown => {
            "the firmware does not know this request; flash the firmware that belongs to this program"
                .to_owned()
        }
    }
}

/// What the firmware of a rig lacks that cannot tell its boots apart.
pub fn no_boots() -> &'static str {
    "the rig does not tell its boots apart: a duplicate of a request that the link delays past a reset can still arm and move the drive; its flash does not store their number; check the board"
}

/// The owner of the drive, and the options of another host.
pub fn owned(presence: Presence, host: &str, silent_ms: u32) -> String {
    let host = sanitised(host, NAME);
    match presence {
        Presence::There => format!(
            "{host} commands the drive and was heard {:.2} s ago; wait until it has ended, or stop the drive (`pneudrive device stop`)",
            f64::from(silent_ms) / 1e3
        ),
        Presence::Gone => {
            format!("{host} armed the drive and has gone; disarm it first (`pneudrive device disarm`)")
        }
        Presence::Nobody => "no host commands the drive any more; try again".to_owned(),
    }
}

fn out_of_range(id: u16, value: i32) -> String {
    match Written::of(id) {
        Some(written) => {
            format!("{} = {} is out of range: {}", written.name, written.text(value), written.range())
        }
        None => format!("parameter {id} = {value} is out of range"),
    }
}
