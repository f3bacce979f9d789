//! The command of the continuous controller and the hysteresis on it, checked in a transient.

use super::super::{END_GUARDS, GUARDS, STATES, scale_of};
use super::*;
use crate::assembly::build;
use crate::component::friction::Contact;
use crate::values::Rig;
use pneudrive_solver::{Integrator, Method};

/// Half the width of the loop of servo-drive B, m.
const HALF_WIDTH: f64 = 0.05e-3;

/// Servo-drive B under the continuous controller, at the start of a move.
struct Transient {
    assembly: Assembly,
    integrator: Integrator<STATES, GUARDS, END_GUARDS>,
}

impl Transient {
    fn new(settings: &[String], target: i32) -> Transient {
        let continuous = "controller.model=continuous".to_owned();
        let settings: Vec<String> = settings.iter().cloned().chain([continuous]).collect();
        let rig = Rig::read_with("test", "", &settings).expect("valid");
        let (parts, x) = build::drive(&rig);
        let scale = scale_of(&parts);
        let assembly = Assembly::new(parts, &x);
        let integrator = Integrator::new(Method::DormandPrince, 1e-11, scale, x);
        let mut transient = Transient { assembly, integrator };
        transient.aim(0.0, target);
        transient
    }

    fn aim(&mut self, t: f64, target: i32) {
        let assembly = &mut self.assembly;
        self.integrator.interrupt(assembly, t, |assembly, x| assembly.set_target(t, x, target));
    }

    /// The state at `t`, and the command there in m of spool travel.
    fn look(&mut self, t: f64) -> (StateVector, f64) {
        self.integrator.integrate_to(&mut self.assembly, t, f64::INFINITY).expect("a transient");
        let x = *self.integrator.state(t);
        self.assembly.follow(&x);
        (x, self.assembly.parts.operator.commanded())
    }

    /// What the hysteresis lets through at `t`, m.
    fn magnetised(&self, t: f64) -> f64 {
        let crate::component::operator::Operator::Solenoid(solenoid) = &self.assembly.parts.operator else {
            unreachable!("servo-drive B has a solenoid");
        };
        solenoid.magnetised(t)
    }
}

#[test]
fn the_rate_of_the_command_is_the_slope_of_the_command_in_the_transient() {
    let mut transient = Transient::new(&DAMPED.settings(), 16_384);
    let (mut compared, d) = (0, 1e-6);
    for i in 1..300 {
        let t = 1e-3 * f64::from(i);
        let (before, contact) = (transient.look(t - d).0, transient.assembly.load_contact);
        let [here, after] = [t, t + d].map(|t| transient.look(t).0);
        let demand = |x: &StateVector| transient.assembly.demand(x).expect("a continuous controller");
        let slopes = [demand(&here) - demand(&before), demand(&after) - demand(&here)].map(|rise| rise / d);
        // An event in between is a jump.
        if contact != transient.assembly.load_contact || (slopes[1] - slopes[0]).abs() > 1e3 {
            continue;
        }
        compared += usize::from(contact != Contact::Stuck);
        let rate = transient.assembly.demand_rate(t, &here).expect("a continuous controller");
        let slope = 0.5 * (slopes[0] + slopes[1]);
        assert!((rate - slope).abs() < 1e-4 * slope.abs() + 1.0, "at {t} s: {rate} {slope} counts/s");
    }
    assert!(compared > 200, "{compared}");
}

/// The textbook play by small steps of its input, s = max(u - w, min(u + w, s)), from rest at 0.
struct Textbook {
    s: f64,
    moves: bool,
    /// How often the output began or ceased to move.
    turns: u32,
}

impl Textbook {
    fn take(&mut self, u: f64) -> f64 {
        let before = self.s;
        self.s = before.max(u - HALF_WIDTH).min(u + HALF_WIDTH);
        self.turns += u32::from(self.moves != (self.s != before));
        self.moves = self.s != before;
        self.s
    }
}

/// What differs between the transients.
struct Case {
    /// Gains of velocity and acceleration.
    feedback: u32,
    dither_mm: f64,
    /// Of the dither, cycles.
    phase: f64,
    amplifier_gain: f64,
    saturation_mm: f64,
}

const DAMPED: Case =
    Case { feedback: 1000, dither_mm: 0.0, phase: 0.0, amplifier_gain: 1.0, saturation_mm: 1.0 };
const DITHERED: Case = Case { dither_mm: 0.2, ..DAMPED };

impl Case {
    fn settings(&self) -> [String; 6] {
        [
            format!("controller.velocity_gain={}", self.feedback),
            format!("controller.acceleration_gain={}", self.feedback),
            format!("operator.dither_mm={}", self.dither_mm),
            format!("operator.dither_phase_deg={}", 360.0 * self.phase),
            format!("operator.amplifier_gain={}", self.amplifier_gain),
            format!("operator.saturation_mm={}", self.saturation_mm),
        ]
    }

    /// u, m, for a command in m.
    fn amplified(&self, t: f64, command: f64) -> f64 {
        let limit = self.saturation_mm * 1e-3;
        let dither = self.dither_mm * 1e-3 * (std::f64::consts::TAU * (50.0 * t + self.phase)).sin();
        (self.amplifier_gain * command).clamp(-limit, limit) + dither
    }
}

/// Compares what the solenoid makes of its command with the textbook during two moves by `counts`. Tells
/// how often the play's output began or ceased to move.
///
/// The textbook does not see how far the input went since the last look before it jumped: at one metre a
/// second in 0.1 us it is two thousandths of the slack.
fn repeats_the_textbook(case: &Case, counts: i32) -> u32 {
    let mut transient = Transient::new(&case.settings(), 8192 + counts);
    let mut textbook = Textbook { s: 0.0, moves: false, turns: 0 };
    for i in 0..6_000_000 {
        let t = 1e-7 * f64::from(i);
        if i == 3_000_000 {
            transient.aim(t, 8192);
        }
        let command = transient.look(t).1;
        let (expected, got) = (textbook.take(case.amplified(t, command)), transient.magnetised(t));
        assert!((got - expected).abs() < 2e-3 * HALF_WIDTH, "{counts} at {t} s: {got} m, not {expected} m");
    }
    textbook.turns
}

#[test]
fn without_dither_the_hysteresis_is_the_textbook_play_on_the_command() {
    for (feedback, counts, least) in [(1000, 300, 4), (1000, 8192, 20), (1, 8192, 10)] {
        let turns = repeats_the_textbook(&Case { feedback, ..DAMPED }, counts);
        assert!(turns >= least, "gains {feedback}, move {counts}: {turns} turns");
    }
}

/// At a phase of a quarter the run begins at a crest.
#[test]
fn with_dither_the_hysteresis_is_the_textbook_play_on_command_and_dither() {
    for (phase, counts) in [(0.0, 20), (0.25, 300)] {
        let turns = repeats_the_textbook(&Case { phase, ..DITHERED }, counts);
        assert!(turns >= 120, "move {counts}: {turns} turns");
    }
}

#[test]
fn an_amplifier_at_its_limit_leaves_the_play_to_the_dither() {
    let case = Case { amplifier_gain: 2.0, saturation_mm: 0.06, ..DITHERED };
    for counts in [300, 8192] {
        let turns = repeats_the_textbook(&case, counts);
        assert!(turns >= 120, "move {counts}: {turns} turns");
    }
}
