//! Analytical solenoid (6.33; thesis L(2) = 1), driven by a command X_c in metres of spool travel:
//!
//! ```text
//! u = clamp(gain X_c, +-saturation) + dither         the amplifier (thesis 5.3.2)
//! s = play(u)                                        magnetic hysteresis (6.4.5)
//! F = max(0, G_s (s + X_b)),   X_b = F_i / G_s       the coil pulls one way; X_b is its mid-range
//! M x'' = F - F_i - K x - D x' - F_ind - dry friction + F_se
//! ```
//!
//! X_b makes the null of the +-1 mm signal the middle of the coil's 0 to 2 mm (EQUATIONS section 7).
//! F_ind is the flow force, F_se the force of the spool's stops.

mod course;
mod parameters;

use super::closed_form::{Forcing, FreeMotion, Oscillator, rounding};
use super::hysteresis::Hysteresis;
use super::moving_hysteresis::MovingHysteresis;
use super::{GUARDS, Request, SpoolLaw, SpoolState, within_range};
use crate::component::dither::Dither;
use crate::component::friction::Contact;
use crate::component::stop::Side;
pub(crate) use parameters::check;
pub use parameters::{SolenoidParameters, keys};

/// The magnetic hysteresis, by the kind of its command.
#[derive(Clone, Copy, Debug)]
enum Magnetism {
    /// It changes at outputs: when the branches change is known beforehand.
    Stepped(Hysteresis),
    /// It moves all the time: when the branches change has to be found.
    Moving(MovingHysteresis),
}

impl Magnetism {
    /// s, m.
    fn output(&self, t: f64) -> f64 {
        match self {
            Magnetism::Stepped(hysteresis) => hysteresis.output(t),
            Magnetism::Moving(hysteresis) => hysteresis.output(t),
        }
    }
}

/// A solenoid with its modes.
#[derive(Clone, Debug)]
pub struct Solenoid {
    parameters: SolenoidParameters,
    counts: f64,
    magnetism: Magnetism,
    contact: Contact,
    side: Side,
    /// The motion until the next event, where it is known.
    flight: Option<FreeMotion>,
    /// When the coil runs out of current or has some again, if the branch stays.
    passage: f64,
}

/// s: a time in which no force changes its kind by itself.
const MOMENT: f64 = 1e-3;

const FRICTION: usize = 0;
const STOPS: usize = 1;
const MAGNETISM: usize = 2;

impl Solenoid {
    /// A solenoid with its spool at rest at mid-travel and a null command, tested for breakaway.
    #[must_use]
    pub fn new(parameters: SolenoidParameters) -> Solenoid {
        let p = &parameters;
        let hysteresis = Hysteresis::new(p.play, p.dither, 0.0);
        let mut solenoid = Solenoid::stuck(parameters, Magnetism::Stepped(hysteresis));
        solenoid.set_off(0.0, SpoolState::default(), 0.0);
        solenoid
    }

    /// A solenoid for a command that moves all the time, with its spool at mid-travel. It begins with the
    /// jump to its first command, and is tested for breakaway then.
    #[must_use]
    pub fn with_moving_command(parameters: SolenoidParameters) -> Solenoid {
        let p = &parameters;
        let hysteresis = MovingHysteresis::new(p.play, p.dither, p.limit());
        Solenoid::stuck(parameters, Magnetism::Moving(hysteresis))
    }

    fn stuck(parameters: SolenoidParameters, magnetism: Magnetism) -> Solenoid {
        let side = parameters.stops.side(0.0);
        let contact = Contact::Stuck;
        Solenoid { parameters, counts: 0.0, magnetism, contact, side, flight: None, passage: f64::INFINITY }
    }

    /// X_c, m.
    pub(super) fn commanded(&self) -> f64 {
        self.counts * self.parameters.travel_per_count
    }

    /// Where the spool is at `t`, if the integrator's state is `spool`.
    pub(super) fn state(&self, t: f64, spool: SpoolState) -> SpoolState {
        self.flight.as_ref().map_or(spool, |flight| flight.at(t))
    }

    pub(super) fn drive(&mut self, t: f64, spool: SpoolState, request: Request, flow_force: f64) {
        self.counts = f64::from(request.counts);
        let amplified = self.amplified();
        match &mut self.magnetism {
            Magnetism::Stepped(hysteresis) => hysteresis.jump(t, amplified),
            Magnetism::Moving(hysteresis) => hysteresis.jump(t, amplified, 0.0),
        }
        self.set_off(t, spool, flow_force);
    }

    pub(super) fn follow(&mut self, demand: f64) {
        self.counts = within_range(demand);
        let unlimited = demand * self.amplified_per_count();
        if let Magnetism::Moving(hysteresis) = &mut self.magnetism {
            hysteresis.follow(unlimited);
        }
    }

    pub(super) fn follow_rate(&mut self, rate: f64) {
        let rate = rate * self.amplified_per_count();
        if let Magnetism::Moving(hysteresis) = &mut self.magnetism {
            hysteresis.follow_rate(rate);
        }
    }

    pub(super) fn remembers_command(&self) -> bool {
        matches!(self.magnetism, Magnetism::Moving(_))
    }

    pub(super) fn needs_rate(&self) -> bool {
        matches!(&self.magnetism, Magnetism::Moving(hysteresis) if hysteresis.needs_rate())
    }

    /// The demand (counts) that it follows, its rate (counts/s) or both jump.
    pub(super) fn jump(&mut self, t: f64, spool: SpoolState, [demand, rate]: [f64; 2], flow_force: f64) {
        self.counts = within_range(demand);
        let amplified = self.amplified_per_count();
        if let Magnetism::Moving(hysteresis) = &mut self.magnetism {
            hysteresis.jump(t, demand * amplified, rate * amplified);
        }
        self.break_away(t, spool, flow_force);
    }

    /// The output of the hysteresis for command and dither, m.
    #[cfg(test)]
    pub(crate) fn magnetised(&self, t: f64) -> f64 {
        self.magnetism.output(t)
    }

    pub(super) fn spool_law(&self) -> SpoolLaw {
        let p = &self.parameters;
        SpoolLaw::Moves {
            per_count: self.amplified_per_count() * p.force_gain / p.spring,
            stiffness_per_mass: p.spring / p.spool_mass,
            damping_per_mass: p.damping / p.spool_mass,
            mass: p.spool_mass,
        }
    }

    /// m.
    fn amplified_per_count(&self) -> f64 {
        self.parameters.amplifier_gain * self.parameters.travel_per_count
    }

    fn amplified(&self) -> f64 {
        let p = &self.parameters;
        (p.amplifier_gain * self.commanded()).clamp(-p.saturation, p.saturation)
    }

    /// The forces have changed: the spool is tested for breakaway, and its motion restarts.
    fn set_off(&mut self, t: f64, spool: SpoolState, flow_force: f64) {
        self.break_away(t, spool, flow_force);
        self.fly(t, spool);
    }

    /// Between its stops a spool that slips goes as far as is known beforehand.
    fn fly(&mut self, t: f64, spool: SpoolState) {
        let Magnetism::Stepped(hysteresis) = self.magnetism else { return };
        self.passage = hysteresis.next_passage(t, -self.bias());
        let moves = self.contact != Contact::Stuck && self.side == Side::Free;
        self.flight = if moves && !self.parameters.feels_flow {
            let p = &self.parameters;
            let oscillator = Oscillator {
                stiffness_per_mass: p.spring / p.spool_mass,
                damping_per_mass: p.damping / p.spool_mass,
            };
            FreeMotion::new(oscillator, self.forces(t, &hysteresis), t, spool)
        } else {
            None
        };
    }

    /// The forces on a slipping spool from `t` to the next kink of the magnetic force.
    fn forces(&self, t: f64, hysteresis: &Hysteresis) -> Forcing {
        let p = &self.parameters;
        let (level, driven) = hysteresis.course();
        let inside = t + 0.5 * (self.next_time_event() - t).min(MOMENT);
        let pulls = self.magnetism.output(inside) + self.bias() > 0.0;
        let magnetic = if pulls { p.force_gain * (level + self.bias()) } else { 0.0 };
        let steady = magnetic - p.spring_preload - p.friction.force(self.contact, 0.0);
        let amplitude = if pulls && driven { p.force_gain * hysteresis.dither().amplitude } else { 0.0 };
        Forcing {
            steady: steady / p.spool_mass,
            swing: Dither { amplitude: amplitude / p.spool_mass, ..hysteresis.dither() },
        }
    }

    /// A stuck spool is tested for breakaway after a jump of its force; a slipping one keeps its
    /// mode (EQUATIONS section 11 rule 2).
    fn break_away(&mut self, t: f64, spool: SpoolState, flow_force: f64) {
        if self.contact == Contact::Stuck {
            self.contact = self.parameters.friction.at_rest(self.applied_force(t, spool, flow_force));
        }
    }

    /// X_b, m.
    fn bias(&self) -> f64 {
        self.parameters.spring_preload / self.parameters.force_gain
    }

    /// All forces on the spool but dry friction, N.
    fn applied_force(&self, t: f64, spool: SpoolState, flow_force: f64) -> f64 {
        let p = &self.parameters;
        let magnetic = (p.force_gain * (self.magnetism.output(t) + self.bias())).max(0.0);
        magnetic - p.spring_preload - p.spring * spool.position - p.damping * spool.velocity - flow_force
            + p.stops.force(self.side, spool.position, spool.velocity)
    }

    pub(super) fn acceleration(&self, t: f64, spool: SpoolState, flow_force: f64) -> f64 {
        if self.contact == Contact::Stuck {
            return 0.0;
        }
        let applied = self.applied_force(t, spool, flow_force);
        (applied - self.parameters.friction.force(self.contact, applied)) / self.parameters.spool_mass
    }

    pub(super) fn guards(&self, t: f64, spool: SpoolState, flow_force: f64) -> [f64; GUARDS] {
        let stuck = self.contact == Contact::Stuck;
        let applied = if stuck { self.applied_force(t, spool, flow_force) } else { 0.0 };
        let mut guards = [1.0; GUARDS];
        // A spool that has broken away without more force than holds it back is at rest but for rounding.
        let rests = self.flies() && spool.velocity.abs() <= rounding(t);
        let velocity = if rests { 0.0 } else { spool.velocity };
        guards[FRICTION] = self.parameters.friction.guard(self.contact, applied, velocity);
        guards[STOPS] = self.parameters.stops.guard(self.side, spool.position);
        if let Magnetism::Moving(hysteresis) = &self.magnetism {
            guards[MAGNETISM..].copy_from_slice(&hysteresis.guards(t));
        }
        guards
    }

    pub(super) fn cross(&mut self, guard: usize, t: f64, spool: &mut SpoolState, flow_force: f64) {
        if guard == STOPS {
            self.side = self.parameters.stops.after(self.side, spool.position);
            self.fly(t, *spool);
            return;
        }
        if let Magnetism::Moving(hysteresis) = &mut self.magnetism
            && guard >= MAGNETISM
        {
            hysteresis.cross(guard - MAGNETISM, t);
            return;
        }
        if self.contact != Contact::Stuck {
            spool.velocity = 0.0;
        }
        let applied = self.applied_force(t, *spool, flow_force);
        self.contact = self.parameters.friction.after(self.contact, applied);
        self.fly(t, *spool);
    }

    /// The next kink of the magnetic force: of the hysteresis, or where the coil has no more current
    /// to lose.
    pub(super) fn next_time_event(&self) -> f64 {
        match &self.magnetism {
            Magnetism::Stepped(hysteresis) => hysteresis.next_time_event().min(self.passage),
            Magnetism::Moving(_) => f64::INFINITY,
        }
    }

    /// Whether the motion is known, so that the integrator's state rests.
    pub(super) fn flies(&self) -> bool {
        self.flight.is_some()
    }

    /// Whether nothing but time moves the spool, or would break it away.
    pub(super) fn has_closed_form(&self) -> bool {
        let held = self.contact == Contact::Stuck && self.side == Side::Free && !self.parameters.feels_flow;
        self.flies() || (held && matches!(self.magnetism, Magnetism::Stepped(_)))
    }

    /// s.
    pub(super) fn max_step(&self) -> f64 {
        self.flight.as_ref().map_or(f64::INFINITY, FreeMotion::quarter_period)
    }

    /// Where the coil runs out of current nothing changes but the force's slope.
    pub(super) fn pass_instant(&mut self, t: f64, spool: SpoolState, flow_force: f64) {
        if let Magnetism::Stepped(hysteresis) = &mut self.magnetism
            && t >= hysteresis.next_time_event()
        {
            hysteresis.pass_instant();
        }
        self.set_off(t, spool, flow_force);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::friction::DryFriction;
    use crate::component::play::Play;
    use crate::component::stop::Stops;

    fn thesis() -> Solenoid {
        Solenoid::new(SolenoidParameters {
            travel_per_count: 1e-3 / 2048.0,
            amplifier_gain: 1.0,
            saturation: 1e-3,
            play: Play::held(0.05e-3, 0.0),
            dither: Dither { amplitude: 0.2e-3, frequency_hz: 50.0, phase_cycles: 0.0 },
            force_gain: 25e3,
            spring: 25e3,
            spring_preload: 25.0,
            damping: 2.3,
            spool_mass: 0.023,
            friction: DryFriction::symmetric(3.0, 2.0),
            stops: Stops::new(-1e-3, 1e-3, 1e5, 5e-5, 0.5, 0.023),
            feels_flow: false,
        })
    }

    const REST: SpoolState = SpoolState { position: 0.0, velocity: 0.0 };

    #[test]
    fn at_mid_range_the_coil_balances_the_preload() {
        assert!(thesis().applied_force(0.0, REST, 0.0).abs() < 1e-12);
        assert_eq!(thesis().contact, Contact::Stuck);
    }

    #[test]
    fn a_command_moves_the_balance_by_itself_less_the_slack() {
        let mut solenoid = thesis();
        solenoid.drive(0.02, REST, Request { counts: 1024, step: 0 }, 0.0);
        let balance = SpoolState { position: 0.45e-3, velocity: 0.0 };
        assert!(solenoid.applied_force(0.02, balance, 0.0).abs() < 1e-9);
        assert_eq!(solenoid.contact, Contact::Extending, "12 N break the spool away");
    }

    /// EQUATIONS section 11 rule 4: from s = 0, rule 3 once with the first input. At 13.5 N of dither alone
    /// the spool would have broken away.
    #[test]
    fn a_moving_command_begins_with_its_first_value_not_with_null() {
        let dither = Dither { amplitude: 0.6e-3, frequency_hz: 50.0, phase_cycles: 0.25 };
        let mut solenoid =
            Solenoid::with_moving_command(SolenoidParameters { dither, ..thesis().parameters });
        solenoid.jump(0.0, REST, [-0.55e-3 * 2.048e6, 0.0], 0.0);
        assert!(solenoid.magnetised(0.0).abs() < 1e-15);
        assert_eq!(solenoid.contact, Contact::Stuck);
    }

    #[test]
    fn the_limit_of_a_moving_command_is_that_of_converter_or_amplifier() {
        for (amplifier_gain, saturation, limit) in [(1.0, 2e-3, 1e-3), (3.0, 2e-3, 2e-3), (0.5, 2e-3, 0.5e-3)]
        {
            let parameters = SolenoidParameters { amplifier_gain, saturation, ..thesis().parameters };
            let still = Dither { amplitude: 0.0, ..parameters.dither };
            let mut solenoid =
                Solenoid::with_moving_command(SolenoidParameters { dither: still, ..parameters });
            solenoid.jump(0.0, REST, [9000.0, 0.0], 0.0);
            assert!((solenoid.magnetised(0.0) - (limit - 0.05e-3)).abs() < 1e-15);
            assert_eq!(solenoid.commanded(), 1e-3);
        }
    }

    #[test]
    fn the_coil_cannot_push() {
        let mut solenoid = thesis();
        solenoid.drive(0.01, REST, Request { counts: -2048, step: 0 }, 0.0);
        let trough = 0.015;
        let force = solenoid.applied_force(trough, REST, 0.0);
        assert!(force >= -25.0 - 1e-9, "at most the preload pulls back: {force}");
    }

    #[test]
    fn a_flow_force_pushes_an_open_spool_back() {
        let with = thesis().applied_force(0.0, REST, 2.0);
        assert!((with + 2.0).abs() < 1e-12);
    }
}
