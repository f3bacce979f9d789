//! What can be fitted, on which scale it is searched, and what is assumed about it.

use anyhow::{Result, anyhow, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::component::actuator::leakage;
use pneudrive_sim::keys;
use pneudrive_sim::rig::MAX_DISCHARGE;
use pneudrive_sim::rig::{Key, Kind, Source, all_keys, find_key};

/// Tables whose numbers are physical; of `[test]` the initial state is.
const TABLES: [&str; 9] =
    ["gas", "supply", "exhaust", "operator", "valve", "tubing", "actuator", "load", "test"];

/// The numbers of `[test]` that can be fitted.
const START: [&str; 5] = [
    keys::test::POSITION_M.key.path,
    keys::test::PRESSURE_1_PA.key.path,
    keys::test::PRESSURE_2_PA.key.path,
    keys::test::TEMPERATURE_1_K.key.path,
    keys::test::TEMPERATURE_2_K.key.path,
];

/// Prior standard deviation of numbers that are searched by their difference from the file's value.
const DIFFERENCES: [(&str, f64); 9] = [
    (keys::valve::NULL_OFFSET_MM.key.path, 0.1),
    (keys::flow_map::FLOW_MAP_SHIFT.key.path, 1.0),
    (keys::valve::UNDERLAP_MM.key.path, 0.1),
    (keys::load::CONSTANT_FORCE_N.key.path, 50.0),
    (keys::load::INCLINE_DEG.key.path, 10.0),
    (keys::dither::DITHER_PHASE_DEG.key.path, 90.0),
    (keys::supply::TEMPERATURE_K.key.path, 10.0),
    (keys::exhaust::TEMPERATURE_K.key.path, 10.0),
    (keys::test::POSITION_M.key.path, 1e-3),
];

/// Prior standard deviation of the logarithm of a gauge reading.
const LOGARITHMS: [(&str, f64); 4] = [
    (keys::supply::PRESSURE_PA.key.path, 0.1),
    (keys::exhaust::PRESSURE_PA.key.path, 0.05),
    (keys::test::PRESSURE_1_PA.key.path, 0.1),
    (keys::test::PRESSURE_2_PA.key.path, 0.1),
];

/// The same for a quantity that is known to a factor of two.
const VAGUE: f64 = 0.7;

/// Prior standard deviation of any other logarithm.
const USUAL: f64 = 0.3;

/// Prior standard deviation of u where almost nothing is assumed.
const UNKNOWN: f64 = 30.0;

/// Longest step of a search in u, beyond which the linear model is not to be trusted: of a logarithm or a part of what is
/// assumed, and of what is searched in parts of a usual size.
const LONGEST: f64 = 0.3;
const LONGEST_OF_UNKNOWN: f64 = 3.0;

/// Difference in u for a derivative: large against the integrator's error, small against curvature.
const DIFFERENCE: f64 = 3e-4;

/// How u becomes a value.
#[derive(Clone, Copy, Debug)]
enum Scale {
    /// u is the logarithm of the value over the file's.
    Logarithm,
    /// u is the difference from the file's value, in its prior standard deviation.
    Difference(f64),
}

/// A key that is fitted.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its path in the rig file, such as `load.mass_kg`.
    pub key: &'static Key,
    /// The file's value, in the unit of the key.
    pub start: f64,
    scale: Scale,
    /// Standard deviation of u before there are data: how far the value may be from the file's.
    pub prior: f64,
    /// Difference in u for a derivative.
    pub difference: f64,
    /// Longest step of a search in u.
    pub longest: f64,
    /// Smallest and largest value, in the unit of the key.
    range: [f64; 2],
    /// Whether it is an error of calibration, and not a value of the rig.
    pub is_calibration: bool,
}

impl Parameter {
    /// A key of a rig as a parameter.
    ///
    /// # Errors
    /// When there is no such key, it is not a physical number, or it has no value to start from.
    pub fn of(rig: &Rig, path: &str) -> Result<Parameter> {
        let key = find_key(path).ok_or_else(|| {
            anyhow!("there is no key {path:?} to fit; `pneudrive rig explain` lists the keys")
        })?;
        let physical = TABLES.contains(&key.table()) && (key.table() != "test" || START.contains(&path));
        let Kind::Number { min, max } = key.kind else { return Err(not_physical(path)) };
        if !physical {
            return Err(not_physical(path));
        }
        if let Some(why) = rig.idle(key) {
            bail!("{path} cannot be fitted: it has no effect with {why}");
        }
        let start = rig
            .number_at(path)
            .ok_or_else(|| anyhow!("{path} has no value in the rig file; give one to start from"))?;
        let known =
            |table: &[(&str, f64)]| table.iter().find(|(known, _)| *known == path).map(|(_, size)| *size);
        let range = rig.origin(key).range;
        let (scale, prior) = match known(&DIFFERENCES) {
            Some(size) => {
                let size = range.map_or(size, |range| size.max(deviation(range, start)));
                (Scale::Difference(size), 1.0)
            }
            None => {
                let usual = known(&LOGARITHMS).unwrap_or(if key.vague { VAGUE } else { USUAL });
                let logarithms = range.filter(|[low, _]| *low > 0.0).map(|range| range.map(f64::ln));
                let stated = logarithms.map(|range| deviation(range, start.ln()));
                (Scale::Logarithm, stated.map_or(usual, |stated| usual.max(stated)))
            }
        };
        if matches!(scale, Scale::Logarithm) && start <= 0.0 {
            bail!(
                "{path} is {start} in the rig file, and its logarithm is fitted; give a value above 0 to start from"
            );
        }
        let capped = key.name().starts_with("discharge") && rig.get(&keys::valve::UPSTREAM_MACH);
        let max = if capped { MAX_DISCHARGE } else { max };
        let (difference, longest) = (DIFFERENCE, LONGEST);
        Ok(Parameter {
            key,
            start,
            scale,
            prior,
            difference,
            longest,
            range: [min, max],
            is_calibration: false,
        })
    }

    /// A key that is searched by the difference from the rig's value, in parts of `size` and not below `least`, both in
    /// its unit, and about which next to nothing is assumed. None where it is no number of the rig.
    #[must_use]
    pub(crate) fn by_difference(rig: &Rig, path: &str, size: f64, least: f64) -> Option<Parameter> {
        let key = find_key(path)?;
        let Kind::Number { min, max } = key.kind else { return None };
        let scale = Scale::Difference(size.abs());
        let range = [min.max(least), max];
        Some(Parameter {
            key,
            start: rig.number_at(path)?,
            scale,
            prior: UNKNOWN,
            difference: DIFFERENCE,
            longest: LONGEST_OF_UNKNOWN,
            range,
            is_calibration: false,
        })
    }

    /// An error of calibration with a tolerance, its standard deviation before there are data; the difference for a
    /// derivative and the longest step of a search are in the unit of the key, too. None where it is no number of the rig.
    #[must_use]
    pub fn calibration(
        rig: &Rig,
        path: &str,
        tolerance: f64,
        [difference, longest]: [f64; 2],
    ) -> Option<Parameter> {
        let free = Parameter::by_difference(rig, path, tolerance, f64::NEG_INFINITY)?;
        let (difference, longest) = (difference / tolerance, longest / tolerance);
        Some(Parameter { prior: 1.0, difference, longest, is_calibration: true, ..free })
    }

    /// The same error of calibration, about which next to nothing is assumed.
    #[must_use]
    pub fn freed(&self) -> Parameter {
        Parameter { prior: UNKNOWN * self.longest, ..self.clone() }
    }

    /// The same, searched by the difference from the file's value, with another prior standard deviation in its unit.
    #[must_use]
    pub fn within(self, size: f64) -> Parameter {
        Parameter { scale: Scale::Difference(size), prior: 1.0, ..self }
    }

    /// The value at `u`, in the unit of the key, kept within the key's range.
    #[must_use]
    pub fn value(&self, u: f64) -> f64 {
        let [min, max] = self.range;
        match self.scale {
            Scale::Difference(size) => self.start + size * u,
            Scale::Logarithm => self.start * u.exp(),
        }
        .clamp(min, max)
    }

    /// u at a value; minus infinity for the logarithm of 0.
    #[must_use]
    pub fn u(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Difference(size) => (value - self.start) / size,
            Scale::Logarithm => (value / self.start).ln(),
        }
    }

    /// Ends of the range of u.
    #[must_use]
    pub fn limits(&self) -> [f64; 2] {
        self.range.map(|end| self.u(end))
    }

    /// How much the value changes with u, in the unit of the key.
    #[must_use]
    pub fn slope(&self, u: f64) -> f64 {
        match self.scale {
            Scale::Difference(size) => size,
            Scale::Logarithm => self.value(u),
        }
    }

    /// What is assumed about the value, as a standard deviation: "+-0.1 mm" or "+-35 %".
    #[must_use]
    pub fn assumed_within(&self) -> String {
        match self.scale {
            Scale::Difference(size) => format!("+-{} {}", (1e4 * size).round() / 1e4, self.key.unit()),
            Scale::Logarithm if self.prior > 0.5 => format!("a factor of {:.1}", self.prior.exp()),
            Scale::Logarithm => format!("+-{:.0} %", 100.0 * self.prior),
        }
    }
}

/// Deviation (root mean square) of what lies anywhere in a range from a value in it.
fn deviation([low, high]: [f64; 2], start: f64) -> f64 {
    ((high - low) / 12f64.sqrt()).hypot(0.5 * (low + high) - start)
}

fn not_physical(path: &str) -> anyhow::Error {
    anyhow!("{path} cannot be fitted: it is not a physical number of the rig")
}

/// Numbers that are fitted besides those that a spread draws, as they are never known exactly, either.
const ALSO: [&str; 12] = [
    keys::valve::NULL_OFFSET_MM.key.path,
    keys::flow_map::FLOW_MAP_SHIFT.key.path,
    keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA.key.path,
    keys::iso6358::CRITICAL_RATIO.key.path,
    keys::iso6358::EXHAUST_SONIC_CONDUCTANCE_M3_PER_S_PA.key.path,
    keys::iso6358::EXHAUST_CRITICAL_RATIO.key.path,
    keys::lands::LEAKAGE_PERCENT.key.path,
    keys::empirical::STIFFNESS_PER_MASS_PER_S2.key.path,
    keys::empirical::DAMPING_PER_S.key.path,
    keys::tubing::FRICTION_FACTOR.key.path,
    keys::leakage::LEAKAGE_COEFFICIENT.key.path,
    keys::leakage::PASSAGE_CLEARANCE_M.key.path,
];

/// What is fitted if nothing is named: every physical value that the rig's models use and that is never known exactly, or that the
/// rig file gives as unknown. A value of 0 means that the rig does not have this; it is not fitted.
#[must_use]
pub fn usual(rig: &Rig) -> Vec<Parameter> {
    let is_open = |key| rig.origin(key).source == Source::Unknown;
    let unknown = all_keys().filter(|key| key.spread || ALSO.contains(&key.path) || is_open(key));
    unknown.filter(|key| belongs(rig, key.path)).filter_map(|key| Parameter::of(rig, key.path).ok()).collect()
}

/// Whether a rig has what a key tells of, where that is no matter of its table's model.
fn belongs(rig: &Rig, path: &str) -> bool {
    let leakage = rig.get(&keys::leakage::LEAKAGE);
    match path {
        _ if path == keys::leakage::LEAKAGE_COEFFICIENT.path => leakage == leakage::LeakageKind::Laminar,
        _ if path == keys::leakage::PASSAGE_CLEARANCE_M.path => leakage == leakage::LeakageKind::Adiabatic,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(text: &str) -> Rig {
        Rig::read("test", text).expect("valid")
    }

    #[test]
    fn what_cannot_be_negative_is_searched_by_its_logarithm_and_the_rest_by_differences() {
        let mass = Parameter::of(&rig(""), "load.mass_kg").expect("a number");
        assert_eq!(mass.value(0.0), 1.6);
        assert!((mass.value(0.1) / 1.6 - 0.1f64.exp()).abs() < 1e-12);
        let null = Parameter::of(&rig(""), "valve.null_offset_mm").expect("a number");
        assert_eq!((null.value(0.0), null.value(-0.5)), (0.0, -0.05));
        for parameter in [mass, null] {
            assert!((parameter.u(parameter.value(0.3)) - 0.3).abs() < 1e-12, "{}", parameter.key.path);
        }
    }

    #[test]
    fn values_stay_in_the_range_of_their_key() {
        let discharge = Parameter::of(&rig(""), "valve.discharge_supply").expect("a number");
        assert_eq!(discharge.value(3.0), MAX_DISCHARGE);
        let still = rig("[valve]\nupstream_mach = false\n");
        let discharge = Parameter::of(&still, "valve.discharge_supply").expect("a number");
        assert_eq!(discharge.value(3.0), 1.0);
    }

    #[test]
    fn what_is_never_known_exactly_is_fitted_as_far_as_the_rig_has_it() {
        let paths = |text: &str| -> Vec<&str> { usual(&rig(text)).iter().map(|p| p.key.path).collect() };
        let solenoid = paths("");
        for path in ["supply.pressure_pa", "operator.spring_n_per_mm", "valve.null_offset_mm", "load.mass_kg"]
        {
            assert!(solenoid.contains(&path), "{path}");
        }
        assert!(!solenoid.contains(&"actuator.leakage_coefficient"), "it has none");
        let stepper = paths("[operator]\nmodel = \"stepper\"\n[load]\nviscous_n_s_per_m = 0.0\n");
        assert!(stepper.iter().all(|path| !path.starts_with("operator.")), "{stepper:?}");
        assert!(!stepper.contains(&"load.viscous_n_s_per_m"), "there is no viscous friction");
        let leaks = paths("[actuator]\nleakage = \"laminar\"\nleakage_coefficient = 1e-9\n");
        assert!(leaks.contains(&"actuator.leakage_coefficient"));
    }

    #[test]
    fn a_valve_by_its_data_sheet_is_fitted_by_its_conductances_and_its_null() {
        let valve = "[valve]\nmodel = \"iso-6358\"\ncharacteristic = \"linear\"\nleakage_percent = 1.0\nsonic_conductance_m3_per_s_pa = 2e-8\ncritical_ratio = 0.3\n";
        let fitted = |more: &str| usual(&rig(&format!("{valve}{more}")));
        let paths = |more: &str| -> Vec<&str> { fitted(more).iter().map(|p| p.key.path).collect() };
        let exhaust = "valve.exhaust_sonic_conductance_m3_per_s_pa";
        for path in [
            "valve.sonic_conductance_m3_per_s_pa",
            "valve.critical_ratio",
            "valve.null_offset_mm",
            "valve.leakage_percent",
        ] {
            assert!(paths("").contains(&path), "{path}");
        }
        assert!(!paths("").contains(&exhaust), "it is that of the path from the supply");
        assert!(paths("exhaust_sonic_conductance_m3_per_s_pa = 3e-8\n").contains(&exhaust));
        for path in ["valve.discharge_supply", "valve.sleeve_diameter_mm", "valve.port_diameter_mm"] {
            assert!(!paths("").contains(&path), "{path} is none of its figures");
        }
    }

    #[test]
    fn what_a_rig_file_gives_as_unknown_is_fitted() {
        let lap = |value: &str| rig(&format!("[valve]\nunderlap_mm = {value}\n"));
        let fits_it = |rig: &Rig| usual(rig).iter().any(|p| p.key.path == keys::valve::UNDERLAP_MM.path);
        assert!(fits_it(&lap("{ unknown = 0.025, low = 0.0, high = 0.05, from = \"judgement\" }")));
        assert!(!fits_it(&lap("0.025")), "it is given");
    }

    #[test]
    fn no_less_is_assumed_open_than_anywhere_in_the_range_of_the_rig_file() {
        let spring = |value: &str| {
            Parameter::of(
                &rig(&format!("[operator]\nspring_n_per_mm = {value}\n")),
                "operator.spring_n_per_mm",
            )
        };
        let prior = |value: &str| spring(value).expect("a number").prior;
        let wide = prior("{ unknown = 9.0, low = 3.0, high = 27.0, from = \"judgement\" }");
        assert!((wide - 9f64.ln() / 12f64.sqrt()).abs() < 1e-12, "{wide}");
        let at_its_end = prior("{ unknown = 3.0, low = 3.0, high = 27.0, from = \"judgement\" }");
        assert!((at_its_end - 9f64.ln() / 3f64.sqrt()).abs() < 1e-12, "{at_its_end}");
        assert_eq!(prior("{ unknown = 9.0, low = 8.9, high = 9.1, from = \"judgement\" }"), prior("9.0"));
    }

    #[test]
    fn a_valve_by_its_map_is_fitted_within_the_spread_of_its_measurement() {
        let map = "[valve]\nmodel = \"flow-map\"\nflow_map = [[0, 700, 140, 4, 1], [0, 700, 560, 3, 1], [100, 700, 140, 800, 9], [100, 700, 560, 500, 9]]\n";
        let fitted = usual(&rig(map));
        let shift = fitted.iter().find(|p| p.key.path == "valve.flow_map_shift").expect("it is fitted");
        assert_eq!(
            (shift.value(0.0), shift.value(1.0), shift.prior),
            (0.0, 1.0, 1.0),
            "in standard deviations"
        );
    }

    /// A model of friction brings its keys with it.
    #[test]
    fn keys_of_a_model_of_friction_are_fitted_where_the_load_has_it() {
        let paths = |text: &str| -> Vec<&str> { usual(&rig(text)).iter().map(|p| p.key.path).collect() };
        let (bristles, lugre) = ("load.bristle_stiffness_n_per_m", "[load]\nfriction = \"lugre\"\n");
        assert!(paths(lugre).contains(&bristles) && !paths("").contains(&bristles));
        let refused = Parameter::of(&rig(""), bristles).expect_err("refused").to_string();
        assert!(refused.contains("has no effect with load.friction = \"coulomb\""), "{refused}");
        assert!(Parameter::of(&rig(lugre), bristles).expect("fitted").prior > 0.5);
    }

    #[test]
    fn what_is_no_physical_number_of_this_rig_is_refused_with_the_reason() {
        let refused = |path: &str| Parameter::of(&rig(""), path).expect_err("refused").to_string();
        assert!(refused("load.mas").contains("there is no key"));
        assert!(refused("controller.scale").contains("not a physical number"));
        assert!(refused("test.duration_s").contains("not a physical number"));
        assert!(refused("operator.mm_per_step").contains("has no effect with operator.model = \"solenoid\""));
        assert!(
            refused("actuator.leakage_coefficient").contains("no effect with actuator.leakage = \"none\"")
        );
        assert!(refused("actuator.heat_transfer_w_per_m2_k").contains("above 0"));
        assert!(refused("test.pressure_1_pa").contains("no value"));
    }
}
