//! How well a download fills a serial line: a pty that carries a byte in the time that 921,600 baud give it.
#![cfg(unix)]

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pneudrive_link::client::{Client, Pieces};
use pneudrive_link::port::BAUD;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;
use serialport::{SerialPort, TTYPort};

/// A slot of the line, and the bytes that it carries at most: start bit, eight bits and stop bit each.
const SLOT: Duration = Duration::from_millis(1);
const SLOT_BYTES: usize = BAUD as usize / 10 / 1000;

/// One direction of a line. It counts slots, not seconds: while the machine does something else, the line stands
/// still.
#[derive(Default)]
struct Direction {
    waiting: Mutex<VecDeque<u8>>,
    carried: AtomicUsize,
    slots: AtomicUsize,
}

impl Direction {
    /// Takes what comes at one end, at once.
    fn take_from(self: Arc<Self>, mut end: TTYPort, over: Arc<AtomicBool>) {
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            while !over.load(Ordering::Relaxed) {
                let count = end.read(&mut bytes).unwrap_or(0);
                self.waiting.lock().expect("alive").extend(&bytes[..count]);
            }
        });
    }

    /// Gives it to the other end, a slot's bytes at a time.
    fn give_to(self: Arc<Self>, mut end: TTYPort, over: Arc<AtomicBool>) {
        std::thread::spawn(move || {
            while !over.load(Ordering::Relaxed) {
                let mut waiting = self.waiting.lock().expect("alive");
                let count = waiting.len().min(SLOT_BYTES);
                let slot: Vec<u8> = waiting.drain(..count).collect();
                drop(waiting);
                self.slots.fetch_add(1, Ordering::Relaxed);
                self.carried.fetch_add(count, Ordering::Relaxed);
                if end.write_all(&slot).is_err() {
                    break;
                }
                std::thread::sleep(SLOT);
            }
        });
    }

    fn counts(&self) -> (usize, usize) {
        (self.carried.load(Ordering::Relaxed), self.slots.load(Ordering::Relaxed))
    }
}

/// A line between the rig's pty and one of its own, and what it carries to the PC.
struct PacedLine {
    /// The PC's end, by name.
    port: String,
    down: Arc<Direction>,
    over: Arc<AtomicBool>,
    /// Held open, so that the line outlives the programs that open it.
    _end: TTYPort,
}

impl PacedLine {
    fn to(rig: &str) -> PacedLine {
        let at_rig = serialport::new(rig.trim_start_matches("pty:"), BAUD).timeout(SLOT);
        let at_rig = at_rig.open_native().expect("the rig's pty");
        let (mut at_pc, end) = TTYPort::pair().expect("a pty");
        at_pc.set_timeout(SLOT).expect("a pty");
        let [up, down] = [(); 2].map(|()| Arc::new(Direction::default()));
        let over = Arc::new(AtomicBool::new(false));
        let again = |port: &TTYPort| port.try_clone_native().expect("a pty");
        Arc::clone(&up).take_from(again(&at_pc), Arc::clone(&over));
        up.give_to(again(&at_rig), Arc::clone(&over));
        Arc::clone(&down).take_from(at_rig, Arc::clone(&over));
        Arc::clone(&down).give_to(at_pc, Arc::clone(&over));
        PacedLine { port: format!("pty:{}", end.name().expect("a name")), down, over, _end: end }
    }
}

impl Drop for PacedLine {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}

/// Bytes that came while the samples were downloaded, of those that could.
fn fraction_used(client: &mut Client, line: &PacedLine) -> f64 {
    let head = client.record_head().expect("a record");
    let (bytes_before, slots_before) = line.down.counts();
    let record = client.download(&head, Pieces::none(head.samples), |_, _| Ok(())).expect("whole");
    let (bytes, slots) = line.down.counts();
    assert_eq!(record.samples.len(), 4386);
    (bytes - bytes_before) as f64 / ((slots - slots_before) * SLOT_BYTES) as f64
}

/// What else the machine does can only take away from it: the best of five downloads counts.
#[test]
fn a_download_through_a_pty_takes_95_percent_of_what_the_line_carries() {
    let test = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let pace = Pace { fast: true, live: false };
    let served = VirtualRig::new(test.clone(), 0, pace).expect("a rig");
    let rig = Background::start(served, Listener::open("pty").expect("a port"));
    let line = PacedLine::to(rig.port());
    let mut client = Client::connect(&line.port).expect("an answer");
    client.prepare(&test, 4385, None).expect("disarmed");
    client.arm().expect("referenced");
    client.start().expect("armed");
    client.follow(&AtomicBool::new(false), |_| {}).expect("no fault");
    let fractions = [(); 5].map(|()| fraction_used(&mut client, &line));
    println!("of what 921,600 baud carry, five downloads of 4386 samples took {fractions:.4?}");
    assert!(fractions.iter().any(|&fraction| fraction >= 0.95), "{fractions:?}");
    assert!(fractions.iter().all(|&fraction| fraction <= 1.0), "{fractions:?}");
}
