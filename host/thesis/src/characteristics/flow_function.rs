//! Flow function (V.9, 6.52): the flow of a land over the ratio of downstream to upstream pressure, as a share of the
//! choked flow of an ideal nozzle of its area.
//!
//! ```text
//! m / (A P_u / sqrt(T_u) sqrt(n/R) (2/(n+1))^((n+1)/(2(n-1))))
//! ```
//!
//! A second curve shows the flow function with upstream Mach numbers (V.9 to V.11, Fig. 6.14) as a share of the same
//! flow. P_u and T_u are those of the moving air. The flow equals that of air at rest in the stagnation state
//!
//! ```text
//! T_0 = T_u s,   P_0 = P_u s^(n/(n-1)),   s = 1 + (n-1)/2 M_u^2
//! ```

use super::points::{evenly, over};
use super::{Characteristic, Figure, Graph, Unfit};
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::valve::Valve;
use pneudrive_sim::component::valve::discharge::perry;
use pneudrive_sim::component::valve::flow_law::FlowLaw;
use pneudrive_sim::keys;

pub(super) const ABOUT: &str = "flow of a land over the pressure ratio, and the flow function with upstream Mach numbers (V.9, Fig. 6.14)";

/// The Mach numbers of the curves; the thesis restricts them to subsonic ones (6.54).
const MACH_NUMBERS: [f64; 5] = [0.0, 0.2, 0.4, 0.6, 0.8];

/// Choked flow of an ideal nozzle, kg/s per m^2, from a pressure (Pa) and temperature (K) at rest.
#[must_use]
pub(crate) fn choked_flux(gas: &Gas, pressure_pa: f64, temperature: f64) -> f64 {
    let n = gas.heat_capacity_ratio;
    let shape = libm::pow(2.0 / (n + 1.0), (n + 1.0) / (2.0 * (n - 1.0)));
    pressure_pa * (n / (gas.gas_constant * temperature)).sqrt() * shape
}

/// Flow of the rig's widest open land to the supply at a pressure ratio, kg/s, from the rig's supply at rest.
#[must_use]
pub(crate) fn land_flow(rig: &Rig, ratio: f64) -> f64 {
    let (gas, valve) = (Gas::of(rig), Valve::of(rig));
    let (up, down) = (rig.get(&keys::supply::PRESSURE_PA), ratio * rig.get(&keys::supply::PRESSURE_PA));
    let spool = valve.null_offset + valve.travel;
    let [law, _] = valve.laws_at(spool).unwrap_or(valve.land_laws);
    let psi = law.psi(&gas, gas.exner(up), gas.exner(down));
    (valve.supply_conductance(&gas, spool) * psi / rig.get(&keys::supply::TEMPERATURE_K)).max(0.0).sqrt()
}

/// The flow function with an upstream Mach number (V.9, V.11) at a ratio of static pressures up to 1, as a share of
/// the choked flow from rest.
#[must_use]
pub(crate) fn with_approach(gas: &Gas, mach: f64, ratio: f64) -> f64 {
    let stagnation = 1.0 + (gas.heat_capacity_ratio - 1.0) / 2.0 * mach * mach;
    let of = |upstream, downstream| FlowLaw::Orifice.psi(gas, upstream, downstream);
    (of(stagnation, gas.exner(ratio)) / (stagnation * of(1.0, 0.0))).sqrt()
}

/// The reference flow, kg/s: the choked flow of an ideal nozzle of the land's area, or of the land itself if it has
/// no area.
fn whole(rig: &Rig) -> f64 {
    if !rig.get(&keys::valve::MODEL).facts().has_areas() {
        return land_flow(rig, 0.0);
    }
    let (gas, valve) = (Gas::of(rig), Valve::of(rig));
    let [pressure, temperature] =
        [&keys::supply::PRESSURE_PA, &keys::supply::TEMPERATURE_K].map(|key| rig.get(key));
    valve.edge_area(valve.travel - valve.lap) * choked_flux(&gas, pressure, temperature)
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let (gas, whole) = (Gas::of(rig), whole(rig));
    let ratios = evenly(0.0, 1.0, 200);
    let land = over("a land of this rig", &ratios, |ratio| land_flow(rig, ratio) / whole);
    let ideal = over("ideal nozzle", &ratios, |ratio| {
        let psi = FlowLaw::Orifice.psi(&gas, 1.0, gas.exner(ratio));
        (psi / FlowLaw::Orifice.psi(&gas, 1.0, 0.0)).sqrt()
    });
    let approaching = MACH_NUMBERS.map(|mach| {
        over(&format!("upstream Mach {mach}"), &ratios, |ratio| with_approach(&gas, mach, ratio))
    });
    let with_perry = ratios.iter().zip(&ideal.y).map(|(&ratio, flow)| flow * perry(ratio));
    let with_perry =
        Curve::new("ideal nozzle with Perry's coefficient", ratios.clone(), with_perry.collect());
    let n = gas.heat_capacity_ratio;
    let critical = libm::pow(2.0 / (n + 1.0), n / (n - 1.0));
    Ok(Characteristic {
        notes: vec![
            "As a share of the choked flow of an ideal nozzle with the land's area, its air at rest in front of it; where conductances stand for areas, of that of the land itself.".to_owned(),
            "Below, the flow function of an ideal nozzle that air approaches at a Mach number (Fig. 6.14), over the ratio of static pressures: at equal pressures its speed alone carries it on.".to_owned(),
        ],
        across: "downstream over upstream pressure",
        graphs: vec![
            Graph { title: "flow, share of choked", series: vec![land, ideal, with_perry] },
            Graph { title: "flow function, share of choked from rest", series: approaching.into() },
        ],
        figures: vec![
            Figure::computed("critical pressure ratio of an ideal nozzle".to_owned(), critical, ""),
            Figure::computed("choked flow of the open land".to_owned(), 1e3 * land_flow(rig, 0.0), "g/s"),
        ],
        ..Characteristic::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    /// EQUATIONS section 1: 3.3 mm, 589 kPa, 294 K, C_d = 1.
    #[test]
    fn an_ideal_nozzle_of_3_3_mm_passes_11_88_g_s() {
        let gas = Gas::new(1.4, 286.76);
        let flow = std::f64::consts::PI / 4.0 * 3.3e-3 * 3.3e-3 * choked_flux(&gas, 589e3, 294.0);
        assert!((flow - 11.880e-3).abs() < 1e-6, "{flow}");
    }

    #[test]
    fn a_land_is_choked_up_to_the_critical_ratio_and_passes_its_coefficient_of_discharge() {
        let rig = rig(&[]);
        let valve = Valve::of(&rig);
        let ideal = valve.edge_area(valve.travel) * choked_flux(&Gas::of(&rig), 589e3, 294.0);
        for ratio in [0.0, 0.3, 0.528] {
            assert!((land_flow(&rig, ratio) / ideal - 0.8).abs() < 1e-6, "{ratio}");
        }
        assert!(land_flow(&rig, 0.6) < 0.8 * ideal);
        assert_eq!(land_flow(&rig, 1.0), 0.0);
    }

    /// V.9 and V.11, with n = 1.4.
    #[test]
    fn the_flow_function_with_upstream_mach_numbers_is_that_of_appendix_v() {
        let (gas, n) = (Gas::new(1.4, 286.76), 1.4_f64);
        let shape = |base: f64| (base / (n + 1.0)).powf((n + 1.0) / (2.0 * (n - 1.0)));
        for mach in [0.0_f64, 0.2, 0.57, 0.8, 1.0] {
            let kinetic = mach * mach * (n - 1.0) + 2.0;
            let critical = (kinetic / (n + 1.0)).powf(n / (n - 1.0));
            for ratio in [0.1_f64, 0.5, 0.6, 0.7, 0.9, 0.99, 1.0] {
                let root = (mach * mach + 2.0 / (n - 1.0) * (1.0 - ratio.powf((n - 1.0) / n))).sqrt();
                let gamma = if ratio > critical { ratio.powf(1.0 / n) * root } else { shape(kinetic) };
                let share = with_approach(&gas, mach, ratio);
                assert!((share - gamma / shape(2.0)).abs() < 1e-12, "Mach {mach}, ratio {ratio}: {share}");
            }
        }
    }

    /// ISO 6358: sqrt(1 - ((r - b)/(1 - b))^2) of the choked flow C rho_0 P_u.
    #[test]
    fn a_component_by_its_conductance_follows_the_ellipse_of_iso_6358() {
        let rig = rig(&[
            "valve.model=\"iso-6358\"",
            "valve.sonic_conductance_m3_per_s_pa=2e-8",
            "valve.critical_ratio=0.3",
        ]);
        let choked = land_flow(&rig, 0.1);
        let ellipse = (1.0_f64 - (0.4_f64 / 0.7).powi(2)).sqrt();
        assert!((land_flow(&rig, 0.7) / choked - ellipse).abs() < 1e-9);
    }
}
