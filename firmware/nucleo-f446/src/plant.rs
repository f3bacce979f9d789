//! The control of a plant that is simulated on a PC, in lock step: USART3 on PC10 and PC11 carries the plant bus
//! ([`pneudrive_app::plant_link`]), 921,600 baud, both directions by DMA. The last byte of an answer interrupts.
//!
//! Nothing is driven: `drive_enable` is held low, every other line of valve and sensors stays an input.

use core::sync::atomic::{AtomicU8, Ordering, compiler_fence, fence};

use cortex_m::peripheral::{DCB, DWT};
use pneudrive_app::lock_step::Stopwatch;
use pneudrive_app::plant_bus::{Inputs, Outputs};
use pneudrive_app::plant_link::{Line, PlantLink};
use pneudrive_app::runtime::drive::REST_US;
use pneudrive_app::runtime::talk::Served;
use pneudrive_app::{LockStep, Recorder};
use stm32f4xx_hal::gpio::{GpioExt, Output, PB10, PC10, PC11, PinState};
use stm32f4xx_hal::pac::{CorePeripherals, GPIOB, Peripherals, USART3};
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::{Config, DmaConfig, InvalidConfig};
use stm32f4xx_hal::serial::{Serial, SerialExt};
use stm32f4xx_hal::time::Bps;

use crate::dma::{Stream, streams};
use crate::port::{BAUD, Port};
use crate::start::{PROCESSOR_MHZ, Store, clocks, store, take_up};
use crate::watchdog::Watchdog;
use crate::{Control, Talk, reset};

/// Nothing is stored before the drive has been disabled for this long: as on the board with a cylinder.
const REST_CYCLES: u32 = PROCESSOR_MHZ * REST_US as u32;

/// The control, its board, and the plant's line: what the two tasks share.
pub struct PlantDrive {
    pub control: Control,
    pub board: LockStep<Store>,
    link: PlantLink<PlantLine>,
    cycles: Cycles,
    /// When the drive was last seen enabled, until it has rested.
    enabled: Option<u32>,
    _drive_enable: PB10<Output>,
}

impl PlantDrive {
    /// The line's interrupt: the plant has answered.
    pub fn tick(&mut self) {
        self.link.attend(&mut self.control, &mut self.board, &self.cycles);
    }
}

impl Served for PlantDrive {
    type Board = LockStep<Store>;
    type Recorder = &'static mut Recorder;

    fn parts(&mut self) -> (&mut Control, &mut LockStep<Store>) {
        (&mut self.control, &mut self.board)
    }

    /// The control runs when the plant says so, and a plant that is silent does not stall the board: true. Looks
    /// whether it is silent.
    fn has_run(&mut self) -> bool {
        self.control.settle_timing();
        self.link.watch(&mut self.control, &mut self.board, &self.cycles);
        true
    }

    /// The plant waits.
    fn has_time(&self) -> bool {
        true
    }

    /// The plant is told the timing when a run begins.
    fn keep_timing(&mut self) {}

    /// What waits for a disabled drive. False when the flash does not take it.
    fn tidy_up(&mut self) -> bool {
        if self.control.state().supervisor.drives() {
            self.enabled = Some(self.cycles.now());
        }
        if self.enabled.is_some_and(|enabled| self.cycles.since(enabled) < REST_CYCLES) {
            return true;
        }
        self.enabled = None;
        self.control.tidy_up(&mut self.board).is_ok()
    }
}

/// Starts everything. Runs once, with interrupts disabled; a failure here is a breakdown.
pub fn start(
    core: CorePeripherals,
    device: Peripherals,
    recorder: &'static mut Recorder,
) -> (PlantDrive, Talk) {
    let reset = reset::reason(&device.RCC);
    let mut watchdog = Watchdog::new(device.IWDG, &device.DBGMCU);
    let mut rcc = clocks(device.RCC, &device.GPIOA);
    let (a, b, c) =
        (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));

    // First of all the line that must be low.
    let drive_enable = b.pb10.into_push_pull_output_in_state(PinState::Low);
    let mut control = Control::with_recorder(recorder);
    let store =
        store(device.FLASH, watchdog).unwrap_or_else(|_| panic!("the plan's layout is that of this flash"));
    let mut board = LockStep::new("Nucleo-F446RE, plant bus", store).with_watchdog();
    take_up(&mut control, &mut board, &reset);
    let (inputs, outputs, received, sent) = streams(device.DMA1, &mut rcc);
    let port = Port::open(device.USART2, (received, sent), (a.pa2, a.pa3), &mut rcc);
    let port = port.unwrap_or_else(|_| panic!("APB1 runs at 45 MHz"));
    let line = PlantLine::open(device.USART3, (inputs, outputs), (c.pc10, c.pc11), &mut rcc);
    let line = line.unwrap_or_else(|_| panic!("APB1 runs at 45 MHz"));
    let cycles = Cycles::start(core.DCB, core.DWT);
    let link = PlantLink::new(line, PROCESSOR_MHZ * 1000, &cycles);
    watchdog.start();
    let drive = PlantDrive { control, board, link, cycles, enabled: None, _drive_enable: drive_enable };
    (drive, Talk::new(port, watchdog))
}

/// Drive disabled, from wherever the program is.
pub fn switch_off() {
    // SAFETY: the program does not go on after this, so nobody else uses this register.
    unsafe { GPIOB::steal() }.bsrr().write(|w| w.br10().set_bit());
}

/// The processor's cycles, which wrap after 23 s.
struct Cycles(());

impl Cycles {
    fn start(mut debug: DCB, mut counter: DWT) -> Cycles {
        debug.enable_trace();
        counter.enable_cycle_counter();
        Cycles(())
    }
}

impl Stopwatch for Cycles {
    /// No work is moved across the reading.
    fn now(&self) -> u32 {
        compiler_fence(Ordering::SeqCst);
        let now = DWT::cycle_count();
        compiler_fence(Ordering::SeqCst);
        now
    }

    fn since(&self, reading: u32) -> u32 {
        self.now().wrapping_sub(reading)
    }
}

static ANSWER: [AtomicU8; Inputs::BYTES] = [const { AtomicU8::new(0) }; Inputs::BYTES];
static SAID: [AtomicU8; Outputs::BYTES] = [const { AtomicU8::new(0) }; Outputs::BYTES];

/// USART3.
struct PlantLine {
    usart: USART3,
    inputs: Stream<1>,
    outputs: Stream<3>,
}

impl PlantLine {
    fn open(
        usart: USART3,
        (inputs, outputs): (Stream<1>, Stream<3>),
        pins: (PC10, PC11),
        rcc: &mut Rcc,
    ) -> Result<PlantLine, InvalidConfig> {
        let config = Config::default().baudrate(Bps(BAUD)).dma(DmaConfig::TxRx);
        let serial: Serial<USART3> = usart.serial(pins, config, rcc)?;
        let (usart, _) = serial.release();
        Ok(PlantLine { usart, inputs, outputs })
    }

    /// Whether a byte was lost or damaged since [`PlantLine::forget`].
    fn is_disturbed(&self) -> bool {
        let state = self.usart.sr().read();
        state.ore().bit_is_set() || state.fe().bit_is_set() || state.nf().bit_is_set()
    }

    /// A byte that nobody has taken, and the errors: the state is read, then the data.
    fn forget(&self) {
        let _ = self.usart.sr().read();
        let _ = self.usart.dr().read();
    }
}

impl Line for PlantLine {
    fn ask<const N: usize>(&mut self, bytes: [u8; N], answer_bytes: usize) {
        let port = self.usart.dr().as_ptr().cast();
        self.forget();
        self.inputs.fill(port, &ANSWER, answer_bytes);
        SAID.iter().zip(bytes).for_each(|(to, from)| to.store(from, Ordering::Relaxed));
        self.outputs.send(port, &SAID, N);
    }

    fn answer<const N: usize>(&mut self) -> Option<[u8; N]> {
        if self.inputs.is_on() {
            return None;
        }
        self.inputs.clear_flags();
        if self.is_disturbed() {
            return None;
        }
        // What the stream has written is read after its end.
        fence(Ordering::Acquire);
        let mut bytes = [0; N];
        bytes.iter_mut().zip(&ANSWER).for_each(|(to, from)| *to = from.load(Ordering::Relaxed));
        Some(bytes)
    }
}
