//! What serial ports are known for: each ends in an error that says what happened, or does no harm.

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use pneudrive_link::client::{Client, Pieces};
use pneudrive_link::port::Wire;

use crate::simulated_link::{Random, SimulatedRig, any_samples};

/// What a client says of a port that is read so.
fn printed_by(reader: impl Read + Send + 'static) -> String {
    let client = Client::over(Box::new(Wire::new(reader, io::sink())), "the port");
    client.err().expect("nobody answers").to_string()
}

/// A port that comes back at once, whatever time-out it was given, and counts how often.
#[derive(Clone, Default)]
struct Hasty(Arc<AtomicU64>);

impl Read for Hasty {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.fetch_add(1, Ordering::Relaxed);
        Err(io::ErrorKind::TimedOut.into())
    }
}

/// A port that does not come back.
struct Stuck(Receiver<()>);

impl Read for Stuck {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        let _ = self.0.recv();
        Ok(0)
    }
}

/// A port that is full and stays so, and says it in this way.
struct Full(fn() -> io::Result<usize>);

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        self.0()
    }
    fn flush(&mut self) -> io::Result<()> {
        loop {
            std::thread::park();
        }
    }
}

#[test]
fn a_read_that_does_not_keep_its_time_out_changes_nothing() {
    let hasty = Hasty::default();
    let begun = Instant::now();
    assert!(printed_by(hasty.clone()).starts_with("no answer from the port within 1.5 s"));
    let looks_a_ms = hasty.0.load(Ordering::Relaxed) as f64 / begun.elapsed().as_secs_f64() / 1e3;
    assert!(looks_a_ms < 6.0, "{looks_a_ms:.0} looks a ms: the processor has nothing else to do");
    let (_far_end, never) = channel();
    assert!(printed_by(Stuck(never)).starts_with("no answer from the port within 1.5 s"));
}

#[test]
fn a_port_that_takes_nothing_is_an_error_and_is_not_waited_for() {
    for full in [|| Err(io::ErrorKind::TimedOut.into()), || Ok(0)] {
        let client = Client::over(Box::new(Wire::new(Hasty::default(), Full(full))), "the port");
        assert_eq!(client.err().expect("it takes nothing").to_string(), "cannot write to the port");
    }
}

#[test]
fn noise_at_start_up_is_passed_over() {
    let samples = any_samples(&mut Random(2), 100);
    let mut random = Random(4);
    for length in [1, 30, 2000] {
        let rig = SimulatedRig::with_record(&samples);
        let noise: Vec<u8> = (0..length).map(|_| random.next() as u8 | 0x80).collect();
        assert!(String::from_utf8(noise.clone()).is_err() || length == 1);
        rig.change(|simulation| {
            let now = simulation.now();
            // What the last program has left, cut, and what a board says while it starts.
            simulation.down.send(now, noise.clone());
            simulation.up.send(now, noise);
        });
        let mut client = rig.connect().expect("the first good frame is the answer");
        assert_eq!(client.record(|_, _| {}).expect("a record").samples, samples);
    }
}

/// DTR and RTS are set when a port is opened: some boards are reset by that.
#[test]
fn a_board_that_is_reset_by_the_opening_of_its_port_is_waited_for() {
    let samples = any_samples(&mut Random(2), 100);
    let rig = SimulatedRig::with_record(&samples);
    rig.change(|simulation| {
        simulation.deaf_until = Duration::from_millis(1200);
        simulation.down.send(Duration::ZERO, b"boot v1.2\r\n\xff\xfe".to_vec());
    });
    let mut client = rig.connect().expect("it comes up");
    assert_eq!(client.record(|_, _| {}).expect("a record").samples, samples);
}

#[cfg(unix)]
mod pty {
    use pneudrive_link::port;
    use pneudrive_rigs::virtual_rig::Background;

    use super::*;
    use crate::program::{folder, transcript, virtual_rig_at};

    fn rig_on_a_pty() -> Background {
        virtual_rig_at("servo-b-tuned", "pty")
    }

    #[test]
    fn a_port_that_another_program_has_open_is_refused_by_name_and_free_again_after_it() {
        let rig = rig_on_a_pty();
        let path = rig.port().trim_start_matches("pty:").to_owned();
        let held = Client::connect(rig.port()).expect("an answer");
        let error = port::open(rig.port()).err().expect("it is held").to_string();
        assert_eq!(error, format!("another program has {path} open; close it first"));
        let printed = transcript(folder().path(), &format!("device --port {} info", rig.port()));
        assert_eq!(printed, format!("! error: another program has {path} open; close it first\n= 4"));
        drop(held);
        Client::connect(rig.port()).expect("free again");
    }

    #[test]
    fn a_port_that_vanishes_in_the_middle_of_a_download_is_an_error_that_says_so() {
        let folder = folder();
        let mut rig = Some(rig_on_a_pty());
        let port = rig.as_ref().expect("there").port().to_owned();
        transcript(folder.path(), &format!("run servo-b-tuned --set test.duration_s=4 --port {port}"));
        let mut client = Client::connect(&port).expect("an answer");
        let head = client.record_head().expect("a record");
        assert_eq!(head.samples, 3077);
        let result = client
            .download(&head, Pieces::none(head.samples), |_, _| rig.take().map_or(Ok(()), Background::stop));
        let error = format!("{:#}", result.expect_err("the port has gone"));
        assert!(error.starts_with(&format!("the link to {port} broke: ")), "{error}");
    }

    #[test]
    fn a_rig_on_a_pty_outlives_a_program_that_left_its_answers_unread() {
        let rig = rig_on_a_pty();
        for _ in 0..3 {
            let mut port = port::open(rig.port()).expect("free");
            let body = pneudrive_protocol::RequestBody::Info;
            let request = pneudrive_protocol::Request { sequence: 1, session: 1007, boot: 0, body };
            let mut frame = [0; pneudrive_protocol::MAX_FRAME];
            let frame = pneudrive_protocol::encode(&request, &mut frame).expect("fits");
            for _ in 0..400 {
                let _ = port.write(frame);
            }
        }
        Client::connect(rig.port()).expect("it still answers");
    }
}
