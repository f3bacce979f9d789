//! Draws from a seeded generator.

use rand_chacha::rand_core::Rng;

/// An even draw from 0 to 1 with 53 bits.
pub fn unit_interval(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}
