//! The built-in rigs.

use crate::values::Rig;

/// Name and file of each built-in rig.
pub const BUILTIN: &[(&str, &str)] = &[
    ("servo-a", include_str!("../../rigs/servo-a.toml")),
    ("servo-a-tuned", include_str!("../../rigs/servo-a-tuned.toml")),
    ("servo-b", include_str!("../../rigs/servo-b.toml")),
    ("servo-b-thesis", include_str!("../../rigs/servo-b-thesis.toml")),
    ("servo-b-tuned", include_str!("../../rigs/servo-b-tuned.toml")),
    ("servo-c", include_str!("../../rigs/servo-c.toml")),
    ("servo-c-tuned", include_str!("../../rigs/servo-c-tuned.toml")),
    ("lut-stepper", include_str!("../../rigs/lut-stepper.toml")),
    ("lut-solenoid", include_str!("../../rigs/lut-solenoid.toml")),
    ("burrows", include_str!("../../rigs/burrows.toml")),
    ("bang-bang", include_str!("../../rigs/bang-bang.toml")),
    ("press", include_str!("../../rigs/press.toml")),
];

/// The file of a built-in rig.
#[must_use]
pub fn builtin(name: &str) -> Option<&'static str> {
    BUILTIN.iter().find(|(builtin, _)| *builtin == name).map(|(_, text)| *text)
}

impl Rig {
    /// A built-in rig.
    #[must_use]
    pub fn builtin(name: &str) -> Option<Rig> {
        builtin(name).map(|text| Rig::read(name, text).unwrap_or_else(|problems| panic!("{problems}")))
    }
}
