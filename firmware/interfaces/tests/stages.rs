//! The drive stages of a wired board: the enable line is low whenever the drive is disabled, or a command was not taken.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use pneudrive_app::runtime::clock::{Mark, Timer};
use pneudrive_app::runtime::spool::SpoolMemory;
use pneudrive_app::store::NoStore;
use pneudrive_controller::Command;
use pneudrive_controller::drive::{DacCode, DacConfig, DriveConfig, Translator};
use pneudrive_interfaces::wired_board::{Parts, Stages};
use pneudrive_interfaces::{
    Conversions, Direction, EncoderCounter, PressureInput, StepDirection, Terminals, ValveOutput,
};

const SOLENOID: DriveConfig =
    DriveConfig::Dac(DacConfig { null_code: DacCode::new(2000), inverted: false, max_counts: 2000 });
const TRANSLATOR: Translator = Translator { pulse_width_us: 10, direction_setup_us: 10 };
const STEPPER: DriveConfig = DriveConfig::Stepper { max_steps: 40, translator: TRANSLATOR };

/// What has happened on the lines, in its order.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Event {
    Enable(bool),
    Code(u16),
    Step(Direction),
}

/// The lines; those that are broken take nothing.
#[derive(Clone, Default)]
struct Lines {
    story: Rc<RefCell<Vec<Event>>>,
    broken: Rc<RefCell<bool>>,
}

impl Lines {
    fn take(&self, event: Event) -> Result<(), ()> {
        if *self.broken.borrow() {
            return Err(());
        }
        self.story.borrow_mut().push(event);
        Ok(())
    }
}

struct Enable(Lines);

impl ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.story.borrow_mut().push(Event::Enable(false));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.story.borrow_mut().push(Event::Enable(true));
        Ok(())
    }
}

impl ValveOutput for Lines {
    type Error = ();

    fn set_code(&mut self, code: DacCode) -> Result<(), ()> {
        self.take(Event::Code(code.get()))
    }
}

impl StepDirection for Lines {
    type Error = ();

    fn step(&mut self, translator: &Translator, direction: Direction) -> Result<(), ()> {
        assert_eq!(*translator, TRANSLATOR);
        self.take(Event::Step(direction))
    }
}

/// Parts of which these tests need no more than their types.
enum Unused {}

impl EncoderCounter for Unused {
    type Error = Infallible;
    fn count(&mut self) -> Result<i32, Infallible> {
        match *self {}
    }
}

impl PressureInput for Unused {
    type Error = Infallible;
    fn convert(&mut self) -> Result<Conversions, Infallible> {
        match *self {}
    }
}

impl ErrorType for Unused {
    type Error = Infallible;
}

impl InputPin for Unused {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        match *self {}
    }
    fn is_low(&mut self) -> Result<bool, Infallible> {
        match *self {}
    }
}

impl Timer for Unused {
    fn counter(&self) -> u32 {
        match *self {}
    }
    fn instant(&self, _: Mark) -> u32 {
        match *self {}
    }
    fn set_instant(&mut self, _: Mark, _: u32) {
        match *self {}
    }
    fn is_reached(&self, _: Mark) -> bool {
        match *self {}
    }
    fn clear(&mut self, _: Mark) {
        match *self {}
    }
}

impl Terminals for Unused {
    fn read(&mut self) -> u8 {
        match *self {}
    }
    fn write(&mut self, _: u8) {
        match *self {}
    }
}

impl SpoolMemory for Unused {
    fn keep(&mut self, _: [u32; 2]) {
        match *self {}
    }
    fn kept(&self) -> [u32; 2] {
        match *self {}
    }
}

struct TestParts;

impl Parts for TestParts {
    type Encoder = Unused;
    type Pressures = Unused;
    type Valve = Lines;
    type Steps = Lines;
    type Enable = Enable;
    type HomeSwitch = Unused;
    type Terminals = Unused;
    type Timer = Unused;
    type SpoolMemory = Unused;
    type Store = NoStore;
}

/// The stages on these lines, and what happened at their start is forgotten.
fn stages(lines: &Lines) -> Stages<TestParts> {
    let stages = Stages::new(lines.clone(), lines.clone(), Enable(lines.clone()));
    lines.story.borrow_mut().clear();
    stages
}

fn moving(counts: i16, step: i8) -> Command {
    Command { counts, step, drive_enable: true }
}

/// What a command does.
fn driven(
    stages: &mut Stages<TestParts>,
    lines: &Lines,
    config: &DriveConfig,
    command: Command,
) -> Vec<Event> {
    stages.drive(config, command);
    lines.story.take()
}

use Event::{Code, Enable as Gate, Step};

#[test]
fn a_board_starts_disabled_with_its_converter_in_the_middle() {
    let lines = Lines::default();
    let _stages: Stages<TestParts> = Stages::new(lines.clone(), lines.clone(), Enable(lines.clone()));
    assert_eq!(*lines.story.borrow(), [Gate(false), Code(2048)]);
}

#[test]
fn a_drive_is_enabled_after_its_command_and_disabled_before() {
    let lines = Lines::default();
    let mut stages = stages(&lines);
    assert_eq!(driven(&mut stages, &lines, &SOLENOID, moving(100, 0)), [Code(2100), Gate(true)]);
    assert_eq!(driven(&mut stages, &lines, &SOLENOID, Command::OFF), [Gate(false), Code(2000)]);
}

#[test]
fn a_stepper_gets_its_pulse_and_the_amplifier_the_middle() {
    let lines = Lines::default();
    let mut stages = stages(&lines);
    let mut step = |step| driven(&mut stages, &lines, &STEPPER, moving(7, step));
    assert_eq!(step(1), [Code(2048), Step(Direction::Extend), Gate(true)]);
    assert_eq!(step(-1), [Code(2048), Step(Direction::Retract), Gate(true)]);
    assert_eq!(step(0), [Code(2048), Gate(true)]);
}

#[test]
fn a_command_that_is_not_taken_disables_the_drive_until_it_was_told_to_be() {
    for config in [SOLENOID, STEPPER] {
        let lines = Lines::default();
        let mut stages = stages(&lines);
        driven(&mut stages, &lines, &config, moving(0, 0));
        lines.broken.replace(true);
        assert_eq!(driven(&mut stages, &lines, &config, moving(5, 1)), [Gate(false)]);
        lines.broken.replace(false);
        let again = driven(&mut stages, &lines, &config, moving(5, 1));
        assert!(!again.contains(&Gate(true)), "{again:?}: the supervisor does not know yet");
        driven(&mut stages, &lines, &config, Command::OFF);
        assert!(driven(&mut stages, &lines, &config, moving(5, 1)).contains(&Gate(true)));
    }
}
