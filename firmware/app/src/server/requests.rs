//! Carries out requests one by one: the effect of each, and its answer.

use core::borrow::BorrowMut;

use pneudrive_controller::parameters::SetError;
use pneudrive_controller::sequencer::SequenceError;
use pneudrive_controller::{Fault, Mode, Refusal};
use pneudrive_protocol::{ReplyBody, Request, RequestBody, RequestRefusal, Values, code};

use super::answers::{
    chunk, config, config_state, digest, events, info, kept, motion, move_records, record_info, status, test,
};
use super::{Scratch, Talk};
use crate::board::Board;
use crate::change::{NotWhole, Parts};
use crate::control::{ChangeError, Control, SaveRefusal, TakeError};
use crate::duplicate_filter::counts_in_any_boot;
use crate::ownership::{Need, Requester};
use crate::recorder::Recorder;
use crate::shared_drive::{SharedDrive, with_learned};
use crate::store::Store;

/// Carries out a request, unless it was meant for another boot, or another host commands the drive.
pub(super) fn carry_out<'a>(
    request: &Request<'a>,
    drive: &mut impl SharedDrive,
    damaged_frames: u32,
    talk: &mut Talk,
    scratch: &'a mut Scratch,
) -> ReplyBody<'a> {
    let Request { sequence, session, body, .. } = *request;
    let by = |host| Requester { session, host, sequence: Some(sequence) };
    match drive.lock(|control, board| admission(request, control, board)) {
        Admission::OtherBoot { number } => return ReplyBody::Refused(RequestRefusal::OtherBoot { number }),
        Admission::Owned => {
            return drive.lock(|control, board| {
                ReplyBody::Refused(RequestRefusal::Owned(kept(control.owner(board), scratch)))
            });
        }
        Admission::Granted => {}
    }
    match body {
        RequestBody::Info => drive.lock(|_, board| info(board, scratch)),
        RequestBody::Status => drive.lock(|control, _| ReplyBody::Status(status(control, damaged_frames))),
        RequestBody::ConfigGet { first_id, count } => config(drive, first_id, count, scratch),
        RequestBody::ConfigSet { first_id, values } => {
            drive.lock(|control, _| set(control, first_id, values))
        }
        RequestBody::Arm { host } => arm(drive, &by(host)),
        RequestBody::TakeOver { host } => {
            drive.lock(|control, board| done(control.take_over(&by(host), board).map_err(not_now)))
        }
        RequestBody::Leave => drive.lock(|control, _| {
            control.host_leaves(session);
            ReplyBody::Done
        }),
        RequestBody::Token { .. } => ReplyBody::Done,
        RequestBody::Boot => drive.lock(|_, board| ReplyBody::Boot { number: board.store().boot() }),
        RequestBody::Owner => {
            drive.lock(|control, board| ReplyBody::Owner(kept(control.owner(board), scratch)))
        }
        RequestBody::Disarm => drive.lock(|control, _| {
            control.disarm();
            ReplyBody::Done
        }),
        RequestBody::Start { crc32 } => drive.lock(|control, board| done(start(control, board, crc32))),
        RequestBody::Stop => drive.lock(|control, _| {
            control.stop();
            ReplyBody::Done
        }),
        RequestBody::Reference { position_counts } => {
            drive.lock(|control, _| done(control.reference(position_counts).map_err(not_now)))
        }
        RequestBody::ChangePart { crc32, first, part } => {
            done(talk.change.add(crc32, first, part).map_err(|NotWhole| RequestRefusal::ChangeNotWhole))
        }
        RequestBody::ChangeTake { crc32 } => take(drive, &mut talk.change, crc32),
        RequestBody::Home => drive.lock(|control, board| done(home(control, board))),
        RequestBody::SeekNull => drive.lock(|control, _| done(control.seek_null().map_err(not_now))),
        RequestBody::AtNull => drive.lock(|control, board| done(control.at_null(board).map_err(not_now))),
        RequestBody::Motion => drive.lock(|control, _| ReplyBody::Motion(motion(control))),
        RequestBody::ConfigSave => drive.lock(|control, board| done(save(control, board))),
        RequestBody::ConfigState => {
            drive.lock(|control, _| ReplyBody::ConfigState(config_state(control.configuration())))
        }
        RequestBody::Events { first, count } => events(drive, first, count, scratch),
        RequestBody::Timing => drive.lock(|control, _| {
            let [interval, latency] = control.timing();
            ReplyBody::Timing { interval, latency }
        }),
        RequestBody::TestRead { first } => drive.lock(|control, _| test(control, first, scratch)),
        RequestBody::MoveRecordsRead { first } => {
            drive.lock(|control, _| move_records(control, first, scratch))
        }
        RequestBody::Io => drive.lock(|control, _| {
            let seen = control.selector();
            let [inputs, settled] = [seen.inputs(), seen.settled()];
            let [outputs, number, refused] = [seen.outputs(), seen.number(), seen.refused()];
            ReplyBody::Io { inputs, settled, outputs, number, refused }
        }),
        RequestBody::IoSet { inputs } => drive.lock(|_, board| match board.emulate_inputs(inputs) {
            true => ReplyBody::Done,
            false => ReplyBody::Refused(RequestRefusal::NotNow(code::INPUTS_ARE_PINS)),
        }),
        RequestBody::TryWatchdog => drive.lock(|control, board| done(try_watchdog(control, board))),
        RequestBody::RecordInfo => record_info(drive, scratch),
        RequestBody::RecordRead { crc32, first, count } => {
            match drive.lock(|control, _| digest(control, 0)) {
                Some(crc) if crc == crc32 => chunk(drive, first, count, scratch),
                _ => ReplyBody::Refused(RequestRefusal::OtherRecord),
            }
        }
        RequestBody::StreamBegin { every, batch } => {
            talk.stream.begin(sequence, every, batch);
            ReplyBody::Done
        }
        RequestBody::StreamGrant { until } => {
            talk.stream.grant(until);
            ReplyBody::Done
        }
        RequestBody::StreamRead { first, count } => talk.stream.read(first, count, scratch),
    }
}

/// Whether a request may be carried out.
enum Admission {
    Granted,
    /// It was meant for another boot than this one.
    OtherBoot {
        number: u32,
    },
    /// Another host commands the drive.
    Owned,
}

fn admission<R: BorrowMut<Recorder>>(
    request: &Request<'_>,
    control: &Control<R>,
    board: &mut impl Board,
) -> Admission {
    let number = board.store().boot();
    if !(request.boot == number || counts_in_any_boot(&request.body)) {
        return Admission::OtherBoot { number };
    }
    match control.allows(request.session, Need::of(&request.body), board) {
        true => Admission::Granted,
        false => Admission::Owned,
    }
}

/// Arms. The learned null offset of the last run is prepared while the control goes on: a holding drive may be armed
/// again.
fn arm<'a>(drive: &mut impl SharedDrive, by: &Requester<'_>) -> ReplyBody<'a> {
    with_learned(drive, |control, learned, board| done(control.arm_with(learned, by, board).map_err(not_now)))
}

/// Starts, unless the drive is armed with another test than the one that is named, or has other parameters.
fn start<'a>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut impl Board,
    crc32: u32,
) -> Result<(), RequestRefusal<'a>> {
    must_not_have_lapsed(control)?;
    let (mode, test) = (control.state().supervisor.mode(), control.test());
    if mode == Mode::Armed && !test.sequence().moves().is_empty() && !control.is_named(crc32) {
        return Err(RequestRefusal::OtherTest);
    }
    control.start(board).map_err(not_now)
}

fn home<'a>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut impl Board,
) -> Result<(), RequestRefusal<'a>> {
    must_not_have_lapsed(control)?;
    control.home(board).map_err(not_now)
}

fn try_watchdog<'a>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &impl Board,
) -> Result<(), RequestRefusal<'a>> {
    match control.state().supervisor.mode() {
        _ if !board.has_watchdog() => Err(RequestRefusal::NotNow(code::NO_WATCHDOG)),
        Mode::Disarmed => {
            control.trip(Fault::WatchdogTried);
            Ok(())
        }
        Mode::Fault(_) => Err(RequestRefusal::NotNow(code::IN_FAULT)),
        _ => Err(not_now(Refusal::NotDisarmed)),
    }
}

fn must_not_have_lapsed<'a, R: BorrowMut<Recorder>>(control: &Control<R>) -> Result<(), RequestRefusal<'a>> {
    if control.owner_was_silent() { Err(RequestRefusal::NotNow(code::HOST_WAS_SILENT)) } else { Ok(()) }
}

fn set<'a>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    first_id: u16,
    values: Values<'_>,
) -> ReplyBody<'a> {
    done(control.set_parameters(first_id, values.iter()).map_err(|(id, error)| {
        let place = usize::from(id.saturating_sub(first_id));
        change_refused(id, values.iter().nth(place).unwrap_or(0), error)
    }))
}

fn save<'a>(
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut impl Board,
) -> Result<(), RequestRefusal<'a>> {
    control.save_parameters(board).map_err(|refused| match refused {
        SaveRefusal::NotNow(refusal) => not_now(refusal),
        SaveRefusal::NotStored => RequestRefusal::NotStored,
    })
}

/// Takes the change whose parts have come, and forgets them.
fn take<'a>(drive: &mut impl SharedDrive, parts: &mut Parts, crc32: u32) -> ReplyBody<'a> {
    let taken = match parts.whole(crc32) {
        Ok(change) => drive.lock(|control, _| control.take_change(change).map_err(take_refused)),
        Err(NotWhole) => Err(RequestRefusal::ChangeNotWhole),
    };
    if taken.is_ok() {
        parts.clear();
    }
    done(taken)
}

fn take_refused<'a>(error: TakeError) -> RequestRefusal<'a> {
    match error {
        TakeError::Refused(refusal) => not_now(refusal),
        TakeError::Value { id, value, error } => change_refused(id, value, ChangeError::Value(error)),
        TakeError::Inconsistent(error) => RequestRefusal::Inconsistent { advice: error.advice() },
        TakeError::Sequence(SequenceError::Full) => RequestRefusal::TooManyMoves,
        TakeError::Sequence(SequenceError::OutOfOrder) => RequestRefusal::MovesOutOfOrder,
        TakeError::TooLong => RequestRefusal::TestTooLong,
        TakeError::Malformed => RequestRefusal::Unknown,
    }
}

fn done<'a>(result: Result<(), RequestRefusal<'a>>) -> ReplyBody<'a> {
    match result {
        Ok(()) => ReplyBody::Done,
        Err(refused) => ReplyBody::Refused(refused),
    }
}

fn not_now<'a>(refusal: Refusal) -> RequestRefusal<'a> {
    RequestRefusal::NotNow(refusal.code())
}

fn change_refused<'a>(id: u16, value: i32, error: ChangeError) -> RequestRefusal<'a> {
    match error {
        ChangeError::Refused(refusal) => not_now(refusal),
        ChangeError::Value(SetError::UnknownId) => RequestRefusal::UnknownParameter { id },
        ChangeError::Value(SetError::OutOfRange) => RequestRefusal::OutOfRange { id, value },
        ChangeError::Inconsistent(error) => RequestRefusal::Inconsistent { advice: error.advice() },
    }
}
