//! The constants and flags of the thesis by number, for `rig explain 'C(46)'`.

use super::table::all_keys;
use crate::key::Key;

/// An entry of Appendix VII.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name {
    /// Its number, such as C(46).
    pub number: &'static str,
    /// Its name in the thesis.
    pub printed: &'static str,
    /// The default that the thesis prints.
    pub default: &'static str,
    /// Without a key: why, or its replacement.
    pub instead: &'static str,
}

impl Name {
    /// The keys that stand for it.
    pub fn keys(&self) -> impl Iterator<Item = &'static Key> {
        let number = self.number;
        // C(4) is not part of C(46): the bracket ends it.
        all_keys().filter(move |key| key.thesis.contains(number))
    }
}

/// The entry of a number, such as C(46) or c46.
#[must_use]
pub fn named(number: &str) -> Option<&'static Name> {
    let plain = |text: &str| text.to_uppercase().replace(['(', ')', ' '], "");
    THESIS.iter().find(|name| plain(name.number) == plain(number))
}

/// All of them as a table of Markdown.
#[must_use]
pub fn table() -> String {
    let row = |name: &Name| {
        let keys: Vec<String> = name.keys().map(|key| format!("`{}`", key.path)).collect();
        let here = if keys.is_empty() { name.instead.to_owned() } else { keys.join(", ") };
        format!("| {} | {} | {} | {here} |\n", name.number, name.printed, name.default)
    };
    format!(
        "| | in the thesis | default there | here |\n|---|---|---|---|\n{}",
        THESIS.iter().map(row).collect::<String>()
    )
}

const fn name(
    number: &'static str,
    printed: &'static str,
    default: &'static str,
    instead: &'static str,
) -> Name {
    Name { number, printed, default, instead }
}

/// The 69 constants and 22 flags of Appendix VII that are in use.
#[rustfmt::skip]
pub const THESIS: [Name; 91] = [
    name("C(1)", "1-D adiabatic flow constant", "1.4", ""),
    name("C(2)", "Universal gas constant (J/kg/K)", "286.76", ""),
    name("C(3)", "Max physical spool displacement (mm)", "1.0", ""),
    name("C(4)", "Underlap (mm)", "0.0", ""),
    name("C(5)", "Supply pressure (N/m^2)", "589000.0", ""),
    name("C(6)", "Supply temperature (K)", "294.0", ""),
    name("C(7)", "Exhaust pressure (N/m^2)", "101300.0", ""),
    name("C(8)", "Exhaust temperature (K)", "294.0", ""),
    name("C(9)", "Valve sleeve diameter (mm)", "10.0", ""),
    name("C(10)", "Valve spool diameter (mm)", "9.98", ""),
    name("C(11)", "Coefficient of discharge (supply)", "0.8", ""),
    name("C(12)", "Coefficient of discharge (exhaust)", "0.8", ""),
    name("C(13)", "Plastic tube diameter", "4.0", ""),
    name("C(14)", "Cylinder length (m)", "0.3", ""),
    name("C(15)", "Piston diameter (m)", "0.05", ""),
    name("C(16)", "Piston rod diameter (m)", "0.025", ""),
    name("C(17)", "Mass of load (kg)", "1.6", ""),
    name("C(18)", "Coeff of viscous friction (Ns/m)", "30.0", ""),
    name("C(19)", "Load in direction of piston action (N)", "0.0", ""),
    name("C(21)", "Proportional gain (profile not used)", "1.0", ""),
    name("C(24)", "Threshold velocity (m/s)", "0.00001", ""),
    name("C(25)", "Spool rod diameter (mm)", "6.0", ""),
    name("C(26)", "Controller delay (s)", "0.0005", ""),
    name("C(27)", "Position dead band (m)", "0.0", ""),
    name("C(28)", "Slope of pressure drop in tubing", "0.4", ""),
    name("C(29)", "Threshold percent of hysteresis", "5.0", ""),
    name("C(30)", "Reference flow for pressure drop", "0.00465", ""),
    name("C(31)", "Forced closed loop exit time", "1.42", ""),
    name("C(32)", "Dither frequency (Hz)", "50.0", ""),
    name("C(33)", "Dither amplitude (mm of spool disp)", "0.2", ""),
    name("C(34)", "Dither phase lag (in degrees)", "0.0", ""),
    name("C(35)", "Residual volume in chamber 1 (m^3)", "0.00002", ""),
    name("C(36)", "Residual volume in chamber 2 (m^3)", "0.00002", ""),
    name("C(37)", "Spool signal amplifying factor", "1.0", ""),
    name("C(38)", "Software saturation limit (mm)", "1.0", ""),
    name("C(39)", "Valve port diameter (mm)", "3.3", ""),
    name("C(40)", "Start time of controller function (s)", "0.0", ""),
    name("C(41)", "Sampling time (s)", "0.0013", ""),
    name("C(42)", "Encoder pulse (mm of stroke/pulse)", "0.01205", ""),
    name("C(43)", "Proportional gain on derived velocity", "1.0", ""),
    name("C(44)", "Proportional gain on derived acc", "1.0", ""),
    name("C(45)", "Velocity dead band", "0.0", ""),
    name("C(46)", "Static friction (extending) (N)", "70.0", ""),
    name("C(47)", "Coulomb friction (extending) (N)", "40.0", ""),
    name("C(48)", "Static friction (retracting) (N)", "40.0", ""),
    name("C(49)", "Coulomb friction (retracting) (N)", "11.0", ""),
    name("C(50)", "Spool coefficient K_S (s^{-2})", "36000.0", ""),
    name("C(51)", "Spool damping coefficient K_D (s^{-1})", "100.0", ""),
    name("C(52)", "Blind width reduction factor", "0.5", "not defined: Appendix VII alone names it, without a unit, and no text or equation has a blind width; Fig. 6.9 (6.4.5), which might, has no legend (docs/explanation/equations.md, section 7)"),
    name("C(54)", "Turbulence coeff. for Mach Number", "1.0", ""),
    name("C(55)", "Leakage coeff. bet. chamber (empirical)", "0.0", ""),
    name("C(56)", "Passage resistance (Egli's rho)", "20.0", ""),
    name("C(57)", "Leakage passage thickness (m)", "0.0001", ""),
    name("C(58)", "Reverse flow coeff. of discharge", "1.0", ""),
    name("C(59)", "Temperature difference limit in FLS", "200.0", "void: Appendix VII alone, where FLS is not spelled out; it reads as a limit on the temperature in the iterations of the node (6.5.6), and ours solves one equation for the pressure, from which the temperature follows (docs/explanation/equations.md, section 3)"),
    name("C(63)", "Diameter of connector (mm)", "5.0", ""),
    name("C(66)", "Stepper pulse gain (mm spl disp/pulse)", "0.0125", ""),
    name("C(68)", "Burrows' k5 (pressure feedback)", "12.4", ""),
    name("C(70)", "Length of valve land (flow ind. forces)", "0.01", ""),
    name("C(81)", "Solenoid force gain coefficient (N/mm)", "25.0", ""),
    name("C(82)", "Valve spring stiffness (N/mm)", "25.0", ""),
    name("C(83)", "Initial valve spring compression (N)", "25.0", ""),
    name("C(84)", "Static friction of spool (N)", "3.0", ""),
    name("C(85)", "Coulomb friction of spool (N)", "2.0", ""),
    name("C(86)", "Mass of spool (kg)", "0.023", ""),
    name("C(87)", "Spool velocity threshold (mm/s)", "0.00001", "void: a spool sticks where its velocity crosses zero (6.4.3), which is located; that is the limit of a threshold that goes to 0 (docs/explanation/equations.md, section 6)"),
    name("C(89)", "Region of infinite stiffness (m)", "0.001", ""),
    name("C(90)", "Infinite stiffness at end stops (N/m)", "1000000.0", ""),
    name("C(91)", "Infinite stiffness for spool stop (N/m)", "100000.0", ""),
    name("L(1)", "Controller start working flag", "0", "void: a working flag of the thesis's program, in Appendix VII alone, which reads as whether C(40) is over; here that is controller.start_s, and the supervisor has its modes"),
    name("L(2)", "Spool operator indicator (solenoid)", "1", ""),
    name("L(3)", "Loop flag (closed)", "1", ""),
    name("L(4)", "System identification (discrete)", "1", ""),
    name("L(5)", "Feedback mode (position)", "1", "not defined: Appendix VII alone, with one value, position; that is what the loop feeds back (6.3.3), and controller.velocity_gain and acceleration_gain are the minor loops"),
    name("L(6)", "Number of moves required", "1", ""),
    name("L(8)", "Gain profile requirement flag (used)", "1", ""),
    name("L(10)", "Diagnostic flag (off)", "0", "not defined: a switch of the thesis's program, in Appendix VII alone; nothing tells what it shows"),
    name("L(11)", "Dead band exit condition flag (disabled)", "1", ""),
    name("L(14)", "Velocity calculation mode flag (vary)", "1", "not defined: Appendix VII alone names the mode \"vary\", and 6.3.3 has only differences of position samples; the window is controller.velocity_window_samples (docs/explanation/equations.md, section 9)"),
    name("L(16)", "Model type (flow node)", "1", ""),
    name("L(17)", "Coeff. of discharge flag (Perry's)", "1", ""),
    name("L(18)", "Actuator leakage model indicator (Egli's)", "1", ""),
    name("L(19)", "Flag for control software kp(-ve) bug", "0", ""),
    name("L(20)", "Max stepper motor actuator steps", "40", ""),
    name("L(21)", "Load model flag", "0", ""),
    name("L(22)", "Controller model flag (Discrete)", "1", ""),
    name("L(51)", "Velocity calculation time", "0", "not defined: Appendix VII alone, with a default of 0; L(77), its like for the acceleration, is a window of 3 samples, and a window of 0 would be no velocity (docs/explanation/equations.md, section 9)"),
    name("L(52)", "Counting integer for velocity calculation", "5", ""),
    name("L(67)", "Span of application of each Kp data", "4", ""),
    name("L(68)", "Scale factor for quantised spool command", "65536", ""),
    name("L(77)", "Acceleration calculation time", "3", ""),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_a_key_or_says_what_does_its_work() {
        for name in THESIS {
            assert_eq!(name.keys().next().is_none(), !name.instead.is_empty(), "{}", name.number);
        }
    }

    /// A key that names a number of the thesis names one that there is.
    #[test]
    fn every_number_of_a_key_is_an_entry() {
        for key in all_keys() {
            for number in
                key.thesis.split(", ").filter(|text| text.starts_with("C(") || text.starts_with("L("))
            {
                let number = number.split('=').next().unwrap_or(number);
                assert!(named(number).is_some(), "{}: {number}", key.path);
            }
        }
    }

    #[test]
    fn a_number_is_found_however_it_is_written() {
        for number in ["C(46)", "c(46)", "C46", "c46"] {
            assert_eq!(
                named(number).and_then(|name| name.keys().next()).map(|key| key.path),
                Some("load.static_extend_n")
            );
        }
        assert_eq!(named("C(20)"), None, "the thesis does not use it");
        assert_eq!(named("C(4)").expect("underlap").keys().count(), 1);
    }
}
