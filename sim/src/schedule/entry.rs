//! `[[test.move]]`: a move with its profile, in mm and s.
//!
//! | profile | the setpoint | needs |
//! |---|---|---|
//! | step | is the target at once | |
//! | trapezoid | goes there within limits of velocity and acceleration | |
//! | s-curve | the same, and of jerk | |
//! | linear | goes there in a straight line | duration_s |
//! | sine | swings about it for whole cycles | amplitude, frequency_hz |
//! | chirp | the same, while the frequency changes evenly | amplitude, frequency_hz, end_frequency_hz, duration_s |
//! | prbs | jumps to either side of it: a pseudo-random binary sequence | amplitude, hold_s |
//! | points | goes through points in straight lines | points |

use pneudrive_controller::sequencer::MAX_MOVES;

use crate::key::{Key, Kind, Preset, Tables, integer, number, optional_number, other, words};

const COUNT: i64 = i32::MAX as i64;
const LENGTH: f64 = 20_000.0;

words! {
    /// The profile of a move that goes to its target.
    pub enum Shape {
        /// At once.
        Step = "step",
        /// Limits of velocity and acceleration.
        Trapezoid = "trapezoid",
        /// Limits of velocity, acceleration and jerk.
        SCurve = "s-curve",
    }
}

/// Every profile and its effect.
#[rustfmt::skip]
const PROFILES: &[(&str, &str)] = &[
    ("step", "the setpoint is the target at once"),
    ("trapezoid", "it goes there within limits of velocity and acceleration"),
    ("s-curve", "it goes there within limits of velocity, acceleration and jerk"),
    ("linear", "it goes there in a straight line"),
    ("sine", "it swings about the target for whole cycles"),
    ("chirp", "it swings about the target while the frequency changes evenly"),
    ("prbs", "it jumps to either side of the target: a pseudo-random binary sequence"),
    ("points", "it goes through points in straight lines, each of them a move"),
];

#[rustfmt::skip]
const PROFILE: Kind = Kind::Choice(&[
    ("step", true), ("trapezoid", true), ("s-curve", true), ("linear", true), ("sine", true), ("chirp", true),
    ("prbs", true), ("points", true),
]);

/// The list of moves.
pub(crate) static ENTRIES: Tables = Tables {
    path: "test.move",
    entry: "move",
    entry_with: "a move with the profile",
    words: PROFILES,
    fields: FIELDS,
};

const LIMITED: &[&str] = &["trapezoid", "s-curve"];
const TO_TARGET: &[&str] = &["step", "trapezoid", "s-curve", "linear", "sine", "chirp", "prbs"];
const SWINGS: &[&str] = &["sine", "chirp", "prbs"];

#[rustfmt::skip]
static FIELDS: &[Key] = &[
    other::<String>("test.move.profile", PROFILE, Preset::Absent("must be given"), "", "How the setpoint goes to its target.").key,
    optional_number("test.move.at_s", 0.0, 4294.0, "when the profile of the move before is over", "", "Begin of the move, from the start of the test; whole microseconds.").key,
    optional_number("test.move.to_mm", -LENGTH, LENGTH, "to_counts", "", "Target in closed loop, or what sine, chirp and prbs swing about.").of(TO_TARGET).key,
    other::<Option<i64>>("test.move.to_counts", Kind::Integer { min: -COUNT, max: COUNT }, Preset::Absent("to_mm"), "", "The same in counts, as in open loop, where it is a valve command.").of(TO_TARGET).key,
    optional_number("test.move.velocity_mm_s", 1e-3, 1e5, "test.velocity_mm_s", "", "Limit of velocity; in open loop counts/s.").of(LIMITED).key,
    optional_number("test.move.acceleration_mm_s2", 1e-3, 1e7, "test.acceleration_mm_s2", "", "Limit of acceleration; in open loop counts/s^2.").of(LIMITED).key,
    optional_number("test.move.jerk_mm_s3", 1e-3, 1e10, "test.jerk_mm_s3", "", "Limit of jerk; in open loop counts/s^3.").of(&["s-curve"]).key,
    optional_number("test.move.amplitude_mm", 0.0, LENGTH, "amplitude_counts", "", "From the target to either side.").of(SWINGS).key,
    other::<Option<i64>>("test.move.amplitude_counts", Kind::Integer { min: 0, max: COUNT }, Preset::Absent("amplitude_mm"), "", "The same in counts, as in open loop.").of(SWINGS).key,
    number("test.move.frequency_hz", 1.0, 1e-4, 1e4, "", "Frequency of a sine, and that with which a chirp begins.").of(&["sine", "chirp"]).key,
    number("test.move.end_frequency_hz", 10.0, 1e-4, 1e4, "", "Frequency with which a chirp ends.").of(&["chirp"]).key,
    integer("test.move.cycles", 5, 1, 1_000_000, "", "Cycles of a sine.").of(&["sine"]).key,
    number("test.move.duration_s", 1.0, 1e-4, 3600.0, "", "Duration; that of a chirp is rounded to whole cycles.").of(&["linear", "chirp"]).key,
    number("test.move.hold_s", 0.05, 1e-4, 100.0, "", "How long each sign lasts at least; rounded to whole samples.").of(&["prbs"]).key,
    integer("test.move.order", 7, 3, 16, "", "Bits of the shift register n: the sequence repeats after 2^n - 1 signs.").of(&["prbs"]).key,
    integer("test.move.repeats", 1, 1, 1000, "", "How often the sequence is run through.").of(&["prbs"]).key,
    other::<Option<Vec<Vec<f64>>>>("test.move.points", Kind::Rows { columns: &["time in s", "mm"], max_rows: MAX_MOVES }, Preset::Absent("must be given"), "", "Points with increasing times, from the begin of the move on; in open loop counts in place of mm.").of(&["points"]).key,
];
