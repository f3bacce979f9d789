//! Requests by their structure: any of them, each field anywhere in its range and often where it matters.

use arbitrary::{Result, Unstructured};
use pneudrive_controller::parameters::TABLE;
use pneudrive_protocol::change::{Entry, PART_BYTES};
use pneudrive_protocol::{MAX_VALUES, ProfiledMove, RequestBody, Values};

/// Names of tests and hosts, some of them too long.
fn text<'a>(u: &mut Unstructured<'a>) -> Result<&'a str> {
    let names =
        ["", "step", "a host", "über alles", "a name that is longer than the thirty-two bytes of one"];
    if u.ratio(3, 4)? { u.choose(&names).copied() } else { u.arbitrary() }
}

/// An id of a parameter, mostly one that there is.
fn id(u: &mut Unstructured<'_>) -> Result<u16> {
    if u.ratio(7, 8)? { u.choose(&TABLE).map(|parameter| parameter.id) } else { u.arbitrary() }
}

/// A value of a parameter, mostly near its default.
fn value(id: u16, u: &mut Unstructured<'_>) -> Result<i32> {
    let default = pneudrive_controller::parameters::lookup(id).map_or(0, |parameter| parameter.default);
    match u.int_in_range(0..=3u8)? {
        0 => u.arbitrary(),
        1 => Ok(default),
        _ => Ok(default.saturating_add(i32::from(u.arbitrary::<i8>()?))),
    }
}

/// A number that is mostly small.
fn count(u: &mut Unstructured<'_>) -> Result<u32> {
    if u.ratio(7, 8)? { u.int_in_range(0..=40) } else { u.arbitrary() }
}

fn short(u: &mut Unstructured<'_>) -> Result<u16> {
    if u.ratio(7, 8)? { u.int_in_range(0..=9) } else { u.arbitrary() }
}

/// A setpoint or a position, mostly within the stroke.
fn counts(u: &mut Unstructured<'_>) -> Result<i32> {
    if u.ratio(7, 8)? { u.int_in_range(-100..=2000) } else { u.arbitrary() }
}

/// What a request body borrows.
#[derive(Debug)]
pub struct Room {
    values: [u8; 4 * MAX_VALUES],
}

impl Default for Room {
    fn default() -> Self {
        Room { values: [0; 4 * MAX_VALUES] }
    }
}

/// Values of consecutive parameters.
fn values<'r>(first_id: u16, u: &mut Unstructured<'_>, room: &'r mut Room) -> Result<Values<'r>> {
    let count = u.int_in_range(0..=4u16)?;
    let values = (0..count).map(|place| value(first_id.saturating_add(place), u));
    let values = values.collect::<Result<Vec<i32>>>()?;
    Ok(Values::fill(&mut room.values, values).expect("four have room"))
}

/// The bytes of a change: entries that mostly go together.
pub fn change(u: &mut Unstructured<'_>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for _ in 0..u.int_in_range(0..=5u8)? {
        let (mut room, mut out) = (Room::default(), [0; PART_BYTES]);
        let told_bytes;
        let entry = match u.int_in_range(0..=4u8)? {
            0 => {
                let first_id = id(u)?;
                Entry::Parameters { first_id, values: values(first_id, u, &mut room)? }
            }
            1 => Entry::Test {
                name: "changed",
                last_sample: count(u)?,
                round: count(u)?,
                decimation: short(u)?,
                pre_trigger: short(u)?,
            },
            2 => {
                let told = ProfiledMove {
                    at_sample: count(u)?,
                    target: counts(u)?,
                    kind: u.arbitrary()?,
                    numbers: u.arbitrary()?,
                };
                told_bytes = told.to_bytes();
                Entry::MoveRecord { number: u.int_in_range(0..=16)?, bytes: &told_bytes }
            }
            _ => Entry::Move { at_sample: count(u)?, target: counts(u)? },
        };
        bytes.extend_from_slice(entry.write(&mut out).expect("short entries have room"));
    }
    if u.ratio(1, 16)? {
        bytes.extend_from_slice(u.arbitrary::<&[u8]>()?);
    }
    Ok(bytes)
}

/// A request. Those that name something by its CRC-32 name what `named` says, or anything.
pub fn body<'a>(u: &mut Unstructured<'a>, named: u32, room: &'a mut Room) -> Result<RequestBody<'a>> {
    use RequestBody as Body;
    let crc32 = if u.ratio(7, 8)? { named } else { u.arbitrary()? };
    Ok(match u.int_in_range(0..=41u8)? {
        0 => Body::Info,
        1 => Body::Status,
        2 => Body::ConfigGet { first_id: id(u)?, count: u.arbitrary()? },
        3 => {
            let first_id = id(u)?;
            Body::ConfigSet { first_id, values: values(first_id, u, room)? }
        }
        5 => Body::Disarm,
        4 | 6 => Body::Start { crc32 },
        7 => Body::Stop,
        8 => Body::Reference { position_counts: counts(u)? },
        9 | 10 => Body::Status,
        11 | 12 => Body::RecordInfo,
        14 => Body::Home,
        15 => Body::Motion,
        16 => Body::ConfigSave,
        17 => Body::ConfigState,
        18 => Body::Events { first: u.arbitrary()?, count: u.arbitrary()? },
        19 => Body::Timing,
        13 | 20 => Body::RecordRead { crc32, first: count(u)?, count: u.arbitrary()? },
        21 => Body::StreamBegin { every: short(u)?, batch: u.arbitrary()? },
        22 => Body::StreamGrant { until: u.arbitrary()? },
        23 => Body::StreamRead { first: count(u)?, count: u.arbitrary()? },
        24..=26 => Body::Arm { host: text(u)? },
        27 => Body::TakeOver { host: text(u)? },
        28 => Body::Leave,
        29 => Body::Owner,
        30 => Body::ChangePart { crc32, first: short(u)?, part: u.arbitrary()? },
        31 => Body::ChangeTake { crc32 },
        32 => Body::Start { crc32 },
        33 => Body::SeekNull,
        34 => Body::AtNull,
        35 => Body::TestRead { first: u.arbitrary()? },
        36 => Body::MoveRecordsRead { first: u.arbitrary()? },
        37 => Body::Io,
        38 => Body::IoSet { inputs: u.arbitrary()? },
        39 => Body::TryWatchdog,
        40 => Body::Boot,
        _ => Body::Token { token: text(u)? },
    })
}
