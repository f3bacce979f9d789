//! Requests, carried out one by one: what each does, and what is answered.

use core::borrow::BorrowMut;

use pneudrive_controller::parameters::SetError;
use pneudrive_controller::sequencer::SequenceError;
use pneudrive_controller::{Mode, Move};
use pneudrive_protocol::session::OLD_HOSTS;
use pneudrive_protocol::{
    CURRENT_VERSION, InBoot, InSession, MIN_VERSION, Owner, Refused, ReplyBody, RequestBody, UNTIL_STOPPED,
    code,
};

use super::answers::{chunk, config, config_state, digest, events, motion, record_info, status};
use super::{FIRMWARE, Scratch, Talk};
use crate::board::Board;
use crate::change::{NotWhole, Parts};
use crate::control::{ChangeError, Control, MoveError, SaveRefused, TakeError, Test};
use crate::ownership::Need;
use crate::recorder::{CAPACITY, Recorder};
use crate::repetition::counts_in_any_boot;
use crate::store::Store;

/// Carries out a request, unless it was meant for another boot, or another host commands the drive.
pub(super) fn carry_out<'a, B: Board>(
    meant: &InBoot<'a>,
    control: &'a mut Control<impl BorrowMut<Recorder>>,
    board: &'a mut B,
    damaged_frames: u32,
    talk: &mut Talk,
    scratch: &'a mut Scratch,
) -> ReplyBody<'a> {
    let InBoot { asked: InSession { request, session }, .. } = *meant;
    let boot = board.store().boot();
    if !(meant.counts_in(boot) || counts_in_any_boot(&request.body)) {
        return ReplyBody::Refused(Refused::OtherBoot { number: boot });
    }
    if !control.allows(session, Need::of(&request.body), board) {
        return ReplyBody::Refused(owned(session, control.owner(board)));
    }
    match request.body {
        RequestBody::Info => ReplyBody::Info {
            min_version: MIN_VERSION,
            version: CURRENT_VERSION,
            firmware: FIRMWARE,
            build: board.build(),
            board: board.name(),
            record_capacity: CAPACITY as u32,
        },
        RequestBody::Status => ReplyBody::Status(status(control, damaged_frames)),
        RequestBody::ConfigGet { first_id, count } => config(control, first_id, count, scratch),
        RequestBody::ConfigSet { first_id, values } => {
            done(control.set_parameters(first_id, values.iter()).map_err(|(id, error)| {
                let place = usize::from(id.saturating_sub(first_id));
                change_refused(id, values.iter().nth(place).unwrap_or(0), error)
            }))
        }
        // A host that has a session arms by `ArmAs`: this is something else that reads as it, such as an echo.
        RequestBody::Arm if session != OLD_HOSTS => ReplyBody::Refused(Refused::Unknown),
        RequestBody::Arm => done(control.arm_as(session, "", board).map_err(not_now)),
        RequestBody::ArmAs { host } => done(control.arm_as(session, host, board).map_err(not_now)),
        RequestBody::TakeOver { host } => done(control.take_over(session, host, board).map_err(not_now)),
        RequestBody::Leave => {
            control.host_leaves(session);
            ReplyBody::Done
        }
        RequestBody::Token { .. } => ReplyBody::Done,
        RequestBody::Boot => ReplyBody::Boot { number: boot },
        RequestBody::Owner => ReplyBody::Owner(control.owner(board)),
        RequestBody::Disarm => {
            control.disarm();
            ReplyBody::Done
        }
        RequestBody::Start | RequestBody::StartTest { .. } | RequestBody::Home
            if control.owner_was_silent() =>
        {
            ReplyBody::Refused(Refused::NotNow(code::HOST_WAS_SILENT))
        }
        RequestBody::Start if others_test(control, |test| test.is_by(session)) => {
            ReplyBody::Refused(other_test(session))
        }
        RequestBody::StartTest { crc32 } if others_test(control, |_| control.is_named(crc32)) => {
            ReplyBody::Refused(Refused::OtherTest)
        }
        RequestBody::Start | RequestBody::StartTest { .. } => done(control.start(board).map_err(not_now)),
        RequestBody::Stop => {
            control.stop();
            ReplyBody::Done
        }
        RequestBody::Reference { position_counts } => {
            done(control.reference(position_counts).map_err(not_now))
        }
        RequestBody::TestBegin { name, duration_us, decimation, pre_trigger } => {
            let last_sample = duration_us / control.config().timing.period_us;
            let test = Test::new(name, last_sample, decimation, pre_trigger).by(session);
            done(control.set_test(test).map_err(not_now))
        }
        RequestBody::TestMove { .. } | RequestBody::TestSpan { .. } if !control.test().is_by(session) => {
            ReplyBody::Refused(other_test(session))
        }
        RequestBody::TestMove { time_us, target } => {
            let next = Move::at_time_us(time_us, control.config().timing.period_us, target);
            done(control.push_move(next).map_err(move_refused))
        }
        RequestBody::TestSpan { last_sample, .. } if last_sample > UNTIL_STOPPED => {
            ReplyBody::Refused(Refused::TestTooLong)
        }
        RequestBody::TestSpan { last_sample, round } => {
            done(control.set_span(last_sample, round).map_err(move_refused))
        }
        RequestBody::ChangePart { crc32, first, part } => {
            done(talk.change.add(crc32, first, part).map_err(|NotWhole| Refused::ChangeNotWhole))
        }
        RequestBody::ChangeTake { crc32 } => take(control, &mut talk.change, crc32),
        RequestBody::Home => done(control.home(board).map_err(not_now)),
        RequestBody::SeekNull => done(control.seek_null().map_err(not_now)),
        RequestBody::AtNull => done(control.at_null(board).map_err(not_now)),
        RequestBody::Motion => ReplyBody::Motion(motion(control)),
        RequestBody::ConfigSave => done(control.save_parameters(board).map_err(|refused| match refused {
            SaveRefused::NotNow(refusal) => not_now(refusal),
            SaveRefused::NotStored => Refused::NotStored,
        })),
        RequestBody::ConfigState => ReplyBody::ConfigState(config_state(control.configuration())),
        RequestBody::Events { first, count } => events(board.store(), first, count, scratch),
        RequestBody::Timing => {
            let [interval, latency] = control.timing();
            ReplyBody::Timing { interval, latency }
        }
        RequestBody::RecordInfo => record_info(control),
        RequestBody::RecordRead { first, count } => chunk(control, first, count, scratch),
        RequestBody::RecordChunk { crc32, first, count } => match digest(control, 0) {
            Some(crc) if crc == crc32 => chunk(control, first, count, scratch),
            _ => ReplyBody::Refused(Refused::OtherRecord),
        },
        RequestBody::StreamBegin { every, batch } => {
            talk.stream.begin(request.sequence, every, batch);
            ReplyBody::Done
        }
        RequestBody::StreamGrant { until } => {
            talk.stream.grant(until);
            ReplyBody::Done
        }
        RequestBody::StreamRead { first, count } => talk.stream.read(first, count, scratch),
    }
}

/// Who commands the drive, in words that the host of this session knows.
fn owned(session: u32, owner: Owner<'_>) -> Refused<'_> {
    if session == OLD_HOSTS { Refused::NotNow(code::OWNED) } else { Refused::Owned(owner) }
}

/// Whether an armed drive has a test to run, and it is not the one that is meant.
fn others_test<R: BorrowMut<Recorder>>(control: &Control<R>, is_meant: impl Fn(&Test) -> bool) -> bool {
    let (mode, test) = (control.state().supervisor.mode(), control.test());
    mode == Mode::Armed && !test.sequence().moves().is_empty() && !is_meant(test)
}

/// The test is another host's, in words that the host of this session knows.
fn other_test<'a>(session: u32) -> Refused<'a> {
    if session == OLD_HOSTS { Refused::NotNow(code::OTHER_TEST) } else { Refused::OtherTest }
}

/// Takes the change whose parts have come, and forgets them.
fn take<'a>(control: &mut Control<impl BorrowMut<Recorder>>, parts: &mut Parts, crc32: u32) -> ReplyBody<'a> {
    let taken = match parts.whole(crc32) {
        Ok(change) => control.take_change(change).map_err(take_refused),
        Err(NotWhole) => Err(Refused::ChangeNotWhole),
    };
    if taken.is_ok() {
        parts.clear();
    }
    done(taken)
}

fn take_refused<'a>(error: TakeError) -> Refused<'a> {
    match error {
        TakeError::Refused(refusal) => not_now(refusal),
        TakeError::Value { id, value, error } => change_refused(id, value, ChangeError::Value(error)),
        TakeError::Inconsistent(error) => Refused::Inconsistent { advice: error.advice() },
        TakeError::Sequence(error) => move_refused(MoveError::Sequence(error)),
        TakeError::TooLong => Refused::TestTooLong,
        TakeError::Malformed => Refused::Unknown,
    }
}

fn done<'a>(result: Result<(), Refused<'a>>) -> ReplyBody<'a> {
    match result {
        Ok(()) => ReplyBody::Done,
        Err(refused) => ReplyBody::Refused(refused),
    }
}

fn not_now<'a>(refusal: pneudrive_controller::Refusal) -> Refused<'a> {
    Refused::NotNow(refusal.code())
}

fn move_refused<'a>(error: MoveError) -> Refused<'a> {
    match error {
        MoveError::Refused(refusal) => not_now(refusal),
        MoveError::Sequence(SequenceError::Full) => Refused::TooManyMoves,
        MoveError::Sequence(SequenceError::OutOfOrder) => Refused::MovesOutOfOrder,
    }
}

fn change_refused<'a>(id: u16, value: i32, error: ChangeError) -> Refused<'a> {
    match error {
        ChangeError::Refused(refusal) => not_now(refusal),
        ChangeError::Value(SetError::UnknownId) => Refused::UnknownParameter { id },
        ChangeError::Value(SetError::OutOfRange) => Refused::OutOfRange { id, value },
        ChangeError::Inconsistent(error) => Refused::Inconsistent { advice: error.advice() },
    }
}
