//! How long the air needs until a load breaks away: the time that the stall detector has to leave it.
//!
//! ```text
//! F    = P_1 A_1 - P_2 A_2 - P_e (A_1 - A_2)      from W - F_s to W + F_s, extending, and back, retracting
//! P_1' =  n R T mdot(P_s, P_1)/V_1                 the valve fully open; W: all that stands against extension
//! P_2' = -n R T mdot(P_2, P_e)/V_2                 n R T of the supply
//! no-motion time = 0.25 s + 2 t, from 0.5 to 10 s  t: the longest over both directions, three places and all levels of pressure
//! ```
//!
//! The load rests under the least force that its friction allows, and has to go under the largest. For a chamber alone, a
//! choked flow fills it at a constant rate, so that t is (P - P_0) V/(n R T C rho_0 P_s); a test holds that. Twice that
//! leaves room for friction that is more, and a valve that is less, than the file says.

use pneudrive_sim::component::actuator::Actuator;
use pneudrive_sim::component::actuator::cushion::has_cushions;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::load::Load;
use pneudrive_sim::component::supply::SupplyKind;
use pneudrive_sim::component::tubing::has_flow_controls;
use pneudrive_sim::component::valve::flow_law::FlowLaw;
use pneudrive_sim::component::valve::iso6358::Iso6358;
use pneudrive_sim::{Rig, keys};

/// Besides the pressure: the lag of the valve, and the first half of a millimetre, s.
const BESIDES_S: f64 = 0.25;
/// Room for what is not known.
const ROOM: f64 = 2.0;
/// The shortest and the longest no-motion time, s.
const BOUNDS_S: [f64; 2] = [0.5, 10.0];
/// Steps of the integration, s, and until when it goes, s.
const STEP_S: f64 = 5e-4;
const UNTIL_S: f64 = 5.0;
/// Levels of pressure that are tried.
const LEVELS: u32 = 8;
/// The law "cascade" demands at most this part of the supply's force on the smaller area.
const OF_CASCADE: f64 = 0.8;

/// What breaks a load away: forces in N and a time in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakaway {
    /// The force in the direction that needs the larger share of the available force.
    pub needed: f64,
    /// The force that the supply can give in this direction.
    pub held: f64,
    /// The largest force that the law "cascade" demands.
    pub asked: f64,
    /// The time until the load breaks away; None: it takes longer than the integration runs, or the load never breaks away.
    pub time: Option<f64>,
}

/// A drive whose valve is known by its conductance.
struct Drive {
    actuator: Actuator,
    load: Load,
    gas: Gas,
    paths: [Iso6358; 2],
    /// P_s, P_e, Pa; T, K.
    supply: f64,
    exhaust: f64,
    temperature: f64,
    /// F_s, extending and retracting.
    friction: [f64; 2],
}

impl Drive {
    fn of(rig: &Rig) -> Option<Drive> {
        let paths = rig.get(&keys::valve::MODEL).laws(rig).map(|law| match law {
            FlowLaw::Iso6358(path) => Some(path),
            _ => None,
        });
        let [Some(filling), Some(venting)] = paths else { return None };
        // Their throttles are not in the conductance of the valve, and a receiver or a regulator does not hold the pressure.
        if has_flow_controls(rig) || has_cushions(rig) || rig.get(&keys::supply::MODEL) != SupplyKind::Ideal {
            return None;
        }
        Some(Drive {
            actuator: Actuator::of(rig),
            load: Load::of(rig),
            gas: Gas::of(rig),
            paths: [filling, venting],
            supply: rig.get(&keys::supply::PRESSURE_PA),
            exhaust: rig.get(&keys::exhaust::PRESSURE_PA),
            temperature: rig.get(&keys::supply::TEMPERATURE_K),
            friction: [&keys::friction::STATIC_EXTEND_N, &keys::friction::STATIC_RETRACT_N]
                .map(|key| rig.get(key)),
        })
    }

    /// Area of the chamber that is filled, and of that which is vented.
    fn areas(&self, extends: bool) -> [f64; 2] {
        let areas = [self.actuator.area_1, self.actuator.area_2];
        if extends { areas } else { [areas[1], areas[0]] }
    }

    /// W and F_s in a direction: the least force of a load at rest, and the one that moves it.
    fn forces(&self, extends: bool, place: f64) -> [f64; 2] {
        let against = -self.load.standing_force(place);
        let [out, back] = self.friction;
        if extends { [against - back, against + out] } else { [-against - out, -against + back] }
    }

    /// The force of the air towards the chamber that is vented, N.
    fn force(&self, extends: bool, [filled, vented]: [f64; 2]) -> f64 {
        let [to, from] = self.areas(extends);
        filled * to - vented * from - self.exhaust * (to - from)
    }

    /// The largest force in a direction.
    fn held(&self, extends: bool) -> f64 {
        if self.open(extends)[0] { 0.0 } else { (self.supply - self.exhaust) * self.areas(extends)[0] }
    }

    /// Whether the chamber that is filled is open to the surroundings, and that which is vented: in a single-acting cylinder
    /// one of them.
    fn open(&self, extends: bool) -> [bool; 2] {
        let open = [0, 1].map(|i| self.actuator.is_vented(i));
        if extends { open } else { [open[1], open[0]] }
    }

    /// t from a pressure in the vented chamber; None: not within [`UNTIL_S`].
    fn time(&self, extends: bool, place: f64, vented: f64) -> Option<f64> {
        let [least, needed] = self.forces(extends, place);
        let [to, from] = self.areas(extends);
        let open = self.open(extends);
        let vented = if open[1] { self.exhaust } else { vented };
        let filled = (least + vented * from + self.exhaust * (to - from)) / to;
        let filled = if open[0] { self.exhaust } else { filled };
        let mut pressures =
            [filled.clamp(self.exhaust, self.supply), vented.clamp(self.exhaust, self.supply)];
        let volumes = self.actuator.volumes(place, 0.0).map(|volume| volume.volume);
        let volumes = if extends { volumes } else { [volumes[1], volumes[0]] };
        let rate = self.gas.heat_capacity_ratio * self.gas.gas_constant * self.temperature;
        let flow = |path: &Iso6358, up: f64, down: f64| path.flow(&self.gas, up, self.temperature, down);
        for step in 0..(UNTIL_S / STEP_S) as u32 {
            if self.force(extends, pressures) >= needed {
                return Some(f64::from(step) * STEP_S);
            }
            let [filled, vented] = pressures;
            let into = if open[0] { 0.0 } else { flow(&self.paths[0], self.supply, filled.min(self.supply)) };
            let out = flow(&self.paths[1], vented, self.exhaust.min(vented));
            pressures = [
                (filled + STEP_S * rate * into / volumes[0]).min(self.supply),
                (vented - STEP_S * rate * out / volumes[1]).max(self.exhaust),
            ];
        }
        None
    }

    /// The longest time over places and levels.
    fn longest(&self, extends: bool) -> Option<f64> {
        let level =
            |n: u32| self.exhaust + (self.supply - self.exhaust) * f64::from(n) / f64::from(LEVELS - 1);
        let starts = [0.0, 0.5, 1.0].into_iter().flat_map(|part| (0..LEVELS).map(move |n| (part, n)));
        starts
            .map(|(part, n)| self.time(extends, part * self.actuator.stroke, level(n)))
            .try_fold(0.0_f64, |longest, time| Some(longest.max(time?)))
    }
}

impl Breakaway {
    /// The breakaway of a rig's load; None where the rig does not give the flow of its valve as a conductance.
    #[must_use]
    pub fn of(rig: &Rig) -> Option<Breakaway> {
        let drive = Drive::of(rig)?;
        let both = [true, false].map(|extends| {
            let needed = drive.forces(extends, 0.0)[1].max(drive.forces(extends, drive.actuator.stroke)[1]);
            (extends, needed, drive.held(extends))
        });
        let share = |(_, needed, held): &(bool, f64, f64)| needed / held;
        let (_, needed, held) = if share(&both[0]) >= share(&both[1]) { both[0] } else { both[1] };
        let asked = OF_CASCADE * drive.held(true).min(drive.held(false));
        let time = both.map(|(extends, ..)| drive.longest(extends));
        let time = time[0].zip(time[1]).map(|(out, back)| out.max(back));
        Some(Breakaway { needed, held, asked, time })
    }

    /// The time of a standing load before the stall detector trips, s.
    #[must_use]
    pub fn no_motion_s(&self) -> f64 {
        let [shortest, longest] = BOUNDS_S;
        self.time.map_or(longest, |time| (BESIDES_S + ROOM * time).clamp(shortest, longest))
    }

    /// Whether the supply can move the load at all.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        self.needed < self.held
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::own_drive::rig_file;
    use crate::question::Answers;

    fn rig(given: &[(&str, &str)]) -> Rig {
        let text = rig_file("own", &Answers::of(given)).unwrap_or_else(|wrong| panic!("{wrong:?}"));
        Rig::read("own.toml", &text).unwrap_or_else(|problems| panic!("{problems}"))
    }

    const LARGE: &[(&str, &str)] = &[
        ("bore", "200 mm"),
        ("rod", "0 mm"),
        ("stroke", "1 m"),
        ("mass", "40 kg"),
        ("valve", "proportional-5-3-100"),
    ];

    /// A chamber alone, choked: its pressure rises in proportion to the time.
    #[test]
    fn a_choked_flow_fills_a_chamber_in_the_time_of_the_closed_form() {
        let rig = rig(LARGE);
        let mut drive = Drive::of(&rig).expect("a conductance");
        // Nothing is vented; friction asks for 0.4 bar.
        drive.paths[1].sonic_conductance = 1e-15;
        let area = drive.actuator.area_1;
        drive.friction = [0.2e5 * area; 2];
        let time = drive.time(true, 0.5, 2e5).expect("soon");
        let Drive { gas, supply, temperature, .. } = &drive;
        let flow = drive.paths[0].flow(gas, *supply, *temperature, drive.exhaust);
        let volume = drive.actuator.volumes(0.5, 0.0)[0].volume;
        let rate = gas.heat_capacity_ratio * gas.gas_constant * temperature * flow / volume;
        let expected = 0.4e5 / rate;
        assert!((time - expected).abs() <= 2.0 * STEP_S, "{time} s, and {expected} s by the closed form");
    }

    /// A spring alone retracts it: the supply has nothing to add.
    #[test]
    fn a_single_acting_cylinder_needs_a_spring_that_outweighs_its_friction() {
        let of = |settings: &[&str]| {
            let rig = rig(&[
                ("bore", "32 mm"),
                ("rod", "12 mm"),
                ("stroke", "100 mm"),
                ("mass", "2 kg"),
                ("valve", "proportional-5-3-350"),
            ]);
            let others =
                ["actuator.vented=chamber-2", "controller.law=gain-profile", "load.static_retract_n=60"];
            let rig = rig.with_settings(&[&others[..], settings].concat());
            Breakaway::of(&rig.unwrap_or_else(|problems| panic!("{problems}"))).expect("known")
        };
        let alone = of(&[]);
        assert!(!alone.is_possible() && alone.held == 0.0 && alone.time.is_none(), "{alone:?}");
        let spring = |preload: &str| of(&["actuator.return_spring=retract", preload]);
        assert!(!spring("actuator.return_spring_preload_n=50").is_possible());
        let strong = spring("actuator.return_spring_preload_n=90");
        assert!(strong.is_possible() && strong.time.is_some_and(|time| time < 0.5), "{strong:?}");
    }

    #[test]
    fn a_small_drive_keeps_the_default_and_a_large_one_on_a_small_valve_gets_the_time_that_it_needs() {
        let small = [
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "8 kg"),
            ("valve", "proportional-5-3-350"),
        ];
        let small = rig(&small);
        assert_eq!(Breakaway::of(&small).expect("known").no_motion_s(), 0.5);
        assert!(!small.is_set(&keys::safety::NO_MOTION_S), "it is the default");
        let large = rig(LARGE);
        let found = Breakaway::of(&large).expect("known");
        let written = large.get(&keys::safety::NO_MOTION_S);
        assert!(
            (written / found.no_motion_s() - 1.0).abs() < 1e-4 && written > 1.0,
            "{written} s, {found:?}"
        );
        let origin = large.origin(&keys::safety::NO_MOTION_S);
        assert!(origin.from.contains("break"), "{origin:?}");
    }

    #[test]
    fn a_load_that_the_supply_cannot_move_is_found() {
        let heavy = [
            ("cylinder", "iso-15552-32"),
            ("stroke", "250 mm"),
            ("mass", "44 kg"),
            ("incline", "90 deg"),
            ("breakaway", "100 N"),
            ("valve", "proportional-5-3-350"),
        ];
        let found = Breakaway::of(&rig(&heavy)).expect("known");
        assert!(!found.is_possible() && found.time.is_none(), "{found:?}");
        assert_eq!(found.no_motion_s(), 10.0);
    }

    #[test]
    fn a_valve_without_a_conductance_says_nothing() {
        let thesis =
            Rig::read("a", pneudrive_sim::rigfile::builtin("servo-a").expect("built in")).expect("valid");
        assert_eq!(Breakaway::of(&thesis), None);
    }
}
