//! The flow as in data sheets: litres a minute of the open path over the command, from 6 to 5 bar gauge at 20 degrees
//! Celsius (ANR, ISO 8778), and the conductances of the fully open paths (ISO 6358-1).
//!
//! ```text
//! Q = mdot / rho_0,   C = mdot / (rho_0 P_u) of a choked flow at 20 degrees Celsius
//! ```

use super::bench::ValveBench;
use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_sim::Rig;
use pneudrive_sim::component::valve::iso6358::{REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "nominal flow over the command, and the conductances of the paths (ISO 6358)";

/// Pressures in front of the valve and behind it, Pa: 6 and 5 bar above 100 kPa.
const NOMINAL_PA: [f64; 2] = [7e5, 6e5];

/// Of the pressure upstream: far below any critical ratio.
const CHOKED: f64 = 0.05;

/// Litres a minute in a kg/s.
const LITRES_A_MINUTE: f64 = 6e4 / REFERENCE_DENSITY;

/// Litres in a m^3, and Pa in a bar: dm^3/(s bar) in a m^3/(s Pa).
const DM3_PER_S_BAR: f64 = 1e8;

/// A valve between two pressures at 20 degrees Celsius.
struct Paths {
    bench: ValveBench,
    null: f64,
    travel: f64,
    supply_pa: f64,
}

impl Paths {
    /// The paths of a rig's valve: `up` in front of it, `down` behind its ports, Pa.
    fn of(rig: &Rig, up: f64) -> Paths {
        let warm = [&keys::supply::TEMPERATURE_K, &keys::exhaust::TEMPERATURE_K];
        let rig = rig.with_numbers(&warm.map(|key| (key.path, REFERENCE_TEMPERATURE)));
        let rig = rig.unwrap_or_else(|problems| panic!("a rig at 20 degrees Celsius: {problems}"));
        let bench = ValveBench::new(&rig, up);
        let (null, travel) = (bench.valve.null_offset, bench.valve.travel);
        Paths { bench, null, travel, supply_pa: up }
    }

    /// From the supply to ports 1 and 2 with the spool at a part of its travel, kg/s.
    fn supply_flows(&mut self, part: f64, down: f64) -> [f64; 2] {
        let spool = self.null + part * self.travel;
        self.bench.nodes(spool, [down; 2]).map(|node| node.supply_flow)
    }

    /// From ports 1 and 2 to the exhaust, out of a pressure that chokes it, kg/s.
    fn exhaust_flows(&mut self, part: f64) -> [f64; 2] {
        let spool = self.null + part * self.travel;
        self.bench.nodes(spool, [self.supply_pa; 2]).map(|node| -node.exhaust_flow)
    }
}

/// Flow from the supply to the port that the spool opens, l/min (ANR), at a command in percent.
#[must_use]
pub fn nominal_flow(rig: &Rig, percent: f64) -> f64 {
    let [up, down] = NOMINAL_PA;
    let [one, two] = Paths::of(rig, up).supply_flows(1e-2 * percent, down);
    LITRES_A_MINUTE * one.max(two)
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let [up, down] = NOMINAL_PA;
    let mut paths = Paths::of(rig, up);
    let commands = evenly(-100.0, 100.0, 200);
    let mut flow =
        |command: f64, port: usize| LITRES_A_MINUTE * paths.supply_flows(1e-2 * command, down)[port];
    let open = over("the open path", &commands, |command| flow(command, 0).max(flow(command, 1)));
    let shut = over("the shut path", &commands, |command| flow(command, 0).min(flow(command, 1)));
    Ok(Characteristic {
        notes: vec![
            "From 6 to 5 bar gauge at 20 \u{b0}C, in litres a minute at the reference atmosphere (ANR, ISO 8778). 100 % of the command is the whole travel of the spool, from its null; operator and hysteresis are left out. Conductances are those of choked flow with the valve fully open.".to_owned(),
        ],
        across: "command, %",
        graphs: vec![Graph { title: "flow, l/min", series: vec![open, shut] }],
        figures: figures(&mut paths),
        ..Characteristic::default()
    })
}

/// Nominal flow and conductance of each path, fully open.
fn figures(paths: &mut Paths) -> Vec<Figure> {
    let [up, down] = NOMINAL_PA;
    let mut figures = Vec::new();
    for (port, part) in [(0, 1.0), (1, -1.0)] {
        let named = |what: &str| format!("{what} port {}", port + 1);
        let flow = LITRES_A_MINUTE * paths.supply_flows(part, down)[port];
        let conductance = |flow: f64| DM3_PER_S_BAR * flow / (REFERENCE_DENSITY * up);
        let supply = conductance(paths.supply_flows(part, CHOKED * up)[port]);
        let exhaust = conductance(paths.exhaust_flows(-part)[port]);
        figures.extend([
            Figure::computed(named("nominal flow Qn from the supply to"), flow, "l/min (ANR)"),
            Figure::computed(named("conductance C from the supply to"), supply, "dm3/(s bar)"),
            Figure::computed(named("conductance C to the exhaust from"), exhaust, "dm3/(s bar)"),
        ]);
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::super::servo_b;
    use super::*;

    fn valve(more: &[&str]) -> Rig {
        let of_data_sheet = [
            "valve.model=iso-6358",
            "valve.characteristic=linear",
            "valve.sonic_conductance_m3_per_s_pa=1.375e-8",
            "valve.critical_ratio=0.3",
        ];
        servo_b(&[&of_data_sheet, more].concat())
    }

    fn figure(found: &Characteristic, name: &str) -> f64 {
        let figure = found.figures.iter().find(|figure| figure.name == name);
        figure.and_then(Figure::value).unwrap_or_else(|| panic!("no {name}"))
    }

    /// By hand: r = 6/7, (r - 0.3)/0.7 = 0.7959, Q = 1.375 dm3/(s bar) 7 bar sqrt(1 - 0.7959^2) = 5.827 dm3/s.
    #[test]
    fn the_nominal_flow_of_a_data_sheet_comes_out_over_the_command() {
        let rig = valve(&["valve.leakage_percent=1"]);
        let whole = 349.6;
        for (command, share) in [(100.0, 1.0), (-100.0, 1.0), (50.0, 0.505), (-20.0, 0.208), (0.0, 0.01)] {
            let flow = nominal_flow(&rig, command);
            assert!((flow / (share * whole) - 1.0).abs() < 1e-3, "{command} %: {flow} l/min");
        }
    }

    #[test]
    fn each_path_has_the_conductance_of_the_data_sheet() {
        let rig = valve(&[
            "valve.exhaust_sonic_conductance_m3_per_s_pa=1.7e-8",
            "valve.exhaust_critical_ratio=0.2",
        ]);
        let found = measure(&rig).expect("a valve");
        for port in [1, 2] {
            let supply = figure(&found, &format!("conductance C from the supply to port {port}"));
            let exhaust = figure(&found, &format!("conductance C to the exhaust from port {port}"));
            assert!((supply - 1.375).abs() < 1e-6 && (exhaust - 1.7).abs() < 1e-6, "{supply} {exhaust}");
        }
    }

    #[test]
    fn a_table_of_the_data_sheet_is_reproduced_at_its_points_and_between_them() {
        let table =
            [[0.0, 0.2], [5.0, 0.4], [10.0, 4.0], [25.0, 20.0], [50.0, 55.0], [75.0, 90.0], [100.0, 100.0]];
        let written = format!("valve.characteristic_table={table:?}");
        let rig = valve(&["valve.characteristic=table", &written]);
        for [command, share] in table {
            for side in [command, -command] {
                let flow = nominal_flow(&rig, side);
                assert!((flow / (1e-2 * share * 349.6) - 1.0).abs() < 1e-3, "{side} %: {flow} l/min");
            }
        }
        let between = nominal_flow(&rig, 37.0);
        assert!((0.2 * 349.6..0.55 * 349.6).contains(&between), "{between}");
    }

    #[test]
    fn a_valve_by_its_dimensions_has_conductances_too() {
        let found = measure(&servo_b(&["valve.upstream_mach=false"])).expect("a valve");
        let conductance = figure(&found, "conductance C from the supply to port 1");
        // A choked port of 3.3 mm passes 0.8 11.880 g/s at 589 kPa and 294 K (EQUATIONS section 1): 1.36 dm3/(s bar). The land
        // in front of it is three times as wide, and what the clearance lets to the exhaust comes on top.
        assert!((1.25..1.42).contains(&conductance), "{conductance}");
    }
}
