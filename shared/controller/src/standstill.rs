//! How long an axis has stood where it is.
//!
//! A rod on its stop creeps on by a count now and then while the pressure on it rises, and dither shakes it. So
//! standing still is a distance from where it stood, not a step of zero.

/// Where an axis stands, and since when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Standstill {
    at: i32,
    /// The number of samples, or the sum of efforts.
    sum: u32,
}

impl Standstill {
    /// Takes the position at a sample. Returns for how many samples before it the axis has stood within `tolerance`
    /// counts.
    pub fn at(&mut self, position: i32, tolerance: u32) -> u32 {
        self.pushed(position, tolerance, 1)
    }

    /// The same for an axis that is pushed: the sum of `effort` over the samples that it has stood.
    pub fn pushed(&mut self, position: i32, tolerance: u32, effort: u32) -> u32 {
        if position.abs_diff(self.at) <= tolerance {
            self.sum = self.sum.saturating_add(effort);
        } else {
            *self = Standstill { at: position, sum: 0 };
        }
        self.sum
    }

    /// The axis stands at `position` from this sample on.
    pub fn restart(&mut self, position: i32) {
        *self = Standstill { at: position, sum: 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_stands_until_it_is_further_from_where_it_stood() {
        let mut standstill = Standstill::default();
        standstill.restart(100);
        let seen = [100, 103, 97, 103, 104, 104, 102, 108].map(|position| standstill.at(position, 3));
        assert_eq!(seen, [1, 2, 3, 4, 0, 1, 2, 0]);
    }
}
