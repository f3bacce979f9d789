//! Settings that tests of several components share.

/// A load that nothing rubs.
pub const NO_FRICTION: [&str; 5] = [
    "load.viscous_n_s_per_m=0",
    "load.static_extend_n=0",
    "load.coulomb_extend_n=0",
    "load.static_retract_n=0",
    "load.coulomb_retract_n=0",
];
