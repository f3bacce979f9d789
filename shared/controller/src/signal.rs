//! The inputs and outputs of the controller, in the raw units of the hardware.

/// One reading of the sensors, latched at the sample instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Encoder count; positive means extension. Unit: counts.
    pub position: i32,
    /// Chamber 1 (blind side) pressure as converted, 0 to 2^bits - 1; 0 without sensors.
    pub pressure_1: i16,
    /// Chamber 2 (rod side) pressure as converted, 0 to 2^bits - 1; 0 without sensors.
    pub pressure_2: i16,
    /// Spool displacement as converted, 0 to 2^bits - 1.
    pub spool: i16,
    /// Whether the homing switch is closed; false without one.
    pub home_switch: bool,
}

/// The command to the drive stage from the output instant on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command {
    /// Valve command; positive means extension, 0 is the valve's null. DAC: -2048 to 2048 counts.
    /// Stepper: the spool location asked for, steps.
    pub counts: i16,
    /// Stepper: the pulse to give now, -1, 0 or 1. DAC: 0.
    pub step: i8,
    /// The drive's enable line: gates the valve amplifier and, where there is one, the dump valve.
    pub drive_enable: bool,
}

impl Command {
    /// Null command, drive disabled: the safe output.
    pub const OFF: Command = Command { counts: 0, step: 0, drive_enable: false };
}

/// A sample and the controller's results from it. The recorder's six channels and the telemetry come from here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Observation {
    /// Whether the sample belongs to a run. The recorder stores those.
    pub running: bool,
    /// k: the number of this sample since the start of the run (0 before one).
    pub index: u32,
    /// Encoder count.
    pub position: i32,
    /// Estimated velocity, counts per velocity window.
    pub velocity: i64,
    /// Estimated acceleration, counts per velocity window per acceleration window.
    pub acceleration: i64,
    /// The setpoint in force, counts (open loop: the command asked for).
    pub setpoint: i32,
    /// Setpoint less position, saturated to 32 bits; 0 in open loop, which has no error.
    pub error: i32,
    /// The command computed from this sample: counts of a DAC, steps of a stepper.
    pub command: i16,
    /// Chamber 1 pressure, raw; 0 without sensors.
    pub pressure_1: i16,
    /// Chamber 2 pressure, raw; 0 without sensors.
    pub pressure_2: i16,
    /// Spool displacement, raw; for a stepper SPLLOC at the sample, steps.
    pub spool: i16,
}
