//! What can be fitted, and the scale on which it is searched.

use anyhow::{Result, anyhow, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::rig::keys::{self, Key, Kind};

/// Tables whose numbers are physical; of `[test]` the initial state is.
const TABLES: [&str; 9] =
    ["gas", "supply", "exhaust", "operator", "valve", "tubing", "actuator", "load", "test"];

/// The numbers of `[test]` that can be fitted.
const START: [&str; 5] = [
    "test.position_m",
    "test.pressure_1_pa",
    "test.pressure_2_pa",
    "test.temperature_1_k",
    "test.temperature_2_k",
];

/// What is plausible, to either side, of numbers that can be negative.
const PLAUSIBLE: [(&str, f64); 6] = [
    ("valve.null_offset_mm", 0.1),
    ("valve.underlap_mm", 0.1),
    ("load.constant_force_n", 50.0),
    ("load.incline_deg", 10.0),
    ("operator.dither_phase_deg", 90.0),
    ("test.position_m", 1e-3),
];

/// A key that is fitted.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// The key.
    pub key: &'static Key,
    /// The file's value, in the unit of the key.
    pub start: f64,
    /// None: u is the logarithm of the value over the file's. Else u is the difference over this.
    plausible: Option<f64>,
}

impl Parameter {
    /// A key of a rig as a parameter.
    ///
    /// # Errors
    /// When there is no such key, it is no physical number, or it has no value to start from.
    pub fn of(rig: &Rig, path: &str) -> Result<Parameter> {
        let key = keys::find(path).ok_or_else(|| {
            anyhow!("there is no key {path:?} to fit; `pneudrive rig explain` lists the keys")
        })?;
        let physical = TABLES.contains(&key.table()) && (key.table() != "test" || START.contains(&path));
        if !physical || !matches!(key.kind, Kind::Number { .. }) {
            bail!("{path} cannot be fitted: it is no physical number of the rig");
        }
        let model = |key: &Key| rig.word(&format!("{}.model", key.table())).to_owned();
        if !key.models.is_empty() && !key.models.contains(&model(key).as_str()) {
            bail!(
                "{path} cannot be fitted: the rig's {}.model = {:?} does not use it",
                key.table(),
                model(key)
            );
        }
        let start = rig
            .optional_number(path)
            .ok_or_else(|| anyhow!("{path} has no value in the rig file; give one to start from"))?;
        let plausible = PLAUSIBLE.iter().find(|(known, _)| *known == path).map(|(_, range)| *range);
        if plausible.is_none() && start <= 0.0 {
            bail!(
                "{path} is {start} in the rig file, and its logarithm is fitted; give a value above 0 to start from"
            );
        }
        Ok(Parameter { key, start, plausible })
    }

    /// The value at `u`, in the unit of the key, kept within the key's range.
    #[must_use]
    pub fn value(&self, u: f64) -> f64 {
        let value = match self.plausible {
            Some(range) => self.start + range * u,
            None => self.start * u.exp(),
        };
        match self.key.kind {
            Kind::Number { min, max } => value.clamp(min, max),
            _ => value,
        }
    }

    /// How much the value changes with u, in the unit of the key.
    #[must_use]
    pub fn slope(&self, u: f64) -> f64 {
        self.plausible.unwrap_or_else(|| self.value(u))
    }
}

/// What is fitted if nothing is named: what a rig has of the dry and viscous friction, leakage, the valve's
/// null and its coefficients of discharge, mass and the gain of the operator.
///
/// # Errors
/// When the file has no value to start from for one of them.
pub fn usual(rig: &Rig) -> Result<Vec<Parameter>> {
    let mut keys = vec![
        "load.static_extend_n",
        "load.coulomb_extend_n",
        "load.static_retract_n",
        "load.coulomb_retract_n",
        "load.viscous_n_s_per_m",
        "valve.null_offset_mm",
        "valve.discharge_supply",
        "valve.discharge_exhaust",
        "load.mass_kg",
    ];
    if rig.word("actuator.leakage") == "laminar" {
        keys.push("actuator.leakage_coefficient");
    }
    if rig.word("operator.model").starts_with("solenoid") {
        keys.push("operator.amplifier_gain");
    }
    keys.into_iter().map(|key| Parameter::of(rig, key)).collect()
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
    }

    #[test]
    fn values_stay_in_the_range_of_their_key() {
        let discharge = Parameter::of(&rig(""), "valve.discharge_supply").expect("a number");
        assert_eq!(discharge.value(3.0), 1.0);
    }

    #[test]
    fn what_is_no_physical_number_of_this_rig_is_refused_with_the_reason() {
        let refused = |path: &str| Parameter::of(&rig(""), path).expect_err("refused").to_string();
        assert!(refused("load.mas").contains("there is no key"));
        assert!(refused("controller.scale").contains("no physical number"));
        assert!(refused("test.duration_s").contains("no physical number"));
        assert!(refused("operator.mm_per_step").contains("does not use it"));
        assert!(refused("actuator.leakage_coefficient").contains("above 0"));
        assert!(refused("test.pressure_1_pa").contains("no value"));
    }
}
