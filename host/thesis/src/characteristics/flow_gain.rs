//! Flow gain (7.1.1.1, Fig. 7.4): the flow out of port 1 over the spool.
//!
//! The family over supply pressure has a back pressure half-way between supply and exhaust at the port. So one side
//! of the spool shows the flow out, the other the flow back. Fig. 7.4 is the other family: one pressure at the supply
//! port, several at port 1.

use super::bench::ValveBench;
use super::points::{evenly, over, supplies};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "flow of a port over the spool, by supply pressure (7.1.1.1, Fig. 7.4)";

/// Pressure at the supply port in Fig. 7.4, Pa.
pub(crate) const FIG_7_4_SUPPLY_PA: f64 = 317e3;

/// The gain is taken this far to either side of the null, as a part of the travel; nearer, the clearance bends the
/// curve.
const ABOUT_NULL: f64 = 0.05;

/// Pressures at port 1 for the second family, Pa.
const FIG_7_4_PORT_PA: [f64; 4] = [110e3, 170e3, 230e3, 290e3];

/// Flow out of port 1 or 2, kg/s, with the spool at a place (m) and the pressures of supply port and port (Pa).
#[must_use]
pub fn port_flow(rig: &Rig, port: usize, spool: f64, supply_pa: f64, port_pa: f64) -> f64 {
    ValveBench::new(rig, supply_pa).nodes(spool, [port_pa; 2])[port].port_flow()
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let supplies = supplies(rig);
    let halfway = |supply: f64| (rig.get(&keys::exhaust::PRESSURE_PA) + supply) / 2.0;
    let by_supply = supplies
        .iter()
        .map(|&supply| curve(rig, &format!("Ps = {:.1} kPa", supply / 1e3), supply, halfway(supply)));
    let by_port = FIG_7_4_PORT_PA.iter().map(|&port| {
        curve(
            rig,
            &format!("P1 = {:.0} kPa, Ps = {:.0} kPa", port / 1e3, FIG_7_4_SUPPLY_PA / 1e3),
            FIG_7_4_SUPPLY_PA,
            port,
        )
    });
    Ok(Characteristic {
        figures: supplies.iter().flat_map(|&supply| figures(rig, supply, halfway(supply))).collect(),
        notes: vec![
            "Pressures are absolute and hold right at the valve's ports. Above: the rig's own supply pressure first, then those of the thesis; the back pressure at port 1 is half-way between supply and exhaust. Below: Fig. 7.4, one supply pressure and several back pressures.".to_owned(),
        ],
        across: "spool, mm",
        graphs: vec![
            Graph { title: "flow of port 1, g/s", series: by_supply.collect() },
            Graph { title: "flow of port 1, g/s (Fig. 7.4)", series: by_port.collect() },
        ],
        ..Characteristic::default()
    })
}

/// How steep the flow is about the null, and how large with the valve wide open.
fn figures(rig: &Rig, supply_pa: f64, port_pa: f64) -> [Figure; 2] {
    let [travel, null] =
        [&keys::valve::SPOOL_TRAVEL_MM, &keys::valve::NULL_OFFSET_MM].map(|key| rig.get(key));
    let mut bench = ValveBench::new(rig, supply_pa);
    let mut flow = |spool_mm: f64| 1e3 * bench.nodes(spool_mm * 1e-3, [port_pa; 2])[0].port_flow();
    let beside = ABOUT_NULL * travel;
    let gain = (flow(null + beside) - flow(null - beside)) / (2.0 * beside);
    let named = |what: &str| format!("{what}, Ps = {:.1} kPa", supply_pa / 1e3);
    [
        Figure::computed(named("flow gain about the null"), gain, "g/s/mm"),
        Figure::computed(named("flow wide open"), flow(travel), "g/s"),
    ]
}

fn curve(rig: &Rig, name: &str, supply_pa: f64, port_pa: f64) -> Curve {
    let mut bench = ValveBench::new(rig, supply_pa);
    let travel = rig.get(&keys::valve::SPOOL_TRAVEL_MM);
    over(name, &evenly(-travel, travel, 160), |spool| {
        1e3 * bench.nodes(spool * 1e-3, [port_pa; 2])[0].port_flow()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    #[test]
    fn a_symmetric_valve_gives_port_2_what_it_gives_port_1_on_the_other_side() {
        for spool in [0.02e-3, 0.2e-3, 0.9e-3] {
            let one = port_flow(&rig(&[]), 0, spool, 317e3, 200e3);
            let two = port_flow(&rig(&[]), 1, -spool, 317e3, 200e3);
            assert!((one - two).abs() < 1e-11 && one > 0.0, "{spool}: {one} {two}");
        }
    }

    #[test]
    fn at_null_the_flows_of_both_lands_are_equal() {
        let rig = rig(&["valve.null_offset_mm=0.03"]);
        let mut bench = ValveBench::new(&rig, 589e3);
        let [p1, p2] = bench.blocked(0.03e-3);
        let nodes = bench.nodes(0.03e-3, [p1, p2]);
        assert!((nodes[0].supply_flow - nodes[1].supply_flow).abs() < 1e-10, "7.1.1.2: m_s1 = m_s2");
        for node in nodes {
            assert!(node.port_flow().abs() < 1e-8 && node.supply_flow > 1e-5, "m_s + m_e = 0: {node:?}");
        }
    }

    /// C(39): through 3.3 mm goes no more than C_d times 11.880 g/s per 589 kPa (EQUATIONS section 1).
    #[test]
    fn the_flow_saturates_below_what_the_port_passes_choked() {
        let rig = rig(&["valve.upstream_mach=false"]);
        let [half, full] = [0.5e-3, 1e-3].map(|spool| port_flow(&rig, 0, spool, 589e3, 101.3e3));
        assert!(full < 0.8 * 11.880e-3, "{full}");
        assert!(full / half < 1.1, "saturation: {half} {full}");
    }

    #[test]
    fn the_figures_are_those_of_the_curves() {
        let found = measure(&rig(&[])).expect("a valve");
        assert_eq!(found.figures.len(), 2 * 6, "its own supply pressure and five of the thesis");
        assert!(found.figures[0].name.ends_with("Ps = 589.0 kPa"), "{}", found.figures[0].name);
        for (figures, series) in found.figures.chunks(2).zip(&found.graphs[0].series) {
            let [gain, most] = [0, 1].map(|i| figures[i].value().expect("a value"));
            assert!((most / series.y[160] - 1.0).abs() < 1e-6, "{most}");
            // The curve has a place every 0.0125 mm, the middle one at the null.
            let slope = (series.y[84] - series.y[76]) / (series.x[84] - series.x[76]);
            assert!(gain > 0.0 && (gain / slope - 1.0).abs() < 1e-6, "{gain} {slope}");
        }
    }

    #[test]
    fn more_supply_pressure_gives_more_flow_at_every_opening() {
        let found = measure(&rig(&[])).expect("a valve");
        let family = &found.graphs[0].series[1..];
        assert_eq!(family.len(), 5);
        for pair in family.windows(2) {
            let (more, less) = (&pair[0].y, &pair[1].y);
            assert!(more.iter().zip(less).skip(85).all(|(more, less)| more > less), "{}", pair[0].name);
        }
    }
}
