//! The known course of a spool: until when it is held, or the limits that a flight may meet.

use super::{FRICTION, Magnetism, STOPS, Solenoid};
use crate::component::friction::Contact;
use crate::component::operator::hysteresis::Hysteresis;
use crate::component::operator::{KnownMotion, Limit, Met, Quantity, SpoolState};

/// How many branches ahead a breakaway is looked for: an output comes before the next one, as a rule.
const BRANCHES: usize = 3;

impl Solenoid {
    /// Its known course after `t`, by the edges of the lands.
    pub(in super::super) fn course(&self, t: f64, spool: SpoolState, edges: &[Limit; 2]) -> KnownMotion<'_> {
        match (&self.flight, &self.magnetism) {
            (Some(flight), _) => KnownMotion::Flies(flight, self.limits(edges)),
            (None, Magnetism::Stepped(hysteresis)) if self.has_closed_form() => {
                self.standing(t, spool, *hysteresis)
            }
            _ => KnownMotion::Unknown,
        }
    }

    /// A spool that is held breaks away where the magnetic force leaves the band of stiction. Until then the branches of
    /// the hysteresis move nothing: they are followed on a copy.
    fn standing(&self, t: f64, spool: SpoolState, mut hysteresis: Hysteresis) -> KnownMotion<'_> {
        let p = &self.parameters;
        let balance = p.spring_preload + p.spring * spool.position;
        let magnetised = |force: f64| force / p.force_gain - self.bias();
        let low = balance - p.friction.static_retract;
        // The coil cannot push.
        let low = if low > 0.0 { magnetised(low) } else { f64::NEG_INFINITY };
        let band = [low, magnetised(balance + p.friction.static_extend)];
        let mut from = t;
        for _ in 0..BRANCHES {
            let (exit, change) = (hysteresis.next_exit(from, band), hysteresis.next_time_event());
            if exit < change {
                return KnownMotion::Stands(exit, Some(FRICTION));
            } else if change.is_infinite() {
                return KnownMotion::Stands(f64::INFINITY, None);
            }
            hysteresis.pass_instant();
            from = change;
        }
        KnownMotion::Stands(from, None)
    }

    /// The hysteresis of a spool that stood until `t` takes its branch there.
    pub(in super::super) fn catch_up(&mut self, t: f64) {
        if self.flies() || !self.has_closed_form() {
            return;
        }
        if let Magnetism::Stepped(hysteresis) = &mut self.magnetism {
            while hysteresis.next_time_event() <= t {
                hysteresis.pass_instant();
            }
        }
    }

    /// The limits of its flight: the next edge or stop ahead, and the end of its slip. Without friction, edge or stop
    /// either way.
    fn limits(&self, edges: &[Limit; 2]) -> [Limit; 2] {
        let slip = |upper| Limit { of: Quantity::Velocity, level: 0.0, upper, met: Met::Guard(FRICTION) };
        match self.contact {
            Contact::Extending => [self.next_place(edges, true), slip(false)],
            Contact::Retracting => [self.next_place(edges, false), slip(true)],
            Contact::Free | Contact::Stuck => [true, false].map(|up| self.next_place(edges, up)),
        }
    }

    /// The first place that it meets on its way up or down.
    fn next_place(&self, edges: &[Limit; 2], up: bool) -> Limit {
        let stops = &self.parameters.stops;
        let level = if up { stops.high } else { stops.low };
        let stop = Limit { of: Quantity::Position, level, upper: up, met: Met::Guard(STOPS) };
        let nearer =
            |one: &Limit, other: &Limit| if up { one.level < other.level } else { one.level > other.level };
        // Of two at the same place the one with the lower index.
        edges
            .iter()
            .rev()
            .filter(|edge| edge.upper == up)
            .fold(stop, |next, edge| if nearer(&next, edge) { next } else { *edge })
    }
}
