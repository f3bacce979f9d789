//! The firmware's application, run natively, with its plant at a second port, as on a Nucleo board with the feature
//! `plant-bus`: TCP replaces the two serial ports, and everything else is as on the board.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Result;
use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::lock_step::Stopwatch;
use pneudrive_app::plant_link::{Line, PlantLink};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Control, LockStep, Server};
use pneudrive_rigs::board_plant::BoardPlant;
use pneudrive_sim::Rig;

use crate::Target;
use crate::service::commission;

/// The board, and the plant that waits at its second port.
pub struct LinkedTarget {
    port: String,
    plant_port: String,
    plant: Option<BoardPlant>,
    stop: Arc<AtomicBool>,
}

impl LinkedTarget {
    /// A board in service, its plant that of the rig.
    ///
    /// # Errors
    /// When there is no port, or board and plant do not come together.
    pub fn start(rig: &Rig) -> Result<LinkedTarget> {
        let [protocol, plant] = [listener()?, listener()?];
        let name = |listener: &TcpListener| listener.local_addr().map(|address| format!("tcp://{address}"));
        let (port, plant_port) = (name(&protocol)?, name(&plant)?);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        std::thread::spawn(move || NativeBoard::new(protocol, plant).serve(&stopped));
        let mut target = LinkedTarget { port, plant_port, plant: None, stop };
        target.plant_comes(rig)?;
        commission(&target, rig)?;
        Ok(target)
    }

    /// The plant ends: nobody answers the board any more.
    pub fn plant_goes(&mut self) {
        self.plant = None;
    }

    /// A plant waits for the board's hello and answers it.
    ///
    /// # Errors
    /// When there is none.
    pub fn plant_comes(&mut self, rig: &Rig) -> Result<()> {
        self.plant = Some(BoardPlant::open(&self.plant_port, rig)?);
        Ok(())
    }
}

fn listener() -> Result<TcpListener> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

impl Target for LinkedTarget {
    fn name(&self) -> &str {
        "native board with its plant at a port"
    }

    fn port(&self) -> &str {
        &self.port
    }
}

impl Drop for LinkedTarget {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// What the Nucleo's `Drive` and `Talk` are.
struct NativeBoard {
    control: Box<Control>,
    board: LockStep<FlashStore<RamFlash, Memory>>,
    link: PlantLink<TcpLine>,
    microseconds: Microseconds,
    listener: TcpListener,
    callers: Vec<(TcpStream, Server)>,
}

impl NativeBoard {
    fn new(listener: TcpListener, plant: TcpListener) -> NativeBoard {
        let kept = FlashStore::take_up(RamFlash::default(), RamFlash::layout(), [0; MEMORY_BYTES]);
        let mut board = LockStep::new("native", kept.expect("the layout is that of this flash").0);
        let mut control = Box::<Control>::default();
        control.set_referenced().expect("a new drive is disarmed");
        control.take_up(&mut board);
        let microseconds = Microseconds(Instant::now());
        let line = TcpLine { listener: plant, plant: None, answer: Vec::new(), awaited: 0 };
        let link = PlantLink::new(line, 1000, &microseconds);
        NativeBoard { control, board, link, microseconds, listener, callers: Vec::new() }
    }

    fn serve(mut self, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.listen();
            self.link.attend(&mut self.control, &mut self.board, &self.microseconds);
            self.link.watch(&mut self.control, &mut self.board, &self.microseconds);
            // This flash takes everything.
            let _ = self.control.tidy_up(&mut self.board);
            std::thread::sleep(Duration::from_micros(20));
        }
    }

    /// Requests that have come, whatever the plant is doing.
    fn listen(&mut self) {
        if let Some(caller) = accepted(&self.listener) {
            self.callers.push((caller, Server::default()));
        }
        let NativeBoard { control, board, callers, .. } = self;
        callers.retain_mut(|(caller, server)| {
            let (mut bytes, mut replies) = ([0; 1024], Vec::new());
            let Some(count) = read(caller, &mut bytes) else { return false };
            let Ok(()) = server.receive(&bytes[..count], control, board, &mut replies);
            server.attend(control);
            let Ok(()) = server.speak(&mut replies);
            caller.write_all(&replies).is_ok()
        });
    }
}

fn accepted(listener: &TcpListener) -> Option<TcpStream> {
    let (caller, _) = listener.accept().ok()?;
    caller.set_nonblocking(true).ok()?;
    caller.set_nodelay(true).ok()?;
    Some(caller)
}

/// How many bytes have come; None once the other side has gone.
fn read(from: &mut TcpStream, bytes: &mut [u8]) -> Option<usize> {
    match from.read(bytes) {
        Ok(0) if !bytes.is_empty() => None,
        Ok(count) => Some(count),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
        Err(_) => None,
    }
}

struct Microseconds(Instant);

impl Stopwatch for Microseconds {
    fn now(&self) -> u32 {
        self.0.elapsed().as_micros() as u32
    }

    fn since(&self, reading: u32) -> u32 {
        self.now().wrapping_sub(reading)
    }
}

/// The second port; one plant at a time calls there.
struct TcpLine {
    listener: TcpListener,
    plant: Option<TcpStream>,
    answer: Vec<u8>,
    awaited: usize,
}

impl TcpLine {
    /// Takes what has come, as far as it is awaited.
    fn take(&mut self) {
        let Some(plant) = &mut self.plant else { return };
        let mut bytes = vec![0; self.awaited - self.answer.len()];
        match read(plant, &mut bytes) {
            Some(count) => self.answer.extend(&bytes[..count]),
            None => self.plant = None,
        }
    }
}

impl Line for TcpLine {
    fn ask<const N: usize>(&mut self, bytes: [u8; N], answer_bytes: usize) {
        self.plant = accepted(&self.listener).or(self.plant.take());
        self.answer.clear();
        self.awaited = answer_bytes;
        if self.plant.as_mut().is_some_and(|plant| plant.write_all(&bytes).is_err()) {
            self.plant = None;
        }
    }

    fn answer<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take();
        self.answer.get(..N)?.try_into().ok()
    }
}
