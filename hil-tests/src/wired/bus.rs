//! The bus to a chip, in time: the chip's clock, its select and the waits of its driver pass on the lines' own nanoseconds.
//! A frame that is faster than the chip's data sheet allows is refused: the chip does not hear it, and its output stays
//! undriven.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

use super::Chip;
use super::wires::Wires;

/// The shortest times that a data sheet asks for, ns.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The select is high between two frames.
    pub high_ns: u64,
    /// The clock rests before the select falls.
    pub idle_ns: u64,
    /// From the select's fall to the first rising edge of the clock.
    pub setup_ns: u64,
    /// From the last rising edge of the clock to the select's rise.
    pub hold_ns: u64,
    /// Each half of a clock.
    pub half_clock_ns: u64,
}

/// A chip on SPI, mode 0.
pub trait ChipModel {
    /// Which it is.
    const CHIP: Chip;

    /// How fast it may be talked to.
    const LIMITS: Limits;

    /// The chip select falls.
    fn select(&mut self);

    /// One clock: the bit on its input, and the bit on its output; true where nothing drives it, as the bus is
    /// pulled up.
    fn clock(&mut self, input: bool) -> bool;

    /// The chip select rises.
    fn deselect(&mut self);
}

/// The bus to a chip, with its chip select.
pub struct Bus<M> {
    pub chip: Rc<RefCell<M>>,
    wires: Wires,
    half_clock_ns: u64,
    /// When the select last rose.
    risen_ns: u64,
    /// When the clock last rose.
    clocked_ns: u64,
}

/// A frame on its way.
struct Frame {
    selected_ns: u64,
    has_clocked: bool,
    is_heard: bool,
}

impl<M: ChipModel> Bus<M> {
    /// A bus with this clock, kHz.
    pub fn new(chip: Rc<RefCell<M>>, wires: &Wires, khz: u64) -> Bus<M> {
        let wires = Rc::clone(wires);
        Bus { chip, wires, half_clock_ns: 500_000 / khz, risen_ns: 0, clocked_ns: 0 }
    }

    fn now_ns(&self) -> u64 {
        self.wires.borrow().passed_ns
    }

    fn wait(&self, ns: u64) {
        self.wires.borrow_mut().passed_ns += ns;
    }

    fn select(&self) -> Frame {
        let now = self.now_ns();
        let Limits { high_ns, idle_ns, half_clock_ns, .. } = M::LIMITS;
        let is_heard = now - self.risen_ns >= high_ns
            && now - self.clocked_ns >= idle_ns
            && self.half_clock_ns >= half_clock_ns
            && self.wires.borrow().without_supply != Some(M::CHIP);
        if is_heard {
            self.chip.borrow_mut().select();
        }
        Frame { selected_ns: now, has_clocked: false, is_heard }
    }

    fn clock(&mut self, frame: &mut Frame, input: bool) -> bool {
        self.wait(self.half_clock_ns);
        self.clocked_ns = self.now_ns();
        let is_too_soon = !frame.has_clocked && self.clocked_ns - frame.selected_ns < M::LIMITS.setup_ns;
        frame.is_heard &= !is_too_soon;
        frame.has_clocked = true;
        self.wait(self.half_clock_ns);
        !frame.is_heard || self.chip.borrow_mut().clock(input)
    }

    fn exchange(&mut self, frame: &mut Frame, sent: u8) -> u8 {
        (0..8)
            .rev()
            .fold(0, |received, bit| received << 1 | u8::from(self.clock(frame, sent >> bit & 1 == 1)))
    }

    fn deselect(&mut self, frame: &Frame) {
        self.risen_ns = self.now_ns();
        if frame.is_heard && self.risen_ns - self.clocked_ns >= M::LIMITS.hold_ns {
            self.chip.borrow_mut().deselect();
        }
    }
}

impl<M> ErrorType for Bus<M> {
    type Error = Infallible;
}

impl<M: ChipModel> SpiDevice for Bus<M> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let mut frame = self.select();
        for operation in operations {
            match operation {
                Operation::DelayNs(ns) => self.wait(u64::from(*ns)),
                Operation::TransferInPlace(bytes) => {
                    bytes.iter_mut().for_each(|byte| *byte = self.exchange(&mut frame, *byte));
                }
                Operation::Read(_) | Operation::Write(_) | Operation::Transfer(_, _) => {
                    unreachable!("no driver does this")
                }
            }
        }
        self.deselect(&frame);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use embedded_hal::delay::DelayNs;
    use pneudrive_controller::drive::DacCode;
    use pneudrive_interfaces::chip::{ls7366r, mcp3208, mcp4922};
    use pneudrive_interfaces::{EncoderCounter, PressureInput, ValveOutput};

    use super::*;
    use crate::wired::chips::{Ls7366r, Mcp3208, Mcp4922};
    use crate::wired::wires::Microseconds;

    /// Nobody waits.
    struct Hasty;

    impl DelayNs for Hasty {
        fn delay_ns(&mut self, _: u32) {}
    }

    fn sensors<D: DelayNs>(wires: &Wires, khz: u64, delay: D) -> mcp3208::Mcp3208<Bus<Mcp3208>, D> {
        let chip = Rc::new(RefCell::new(Mcp3208::new(Rc::clone(wires))));
        mcp3208::Mcp3208::new(Bus::new(chip, wires, khz), delay, [0, 1, 2])
    }

    fn waiting(wires: &Wires) -> Microseconds {
        Microseconds(Rc::clone(wires))
    }

    /// The second and third conversion began some 30 ns after the one before.
    #[test]
    fn a_converter_whose_select_was_high_too_shortly_gives_no_pressure() {
        let wires = Wires::default();
        assert!(sensors(&wires, 1000, waiting(&wires)).convert().is_ok());
        assert!(sensors(&wires, 1000, Hasty).convert().is_err());
    }

    #[test]
    fn a_converter_that_is_clocked_too_fast_gives_no_pressure() {
        let wires = Wires::default();
        assert!(sensors(&wires, 2000, waiting(&wires)).convert().is_ok());
        assert!(sensors(&wires, 2500, waiting(&wires)).convert().is_err());
    }

    #[test]
    fn a_valve_converter_that_is_given_no_rest_keeps_its_code() {
        let wires = Wires::default();
        let bus = || Bus::new(Rc::new(RefCell::new(Mcp4922::new(Rc::clone(&wires)))), &wires, 20_000);
        let mut waits = mcp4922::Mcp4922::new(bus(), waiting(&wires), mcp4922::Channel::A);
        let mut volts = |code| {
            waits.set_code(DacCode::new(code)).expect("the bus works");
            wires.borrow().command_v
        };
        let [low, high] = [volts(0), volts(4095)];
        assert!(low < high, "{low:?} {high:?}");

        let mut hastes = mcp4922::Mcp4922::new(bus(), Hasty, mcp4922::Channel::A);
        hastes.set_code(DacCode::new(0)).expect("the bus works");
        hastes.set_code(DacCode::new(4095)).expect("the bus works");
        assert_eq!(wires.borrow().command_v, low, "the second frame came at once");
    }

    #[test]
    fn a_counter_that_is_given_no_rest_does_not_start() {
        let wires = Wires::default();
        let bus = || Bus::new(Rc::new(RefCell::new(Ls7366r::default())), &wires, 2000);
        let mut counter = ls7366r::Ls7366r::start(bus(), waiting(&wires)).expect("a counter that answers");
        assert_eq!(counter.count(), Ok(0));
        assert!(ls7366r::Ls7366r::start(bus(), Hasty).is_err());
    }
}
