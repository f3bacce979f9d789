//! End cushions: near an end of the stroke a spear on the piston closes the bore to the port, and the air behind it leaves through a
//! throttle alone.
//!
//! ```text
//! s = y  (end 1),   s = L - y  (end 2)                    the spear is in where s < l
//! V = (A - A_s) s + q V_R,   V_p = A_s s + (1 - q) V_R    chamber and pocket; their sum is 6.21 or 6.22
//! P > P_p:  mdot = C rho_0 P   sqrt(T_0/T)   phi(P_p/P)             throttle, out of the chamber
//! P < P_p:  mdot = (C + C_v) rho_0 P_p sqrt(T_0/T_p) phi(P/P_p)     check valve beside it, into the chamber
//! F: P A becomes P (A - A_s) + P_p A_s                    in 6.25
//! goes in:   P and T of both are those of the chamber, m goes by the volumes
//! comes out: m + m_p -> m,   (P V + P_p V_p)/(V + V_p) -> P
//! A_s = pi/4 (D_s^2 - d^2)                                d: the rod on this side
//! ```
//!
//! The pocket is the bore that the spear goes into, with port and tube. It is a vessel of its own as long as the spear is in, and the valve
//! empties and fills it. Both vessels are [`crate::component::air`], phi is that of an opening in [`crate::component::valve::iso6358`],
//! and mass and energy change by nothing else: this follows from their balances, and the thesis has no cushion. Simscape's cylinder
//! cushion has the same parts: an orifice that the position closes, a throttle and a check valve.
//!
//! The spear shuts the bore at once, and opens it at once: both are events. A spear that comes out while the pressures differ lets them
//! become equal within that instant, without work. Sheets have the length alone; the throttle may stand anywhere.
//!
//! With D_s = 0 the spear has no area, the whole piston is under the pressure of the cushion, and the pocket keeps its volume.

use std::f64::consts::PI;

use super::ActuatorKind;
use super::vent::Vent;
use crate::component::air::{ChamberAir, Volume};
use crate::component::valve::iso6358::Opening;
use crate::key::{Typed, keys, words};
use crate::number::{Number, Pair};
use crate::values::{Findings, Rig};

words! {
    /// The end cushions of a cylinder.
    pub enum CushionKind {
        /// There are none.
        None = "none",
        /// Air cushions with a throttle, at one end or both.
        Adjustable = "adjustable",
    }
}

keys! {
    CUSHION: CushionKind = choice("actuator.cushion", "", "End cushions: a spear shuts the bore to the port near the end of the stroke, so that the air there leaves by a throttle.");
    CUSHION_1_LENGTH_M: f64 = number("actuator.cushion_1_length_m", 0.02, 0.0, 1.0, "", "Length of the cushion at the retracted end, 0 for none; the default is that of a rodless cylinder of 32 mm bore.").chosen_by(&CUSHION, &["adjustable"]);
    CUSHION_2_LENGTH_M: f64 = number("actuator.cushion_2_length_m", 0.02, 0.0, 1.0, "", "The same at the extended end.").chosen_by(&CUSHION, &["adjustable"]);
    CUSHION_1_CONDUCTANCE: f64 = number("actuator.cushion_1_conductance_m3_per_s_pa", 1e-9, 0.0, 1e-6, "", "Sonic conductance of the throttle at the retracted end (ISO 6358), 0 where it is shut; a round number, as the needle may stand anywhere.").chosen_by(&CUSHION, &["adjustable"]).spread();
    CUSHION_2_CONDUCTANCE: f64 = number("actuator.cushion_2_conductance_m3_per_s_pa", 1e-9, 0.0, 1e-6, "", "The same at the extended end.").chosen_by(&CUSHION, &["adjustable"]).spread();
    CUSHION_CHECK_CONDUCTANCE: f64 = number("actuator.cushion_check_conductance_m3_per_s_pa", 1e-8, 0.0, 1e-6, "", "Sonic conductance of the check valves, through which air comes back into a chamber whose spear is in; a round number, as sheets have none.").chosen_by(&CUSHION, &["adjustable"]);
    CUSHION_CRITICAL_RATIO: f64 = number("actuator.cushion_critical_ratio", 0.3, 0.0, 0.9, "", "Critical pressure ratio of throttles and check valves (ISO 6358).").chosen_by(&CUSHION, &["adjustable"]);
    CUSHION_SPEAR_DIAMETER_M: f64 = number("actuator.cushion_spear_diameter_m", 0.0, 0.0, 2.0, "", "Outer diameter of the spears, also of one that is a sleeve on the rod; 0 leaves their area out.").chosen_by(&CUSHION, &["adjustable"]);
    CUSHION_DEAD_VOLUME_PERCENT: f64 = number("actuator.cushion_dead_volume_percent", 20.0, 1.0, 99.0, "", "Part of the dead volume that is behind the spear; the rest is that of its bore, port and tube.").chosen_by(&CUSHION, &["adjustable"]);
}

const LENGTHS: [&Typed<f64>; 2] = [&keys::CUSHION_1_LENGTH_M, &keys::CUSHION_2_LENGTH_M];

/// The cushions of a cylinder, SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cushion {
    /// At the retracted and at the extended end.
    ends: [Option<End>; 2],
    /// L, m.
    stroke: f64,
}

/// The cushion at one end.
#[derive(Clone, Copy, Debug)]
struct End {
    /// l, m.
    length: f64,
    /// A, m^2.
    area: f64,
    /// A_s, m^2.
    spear: f64,
    /// q V_R and (1 - q) V_R, m^3.
    dead: [f64; 2],
    throttle: Opening,
    /// The check valve and the throttle beside it.
    back: Opening,
}

/// The air that passes a spear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passing {
    /// kg/s from the pocket into the chamber.
    pub flow: f64,
    /// Of the air that it comes from, K.
    pub temperature: f64,
}

/// Of the volume behind the spear and of the pocket, at each end.
const USED_UP: [[&str; 2]; 2] = [
    [
        "the piston has run into its stop and taken up the dead volume behind the spear at the retracted end: give more actuator.cushion_dead_volume_percent, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
        "the piston has run into its stop and taken up the dead volume in the bore of the spear at the retracted end: give less actuator.cushion_dead_volume_percent, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
    ],
    [
        "the piston has run into its stop and taken up the dead volume behind the spear at the extended end: give more actuator.cushion_dead_volume_percent, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
        "the piston has run into its stop and taken up the dead volume in the bore of the spear at the extended end: give less actuator.cushion_dead_volume_percent, a larger load.stop_stiffness_n_per_m, or a load that arrives more slowly",
    ],
];

/// Part of a dead volume that is next to nothing.
const LEFT_OVER: f64 = 0.01;

/// Whether a rig's cylinder has cushions.
#[must_use]
pub fn has_cushions(rig: &Rig) -> bool {
    lengths(rig).iter().any(|length| *length > 0.0)
}

/// l at both ends, m; 0 where there is no cushion. A vented chamber has none: its air leaves by the vent.
fn lengths(rig: &Rig) -> [f64; 2] {
    if rig.get(&keys::CUSHION) == CushionKind::None {
        return [0.0; 2];
    }
    let vented = Vent::of(rig).map(|vent| vent.chamber);
    [0, 1].map(|end| if vented == Some(end) { 0.0 } else { rig.get(LENGTHS[end]) })
}

/// The positions between which no spear is in, m; infinite where there is no cushion.
#[must_use]
pub fn between(rig: &Rig) -> [f64; 2] {
    let ([near, far], stroke) = (lengths(rig), rig.get(&super::keys::STROKE_M));
    let or = |length: f64, end: f64, none: f64| if length > 0.0 { end } else { none };
    [or(near, near, f64::NEG_INFINITY), or(far, stroke - far, f64::INFINITY)]
}

/// The diameters of the rod on both sides of the piston, m.
fn rods(rig: &Rig) -> [f64; 2] {
    let rod = rig.get(&super::keys::ROD_DIAMETER_M);
    [if rig.get(&super::keys::MODEL) == ActuatorKind::Symmetric { rod } else { 0.0 }, rod]
}

/// The constraints on the cushions of a rig.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    if rig.get(&keys::CUSHION) != CushionKind::None && !has_cushions(rig) {
        let vented = Vent::of(rig).map(|vent| vent.chamber);
        let given = LENGTHS[usize::from(vented == Some(0))].path;
        let message = format!("\"adjustable\" has no length at either end: give {given}, or write \"none\"");
        findings.note(&keys::CUSHION, message);
    }
    let half = 0.5 * rig.get(&super::keys::STROKE_M);
    let key = &keys::CUSHION_SPEAR_DIAMETER_M;
    let (spear, bore) = (rig.get(key), rig.get(&super::keys::BORE_M));
    for (end, length) in lengths(rig).into_iter().enumerate().filter(|(_, length)| *length > 0.0) {
        if length > half {
            let message = format!(
                "must not be above half of actuator.stroke_m, {half}, is {length}: a piston has one spear in at a time; give the cushion that the sheet prints, or 0 for none"
            );
            findings.note(LENGTHS[end], message);
        }
        let rod = rods(rig)[end];
        if spear >= bore || (spear > 0.0 && spear <= rod) {
            let message = format!(
                "must be between the rod of {rod} m and the bore of {bore} m at end {}, is {spear}; 0 leaves the area of the spears out",
                end + 1
            );
            findings.note(key, message);
        }
    }
}

impl Cushion {
    /// The cushions of a rig, if there are any, for the areas (m^2) and residual volumes (m^3) of its chambers.
    pub fn of(rig: &Rig, areas: [f64; 2], residual: [f64; 2]) -> Option<Cushion> {
        let (lengths, spear) = (lengths(rig), rig.get(&keys::CUSHION_SPEAR_DIAMETER_M));
        let part = 1e-2 * rig.get(&keys::CUSHION_DEAD_VOLUME_PERCENT);
        let conductances =
            [&keys::CUSHION_1_CONDUCTANCE, &keys::CUSHION_2_CONDUCTANCE].map(|key| rig.get(key));
        let (check, ratio) =
            (rig.get(&keys::CUSHION_CHECK_CONDUCTANCE), rig.get(&keys::CUSHION_CRITICAL_RATIO));
        let rods = rods(rig);
        let end = |i: usize| End {
            length: lengths[i],
            area: areas[i],
            spear: PI / 4.0 * (spear * spear - rods[i] * rods[i]).max(0.0),
            dead: [part * residual[i], (1.0 - part) * residual[i]],
            throttle: Opening::new(conductances[i], ratio),
            back: Opening::new(conductances[i] + check, ratio),
        };
        has_cushions(rig).then(|| Cushion {
            ends: [0, 1].map(|i| (lengths[i] > 0.0).then(|| end(i))),
            stroke: rig.get(&super::keys::STROKE_M),
        })
    }

    /// The end whose spear is in at a position (m).
    pub fn spear_at(&self, position: f64) -> Option<usize> {
        (0..2).find(|&end| self.depth(end, position) > 0.0)
    }

    /// How far the spear of an end is in, m; negative in front of it.
    fn depth(&self, end: usize, position: f64) -> f64 {
        self.ends[end].map_or(f64::NEG_INFINITY, |own| own.length - self.distance(end, position))
    }

    /// s, m.
    fn distance(&self, end: usize, position: f64) -> f64 {
        if end == 0 { position } else { self.stroke - position }
    }

    /// Not negative as long as the spear of this end, or none, is in.
    pub fn guard(&self, spear: Option<usize>, position: f64) -> f64 {
        match spear {
            Some(end) => self.depth(end, position),
            None => -self.depth(0, position).max(self.depth(1, position)),
        }
    }

    /// The end whose spear goes in, or the one whose spear has been in, after the guard has become negative at a position.
    pub fn after(&self, spear: Option<usize>, position: f64) -> Option<usize> {
        let nearer = usize::from(self.depth(1, position) > self.depth(0, position));
        if spear.is_none() { Some(nearer) } else { None }
    }

    fn end(&self, end: usize) -> &End {
        self.ends[end].as_ref().expect("a spear that is in has a cushion")
    }

    /// V_p at a position (m) and velocity (m/s).
    pub fn pocket(&self, end: usize, position: f64, velocity: f64) -> Volume {
        let own = self.end(end);
        let rate = if end == 0 { velocity } else { -velocity };
        Volume { volume: own.spear * self.distance(end, position) + own.dead[1], rate: own.spear * rate }
    }

    /// The chambers' volumes without the pocket.
    pub fn behind_spear(&self, end: usize, both: Volume<Pair>, pocket: Volume) -> Volume<Pair> {
        let of = |value: f64| Pair::of(|i| if i == end { value } else { 0.0 });
        Volume { volume: both.volume - of(pocket.volume), rate: both.rate - of(pocket.rate) }
    }

    /// A_s/A.
    pub fn part_of_spear(&self, end: usize) -> f64 {
        self.end(end).spear / self.end(end).area
    }

    /// The air that passes the spear.
    pub fn passing(&self, end: usize, chamber: &ChamberAir, pocket: &ChamberAir) -> Passing {
        let own = self.end(end);
        let place = |air: &ChamberAir| (air.pressure, air.temperature);
        if chamber.pressure > pocket.pressure {
            let flow = -own.throttle.flow(place(chamber), pocket.pressure);
            return Passing { flow, temperature: chamber.temperature };
        }
        Passing { flow: own.back.flow(place(pocket), chamber.pressure), temperature: pocket.temperature }
    }

    /// Why the piston can go no farther, at a position (m), and the remedy.
    pub fn used_up(&self, spear: Option<usize>, position: f64) -> Option<&'static str> {
        let end = spear?;
        let own = self.end(end);
        let distance = self.distance(end, position);
        let left = [(own.area - own.spear) * distance + own.dead[0], own.spear * distance + own.dead[1]];
        let part = (0..2).find(|&i| left[i] < LEFT_OVER * own.dead[i])?;
        Some(USED_UP[end][part])
    }

    /// The part that a piston takes up by giving way (m) at an end: of the volume behind the spear or of its pocket, whichever is larger.
    pub fn taken_up(&self, end: usize, way: f64) -> Option<f64> {
        let parts = |own: End| [(own.area - own.spear) / own.dead[0], own.spear / own.dead[1]];
        self.ends[end].map(|own| way * parts(own).into_iter().fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 mm in front of the stop, and 3 mm beyond it; a spear of 45 mm in a bore of 50 mm, with 99 % or 1 % of the dead volume behind it.
    #[test]
    fn what_a_piston_has_taken_up_is_named_with_the_part_of_the_dead_volume_that_helps() {
        let said = |percent: &str| {
            let settings = [
                "actuator.cushion=adjustable",
                "actuator.cushion_spear_diameter_m=0.045",
                &format!("actuator.cushion_dead_volume_percent={percent}"),
                "load.stop_stiffness_n_per_m=1e8",
            ];
            let rig = Rig::read_with("cushioned", "", &settings.map(str::to_owned))
                .unwrap_or_else(|problems| panic!("{problems}"));
            let cushion = Cushion::of(&rig, [1.96e-3, 1.47e-3], [2e-5; 2]).expect("cushions");
            assert_eq!(cushion.used_up(Some(0), 0.003), None);
            cushion.used_up(Some(0), -0.003).expect("taken up")
        };
        assert!(said("99").contains("give less actuator.cushion_dead_volume_percent"), "{}", said("99"));
        assert!(said("1").contains("give more actuator.cushion_dead_volume_percent"), "{}", said("1"));
    }
}
