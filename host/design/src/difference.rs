//! Two rigs, key by key.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::{Key, Value, all_keys};

/// A key at which two rigs differ.
#[derive(Clone, Debug)]
pub struct Difference<'a> {
    /// The key.
    pub key: &'static Key,
    /// Its values; None where a rig has none, or its models do not use it.
    pub values: [Option<&'a Value>; 2],
}

/// Where two rigs differ, in the order of `rig explain`. A key that the models of neither use does not count.
#[must_use]
pub fn differences<'a>(one: &'a Rig, other: &'a Rig) -> Vec<Difference<'a>> {
    let value_in = |rig: &'a Rig, key: &Key| rig.value(key.path).filter(|_| rig.uses(key));
    all_keys()
        .map(|key| Difference { key, values: [value_in(one, key), value_in(other, key)] })
        .filter(|difference| difference.values[0] != difference.values[1])
        .collect()
}

impl Difference<'_> {
    /// How much larger the second number is, in percent of the first; None where there are no two numbers.
    #[must_use]
    pub fn percent(&self) -> Option<f64> {
        let number = |value: Option<&Value>| match value {
            Some(Value::Number(number)) => Some(*number),
            Some(Value::Integer(number)) => Some(*number as f64),
            _ => None,
        };
        let [first, second] = self.values.map(number);
        let (first, second) = (first.filter(|first| *first != 0.0)?, second?);
        Some(100.0 * (second - first) / first.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(one: &str, other: &str) -> Vec<&'static str> {
        let [one, other] = [one, other].map(|text| Rig::read("rig", text).expect("a rig"));
        differences(&one, &other).iter().map(|difference| difference.key.path).collect()
    }

    #[test]
    fn only_what_differs_is_told() {
        assert_eq!(paths("[load]\nmass_kg = 2\n", "[load]\nmass_kg = 3\n"), ["load.mass_kg"]);
        assert!(paths("[load]\nmass_kg = 1.6\n", "").is_empty(), "the same value, from elsewhere");
    }

    #[test]
    fn keys_of_a_model_that_one_rig_has_differ_from_nothing() {
        let found = paths("[tubing]\nmodel = \"none\"\n", "");
        assert!(found.contains(&"tubing.model") && found.contains(&"tubing.drop_slope"), "{found:?}");
    }

    #[test]
    fn numbers_differ_by_percent() {
        let [one, other] = ["[load]\nmass_kg = 2\n", "[load]\nmass_kg = 3\n"]
            .map(|text| Rig::read("rig", text).expect("a rig"));
        assert_eq!(differences(&one, &other)[0].percent(), Some(50.0));
    }
}
