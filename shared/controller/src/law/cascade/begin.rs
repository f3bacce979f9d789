//! How a run begins: with a load that is taken to be at rest, until the second sample tells whether it moves.

use super::doubt::Doubt;
use super::flow::Flow;
use super::kept::{Kept, Learned};
use super::lag::Lag;
use super::load::Load;
use super::motion::Motion;
use super::number::within;
use super::{Cascade, Phase, Settings};
use crate::fault::Fault;
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
    #[cold]
    #[inline(never)]
    pub(super) fn begin_at(&mut self, settings: &Settings, count: i32, force: i32) {
        let Learned { looseness, .. } = settings.kept.learned;
        self.load = Load::new(&settings.load, &settings.kept.learned);
        self.motion = Motion::new(count, force, &self.load, settings.load.stiction);
        self.flow = Flow::new(force);
        self.lag = Lag::new(&settings.lag, &settings.kept.learned);
        self.rest.looseness = looseness.unsigned_abs();
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
        self.goes_on(settings, count, step, force);
        self.target = count.saturating_add(reference.error);
        self.set_off(settings, force);
    }

    /// A load that has moved by this step moves on.
    #[cold]
    #[inline(never)]
    fn goes_on(&mut self, settings: &Settings, count: i32, step: i32, force: i32) {
        self.load = Load::new(&settings.load, &settings.kept.learned);
        self.load.goes_on(&settings.load, step, force);
        self.motion = Motion::going(count, step, force, &self.load);
        self.flow = Flow::new(force);
        self.lag = Lag::new(&settings.lag, &settings.kept.learned);
    }

    /// What it has learned up to now; what the rig file says before the first sample.
    #[must_use]
    pub fn learned(&self) -> Learned {
        let [force, viscous] = self.load.forces();
        let (mass, friction, pace) = (self.load.mass, self.load.friction, self.lag.pace);
        let looseness = self.rest.looseness.min(4) as i32;
        Learned { mass, friction, force, viscous, pace, looseness }.bounded()
    }

    /// What is kept at the arming behind this run, with the fault that the drive is in; None: nothing, or it has not run.
    pub(crate) fn keep(&self, settings: &Settings, fault: Option<Fault>) -> Option<Kept> {
        let is_at_bound = self.load.is_at_bound() || self.lag.is_at_bound();
        let has_run = settings.keeps && self.begun != Begun::No;
        has_run.then(|| settings.kept.after(self.learned(), is_at_bound, fault))
    }

    /// What this run has learned is kept, or not: it is not asked for again.
    pub(crate) fn leave(&mut self) {
        self.begun = Begun::No;
    }
}
