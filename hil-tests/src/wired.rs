//! The application on a board of chips on SPI ([`pneudrive_interfaces::spi_board`]): drivers, clock and control are those of
//! a microcontroller, the chips are modelled bit by bit, and the simulated plant is at their pins.
//!
//! ```text
//! control -> drivers -> SPI -> chips -> voltages, edges, pulses -> plant
//! ```

mod bench;
mod bus;
mod chips;
mod wires;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::Result;
use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::runtime::clock::{Clock, Mark};
use pneudrive_app::runtime::drive::{ClockedBoard, Drive};
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Board, Control, inputs};
use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::{Command, Config, Sample};
use pneudrive_interfaces::chip::ls7366r;
use pneudrive_interfaces::chip::mcp3208;
use pneudrive_interfaces::chip::mcp4922::{self, Channel};
use pneudrive_interfaces::spi_board::{Lines, SpiBoard};
use pneudrive_interfaces::step_pins::StepPins;
use pneudrive_interfaces::wired_board::Stages;
use pneudrive_rigs::timing::LateSample;
use pneudrive_sim::{IntegrationError, Rig};

use crate::native::{Callers, listener, port_name};
use crate::service::commission;
use crate::{Delayed, Target};
use bench::ChipBench;
use bus::{Bus, ChipModel};
use chips::{Ls7366r, Mcp3208, Mcp4922};
use wires::{KeptWords, Microseconds, NoSwitch, Output, OutputLine, Terminals, Wires};

/// The chips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chip {
    /// The counter of the encoder.
    Ls7366r,
    /// The converter of the sensors.
    Mcp3208,
    /// The converter of the valve.
    Mcp4922,
}

/// The clocks of the buses, kHz: as on the Pico 2, and half of what a counter takes at 3.3 V.
const SENSORS_KHZ: u64 = 1000;
const VALVE_KHZ: u64 = 10_000;
const ENCODER_KHZ: u64 = 2000;

/// The most samples between two looks at the port.
const SAMPLES_AT_ONCE: u32 = 64;

/// What happens to the supply of a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// It goes, for good.
    Off(Chip),
    /// That of the encoder's counter goes and comes back.
    BrownOut,
}

/// A loss at a sample of each run; clones share it.
type PowerLoss = Arc<Mutex<Option<(u64, Loss)>>>;

/// The board as an execution level.
pub struct WiredTarget {
    port: String,
    late: LateSample,
    power_loss: PowerLoss,
    stop: Arc<AtomicBool>,
}

impl WiredTarget {
    /// A board in service, its plant that of the rig, as fast as it goes.
    ///
    /// # Errors
    /// When there is no port, or the board does not answer.
    pub fn start(rig: &Rig) -> Result<WiredTarget> {
        let listener = listener()?;
        let port = port_name(&listener)?;
        let (late, power_loss) = (LateSample::default(), PowerLoss::default());
        let stop = Arc::new(AtomicBool::new(false));
        let target = WiredTarget {
            port,
            late: late.clone(),
            power_loss: Arc::clone(&power_loss),
            stop: Arc::clone(&stop),
        };
        let model = rig.clone();
        std::thread::spawn(move || Level::new(&model, Callers::new(listener), late, power_loss).serve(&stop));
        commission(&target, rig)?;
        Ok(target)
    }

    /// A chip loses its supply just before sample k of the next run.
    pub fn lose_supply(&self, k: u64, loss: Loss) {
        *self.power_loss.lock().unwrap_or_else(PoisonError::into_inner) = Some((k, loss));
    }
}

impl Target for WiredTarget {
    fn name(&self) -> &str {
        "board of chips on SPI"
    }

    fn port(&self) -> &str {
        &self.port
    }
}

impl Delayed for WiredTarget {
    fn delay_sample(&self, k: u64, late_us: u16) {
        self.late.set(k, late_us);
    }
}

impl Drop for WiredTarget {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// What the microcontroller has.
struct Modelled;

impl Lines for Modelled {
    type Encoder = Bus<Ls7366r>;
    type Converter = Bus<Mcp3208>;
    type Valve = Bus<Mcp4922>;
    type Step = OutputLine;
    type Direction = OutputLine;
    type Delay = Microseconds;
    type Enable = OutputLine;
    type HomeSwitch = NoSwitch;
    type Terminals = Terminals;
    type Timer = Microseconds;
    type SpoolMemory = KeptWords;
    type Store = FlashStore<RamFlash, Memory>;
}

/// The board, and the plant at its pins: a run begins with the plant in its initial state.
struct TestBoard {
    board: SpiBoard<Modelled>,
    bench: ChipBench,
}

impl TestBoard {
    fn new(rig: &Rig, wires: &Wires) -> TestBoard {
        let encoder = Rc::new(RefCell::new(Ls7366r::default()));
        let bench = ChipBench::new(rig, Rc::clone(wires), Rc::clone(&encoder));
        let pin = |output| OutputLine(Rc::clone(wires), output);
        let waits = || Microseconds(Rc::clone(wires));
        let Ok(steps) = StepPins::new(pin(Output::Step), pin(Output::Direction), waits());
        let valve = bus(Mcp4922::new(Rc::clone(wires)), wires, VALVE_KHZ);
        let sensors = bus(Mcp3208::new(Rc::clone(wires)), wires, SENSORS_KHZ);
        let counter = Bus::new(Rc::clone(&encoder), wires, ENCODER_KHZ);
        let kept = FlashStore::take_up(RamFlash::default(), RamFlash::layout(), [0; MEMORY_BYTES]);
        let board = SpiBoard {
            name: "board of chips on SPI",
            encoder: ls7366r::Ls7366r::start(counter, waits()).expect("a counter that answers"),
            pressures: mcp3208::Mcp3208::new(sensors, waits(), [0, 1, 2]),
            home_switch: NoSwitch,
            terminals: Terminals::default(),
            stages: Stages::new(
                mcp4922::Mcp4922::new(valve, waits(), Channel::A),
                steps,
                pin(Output::Enable),
            ),
            clock: Clock::start(Microseconds(Rc::clone(wires)), Config::default().timing),
            spool: KeptWords::default(),
            store: kept.expect("the layout is that of this flash").0,
            position: 0,
            enabled_us: 0,
        };
        TestBoard { board, bench }
    }
}

/// A chip on a bus of its own.
fn bus<M: ChipModel>(chip: M, wires: &Wires, khz: u64) -> Bus<M> {
    Bus::new(Rc::new(RefCell::new(chip)), wires, khz)
}

impl Board for TestBoard {
    type Store = FlashStore<RamFlash, Memory>;

    fn store(&mut self) -> &mut Self::Store {
        self.board.store()
    }

    fn name(&self) -> &str {
        self.board.name()
    }

    fn build(&self) -> &'static str {
        self.board.build()
    }

    fn read_sensors(&mut self, config: &Config) -> Sample {
        self.board.read_sensors(config)
    }

    fn drive(&mut self, config: &Config, command: Command) {
        self.board.drive(config, command);
    }

    fn has_converter(&self) -> bool {
        self.board.has_converter()
    }

    fn now_us(&self) -> u64 {
        self.board.now_us()
    }

    /// The board's time is not that of the wall.
    fn host_clock_ms(&self) -> Option<u64> {
        None
    }

    fn inputs(&mut self) -> u8 {
        self.board.inputs()
    }

    fn show(&mut self, outputs: u8) {
        self.board.show(outputs);
    }

    fn emulate_inputs(&mut self, inputs: u8) -> bool {
        self.board.terminals.inputs = inputs;
        true
    }

    fn run_begins(&mut self, config: &Config) {
        self.bench.begin(&config.timing);
    }

    fn starts_referenced(&self) -> bool {
        true
    }

    /// The plant is simulated, yet the counter is one of edges.
    fn may_know_position(&self) -> bool {
        self.board.may_know_position()
    }

    fn keep_spool(&mut self, location: SpoolLocation) {
        self.board.keep_spool(location);
    }
}

impl ClockedBoard for TestBoard {
    type Timer = Microseconds;

    fn clock(&self) -> &Clock<Microseconds> {
        self.board.clock()
    }

    fn clock_mut(&mut self) -> &mut Clock<Microseconds> {
        self.board.clock_mut()
    }

    fn enabled_us(&self) -> u64 {
        self.board.enabled_us()
    }
}

/// The board with its control and its port.
struct Level {
    drive: Drive<TestBoard>,
    wires: Wires,
    callers: Callers,
    late: LateSample,
    power_loss: PowerLoss,
}

impl Level {
    fn new(rig: &Rig, callers: Callers, late: LateSample, power_loss: PowerLoss) -> Level {
        let wires = Wires::default();
        let mut board = TestBoard::new(rig, &wires);
        let mut control = Control::default();
        control.set_referenced().expect("a new drive is disarmed");
        control.take_up(&mut board);
        Level { drive: Drive::new(control, board, 0), wires, callers, late, power_loss }
    }

    fn serve(mut self, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            let Drive { control, board, .. } = &mut self.drive;
            self.callers.listen(control, board);
            self.drive.keep_timing();
            assert!(self.drive.tidy_up(), "this flash takes everything");
            let on_its_way = self.drive.board.bench.is_on_its_way();
            for _ in 0..if on_its_way { SAMPLES_AT_ONCE } else { 1 } {
                if self.callers.wait_for_host() {
                    break;
                }
                self.period().expect("a plant that can be simulated");
            }
            if !on_its_way {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
    }

    /// A sample and its output.
    fn period(&mut self) -> Result<(), IntegrationError> {
        let bench = &mut self.drive.board.bench;
        let late_us = if bench.is_on_its_way() { self.late.lateness_of(bench.k) } else { 0 };
        self.lose_power();
        self.drive.board.bench.sample()?;
        self.interrupt(Mark::Sample, late_us);
        self.interrupt(Mark::Output, 0);
        self.callers.attend(&mut self.drive.control);
        let Drive { control, board, .. } = &mut self.drive;
        inputs::attend(&mut (control, board));
        let mode = self.drive.control.state().supervisor.mode();
        self.drive.board.bench.output(mode)
    }

    /// The timer reaches an instant, and the processor comes to it `late_us` later.
    fn interrupt(&mut self, mark: Mark, late_us: u16) {
        self.wires.borrow_mut().reach(mark, late_us);
        self.drive.tick();
    }

    fn lose_power(&mut self) {
        let bench = &self.drive.board.bench;
        let mut loss = self.power_loss.lock().unwrap_or_else(PoisonError::into_inner);
        match loss.take_if(|(k, _)| bench.is_on_its_way() && *k == bench.k) {
            Some((_, Loss::Off(chip))) => self.wires.borrow_mut().without_supply = Some(chip),
            Some((_, Loss::BrownOut)) => bench.encoder.borrow_mut().lose_power(),
            None => {}
        }
    }
}
