//! Lies about the record.

use super::*;

/// All of them.
pub const LIES: &[Told] = &[
    told(
        "a record of 2^32 - 1 samples",
        |_, _, reply| record_info(reply, |info| info.samples = u32::MAX),
        &[(RECORD, "! error: "), (PLAN, "! error: ")],
    ),
    told(
        "a record and a memory of 2^32 - 1 samples",
        |_, _, reply| match reply.body {
            ReplyBody::Info { .. } => info(reply, u32::MAX, "honest"),
            _ => record_info(reply, |info| info.samples = u32::MAX),
        },
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record that is longer than the memory",
        |_, _, reply| record_info(reply, |info| info.samples = 40_000),
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record that goes on behind the last sample that is counted",
        |_, _, reply| match reply.body {
            ReplyBody::Info { .. } => info(reply, u32::MAX, "honest"),
            _ => record_info(reply, |info| (info.samples, info.decimation) = (40_000, u16::MAX)),
        },
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record from long before its start",
        |_, _, reply| record_info(reply, |info| info.first_index = i32::MIN),
        &[(RECORD, "= ")],
    ),
    told(
        "a record that begins after its start",
        |_, _, reply| record_info(reply, |info| info.first_index = 7),
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record that is never complete",
        |_, _, reply| record_info(reply, |info| info.complete = false),
        &[(RECORD, "! error: ")],
    ),
    told(
        "a wrong CRC",
        |_, _, reply| record_info(reply, |info| info.crc32 ^= 1),
        &[(RECORD, "! error: "), (PLAN, "! error: ")],
    ),
    told(
        "a record without samples",
        |_, _, reply| record_info(reply, |info| info.samples = 0),
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record that grows from question to question",
        |memory, _, reply| {
            memory.count += 1;
            let ReplyBody::RecordInfo(mut info) = reply.body else { return Says::Truth };
            (info.samples, info.complete) = (info.samples + memory.count, memory.count > 9);
            instead(reply, ReplyBody::RecordInfo(info))
        },
        &[(RECORD, "! error: ")],
    ),
    told(
        "a record that shrinks while it is read",
        |memory, _, reply| {
            let ReplyBody::Chunk { .. } = reply.body else { return Says::Truth };
            memory.count += 1;
            if memory.count == 1 {
                Says::Truth
            } else {
                refused(reply, RequestRefusal::RecordRange { samples: 3 })
            }
        },
        &[(RECORD, "! error: the record changed while it was read")],
    ),
    told(
        "chunks that are too short",
        |_, _, reply| chunk(reply, 0, |samples| samples[1..].to_vec()),
        &[(RECORD, "no answer from")],
    ),
    told(
        "chunks that are too long",
        |_, _, reply| chunk(reply, 0, |samples| [samples, &[7; RecordedSample::BYTES]].concat()),
        &[(RECORD, "no answer from")],
    ),
    told(
        "chunks of another place",
        |_, _, reply| chunk(reply, 32, <[u8]>::to_vec),
        &[(RECORD, "no answer from")],
    ),
    told(
        "chunks of other samples",
        |_, _, reply| chunk(reply, 0, |samples| samples.iter().map(|byte| byte ^ 1).collect()),
        &[(RECORD, "! error: the record changed while it was read")],
    ),
    told(
        "a test with escapes and lines in its name",
        |_, _, reply| record_info(reply, |info| info.test = EVIL),
        &[(RECORD, "= 0")],
    ),
    told(
        "a clock without time",
        |_, _, reply| record_info(reply, |info| info.measured_period_ns = 0),
        &[(RECORD, "= 0")],
    ),
];
