//! The whole application on a scripted board.

use pneudrive_app::store::NoStore;
use pneudrive_app::{App, Board};
use pneudrive_controller::{Command, Config, Mode, Refusal, Sample};
use pneudrive_protocol::change::{Entry, PART_BYTES, start_crc32};
use pneudrive_protocol::{
    Accumulator, CHUNK_SAMPLES, MAX_FRAME, RecordCrc, RecordedSample, ReplyBody, Request, RequestBody,
    RequestRefusal, decode_reply, encode, frame,
};

/// The session of the host, unless a test says otherwise.
pub const HOST: u32 = 0x1001;

pub const ARM: RequestBody<'_> = RequestBody::Arm { host: "bench" };

/// A board whose rod creeps out by 3 counts a sample, with a clock that the test turns.
#[derive(Default)]
pub struct FakeBoard {
    pub position: i32,
    /// The rod stands still instead.
    pub stands: bool,
    /// The rod goes where the valve drives it, down to a stop at this position.
    pub stop: Option<i32>,
    pub driven: Vec<Command>,
    pub now_us: u64,
    pub host_clock_ms: Option<u64>,
    pub runs: u32,
    /// The digital inputs, and the outputs that were driven last.
    pub inputs: u8,
    pub shown: u8,
    pub has_watchdog: bool,
    pub store: NoStore,
}

impl Board for FakeBoard {
    type Store = NoStore;

    fn store(&mut self) -> &mut NoStore {
        &mut self.store
    }
    fn name(&self) -> &'static str {
        "fake"
    }
    fn build(&self) -> &'static str {
        "test"
    }
    fn read_sensors(&mut self, _: &Config) -> Sample {
        let driven = self.driven.last().map_or(0, |command| 50 * i32::from(command.counts.signum()));
        self.position = match self.stop {
            Some(stop) => (self.position + driven).max(stop),
            None if self.stands => self.position,
            None => self.position + 3,
        };
        Sample { position: self.position, pressure_1: 100, pressure_2: 200, spool: 2000, home_switch: false }
    }
    fn drive(&mut self, _: &Config, command: Command) {
        self.driven.push(command);
    }
    fn now_us(&self) -> u64 {
        self.now_us
    }
    fn host_clock_ms(&self) -> Option<u64> {
        self.host_clock_ms
    }
    fn inputs(&mut self) -> u8 {
        self.inputs
    }
    fn show(&mut self, outputs: u8) {
        self.shown = outputs;
    }
    fn has_watchdog(&self) -> bool {
        self.has_watchdog
    }
    fn run_begins(&mut self, _: &Config) {
        self.runs += 1;
    }
}

pub struct AppBench {
    pub app: Box<App>,
    pub board: FakeBoard,
    pub sequence: u16,
    /// The host that asks.
    pub session: u32,
    /// The boot that it means.
    pub boot: u32,
}

impl Default for AppBench {
    fn default() -> Self {
        AppBench { app: Box::default(), board: FakeBoard::default(), sequence: 0, session: HOST, boot: 0 }
    }
}

/// The bytes of a change.
pub fn change(entries: &[Entry<'_>]) -> Vec<u8> {
    let mut room = [0; PART_BYTES];
    entries.iter().flat_map(|entry| entry.write(&mut room).expect("room").to_vec()).collect()
}

impl AppBench {
    /// A bench whose axis is referenced.
    pub fn referenced() -> AppBench {
        let mut bench = AppBench::default();
        assert_eq!(bench.ask(RequestBody::Reference { position_counts: 0 }), "Done");
        bench
    }

    pub fn samples(&mut self, count: u32) {
        for _ in 0..count {
            self.app.control.on_sample(&mut self.board);
            self.app.control.on_output(&mut self.board);
            self.board.now_us += 1300;
        }
    }

    pub fn send(&mut self, bytes: &[u8]) -> Vec<u8> {
        let mut replies = Vec::new();
        let App { control, server } = &mut *self.app;
        let Ok(()) = server.receive(bytes, control, &mut self.board, &mut replies);
        replies
    }

    pub fn frame(&mut self, body: RequestBody<'_>) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let request = Request { sequence: self.sequence, session: self.session, boot: self.boot, body };
        encode(&request, &mut [0; MAX_FRAME]).expect("fits").to_vec()
    }

    pub fn ask_for<T>(&mut self, body: RequestBody<'_>, take: impl Fn(ReplyBody<'_>) -> T) -> T {
        let frame = self.frame(body);
        let replies = self.send(&frame);
        let mut accumulator: Accumulator = Accumulator::new();
        for byte in replies {
            if let Some(message) = accumulator.push(byte) {
                let reply = decode_reply(message.expect("whole")).expect("a reply");
                assert_eq!(reply.sequence, self.sequence);
                return take(reply.body);
            }
        }
        panic!("no reply to {body:?}");
    }

    pub fn ask(&mut self, body: RequestBody<'_>) -> String {
        self.ask_for(body, |reply| format!("{reply:?}"))
    }

    pub fn done(&mut self, body: RequestBody<'_>) {
        assert_eq!(self.ask(body), "Done", "{body:?}");
    }

    pub fn refused(&mut self, body: RequestBody<'_>, refusal: Refusal) {
        let expected = format!("{:?}", ReplyBody::Refused(RequestRefusal::NotNow(refusal.code())));
        assert_eq!(self.ask(body), expected, "{body:?}");
    }

    pub fn mode(&self) -> Mode {
        self.app.control.state().supervisor.mode()
    }

    /// A closed-loop test of `samples` samples.
    pub fn test(&mut self, samples: u32, decimation: u16, pre_trigger: u16) {
        let test = Entry::Test { name: "bench", last_sample: samples, round: 0, decimation, pre_trigger };
        let moves = [(0, 500), (4, 0)].map(|(at_sample, target)| Entry::Move { at_sample, target });
        self.takes(&[test, moves[0], moves[1]]);
    }

    /// Sends a change in small parts, and asks to take it.
    pub fn take(&mut self, change: &[u8]) -> String {
        let crc32 = frame::crc32(change);
        for (index, part) in change.chunks(7).enumerate() {
            self.done(RequestBody::ChangePart { crc32, first: 7 * index as u16, part });
        }
        self.ask(RequestBody::ChangeTake { crc32 })
    }

    pub fn takes(&mut self, entries: &[Entry<'_>]) {
        assert_eq!(self.take(&change(entries)), "Done", "{entries:?}");
    }

    /// The request that starts the test that the drive has, with the parameters in force.
    pub fn start_request(&self) -> RequestBody<'static> {
        let (test, parameters) = (self.app.control.test().crc32(), self.app.control.configuration().hash());
        RequestBody::Start { crc32: start_crc32(test.unwrap_or(0), parameters) }
    }

    /// The request that reads some of the record that the drive has.
    pub fn read(&mut self, first: u32, count: u8) -> RequestBody<'static> {
        let crc32 = self.app.control.recorder.digest(usize::MAX).unwrap_or(0);
        RequestBody::RecordRead { crc32, first, count }
    }

    /// The same, ready to start.
    pub fn armed(&mut self, samples: u32, decimation: u16, pre_trigger: u16) {
        self.test(samples, decimation, pre_trigger);
        self.done(ARM);
    }

    /// The whole record: index of the first sample and all samples, its CRC checked.
    pub fn record(&mut self) -> (i32, Vec<RecordedSample>) {
        let (count, first, crc) = loop {
            let (complete, info) = self.ask_for(RequestBody::RecordInfo, |reply| match reply {
                ReplyBody::RecordInfo(info) => (info.complete, (info.samples, info.first_index, info.crc32)),
                other => panic!("{other:?}"),
            });
            if complete {
                break info;
            }
        };
        let (mut samples, mut digest) = (Vec::new(), RecordCrc::new());
        while (samples.len() as u32) < count {
            let at = samples.len() as u32;
            let wanted = (count - at).min(CHUNK_SAMPLES as u32) as u8;
            let read = RequestBody::RecordRead { crc32: crc, first: at, count: wanted };
            let bytes = self.ask_for(read, |reply| match reply {
                ReplyBody::Chunk { first, samples } if first == at => samples.to_vec(),
                other => panic!("{other:?}"),
            });
            digest.update(&bytes);
            samples.extend(RecordedSample::read(&bytes).expect("whole samples"));
        }
        assert_eq!(digest.finish(), crc);
        (first, samples)
    }
}
