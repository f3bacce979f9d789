//! The rigs that are identified.

use std::fmt::Write as _;

use pneudrive_sim::Rig;
use pneudrive_sim::rig::all_keys;
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::Hidden;

/// A drive that was levelled lies so many degrees off, standard deviation.
const LEVELLING_ERROR_DEG: f64 = 2.0;

/// The valve's null is off by so many mm at most.
const NULL: f64 = 0.01;

/// A file whose calibration is exact.
pub const EXACT: &str = "\
controller.clock_tolerance_percent = 0
encoder.scale_tolerance_percent = 0
encoder.offset_tolerance_mm = 0
sensors.pressure_gain_tolerance_percent = 0
sensors.pressure_offset_tolerance_pa = 0
sensors.spool_gain_tolerance_percent = 0
sensors.spool_offset_tolerance_mm = 0
";

/// The errors of scales, offsets and clock, each with its tolerance.
const SCALES: [(&str, &str); 9] = [
    ("controller.clock_error_percent", "controller.clock_tolerance_percent"),
    ("encoder.scale_error_percent", "encoder.scale_tolerance_percent"),
    ("encoder.offset_error_mm", "encoder.offset_tolerance_mm"),
    ("sensors.pressure_1_gain_error_percent", "sensors.pressure_gain_tolerance_percent"),
    ("sensors.pressure_1_offset_error_pa", "sensors.pressure_offset_tolerance_pa"),
    ("sensors.pressure_2_gain_error_percent", "sensors.pressure_gain_tolerance_percent"),
    ("sensors.pressure_2_offset_error_pa", "sensors.pressure_offset_tolerance_pa"),
    ("sensors.spool_gain_error_percent", "sensors.spool_gain_tolerance_percent"),
    ("sensors.spool_offset_error_mm", "sensors.spool_offset_tolerance_mm"),
];

/// Draws of a rig.
struct Draw(ChaCha8Rng);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit_interval(&mut self.0)
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        let place = (unit_interval(&mut self.0) * choices.len() as f64) as usize;
        choices[place.min(choices.len() - 1)]
    }

    /// A normal draw (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - unit_interval(&mut self.0), unit_interval(&mut self.0));
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }

    /// Any size between two, evenly by its logarithm.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(unit_interval(&mut self.0))
    }

    /// What a spread does not draw: the null of the valve, and how level the drive lies.
    fn rest(&mut self) -> String {
        let (null, incline) = (self.within(-NULL, NULL), LEVELLING_ERROR_DEG * self.normal());
        format!("valve.null_offset_mm = {null}\nload.incline_deg = {incline}\n")
    }
}

/// Servo-drive B as it is shipped, in the middle of its stroke.
#[must_use]
pub fn shipped_rig(seed: u64) -> Hidden {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let model = format!("{EXACT}operator.dither_mm = 0.26\ntest.position_m = 0.15\n");
    let real = format!("{model}{}", draw.rest());
    Hidden { name: "servo-b".to_owned(), model, real, lacks: None, quiet: false, live: false, seed }
}

/// A drive by its data sheets in the middle of its stroke, which goes on between its tests.
///
/// # Panics
/// When there is none of that name.
#[must_use]
pub fn live_rig(seed: u64) -> Hidden {
    let press = pneudrive_sim::rigfile::builtin("press").expect("a built-in rig");
    let is_place = |line: &&str| !line.starts_with("position_m") && !line.starts_with("moves_mm");
    let model: String = press.lines().filter(is_place).map(|line| format!("{line}\n")).collect();
    let model = format!("{model}position_m = 0.125005\nmoves_mm = [[0.0, 125.0]]\n");
    Hidden {
        name: "press".to_owned(),
        real: model.clone(),
        model,
        lacks: None,
        quiet: false,
        live: true,
        seed,
    }
}

/// Any cylinder, of 25 to 63 mm bore and 100 to 500 mm stroke, with a rod to one side, to both, or none, and a valve of
/// its size that a solenoid or a stepper drives, with or without a dither.
#[must_use]
pub fn any_rig(seed: u64) -> Hidden {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let operator = draw.of(&["solenoid", "solenoid", "solenoid-empirical", "stepper"]);
    let (rod, bore, stroke) = (
        draw.of(&["asymmetric", "symmetric", "rodless"]),
        draw.of(&[25.0, 32.0, 40.0, 50.0, 63.0]),
        draw.of(&[0.1, 0.2, 0.3, 0.5]),
    );
    // Of servo-drive B's bore.
    let size: f64 = bore / 50.0;
    let mut text = Text::default();
    text.put("actuator.bore_m", 1e-3 * bore);
    text.put("actuator.stroke_m", stroke);
    let rod_m = if rod == "rodless" { 0.0 } else { 1e-3 * bore * draw.within(0.3, 0.5) };
    text.put("actuator.rod_diameter_m", rod_m);
    text.put_load(size, &mut draw);
    text.put_valve(size, draw.within(5e5, 8e5));
    let pulse = draw.of(&[0.005, 0.01, 0.01205, 0.02]);
    text.put("encoder.mm_per_count", pulse);
    let dither = if bore < 40.0 { draw.of(&[0.0, 0.05, 0.1]) } else { draw.of(&[0.0, 0.1, 0.2, 0.26]) };
    if operator != "stepper" {
        text.put("operator.dither_mm", dither);
    }
    let position = stroke * draw.within(0.48, 0.52);
    text.put("test.position_m", position);
    // The way back of a plan, in closed loop: slow, and damped.
    let middle = (1e3 * position / pulse) as i32;
    let actuator = if rod == "asymmetric" { "asymmetric" } else { "symmetric" };
    let model = format!(
        "{EXACT}{}test.moves = [[0.0, {middle}]]\ntest.duration_s = 0.2\noperator.model = \"{operator}\"\nactuator.model = \"{actuator}\"\ncontroller.gain_profile = [512, 256, 128]\ncontroller.velocity_gain = 300\n",
        text.0
    );
    let real = format!("{model}{}", draw.rest());
    let name = format!("{operator}, {rod}, {bore} mm, {:.0} mm, dither {dither} mm", 1e3 * stroke);
    Hidden { name, model, real, lacks: None, quiet: false, live: false, seed }
}

/// The text of a rig file in the making; sizes are over those of servo-drive B.
#[derive(Default)]
struct Text(String);

impl Text {
    fn put(&mut self, key: &str, value: f64) {
        let _ = writeln!(self.0, "{key} = {value}");
    }

    /// Residual volumes, mass and friction.
    fn put_load(&mut self, size: f64, draw: &mut Draw) {
        for chamber in ["actuator.residual_volume_1_m3", "actuator.residual_volume_2_m3"] {
            self.put(chamber, 2e-5 * size.powi(2) * draw.within(0.6, 1.6));
        }
        self.put("load.mass_kg", 1.6 * size.powi(2) * draw.within(0.5, 3.0));
        self.put("load.viscous_n_s_per_m", 30.0 * size.powi(2) * draw.within(0.6, 1.8));
        for (way, stiction) in [("extend", 60.0), ("retract", 50.0)] {
            let stiction = stiction * size.powi(2) * draw.within(0.5, 1.3);
            self.put(&format!("load.static_{way}_n"), stiction);
            self.put(&format!("load.coulomb_{way}_n"), stiction * draw.within(0.3, 0.7));
        }
    }

    /// The supply, the valve and its tubes.
    fn put_valve(&mut self, size: f64, supply_pa: f64) {
        self.put("supply.pressure_pa", supply_pa);
        self.put("valve.sleeve_diameter_mm", 10.0 * size);
        self.put("valve.spool_diameter_mm", 10.0 * size - 0.02);
        self.put("valve.port_diameter_mm", 3.3 * size);
        self.put("tubing.reference_flow_kg_s", 4.65e-3 * size.powi(2));
    }
}

/// The same as [`shipped_rig`] or [`any_rig`], its values written out instead of drawn by the virtual rig: that has no
/// noise, and rounding is all there is.
///
/// # Panics
/// When the rig that was drawn is not valid.
#[must_use]
pub fn quiet_rig(seed: u64) -> Hidden {
    quiet(if seed.is_multiple_of(2) { shipped_rig(seed) } else { any_rig(seed) })
}

/// A rig without noise that lacks an effect.
///
/// # Panics
/// When the rig that was drawn is not valid.
#[must_use]
pub fn quiet_lacking_rig(seed: u64) -> Hidden {
    quiet(lacking_rig(seed))
}

fn quiet(mut hidden: Hidden) -> Hidden {
    let truth = hidden.truth().expect("a drawn rig is valid");
    let drawn: Vec<(&str, f64)> = all_keys()
        .filter(|key| key.spread)
        .filter_map(|key| Some((key.path, truth.number_at(key.path)?)))
        .collect();
    let is_drawn = |line: &str| drawn.iter().any(|(path, _)| line.split(" =").next() == Some(*path));
    let rest = hidden.real.lines().filter(|line| !is_drawn(line)).map(|line| format!("{line}\n"));
    let written = drawn.iter().map(|(path, value)| format!("{path} = {value}\n"));
    hidden.real = rest.chain(written).collect();
    Hidden { quiet: true, ..hidden }
}

/// Servo-drive B, or any rig, each of whose scales and offsets and whose clock is off by the whole tolerance that the file has
/// without saying so, one way or the other.
///
/// # Panics
/// When a key of a tolerance has no value.
#[must_use]
pub fn scaled_rig(seed: u64) -> Hidden {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(!seed));
    let mut hidden = if seed.is_multiple_of(2) { shipped_rig(seed) } else { any_rig(seed) };
    hidden.model = hidden.model.replacen(EXACT, "", 1);
    hidden.real = hidden.real.replacen(EXACT, "", 1);
    let rig = Rig::read("model.toml", &hidden.model).expect("valid");
    for (error, tolerance) in SCALES {
        let size = rig.number_at(tolerance).expect("a number");
        let _ = writeln!(hidden.real, "{error} = {}", draw.of(&[-1.0, 1.0]) * size);
    }
    hidden
}

/// The same with one error of its own, as a user's file has it.
#[must_use]
pub fn misscaled_rig(seed: u64, error: &str, tolerances: &str) -> Hidden {
    let mut hidden = shipped_rig(seed);
    hidden.model = hidden.model.replacen(EXACT, tolerances, 1);
    hidden.real = format!("{}{error}\n", hidden.real.replacen(EXACT, tolerances, 1));
    hidden
}

/// What real rigs have and a rig file lacks: keys, and the smallest and largest size.
const EFFECTS: [(&str, f64, f64); 11] = [
    ("actuator.heat_transfer_w_per_m2_k", 3.0, 200.0),
    ("sensors.pressure_lag_s", 1e-4, 5e-3),
    ("tubing.lag_s", 3e-4, 1e-2),
    ("actuator.leakage_coefficient", 1e-11, 3e-9),
    ("load.incline_deg", 0.5, 8.0),
    ("load.spring_n_per_m", 3.0, 300.0),
    ("valve.underlap_mm", 1e-3, 0.1),
    ("supply.temperature_k", 1.0, 30.0),
    ("gas.heat_capacity_ratio", 0.003, 0.1),
    ("exhaust.pressure_pa", 300.0, 1e4),
    ("valve.upstream_mach", 0.0, 0.0),
];

/// Servo-drive B, or any rig, with one effect that the rig file does not have, from slight to large.
#[must_use]
pub fn lacking_rig(seed: u64) -> Hidden {
    // Another stream than that of the rig itself.
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(!seed));
    let mut hidden = if seed.is_multiple_of(2) { shipped_rig(seed) } else { any_rig(seed) };
    let (key, low, high) = EFFECTS[(seed as usize) % EFFECTS.len()];
    let sign = draw.of(&[-1.0, 1.0]);
    let size = if low > 0.0 { draw.size(low, high) } else { 0.0 };
    let effect = match key {
        "valve.upstream_mach" => "valve.upstream_mach = false\n".to_owned(),
        "actuator.leakage_coefficient" => format!("actuator.leakage = \"laminar\"\n{key} = {size}\n"),
        "load.incline_deg" => {
            let level = hidden.real.lines().filter(|line| !line.starts_with(key));
            hidden.real = level.map(|line| format!("{line}\n")).collect();
            format!("{key} = {}\n", sign * size)
        }
        "supply.temperature_k" => format!("{key} = {}\n", 294.0 + sign * size),
        "gas.heat_capacity_ratio" => format!("{key} = {}\n", 1.4 - size),
        "exhaust.pressure_pa" => format!("{key} = {}\n", 101_300.0 - size),
        "valve.underlap_mm" => format!("{key} = {}\n", sign * size),
        _ => format!("{key} = {size}\n"),
    };
    hidden.real.push_str(&effect);
    hidden.lacks = Some(effect.lines().last().unwrap_or_default().to_owned());
    hidden
}
