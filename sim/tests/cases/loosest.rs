//! The cases that docs/explanation/speed.md compares with a specialised program, each with the loosest tolerance, of one, two, three,
//! five and seven times a power of ten, that keeps the whole run within that program's 1e-6 m and 10 Pa.

pub const LOOSEST: [(&str, f64); 6] = [
    ("A_closed", 5e-6),
    ("A_open_quarter", 3e-5),
    ("A_open_taulag", 7e-5),
    ("B_open_nodither", 7e-6),
    ("B_open_dither", 1e-7),
    ("B_closed_damped", 1e-8),
];
