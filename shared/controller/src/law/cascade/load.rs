//! The load: its mass, friction, standing force and viscous friction, learned while it moves.
//!
//! ```text
//! F = M (a/A + w) + s Fc sgn(v) + f + d + B v         A: acceleration by the supply on area 1;  w: weight, f: force of the rig file
//! ```
//!
//! M and s are parts of what the rig file says. The measured force, the friction and the speed go through the same filter
//! 1/(p/300 + 1)^3, whose difference of the speed is a; each of the four unknowns is counted in units of its prior deviation (0.3,
//! 0.3, the stiction, B itself), forces in units of their noise, for recursive least squares (`squares`). What the filter still
//! holds of the stiction is doubt.
//!
//! A load may be exchanged while it rests: with a new target the variance of M grows by a quarter of the prior's.
//!
//! Every other sample above 30 mm/s counts; those between are for the lag of the valve ([`super::lag`]). What is learned stays within its bounds: M 0.25 to 2.5, s 0.3 to 2, d within 8 stictions, B 0 to 5
//! times that of the rig file.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | forces, M, s as they are used | Q24, Q16, Q16 | |
//! | filters of speed, force and friction | Q16, Q24, Q24 | 2^14 counts a sample, saturated, 1 |

use super::kept::Learned;
use super::number::{ONE, product, ratio, scaled, within};
use super::squares::Squares;
use crate::fixed::saturate;
use crate::parameters::{Parameters, id};

/// 0.3 in Q16: the prior deviation of mass and friction.
const SPREAD: i32 = 19_661;
/// The bounds of the unknowns, Q24.
const BOUNDS: [[i32; 2]; 4] =
    [[-41_943_040, 83_886_080], [-39_146_837, 55_924_053], [-8 * ONE, 8 * ONE], [-ONE, 4 * ONE]];

/// What the variance of the mass grows by before a move, Q30: half the prior deviation.
const EXCHANGED: i32 = 1 << 28;

/// What is left of a beginning of which nothing is known, 64 times as much as of one at which a load breaks away: in 29 ms it is as much.
const LOST: Filter = [64 * ONE; 3];

/// What it knows beforehand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constants {
    /// A, Q16.
    pub(super) acceleration: i32,
    /// 1/A, Q24.
    pub(super) inertia: i32,
    /// Fc of both directions, and the stiction, Q24.
    coulomb: [i32; 2],
    pub(super) stiction: i32,
    /// B, Q30 a count per sample.
    viscous: i32,
    /// w and f, Q24.
    weight: i32,
    force: i32,
    /// 1/noise, Q16; 0: nothing is learned.
    pub(super) certainty: i32,
    /// The stiction over the noise, Q16.
    doubt: i32,
    /// Of the filter, Q16.
    pole: i32,
    /// 30 mm/s, Q16.
    fast: i32,
}

/// A filter of three equal poles.
type Filter = [i32; 3];

/// What is learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Load {
    squares: Squares<4>,
    /// Speed, force, friction and what is left of the beginning; whether they run.
    speed: Filter,
    pushed: Filter,
    rubbed: Filter,
    left: Filter,
    runs: bool,
    /// M, Q16.
    pub mass: i32,
    /// 1/M, Q16.
    pub by_mass: i32,
    /// s, Q16.
    pub friction: i32,
    /// M w + f + d, Q24.
    pub standing: i32,
    /// B, Q30 a count per sample.
    pub viscous: i32,
}

impl Constants {
    /// `speed` is a m/s in counts a sample, Q16.
    pub(super) fn of(parameters: &Parameters, period_us: u32, speed: i32) -> Constants {
        let get = |id| parameters.scalar(id);
        let acceleration = get(id::CASCADE_ACCELERATION);
        let noise = get(id::CASCADE_LEARNING_NOISE);
        let inverse =
            |value: i32| ratio(1 << 40, u64::from(value.unsigned_abs())).min(i32::MAX as u64) as i32;
        // 300 T/(1 + 300 T).
        let pole = ratio((300 * u64::from(period_us)) << 16, 1_000_000 + 300 * u64::from(period_us));
        let certainty = if noise == 0 { 0 } else { inverse(noise) };
        Constants {
            acceleration,
            inertia: inverse(acceleration),
            coulomb: [get(id::CASCADE_COULOMB_EXTEND), get(id::CASCADE_COULOMB_RETRACT)],
            stiction: get(id::CASCADE_STICTION),
            viscous: get(id::CASCADE_VISCOUS),
            weight: get(id::CASCADE_WEIGHT),
            force: get(id::CASCADE_STANDING_FORCE),
            certainty,
            doubt: product(get(id::CASCADE_STICTION), certainty, 24),
            pole: pole as i32,
            fast: product(speed, 1966, 16),
        }
    }

    /// Fc with the sign of a motion, Q24; 0 without.
    #[inline(always)]
    fn coulomb(&self, sign: i32) -> i32 {
        match sign {
            1.. => self.coulomb[0],
            0 => 0,
            _ => -self.coulomb[1],
        }
    }

    /// A force or an equation's part in units of the noise, Q16.
    #[inline(always)]
    fn weighed(&self, force: i32) -> i32 {
        product(force, self.certainty, 24)
    }
}

impl Default for Load {
    fn default() -> Load {
        Load {
            squares: Squares::default(),
            speed: [0; 3],
            pushed: [0; 3],
            rubbed: [0; 3],
            left: [0; 3],
            runs: false,
            mass: 1 << 16,
            by_mass: 1 << 16,
            friction: 1 << 16,
            standing: 0,
            viscous: 0,
        }
    }
}

/// One sample through a filter; returns what came out before.
#[inline(always)]
fn pass(filter: &mut Filter, input: i32, pole: i32) -> i32 {
    let [first, second, third] = filter;
    let before = *third;
    *first = first.saturating_add(scaled(input.saturating_sub(*first), pole, 16));
    *second = second.saturating_add(scaled(first.saturating_sub(*second), pole, 16));
    *third = third.saturating_add(scaled(second.saturating_sub(*third), pole, 16));
    before
}

/// 1/0.3 in Q24: a sample does not divide.
const BY_SPREAD: i64 = (1 << 40) / SPREAD as i64;

/// A part of what the rig file says (Q16) in prior deviations from it, Q24.
fn deviation(part: i32) -> i32 {
    saturate(((i64::from(part) - (1 << 16)) * BY_SPREAD) >> 16)
}

impl Load {
    /// With what is known of it, as little certain as the rig file.
    pub(super) fn new(constants: &Constants, known: &Learned) -> Load {
        let mut load = Load::default();
        let Learned { mass, friction, force, viscous, .. } = *known;
        let known = [deviation(mass), deviation(friction), force, viscous];
        for ((unknown, known), &[low, high]) in load.squares.unknown.iter_mut().zip(known).zip(&BOUNDS) {
            *unknown = known.min(high).max(low);
        }
        load.take_over(constants);
        load
    }

    /// It moves by this step under this force: nothing is learned before the filters have forgotten that they
    /// began with neither acceleration nor its force.
    pub(super) fn goes_on(&mut self, constants: &Constants, step: i32, force: i32) {
        self.speed = [within(step, 1 << 14) << 16; 3];
        self.pushed = [force; 3];
        self.rubbed = [constants.coulomb(step.signum()); 3];
        (self.left, self.runs) = (LOST, true);
    }

    /// d and B as they are learned, in their deviations, Q24.
    pub(super) fn forces(&self) -> [i32; 2] {
        let [_, _, force, viscous] = self.squares.unknown;
        [force, viscous]
    }

    /// Whether mass or standing force is at a bound.
    pub(super) fn is_at_bound(&self) -> bool {
        let ([of_mass, _, of_force, _], [mass, _, force, _]) = (&BOUNDS, &self.squares.unknown);
        of_mass.contains(mass) || of_force.contains(force)
    }

    /// Friction in motion with a sign, Q24.
    #[inline]
    pub fn slide(&self, constants: &Constants, sign: i32) -> i32 {
        product(constants.coulomb(sign), self.friction, 16)
    }

    /// A force no farther from a centre than a share (Q16) of the running friction, Q24.
    pub(super) fn held(&self, constants: &Constants, force: i32, centre: i32, share: i32) -> i32 {
        let [extend, retract] = constants.coulomb;
        let most = product(product(extend.min(retract), self.friction, 16), share, 16);
        force.min(centre.saturating_add(most)).max(centre.saturating_sub(most))
    }

    /// B v, Q24; v in Q16.
    #[inline]
    pub fn drag(&self, speed: i32) -> i32 {
        product(self.viscous, speed, 22)
    }

    /// What a force accelerates it by, counts a sample squared, Q16.
    #[inline]
    pub fn accelerated(&self, constants: &Constants, force: i32) -> i32 {
        product(product(force, constants.acceleration, 24), self.by_mass, 16)
    }

    /// M/A in Q24: the force of an acceleration of 1.
    #[inline]
    pub fn inertia(&self, constants: &Constants) -> i32 {
        product(constants.inertia, self.mass, 16)
    }

    /// At rest, with a new target: it may be another load.
    pub(super) fn may_be_exchanged(&mut self) {
        self.squares.doubt(0, EXCHANGED);
    }

    /// A load at rest tells nothing.
    pub(super) fn forget(&mut self) {
        self.runs = false;
    }

    /// An end of the stroke pushes a load back with a force that nobody knows: nothing is learned until the filters have forgotten it.
    pub(super) fn lose(&mut self) {
        self.left = LOST;
    }

    /// Whether they have not yet.
    #[inline(always)]
    pub(super) fn is_lost(&self) -> bool {
        self.left[2] > ONE
    }

    /// A sample in motion: the step of the count, the speed (Q16) and the force (Q24); `is_for_load`: whether it is one to learn by.
    pub(super) fn learn(
        &mut self,
        constants: &Constants,
        step: i32,
        speed: i32,
        force: i32,
        is_for_load: bool,
    ) {
        if constants.certainty == 0 {
            return;
        }
        let slide = constants.coulomb(if speed > 0 { 1 } else { -1 });
        if !self.runs {
            let rest = self.standing.saturating_add(product(slide, self.friction, 16));
            // What it broke away from was no farther from that than the stiction, whatever stands against it.
            let rest = rest
                .max(force.saturating_sub(constants.stiction))
                .min(force.saturating_add(constants.stiction));
            (self.speed, self.pushed, self.rubbed) = ([0; 3], [rest; 3], [slide; 3]);
            (self.left, self.runs) = ([ONE; 3], true);
        }
        let pole = constants.pole;
        let before = pass(&mut self.speed, within(step, 1 << 14) << 16, pole);
        let after = self.speed[2];
        let force = pass(&mut self.pushed, force, pole);
        let slide = pass(&mut self.rubbed, slide, pole);
        let left = pass(&mut self.left, 0, pole);
        let mean = (before >> 1) + (after >> 1);
        let goes_on = (mean > 0) == (speed > 0) && mean.unsigned_abs() > constants.fast.unsigned_abs();
        if is_for_load && goes_on && !self.is_lost() {
            self.fit(constants, [after.saturating_sub(before), mean, force, slide], left);
            self.take_over(constants);
        }
    }

    /// A step of the least squares.
    #[inline(never)]
    fn fit(&mut self, constants: &Constants, [change, speed, force, slide]: [i32; 4], left: i32) {
        let inertia = product(change, constants.inertia, 16).saturating_add(constants.weight);
        let drag = product(constants.viscous, speed, 22);
        let known = inertia.saturating_add(slide).saturating_add(drag).saturating_add(constants.force);
        let h = [
            scaled(constants.weighed(inertia), SPREAD, 16),
            scaled(constants.weighed(slide), SPREAD, 16),
            constants.doubt,
            constants.weighed(drag),
        ];
        let y = constants.weighed(force.saturating_sub(known));
        // No more than 1 is left.
        let doubt = scaled(constants.doubt, left, 24);
        self.squares.fit(h, y, product(doubt, doubt, 16), &BOUNDS);
    }

    /// The unknowns as they are used.
    fn take_over(&mut self, constants: &Constants) {
        let [mass, friction, force, viscous] = self.squares.unknown;
        self.mass = ((1 << 16) + scaled(mass, SPREAD, 24)).clamp(1 << 14, 5 << 15);
        self.by_mass = u32::MAX.checked_div(self.mass.unsigned_abs()).unwrap_or(0) as i32;
        self.friction = ((1 << 16) + scaled(friction, SPREAD, 24)).min(2 << 16);
        self.standing = product(constants.weight, self.mass, 16)
            .saturating_add(constants.force)
            .saturating_add(product(constants.stiction, force, 24));
        self.viscous = constants.viscous.saturating_add(product(constants.viscous, viscous, 24));
    }
}
