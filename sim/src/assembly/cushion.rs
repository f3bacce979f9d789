//! A spear that is in: chamber and pocket as two vessels.
//!
//! The states of the pocket are in places that the drive does not need otherwise: more than 16 states would cost all drives 4 %, as the
//! compiler then copies them by a call.

use super::{Assembly, StateVector, slot};
use crate::component::actuator::cushion::{Cushion, Passing, has_cushions, keys};
use crate::component::air::{ChamberAir, GasState, Volume};
use crate::component::friction::{Friction, FrictionModel};
use crate::component::gas::Gas;
use crate::component::supply::SupplyKind;
use crate::keys::{sensors, supply, tubing};
use crate::number::{Number, Pair};
use crate::values::{Findings, Rig};

/// Cushions, and the places of mass and Exner pressure of the pocket.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cushions {
    pub cushion: Cushion,
    pub places: [usize; 2],
}

impl Cushions {
    /// The cushions of a rig, for the areas (m^2) and residual volumes (m^3) of its chambers.
    pub fn of(rig: &Rig, areas: [f64; 2], residual: [f64; 2]) -> Option<Cushions> {
        let cushion = Cushion::of(rig, areas, residual)?;
        Some(Cushions { cushion, places: free_places(rig)? })
    }
}

/// Places of two states that a rig's drive does not have.
fn free_places(rig: &Rig) -> Option<[usize; 2]> {
    let tubes_lag = rig.get(&tubing::LAG_S) > 0.0;
    let draws = rig.get(&supply::MODEL) != SupplyKind::Ideal;
    if !tubes_lag && !draws {
        Some([slot::RATIO[0], slot::RATIO[1]])
    } else if rig.get(&sensors::PRESSURE_LAG_S) == 0.0 {
        Some(slot::SENSED)
    } else if Friction::of(rig).scale().is_empty() {
        Some([slot::FRICTION[0], slot::FRICTION[1]])
    } else {
        None
    }
}

/// The constraints between cushions and what has states of its own.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    if has_cushions(rig) && free_places(rig).is_none() {
        let message = "\"adjustable\": the states of its air have no place beside a receiver or lagged tubes, lagged pressure sensors and bristles at once; leave out one of supply.model (a receiver or a regulator) or tubing.lag_s, sensors.pressure_lag_s, and a load.friction with bristles";
        findings.note(&keys::CUSHION, message);
    }
}

impl Cushions {
    /// The air in the pocket of a spear that is in.
    fn air(&self, end: usize, gas: &Gas, x: &StateVector) -> ChamberAir {
        let [mass, exner] = self.places.map(|place| x[place]);
        ChamberAir::of_state(gas, mass, exner, self.pocket(end, x).volume)
    }

    fn pocket(&self, end: usize, x: &StateVector) -> Volume {
        self.cushion.pocket(end, x[slot::POSITION], x[slot::VELOCITY])
    }

    /// The air of a chamber of this volume (m^3) is divided by a spear that goes in.
    pub fn divide(&self, end: usize, volume: f64, x: &mut StateVector) {
        let mass = self.pocket(end, x).volume / volume * x[slot::MASS[end]];
        x[slot::MASS[end]] -= mass;
        [x[self.places[0]], x[self.places[1]]] = [mass, x[slot::EXNER[end]]];
    }

    /// The air of chamber and pocket, of this volume together, becomes one as the spear comes out.
    fn join(&self, end: usize, gas: &Gas, volume: f64, x: &mut StateVector) {
        let part = self.pocket(end, x).volume / volume;
        let [own, pocket] = [slot::EXNER[end], self.places[1]].map(|place| gas.pressure(x[place]));
        x[slot::MASS[end]] += x[self.places[0]];
        x[slot::EXNER[end]] = gas.exner(own + part * (pocket - own));
        [x[self.places[0]], x[self.places[1]]] = [0.0; 2];
    }
}

// Where no spear is in, this costs next to nothing: what is taken by its address is a copy, so that it stays in registers otherwise,
// and the right-hand side asks once.
impl Assembly {
    /// The cushions, and the end whose spear is in.
    #[inline(always)]
    fn spear_in(&self) -> Option<(usize, &Cushions)> {
        self.spear.zip(self.parts.cushions.as_ref())
    }

    /// Whether a spear is in.
    pub(super) fn is_cushioned(&self) -> bool {
        self.spear.is_some()
    }

    /// The volumes of the chambers.
    #[inline(always)]
    pub(super) fn volumes(&self, x: &StateVector) -> Volume<Pair> {
        self.volumes_with(self.spear, x)
    }

    /// The same, behind a spear that is in.
    #[inline(always)]
    pub(super) fn volumes_with(&self, spear: Option<usize>, x: &StateVector) -> Volume<Pair> {
        let both = self.parts.actuator.both_volumes(x[slot::POSITION], x[slot::VELOCITY]);
        if spear.is_none() { both } else { self.volumes_behind_spear(both, x) }
    }

    #[cold]
    #[inline(never)]
    fn volumes_behind_spear(&self, both: Volume<Pair>, x: &StateVector) -> Volume<Pair> {
        let Some((end, cushions)) = self.spear_in() else { return both };
        cushions.cushion.behind_spear(end, both, cushions.pocket(end, x))
    }

    /// The air at the ports of the chambers in a state.
    pub(super) fn at_ports(&self, x: &StateVector) -> GasState<Pair> {
        self.air_at_ports(self.spear, x, &self.air(x))
    }

    /// The air at the ports of the chambers: that of the pocket where a spear is in.
    #[inline(always)]
    pub(super) fn air_at_ports(
        &self,
        spear: Option<usize>,
        x: &StateVector,
        air: &ChamberAir<Pair>,
    ) -> GasState<Pair> {
        if spear.is_none() { air.station() } else { self.air_before_spear(x, &{ *air }) }
    }

    #[cold]
    #[inline(never)]
    fn air_before_spear(&self, x: &StateVector, air: &ChamberAir<Pair>) -> GasState<Pair> {
        let mut places = [0, 1].map(|i| air.lane(i).station());
        if let Some((end, cushions)) = self.spear_in() {
            places[end] = cushions.air(end, &self.parts.gas, x).station();
        }
        GasState::both(&places)
    }

    /// The pressures that act on the piston, Pa: on the part of the spear that of the pocket.
    #[inline(always)]
    pub(super) fn acting(&self, spear: Option<usize>, x: &StateVector, pressures: [f64; 2]) -> [f64; 2] {
        if spear.is_none() { pressures } else { self.acting_on_spear(x, pressures) }
    }

    #[cold]
    #[inline(never)]
    fn acting_on_spear(&self, x: &StateVector, mut pressures: [f64; 2]) -> [f64; 2] {
        if let Some((end, cushions)) = self.spear_in() {
            let before = self.parts.gas.pressure(x[cushions.places[1]]);
            pressures[end] += cushions.cushion.part_of_spear(end) * (before - pressures[end]);
        }
        pressures
    }

    /// The pressures at the sensors, Pa: at the ports.
    #[inline(always)]
    pub(super) fn at_sensors(&self, x: &StateVector, pressures: [f64; 2]) -> [f64; 2] {
        if self.spear.is_none() { pressures } else { self.before_spear(x, pressures) }
    }

    #[cold]
    #[inline(never)]
    fn before_spear(&self, x: &StateVector, mut pressures: [f64; 2]) -> [f64; 2] {
        if let Some((end, cushions)) = self.spear_in() {
            pressures[end] = self.parts.gas.pressure(x[cushions.places[1]]);
        }
        pressures
    }

    /// The rates of the pressures that act on the piston, Pa/s.
    pub(super) fn acting_rates(&self, x: &StateVector, slope: &StateVector) -> [f64; 2] {
        let rate = |place: usize| self.parts.gas.pressure_rate(x[place], slope[place]);
        let mut rates = slot::EXNER.map(rate);
        if let Some((end, cushions)) = self.spear_in() {
            rates[end] += cushions.cushion.part_of_spear(end) * (rate(cushions.places[1]) - rates[end]);
        }
        rates
    }

    /// The flows into the chambers from their ports, and what they carry: past the spear where one is in.
    #[inline(always)]
    pub(super) fn entering_chambers(
        &self,
        spear: Option<usize>,
        x: &StateVector,
        air: &ChamberAir<Pair>,
        ports: (Pair, Pair),
    ) -> (Pair, Pair) {
        if spear.is_none() { ports } else { self.past_spear(x, &{ *air }, ports) }
    }

    #[cold]
    #[inline(never)]
    fn past_spear(&self, x: &StateVector, air: &ChamberAir<Pair>, ports: (Pair, Pair)) -> (Pair, Pair) {
        let Some((end, cushions)) = self.spear_in() else { return ports };
        let pocket = cushions.air(end, &self.parts.gas, x);
        let Passing { flow, temperature } = cushions.cushion.passing(end, &air.lane(end), &pocket);
        let with = |pair: Pair, value: f64| Pair::of(|i| if i == end { value } else { pair.lane(i) });
        (with(ports.0, flow), with(ports.1, temperature))
    }

    /// The rates of the pocket between the flows of its port and those past the spear.
    #[cold]
    #[inline(never)]
    pub(super) fn fill_pocket(
        &self,
        x: &StateVector,
        ports: (Pair, Pair),
        chambers: (Pair, Pair),
        slope: &mut StateVector,
    ) {
        let Some((end, cushions)) = self.spear_in() else { return };
        let (gas, volume) = (&self.parts.gas, cushions.pocket(end, x));
        let from_port = (ports.0.lane(end), ports.1.lane(end));
        let past_spear = (-chambers.0.lane(end), chambers.1.lane(end));
        let air = cushions.air(end, gas, x);
        let rates = air.derivative(gas, volume, [from_port, past_spear, (0.0, air.temperature)]);
        for (place, rate) in cushions.places.into_iter().zip(rates) {
            slope[place] = rate;
        }
    }

    /// The chamber whose spear is in, and the place of the mass of its pocket.
    pub fn pocket_mass(&self) -> Option<(usize, usize)> {
        self.spear_in().map(|(end, cushions)| (end, cushions.places[0]))
    }

    /// Not negative as long as the load stays on its side of the stops, and the spears where they are.
    #[inline(always)]
    pub(super) fn travel_guard(&self, position: f64) -> f64 {
        let stops = self.parts.load.stops.guard(self.load_side, position);
        match &self.parts.cushions {
            None => stops,
            Some(cushions) => stops.min(cushions.cushion.guard(self.spear, position)),
        }
    }

    /// Whether a spear has gone in or come out, rather than a stop been met or left.
    pub(super) fn meets_spear(&self, position: f64) -> bool {
        self.parts.cushions.as_ref().is_some_and(|cushions| {
            let stops = self.parts.load.stops.guard(self.load_side, position);
            cushions.cushion.guard(self.spear, position) < stops
        })
    }

    /// A spear goes in or comes out at `t`.
    pub(super) fn move_spear(&mut self, t: f64, x: &mut StateVector) {
        let Some(cushions) = self.parts.cushions else { return };
        let after = cushions.cushion.after(self.spear, x[slot::POSITION]);
        let both = self.parts.actuator.both_volumes(x[slot::POSITION], x[slot::VELOCITY]);
        match (self.spear, after) {
            (_, Some(end)) => cushions.divide(end, both.volume.lane(end), x),
            (Some(end), None) => cushions.join(end, &self.parts.gas, both.volume.lane(end), x),
            (None, None) => {}
        }
        self.spear = after;
        self.parts.network.jump();
        self.solved = None;
        self.find_port_directions(t, x);
    }
}
