//! Numbers with a unit: "6 bar(g)", "250 mm", "0.4 N/mm", "20 degC".
//!
//! A unit is a product of factors over a product of factors, as in `dm3/(s bar)`. What a factor is worth in SI comes
//! from [`uom`]; a whole exponent stands behind it (`cm3`, `cm^3` or `cm³`).

use uom::si::f64::{
    Angle, Energy, Force, Frequency, Length, Mass, Power, Pressure, TemperatureInterval, Time, Volume,
};

/// Exponents of length, mass, time, temperature and angle.
type Dimension = [i32; 5];

/// What a unit is worth in SI, and of which dimension it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unit {
    factor: f64,
    dimension: Dimension,
}

/// A number that was read with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// In the requested unit.
    pub value: f64,
    /// Whether it counts from the pressure of the surroundings.
    pub gauge: bool,
}

/// Reads a number with its unit, and converts it into `unit`.
///
/// # Errors
/// What is wrong with the number or its unit, and what would be right.
pub fn read(text: &str, unit: &str) -> Result<Reading, String> {
    let (number, given) = number_and_unit(text)?;
    if given == unit {
        return Ok(Reading { value: number, gauge: false });
    }
    if given.is_empty() {
        return Err(format!("needs a unit: write it as \"{number} {unit}\", or in another unit"));
    }
    if let ("K", Some(celsius)) = (unit, of_celsius(number, given)) {
        return Ok(Reading { value: digits(celsius), gauge: false });
    }
    let (symbol, gauge) = pressure_reference(given);
    let target =
        parse(unit).ok_or_else(|| format!("is in {unit}, which cannot be converted from another unit"))?;
    let from = parse(symbol).ok_or_else(|| format!("{given} is not a known unit; use {unit}"))?;
    if from.dimension != target.dimension || (gauge && unit != "Pa") {
        return Err(format!("{given} is not a unit of the same quantity as {unit}"));
    }
    Ok(Reading { value: digits(number * from.factor / target.factor), gauge })
}

/// The number at the front of a text, and what follows.
fn number_and_unit(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    let ends = (1..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
    ends.map(|end| text.split_at(end))
        .find_map(|(number, unit)| Some((number.trim().parse::<f64>().ok()?, unit.trim())))
        .filter(|(number, _)| number.is_finite())
        .ok_or_else(|| format!("must be a number with a unit, such as \"6 bar(g)\", is \"{text}\""))
}

/// K of a temperature in degrees Celsius.
fn of_celsius(number: f64, unit: &str) -> Option<f64> {
    ["C", "degC", "°C"].contains(&unit).then_some(number + 273.15)
}

/// The unit of a pressure without what it counts from, and whether that is the surroundings.
fn pressure_reference(unit: &str) -> (&str, bool) {
    let gauge = ["(g)", "(gauge)", "g"].iter().find_map(|ending| unit.strip_suffix(ending));
    let absolute = ["(a)", "(abs)", "a"].iter().find_map(|ending| unit.strip_suffix(ending));
    let is_pressure = |unit: &&str| parse(unit.trim()).is_some_and(|found| found.dimension == PRESSURE);
    match (gauge.filter(is_pressure), absolute.filter(is_pressure)) {
        (Some(unit), _) => (unit.trim(), true),
        (_, Some(unit)) => (unit.trim(), false),
        _ => (unit, false),
    }
}

/// A number without the last digit, which a conversion does not keep: 5.89 bar are 589000 Pa.
fn digits(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

/// A unit such as `N s/m` or `m3/(s Pa)`.
fn parse(unit: &str) -> Option<Unit> {
    let (over, under) = unit.split_once('/').unwrap_or((unit, ""));
    let one = Unit { factor: 1.0, dimension: [0; 5] };
    let over = if over == "1" { one } else { product(over)? };
    let under = if under.is_empty() { one } else { product(under.trim_matches(['(', ')']))? };
    Some(Unit {
        factor: over.factor / under.factor,
        dimension: combined(over.dimension, under.dimension, -1),
    })
}

fn product(factors: &str) -> Option<Unit> {
    let mut product = Unit { factor: 1.0, dimension: [0; 5] };
    let factors: Vec<&str> = factors.split([' ', '*', '·']).filter(|factor| !factor.is_empty()).collect();
    if factors.is_empty() {
        return None;
    }
    for factor in factors {
        let (symbol, exponent) = powered(factor);
        let unit = atom(symbol)?;
        product.factor *= unit.factor.powi(exponent);
        product.dimension = combined(product.dimension, unit.dimension, exponent);
    }
    Some(product)
}

fn combined(a: Dimension, b: Dimension, exponent: i32) -> Dimension {
    std::array::from_fn(|i| a[i] + exponent * b[i])
}

/// A symbol and its exponent: `cm3` is (cm, 3).
fn powered(factor: &str) -> (&str, i32) {
    [("2", 2), ("²", 2), ("3", 3), ("³", 3)]
        .into_iter()
        .find_map(|(ending, exponent)| Some((factor.strip_suffix(ending)?.trim_end_matches('^'), exponent)))
        .unwrap_or((factor, 1))
}

const PRESSURE: Dimension = [-1, 1, -2, 0, 0];

/// One symbol, by the quantities of uom.
fn atom(symbol: &str) -> Option<Unit> {
    let symbol = match symbol {
        "l" => "L",
        "ml" => "mL",
        "um" => "µm",
        "us" => "µs",
        "deg" => "°",
        other => other,
    };
    let one = format!("1 {symbol}");
    macro_rules! first_of {
        ($($quantity:ty: $dimension:expr;)+) => {
            $(if let Ok(found) = one.parse::<$quantity>() {
                return Some(Unit { factor: found.value, dimension: $dimension });
            })+
        };
    }
    first_of! {
        Length: [1, 0, 0, 0, 0];
        Time: [0, 0, 1, 0, 0];
        Mass: [0, 1, 0, 0, 0];
        Force: [1, 1, -2, 0, 0];
        Pressure: PRESSURE;
        Volume: [3, 0, 0, 0, 0];
        Frequency: [0, 0, -1, 0, 0];
        Energy: [2, 1, -2, 0, 0];
        Power: [2, 1, -3, 0, 0];
        TemperatureInterval: [0, 0, 0, 1, 0];
        Angle: [0, 0, 0, 0, 1];
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::all_keys;

    fn value(text: &str, unit: &str) -> f64 {
        let reading = read(text, unit).unwrap_or_else(|message| panic!("{text}: {message}"));
        assert!(!reading.gauge, "{text}");
        reading.value
    }

    #[test]
    fn catalogue_units_become_those_of_keys() {
        for (text, unit, expected) in [
            ("250 mm", "m", 0.25),
            ("32mm", "m", 0.032),
            ("2 in", "mm", 50.8),
            ("5.89 bar", "Pa", 589e3),
            ("5.89 bar(a)", "Pa", 589e3),
            ("0.6 MPa", "Pa", 6e5),
            ("20 degC", "K", 293.15),
            ("-5 °C", "K", 268.15),
            ("300 K", "K", 300.0),
            ("22 cm3", "m3", 22e-6),
            ("22 cm^3", "m3", 22e-6),
            ("0.5 l", "m3", 5e-4),
            ("2 dm3/(s bar)", "m3/(s Pa)", 2e-8),
            ("350 l/min", "m3/s", 350e-3 / 60.0),
            ("0.4 N/mm", "N/m", 400.0),
            ("30 N s/m", "N s/m", 30.0),
            ("1.3 ms", "s", 1.3e-3),
            ("8 kg", "kg", 8.0),
            ("500 g", "kg", 0.5),
            ("2.5 kN", "N", 2500.0),
            ("90 deg", "deg", 90.0),
            ("1 J/(kg K)", "J/(kg K)", 1.0),
            ("5 %", "%", 5.0),
            ("3.6 mm/h", "mm/h", 3.6),
        ] {
            let got = value(text, unit);
            assert!((got - expected).abs() <= 1e-14 * expected.abs(), "{text}: {got}");
        }
    }

    #[test]
    fn gauge_is_told_from_absolute() {
        for text in ["6 bar(g)", "6 barg", "6 bar (g)", "600 kPa(g)", "600 kPag"] {
            assert_eq!(read(text, "Pa"), Ok(Reading { value: 6e5, gauge: true }), "{text}");
        }
        assert!(read("14.5 psig", "Pa").expect("a pressure").gauge);
        assert_eq!(value("6 bara", "Pa"), 6e5);
        assert!(read("6 g", "kg").is_ok_and(|reading| !reading.gauge), "a gram is no gauge pressure");
    }

    #[test]
    fn what_is_wrong_is_said_with_what_would_be_right() {
        for (text, unit, expected) in [
            ("6", "Pa", "needs a unit: write it as \"6 Pa\", or in another unit"),
            ("six bar", "Pa", "must be a number with a unit, such as \"6 bar(g)\", is \"six bar\""),
            ("6 foo", "Pa", "foo is not a known unit; use Pa"),
            ("6 mm", "Pa", "mm is not a unit of the same quantity as Pa"),
            ("6 bar(g)", "N", "bar(g) is not a unit of the same quantity as N"),
            ("6 mm", "counts", "is in counts, which cannot be converted from another unit"),
            ("inf mm", "m", "must be a number with a unit"),
        ] {
            let message = read(text, unit).expect_err(text);
            assert!(message.starts_with(expected), "{text}: {message}");
        }
    }

    #[test]
    fn every_unit_of_a_key_is_understood() {
        let counted = ["", "%", "samples", "counts", "mm/count", "mm/step"];
        for key in all_keys().filter(|key| !counted.contains(&key.unit()) && key.unit() != "1/s2") {
            assert_eq!(value(&format!("7 {}", key.unit()), key.unit()), 7.0, "{}", key.path);
        }
    }
}
