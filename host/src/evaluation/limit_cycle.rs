//! A drive that never comes to rest swings about its setpoint: how far, and how often.

/// A swing of the position that goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitCycle {
    /// Half of the distance from its lowest to its highest position, mm.
    pub amplitude_mm: f64,
    /// Hz.
    pub frequency_hz: f64,
}

impl LimitCycle {
    /// The limit cycle in a stretch of positions, if there is one.
    ///
    /// Its swing is more than two counts, so that a drive that stands on the edge of a count has none, and
    /// it passes its middle upwards at least twice: less is a drift.
    #[must_use]
    pub fn of(time: &[f64], position: &[f64], mm_per_count: f64) -> Option<LimitCycle> {
        let low = position.iter().copied().fold(f64::INFINITY, f64::min);
        let high = position.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if position.is_empty() || high - low <= 2.5 * mm_per_count {
            return None;
        }
        let passes = passes_upwards(time, position, (low + high) / 2.0, (high - low) / 4.0);
        let (first, last) = (passes.first()?, passes.last()?);
        let cycles = passes.len() - 1;
        (cycles > 0).then(|| LimitCycle {
            amplitude_mm: (high - low) / 2.0,
            frequency_hz: cycles as f64 / (last - first),
        })
    }
}

/// When the position passes from below `middle - band` to above `middle + band`: the band keeps a jitter
/// about the middle from being counted.
fn passes_upwards(time: &[f64], position: &[f64], middle: f64, band: f64) -> Vec<f64> {
    let mut below = false;
    let mut passes = Vec::new();
    for (&time, &position) in time.iter().zip(position) {
        if position < middle - band {
            below = true;
        } else if position > middle + band && below {
            below = false;
            passes.push(time);
        }
    }
    passes
}
