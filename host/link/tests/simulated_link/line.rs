//! One direction of the line, and its faults.

use std::collections::VecDeque;
use std::time::Duration;

use pneudrive_link::port::BAUD;
use pneudrive_protocol::{MAX_FRAME, Reply, decode_request, encode};

use super::{Other, Simulation};

/// Time that a byte takes: start bit, eight bits, stop bit.
pub fn byte_time(bytes: usize) -> Duration {
    Duration::from_nanos(bytes as u64 * 10_000_000_000 / u64::from(BAUD))
}

/// How long the operating system keeps what has come, in each direction.
const LATENCY: Duration = Duration::from_millis(2);

/// Numbers by SplitMix64: the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

/// What goes wrong with a line.
#[derive(Clone, Debug)]
pub struct Faults {
    pub random: Random,
    /// Frames of a thousand that something happens to.
    pub per_mille: usize,
    /// Whether the cable may be pulled.
    pub disconnects: bool,
}

impl Faults {
    /// As many faults at other times.
    pub fn clone_apart(&self) -> Faults {
        Faults { random: Random(self.random.0 ^ 0xa5a5), ..self.clone() }
    }
}

/// One direction of a line.
#[derive(Default)]
pub struct Line {
    pub faults: Option<Faults>,
    /// By how much more everything comes late.
    pub delay: Duration,
    /// When the last byte so far will have gone.
    free_at: Duration,
    /// Bytes and when they arrive, in order.
    on_the_way: VecDeque<(Duration, Vec<u8>)>,
    /// Bytes ever sent, frames ever sent and those that something happened to.
    pub carried: usize,
    pub frames: usize,
    pub damaged: usize,
    pulled: bool,
}

impl Line {
    /// A frame goes onto the line, behind what is there.
    pub fn send(&mut self, now: Duration, mut frame: Vec<u8>) {
        self.frames += 1;
        let what = self.faults.as_mut().and_then(|faults| {
            let damaged = faults.random.below(1000) < faults.per_mille;
            damaged.then(|| faults.random.below(if faults.disconnects { 164 } else { 160 }))
        });
        self.damaged += usize::from(what.is_some());
        match what.map(|what| (what / 20, &mut self.faults)) {
            None => {}
            Some((0, _)) => return,                       // dropped
            Some((1, _)) => self.put(now, frame.clone()), // twice
            Some((2, _)) => return self.overtake(now, frame),
            Some((3, Some(f))) => {
                let at = f.random.below(frame.len());
                frame[at] ^= 1 << f.random.below(8);
            }
            Some((4, Some(f))) => {
                let at = f.random.below(frame.len());
                let end = frame.len().min(at + 1 + f.random.below(80));
                frame.drain(at..end);
            }
            Some((5, Some(f))) => {
                let at = f.random.below(frame.len());
                let noise: Vec<u8> = (0..1 + f.random.below(80)).map(|_| f.random.next() as u8).collect();
                frame.splice(at..at, noise);
            }
            Some((6, Some(f))) => self.free_at += Duration::from_millis(f.random.below(300) as u64), // stall
            Some((7, Some(f))) => {
                // Noise of its own behind the frame.
                let noise: Vec<u8> = (0..1 + f.random.below(600)).map(|_| f.random.next() as u8).collect();
                frame.extend(noise);
            }
            Some(_) => self.pulled = true,
        }
        self.put(now, frame);
    }

    fn put(&mut self, now: Duration, bytes: Vec<u8>) {
        self.carried += bytes.len();
        self.free_at = self.free_at.max(now) + byte_time(bytes.len());
        self.on_the_way.push_back((self.free_at + LATENCY + self.delay, bytes));
    }

    /// Comes ahead of the frame before it.
    fn overtake(&mut self, now: Duration, frame: Vec<u8>) {
        self.put(now, frame);
        if let [.., (_, before), (_, last)] = self.on_the_way.make_contiguous() {
            std::mem::swap(before, last);
        }
    }

    /// Whether nothing is being sent.
    pub fn is_free(&self, now: Duration) -> bool {
        self.free_at <= now
    }

    pub fn next_arrival(&self) -> Option<Duration> {
        self.on_the_way.front().map(|(arrival, _)| *arrival)
    }

    /// What arrives next.
    pub fn take(&mut self) -> Vec<u8> {
        self.on_the_way.pop_front().map(|(_, bytes)| bytes).unwrap_or_default()
    }

    /// Whether the cable was just pulled.
    pub fn breaks(&mut self) -> bool {
        std::mem::take(&mut self.pulled)
    }

    pub fn clear(&mut self) {
        self.on_the_way.clear();
    }
}

/// A byte comes to a rig with another firmware.
pub fn hear_as(other: Other, byte: u8, rig: &mut Simulation, replies: &mut Vec<u8>) {
    let Some(Ok(message)) = rig.accumulator.push(byte) else { return };
    let message = message.to_vec();
    let request = decode_request(&message).expect("a request");
    match other(&request) {
        Some(body) => {
            let reply = Reply { sequence: request.sequence, body };
            replies.extend(encode(&reply, &mut [0; MAX_FRAME]).expect("fits"));
        }
        None => {
            let mut frame = [0; MAX_FRAME];
            let frame = encode(&request, &mut frame).expect("it came in one");
            let Ok(()) = rig.server.receive(frame, &mut rig.control, &mut rig.board, replies);
        }
    }
}
