//! The paths through a valve and its tubes, as the law "cascade" knows them: a conductance, a critical ratio, a land and tubes.
//!
//! ```text
//! orifice    C = Cd A sqrt(n/(R T_0)) (2/(n+1))^((n+1)/(2(n-1)))/rho_0,   b = (2/(n+1))^(n/(n-1))
//!            its ellipse is within 0.4 % of the isentropic flow function (`component/valve/iso6358.rs`)
//! land       pi (D_v + D_s)/2 sqrt(z^2 + d^2),   d = (D_v - D_s)/2    as wide as the port at z = p = D_p^2/(2 (D_v + D_s))
//! in series  1/C^2 = 1/C_land^2 + 1/C_port^2
//! tube       P_out = P_in (1 - k)^(m/m_ref), from the supply and to the cylinder, m of the orifice between them
//!            1/M = (1 - (m/x)^2)/m = a + b/(y - 1)        x: m without tubes, y: ratio of the pressures at the ends, both of the path
//! ```
//!
//! a and b are least squares of the errors of M, with the valve three quarters open, over chambers from the exhaust to the supply. What the law makes of
//! them is within 9 % of m on the thesis's tubes, whatever the opening (tested).

use crate::component::tubing::TubingKind;
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::iso6358::{Iso6358, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use crate::component::valve::{Valve, spool_travel};
use crate::keys;
use crate::values::Rig;

/// The part of the open valve that a and b are for.
const OPEN: f64 = 0.75;
/// Pressures that they are for: from so much above the exhaust to so much below the supply.
const EMPTY: f64 = 1.05;
const FULL: f64 = 0.98;
const PRESSURES: u32 = 25;

/// Both paths of a valve.
pub(super) struct Paths {
    /// Fully open: from the supply and to the exhaust.
    pub open: [Iso6358; 2],
    pub land: Option<Land>,
    /// From the supply and to the exhaust.
    pub tubes: Option<[Tubes; 2]>,
    /// What the tubes leave of the flow out of a chamber at three fifths of the supply.
    pub kept: f64,
}

/// A land before a port, m.
pub(super) struct Land {
    /// p and d.
    pub port: f64,
    pub clearance: f64,
}

/// a and b, times the choked flow of the open path at the pressure of the supply.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tubes {
    pub choked: f64,
    pub slight: f64,
}

/// Which way a path goes.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    In,
    Out,
}

/// A path of an orifice and tubes, SI.
struct Path {
    /// Choked flow over the pressure, kg/(s Pa).
    choked: f64,
    critical_ratio: f64,
    ends: [f64; 2],
    /// ln(P_in/P_out) over the flow of a tube, s/kg.
    decay: f64,
}

impl Paths {
    pub(super) fn of(rig: &Rig) -> Paths {
        let valve = rig.get(&keys::valve::MODEL);
        if !valve.facts().has_areas() {
            let open = valve.laws(rig).map(|law| match law {
                FlowLaw::Iso6358(path) => path,
                _ => Iso6358 { sonic_conductance: 0.0, critical_ratio: 0.0, subsonic_index: 0.5 },
            });
            return Paths { open, land: None, tubes: None, kept: 1.0 };
        }
        let valve = Valve::of(rig);
        let land = Land::of(&valve);
        let open = orifice(rig, valve.discharge_supply * land.in_series(&valve, spool_travel(rig) - valve.lap));
        let is_empirical = rig.get(&keys::tubing::MODEL) == TubingKind::Empirical;
        let path = is_empirical.then(|| Path::of(rig, &open));
        let tubes = path.as_ref().map(|path| [Way::In, Way::Out].map(|way| path.fit(way)));
        let kept = path.map_or(1.0, |path| {
            let pressure = 0.6 * rig.get(&keys::supply::PRESSURE_PA);
            path.flow(Way::Out, pressure, 1.0) / path.without_tubes(Way::Out, pressure)
        });
        Paths { open: [open; 2], land: Some(land), tubes, kept }
    }
}

/// An orifice of an effective area.
fn orifice(rig: &Rig, area: f64) -> Iso6358 {
    let (n, r) = (rig.get(&keys::gas::HEAT_CAPACITY_RATIO), rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K));
    let choked = n.sqrt() * libm::pow(2.0 / (n + 1.0), (n + 1.0) / (2.0 * (n - 1.0)));
    Iso6358 {
        sonic_conductance: area * choked / (r * REFERENCE_TEMPERATURE).sqrt() / REFERENCE_DENSITY,
        critical_ratio: libm::pow(2.0 / (n + 1.0), n / (n - 1.0)),
        subsonic_index: 0.5,
    }
}

impl Land {
    fn of(valve: &Valve) -> Land {
        let (sleeve, spool) = (valve.sleeve_diameter, valve.spool_diameter);
        let port = valve.port_diameter * valve.port_diameter / (2.0 * (sleeve + spool));
        Land { port, clearance: 0.5 * (sleeve - spool) }
    }

    /// The area of land and port in series, with the spool so far beyond the lap.
    fn in_series(&self, valve: &Valve, z: f64) -> f64 {
        let t = z.max(0.0).hypot(self.clearance) / self.port;
        valve.port_area() * t / t.hypot(1.0)
    }
}

impl Path {
    fn of(rig: &Rig, open: &Iso6358) -> Path {
        let temperature = rig.get(&keys::supply::TEMPERATURE_K);
        let drop = -libm::log(1.0 - rig.get(&keys::tubing::DROP_SLOPE));
        Path {
            choked: open.sonic_conductance * REFERENCE_DENSITY * (REFERENCE_TEMPERATURE / temperature).sqrt(),
            critical_ratio: open.critical_ratio,
            ends: [rig.get(&keys::supply::PRESSURE_PA), rig.get(&keys::exhaust::PRESSURE_PA)],
            decay: drop / rig.get(&keys::tubing::REFERENCE_FLOW_KG_S),
        }
    }

    /// Of the orifice between two pressures.
    fn between(&self, up: f64, down: f64) -> f64 {
        let beyond = ((down / up - self.critical_ratio) / (1.0 - self.critical_ratio)).clamp(0.0, 1.0);
        self.choked * up * (1.0 - beyond * beyond).sqrt()
    }

    fn without_tubes(&self, way: Way, pressure: f64) -> f64 {
        let [supply, exhaust] = self.ends;
        match way {
            Way::In => self.between(supply, pressure),
            Way::Out => self.between(pressure, exhaust),
        }
    }

    /// With tubes, the valve open by a part of its conductance: the flow falls with what it loses, so halves find it.
    fn flow(&self, way: Way, pressure: f64, part: f64) -> f64 {
        let [supply, exhaust] = self.ends;
        let behind_tubes = |flow: f64| {
            let left = libm::exp(-self.decay * flow);
            let (up, down) = match way {
                Way::In => (supply * left, pressure / left),
                Way::Out => (pressure * left, exhaust),
            };
            if down < up { part * self.between(up, down) } else { 0.0 }
        };
        let (mut low, mut high) = (0.0, part * self.without_tubes(way, pressure));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if behind_tubes(middle) > middle { low = middle } else { high = middle }
        }
        low
    }

    /// 1/(y - 1).
    fn nearness(&self, way: Way, pressure: f64) -> f64 {
        let [supply, exhaust] = self.ends;
        match way {
            Way::In => pressure / (supply - pressure),
            Way::Out => exhaust / (pressure - exhaust),
        }
    }

    /// Weighed by M: sum of ((a + b h) M - 1)^2.
    fn fit(&self, way: Way) -> Tubes {
        let [supply, exhaust] = self.ends;
        let [mut aa, mut ab, mut bb, mut a1, mut b1] = [0.0; 5];
        for i in 0..PRESSURES {
            let along = f64::from(i) / f64::from(PRESSURES - 1);
            let pressure = EMPTY * exhaust + along * (FULL * supply - EMPTY * exhaust);
            let flow = self.flow(way, pressure, OPEN);
            let left = flow / (OPEN * self.without_tubes(way, pressure));
            let m = flow / (1.0 - left * left).max(1e-9);
            let (a, b) = (m, m * self.nearness(way, pressure));
            aa += a * a;
            ab += a * b;
            bb += b * b;
            a1 += a;
            b1 += b;
        }
        let determinant = aa * bb - ab * ab;
        let open = self.choked * supply;
        Tubes {
            choked: open * (a1 * bb - b1 * ab) / determinant,
            slight: open * (aa * b1 - ab * a1) / determinant,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The law's quadratic beside the flow through orifice and tubes.
    #[test]
    fn a_quadratic_with_a_and_b_is_the_flow_behind_the_thesis_s_tubes() {
        let rig = Rig::builtin("servo-b").expect("there");
        let open = Paths::of(&rig).open[0];
        let path = Path::of(&rig, &open);
        let [supply, exhaust] = path.ends;
        for way in [Way::In, Way::Out] {
            let tubes = path.fit(way);
            let mut worst = 0.0_f64;
            for part in [0.04, 0.1, 0.2, 0.35, 0.6, 0.8, 1.0] {
                for i in 0..=40 {
                    let along = f64::from(i) / 40.0;
                    let pressure = EMPTY * exhaust + along * (FULL * supply - EMPTY * exhaust);
                    let x = part * path.without_tubes(way, pressure);
                    let lost = tubes.choked + tubes.slight * path.nearness(way, pressure);
                    let u = 0.5 * x / (path.choked * supply) * lost;
                    let error = x / (u.hypot(1.0) + u) / path.flow(way, pressure, part) - 1.0;
                    worst = worst.max(error.abs());
                }
            }
            assert!(worst < 0.09 && worst > 0.05, "{worst}");
        }
    }

    /// The ports of the thesis: 3.3 mm behind a sleeve of 10 mm.
    #[test]
    fn a_land_is_as_wide_as_its_port_where_it_says() {
        let rig = Rig::builtin("servo-c").expect("there");
        let (valve, land) = (Valve::of(&rig), Paths::of(&rig).land.expect("by its areas"));
        let z = (land.port * land.port - land.clearance * land.clearance).sqrt();
        assert!((valve.edge_area(z) / valve.port_area() - 1.0).abs() < 1e-12);
        assert!((land.in_series(&valve, z) / valve.port_area() - 0.5_f64.sqrt()).abs() < 1e-12);
    }
}
