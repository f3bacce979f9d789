//! The first event in a step. Unless all guards stay clear of zero, they are probed at a few places; a zero is then
//! located on the refined dense output.

use crate::crossing::{PROBES, any_may_cross, first_crossing, stay_clear};
use crate::dense_output::DenseOutput;
use crate::progress::Progress;
use crate::root::bracketed_root;
use crate::system::{Event, System};

/// Part of a step to which the zero of an end guard is located: such a guard is expensive.
const END_GUARD_RESOLUTION: f64 = 1e-10;

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

impl<const N: usize> Progress<N> {
    /// The first guard in a step from the present state to `x` at `end` that becomes negative, and when. `guards` are
    /// those at its beginning, if they are known, and become those at its end.
    pub(crate) fn first_event<const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        guards: &mut Option<[f64; G]>,
        step: &mut DenseOutput<N>,
        end: f64,
        x: &[f64; N],
    ) -> Option<(Event, f64)> {
        let span = Span { start: step.start, width: step.width, end };
        let begin = guards.unwrap_or_else(|| system.guards(span.start, &self.x));
        let (middle, last) = (system.guards(span.when(0.5), &step.at_part(0.5)), system.guards(end, x));
        let end_guards = system.end_guards(end, x);
        *guards = Some(last);
        let n_guards = system.n_guards().min(G);
        let clear = stay_clear(&begin[..n_guards], &middle[..n_guards], &last[..n_guards]);
        if clear && end_guards.iter().all(|value| *value >= 0.0) {
            return None;
        }
        self.closer_look(system, step, &span, &[begin, middle, last], &end_guards)
    }

    /// The same where a guard may have crossed, by the guards at the beginning, in the middle and at the end.
    #[inline(never)]
    fn closer_look<const G: usize, const E: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        step: &mut DenseOutput<N>,
        span: &Span,
        &[begin, middle, last]: &[[f64; G]; 3],
        end_guards: &[f64; E],
    ) -> Option<(Event, f64)> {
        let n_guards = system.n_guards().min(G);
        let mut guards_at =
            |theta: f64, step: &DenseOutput<N>| system.guards(span.when(theta), &step.at_part(theta));
        let mut probed = [guards_at(PROBES[0], step), middle, guards_at(PROBES[2], step), last];
        if end_guards.iter().all(|value| *value >= 0.0) && !any_may_cross(n_guards, &begin, &probed) {
            return None;
        }
        if self.refine(system, step) {
            for (guards, theta) in probed.iter_mut().zip([PROBES[0], PROBES[1], PROBES[2]]) {
                *guards = system.guards(span.when(theta), &step.at_part(theta));
            }
        }
        let by_guard =
            first_crossing(&begin, &probed, |theta| system.guards(span.when(theta), &step.at_part(theta)))
                .map(|(guard, theta)| (Event::Guard(guard), span.when(theta)));
        let by_end_guard = self.first_end_guard(system, step, span, end_guards);
        [by_guard, by_end_guard].into_iter().flatten().min_by(|(_, one), (_, other)| one.total_cmp(other))
    }

    fn first_end_guard<const G: usize, const E: usize>(
        &self,
        system: &mut impl System<N, G, E>,
        step: &DenseOutput<N>,
        span: &Span,
        after: &[f64; E],
    ) -> Option<(Event, f64)> {
        let mut first: Option<(Event, f64)> = None;
        for guard in (0..E).filter(|guard| after[*guard] < 0.0) {
            let before = system.end_guards(span.start, &self.x)[guard].max(0.0);
            let value_at = |theta: f64| system.end_guards(span.when(theta), &step.at_part(theta))[guard];
            let theta = bracketed_root(value_at, [(0.0, before), (1.0, after[guard])], END_GUARD_RESOLUTION);
            first = earlier(first, (Event::EndGuard(guard), span.when(theta)));
        }
        first
    }
}

/// Of two at the same instant the one that is known already.
fn earlier(known: Option<(Event, f64)>, other: (Event, f64)) -> Option<(Event, f64)> {
    known.filter(|(_, at)| *at <= other.1).or(Some(other))
}
