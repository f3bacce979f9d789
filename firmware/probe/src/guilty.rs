//! One of each thing that the probe looks for.

probes! {
    probe_guilty_float(value: f32) -> f32 = value * 1.5;
    probe_guilty_soft_float(value: f64) -> f64 = value * 1.5;
    probe_guilty_index(values: &[i32], index: usize) -> i32 = values[index];
    probe_guilty_division(value: u64, divisor: core::num::NonZeroU64) -> u64 = value / divisor;
    probe_guilty_recursion(value: u32) -> u32 =
        if value == 0 { 1 } else { value.rotate_left(probe_guilty_recursion(value - 1)) };
    probe_guilty_call(call: fn(u32) -> u32, value: u32) -> u32 = call(value).wrapping_add(1);
}
