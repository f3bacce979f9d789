//! A translator on two pins: the direction stands before the pulse, and the pulse lasts.

use std::cell::RefCell;
use std::convert::Infallible;
use std::io;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use pneudrive_controller::drive::Translator;
use pneudrive_interfaces::step_pins::{PinError, StepPins};
use pneudrive_interfaces::{Direction, StepDirection};

const TRANSLATOR: Translator = Translator { pulse_width_us: 10, direction_setup_us: 25 };

/// What happens on the lines, in its order.
type Story = Rc<RefCell<Vec<(&'static str, u64)>>>;

/// A line, or the time that passes.
#[derive(Clone)]
struct Line(&'static str, Story);

impl Line {
    fn tell(&self, value: u64) {
        self.1.borrow_mut().push((self.0, value));
    }
}

impl ErrorType for Line {
    type Error = Infallible;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.tell(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.tell(1);
        Ok(())
    }
}

impl DelayNs for Line {
    fn delay_ns(&mut self, ns: u32) {
        self.tell(u64::from(ns));
    }
}

fn story_of(direction: Direction) -> Vec<(&'static str, u64)> {
    let story = Story::default();
    let line = |name| Line(name, Rc::clone(&story));
    let Ok(mut pins) = StepPins::new(line("step"), line("direction"), line("ns"));
    let Ok(()) = pins.step(&TRANSLATOR, direction);
    story.borrow().clone()
}

#[test]
fn the_direction_stands_for_its_set_up_time_before_a_pulse_of_its_width() {
    let step = |direction| {
        vec![("step", 0), ("direction", direction), ("ns", 25_000), ("step", 1), ("ns", 10_000), ("step", 0)]
    };
    assert_eq!(story_of(Direction::Extend), step(1));
    assert_eq!(story_of(Direction::Retract), step(0));
}

#[test]
fn without_a_direction_there_is_no_pulse() {
    let broken = MockError::Io(io::ErrorKind::Other);
    let mut step = Mock::new(&[Transaction::set(State::Low)]);
    let mut direction = Mock::new(&[Transaction::set(State::High).with_error(broken.clone())]);
    let delay = Line("ns", Story::default());
    let mut pins = StepPins::new(step.clone(), direction.clone(), delay).expect("a step line");
    assert_eq!(pins.step(&TRANSLATOR, Direction::Extend), Err(PinError::Direction(broken)));
    step.done();
    direction.done();
}
