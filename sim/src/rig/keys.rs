//! The one table of a rig file's keys: default, range, meaning, thesis name, which models use it.
//!
//! Reading, checking, `rig explain`, `--set` and spreads all go by this table. Units stand in the
//! key's name ([`unit()`]); [`super::Rig`] hands out values in SI.

/// What a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A real number within a range, ends included.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// A whole number within a range.
    Integer {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// true or false.
    Switch,
    /// One of some words; each with whether it is built.
    Choice(&'static [(&'static str, bool)]),
    /// A list of whole numbers within a range.
    Integers {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
        /// Most entries.
        most: usize,
    },
    /// A list of real numbers.
    Numbers {
        /// How many.
        count: usize,
    },
    /// A list of [time in s, whole number].
    Moves,
    /// A list of tables: what goes wrong and when.
    Events,
    /// Text.
    Text,
    /// Not built yet; only the default is accepted.
    NotBuilt,
}

/// The value of a key that the file does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// A real number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// true or false.
    Switch(bool),
    /// A word.
    Choice(&'static str),
    /// Whole numbers.
    Integers(&'static [i64]),
    /// Moves.
    Moves(&'static [(f64, i64)]),
    /// Nothing: what that means, for the help text.
    Absent(&'static str),
}

/// One key of a rig file.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// "table.name", as errors and `--set` have it; the top level has no table.
    pub path: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds without it.
    pub default: Default,
    /// Models of the same table that use it; empty: all.
    pub models: &'static [&'static str],
    /// Name in the thesis, or "".
    pub thesis: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Whether `--spread` draws it: a physical value that is never known exactly.
    pub spread: bool,
}

impl Key {
    /// The table, "" for the top level.
    #[must_use]
    pub fn table(&self) -> &'static str {
        self.path.split_once('.').map_or("", |(table, _)| table)
    }

    /// The name within the table.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, name)| name)
    }

    /// The unit, from the name; "" for a plain number.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        unit(self.name()).1
    }
}

/// Endings of names and the units they stand for, longer ones first.
const UNITS: &[(&str, &str)] = &[
    ("_j_per_kg_k", "J/(kg K)"),
    ("_w_per_m2_k", "W/(m2 K)"),
    ("_m3_per_s_pa", "m3/(s Pa)"),
    ("_per_mass_per_s2", "1/s2"),
    ("_n_s_per_m", "N s/m"),
    ("_n_per_mm", "N/mm"),
    ("_n_per_m", "N/m"),
    ("mm_per_count", "mm/count"),
    ("mm_per_step", "mm/step"),
    ("_per_s", "1/s"),
    ("_percent", "%"),
    ("_samples", "samples"),
    ("_counts", "counts"),
    ("_kg_s", "kg/s"),
    ("_m_s", "m/s"),
    ("_kpa", "kPa"),
    ("_mpa", "MPa"),
    ("_bar", "bar"),
    ("_psi", "psi"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_cm", "cm"),
    ("_mm", "mm"),
    ("_um", "um"),
    ("_m3", "m3"),
    ("_l", "l"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_s", "s"),
    ("_n", "N"),
    ("_k", "K"),
    ("_c", "C"),
    ("_m", "m"),
    ("_g", "g"),
];

/// The part of a name before its unit, and the unit ("" for none).
#[must_use]
pub fn unit(name: &str) -> (&str, &'static str) {
    UNITS
        .iter()
        .find_map(|(ending, unit)| name.strip_suffix(ending).map(|stem| (stem, *unit)))
        .unwrap_or((name, ""))
}

/// The key with a path.
#[must_use]
pub fn find(path: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.path == path)
}

pub(super) const fn key(
    path: &'static str,
    kind: Kind,
    default: Default,
    thesis: &'static str,
    meaning: &'static str,
) -> Key {
    Key { path, kind, default, models: &[], thesis, meaning, spread: false }
}

pub(super) const fn number(
    path: &'static str,
    default: f64,
    min: f64,
    max: f64,
    thesis: &'static str,
    meaning: &'static str,
) -> Key {
    key(path, Kind::Number { min, max }, Default::Number(default), thesis, meaning)
}

pub(super) const fn integer(
    path: &'static str,
    default: i64,
    min: i64,
    max: i64,
    thesis: &'static str,
    meaning: &'static str,
) -> Key {
    key(path, Kind::Integer { min, max }, Default::Integer(default), thesis, meaning)
}

const fn switch(path: &'static str, default: bool, thesis: &'static str, meaning: &'static str) -> Key {
    key(path, Kind::Switch, Default::Switch(default), thesis, meaning)
}

pub(super) const fn choice(
    path: &'static str,
    options: &'static [(&'static str, bool)],
    thesis: &'static str,
    meaning: &'static str,
) -> Key {
    key(path, Kind::Choice(options), Default::Choice(options[0].0), thesis, meaning)
}

impl Key {
    pub(super) const fn of(self, models: &'static [&'static str]) -> Key {
        Key { models, ..self }
    }

    const fn spread(self) -> Key {
        Key { spread: true, ..self }
    }

    const fn not_built(self) -> Key {
        Key { kind: Kind::NotBuilt, ..self }
    }
}

const GAIN: i64 = u16::MAX as i64;
pub(super) const COUNT: i64 = i32::MAX as i64;
const SOLENOIDS: &[&str] = &["solenoid", "solenoid-empirical"];
const PROFILE: &[i64] = &[8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256];

/// Every key, in the order of DESIGN section 5.
#[rustfmt::skip]
pub static KEYS: &[Key] = &[
    key("name", Kind::Text, Default::Absent("the name of the file"), "", "What the rig is called in reports and TARGET files."),

    number("gas.heat_capacity_ratio", 1.4, 1.01, 1.9, "C(1)", "Ratio of the heat capacities at constant pressure and volume."),
    number("gas.gas_constant_j_per_kg_k", 286.76, 10.0, 10_000.0, "C(2)", "Specific gas constant."),

    number("supply.pressure_pa", 589_000.0, 2e4, 5e6, "C(5)", "Absolute supply pressure.").spread(),
    number("supply.temperature_k", 294.0, 150.0, 600.0, "C(6)", "Supply temperature."),
    number("exhaust.pressure_pa", 101_300.0, 1e4, 4e6, "C(7)", "Absolute pressure of the surroundings, into which the valve exhausts."),
    number("exhaust.temperature_k", 294.0, 150.0, 600.0, "C(8)", "Temperature of the surroundings."),

    choice("controller.model", &[("sampled", true), ("continuous", true)], "L(22)", "Sampled: the controller that is flashed. Continuous: the simulator's own, in floats."),
    choice("controller.law", &[("gain-profile", true), ("proportional", true), ("moore-proportional", true), ("on-off", true)], "L(22), L(8)", "How the position error becomes a demand."),
    choice("controller.loop", &[("closed", true), ("open", true)], "L(3)", "Open: moves are valve commands, nothing is fed back."),
    number("controller.period_s", 0.0013, 1e-4, 0.1, "C(41)", "Sample period; whole microseconds."),
    number("controller.delay_s", 0.0005, 1e-6, 0.099_999, "C(26)", "From a sample to its output; whole microseconds, less than the period."),
    key("controller.gain_profile", Kind::Integers { min: 0, max: GAIN, most: 256 }, Default::Integers(PROFILE), "Kp(0)..Kp(255)", "Gain on the error, an entry for each span of error; the last one repeats to 256 entries."),
    integer("controller.profile_span_counts", 4, 1, 65_535, "L(67)", "Range of error that one entry of the gain profile covers."),
    integer("controller.proportional_gain", 1, 0, GAIN, "C(21)", "Gain of the laws without a profile."),
    integer("controller.dead_zone_counts", 102, 0, 2048, "", "Moore's law adds it in the direction of the error: what takes the spool across its dead zone. 102 for the DAC, 4 steps for the stepper: 0.05 mm, half of the hysteresis C(29)."),
    integer("controller.velocity_gain", 1, 0, GAIN, "C(43)", "Gain on counts per velocity window; the thesis's 1 gives no damping, about 1000 does."),
    integer("controller.acceleration_gain", 1, 0, GAIN, "C(44)", "Gain on counts per velocity and acceleration window."),
    integer("controller.velocity_window_samples", 5, 1, 63, "L(52)", "Samples over which the velocity is a difference of counts."),
    integer("controller.acceleration_window_samples", 3, 1, 63, "L(77)", "Samples over which the acceleration is a difference of velocities."),
    integer("controller.velocity_dead_band", 0, 0, COUNT, "C(45)", "Velocities below it, in counts per velocity window, count as standstill; 0: off."),
    integer("controller.scale", 256, 1, COUNT, "L(68)", "The law's sum is divided by it: 256 for the DAC, 65536 for the stepper."),
    integer("controller.dead_band_counts", 0, 0, COUNT, "C(27)", "Errors below it ask for nothing; 0: off. For the on-off law the dead zone of its relay."),
    integer("controller.relay_hysteresis_counts", 0, 0, COUNT, "", "The relay of the on-off law drops out this much below dead_band_counts, at which it picks up."),
    integer("controller.null_offset_counts", 0, -2048, 2048, "8.2.3", "Command at which the valve is at its null; added to the demand."),
    number("controller.forced_exit_s", 1.42, 1e-3, 1e4, "C(31)", "Time for each of test.targets."),
    switch("controller.exit_on_dead_band", false, "L(11)", "Whether a target also ends when it has arrived: tolerance_counts, monitoring_s, dwell_s; with test.targets."),
    integer("controller.tolerance_counts", 8, 0, COUNT, "C(27)", "A move has arrived inside this error; without it that of dead_band_counts, if there is one."),
    number("controller.monitoring_s", 0.0, 0.0, 2000.0, "", "Exact stop: time inside the tolerance after which a move has arrived. 0: fast stop, at the first sample inside."),
    number("controller.dwell_s", 0.0, 0.0, 2000.0, "", "From the arrival at a target to the next one."),
    switch("controller.learn_null_offset", false, "8.2.3", "Whether the controller learns the command at which the valve is at its null."),
    integer("controller.learning_gain", 256, 1, GAIN, "8.2.3", "How much of the error at rest goes into the null offset, divided by the scale; 1 in the thesis, which learns nothing in a day."),
    choice("controller.homing", &[("stop", true), ("switch", true)], "", "Where a homing run ends: against a stop, or at the edge of a switch."),
    integer("controller.homing_command_counts", -200, -2048, 2048, "", "Valve command of the homing run, not 0; its sign is the direction. -200 for the DAC, -4 for the stepper."),
    integer("controller.homing_position_counts", 0, -COUNT, COUNT, "", "The position where the homing run ends."),
    number("controller.homing_still_s", 0.5, 0.001, 3600.0, "", "Standing still for so long is being at the stop."),
    number("controller.homing_timeout_s", 10.0, 0.001, 3600.0, "", "A longer homing run trips."),
    number("controller.pressure_feedback_gain", 12.4, 0.0, 1e6, "C(68)", "Burrows' k5: how many counts of error a kPa of quasi-transient pressure difference takes off for the on-off law; the thesis does not say its unit."),

    number("encoder.mm_per_count", 0.01205, 1e-6, 2.0, "C(42)", "Stroke per encoder count."),
    integer("encoder.polarity", 1, -1, 1, "", "-1: the encoder counts down when the rod extends (a matter of wiring; the twin always counts up)."),

    number("sensors.pressure_min_pa", 0.0, 0.0, 1e7, "", "Absolute pressure at raw 0."),
    number("sensors.pressure_max_pa", 1_000_000.0, 1.0, 1e8, "", "Absolute pressure at full scale."),
    number("sensors.spool_min_mm", -1.25, -1000.0, 1000.0, "", "Spool displacement at raw 0."),
    number("sensors.spool_max_mm", 1.25, -1000.0, 1000.0, "", "Spool displacement at full scale."),
    integer("sensors.bits", 12, 8, 15, "", "Width of the converter."),
    key("sensors.home_switch_mm", Kind::Number { min: -1000.0, max: 20_000.0 }, Default::Absent("there is no switch"), "", "The homing switch is closed below this position."),
    number("sensors.pressure_lag_s", 0.0, 0.0, 1.0, "", "First-order lag of the pressure sensors; 0: none."),
    number("sensors.noise_counts", 0.0, 0.0, 1000.0, "", "Standard deviation of the converter's noise."),

    choice("operator.model", &[("solenoid", true), ("solenoid-empirical", true), ("stepper", true), ("on-off", true)], "L(2)", "What moves the spool."),
    number("operator.force_gain_n_per_mm", 25.0, 1e-3, 1e5, "C(81)", "Force of the coil per mm of command.").of(&["solenoid"]).spread(),
    number("operator.spring_n_per_mm", 25.0, 1e-3, 1e5, "C(82)", "Stiffness of the spool's spring.").of(&["solenoid"]).spread(),
    number("operator.spring_preload_n", 25.0, 0.0, 1e5, "C(83)", "Compression of the spring at mid-travel, which the mid-range of the coil balances.").of(&["solenoid"]),
    number("operator.static_friction_n", 3.0, 0.0, 1e4, "C(84)", "Stiction of the spool.").of(&["solenoid"]).spread(),
    number("operator.coulomb_friction_n", 2.0, 0.0, 1e4, "C(85)", "Coulomb friction of the spool.").of(&["solenoid"]).spread(),
    number("operator.spool_mass_kg", 0.023, 1e-5, 100.0, "C(86)", "Mass of the spool with the core.").of(&["solenoid"]).spread(),
    number("operator.damping_n_s_per_m", 2.3, 0.0, 1e5, "", "Viscous damping of the spool; not in the thesis, C(51) times C(86).").of(&["solenoid"]).spread(),
    number("operator.hysteresis_percent", 5.0, 0.0, 100.0, "C(29)", "Width of the hysteresis loop, of the spool's range from end to end (2 mm in servo-drive B).").of(SOLENOIDS).spread(),
    number("operator.dither_hz", 50.0, 0.0, 1000.0, "C(32)", "Frequency of the amplifier's dither.").of(SOLENOIDS),
    number("operator.dither_mm", 0.2, 0.0, 10.0, "C(33)", "Amplitude of the dither.").of(SOLENOIDS).spread(),
    number("operator.dither_phase_deg", 0.0, -360.0, 360.0, "C(34)", "Phase of the dither at t = 0.").of(SOLENOIDS),
    number("operator.stiffness_per_mass_per_s2", 36_000.0, 1.0, 1e9, "C(50)", "Squared natural frequency of the empirical operator.").of(&["solenoid-empirical"]),
    number("operator.damping_per_s", 100.0, 0.0, 1e6, "C(51)", "Damping of the empirical operator.").of(&["solenoid-empirical"]),
    number("operator.mm_per_step", 0.0125, 1e-5, 1.0, "C(66)", "Spool travel of a step.").of(&["stepper"]),
    integer("operator.max_steps", 40, 1, 2048, "L(20)", "Furthest step from mid-travel.").of(&["stepper"]),
    integer("operator.pulse_width_us", 10, 1, 1000, "", "Length of a stepper's pulse, kept by the board.").of(&["stepper"]),
    integer("operator.direction_setup_us", 10, 1, 1000, "", "A stepper's direction stands so long before the pulse, kept by the board.").of(&["stepper"]),
    number("operator.amplifier_gain", 1.0, 1e-3, 1e3, "C(37)", "Gain of the amplifier on the command.").of(SOLENOIDS).spread(),
    number("operator.saturation_mm", 1.0, 1e-3, 100.0, "C(38)", "Largest command that the amplifier passes on.").of(SOLENOIDS),
    number("operator.stop_stiffness_n_per_m", 100_000.0, 1.0, 1e10, "C(91)", "Stiffness of the spool's stops.").of(&["solenoid"]),
    number("operator.stop_region_m", 5e-5, 1e-9, 0.1, "", "Penetration at which the stops' damping is full.").of(&["solenoid"]),
    number("operator.stop_damping_ratio", 0.5, 0.0, 10.0, "", "Damping ratio of the stops.").of(&["solenoid"]),
    number("operator.switch_time_s", 0.0, 0.0, 1.0, "", "Time from state to state of an on-off valve.").of(&["on-off"]),

    choice("valve.model", &[("flow-node", true), ("single-restriction", true), ("multiple-flow-node", true), ("iso-6358", true)], "L(16)", "How the flows through the valve are formed."),
    choice("valve.flow_force", &[("none", true), ("experimental", true), ("analytical", true)], "L(16)=4,5", "Force of the flow on the spool."),
    key("valve.flow_force_inlet", Kind::Numbers { count: 12 }, Default::Absent("a stand-in fitted to the force of a free jet; Louis and Logan's coefficients are not published in the thesis"), "6.34", "C_Fin: coefficients of the powers 0 to 11 of the opening, for the experimental flow force of air that goes in."),
    key("valve.flow_force_outlet", Kind::Numbers { count: 12 }, Default::Absent("as flow_force_inlet"), "6.34", "C_Fout: the same for air that comes out."),
    number("valve.spool_travel_mm", 1.0, 0.01, 100.0, "C(3)", "Travel of the spool to either side; also what a command of 2048 asks for."),
    number("valve.underlap_mm", 0.0, -10.0, 10.0, "C(4)", "Lap of the lands: negative is underlap, positive overlap."),
    number("valve.sleeve_diameter_mm", 10.0, 0.1, 500.0, "C(9)", "Bore of the sleeve."),
    number("valve.spool_diameter_mm", 9.98, 0.1, 500.0, "C(10)", "Diameter of the spool's lands."),
    number("valve.spool_rod_diameter_mm", 6.0, 0.0, 500.0, "C(25)", "Diameter of the spool between its lands."),
    number("valve.port_diameter_mm", 3.3, 0.01, 500.0, "C(39)", "Bore of the ports."),
    number("valve.connector_diameter_mm", 5.0, 0.01, 500.0, "C(63)", "Bore of the connectors: the alternative to tubing.diameter_mm for the multiple flow node; not used, as in the reference."),
    number("valve.discharge_supply", 0.8, 0.01, 1.0, "C(11)", "Coefficient of discharge of the supply lands and the ports.").spread(),
    number("valve.discharge_exhaust", 0.8, 0.01, 1.0, "C(12)", "Coefficient of discharge of the exhaust lands.").spread(),
    number("valve.discharge_reverse", 1.0, 0.01, 1.0, "C(58)", "Multiplier of the coefficient of discharge for reverse flow.").not_built(),
    choice("valve.discharge_model", &[("constant", true), ("perry", true)], "L(17)", "How the coefficient of discharge depends on the pressure ratio."),
    number("valve.land_length_m", 0.01, 0.0, 1.0, "C(70)", "Length of the lands, for flow forces."),
    switch("valve.upstream_mach", true, "C(54)", "Whether the speed counts at which a tube brings air to the ports of flow nodes; false sets every upstream Mach number to zero.").of(&["flow-node", "multiple-flow-node"]),
    switch("valve.table", false, "", "Of former versions: flows from a table. Only false is accepted."),
    number("valve.null_offset_mm", 0.0, -10.0, 10.0, "", "Spool position at which the valve is at its null."),
    key("valve.sonic_conductance_m3_per_s_pa", Kind::Number { min: 1e-12, max: 1e-6 }, Default::Absent("the data sheet's; needed by iso-6358"), "", "Sonic conductance at full opening.").of(&["iso-6358"]),
    key("valve.critical_ratio", Kind::Number { min: 0.0, max: 0.9 }, Default::Absent("the data sheet's; needed by iso-6358"), "", "Critical pressure ratio.").of(&["iso-6358"]),

    choice("tubing.model", &[("empirical", true), ("analytical", true), ("none", true), ("dynamic", false)], "L(11)", "Pressure drop between supply, valve and cylinder."),
    number("tubing.drop_slope", 0.4, 0.0, 0.99, "C(28)", "Part of the pressure that is lost at the reference flow.").of(&["empirical"]).spread(),
    number("tubing.reference_flow_kg_s", 0.00465, 1e-5, 100.0, "C(30)", "Flow at which drop_slope holds.").of(&["empirical"]),
    number("tubing.diameter_mm", 4.0, 0.1, 500.0, "C(13)", "Bore of the tubes; with the multiple flow node that of the restriction at the cylinder."),
    number("tubing.length_m", 1.0, 0.0, 1000.0, "", "Length of each tube.").of(&["analytical", "dynamic"]),
    number("tubing.friction_factor", 0.005, 1e-5, 1.0, "", "Fanning friction factor.").of(&["analytical", "dynamic"]),
    number("tubing.lag_s", 0.0, 0.0, 1.0, "", "First-order lag of the pressure ratio; 0: solved together with the valve."),

    choice("actuator.model", &[("asymmetric", true), ("symmetric", true), ("rotary-vane", false)], "L(18)", "Kind of cylinder; a symmetric one is rodless, or has a rod on both sides."),
    number("actuator.stroke_m", 0.3, 1e-3, 20.0, "C(14)", "Length of the stroke."),
    number("actuator.bore_m", 0.05, 1e-3, 2.0, "C(15)", "Bore of the cylinder."),
    number("actuator.rod_diameter_m", 0.025, 0.0, 2.0, "C(16)", "Diameter of the rod: on one side (asymmetric) or on both (symmetric).").of(&["asymmetric", "symmetric"]),
    number("actuator.residual_volume_1_m3", 2e-5, 1e-9, 1.0, "C(35)", "Dead volume of chamber 1 with its tube.").spread(),
    number("actuator.residual_volume_2_m3", 2e-5, 1e-9, 1.0, "C(36)", "Dead volume of chamber 2 with its tube.").spread(),
    choice("actuator.leakage", &[("none", true), ("laminar", true), ("adiabatic", true)], "L(18)", "Leakage past the piston."),
    number("actuator.leakage_coefficient", 0.0, 0.0, 1e-6, "C(55)", "Laminar leakage, kg/(s Pa)."),
    number("actuator.passage_resistance", 20.0, 1e-3, 1e6, "C(56)", "Egli's resistance of the leakage passage."),
    number("actuator.passage_clearance_m", 1e-5, 1e-9, 1e-2, "C(57)", "Clearance of the leakage passage; the thesis's table has 1e-4, a slip."),
    number("actuator.heat_transfer_w_per_m2_k", 0.0, 0.0, 1e5, "", "Heat transfer of the chambers' walls; 0: adiabatic, as in the thesis."),
    number("actuator.wall_temperature_k", 294.0, 150.0, 600.0, "", "Temperature of the chambers' walls."),

    choice("load.model", &[("mass", true)], "L(21)", "Kind of load."),
    number("load.mass_kg", 1.6, 1e-3, 1e5, "C(17)", "Moving mass.").spread(),
    number("load.viscous_n_s_per_m", 30.0, 0.0, 1e6, "C(18)", "Viscous friction.").spread(),
    number("load.constant_force_n", 0.0, -1e6, 1e6, "C(19)", "Constant force in the direction of extension."),
    number("load.spring_n_per_m", 0.0, 0.0, 1e6, "", "Spring to the retracted end."),
    number("load.incline_deg", 0.0, -90.0, 90.0, "", "Angle at which extension goes uphill."),
    choice("load.friction", &[("coulomb", true), ("lugre", false)], "", "Kind of dry friction."),
    number("load.static_extend_n", 70.0, 0.0, 1e5, "C(46)", "Stiction, extending.").spread(),
    number("load.coulomb_extend_n", 40.0, 0.0, 1e5, "C(47)", "Coulomb friction, extending.").spread(),
    number("load.static_retract_n", 40.0, 0.0, 1e5, "C(48)", "Stiction, retracting.").spread(),
    number("load.coulomb_retract_n", 11.0, 0.0, 1e5, "C(49)", "Coulomb friction, retracting.").spread(),
    number("load.velocity_threshold_m_s", 1e-5, 0.0, 1.0, "C(24)", "Velocity below which the thesis's model sticks; here sticking is an event at exactly zero, and this is not used."),
    number("load.stop_stiffness_n_per_m", 1e6, 1.0, 1e12, "C(90)", "Stiffness of the end stops."),
    number("load.stop_region_m", 0.001, 1e-9, 1.0, "C(89)", "Penetration at which the stops' damping is full."),
    number("load.stop_damping_ratio", 0.5, 0.0, 10.0, "", "Damping ratio of the end stops."),

    key("faults.event", Kind::Events, Default::Absent("nothing goes wrong"), "", "What goes wrong and when, a table [[faults.event]] each."),
    switch("faults.last_gain_for_negative_errors", false, "L(19)", "The same bug in another reading: a negative error has the last gain of the profile; in the simulator only."),
    switch("faults.positive_gain_only", false, "L(19)", "The controller's historical bug (thesis 8.2.5): the error always counts as positive; in the simulator only."),

    number("safety.position_margin_mm", 3.0, 0.0, 1000.0, "", "How far outside the stroke the position may be before the supervisor trips."),
    number("safety.max_speed_m_s", 5.0, 1e-3, 100.0, "", "A faster step of the encoder trips the supervisor."),
    number("safety.host_silence_s", 0.5, 0.0, 3600.0, "", "Silence of the host that trips a running move or homing run; 0: off."),
    number("safety.hold_s", 60.0, 0.0, 3600.0, "", "An enabled drive that stands, armed or holding its last setpoint, is disarmed this long after its host has gone."),
    switch("safety.sensor_watch", true, "", "Whether a pressure at an end of its converter trips, if no pressure of the drive can be there."),
    number("safety.no_motion_s", 0.5, 0.0, 3600.0, "", "A run in closed loop that asks for more than half of the valve and does not move for so long trips; 0: off."),
    key("safety.end_min_mm", Kind::Number { min: -1000.0, max: 20_000.0 }, Default::Absent("none"), "", "Software end position: lower setpoints are refused, an open loop pushes no further."),
    key("safety.end_max_mm", Kind::Number { min: -1000.0, max: 20_000.0 }, Default::Absent("none"), "", "The other software end position."),
    integer("safety.late_sample_us", 100, 1, 100_000, "", "A sample later than this trips the supervisor."),

    key("test.moves", Kind::Moves, Default::Moves(&[(0.0, 8192), (0.3, 16_384), (1.72, 8192)]), "", "[time in s, counts], in order of time: setpoints, or commands in open loop."),
    key("test.targets", Kind::Integers { min: -COUNT, max: COUNT, most: 64 }, Default::Absent("moves hold"), "", "Setpoints in counts, each for controller.forced_exit_s: the thesis's way, instead of moves."),
    number("test.duration_s", 3.1, 1e-4, 3600.0, "", "Length of the test."),
    key("test.repeat_every_s", Kind::Number { min: 1e-4, max: 3600.0 }, Default::Absent("the moves come once"), "", "The moves come again every so often, rounded up to whole samples, until the test is over."),
    key("test.impulse", Kind::Numbers { count: 3 }, Default::Absent("no impulse"), "8.2.1", "[time in s, duration in s, counts]: for so long the setpoint, or the command in open loop, is so much more."),
    key("test.trace_period_s", Kind::Number { min: 1e-6, max: 3600.0 }, Default::Absent("a row a sample"), "", "Period of the rows of trace.csv; whole microseconds."),
    integer("test.decimation", 1, 1, 10_000, "", "The recorder stores every Nth sample."),
    integer("test.pre_trigger", 0, 0, 2000, "", "Stored samples from before the start."),
    number("test.position_m", 98.719_625e-3, 0.0, 20.0, "", "Position at the start; 8192.5 counts, for a start on the edge of a count is ill-defined."),
    key("test.pressure_1_pa", Kind::Number { min: 1e4, max: 5e6 }, Default::Absent("equilibrium with pressure_2_pa"), "", "Chamber 1 at the start, absolute."),
    number("test.pressure_2_pa", 400_000.0, 1e4, 5e6, "", "Chamber 2 at the start, absolute."),
    number("test.temperature_1_k", 294.0, 150.0, 600.0, "", "Chamber 1 at the start."),
    number("test.temperature_2_k", 294.0, 150.0, 600.0, "", "Chamber 2 at the start."),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_unique_and_explained() {
        for (i, key) in KEYS.iter().enumerate() {
            assert!(KEYS[..i].iter().all(|other| other.path != key.path), "{}", key.path);
            assert!(key.meaning.ends_with('.'), "{}", key.path);
        }
    }

    #[test]
    fn defaults_lie_in_their_ranges() {
        for key in KEYS {
            match (key.kind, key.default) {
                (Kind::Number { min, max }, Default::Number(value)) => {
                    assert!((min..=max).contains(&value), "{}", key.path);
                }
                (Kind::Integer { min, max }, Default::Integer(value)) => {
                    assert!((min..=max).contains(&value), "{}", key.path);
                }
                (Kind::Choice(options), Default::Choice(word)) => {
                    assert!(options.iter().any(|&(name, built)| name == word && built), "{}", key.path);
                }
                _ => {}
            }
        }
    }

    #[test]
    fn units_are_read_from_names() {
        assert_eq!(unit("pressure_pa"), ("pressure", "Pa"));
        assert_eq!(unit("residual_volume_1_m3"), ("residual_volume_1", "m3"));
        assert_eq!(unit("gas_constant_j_per_kg_k"), ("gas_constant", "J/(kg K)"));
        assert_eq!(unit("law"), ("law", ""));
        assert_eq!(unit("max_speed_m_s"), ("max_speed", "m/s"));
    }
}
