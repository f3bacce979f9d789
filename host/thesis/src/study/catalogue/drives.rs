//! The drives of the studies, and their tests.

use super::super::Variant;

/// Servo-drive B with the printed profile, and hysteresis and stiction as they were measured.
pub(super) const THESIS: Variant = drive("thesis", &[]);

/// Servo-drive B of the thesis with settings.
pub(super) const fn drive(name: &'static str, settings: &'static [&'static str]) -> Variant {
    Variant { name, rig: "servo-b-thesis", settings }
}

/// The step test with moves of 2.4 s: long enough to see whether the drive comes to rest.
pub(super) const LONG_STEPS: &str = "test.moves=[[0.0, 8192], [0.3, 16384], [2.7, 8192]]";
pub(super) const LONG_STEPS_TIME: &str = "test.duration_s=5.1";
