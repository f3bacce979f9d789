//! A vessel of one litre that a valve charges and empties, against the closed forms of its pressure that follow from ISO 6358's
//! flow. Both sides have the same rho_0 and R.
//!
//! ```text
//! tau = V / (C rho_0 R T_0)
//! charging from P_s       r = r_0 + k t/tau up to b,   then r = b + (1 - b) sin(k (t - t_b)/((1 - b) tau)),   r = P/P_s
//! emptying, isothermal    P = P_0 exp(-t/tau) down to P_e/b
//!           then          t = t_b + (1 - b) tau int_0^theta d(theta)/(b + (1 - b) sin(theta)),  P_e/P = b + (1 - b) sin(theta)
//! emptying, adiabatic     P = P_0 (1 + (n - 1)/2 t/tau)^(-2n/(n - 1)) down to P_e/b
//! ```
//!
//! k is 1 where the air keeps its temperature and n where no heat passes the wall. ISO 6358-2 fills its vessel with wire, so that
//! the air keeps its temperature; here the wall takes up the heat.

use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Rig, run};

const VOLUME: f64 = 1e-3;
const C: f64 = 1.375e-8;
const B: f64 = 0.3;
const R: f64 = 286.76;
const T: f64 = 293.15;
const N: f64 = 1.4;
const DENSITY: f64 = 1.185;
const SUPPLY: f64 = 7e5;
const EXHAUST: f64 = 101_325.0;

/// Heat transfer of the wall, W/(m2 K).
const ADIABATIC: f64 = 0.0;
const ISOTHERMAL: f64 = 1e5;

/// Chamber 1 at its samples.
fn vessel(command: i32, pressure: f64, heat_transfer: f64) -> Vec<Row> {
    let settings = [
        format!("test.moves=[[0.0, {command}]]"),
        format!("test.pressure_1_pa={pressure:?}"),
        format!("test.pressure_2_pa={pressure:?}"),
        format!("actuator.heat_transfer_w_per_m2_k={heat_transfer:?}"),
    ];
    let text = include_str!("../../docs/examples/vessel.toml");
    let rig = Rig::read_with("vessel", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    let rows = run(&rig, Accuracy::of(&rig)).expect("it runs").rows;
    assert!(rows.iter().all(|row| row.plant.position == 0.1), "the piston sticks");
    rows
}

fn tau() -> f64 {
    VOLUME / (C * DENSITY * R * T)
}

/// The largest distance of chamber 1 from its closed form, of the pressure that the latter has.
fn largest_gap(rows: &[Row], closed: impl Fn(f64) -> Option<f64>) -> f64 {
    // The command takes effect after the delay of the first sample.
    let gap = |row: &Row| Some((row.plant.pressures[0] / closed((row.time - 0.001).max(0.0))? - 1.0).abs());
    let gaps: Vec<f64> = rows.iter().filter_map(gap).collect();
    assert!(gaps.len() > 50, "{} samples", gaps.len());
    gaps.into_iter().fold(0.0, f64::max)
}

/// Pressure of a vessel that is charged from a share `start` of the pressure that charges it, over that pressure: choked it rises by
/// `per_s`, then as ISO 6358-1 says with this critical ratio and m = 0.5.
pub fn charged(start: f64, per_s: f64, critical_ratio: f64, t: f64) -> f64 {
    let choked = start + per_s * t;
    if choked <= critical_ratio {
        return choked;
    }
    let angle = per_s * (t - (critical_ratio - start) / per_s) / (1.0 - critical_ratio);
    critical_ratio + (1.0 - critical_ratio) * angle.min(std::f64::consts::FRAC_PI_2).sin()
}

#[test]
fn a_vessel_is_charged_as_iso_6358_says() {
    for (wall, k) in [(ADIABATIC, N), (ISOTHERMAL, 1.0)] {
        let gap = largest_gap(&vessel(2048, EXHAUST, wall), |t| {
            Some(SUPPLY * charged(EXHAUST / SUPPLY, k / tau(), B, t))
        });
        assert!(gap < 1e-3, "k = {k}: {gap}");
    }
}

/// t_b and the time from there to an angle, by Simpson's rule.
fn emptying_time(angle: f64) -> f64 {
    let slope = |theta: f64| 1.0 / (B + (1.0 - B) * theta.sin());
    let h = angle / 1000.0;
    let panel = |i: i32| {
        let a = f64::from(i) * h;
        h / 6.0 * (slope(a) + 4.0 * slope(a + h / 2.0) + slope(a + h))
    };
    tau() * ((SUPPLY * B / EXHAUST).ln() + (1.0 - B) * (0..1000).map(panel).sum::<f64>())
}

#[test]
fn a_vessel_that_keeps_its_temperature_empties_as_iso_6358_says() {
    let choked_until = emptying_time(0.0);
    let end = emptying_time(std::f64::consts::FRAC_PI_2);
    let closed = |t: f64| {
        if t <= choked_until {
            return SUPPLY * (-t / tau()).exp();
        }
        let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if emptying_time(middle) < t.min(end) { &mut low } else { &mut high }) = middle;
        }
        EXHAUST / (B + (1.0 - B) * low.sin())
    };
    let gap = largest_gap(&vessel(-2048, SUPPLY, ISOTHERMAL), |t| Some(closed(t)));
    assert!(gap < 1e-3, "{gap}");
}

#[test]
fn a_vessel_that_no_heat_enters_empties_as_iso_6358_says_while_its_flow_is_choked() {
    let closed = |t: f64| {
        let pressure = SUPPLY * (1.0 + (N - 1.0) / 2.0 * t / tau()).powf(-2.0 * N / (N - 1.0));
        (pressure * B >= EXHAUST).then_some(pressure)
    };
    let gap = largest_gap(&vessel(-2048, SUPPLY, ADIABATIC), closed);
    assert!(gap < 1e-6, "{gap}");
}
