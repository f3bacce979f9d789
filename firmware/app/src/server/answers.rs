//! What a drive tells of itself.

use core::borrow::BorrowMut;

use pneudrive_controller::Mode;
use pneudrive_controller::sequencer::Arrival;
use pneudrive_protocol::{
    self as protocol, CHUNK_SAMPLES, ConfigState, Event, MAX_EVENTS, MAX_VALUES, Motion, RecordInfo,
    RecordedSample, Refused, ReplyBody, Status, Values,
};

use crate::configuration::{Configuration, Source};
use crate::control::Control;
use crate::recorder::Recorder;
use crate::store::Store;

pub(super) fn status(control: &Control<impl BorrowMut<Recorder>>, damaged_frames: u32) -> Status {
    let (state, seen) = (control.state(), control.state().observation());
    let (mode, fault) = match state.supervisor.mode() {
        Mode::Disarmed => (protocol::Mode::Disarmed, 0),
        Mode::Armed => (protocol::Mode::Armed, 0),
        Mode::Running => (protocol::Mode::Running, 0),
        Mode::Done => (protocol::Mode::Done, 0),
        // Version 1 has no word for it; `Motion` of version 2 has.
        Mode::Homing => (protocol::Mode::Running, 0),
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
        homing: state.supervisor.mode() == Mode::Homing,
        arrival: match moves.arrival() {
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

pub(super) fn events<'a>(store: &impl Store, first: u8, count: u8, room: &'a mut [u8]) -> ReplyBody<'a> {
    let total = store.events();
    let wanted = usize::from(first)..usize::from(first) + usize::from(count).min(MAX_EVENTS);
    let mut bytes = 0;
    for (slot, event) in room.chunks_exact_mut(Event::BYTES).zip(wanted.filter_map(|nth| store.event(nth))) {
        slot.copy_from_slice(&event.to_bytes());
        bytes += Event::BYTES;
    }
    ReplyBody::Events { total: total as u8, first, events: room.get(..bytes).unwrap_or(&[]) }
}

pub(super) fn config<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first_id: u16,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let count = usize::from(count).min(MAX_VALUES) as u16;
    let ids = first_id..first_id.saturating_add(count);
    if let Some(id) = ids.clone().find(|&id| control.parameters().get(id).is_none()) {
        return ReplyBody::Refused(Refused::UnknownParameter { id });
    }
    let values = ids.filter_map(|id| control.parameters().get(id));
    match Values::fill(room, values) {
        Some(values) => ReplyBody::Config { first_id, values },
        None => ReplyBody::Refused(Refused::UnknownParameter { id: first_id }),
    }
}

/// Samples that one `RecordInfo` takes into the CRC of the record; the host asks until all are in. A drive
/// that holds its last setpoint goes on sampling meanwhile, and a request must not make a sample late.
const DIGEST_AT_ONCE: usize = 64;

/// Those that it goes on by between two samples, so that the CRC is mostly there when it is asked for.
pub(super) const DIGEST_BETWEEN: usize = 8;

/// Goes on with the CRC of a record that is over, and tells it once it is there.
pub(super) fn digest(control: &mut Control<impl BorrowMut<Recorder>>, samples: usize) -> Option<u32> {
    let over = !matches!(control.state().supervisor.mode(), Mode::Armed | Mode::Running);
    if over { control.recorder.borrow_mut().digest(samples) } else { None }
}

pub(super) fn record_info(control: &mut Control<impl BorrowMut<Recorder>>) -> ReplyBody<'_> {
    let crc = digest(control, DIGEST_AT_ONCE);
    let measured_period_ns = control.measured_period_ns();
    let recorder: &Recorder = control.recorder.borrow();
    ReplyBody::RecordInfo(RecordInfo {
        test: control.test().name(),
        samples: recorder.len() as u32,
        first_index: recorder.first_index(),
        decimation: recorder.decimation() as u16,
        pre_trigger: recorder.pre_trigger(),
        complete: crc.is_some(),
        measured_period_ns,
        mean_spool_raw: recorder.mean_spool(),
        crc32: crc.unwrap_or(0),
    })
}

pub(super) fn chunk<'a>(
    control: &Control<impl BorrowMut<Recorder>>,
    first: u32,
    count: u8,
    room: &'a mut [u8],
) -> ReplyBody<'a> {
    let recorder: &Recorder = control.recorder.borrow();
    if recorder.is_empty() {
        return ReplyBody::Refused(Refused::NoRecord);
    }
    let samples = recorder.len() as u32;
    let end = first.saturating_add(u32::from(count).min(CHUNK_SAMPLES as u32));
    if count == 0 || end > samples {
        return ReplyBody::Refused(Refused::RecordRange { samples });
    }
    let mut bytes = 0;
    for (slot, i) in room.chunks_exact_mut(RecordedSample::BYTES).zip(first..end) {
        if let Some(stored) = recorder.get(i as usize) {
            slot.copy_from_slice(stored);
            bytes += RecordedSample::BYTES;
        }
    }
    ReplyBody::Chunk { first, samples: room.get(..bytes).unwrap_or(&[]) }
}
