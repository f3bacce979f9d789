//! The first event in a step: seen at a few looks, unless all guards stay clear of zero, then located on the
//! refined step.

use super::crossing::{LOOKS, Looks, any_may_cross, first_of, stay_clear};
use super::segment::Segment;
use super::{Event, Hybrid, Integrator};
use crate::root::bracketed_root;

/// To how much of a step a flow guard's zero is located: such a guard is dear, and what it changes begins
/// with nothing.
const FLOW_PLACE: f64 = 1e-10;

/// A step's instants.
struct Span {
    start: f64,
    width: f64,
    end: f64,
}

impl Span {
    fn when(&self, theta: f64) -> f64 {
        if theta == 1.0 { self.end } else { self.start + theta * self.width }
    }
}

impl<const N: usize, const G: usize, const F: usize, const CORE: usize> Integrator<N, G, F, CORE> {
    /// The first guard in a step from the present state to `x` at `end` that becomes negative, and when.
    pub(super) fn first_event(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        segment: &mut Segment<N>,
        end: f64,
        x: &[f64; N],
    ) -> Option<(Event, f64)> {
        let span = Span { start: segment.start, width: segment.width, end };
        let begin = self.guards.unwrap_or_else(|| system.guards(span.start, &self.x));
        let (middle, last) = (system.guards(span.when(0.5), &segment.at_part(0.5)), system.guards(end, x));
        let flows = system.flow_guards(end, x);
        self.guards = Some(last);
        let flows_go_on = flows.iter().all(|value| *value >= 0.0);
        if flows_go_on && stay_clear(&begin, &middle, &last) {
            return None;
        }
        let mut looks = looks(system, segment, &span, x);
        if flows_go_on && !any_may_cross(&begin, &looks) {
            return None;
        }
        if self.refine(system, segment) {
            looks = self::looks(system, segment, &span, x);
        }
        let by_state =
            first_of(&begin, &looks, |theta| system.guards(span.when(theta), &segment.at_part(theta)))
                .map(|(guard, theta)| (Event::Guard(guard), span.when(theta)));
        let by_flow = self.first_flow_guard(system, segment, &span, &flows);
        [by_state, by_flow].into_iter().flatten().min_by(|(_, one), (_, other)| one.total_cmp(other))
    }

    fn first_flow_guard(
        &self,
        system: &mut impl Hybrid<N, G, F>,
        segment: &Segment<N>,
        span: &Span,
        after: &[f64; F],
    ) -> Option<(Event, f64)> {
        let mut first: Option<(Event, f64)> = None;
        for guard in (0..F).filter(|guard| after[*guard] < 0.0) {
            let before = system.flow_guards(span.start, &self.x)[guard].max(0.0);
            let value_at = |theta: f64| system.flow_guards(span.when(theta), &segment.at_part(theta))[guard];
            let theta = bracketed_root(value_at, [(0.0, before), (1.0, after[guard])], FLOW_PLACE);
            first = earlier(first, (Event::FlowGuard(guard), span.when(theta)));
        }
        first
    }
}

/// The guards at [`LOOKS`].
fn looks<const N: usize, const G: usize, const F: usize>(
    system: &mut impl Hybrid<N, G, F>,
    segment: &Segment<N>,
    span: &Span,
    x: &[f64; N],
) -> Looks<G> {
    let mut inside = |i: usize| system.guards(span.when(LOOKS[i]), &segment.at_part(LOOKS[i]));
    let [one, two, three] = [inside(0), inside(1), inside(2)];
    [one, two, three, system.guards(span.end, x)]
}

/// Of two at the same instant the one that is known already.
fn earlier(known: Option<(Event, f64)>, other: (Event, f64)) -> Option<(Event, f64)> {
    known.filter(|(_, at)| *at <= other.1).or(Some(other))
}
