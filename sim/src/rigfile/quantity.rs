//! Numbers with a unit: "6 bar(g)", "250 mm", "0.4 N/mm", "20 degC", "8,5 kg".
//!
//! A unit is a product of factors over others, as in `dm3/(s bar)` and `N/(m/s)`. A slash divides by everything up to the
//! next slash. The value of a factor in SI comes from [`uom`]; a whole exponent may follow it (`cm3`, `cm^3` or `cm³`).

mod likely;
mod spelling;
mod unit;

use unit::{Unit, is_pressure, unit_of};

/// A number that was read with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// In the requested unit.
    pub value: f64,
    /// Whether it counts from the pressure of the surroundings.
    pub gauge: bool,
    /// Whether its unit says gauge or absolute: `bar(g)`, `bar(a)`; not of `bar`.
    pub says_from_where: bool,
}

impl Reading {
    /// A number that counts from nothing but 0.
    #[must_use]
    pub fn plain(value: f64) -> Reading {
        Reading { value, gauge: false, says_from_where: false }
    }
}

/// Reads a number with its unit, and converts it into `unit`.
///
/// # Errors
/// The problem with the number or its unit, and the remedy.
pub fn read(text: &str, unit: &str) -> Result<Reading, String> {
    let (number, given) = spelling::number_and_unit(text)?;
    if given == unit {
        return Ok(Reading::plain(number));
    }
    if given.is_empty() {
        return Err(format!("needs a unit: write it as \"{}\", or in another unit", likely(number, unit)));
    }
    let reading = converted(number, &spelling::plain(given), given, unit)?;
    if reading.value.is_finite() { Ok(reading) } else { Err(format!("{text} is too large")) }
}

/// A number without its unit as it is likely to be meant, for a quantity of the unit `unit`.
#[must_use]
pub fn likely(number: f64, unit: &str) -> String {
    format!("{number} {}", likely::unit_of(number, unit))
}

/// A number in a unit whose spelling is plain, as it was `given`.
fn converted(number: f64, plain: &str, given: &str, unit: &str) -> Result<Reading, String> {
    if let ("K", Some(kelvin)) = (unit, kelvin(number, plain)) {
        return Ok(Reading::plain(digits(kelvin)));
    }
    let (symbol, gauge) = pressure_reference(plain);
    let target =
        unit_of(unit).ok_or_else(|| format!("is in {unit}, which cannot be converted from another unit"))?;
    let from =
        unit_of(of_flow(symbol, target)).ok_or_else(|| format!("{given} is not a known unit; use {unit}"))?;
    if from.dimension != target.dimension || (gauge == Some(true) && unit != "Pa") {
        return Err(format!("{given} is not a unit of the same quantity as {unit}"));
    }
    Ok(Reading {
        value: digits(number * from.factor / target.factor),
        gauge: gauge == Some(true),
        says_from_where: gauge.is_some(),
    })
}

/// K of a temperature on a scale with a zero of its own.
fn kelvin(number: f64, unit: &str) -> Option<f64> {
    match unit {
        "C" | "degC" => Some(number + 273.15),
        "F" | "degF" => Some((number + 459.67) * 5.0 / 9.0),
        _ => None,
    }
}

/// The unit of a flow or a conductance without the note that its volume is at the reference atmosphere: all are.
fn of_flow(unit: &str, target: Unit) -> &str {
    let is_flow = target.dimension == [3, 0, -1, 0, 0] || target.dimension == [4, -1, 1, 0, 0];
    let plain = unit.strip_suffix("(ANR)").or_else(|| unit.strip_suffix(" ANR"));
    plain.filter(|_| is_flow).map_or(unit, str::trim_end)
}

/// The unit of a pressure without its reference, and whether that reference is the surroundings; None if it does not say.
fn pressure_reference(unit: &str) -> (&str, Option<bool>) {
    let endings = [
        (["(g)", "(G)", "(gauge)", " gauge", "g", "G"], true),
        (["(a)", "(A)", "(abs)", " abs", "a", "A"], false),
    ];
    let found = endings.into_iter().find_map(|(endings, gauge)| {
        let symbol = endings.into_iter().find_map(|ending| unit.strip_suffix(ending))?.trim_end();
        is_pressure(symbol).then_some((symbol, Some(gauge)))
    });
    found.unwrap_or((unit, None))
}

/// A number without the last digit, which a conversion does not keep: 5.89 bar are 589000 Pa.
fn digits(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests;
