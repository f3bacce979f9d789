//! How a run begins: with a load that is taken to be at rest, until the second sample tells whether it moves.

use super::doubt::Doubt;
use super::flow::Flow;
use super::lag::Lag;
use super::load::Load;
use super::motion::Motion;
use super::number::within;
use super::{Cascade, Phase, Settings};
use crate::law::Reference;

/// How far a run has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Begun {
    /// It has seen no sample.
    No,
    /// It has seen one, from which it takes the load to be at rest.
    Once,
    /// The step from that to the second has told.
    Yes,
}

impl Cascade {
    /// The first sample: the load is at rest, and held by the force of the pressures.
    pub(super) fn begin_at(&mut self, settings: &Settings, count: i32, force: i32) {
        self.load = Load::new(&settings.load);
        self.motion = Motion::new(count, force, &self.load, settings.load.stiction);
        self.flow = Flow::new(force);
        self.lag = Lag::new(&settings.lag);
        self.doubt = Doubt::new(force);
        (self.begun, self.target) = (Begun::Once, count);
        self.rest.begin(count);
        // What holds it is not known before it has moved.
        self.phase = Phase::Rest { held: force, centre: force };
    }

    /// The second sample of a run. A load that has gone two counts in it, and faster than a valve moves a load from rest, moved before:
    /// by all that a sample tells, it goes on as it has.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_again(&mut self, settings: &Settings, count: i32, reference: &Reference, force: i32) {
        self.begun = Begun::Yes;
        let step = count.saturating_sub(self.motion.count());
        let speed = within(step, 1 << 14) << 16;
        if step.unsigned_abs() < 2 || speed.saturating_abs() < settings.moving {
            return;
        }
        self.load = Load::in_motion(&settings.load, step, force);
        self.motion = Motion::going(count, step, force, &self.load);
        self.flow = Flow::new(force);
        self.lag = Lag::new(&settings.lag);
        self.target = count.saturating_add(reference.error);
        self.set_off(settings, force);
    }
}
