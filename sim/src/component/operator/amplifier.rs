//! The amplifier of a solenoid: `min(gain x, saturation)` of the command, to either side (C(37), C(38)).

use crate::component::dither::SOLENOIDS;
use crate::key::keys;

keys! {
    AMPLIFIER_GAIN: f64 = number("operator.amplifier_gain", 1.0, 1e-3, 1e3, "C(37)", "Gain of the amplifier on the command.").of(SOLENOIDS).spread();
    SATURATION_MM: f64 = number("operator.saturation_mm", 1.0, 1e-3, 100.0, "C(38)", "Largest command that the amplifier passes on.").of(SOLENOIDS);
}
