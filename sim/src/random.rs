//! Draws from a seeded generator.

use std::f64::consts::PI;

use rand_chacha::rand_core::Rng;

/// An even draw from 0 to 1 with 53 bits.
pub fn unit_interval(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// A normal draw (Box and Muller) with this standard deviation; nothing is drawn for 0.
#[inline(always)]
pub fn normal(random: &mut impl Rng, deviation: f64) -> f64 {
    if deviation == 0.0 { 0.0 } else { draw(random, deviation) }
}

#[inline(never)]
fn draw(random: &mut impl Rng, deviation: f64) -> f64 {
    let (radius, angle) = (1.0 - unit_interval(random), unit_interval(random));
    deviation * (-2.0 * libm::log(radius)).sqrt() * libm::cos(2.0 * PI * angle)
}
