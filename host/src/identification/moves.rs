//! The tests whose transients show what a fit is after.
//!
//! Open loop, in pulses of the valve, short, and from rest. What makes a test good for a fit:
//!
//! - **The sum of squares is smooth.** A pulse opens the valve far and at once, so the drive breaks away once. Slow
//!   motion, and a closed loop that creeps to its setpoint, sticks and slips at instants that a hair decides: a
//!   little more stiction then moves all that follows. So a record ends while the drive moves.
//! - **Spool steps of a middling size.** A spool swings to its new place and sticks there; how often it swings
//!   changes at steps of 745 and 1205 counts from rest, and at 480 more each, for servo-drive B. The pulses keep 10 %
//!   away from these, so that a gain within 10 % of the file's is found without a jump.
//! - **Both directions, two sizes, there and back.** Accelerations tell the mass, speeds viscous and Coulomb friction
//!   and the discharge, breakaways the stiction.
//! - **A half open valve**, so that its opening matters: gain and null.
//! - **Rests of two lengths**, in which pressures creep: noise, leakage and null.

use pneudrive_app::recorder::CAPACITY;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::Problems;

/// Command, counts, and how long it holds, s.
type Pulses = &'static [(i32, f64)];

/// Name, where it starts as a part of the stroke, pulses.
const TESTS: &[(&str, f64, Pulses)] = &[
    ("extension, half open", 0.30, &[(0, 0.04), (560, 0.27)]),
    ("retraction, half open", 0.70, &[(0, 0.04), (-560, 0.32)]),
    ("extension and back", 0.35, &[(0, 0.04), (960, 0.20), (-700, 0.20)]),
    ("retraction and back", 0.60, &[(0, 0.04), (-960, 0.20), (700, 0.20)]),
    ("extension after a rest", 0.35, &[(0, 0.10), (620, 0.25)]),
    ("retraction after a rest", 0.65, &[(0, 0.10), (-620, 0.25)]),
];

/// The tests, in their order, each a rig with its test.
///
/// # Errors
/// When the rig cannot run them.
pub fn tests(rig: &Rig) -> Result<Vec<Rig>, Problems> {
    TESTS.iter().map(|(name, start, pulses)| test(rig, name, *start, pulses)).collect()
}

fn test(rig: &Rig, name: &str, start: f64, pulses: Pulses) -> Result<Rig, Problems> {
    let pulse = 1e-3 * rig.number("encoder.mm_per_count");
    let period = rig.number("controller.period_s");
    let mut time = 0.0;
    let mut moves = Vec::new();
    for (command, seconds) in pulses {
        moves.push(format!("[{time:.4}, {command}]"));
        time += seconds;
    }
    let duration = time.min((period * (CAPACITY - 1) as f64 * 1e6).floor() / 1e6);
    let position = ((start * rig.number("actuator.stroke_m") / pulse).floor() + 0.5) * pulse;
    let text = format!(
        "name = \"{name}\"\n[controller]\nloop = \"open\"\n[test]\nmoves = [{}]\nduration_s = {duration:.6}\nposition_m = {position}\n",
        moves.join(", ")
    );
    rig.with_test_of(&Rig::read(name, &text)?)
}
