//! The valve operator: what moves the spool.
//!
//! Analytical solenoid (6.33; thesis L(2) = 1), driven by a command X_c in metres of spool travel:
//!
//! ```text
//! u = clamp(gain X_c, +-saturation) + dither         the amplifier (thesis 5.3.2)
//! s = play(u)                                        magnetic hysteresis (6.4.5)
//! F = max(0, G_s (s + X_b)),   X_b = F_i / G_s       the coil pulls one way; X_b is its mid-range
//! M x'' = F - F_i - K x - D x' - dry friction + F_se
//! ```
//!
//! X_b makes the null of the +-1 mm signal the middle of the coil's 0 to 2 mm (EQUATIONS section 7).
//! F_se is the force of the spool's stops.

use crate::friction::{Contact, DryFriction};
use crate::play::{Dither, Play};
use crate::stop::{Side, Stops};

/// The parameters of a solenoid operator, SI.
#[derive(Clone, Copy, Debug)]
pub struct Solenoid {
    /// C(37).
    pub amplifier_gain: f64,
    /// C(38), m.
    pub saturation: f64,
    /// Half of the width of the hysteresis loop, m.
    pub hysteresis_half_width: f64,
    /// Dither of the amplifier, m of spool travel.
    pub dither: Dither,
    /// G_s, N/m.
    pub force_gain: f64,
    /// K_sp, N/m.
    pub spring: f64,
    /// F_i, N.
    pub spring_preload: f64,
    /// K_d, N s/m.
    pub damping: f64,
    /// M_s, kg.
    pub spool_mass: f64,
    /// Stiction and Coulomb friction of the spool.
    pub friction: DryFriction,
    /// The ends of the spool's travel.
    pub stops: Stops,
}

impl Solenoid {
    /// The amplifier's output for a command in m, before the dither.
    fn amplified(&self, command: f64) -> f64 {
        (self.amplifier_gain * command).clamp(-self.saturation, self.saturation)
    }

    /// The hysteresis at rest, with a command in m from t = 0.
    #[must_use]
    pub fn play_at_rest(&self, command: f64) -> Play {
        Play::new(self.hysteresis_half_width, self.dither, self.amplified(command))
    }

    /// The command jumps at `t`.
    pub fn drive(&self, play: &mut Play, t: f64, command: f64) {
        play.jump(t, self.amplified(command));
    }

    /// The next instant after `t` at which the magnetic force has a kink: of the hysteresis, or
    /// where the coil has no more current to lose.
    #[must_use]
    pub fn next_kink(&self, play: &Play, t: f64) -> f64 {
        play.next_instant().min(play.next_passage(t, -self.bias()))
    }

    /// Takes the branch of the hysteresis that holds after a kink at `t`. Where the coil runs out
    /// of current nothing changes but the force's slope.
    pub fn pass_kink(&self, play: &mut Play, t: f64) {
        if t >= play.next_instant() {
            play.pass_instant();
        }
    }

    /// X_b, m.
    fn bias(&self) -> f64 {
        self.spring_preload / self.force_gain
    }

    /// All forces on the spool but dry friction, N.
    #[must_use]
    pub fn applied_force(&self, play: &Play, side: Side, t: f64, position: f64, velocity: f64) -> f64 {
        let magnetic = (self.force_gain * (play.output(t) + self.bias())).max(0.0);
        magnetic - self.spring_preload - self.spring * position - self.damping * velocity
            + self.stops.force(side, position, velocity)
    }

    /// x'', m/s^2; exactly 0 while stuck.
    #[must_use]
    pub fn acceleration(&self, applied: f64, contact: Contact) -> f64 {
        match contact {
            Contact::Stuck => 0.0,
            _ => (applied - self.friction.force(contact, applied)) / self.spool_mass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thesis() -> Solenoid {
        Solenoid {
            amplifier_gain: 1.0,
            saturation: 1e-3,
            hysteresis_half_width: 0.05e-3,
            dither: Dither { amplitude: 0.2e-3, frequency_hz: 50.0, phase_cycles: 0.0 },
            force_gain: 25e3,
            spring: 25e3,
            spring_preload: 25.0,
            damping: 2.3,
            spool_mass: 0.023,
            friction: DryFriction::symmetric(3.0, 2.0),
            stops: Stops::new(-1e-3, 1e-3, 1e5, 5e-5, 0.5, 0.023),
        }
    }

    #[test]
    fn at_mid_range_the_coil_balances_the_preload() {
        let solenoid = thesis();
        let play = solenoid.play_at_rest(0.0);
        assert!(solenoid.applied_force(&play, Side::Free, 0.0, 0.0, 0.0).abs() < 1e-12);
    }

    #[test]
    fn a_command_moves_the_balance_by_itself_less_the_slack() {
        let solenoid = thesis();
        let mut play = solenoid.play_at_rest(0.0);
        solenoid.drive(&mut play, 0.02, 0.5e-3);
        assert!(solenoid.applied_force(&play, Side::Free, 0.02, 0.45e-3, 0.0).abs() < 1e-9);
    }

    #[test]
    fn the_coil_cannot_push() {
        let solenoid = thesis();
        let play = solenoid.play_at_rest(-5e-3);
        let crest_down = 0.015;
        let force = solenoid.applied_force(&play, Side::Free, crest_down, 0.0, 0.0);
        assert!(force >= -25.0 - 1e-9, "at most the preload pulls back: {force}");
    }
}
