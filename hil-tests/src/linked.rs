//! The firmware's application, run natively, with its plant at a second port, as on a Nucleo board with the feature
//! `plant-bus`: TCP replaces the two serial ports, and everything else is as on the board.

use std::io::Write;
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
use pneudrive_app::{Control, LockStep, inputs};
use pneudrive_sim::Rig;

use crate::Target;
use crate::board_plant::BoardPlant;
use crate::native::{Callers, accepted, listener, port_name, read};
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
        let (port, plant_port) = (port_name(&protocol)?, port_name(&plant)?);
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
    callers: Callers,
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
        NativeBoard { control, board, link, microseconds, callers: Callers::new(listener) }
    }

    fn serve(mut self, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            self.callers.listen(&mut self.control, &mut self.board);
            self.link.attend(&mut self.control, &mut self.board, &self.microseconds);
            self.link.watch(&mut self.control, &mut self.board, &self.microseconds);
            inputs::attend(&mut (&mut *self.control, &mut self.board));
            // This flash takes everything.
            let _ = self.control.tidy_up(&mut self.board);
            std::thread::sleep(Duration::from_micros(20));
        }
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
