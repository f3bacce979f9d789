//! The lies, and which commands they are told.

use pneudrive_protocol::message::{RecordInfo, RequestRefusal, Spread, Status};
use pneudrive_protocol::{
    Mode, Owner, Presence, RecordedSample, Reply, ReplyBody, RequestBody, StreamedSample, Values,
};

use super::{Lie, Memory, Says, frame};

/// A lie by its name, with the commands that are to get along with it and what they must say at least.
pub struct Told {
    pub name: &'static str,
    pub lie: Lie,
    /// Commands, and a part of what each says.
    pub to: &'static [(&'static str, &'static str)],
}

type OnReply = fn(&mut Memory, &RequestBody<'_>, &Reply<'_>) -> Says;

const fn told(name: &'static str, on_reply: OnReply, to: &'static [(&'static str, &'static str)]) -> Told {
    Told { name, lie: Lie { on_reply, unasked: |_| Vec::new() }, to }
}

const fn unasked(
    name: &'static str,
    unasked: fn(&mut Memory) -> Vec<u8>,
    to: &'static [(&'static str, &'static str)],
) -> Told {
    Told { name, lie: Lie { on_reply: |_, _, _| Says::Truth, unasked }, to }
}

const STATUS: &str = "device --port PORT status";
const INFO: &str = "device --port PORT info";
const FAULTS: &str = "device --port PORT faults";
const CONFIG: &str = "device --port PORT config get";
const EXPORT: &str = "device --port PORT config export out.txt";
const HOME: &str = "device --port PORT home";
const RECORD: &str = "record --port PORT";
const RUN: &str = "run servo-b-tuned --set test.duration_s=0.05 --port PORT";
const STREAM: &str = "run servo-b-tuned --set test.duration_s=0.05 --port PORT --stream run.txt";
const MONITOR: &str = "monitor --port PORT --every 0.01 --count 3";
const PLAN: &str = "identify servo-b-tuned --plan PORT --out plan";

/// What is written nowhere: it would move the cursor, or end a line of a file.
const EVIL: &str = "x\x1b[2J\x1b]0;y\x07\n# mm_per_count = 9\r\u{9b}31m\u{202e}z";

fn instead(reply: &Reply<'_>, body: ReplyBody<'_>) -> Says {
    Says::Instead(frame(reply.sequence, body))
}

/// Another answer about the record.
fn record_info(reply: &Reply<'_>, change: fn(&mut RecordInfo<'_>)) -> Says {
    let ReplyBody::RecordInfo(mut info) = reply.body else { return Says::Truth };
    change(&mut info);
    instead(reply, ReplyBody::RecordInfo(info))
}

/// Another answer about the rig.
fn info(reply: &Reply<'_>, capacity: u32, name: &str) -> Says {
    let ReplyBody::Info { version, .. } = reply.body else { return Says::Truth };
    let (firmware, build, board) = (name, name, name);
    let record_capacity = capacity;
    instead(reply, ReplyBody::Info { version, firmware, build, board, record_capacity })
}

/// Another status.
fn status(reply: &Reply<'_>, change: impl FnOnce(&mut Status)) -> Says {
    let ReplyBody::Status(mut status) = reply.body else { return Says::Truth };
    change(&mut status);
    instead(reply, ReplyBody::Status(status))
}

/// Another part of a record.
fn chunk(reply: &Reply<'_>, by: u32, change: fn(&[u8]) -> Vec<u8>) -> Says {
    let ReplyBody::Chunk { first, samples } = reply.body else { return Says::Truth };
    instead(reply, ReplyBody::Chunk { first: first + by, samples: &change(samples) })
}

/// Other values of parameters.
fn config(reply: &Reply<'_>, change: impl Fn(u16, i32) -> i32) -> Says {
    let ReplyBody::Config { first_id, values } = reply.body else { return Says::Truth };
    let changed: Vec<i32> = (first_id..).zip(values.iter()).map(|(id, value)| change(id, value)).collect();
    let mut room = [0; 256];
    let values = Values::fill(&mut room, changed).expect("as many as before");
    instead(reply, ReplyBody::Config { first_id, values })
}

fn refused(reply: &Reply<'_>, refused: RequestRefusal<'_>) -> Says {
    instead(reply, ReplyBody::Refused(refused))
}

/// Rows of a stream.
fn rows(sequence: u16, first: u32, indices: &[u32]) -> Vec<u8> {
    let row = |&index: &u32| StreamedSample { index, ..StreamedSample::default() }.to_bytes();
    let rows: Vec<u8> = indices.iter().flat_map(row).collect();
    frame(sequence, ReplyBody::Rows { first, rows: &rows })
}

/// In place of the rows that come unasked.
fn other_rows(memory: &Memory, request: &RequestBody<'_>, reply: &Reply<'_>, rows: Vec<u8>) -> Says {
    match (request, reply.body) {
        (RequestBody::StreamBegin { .. }, ReplyBody::Rows { .. }) if memory.stream.is_some() => {
            Says::Instead(rows)
        }
        _ => Says::Truth,
    }
}

/// In place of the rows that are asked for again.
fn other_rows_again(request: &RequestBody<'_>, reply: &Reply<'_>, make: impl FnOnce(u32) -> Vec<u8>) -> Says {
    match (request, reply.body) {
        (RequestBody::StreamRead { first, .. }, _) => Says::Instead(make(*first)),
        // The first ones are lost on the way, so that they must be asked for.
        (RequestBody::StreamBegin { .. }, ReplyBody::Rows { first: 0, .. }) => Says::Nothing,
        _ => Says::Truth,
    }
}

macro_rules! silent_at {
    ($pattern:pat) => {
        |_, request, _| if matches!(request, $pattern) { Says::Nothing } else { Says::Truth }
    };
}

const NO_ANSWER: &str = "! error: no answer from tcp://127.0.0.1:";

mod identity;
mod parameters;
mod record;
mod run;
mod stream;

/// All of them.
pub fn all() -> impl Iterator<Item = &'static Told> {
    [record::LIES, identity::LIES, run::LIES, parameters::LIES, stream::LIES].into_iter().flatten()
}
