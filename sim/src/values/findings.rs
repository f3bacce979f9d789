//! What is wrong with the values of a rig.

use super::Rig;
use crate::key::{Key, Typed};

/// The problems of a rig's values, each at a key.
#[derive(Debug, Default)]
pub struct Findings(pub Vec<(&'static str, String)>);

impl Findings {
    /// Notes an error at a key.
    pub fn note(&mut self, key: &Key, message: impl Into<String>) {
        self.0.push((key.path, message.into()));
    }

    /// `lower` must not be above `upper`.
    pub fn not_above(&mut self, rig: &Rig, lower: &Typed<f64>, upper: &Typed<f64>, why: &str) {
        let (low, high) = (rig.get(lower), rig.get(upper));
        if low > high {
            self.note(lower, format!("must not be above {} = {high}, is {low}: {why}", upper.path));
        }
    }

    /// `lower` must be below `upper`.
    pub fn below(&mut self, rig: &Rig, lower: &Typed<f64>, upper: &Typed<f64>, why: &str) {
        let (low, high) = (rig.get(lower), rig.get(upper));
        if low >= high {
            self.note(lower, format!("must be below {} = {high}, is {low}: {why}", upper.path));
        }
    }
}
