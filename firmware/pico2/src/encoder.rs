//! PIO0: 32 bits of quadrature counts, all four edges of a period ([`pneudrive_plan::pico2::quadrature`]).

use pneudrive_interfaces::EncoderCounter;
use pneudrive_plan::pico2::quadrature::{CYCLES_A_ROUND, MISSED, first_look, program};
use rp235x_hal::gpio::bank0::{Gpio2, Gpio3};
use rp235x_hal::gpio::{FunctionPio0, Pin, PullUp};
use rp235x_hal::pac::{PIO0, RESETS};
use rp235x_hal::pio::{
    InstallError, PIO, PIO0SM0, PIOBuilder, PIOExt, Running, Rx, ShiftDirection, StateMachine,
};

/// The system clock is divided by this: 16 MHz, so the tracks are looked at 1.6 million times a second and more.
const DIVIDER: u16 = 8;

/// What the state machine has offered already when it is asked: four counts in its queue.
const QUEUED: u32 = 4;

/// Looks at the queue until the count of the next round is there: ten times a round and more.
const PATIENCE: u32 = 10 * CYCLES_A_ROUND * DIVIDER as u32;

/// The tracks, pulled up: a wire that is off counts nothing, where an open input would count what it picks up.
pub type Pins = (Pin<Gpio2, FunctionPio0, PullUp>, Pin<Gpio3, FunctionPio0, PullUp>);

/// The first of the two pins.
const FIRST_PIN: u8 = 2;

/// Why there is no count.
pub enum NoCount {
    /// The state machine stands.
    Stands,
    /// Both tracks have changed at once: the count is wrong from then on, until the next reset.
    Missed,
}

/// The encoder's counter.
pub struct Encoder {
    pio: PIO<PIO0>,
    counts: Rx<PIO0SM0>,
    _machine: StateMachine<PIO0SM0, Running>,
}

impl Encoder {
    /// Starts counting from 0, with the tracks as they are.
    ///
    /// # Errors
    /// When the program does not fit.
    pub fn start(device: PIO0, _: Pins, resets: &mut RESETS) -> Result<Encoder, InstallError> {
        let (mut pio, machine, ..) = device.split(resets);
        let installed = pio.install(&program())?;
        let (mut machine, counts, _) = PIOBuilder::from_installed_program(installed)
            .in_pin_base(FIRST_PIN)
            .in_shift_direction(ShiftDirection::Left)
            .out_shift_direction(ShiftDirection::Right)
            .clock_divisor_fixed_point(DIVIDER, 0)
            .build(machine);
        for instruction in first_look() {
            machine.exec_instruction(instruction);
        }
        let machine = machine.start();
        Ok(Encoder { pio, counts, _machine: machine })
    }
}

impl EncoderCounter for Encoder {
    type Error = NoCount;

    /// The counts in the queue are old; the one that comes behind them is of now.
    #[inline]
    fn count(&mut self) -> Result<i32, NoCount> {
        for _ in 0..QUEUED {
            let _ = self.counts.read();
        }
        for _ in 0..PATIENCE {
            if let Some(count) = self.counts.read() {
                let missed = self.pio.get_irq_raw() >> MISSED & 1 == 1;
                return if missed { Err(NoCount::Missed) } else { Ok(count.cast_signed()) };
            }
        }
        Err(NoCount::Stands)
    }
}
