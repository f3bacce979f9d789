//! Which bytes lie in a range of a flash.

use core::ops::Range;

/// Whether so many bytes from an offset on all lie within a range.
#[must_use]
pub fn contains(range: &Range<u32>, offset: u32, bytes: usize) -> bool {
    let behind = u32::try_from(bytes).ok().and_then(|bytes| offset.checked_add(bytes));
    offset >= range.start && behind.is_some_and(|behind| behind <= range.end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{nucleo, pico2};

    #[test]
    fn the_first_and_the_last_bytes_of_what_is_kept_lie_within_it_and_no_byte_beside_it_does() {
        for kept in [nucleo::flash::KEPT, pico2::flash::KEPT] {
            let within = |offset| contains(&kept, offset, 32);
            assert!(within(kept.start) && within(kept.end - 32));
            assert!(!within(kept.start - 1) && !within(kept.end - 31) && !within(u32::MAX));
        }
    }
}
