//! Lies about who and how the rig is.

use super::*;

/// All of them.
pub const LIES: &[Told] = &[
    told(
        "a firmware with escapes and lines in its name",
        |_, _, reply| info(reply, 4389, EVIL),
        &[(INFO, "firmware"), (STATUS, "= 0"), (RECORD, "= 0"), (STREAM, "= 0")],
    ),
    told(
        "names as long as a message",
        |_, _, reply| info(reply, 4389, &"n".repeat(150)),
        &[(INFO, "= 0"), (RECORD, "= 0")],
    ),
    told(
        "a version that is not spoken",
        |_, _, reply| {
            let ReplyBody::Info { firmware, build, board, record_capacity, .. } = reply.body else {
                return Says::Truth;
            };
            instead(reply, ReplyBody::Info { version: 99, firmware, build, board, record_capacity })
        },
        &[(STATUS, "use a later version of this program")],
    ),
    told("silence from the beginning", |_, _, _| Says::Nothing, &[(STATUS, NO_ANSWER), (MONITOR, NO_ANSWER)]),
    told("a line that is cut at once", |_, _, _| Says::HangUp, &[(STATUS, "broke"), (RUN, "broke")]),
    unasked("noise without end", |_| vec![0x5a; 60_000], &[(STATUS, "= "), (RECORD, "= ")]),
    unasked("delimiters without end", |_| vec![0; 60_000], &[(STATUS, "= "), (MONITOR, "= ")]),
    unasked(
        "answers to what nobody has asked, without end",
        |_| frame(7, ReplyBody::Done).repeat(5_000),
        &[(STATUS, "= "), (RUN, "= ")],
    ),
    told(
        "answers to other requests",
        |_, _, reply| Says::Instead(frame(reply.sequence.wrapping_add(1), reply.body)),
        &[(STATUS, NO_ANSWER), (RECORD, NO_ANSWER)],
    ),
    told(
        "answers of another kind",
        |_, request, reply| match request {
            RequestBody::Info => Says::Truth,
            _ => {
                instead(reply, ReplyBody::Timing { interval: Spread::default(), latency: Spread::default() })
            }
        },
        &[
            (STATUS, "does not match the request"),
            (RECORD, "does not match the request"),
            (RUN, "does not match the request"),
        ],
    ),
    told(
        "numbers as large as they come",
        |_, _, reply| {
            let (least, most) = (i32::MIN, i32::MAX);
            status(reply, |status| {
                (status.setpoint, status.position, status.error) = (least, most, least);
                (status.command, status.pressure_1, status.pressure_2) = (i16::MIN, i16::MIN, i16::MAX);
                (status.spool, status.recorded, status.damaged_frames) = (i16::MIN, u32::MAX, u32::MAX);
                (status.index, status.duration_samples) = (u32::MAX, u32::MAX);
            })
        },
        &[(STATUS, "= 0"), (MONITOR, "= 0"), (RUN, "= "), (STREAM, "= "), (PLAN, "! error: ")],
    ),
    told(
        "a fault that nobody knows",
        |_, _, reply| status(reply, |status| (status.mode, status.fault) = (Mode::Fault, 255)),
        &[(STATUS, "fault 255"), (RUN, "fault 255"), (MONITOR, "fault 255")],
    ),
    told(
        "an owner with escapes in its name",
        |_, request, reply| match request {
            RequestBody::Owner => {
                let owner = Owner { presence: Presence::There, session: 9, silent_ms: u32::MAX, host: EVIL };
                instead(reply, ReplyBody::Owner(owner))
            }
            RequestBody::Arm { .. } => {
                let owner = Owner { presence: Presence::There, session: 9, silent_ms: 1, host: EVIL };
                refused(reply, RequestRefusal::Owned(owner))
            }
            _ => Says::Truth,
        },
        &[(STATUS, "owner"), (RUN, "commands the drive")],
    ),
    told(
        "advice with escapes",
        |_, request, reply| match request {
            RequestBody::ChangeTake { .. } => refused(reply, RequestRefusal::Inconsistent { advice: EVIL }),
            _ => Says::Truth,
        },
        &[(RUN, "the parameters are inconsistent")],
    ),
    told(
        "a refusal that nobody knows",
        |_, request, reply| match request {
            RequestBody::Info => Says::Truth,
            _ => refused(reply, RequestRefusal::NotNow(250)),
        },
        &[(STATUS, "code 250"), (RECORD, "code 250"), (CONFIG, "code 250")],
    ),
    told(
        "a drive that stands 25 km away",
        |_, _, reply| status(reply, |status| status.position = i32::MAX),
        &[(PLAN, "! error: ")],
    ),
];
