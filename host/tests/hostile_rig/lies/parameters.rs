//! Lies about parameters and events.

use super::*;

/// All of them.
pub const LIES: &[Told] = &[
    told(
        "parameters of another number",
        |_, _, reply| {
            let ReplyBody::Config { first_id, .. } = reply.body else { return Says::Truth };
            let mut room = [0; 8];
            let values = Values::fill(&mut room, [1, 2]).expect("two");
            instead(reply, ReplyBody::Config { first_id, values })
        },
        &[(CONFIG, "does not match the request"), (RECORD, "does not match the request")],
    ),
    told(
        "parameters out of their range",
        |_, _, reply| config(reply, |_, _| i32::MIN),
        &[(CONFIG, "out of range here"), (MONITOR, "out of range here")],
    ),
    told(
        "parameters that change all the time",
        |memory, _, reply| {
            let ReplyBody::ConfigState(mut state) = reply.body else { return Says::Truth };
            memory.count += 1;
            state.hash = memory.count;
            instead(reply, ReplyBody::ConfigState(state))
        },
        &[(CONFIG, "change while they are read"), (RUN, "! error: ")],
    ),
    told(
        "a rig without any parameter",
        |_, request, reply| match *request {
            RequestBody::ConfigGet { first_id, .. } => {
                refused(reply, RequestRefusal::UnknownParameter { id: first_id })
            }
            _ => Says::Truth,
        },
        &[(EXPORT, "= "), (MONITOR, "= 0"), (STATUS, "= 0")],
    ),
    told(
        "a parameter that was not asked for",
        |_, request, reply| match *request {
            RequestBody::ConfigGet { .. } => refused(reply, RequestRefusal::UnknownParameter { id: 0 }),
            _ => Says::Truth,
        },
        &[(CONFIG, "! error: ")],
    ),
    told(
        "a range of pressures without width",
        |_, _, reply| config(reply, |id, value| if id == 25 { 1_000_000 } else { value }),
        &[(MONITOR, " raw  at "), (STATUS, " raw\nspool"), (RECORD, "= ")],
    ),
    told(
        "a fault log without its events",
        |_, _, reply| match reply.body {
            ReplyBody::Events { first, .. } => {
                instead(reply, ReplyBody::Events { total: 255, first, events: &[] })
            }
            _ => Says::Truth,
        },
        &[(FAULTS, "= ")],
    ),
    told(
        "a fault log that goes round",
        |_, _, reply| match reply.body {
            ReplyBody::Events { .. } => {
                instead(reply, ReplyBody::Events { total: 255, first: 0, events: &[0xff; 25] })
            }
            _ => Says::Truth,
        },
        &[(FAULTS, "! error: ")],
    ),
];
