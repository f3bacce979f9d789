//! The board: its peripherals at their addresses, updated to the present time whenever one is accessed.
//!
//! | module | holds |
//! |---|---|
//! | [`bus`] | which peripheral is at which address |
//! | [`idle`] | what may be left out of a task that only polls |
//!
//! Nothing here runs on its own. A peripheral knows when something will happen to it, and [`Board::settle`] makes it
//! happen once that time has come; [`Board::horizon`] tells how far the processor may go before somebody must look.
//! While the idle task only polls, its rounds are left out and the time goes on to the next event.

mod bus;
pub use bus::{BIT_BAND, PERIPHERALS};
mod idle;

use pneudrive_protocol::io::input;

use crate::bench::{Driven, PinBench};
use crate::peripheral::adc::Adc;
use crate::peripheral::control_timer::{ControlTimer, Matches};
use crate::peripheral::dac::Dac;
use crate::peripheral::dma::{Dma, Memory};
use crate::peripheral::encoder_timer::{EncoderTimer, tracks_at};
use crate::peripheral::flash::Flash;
use crate::peripheral::gpio::Port;
use crate::peripheral::pulse_timer::{Pulse, PulseTimer};
use crate::peripheral::pwr::Pwr;
use crate::peripheral::rcc::{Cause, Clocks, Rcc};
use crate::peripheral::system::System;
use crate::peripheral::usart::Usart;
use crate::peripheral::watchdog::Watchdog;
use crate::register::Words;
use crate::tap::{Begun, Tap};
use crate::time::{Corner, Ticks};

/// Ports of pins.
const A: usize = 0;
const B: usize = 1;
const C: usize = 2;

/// Pins of port C with the digital inputs, in the order of their bits.
const INPUTS: [u32; 8] = [2, 3, 4, 5, 6, 8, 9, 12];

/// Channel 4 of DMA1: its stream 5 fills memory from USART2, its stream 6 empties it.
const RECEIVER: u32 = 5;
const SENDER: u32 = 6;
const SERIAL_CHANNEL: u32 = 4;

/// Clocks that stand still count as running at this.
const NO_CLOCK: Clocks = Clocks { core: 45, apb1: 45, apb1_timers: 45, apb2: 45 };

/// Why the processor does not go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The board was reset.
    Reset(Cause),
    /// The power has gone in an operation of the flash.
    Dark,
    /// The board does what its models do not know, or the plant cannot be simulated.
    Broken(String),
}

/// How late the control was at most, since it was last asked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lateness {
    /// From the instant of a sample to the reading of the encoder, ticks.
    pub sample: Ticks,
    /// From the instant of an output to the code of the DAC, ticks.
    pub output: Ticks,
}

/// The board without its processor.
pub struct Board {
    /// The present.
    pub now: Ticks,
    /// What is not known more closely.
    pub corner: Corner,
    /// The flash.
    pub flash: Flash,
    /// What the board is wired to.
    pub bench: PinBench,
    /// Whether somebody waits for the processor to stop, and why.
    pub stop: Option<Stop>,
    /// A debugger has halted the processor.
    pub halted: bool,
    /// The processor has locked up in a fault.
    pub locked_up: bool,
    /// What the board has said to the host, and nobody has taken yet.
    pub unread: Vec<u8>,
    /// Faults of the processor: what the emulator says of each, and where.
    pub faults: Vec<String>,
    /// How late the control was.
    pub lateness: Lateness,
    /// When `drive_enable` has changed, and to what.
    pub enable_log: Vec<(Ticks, bool)>,
    /// The converter gives no conversion any more: through resets.
    adc_stuck: bool,
    /// The crystal's clock comes: through resets.
    crystal: bool,
    clocks: Option<Clocks>,
    rcc: Rcc,
    pwr: Pwr,
    ports: [Port; 3],
    /// The levels at the digital inputs.
    inputs: u8,
    encoder: EncoderTimer,
    pulses: PulseTimer,
    timer: ControlTimer,
    adc: Adc,
    dma_1: Dma,
    dma_2: Dma,
    dac: Dac,
    usart: Usart,
    watchdog: Watchdog,
    system: System,
    debug: Words<3>,
    tap: Tap,
    idle: idle::Idle,
    /// The position whose tracks the encoder shows.
    shown: i32,
    /// Pulses that have not risen yet, and the direction of each.
    coming: Vec<(Pulse, bool)>,
    /// Steps since the last sample instant.
    steps: i8,
    matched: Matches,
    /// Tasks that have not begun to work on what is due: a sample, an output.
    awaited: [Option<Ticks>; 2],
    until: Ticks,
}

impl Board {
    /// A board that has just been given power.
    #[must_use]
    pub fn new(cells: Vec<u8>, bench: PinBench, corner: Corner) -> Board {
        let shown = bench.sample.position;
        let mut board = Board {
            now: 0,
            corner,
            flash: Flash::new(cells, corner),
            bench,
            stop: None,
            halted: false,
            locked_up: false,
            unread: Vec::new(),
            faults: Vec::new(),
            lateness: Lateness::default(),
            enable_log: Vec::new(),
            adc_stuck: false,
            crystal: true,
            clocks: None,
            rcc: Rcc::new(Cause::Power),
            pwr: Pwr::default(),
            ports: after_reset(),
            inputs: 0,
            encoder: EncoderTimer::new(tracks_at(shown)),
            pulses: PulseTimer::new(NO_CLOCK.apb1_timers),
            timer: ControlTimer::new(NO_CLOCK.apb1_timers, 0),
            adc: Adc::new(false),
            dma_1: Dma::default(),
            dma_2: Dma::default(),
            dac: Dac::default(),
            usart: Usart::new(NO_CLOCK.apb1),
            watchdog: Watchdog::new(corner.watchdog_hz),
            system: System::default(),
            debug: Words::after_reset(&[]),
            tap: Tap::default(),
            idle: idle::Idle::default(),
            shown,
            coming: Vec::new(),
            steps: 0,
            matched: [None; 2],
            awaited: [None; 2],
            until: 0,
        };
        board.follow_clocks();
        board
    }

    /// What a reset leaves: memory, flash, wires, and the time.
    pub fn reset(&mut self, cause: Cause) {
        let was_enabled = self.enabled();
        self.rcc = Rcc::new(cause);
        self.rcc.crystal = self.crystal;
        (self.pwr, self.ports) = (Pwr::default(), after_reset());
        (self.dma_1, self.dma_2) = (Dma::default(), Dma::default());
        (self.dac, self.system) = (Dac::default(), System::default());
        self.adc = Adc::new(self.adc_stuck);
        self.set_inputs(self.inputs);
        self.watchdog = Watchdog::new(self.corner.watchdog_hz);
        let cells = self.flash.cells().to_vec();
        self.flash = Flash::new(cells, self.corner);
        self.clocks = None;
        self.follow_clocks();
        for gate in [bus::TIM2, bus::TIM4, bus::TIM5, bus::USART2] {
            self.renew(gate);
        }
        (self.stop, self.locked_up, self.matched, self.awaited) = (None, false, [None; 2], [None; 2]);
        self.coming.clear();
        if was_enabled {
            self.enable_log.push((self.now, false));
        }
    }

    /// Makes happen what was due up to now.
    pub fn settle(&mut self, memory: &mut dyn Memory) {
        self.take_pulses();
        let matches = self.timer.settle(self.now);
        self.follow_matches(matches);
        while let Some(channel) = self.adc.done(self.now) {
            if let Some(code) = self.adc.convert(self.volts_at(channel))
                && self.dma_2.serves(0, 0)
            {
                self.dma_2.deliver(0, &code.to_le_bytes(), memory);
            }
        }
        while self.usart.has_come(self.now) {
            self.idle.something_happens();
            let serves = self.dma_1.serves(RECEIVER, SERIAL_CHANNEL);
            if let Some(byte) = self.usart.receive(self.now, serves) {
                self.dma_1.deliver(RECEIVER, &[byte], memory);
            }
        }
        if let Some(bytes) = self.usart.sent(self.now) {
            self.idle.something_happens();
            self.dma_1.complete(SENDER);
            self.unread.extend(bytes);
        }
        if self.watchdog.bites_at().is_some_and(|bites| bites <= self.now) {
            self.stop.get_or_insert(Stop::Reset(Cause::Watchdog));
        }
    }

    /// Pulses that have risen by now move a stepper.
    fn take_pulses(&mut self) {
        let now = self.now;
        for (_, extends) in self.coming.extract_if(.., |(pulse, _)| pulse.rises <= now) {
            self.steps = self.steps.saturating_add(if extends { 1 } else { -1 });
        }
    }

    fn follow_matches(&mut self, matches: Matches) {
        for (channel, matched) in matches.into_iter().enumerate() {
            if let Some(count) = matched {
                self.matched[channel] = Some(count);
                self.awaited[channel] = Some(self.timer.ticks_of(count));
            }
        }
        let Some(sample) = matches[0] else { return };
        let steps = std::mem::take(&mut self.steps);
        let volts = self.ports[A].is_analogue(4).then(|| self.dac.volts());
        let driven = Driven { enabled: self.enabled(), volts, steps };
        if driven.enabled && !self.bench.lives() && self.inputs & input::START != 0 {
            self.bench.begin(Begun::Homing);
        }
        match self.bench.sample_due(sample, self.matched[1], driven) {
            Ok(()) => self.show(),
            Err(broken) => self.stop = Some(Stop::Broken(format!("the plant stopped: {broken}"))),
        }
    }

    /// Wires the digital inputs, as `pneudrive_protocol::io::input` has their bits.
    pub fn set_inputs(&mut self, inputs: u8) {
        self.inputs = inputs;
        for (bit, pin) in INPUTS.into_iter().enumerate() {
            self.ports[C].wire(pin, Some(inputs & 1 << bit != 0));
        }
    }

    /// The sensors show the present sample.
    fn show(&mut self) {
        self.ports[A].wire(9, self.bench.sample.home_switch.then_some(false));
        let wired = [0, 1].map(|pin| self.ports[A].is_alternate(pin, 1));
        while self.shown != self.bench.sample.position {
            self.shown += (self.bench.sample.position - self.shown).signum();
            let tracks = tracks_at(self.shown);
            let on = |track: usize| tracks[track] && wired[track] && !self.bench.wiring.tracks_off[track];
            self.encoder.see([on(0), on(1)]);
        }
    }

    /// The voltage at a channel of the converter.
    fn volts_at(&self, channel: u32) -> f64 {
        let (port, pin, sensor) = match channel {
            10 => (C, 0, 0),
            11 => (C, 1, 1),
            8 => (B, 0, 2),
            _ => return 0.0,
        };
        if self.ports[port].is_analogue(pin) { self.bench.volts()[sensor] } else { 0.0 }
    }

    /// What stands at the pin of the DAC, V.
    #[must_use]
    pub fn dac_volts(&self) -> f64 {
        self.dac.volts()
    }

    /// Whether `drive_enable` is high. Its resistor holds it low while the program does not drive it.
    #[must_use]
    pub fn enabled(&self) -> bool {
        self.ports[B].driven(10) == Some(true)
    }

    /// How far the processor may go before somebody must look.
    #[must_use]
    pub fn horizon(&self) -> Ticks {
        let events = [self.timer.next_match(), self.watchdog.bites_at()];
        events.into_iter().flatten().fold(self.until, Ticks::min)
    }

    /// Allows the processor to run until then.
    pub fn go_until(&mut self, until: Ticks) {
        self.until = until;
    }

    /// The interrupt controller, and whether the clock security system and TIM5 ask for an exception.
    #[must_use]
    pub fn asks(&self) -> (&System, bool, bool) {
        (&self.system, self.rcc.tells_clock_loss(), self.timer.interrupts())
    }

    /// The interrupt controller; an exception begins or ends.
    pub fn system(&mut self) -> &mut System {
        self.idle.something_happens();
        &mut self.system
    }

    /// Ticks of a cycle of the processor; None while it stands still.
    #[must_use]
    pub fn cycle(&self) -> Option<Ticks> {
        let runs = !self.halted && !self.locked_up;
        self.clocks.filter(|_| runs).map(|clocks| clocks.core)
    }

    /// The time goes on while the processor stands still: to the next event.
    pub fn pass_time(&mut self) {
        let bytes = [self.usart.next_arrival(), self.usart.sent_at()];
        let next = bytes.into_iter().flatten().fold(self.horizon(), Ticks::min);
        self.now = self.now.max(next);
    }

    /// Receives a byte from the host; returns whether it completes a request.
    pub fn hear(&mut self, byte: u8, noisy: bool) -> bool {
        let byte = if noisy { byte ^ 0x10 } else { byte };
        self.usart.hear(byte, noisy, self.now);
        self.idle.something_happens();
        self.tap.request(byte)
    }

    /// The 8 MHz of the ST-LINK fail.
    pub fn lose_crystal(&mut self) {
        self.crystal = false;
        let _ = self.rcc.lose_crystal();
        self.follow_clocks();
    }

    /// The converter gives no conversion any more.
    pub fn stick_converter(&mut self) {
        (self.adc_stuck, self.adc.stuck) = (true, true);
    }

    /// A debugger halts the processor. What it freezes beside, the program has said (RM0390 33.16.3).
    pub fn halt(&mut self) {
        const TIM5_STOP: u32 = 3;
        const IWDG_STOP: u32 = 12;
        self.halted = true;
        if self.debug.bit(bus::APB1_FZ, TIM5_STOP) {
            self.timer.freeze(true, self.now);
        }
        if self.debug.bit(bus::APB1_FZ, IWDG_STOP) {
            self.watchdog.hold(true, self.now);
        }
    }

    /// Timers and line run at what the clock control makes of them.
    fn follow_clocks(&mut self) {
        let clocks = self.rcc.clocks();
        if clocks != self.clocks {
            self.clocks = clocks;
            let clocks = clocks.unwrap_or(NO_CLOCK);
            self.timer.set_clock(clocks.apb1_timers, self.now);
            self.usart.set_clock(clocks.apb1);
        }
    }

    /// Notes how late a task is that begins to work on what is due.
    fn note_lateness(&mut self, task: usize) {
        if let Some(due) = self.awaited[task].take().filter(|_| self.enabled()) {
            let late = self.now.saturating_sub(due);
            let most = [&mut self.lateness.sample, &mut self.lateness.output];
            let most = most.into_iter().nth(task).expect("two tasks");
            *most = (*most).max(late);
        }
    }
}

/// The ports A, B and C after a reset: A and B have pins of the debugger.
fn after_reset() -> [Port; 3] {
    [Port::new(0xa800_0000, 0x6400_0000), Port::new(0x0000_0280, 0x0000_0100), Port::new(0, 0)]
}
