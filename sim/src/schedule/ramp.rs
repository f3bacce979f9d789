//! The lengths of a ramp within limits, rounded here once to whole samples.
//!
//! The closed forms of the time-optimal profile over a distance d, from rest to rest, with limits v, a and j of velocity,
//! acceleration and jerk. The velocity rises for Ta + Tj and falls for the same time; Tv is the time at its mean:
//!
//! ```text
//! trapezoid:  Tv = max(d/v, sqrt(d/a)),   Ta = d/(a Tv)
//! S-curve:    Tj = min(a/j, sqrt(v/j)),   Ta = max(v/a, sqrt(v/j)),   Tv = d/v       where Tv >= Ta + Tj, else Tv = Ta + Tj:
//!             Tj = a/j,                   Ta = (sqrt(Tj^2 + 4 d/a) - Tj)/2           where Ta >= Tj, else
//!             Ta = Tj = cbrt(d/(2 j))
//! T = Tv + Ta + Tj
//! ```
//!
//! A ramp of V, A and J samples ([`pneudrive_controller::profile`]) takes V + A + J - 2. The lengths are the fewest
//! samples that are within all limits and not below T; if necessary V is lengthened.

/// Limits of a setpoint's motion, in counts and samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub velocity: f64,
    pub acceleration: f64,
    /// None: a trapezoid.
    pub jerk: Option<f64>,
}

impl Limits {
    /// Tv, Ta and Tj of the time-optimal profile, samples.
    pub fn shortest(&self, distance: f64) -> [f64; 3] {
        let Limits { velocity, acceleration, jerk } = *self;
        let Some(jerk) = jerk else {
            let at_mean = (distance / velocity).max((distance / acceleration).sqrt());
            return [at_mean, if at_mean > 0.0 { distance / (acceleration * at_mean) } else { 0.0 }, 0.0];
        };
        let least = (velocity / jerk).sqrt();
        let [ta, tj] = [(velocity / acceleration).max(least), (acceleration / jerk).min(least)];
        if distance / velocity >= ta + tj {
            return [distance / velocity, ta, tj];
        }
        let tj = acceleration / jerk;
        let ta = 0.5 * ((tj * tj + 4.0 * distance / acceleration).sqrt() - tj);
        if ta >= tj {
            return [ta + tj, ta, tj];
        }
        let both = (distance / (2.0 * jerk)).cbrt();
        [2.0 * both, both, both]
    }

    /// V, A and J of a ramp, samples.
    pub fn lengths(&self, distance: f64) -> [f64; 3] {
        if distance == 0.0 {
            return [1.0; 3];
        }
        let [tv, ta, tj] = self.shortest(distance);
        let near = |time: f64| (0..4).map(move |more| (time.floor() - 1.0 + f64::from(more)).max(1.0));
        let jerks: Vec<f64> = if self.jerk.is_some() { near(tj).collect() } else { vec![1.0] };
        let pairs = near(ta).flat_map(|a| jerks.iter().map(move |&j| [a, j])).filter(|[a, j]| a >= j);
        let all = pairs.map(|[a, j]| [self.least_velocity_samples(distance, a, j), a, j]);
        let samples = |lengths: &[f64; 3]| lengths.iter().sum::<f64>() - 2.0;
        // Of equal ones that with the gentlest jerk.
        let key = |lengths: &[f64; 3]| (samples(lengths), -lengths[2]);
        let best = all.min_by(|x, y| key(x).partial_cmp(&key(y)).unwrap_or(std::cmp::Ordering::Equal));
        let [v, a, j] = best.unwrap_or([1.0; 3]);
        let short = up(tv + ta + tj) - samples(&[v, a, j]);
        [v + short.max(0.0), a, j]
    }

    /// The least V within all limits beside A and J.
    fn least_velocity_samples(&self, distance: f64, a: f64, j: f64) -> f64 {
        let of_jerk = self.jerk.map_or(0.0, |jerk| distance / (jerk * a * j));
        let apart = if self.jerk.is_some() { a + j } else { a };
        up(distance / self.velocity).max(up(distance / (self.acceleration * a))).max(up(of_jerk)).max(apart)
    }
}

/// Rounded up, but ignoring the rounding error of the arithmetic.
pub(super) fn up(samples: f64) -> f64 {
    (samples - 1e-9 * samples.max(1.0)).ceil()
}
