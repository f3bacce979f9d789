//! The reports of a drive about itself.

use core::borrow::{Borrow, BorrowMut};

use pneudrive_controller::sequencer::Arrival;
use pneudrive_controller::{Mode, Parameters};
use pneudrive_protocol::{
    self as protocol, CHUNK_SAMPLES, ConfigState, Event, MAX_EVENTS, MAX_TOLD_MOVES, MAX_VALUES, Motion,
    Owner, ProfiledMove, RecordInfo, RecordedSample, ReplyBody, RequestRefusal, Status, VERSION, Values,
};

use super::{FIRMWARE, Scratch};
use crate::board::Board;
use crate::configuration::{Configuration, Source};
use crate::control::Control;
use crate::moves::told;
use crate::recorder::{CAPACITY, Recorder};
use crate::shared_drive::SharedDrive;
use crate::store::Store;

pub(super) fn status(control: &Control<impl BorrowMut<Recorder>>, damaged_frames: u32) -> Status {
    let (state, seen) = (control.state(), control.state().observation());
    let (mode, fault) = match state.supervisor.mode() {
        Mode::Disarmed => (protocol::Mode::Disarmed, 0),
        Mode::Armed => (protocol::Mode::Armed, 0),
        Mode::Homing => (protocol::Mode::Homing, 0),
        Mode::Running => (protocol::Mode::Running, 0),
        Mode::Done => (protocol::Mode::Done, 0),
        Mode::Fault(fault) => (protocol::Mode::Fault, fault.code()),
    };
    Status {
        mode,
        fault,
        referenced: state.supervisor.is_referenced(),
        index: seen.index,
        duration_samples: control.test().sequence().duration_samples,
        setpoint: seen.setpoint,
        position: seen.position,
        error: seen.error,
        command: seen.command,
        pressure_1: seen.pressure_1,
        pressure_2: seen.pressure_2,
        spool: seen.spool,
        recorded: control.recorder.borrow().len() as u32,
        damaged_frames,
    }
}

pub(super) fn motion(control: &Control<impl BorrowMut<Recorder>>) -> Motion {
    let (state, moves) = (control.state(), control.state().sequencer());
    Motion {
        arrival: match moves.arrival() {
            _ if state.rests_outside(control.configuration().config()) => 4,
            Arrival::Idle => 0,
            Arrival::Moving => 1,
            Arrival::Arrived => 2,
            Arrival::NotReached => 3,
        },
        begun: u16::try_from(moves.begun(control.test().sequence())).unwrap_or(u16::MAX),
        not_reached: moves.not_reached(),
        learned_null_offset: state.learned_null_offset(),
    }
}

pub(super) fn config_state(configuration: &Configuration) -> ConfigState {
    ConfigState {
        source: match configuration.source() {
            Source::NeverSaved => 0,
            Source::Stored => 1,
            Source::TakenOver => 2,
            Source::Damaged => 3,
        },
        saves: configuration.saves(),
        hash: configuration.hash(),
        saved: configuration.is_saved(),
        ignored: configuration.ignored(),
    }
}

/// A copy of the owner with its name in this buffer: the drive is no longer locked when the reply is framed.
pub(super) fn kept<'a>(owner: Owner<'_>, room: &'a mut Scratch) -> Owner<'a> {
    let Owner { presence, session, silent_ms, host } = owner;
    Owner { presence, session, silent_ms, host: kept_text(host, room) }
}

/// A text in this room; empty if it does not fit.
#[inline(never)]
fn kept_text<'a>(text: &str, room: &'a mut Scratch) -> &'a str {
    let Some(room) = room.get_mut(..text.len()) else { return "" };
    room.copy_from_slice(text.as_bytes());
    core::str::from_utf8(room).unwrap_or("")
}

pub(super) fn info<'a>(board: &impl Board, room: &'a mut Scratch) -> ReplyBody<'a> {
    ReplyBody::Info {
        version: VERSION,
        firmware: FIRMWARE,
        build: board.build(),
        board: kept_text(board.name(), room),
        record_capacity: CAPACITY as u32,
    }
}

pub(super) fn events<'a>(
    drive: &mut impl SharedDrive,
    first: u8,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let wanted = usize::from(count).min(MAX_EVENTS);
    let (total, events) = drive.lock(|_, board| {
        let (store, first) = (board.store(), usize::from(first));
        let nth = |nth| if nth < wanted { store.event(first + nth) } else { None };
        (store.events(), core::array::from_fn::<_, MAX_EVENTS, _>(nth))
    });
    let mut bytes = 0;
    for (slot, event) in room.chunks_exact_mut(Event::BYTES).zip(events.iter().flatten()) {
        slot.copy_from_slice(&event.to_bytes());
        bytes += Event::BYTES;
    }
    ReplyBody::Events { total: total as u8, first, events: room.get(..bytes).unwrap_or(&[]) }
}

/// Values that are read in one piece.
const VALUES_AT_ONCE: usize = 16;

pub(super) fn config<'a>(
    drive: &mut impl SharedDrive,
    first_id: u16,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let end = first_id.saturating_add(usize::from(count).min(MAX_VALUES) as u16);
    let slots = room.as_chunks_mut().0.get_mut(..usize::from(end - first_id)).unwrap_or_default();
    for (first, slots) in (first_id..).step_by(VALUES_AT_ONCE).zip(slots.chunks_mut(VALUES_AT_ONCE)) {
        if let Err(id) = drive.lock(|control, _| read(control.parameters(), first, slots)) {
            return ReplyBody::Refused(RequestRefusal::UnknownParameter { id });
        }
    }
    let bytes = room.get(..4 * usize::from(end - first_id));
    match bytes.and_then(Values::new) {
        Some(values) => ReplyBody::Config { first_id, values },
        None => ReplyBody::Refused(RequestRefusal::UnknownParameter { id: first_id }),
    }
}

/// Reads values of consecutive ids, or returns the first id that does not exist.
fn read(parameters: &Parameters, first_id: u16, slots: &mut [[u8; 4]]) -> Result<(), u16> {
    for (slot, id) in slots.iter_mut().zip(first_id..) {
        *slot = parameters.get(id).ok_or(id)?.to_le_bytes();
    }
    Ok(())
}

/// Samples that one `RecordInfo` takes into the CRC of the record; the host asks until all are in. A drive
/// that holds its last setpoint goes on sampling meanwhile, and a request must not make a sample late.
const DIGEST_AT_ONCE: usize = 64;

/// Samples taken into the CRC between two control samples, so that it is mostly ready when it is requested.
pub(super) const DIGEST_BETWEEN: usize = 8;

/// Continues the CRC of a finished record, and returns it once it is there.
pub(super) fn digest(control: &mut Control<impl BorrowMut<Recorder>>, samples: usize) -> Option<u32> {
    let over = !matches!(control.state().supervisor.mode(), Mode::Armed | Mode::Running);
    if over { control.recorder.borrow_mut().digest(samples) } else { None }
}

pub(super) fn record_info<'a>(drive: &mut impl SharedDrive, room: &'a mut Scratch) -> ReplyBody<'a> {
    for _ in 0..DIGEST_AT_ONCE / DIGEST_BETWEEN {
        drive.lock(|control, _| digest(control, DIGEST_BETWEEN));
    }
    drive.lock(|control, _| {
        let crc = digest(control, 0);
        let measured_period_ns = control.measured_period_ns();
        let recorder: &Recorder = control.recorder.borrow();
        ReplyBody::RecordInfo(RecordInfo {
            test: kept_text(control.test().name(), room),
            samples: recorder.len() as u32,
            first_index: recorder.first_index(),
            decimation: recorder.decimation() as u16,
            pre_trigger: recorder.pre_trigger(),
            complete: crc.is_some(),
            measured_period_ns,
            mean_spool_raw: recorder.mean_spool(),
            crc32: crc.unwrap_or(0),
        })
    })
}

/// The test, and its moves from `first` on, as many as a message carries.
pub(super) fn test<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let sequence = control.test().sequence();
    let moves = sequence.moves();
    let wanted = moves.get(first.into()..).unwrap_or(&[]);
    ReplyBody::Test {
        last_sample: sequence.duration_samples,
        round: sequence.round(),
        total: moves.len() as u8,
        first,
        moves: written(wanted.iter().map(told), room),
    }
}

/// The move records from a number on, as many as a message carries.
pub(super) fn move_records<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let records = control.configuration().records().from(first);
    ReplyBody::MoveRecords { first, records: written(records.iter().copied(), room) }
}

/// Moves as they travel, as many as a message carries.
fn written(moves: impl Iterator<Item = ProfiledMove>, room: &mut [u8]) -> &[u8] {
    let mut bytes = 0;
    for (slot, next) in room.chunks_exact_mut(ProfiledMove::BYTES).zip(moves.take(MAX_TOLD_MOVES)) {
        slot.copy_from_slice(&next.to_bytes());
        bytes += ProfiledMove::BYTES;
    }
    room.get(..bytes).unwrap_or(&[])
}

pub(super) fn chunk<'a>(
    drive: &mut impl SharedDrive,
    first: u32,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    drive.lock(|control, _| {
        let recorder: &Recorder = control.recorder.borrow();
        if recorder.is_empty() {
            return ReplyBody::Refused(RequestRefusal::NoRecord);
        }
        let samples = recorder.len() as u32;
        let end = first.saturating_add(u32::from(count).min(CHUNK_SAMPLES as u32));
        if count == 0 || end > samples {
            return ReplyBody::Refused(RequestRefusal::RecordRange { samples });
        }
        let mut bytes = 0;
        for (slot, i) in room.chunks_exact_mut(RecordedSample::BYTES).zip(first..end) {
            if let Some(stored) = recorder.get(i as usize) {
                slot.copy_from_slice(stored);
                bytes += RecordedSample::BYTES;
            }
        }
        ReplyBody::Chunk { first, samples: room.get(..bytes).unwrap_or(&[]) }
    })
}
