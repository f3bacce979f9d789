//! The part of a lagged tube's drop that follows the flow at once.

use crate::component::air::GasState;
use crate::component::tubing::{FarEnd, Tube};

/// The part of a lagged tube's drop that follows the flow at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Following {
    pub source: GasState,
    pub tube: Tube,
    pub part: f64,
}

impl Following {
    /// w at the valve's end, for the w that the rest has come to.
    pub fn far_end(&self, lagged: f64, temperature: f64, total: f64) -> FarEnd {
        let settled = self.tube.far_end(&GasState { temperature, ..self.source }, total);
        let exner = lagged * libm::pow(settled.exner / lagged, self.part);
        FarEnd { exner, by_flow: self.part * exner * settled.by_flow / settled.exner }
    }
}
