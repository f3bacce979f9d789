//! A stuck spool: its operator still accepts requests, but does not move.

use super::{Operator, Request, SpoolState};

/// An operator whose spool is stuck.
#[derive(Clone, Debug)]
pub struct Stuck {
    /// m.
    position: f64,
    operator: Box<Operator>,
}

impl Stuck {
    pub(super) fn new(position: f64, operator: Operator) -> Stuck {
        Stuck { position, operator: Box::new(operator) }
    }

    pub(super) fn hold(&mut self, position: f64) {
        self.position = position;
    }

    pub(super) fn drive(&mut self, t: f64, spool: SpoolState, request: Request, flow_force: f64) {
        self.operator.drive(t, spool, request, flow_force);
    }

    pub(super) fn follow(&mut self, counts: f64) {
        self.operator.follow(counts);
    }

    pub(super) fn commanded(&self) -> f64 {
        self.operator.commanded()
    }

    pub(super) fn position(&self) -> f64 {
        self.position
    }
}
