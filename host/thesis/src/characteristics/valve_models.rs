//! Single restriction compared with flow node (7.1.1.3, Fig. 7.5): the flow of port 1 over the spool by the
//! conventional model (6.39 to 6.46), and by the flow node (6.47 to 6.51) with and without upstream Mach numbers.

use super::bench::ValveBench;
use super::flow_gain::FIG_7_4_SUPPLY_PA;
use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "single restriction against flow node (7.1.1.3, Fig. 7.5)";

/// Pressure at port 1, Pa.
const PORT_PA: f64 = 110e3;

/// A model of the valve's flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// Only the lands.
    SingleRestriction,
    /// Lands and port, air at rest in front of each.
    FlowNode,
    /// Lands and port, air that approaches at its own speed.
    FlowNodeWithApproach,
}

const MODELS: [(Compared, &str); 3] = [
    (Compared::SingleRestriction, "single restriction"),
    (Compared::FlowNode, "flow node, Mach 0 upstream"),
    (Compared::FlowNodeWithApproach, "flow node, upstream Mach numbers"),
];

/// Flow out of port 1, kg/s, by a model: spool (m), pressures at supply port and port (Pa).
#[must_use]
pub fn flow(rig: &Rig, model: Compared, spool: f64, supply_pa: f64, port_pa: f64) -> f64 {
    let mut bench = ValveBench::with_approach(rig, supply_pa, model == Compared::FlowNodeWithApproach);
    bench.valve.has_node = model != Compared::SingleRestriction;
    bench.nodes(spool, [port_pa; 2])[0].port_flow()
}

/// Pressures at the supply port and port 1 for a curve, Pa.
type Pressures = [f64; 2];

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    if !rig.get(&keys::valve::MODEL).facts().has_areas() {
        return Err(Unfit::NoPart("its valve is known by its flows, not by lands and ports"));
    }
    let own = rig.get(&keys::supply::PRESSURE_PA);
    let halfway = (own + rig.get(&keys::exhaust::PRESSURE_PA)) / 2.0;
    let (of_rig, of_thesis) = ([own, halfway], [FIG_7_4_SUPPLY_PA, PORT_PA]);
    let said = |[supply, port]: Pressures| {
        format!("supply port at {:.0} kPa, port 1 at {:.0} kPa", supply / 1e3, port / 1e3)
    };
    Ok(Characteristic {
        notes: vec![format!(
            "Above: {}, half-way to the exhaust. Below: {}, as in Fig. 7.5. The flow node saturates, as the bore of the port limits what the land lets through.",
            said(of_rig),
            said(of_thesis)
        )],
        across: "spool, mm",
        graphs: vec![
            Graph { title: "flow of port 1, g/s", series: curves(rig, of_rig) },
            Graph { title: "flow of port 1, g/s (Fig. 7.5)", series: curves(rig, of_thesis) },
        ],
        figures: [of_rig, of_thesis]
            .iter()
            .flat_map(|&pressures| at_full_travel(rig, pressures, &said(pressures)))
            .collect(),
        ..Characteristic::default()
    })
}

fn curves(rig: &Rig, [supply, port]: Pressures) -> Vec<Curve> {
    let travel = rig.get(&keys::valve::SPOOL_TRAVEL_MM);
    let curve = |(model, name): (Compared, &str)| {
        over(name, &evenly(0.0, travel, 100), |spool| 1e3 * flow(rig, model, spool * 1e-3, supply, port))
    };
    MODELS.map(curve).into()
}

fn at_full_travel(rig: &Rig, [supply, port]: Pressures, said: &str) -> [Figure; 3] {
    let travel = rig.get(&keys::valve::SPOOL_TRAVEL_MM) * 1e-3;
    MODELS.map(|(model, name)| {
        let flow = 1e3 * flow(rig, model, travel, supply, port);
        Figure::computed(format!("at full travel, {said}, {name}"), flow, "g/s")
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b;
    use super::*;

    /// EQUATIONS section 1, row 6.54: 1 % at 0.05 mm; at 1 mm 21 % at 110 kPa and 50 % at 280 kPa.
    #[test]
    fn upstream_mach_numbers_count_at_wide_openings_and_not_at_narrow_ones() {
        for (spool, port, more) in [(0.05e-3, 110e3, 0.01), (1e-3, 110e3, 0.21), (1e-3, 280e3, 0.50)] {
            let flow = |model| flow(&servo_b(&[]), model, spool, 317e3, port);
            let gain = flow(Compared::FlowNodeWithApproach) / flow(Compared::FlowNode) - 1.0;
            assert!((gain - more).abs() < 0.01, "{spool} {port}: {gain}");
        }
    }

    #[test]
    fn a_valve_by_its_conductances_has_no_port_of_the_thesis() {
        let rig = servo_b(&[
            "valve.model=iso-6358",
            "valve.sonic_conductance_m3_per_s_pa=2e-8",
            "valve.critical_ratio=0.3",
        ]);
        assert!(matches!(measure(&rig), Err(Unfit::NoPart(_))));
    }

    /// Two equal choked orifices behind each other and a land alone: Fig. 7.5's saturation.
    #[test]
    fn the_node_saturates_where_the_single_restriction_goes_on() {
        let at = |model, spool| flow(&servo_b(&[]), model, spool, 317e3, 110e3);
        let gain = |model| at(model, 1e-3) / at(model, 0.5e-3);
        assert!(
            (gain(Compared::SingleRestriction) - 2.0).abs() < 0.02,
            "{}",
            gain(Compared::SingleRestriction)
        );
        assert!(gain(Compared::FlowNode) < 1.1, "{}", gain(Compared::FlowNode));
        let narrow = at(Compared::FlowNode, 0.02e-3) / at(Compared::SingleRestriction, 0.02e-3);
        assert!((0.97..1.0).contains(&narrow), "at small openings the land alone counts: {narrow}");
    }
}
