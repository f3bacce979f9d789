//! A link that splits, damages, drops and invents bytes: what gets lost, and that nothing false
//! comes through.

use std::ops::Range;

use pneudrive_protocol::session::{FIRST, INPUTS};
use pneudrive_protocol::{
    Accumulator, CHUNK_SAMPLES, FrameError, MAX_FRAME, MAX_MESSAGE, MAX_TEXT, MAX_VALUES, Mode, RecordInfo,
    RecordedSample, Reply, ReplyBody, Request, RequestBody, RequestRefusal, Status, Values, decode_reply,
    decode_request, encode, frame,
};
use proptest::collection::vec;
use proptest::prelude::*;

type Bytes = Vec<u8>;

/// Messages of all lengths, many of them short, many with zeros and without any.
fn any_message() -> impl Strategy<Value = Bytes> {
    let byte = prop_oneof![any::<u8>(), Just(0), Just(0xff)];
    prop_oneof![3 => vec(byte, 1..40), 1 => vec(any::<u8>(), 1..=MAX_MESSAGE), 1 => vec(1..=255u8, 250..260)]
}

fn frame_of(message: &[u8]) -> Bytes {
    frame::encode(message, &mut [0; MAX_FRAME]).expect("fits").to_vec()
}

/// The messages that come through, in order.
fn receive(accumulator: &mut Accumulator, stream: &[u8]) -> Vec<Bytes> {
    stream.iter().filter_map(|&byte| Some(accumulator.push(byte)?.ok()?.to_vec())).collect()
}

/// Whether `part` is `whole` with some left out.
fn is_part_of(part: &[Bytes], whole: &[Bytes]) -> bool {
    let mut rest = whole.iter();
    part.iter().all(|message| rest.any(|other| other == message))
}

/// What happens to a stream, at a place given as a share of its length.
#[derive(Clone, Debug)]
enum Damage {
    Flip { at: prop::sample::Index, bit: u32 },
    Cut { at: prop::sample::Index, length: usize },
    Splice { at: prop::sample::Index, noise: Bytes },
}

fn any_damage() -> impl Strategy<Value = Damage> {
    let at = any::<prop::sample::Index>;
    let length = prop_oneof![Just(1), 1..80usize];
    prop_oneof![
        (at(), 0..8u32).prop_map(|(at, bit)| Damage::Flip { at, bit }),
        (at(), length).prop_map(|(at, length)| Damage::Cut { at, length }),
        (at(), vec(any::<u8>(), 1..80)).prop_map(|(at, noise)| Damage::Splice { at, noise }),
    ]
}

impl Damage {
    /// Damages the stream and tells the bytes of it that were touched; for noise, the byte that
    /// follows it.
    fn apply(&self, stream: &mut Bytes) -> Range<usize> {
        match self {
            Damage::Flip { at, bit } => {
                let at = at.index(stream.len());
                stream[at] ^= 1 << bit;
                at..at + 1
            }
            Damage::Cut { at, length } => {
                let at = at.index(stream.len());
                let end = stream.len().min(at + length);
                stream.drain(at..end);
                at..end
            }
            Damage::Splice { at, noise } => {
                let at = at.index(stream.len());
                stream.splice(at..at, noise.iter().copied());
                at..at + 1
            }
        }
    }
}

/// The messages whose frames cannot have suffered: not touched, nor behind a touched delimiter.
fn unharmed(messages: &[Bytes], touched: &Range<usize>) -> Vec<Bytes> {
    let mut start = 0;
    let mut delimiter_before_touched = false;
    let mut unharmed = Vec::new();
    for message in messages {
        let end = start + frame_of(message).len();
        if !delimiter_before_touched && (touched.end <= start || end <= touched.start) {
            unharmed.push(message.clone());
        }
        delimiter_before_touched = touched.contains(&(end - 1));
        start = end;
    }
    unharmed
}

proptest! {
    /// However the bytes are split on their way, every message arrives as it was sent.
    #[test]
    fn a_split_stream_brings_every_message(
        messages in vec(any_message(), 1..8),
        chunks in vec(1..600usize, 1..20),
    ) {
        let stream: Bytes = messages.iter().flat_map(|message| frame_of(message)).collect();
        let mut accumulator = Accumulator::new();
        let (mut received, mut rest) = (Vec::new(), &stream[..]);
        for &chunk in chunks.iter().cycle() {
            let (head, tail) = rest.split_at(chunk.min(rest.len()));
            received.extend(receive(&mut accumulator, head));
            rest = tail;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(received, messages);
        prop_assert_eq!(accumulator.damaged, 0);
    }

    /// A flipped bit, lost bytes or noise cost the frames they touch, and the one behind a touched
    /// delimiter. No message comes through that was not sent. A flipped bit is noticed, unless every
    /// message arrives as it was sent all the same.
    #[test]
    fn damage_costs_no_more_than_the_frames_it_touches(
        messages in vec(any_message(), 1..8),
        damage in any_damage(),
    ) {
        let mut stream: Bytes = messages.iter().flat_map(|message| frame_of(message)).collect();
        let touched = damage.apply(&mut stream);
        let mut accumulator = Accumulator::new();
        let received = receive(&mut accumulator, &stream);
        prop_assert!(is_part_of(&received, &messages), "something false came through");
        prop_assert!(is_part_of(&unharmed(&messages, &touched), &received), "too much was lost");
        if matches!(damage, Damage::Flip { .. }) {
            let all = [received, receive(&mut accumulator, &[frame::DELIMITER])].concat();
            let noticed = all.len() < messages.len() && accumulator.damaged > 0;
            prop_assert!(noticed || all == messages);
        }
    }

    /// Much damage at once: still nothing false.
    #[test]
    fn no_amount_of_damage_brings_a_false_message(
        messages in vec(any_message(), 1..8),
        damages in vec(any_damage(), 1..20),
    ) {
        let mut stream: Bytes = messages.iter().flat_map(|message| frame_of(message)).collect();
        for damage in damages {
            if !stream.is_empty() {
                damage.apply(&mut stream);
            }
        }
        let received = receive(&mut Accumulator::new(), &stream);
        prop_assert!(is_part_of(&received, &messages));
    }

    /// A frame at the tail of an overlong one is part of it, not a frame.
    #[test]
    fn the_tail_of_an_overlong_frame_is_not_taken(
        overlong in vec(1..=255u8, MAX_FRAME..4 * MAX_FRAME),
        tail in any_message(),
        next in any_message(),
    ) {
        let mut accumulator: Accumulator = Accumulator::new();
        let stream = [overlong, frame_of(&tail)].concat();
        let results: Vec<_> = stream
            .iter()
            .filter_map(|&byte| accumulator.push(byte).map(|result| result.map(<[u8]>::to_vec)))
            .collect();
        prop_assert_eq!(results, [Err(FrameError::Overlong)]);
        prop_assert_eq!(accumulator.damaged, 1);
        prop_assert_eq!(receive(&mut accumulator, &frame_of(&next)), [next]);
    }

    /// Whatever came before: a delimiter, and the next good frame is taken.
    #[test]
    fn after_garbage_and_a_delimiter_the_next_frame_is_taken(
        garbage in vec(prop_oneof![any::<u8>(), Just(0)], 0..3 * MAX_FRAME),
        message in any_message(),
    ) {
        let mut accumulator = Accumulator::new();
        prop_assert!(receive(&mut accumulator, &garbage).is_empty());
        prop_assert!(receive(&mut accumulator, &[frame::DELIMITER]).is_empty());
        prop_assert_eq!(receive(&mut accumulator, &frame_of(&message)), [message]);
    }

    /// Accumulators of any size take what has room in them and refuse the rest.
    #[test]
    fn a_small_accumulator_takes_what_has_room(message in any_message()) {
        let mut small = Accumulator::<32>::new();
        let results: Vec<_> = frame_of(&message)
            .iter()
            .filter_map(|&byte| small.push(byte).map(|result| result.map(<[u8]>::to_vec)))
            .collect();
        let fits = message.len() + frame::CRC_BYTES <= 32;
        prop_assert_eq!(results, [if fits { Ok(message) } else { Err(FrameError::Overlong) }]);
    }

    /// Bytes that are no message are an error, never a panic; what is one can be sent again.
    #[test]
    fn any_bytes_are_a_message_or_an_error(
        sequence in 0..128u8, variant in 0..26u8, rest in vec(prop_oneof![any::<u8>(), 0..12u8], 0..80),
    ) {
        for bytes in [&[&[sequence, variant], &rest[..]].concat(), &rest] {
            if let Ok(request) = decode_request(bytes) {
                prop_assert!(encode(&request, &mut [0; MAX_FRAME]).is_some());
            }
            if let Ok(reply) = decode_reply(bytes) {
                prop_assert!(encode(&reply, &mut [0; MAX_FRAME]).is_some());
            }
        }
    }

    /// A request arrives whole; one cut short is an error that still tells its number, if that of its boot is there.
    #[test]
    fn a_request_arrives_as_it_was_sent(parts in any_parts(), variant in 0..13usize) {
        let request = parts.request(variant);
        let message = sent(&request);
        prop_assert_eq!(decode_request(&message), Ok(request));
        let body = sent(&Request { body: RequestBody::Info, ..request }).len() - 1;
        for end in 0..message.len() {
            let error = decode_request(&message[..end]).expect_err("cut short");
            prop_assert_eq!(error.sequence, (end >= body).then_some(request.sequence));
        }
    }

    /// A reply arrives whole.
    #[test]
    fn a_reply_arrives_as_it_was_sent(parts in any_parts(), variant in 0..16usize) {
        let reply = parts.reply(variant);
        let message = sent(&reply);
        prop_assert_eq!(decode_reply(&message), Ok(reply));
    }
}

/// What messages are made of.
#[derive(Clone, Debug)]
struct Parts {
    texts: [String; 3],
    values: Bytes,
    samples: Bytes,
    sequence: u16,
    long: [u32; 5],
    signed: [i32; 4],
    short: [u16; 2],
    raw: [i16; 4],
    byte: u8,
    flag: bool,
}

fn any_parts() -> impl Strategy<Value = Parts> {
    let text = || ".{0,20}".prop_filter("fits", |text: &String| text.len() <= MAX_TEXT);
    let numbers = (
        any::<[u32; 5]>(),
        any::<[i32; 4]>(),
        any::<[u16; 2]>(),
        any::<[i16; 4]>(),
        any::<u8>(),
        any::<bool>(),
    );
    let texts = [text(), text(), text()];
    let values = vec(any::<[u8; 4]>(), 0..=MAX_VALUES);
    let samples = vec(any::<[u8; RecordedSample::BYTES]>(), 0..=CHUNK_SAMPLES);
    (any::<u16>(), texts, values, samples, numbers).prop_map(
        |(sequence, texts, values, samples, (long, signed, short, raw, byte, flag))| Parts {
            texts,
            values: values.concat(),
            samples: samples.concat(),
            sequence,
            long,
            signed,
            short,
            raw,
            byte,
            flag,
        },
    )
}

impl Parts {
    fn values(&self) -> Values<'_> {
        Values::new(&self.values).expect("whole values")
    }

    fn request(&self, variant: usize) -> Request<'_> {
        let ([long, ..], [signed, ..], [short, other], byte) =
            (self.long, self.signed, self.short, self.byte);
        let body = match variant {
            0 => RequestBody::Info,
            1 => RequestBody::Status,
            2 => RequestBody::ConfigGet { first_id: short, count: byte },
            3 => RequestBody::ConfigSet { first_id: short, values: self.values() },
            4 => RequestBody::Arm { host: &self.texts[0] },
            5 => RequestBody::Disarm,
            6 => RequestBody::Start { crc32: long },
            7 => RequestBody::Stop,
            8 => RequestBody::Reference { position_counts: signed },
            9 => RequestBody::ChangePart { crc32: long, first: short, part: &self.values },
            10 => RequestBody::StreamBegin { every: other, batch: byte },
            11 => RequestBody::RecordInfo,
            _ => RequestBody::RecordRead { crc32: signed as u32, first: long, count: byte },
        };
        let session = self.long[1].clamp(FIRST, INPUTS - 1);
        Request { sequence: self.sequence, session, boot: self.long[2], body }
    }

    fn reply(&self, variant: usize) -> Reply<'_> {
        let ([long, ..], [short, other]) = (self.long, self.short);
        let body = match variant {
            0 => ReplyBody::Info {
                version: other,
                firmware: &self.texts[0],
                build: &self.texts[1],
                board: &self.texts[2],
                record_capacity: long,
            },
            1 => ReplyBody::Status(self.status()),
            2 => ReplyBody::Config { first_id: short, values: self.values() },
            3 => ReplyBody::Done,
            4 => ReplyBody::RecordInfo(self.record_info()),
            5 => ReplyBody::Chunk { first: long, samples: &self.samples },
            _ => ReplyBody::Refused(self.refused(variant - 6)),
        };
        Reply { sequence: self.sequence, body }
    }

    fn refused(&self, variant: usize) -> RequestRefusal<'_> {
        let ([samples, ..], [value, ..], [id, _]) = (self.long, self.signed, self.short);
        match variant {
            0 => RequestRefusal::NotNow(self.byte),
            1 => RequestRefusal::UnknownParameter { id },
            2 => RequestRefusal::OutOfRange { id, value },
            3 => RequestRefusal::Inconsistent { advice: &self.texts[0] },
            4 => RequestRefusal::TestTooLong,
            5 => RequestRefusal::MovesOutOfOrder,
            6 => RequestRefusal::TooManyMoves,
            7 => RequestRefusal::NoRecord,
            8 => RequestRefusal::RecordRange { samples },
            _ => RequestRefusal::Unknown,
        }
    }

    fn status(&self) -> Status {
        let modes = [Mode::Disarmed, Mode::Armed, Mode::Running, Mode::Done, Mode::Fault];
        let [index, duration_samples, recorded, damaged_frames, _] = self.long;
        let [setpoint, position, error, _] = self.signed;
        let [command, pressure_1, pressure_2, spool] = self.raw;
        Status {
            mode: modes[usize::from(self.byte) % modes.len()],
            fault: self.byte,
            referenced: self.flag,
            index,
            duration_samples,
            setpoint,
            position,
            error,
            command,
            pressure_1,
            pressure_2,
            spool,
            recorded,
            damaged_frames,
        }
    }

    fn record_info(&self) -> RecordInfo<'_> {
        RecordInfo {
            test: &self.texts[0],
            samples: self.long[0],
            first_index: self.signed[0],
            decimation: self.short[0],
            pre_trigger: self.short[1],
            complete: self.flag,
            measured_period_ns: self.long[1],
            mean_spool_raw: self.raw[0],
            crc32: self.long[2],
        }
    }
}

/// The message that arrives when this one is sent.
fn sent(message: &impl pneudrive_protocol::Message) -> Bytes {
    let mut out = [0; MAX_FRAME];
    let frame = encode(message, &mut out).expect("fits");
    receive(&mut Accumulator::new(), frame).pop().expect("one message")
}

/// Behind a full block of 254 bytes COBS may write a last code or not. A bit that makes that code of the
/// delimiter harms nothing; the next delimiter ends the frame. Once a test took that for a fault.
#[test]
fn a_bit_in_the_delimiter_behind_a_full_block_harms_nothing() {
    let blocks = (1..=250u8).map(|first| [vec![first], vec![7; 249]].concat());
    let mut full = blocks.filter(|message| frame_of(message)[0] == 0xff);
    let message = full.next().expect("one whose CRC has no zero");
    let mut stream = frame_of(&message);
    assert_eq!((stream.len(), stream[255]), (256, frame::DELIMITER));
    stream[255] ^= 1;
    let mut accumulator = Accumulator::new();
    assert!(receive(&mut accumulator, &stream).is_empty());
    assert_eq!(receive(&mut accumulator, &[frame::DELIMITER]), [message]);
    assert_eq!(accumulator.damaged, 0);
}
