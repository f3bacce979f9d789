//! The unit of a key or of a column, from the ending of its name.

/// Endings of names and the units they stand for, longer ones first.
const UNITS: &[(&str, &str)] = &[
    ("_j_per_kg_k", "J/(kg K)"),
    ("_w_per_m2_k", "W/(m2 K)"),
    ("_mm_per_h", "mm/h"),
    ("_mm_s3", "mm/s3"),
    ("_mm_s2", "mm/s2"),
    ("_mm_s", "mm/s"),
    ("_m_s2", "m/s2"),
    ("_m3_per_s_pa", "m3/(s Pa)"),
    ("_per_mass_per_s2", "1/s2"),
    ("_n_s_per_m", "N s/m"),
    ("_n_per_mm", "N/mm"),
    ("_n_per_m", "N/m"),
    ("mm_per_count", "mm/count"),
    ("mm_per_step", "mm/step"),
    ("_per_s", "1/s"),
    ("_percent", "%"),
    ("_samples", "samples"),
    ("_counts", "counts"),
    ("_kg_s", "kg/s"),
    ("_m_s", "m/s"),
    ("_kpa", "kPa"),
    ("_mpa", "MPa"),
    ("_bar", "bar"),
    ("_psi", "psi"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_cm", "cm"),
    ("_mm", "mm"),
    ("_um", "um"),
    ("_m3", "m3"),
    ("_l", "l"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_s", "s"),
    ("_n", "N"),
    ("_k", "K"),
    ("_c", "C"),
    ("_m", "m"),
    ("_g", "g"),
];

/// The part of a name before its unit, and the unit ("" for none).
#[must_use]
pub fn unit(name: &str) -> (&str, &'static str) {
    UNITS
        .iter()
        .find_map(|(ending, unit)| name.strip_suffix(ending).map(|stem| (stem, *unit)))
        .unwrap_or((name, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_from_names() {
        assert_eq!(unit("pressure_pa"), ("pressure", "Pa"));
        assert_eq!(unit("residual_volume_1_m3"), ("residual_volume_1", "m3"));
        assert_eq!(unit("gas_constant_j_per_kg_k"), ("gas_constant", "J/(kg K)"));
        assert_eq!(unit("law"), ("law", ""));
        assert_eq!(unit("max_speed_m_s"), ("max_speed", "m/s"));
        assert_eq!(unit("null_drift_mm_per_h"), ("null_drift", "mm/h"));
        assert_eq!(unit("velocity_mm_s"), ("velocity", "mm/s"));
        assert_eq!(unit("acceleration_m_s2"), ("acceleration", "m/s2"));
        assert_eq!(unit("jerk_mm_s3"), ("jerk", "mm/s3"));
    }
}
