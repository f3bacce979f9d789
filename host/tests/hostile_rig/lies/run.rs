//! Lies during a run.

use super::*;

/// All of them.
pub const LIES: &[Told] = &[
    told(
        "a run that stands still",
        |memory, _, reply| {
            if !memory.started {
                return Says::Truth;
            }
            status(reply, |status| (status.mode, status.index) = (Mode::Running, 3))
        },
        &[(RUN, "! error: "), (STREAM, "! error: ")],
    ),
    told(
        "a run that goes on behind its end",
        |memory, _, reply| {
            if !memory.started {
                return Says::Truth;
            }
            memory.count += 50;
            let index = memory.count;
            status(reply, |status| (status.mode, status.index) = (Mode::Running, index))
        },
        &[(RUN, "! error: "), (STREAM, "! error: ")],
    ),
    told(
        "a run that goes back and forth",
        |memory, _, reply| {
            if !memory.started {
                return Says::Truth;
            }
            memory.count += 1;
            let index = memory.count % 5;
            status(reply, |status| (status.mode, status.index) = (Mode::Running, index))
        },
        &[(RUN, "! error: ")],
    ),
    told("silence at the arming", silent_at!(RequestBody::Arm { .. }), &[(RUN, NO_ANSWER)]),
    told("silence at the start", silent_at!(RequestBody::Start { .. }), &[(RUN, NO_ANSWER)]),
    told(
        "silence about the parameters",
        silent_at!(RequestBody::ConfigGet { .. }),
        &[(CONFIG, NO_ANSWER), (RUN, NO_ANSWER), (PLAN, NO_ANSWER)],
    ),
    told("silence about the record", silent_at!(RequestBody::RecordInfo), &[(RECORD, NO_ANSWER)]),
    told(
        "silence about its samples",
        silent_at!(RequestBody::RecordRead { .. }),
        &[(RECORD, "no answer from")],
    ),
    told("silence about a change", silent_at!(RequestBody::ChangePart { .. }), &[(RUN, NO_ANSWER)]),
    told("silence at the stream", silent_at!(RequestBody::StreamBegin { .. }), &[(STREAM, NO_ANSWER)]),
    told(
        "silence once the run is on",
        |memory, _, _| if memory.started { Says::Nothing } else { Says::Truth },
        &[(RUN, NO_ANSWER), (STREAM, NO_ANSWER)],
    ),
    told(
        "a change that is never whole",
        |_, request, reply| match request {
            RequestBody::ChangeTake { .. } => refused(reply, RequestRefusal::ChangeNotWhole),
            _ => Says::Truth,
        },
        &[(RUN, "parts of a change were lost repeatedly")],
    ),
    told(
        "a homing run without end",
        |_, request, reply| match (request, reply.body) {
            (RequestBody::Home, _) => instead(reply, ReplyBody::Done),
            (_, ReplyBody::Status(_)) => status(reply, |status| status.mode = Mode::Homing),
            (_, ReplyBody::Config { .. }) => config(reply, |id, value| if id == 50 { 100 } else { value }),
            _ => Says::Truth,
        },
        &[(HOME, "! error: ")],
    ),
];
