//! A move with its profile as plain little endian bytes: in a change, and in what a rig tells of its test.
//!
//! | kind | numbers |
//! |---|---|
//! | 0 step | |
//! | 1 ramp | the three lengths over which a step is averaged, samples |
//! | 2 wave | amplitude (counts, signed), samples, turns from the first sample to the second (2^-64, low word first), their increase from sample to sample (the same, signed) |
//! | 3 noise | amplitude (counts, signed), samples, samples that a sign lasts, taps of the shift register |

/// The most numbers of a profile.
pub const NUMBERS: usize = 6;

/// The kind that stands for no move: the place of a move record is empty.
pub const NO_MOVE: u8 = 255;

/// A move; which numbers there are depends on its kind, the others are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProfiledMove {
    /// In force from this sample on.
    pub at_sample: u32,
    /// Setpoint (open loop: command), counts.
    pub target: i32,
    /// Kind of the profile.
    pub kind: u8,
    /// What it is made of.
    pub numbers: [u32; NUMBERS],
}

impl ProfiledMove {
    /// Bytes of a move.
    pub const BYTES: usize = 4 * (2 + NUMBERS) + 1;

    /// The bytes: first sample, target, numbers, kind.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; ProfiledMove::BYTES] {
        let [a, b, c, d, e, f] = self.numbers;
        let all = [self.at_sample, self.target as u32, a, b, c, d, e, f];
        let mut bytes = [self.kind; ProfiledMove::BYTES];
        for (slot, word) in bytes.as_chunks_mut().0.iter_mut().zip(all) {
            *slot = word.to_le_bytes();
        }
        bytes
    }

    /// The move of these bytes; None if they are more or fewer.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<ProfiledMove> {
        let (slots, &[kind]) = bytes.as_chunks() else { return None };
        let &[at_sample, target, a, b, c, d, e, f] = slots else { return None };
        let numbers = [a, b, c, d, e, f].map(u32::from_le_bytes);
        let (at_sample, target) = (u32::from_le_bytes(at_sample), i32::from_le_bytes(target));
        Some(ProfiledMove { at_sample, target, kind, numbers })
    }
}
