//! The value of a unit.

use uom::si::f64::{
    Angle, Energy, Force, Frequency, Length, Mass, Power, Pressure, TemperatureInterval, Time, Volume,
};

/// Exponents of length, mass, time, temperature and angle.
type Dimension = [i32; 5];

/// The value of a unit in SI, and its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    pub factor: f64,
    pub dimension: Dimension,
}

const ONE: Unit = Unit { factor: 1.0, dimension: [0; 5] };

const PRESSURE: Dimension = [-1, 1, -2, 0, 0];

impl Unit {
    fn times(self, other: Unit, exponent: i32) -> Unit {
        Unit {
            factor: self.factor * other.factor.powi(exponent),
            dimension: std::array::from_fn(|i| self.dimension[i] + exponent * other.dimension[i]),
        }
    }
}

/// Whether a unit is one of a pressure.
pub fn is_pressure(unit: &str) -> bool {
    unit_of(unit).is_some_and(|found| found.dimension == PRESSURE)
}

/// A unit such as `N s/m`, `m3/(s Pa)` or `N/(m/s)`.
pub fn unit_of(unit: &str) -> Option<Unit> {
    let mut rest = unit.trim();
    let found = quotient(&mut rest)?;
    rest.is_empty().then_some(found)
}

/// Products with slashes between them, up to the end or a closing bracket.
fn quotient(rest: &mut &str) -> Option<Unit> {
    let mut found = product(rest)?;
    while let Some(under) = rest.strip_prefix('/') {
        *rest = under;
        found = found.times(product(rest)?, -1);
    }
    Some(found)
}

/// Factors, up to a slash, a closing bracket or the end.
fn product(rest: &mut &str) -> Option<Unit> {
    let mut found = None;
    loop {
        *rest = rest.trim_start();
        if rest.is_empty() || rest.starts_with(['/', ')']) {
            return found;
        }
        found = Some(found.unwrap_or(ONE).times(factor(rest)?, 1));
    }
}

fn factor(rest: &mut &str) -> Option<Unit> {
    if let Some(inner) = rest.strip_prefix('(') {
        *rest = inner;
        let found = quotient(rest)?;
        *rest = rest.strip_prefix(')')?;
        return Some(found);
    }
    let end = rest.find([' ', '/', '(', ')']).unwrap_or(rest.len());
    let (factor, behind) = rest.split_at(end);
    *rest = behind;
    if factor == "1" {
        return Some(ONE);
    }
    let (symbol, exponent) = powered(factor);
    Some(ONE.times(symbol_of(symbol)?, exponent))
}

/// A symbol and its exponent: `cm3` is (cm, 3), `s-1` is (s, -1).
fn powered(factor: &str) -> (&str, i32) {
    let symbol = factor.trim_end_matches(|letter: char| letter.is_ascii_digit()).trim_end_matches('-');
    match factor[symbol.len()..].parse() {
        Ok(exponent) if (-4..=4).contains(&exponent) && exponent != 0 => {
            (symbol.trim_end_matches('^'), exponent)
        }
        _ => (factor, 1),
    }
}

/// One symbol, or two without a space between them: `Ns`, `Nm`.
fn symbol_of(symbol: &str) -> Option<Unit> {
    const FIRST: [&str; 5] = ["kN", "N", "Pa", "J", "W"];
    const SECOND: [&str; 4] = ["mm", "m", "s", "h"];
    atom(symbol).or_else(|| {
        let first = FIRST.into_iter().find(|first| symbol.starts_with(first))?;
        let second = SECOND.into_iter().find(|second| *second == &symbol[first.len()..])?;
        Some(atom(first)?.times(atom(second)?, 1))
    })
}

/// uom's symbol for a common spelling.
fn usual(symbol: &str) -> &str {
    match symbol {
        "l" => "L",
        "ml" => "mL",
        "um" => "\u{b5}m",
        "us" => "\u{b5}s",
        "ul" | "\u{b5}l" => "\u{b5}L",
        "deg" => "\u{b0}",
        "degC" => "\u{b0}C",
        "degF" => "\u{b0}F",
        "degR" => "\u{b0}R",
        "degK" => "K",
        "lbs" => "lb",
        "sec" => "s",
        "hr" => "h",
        "Kg" => "kg",
        "Bar" | "BAR" => "bar",
        "PSI" | "Psi" => "psi",
        "inch" | "inches" => "in",
        other => other,
    }
}

/// One symbol, by the quantities of uom.
fn atom(symbol: &str) -> Option<Unit> {
    let one = format!("1 {}", usual(symbol));
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
