//! Locates where a guard becomes negative in a step or in a span of time.

use crate::root::bracketed_root;

/// Places inside a step at which guards are evaluated, so that one that dips below zero and comes
/// back is seen.
pub const PROBES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// Part of a step to which a zero is located.
const RESOLUTION: f64 = 1e-13;

/// How often the way to the first probe is halved in search of a guard that leaves zero and comes back.
/// A body that rebounds from a hard stop may be back within a nanosecond.
const DEPARTURES: u32 = 40;

/// Guards at [`PROBES`].
pub type Probed<const G: usize> = [[f64; G]; PROBES.len()];

/// The first of several guards to become negative, and the place where it does.
pub fn first_crossing<const G: usize>(
    begin: &[f64; G],
    probed: &Probed<G>,
    mut guards_at: impl FnMut(f64) -> [f64; G],
) -> Option<(usize, f64)> {
    let mut first: Option<(usize, f64)> = None;
    for guard in 0..G {
        let values = values_of(guard, begin, probed);
        if may_cross(&values)
            && let Some(place) = first_negative(&values, &mut |theta| guards_at(theta)[guard])
        {
            // Of two at the same place the one that is known already.
            first = first.filter(|(_, earlier)| *earlier <= place).or(Some((guard, place)));
        }
    }
    first
}

/// A guard that stays farther from zero than this many times its change in a step needs no closer look.
const CLEAR: f64 = 2.0;

/// Whether all guards stay clear of zero, by their values at the beginning, in the middle and at the end.
pub(crate) fn stay_clear(begin: &[f64], middle: &[f64], end: &[f64]) -> bool {
    begin.iter().zip(middle).zip(end).all(|((&one, &two), &three)| {
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let (least, most) = (smaller(smaller(one, two), three), larger(larger(one, two), three));
        least > CLEAR * (most - least)
    })
}

/// Whether one of the first `n_guards` guards may become negative at all.
pub(crate) fn any_may_cross<const G: usize>(n_guards: usize, begin: &[f64; G], probed: &Probed<G>) -> bool {
    (0..n_guards.min(G)).any(|guard| may_cross(&values_of(guard, begin, probed)))
}

/// A guard at the beginning and at [`PROBES`].
fn values_of<const G: usize>(guard: usize, begin: &[f64; G], probed: &Probed<G>) -> [f64; 5] {
    [begin[guard], probed[0][guard], probed[1][guard], probed[2][guard], probed[3][guard]]
}

/// The first place in a step at which a guard with these values at 0 and [`PROBES`] becomes negative.
fn first_negative(values: &[f64; 5], value_at: &mut impl FnMut(f64) -> f64) -> Option<f64> {
    let place = |i: usize| if i == 0 { 0.0 } else { PROBES[i - 1] };
    for i in 1..values.len() {
        let (before, here) = (values[i - 1], values[i]);
        if here < 0.0 {
            let left = if before > 0.0 { (place(i - 1), before) } else { departure(place(i), value_at) };
            return Some(bracketed_root(value_at, [left, (place(i), here)], RESOLUTION));
        }
        if i + 1 < values.len()
            && let Some(dip) = dip_between(before, here, values[i + 1])
        {
            let theta = place(i) + dip * (PROBES[1] - PROBES[0]);
            let value = value_at(theta);
            if value < 0.0 {
                let left = if dip < 0.0 { i - 1 } else { i };
                let left = match values[left] {
                    before if before > 0.0 => (place(left), before),
                    _ => departure(theta, value_at),
                };
                return Some(bracketed_root(value_at, [left, (theta, value)], RESOLUTION));
            }
        }
    }
    None
}

/// Whether a guard with these values may become negative at all.
#[inline]
fn may_cross(values: &[f64; 5]) -> bool {
    let dips = |three: &[f64]| dip_between(three[0], three[1], three[2]).is_some();
    values[1..].iter().any(|value| *value < 0.0) || values.windows(3).any(dips)
}

/// A guard that begins at zero (a body that has just broken away) is not crossed there. Returns a place before
/// `probe` at which it is positive, and its value; the beginning of the step if there is none, because then the mode
/// does not hold at all.
fn departure(probe: f64, value_at: &mut impl FnMut(f64) -> f64) -> (f64, f64) {
    let nearer = (1..=DEPARTURES).map(|halvings| probe / (1_u64 << halvings) as f64);
    nearer.map(|theta| (theta, value_at(theta))).find(|(_, value)| *value > 0.0).unwrap_or((0.0, 0.0))
}

/// Where a parabola through three evenly spaced values dips below zero between them, in spacings
/// from the middle one, if it does.
#[inline]
fn dip_between(before: f64, middle: f64, after: f64) -> Option<f64> {
    let curvature = before - 2.0 * middle + after;
    let slope = 0.5 * (after - before);
    let between = curvature > 0.0 && slope.abs() < curvature;
    let below = || after >= 0.0 && 2.0 * middle * curvature < slope * slope;
    (between && below()).then(|| -slope / curvature)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Leaves zero, is negative from 0.02 to 0.2 and has come back at the first probe: a body that rebounds from
    /// its stop, falls back and is thrown off.
    fn rebound(theta: f64) -> [f64; 1] {
        [theta * (0.02 - theta) * (0.2 - theta)]
    }

    #[test]
    fn a_guard_that_leaves_zero_and_dips_before_the_first_probe_is_crossed_where_it_dips() {
        let (guard, at) = first_crossing(&rebound(0.0), &PROBES.map(rebound), rebound).expect("a crossing");
        assert!(guard == 0 && (at - 0.02).abs() < 1e-12, "{at}");
    }
}
