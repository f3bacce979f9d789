//! Sonic conductance and critical ratio of a path from measured flows (ISO 6358-1).
//!
//! ```text
//! q = mdot / (rho_0 P_u sqrt(T_0/T_u)) = C f(r; b, m),   r = P_d/P_u      m is that of the rig, 0.5 the ellipse
//! f = 1 for r <= b,   (1 - ((r - b)/(1 - b))^2)^m above
//! ```
//!
//! C and b make the sum of the squared differences of q least. For a given b that C is a quotient; b is searched for. The errors
//! come from the slopes of f over both at the points, and from the scatter that is left. Points that are all choked say nothing
//! of b, and points that are all far from choked let C and b stand for each other: then there is no figure.

use anyhow::{Context, Result, bail};
use pneudrive_sim::component::valve::iso6358::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use pneudrive_tables::Table;

use super::figures::Figure;

/// Columns of the flow, and kg/s in one of their units.
const FLOWS: [(&str, f64); 3] =
    [("flow_l_min", REFERENCE_DENSITY / 6e4), ("flow_g_s", 1e-3), ("flow_kg_s", 1.0)];
/// Zero of the Celsius scale, K.
const CELSIUS: f64 = 273.15;
/// b that no component has.
const MAX_RATIO: f64 = 0.9;
/// Steps of the search for b.
const STEPS: u32 = 900;
/// Fewest points for two figures and their errors.
const MIN_POINTS: usize = 4;
/// A standard error of b above this is no knowledge of b.
const UNSEEN: f64 = 0.1;

/// A measured flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// P_d/P_u.
    pub ratio: f64,
    /// q, m^3/(s Pa).
    pub conductance: f64,
}

/// What measured flows tell of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// C, m^3/(s Pa).
    pub sonic_conductance: Figure,
    /// b.
    pub critical_ratio: Figure,
    /// Standard deviation of q from the curve, of C.
    pub scatter: f64,
}

impl Point {
    /// A mass flow (kg/s) between pressures (Pa) at a temperature upstream (K).
    #[must_use]
    pub fn of(flow: f64, [up, down]: [f64; 2], temperature: f64) -> Point {
        let conductance = flow / (REFERENCE_DENSITY * up * (REFERENCE_TEMPERATURE / temperature).sqrt());
        Point { ratio: down / up, conductance }
    }
}

impl Path {
    /// Through points, for a subsonic index.
    ///
    /// ```
    /// use pneudrive_identify::conductance::{Path, Point};
    ///
    /// // A valve of C = 3e-8 m^3/(s Pa) and b = 0.3, its flows read to 0.5 % by turns too high and too low.
    /// let share = |ratio: f64| (1.0 - ((ratio - 0.3) / 0.7).max(0.0).powi(2)).sqrt();
    /// let points = [0.1, 0.2, 0.4, 0.6, 0.8, 0.9].map(|ratio| Point { ratio, conductance: 3e-8 * share(ratio) });
    /// let points: Vec<Point> = points.iter().zip([1.005, 0.995].iter().cycle())
    ///     .map(|(point, read)| Point { conductance: point.conductance * read, ..*point }).collect();
    /// let Path { sonic_conductance, critical_ratio, .. } = Path::through(&points, 0.5)?;
    /// assert!((sonic_conductance.value - 3e-8).abs() < 2.0 * sonic_conductance.error);
    /// assert!((critical_ratio.value - 0.3).abs() < 2.0 * critical_ratio.error);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the points do not tell C and b: with what is missing.
    pub fn through(points: &[Point], index: f64) -> Result<Path> {
        if points.len() < MIN_POINTS {
            bail!("C and b need {MIN_POINTS} points at least, found {}", points.len());
        }
        let left = |ratio: f64| squares(points, ratio, index);
        let at = |step: u32| MAX_RATIO * f64::from(step) / f64::from(STEPS);
        let best = (0..=STEPS).min_by(|a, b| left(at(*a)).total_cmp(&left(at(*b)))).unwrap_or(0);
        let ratio = least(left, at(best.saturating_sub(1)), at((best + 1).min(STEPS)));
        let sonic = sonic_conductance(points, ratio, index);
        let scatter = (left(ratio) / (points.len() - 2) as f64).sqrt();
        let errors = errors(points, [sonic, ratio], index, scatter);
        let [sonic_error, ratio_error] = errors
            .context("all points are choked: C can be seen, b cannot; measure at smaller drops, too")?;
        if ratio_error > UNSEEN {
            bail!(
                "b cannot be seen: its standard error is {ratio_error:.2}; measure from choked flow (a pressure ratio below 0.2) to small drops (above 0.8)"
            );
        }
        Ok(Path {
            sonic_conductance: Figure { value: sonic, error: sonic_error },
            critical_ratio: Figure { value: ratio, error: ratio_error },
            scatter: scatter / sonic,
        })
    }

    /// Of a table (a head with `upstream_kpa` and `downstream_kpa`, absolute, one of `flow_l_min` (ANR),
    /// `flow_g_s` and `flow_kg_s`, and perhaps `temperature_c`, upstream, without which it is 20).
    ///
    /// # Errors
    /// When it is no such table, with the line, and as [`Path::through`].
    pub fn of_table(bytes: impl AsRef<[u8]>, index: f64) -> Result<Path> {
        Path::through(&points(&Table::read_whole(bytes)?)?, index)
    }
}

/// f.
fn share(ratio: f64, critical: f64, index: f64) -> f64 {
    let beyond = ((ratio - critical) / (1.0 - critical)).max(0.0);
    (1.0 - beyond * beyond).max(0.0).powf(index)
}

/// The C that fits best with a b.
fn sonic_conductance(points: &[Point], critical: f64, index: f64) -> f64 {
    let shares = || points.iter().map(|point| share(point.ratio, critical, index));
    let product: f64 = points.iter().zip(shares()).map(|(point, share)| point.conductance * share).sum();
    product / shares().map(|share| share * share).sum::<f64>().max(f64::MIN_POSITIVE)
}

/// What the best C leaves with a b.
fn squares(points: &[Point], critical: f64, index: f64) -> f64 {
    let sonic = sonic_conductance(points, critical, index);
    points.iter().map(|point| (point.conductance - sonic * share(point.ratio, critical, index)).powi(2)).sum()
}

/// Standard errors of C and b; None where the points do not tell them apart.
fn errors(points: &[Point], [sonic, critical]: [f64; 2], index: f64, scatter: f64) -> Option<[f64; 2]> {
    let step = 1e-5;
    let slopes = |point: &Point| {
        let by_ratio = |by: f64| share(point.ratio, critical + by, index);
        [share(point.ratio, critical, index), sonic * (by_ratio(step) - by_ratio(-step)) / (2.0 * step)]
    };
    let sum = |of: &dyn Fn([f64; 2]) -> f64| points.iter().map(|point| of(slopes(point))).sum::<f64>();
    let [a, b, c] = [sum(&|s| s[0] * s[0]), sum(&|s| s[0] * s[1]), sum(&|s| s[1] * s[1])];
    let determinant = a * c - b * b;
    (determinant > 1e-12 * a * c && c > 0.0)
        .then(|| [c, a].map(|diagonal| scatter * (diagonal / determinant).sqrt()))
}

/// Where `f` is least between `a` and `b`, by the golden section.
fn least(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let section = (5.0_f64.sqrt() - 1.0) / 2.0;
    while b - a > 1e-9 {
        let [c, d] = [b - section * (b - a), a + section * (b - a)];
        if f(c) < f(d) { b = d } else { a = c }
    }
    0.5 * (a + b)
}

fn points(table: &Table) -> Result<Vec<Point>> {
    let found = table.find_first(&FLOWS)?;
    let (Some(up), Some(down), Some((flow, unit))) =
        (table.find(&["upstream_kpa"])?, table.find(&["downstream_kpa"])?, found)
    else {
        bail!(
            "line {}: expected a header with upstream_kpa, downstream_kpa (both absolute) and flow_l_min, flow_g_s or flow_kg_s; found {}",
            table.head_line(),
            table.names().join(", ")
        );
    };
    let warm = table.find(&["temperature_c"])?;
    let [up, down, flow] = [up, down, flow].map(|place| table.all_numbers(place));
    let (up, down, flow) = (up?, down?, flow?);
    let temperature = match warm {
        Some(place) => table.all_numbers(place)?,
        None => vec![REFERENCE_TEMPERATURE - CELSIUS; table.rows()],
    };
    (0..table.rows())
        .map(|row| {
            let (n, up, down, flow) = (table.line(row), up[row], down[row], flow[row]);
            if !(up > 0.0 && (0.0..=up).contains(&down)) {
                bail!("line {n}: {up} kPa upstream and {down} kPa downstream: absolute pressures that fall are needed");
            }
            if flow < 0.0 {
                bail!("line {n}: a flow of {flow} goes against its pressures");
            }
            Ok(Point::of(unit * flow, [1e3 * up, 1e3 * down], CELSIUS + temperature[row]))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(critical: f64, index: f64, off: impl Fn(usize) -> f64) -> String {
        let lines = (0..20).map(|i| {
            let ratio = 0.1 + 0.88 * i as f64 / 19.0;
            // C = 2 dm3/(s bar) at 7 bar: 14 dm3/s, 840 l/min.
            let flow = 840.0 * share(ratio, critical, index) + off(i);
            format!("700,{},{flow}\n", 700.0 * ratio)
        });
        format!("upstream_kpa,downstream_kpa,flow_l_min\n{}", lines.collect::<String>())
    }

    #[test]
    fn c_and_b_of_points_on_the_curve_are_found() {
        for (critical, index) in [(0.3, 0.5), (0.15, 0.5), (0.44, 0.5), (0.25, 0.57)] {
            let found = Path::of_table(table(critical, index, |_| 0.0), index).expect("a path");
            assert!((found.sonic_conductance.value / 2e-8 - 1.0).abs() < 1e-6, "{found:?}");
            assert!((found.critical_ratio.value - critical).abs() < 1e-6, "{found:?}");
        }
    }

    /// Errors of +-4.2 l/min, half a percent of the flow, alternating: the scatter is that, and the figures hold within their
    /// errors.
    #[test]
    fn scatter_is_carried_into_the_errors_of_both_figures() {
        let found =
            Path::of_table(table(0.3, 0.5, |i| if i % 2 == 0 { 4.2 } else { -4.2 }), 0.5).expect("a path");
        assert!((found.scatter / 0.005 - 1.0).abs() < 0.15, "{found:?}");
        let Figure { value, error } = found.sonic_conductance;
        assert!((value - 2e-8).abs() < 2.0 * error && error < 0.01 * value, "{found:?}");
        let Figure { value, error } = found.critical_ratio;
        assert!((value - 0.3).abs() < 2.0 * error && (1e-3..0.05).contains(&error), "{found:?}");
    }

    #[test]
    fn a_warm_upstream_counts() {
        let csv = "upstream_kpa,downstream_kpa,flow_kg_s,temperature_c\n";
        let line = |ratio: f64| {
            let flow = 2e-8 * 1.185 * 7e5 * (293.15_f64 / 333.15).sqrt() * share(ratio, 0.3, 0.5);
            format!("700,{},{flow},60\n", 700.0 * ratio)
        };
        let lines: String = [0.1, 0.2, 0.5, 0.7, 0.9].map(line).concat();
        let found = Path::of_table(format!("{csv}{lines}"), 0.5).expect("a path");
        assert!((found.sonic_conductance.value / 2e-8 - 1.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn what_the_points_do_not_show_is_not_told() {
        let header = "upstream_kpa,downstream_kpa,flow_l_min\n";
        for (rows, says) in [
            ("700,70,840\n700,100,840\n700,50,841\n700,60,839\n", "b cannot"),
            ("700,70,840\n700,600,400\n", "4 points"),
            ("700,70\n", "line 2"),
            ("600,700,840\n", "absolute pressures that fall"),
            ("700,600,-840\n", "goes against"),
        ] {
            let message =
                format!("{:#}", Path::of_table(format!("{header}{rows}"), 0.5).expect_err("refused"));
            assert!(message.contains(says), "{rows:?}: {message}");
        }
        assert!(format!("{:#}", Path::of_table("a,b\n1,2\n", 0.5).expect_err("no table")).contains("line 1"));
    }
}
