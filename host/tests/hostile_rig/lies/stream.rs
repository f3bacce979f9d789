//! Lies in a stream.

use super::*;

/// All of them.
pub const LIES: &[Told] = &[
    unasked(
        "rows without end",
        |memory| {
            let Some(stream) = memory.stream.filter(|_| memory.started) else { return Vec::new() };
            let mut printed = Vec::new();
            for _ in 0..200 {
                let indices: Vec<u32> = (memory.count..memory.count + 24).collect();
                printed.extend(rows(stream, memory.count, &indices));
                memory.count += 24;
            }
            printed
        },
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows of a far number",
        |memory, request, reply| {
            other_rows(memory, request, reply, rows(reply.sequence, u32::MAX - 30, &[0, 1, 2]))
        },
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows of a far sample",
        |memory, request, reply| {
            other_rows(memory, request, reply, rows(reply.sequence, 0, &[0, 4_000_000_000, 4_000_000_001]))
        },
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows that go back",
        |memory, request, reply| other_rows(memory, request, reply, rows(reply.sequence, 0, &[9, 5, 5, 1])),
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows that are asked for again and come one by one, far away",
        |_, request, reply| {
            other_rows_again(request, reply, |first| {
                rows(reply.sequence, first.saturating_add(100_000_000), &[7])
            })
        },
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows that never come to an end",
        |_, request, reply| other_rows_again(request, reply, |first| rows(reply.sequence, first, &[first])),
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows from the end of all numbers",
        |_, request, reply| other_rows_again(request, reply, |_| rows(reply.sequence, u32::MAX, &[1])),
        &[(STREAM, "! error: ")],
    ),
    told(
        "rows that are lost and never there again",
        |memory, request, reply| match (request, reply.body) {
            (RequestBody::StreamBegin { every: 1.., .. }, ReplyBody::Rows { .. }) if memory.count == 0 => {
                memory.count += 1;
                Says::Nothing
            }
            (RequestBody::StreamRead { first, .. }, _) => Says::Instead(rows(reply.sequence, *first, &[])),
            _ => Says::Truth,
        },
        &[(STREAM, "= ")],
    ),
    told(
        "rows that end within one",
        |memory, request, reply| {
            let cut = frame(reply.sequence, ReplyBody::Rows { first: 0, rows: &[1, 2, 3] });
            other_rows(memory, request, reply, cut)
        },
        &[(STREAM, "= ")],
    ),
];
