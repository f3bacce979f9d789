//! The event-driven integrator: explicit Runge-Kutta with dense output, discontinuities located
//! exactly.
//!
//! A [`Hybrid`] system is smooth as long as its modes stay. What ends a smooth stretch is known in
//! two ways: events known beforehand ([`Hybrid::ahead`]), at which a step is made to end,
//! and guards ([`Hybrid::guards`]) that become negative when a mode no longer holds; their zero is
//! located on the dense output of the step. Between a step's ends the state can be read at any time,
//! so a sample costs no step. Where an event leaves dx/dt as it was, the next step has its first slope already.
//!
//! Methods: Dormand-Prince 5(4) with its interpolant of order 4 (Hairer, Norsett, Wanner, Solving
//! Ordinary Differential Equations I, II.5 and II.6), and Merson 4(3), the thesis's, with cubic
//! Hermite interpolation. Stiff stretches (`integrator/stiffness.rs`) go by the implicit RODAS 4(3)
//! (`integrator/implicit.rs`).

pub(crate) mod crossing;
mod explicit;
mod implicit;
mod linear;
mod pace;
mod search;
mod segment;
mod stiffness;
mod tableau;

use pace::Pace;
use segment::{REFINED_AT, Segment, Taken};
use stiffness::Stiffness;
use tableau::Tableau;

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Dormand-Prince 5(4): the default.
    #[default]
    DormandPrince,
    /// Runge-Kutta-Merson 4(3), as in the thesis.
    Merson,
}

/// A system of N states, smooth between events, with G guards read from the state alone and F that
/// need its flows.
pub trait Hybrid<const N: usize, const G: usize, const F: usize> {
    /// dx/dt in the present modes; must be smooth a little beyond them.
    fn derivative(&mut self, t: f64, x: &[f64; N]) -> [f64; N];
    /// Not negative as long as the present modes hold; looked at inside a step as well.
    fn guards(&mut self, t: f64, x: &[f64; N]) -> [f64; G];
    /// The same for guards that are dear; looked at the ends of a step only.
    fn flow_guards(&mut self, t: f64, x: &[f64; N]) -> [f64; F];
    /// The next instant after `t` at which the system changes of itself.
    fn next_instant(&self, t: f64) -> f64;
    /// The longest step (s) that meets all that guards do.
    fn longest_step(&self) -> f64 {
        f64::INFINITY
    }
    /// Differences of derivatives are about to be taken, or no more: they ask for all the digits that
    /// there are.
    fn sharpen(&mut self, _sharp: bool) {}
    /// A step of `h` seconds is about to be tried: an error of dx/dt counts `h` times.
    fn try_step(&mut self, _h: f64) {}
    /// What is known of the time after `t`.
    fn ahead(&mut self, t: f64, _x: &[f64; N]) -> Ahead {
        Ahead { until: self.next_instant(t), event: Some(Event::Instant) }.within(t + self.longest_step())
    }
    /// Whether something swings in the present modes: then steps are shorter, and their size is remembered apart.
    fn swings(&self) -> bool {
        false
    }
    /// Whether no state but the first ones, the core of the system, moves in the present modes.
    fn core_alone(&self) -> bool {
        false
    }
    /// Changes modes (and state, where a velocity becomes zero) at an event; tells what that makes of dx/dt.
    fn cross(&mut self, event: Event, t: f64, x: &mut [f64; N]) -> Slope;
}

/// How far a step may go, and the event that awaits it there, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ahead {
    /// When.
    pub until: f64,
    /// What happens then.
    pub event: Option<Event>,
}

impl Ahead {
    /// The same, but no farther than to `until`.
    #[must_use]
    pub fn within(self, until: f64) -> Ahead {
        if until < self.until { Ahead { until, event: None } } else { self }
    }
}

/// What a change of modes makes of dx/dt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// It is what it was: it goes on with another curvature.
    Kept,
    /// It may have jumped.
    Lost,
}

/// What ended a smooth stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// An instant at which the system changes of itself.
    Instant,
    /// The guard of this number.
    Guard(usize),
    /// The flow guard of this number.
    FlowGuard(usize),
}

/// Counts of the work done. A slower program shows here without a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Accepted steps.
    pub steps: u64,
    /// Steps taken again with a smaller size.
    pub rejected: u64,
    /// Evaluations of the right-hand side.
    pub evaluations: u64,
    /// Times the method began anew: after events and jumps of the command that leave no slope to go on with.
    pub restarts: u64,
    /// Events of all kinds.
    pub events: u64,
}

/// Why a run cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The state is no longer a number.
    #[error(
        "the state stopped being a number at t = {at_s} s: a parameter is far outside of what the equations hold for"
    )]
    NotANumber {
        /// When.
        at_s: f64,
    },
    /// The step size fell to nothing.
    #[error(
        "the step size fell below {step_s:.1e} s at t = {at_s} s: the rig is too stiff for these methods"
    )]
    StepTooSmall {
        /// When.
        at_s: f64,
        /// The step that would have been needed.
        step_s: f64,
    },
    /// The steps are so small that the run would take for ever.
    #[error(
        "a millisecond takes more than {MOST_STEPS} steps at t = {at_s} s: the rig is too stiff for these methods"
    )]
    NoProgress {
        /// When.
        at_s: f64,
    },
    /// Events follow each other without end.
    #[error("events pile up at t = {at_s} s: two modes hand over to each other without end")]
    EventsPileUp {
        /// When.
        at_s: f64,
    },
}

/// Smallest step, s: below it rounding of the time is felt.
const SMALLEST_STEP: f64 = 1e-13;

/// Most events within [`SMALLEST_STEP`] of each other.
const MOST_EVENTS_AT_ONCE: u32 = 64;

/// Most steps within a [`STRETCH`], tried or accepted: then a second takes a quarter of an hour.
const MOST_STEPS: u64 = 200_000;

/// s.
const STRETCH: f64 = 1e-3;

/// The state of an integration. While all states but the first CORE rest, explicit steps leave the others alone.
#[derive(Clone, Debug)]
pub struct Integrator<const N: usize, const G: usize, const F: usize, const CORE: usize = N> {
    tableau: &'static Tableau,
    /// Allowed error of a step, in each state's scale.
    tolerance: f64,
    /// What counts as large in each state.
    scale: [f64; N],
    t: f64,
    x: [f64; N],
    /// dx/dt at t, if it is known in the present modes.
    slope: Option<[f64; N]>,
    /// The guards at t, if they are known in the present modes.
    guards: Option<[f64; G]>,
    /// The step that led to t.
    segment: Option<Segment<N>>,
    /// The state that was asked for last, as long as it is what it was.
    read: Option<(f64, [f64; N])>,
    /// What happens at t, if it has not been taken yet.
    pending: Option<Event>,
    /// The step size that the error asks for.
    wanted: f64,
    /// The same where the system swings while now it does not, or the other way about.
    wanted_otherwise: f64,
    swings: bool,
    pace: Pace,
    events_at_once: (u32, f64),
    stiffness: Stiffness,
    /// When the present [`STRETCH`] began, and the steps tried until then.
    stretch: (f64, u64),
    /// What it has cost so far.
    pub work: Work,
}

impl<const N: usize, const G: usize, const F: usize> Integrator<N, G, F, N> {
    /// An integration from `x` at t = 0. A step's error may be `tolerance` times the larger of a
    /// state and its `scale`.
    #[must_use]
    pub fn new(method: Method, tolerance: f64, scale: [f64; N], x: [f64; N]) -> Self {
        Integrator::with_core(method, tolerance, scale, x)
    }
}

impl<const N: usize, const G: usize, const F: usize, const CORE: usize> Integrator<N, G, F, CORE> {
    /// The same of a system of which at times the first CORE states move alone.
    #[must_use]
    pub fn with_core(method: Method, tolerance: f64, scale: [f64; N], x: [f64; N]) -> Self {
        Integrator {
            tableau: tableau::of(method),
            tolerance,
            scale,
            t: 0.0,
            x,
            slope: None,
            guards: None,
            segment: None,
            read: None,
            pending: None,
            wanted: 1e-5,
            wanted_otherwise: 1e-5,
            swings: false,
            pace: Pace::default(),
            events_at_once: (0, 0.0),
            stiffness: Stiffness::default(),
            stretch: (0.0, 0),
            work: Work::default(),
        }
    }

    /// The state at `t`, which must lie in the last step of [`Integrator::run_to`].
    #[must_use]
    pub fn state(&mut self, t: f64) -> [f64; N] {
        if let Some((at, x)) = self.read
            && at == t
        {
            return x;
        }
        let x = match &self.segment {
            Some(segment) if t < self.t => segment.at(t),
            _ => self.x,
        };
        self.read = Some((t, x));
        x
    }

    /// The slope of one state at `t`, as in [`Integrator::state`]; None where it may have jumped.
    #[must_use]
    pub fn slope(&self, t: f64, state: usize) -> Option<f64> {
        match &self.segment {
            Some(segment) => Some(segment.slope_at(t.min(self.t), state)),
            None => self.slope.map(|slope| slope[state]),
        }
    }

    /// Integrates to `t`, or a little beyond it, but not beyond `horizon`; takes every event up to
    /// and at `t`.
    ///
    /// # Errors
    /// When the state is no longer a number, or steps or events pile up.
    pub fn run_to(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        t: f64,
        horizon: f64,
    ) -> Result<(), IntegrationError> {
        loop {
            if self.t <= t
                && let Some(event) = self.pending.take()
            {
                self.take(system, event)?;
            } else if self.t < t {
                self.step(system, horizon.max(t))?;
            } else {
                return Ok(());
            }
        }
    }

    /// Ends the last step at `t`, because the system is changed from outside there. `change` is
    /// given the system and its state.
    pub fn cut<S: Hybrid<N, G, F>>(
        &mut self,
        system: &mut S,
        t: f64,
        change: impl FnOnce(&mut S, &mut [f64; N]) -> Slope,
    ) {
        if t < self.t {
            if let Some(mut segment) = self.segment.take() {
                self.refine(system, &mut segment);
                self.x = segment.at(t);
            }
            self.pending = None;
            self.slope = None;
        }
        self.t = t;
        let slope = change(system, &mut self.x);
        self.restart(slope, system.swings());
    }

    /// Makes a step that is left before its end as exact inside as it is there; tells whether that is new.
    fn refine(&mut self, system: &mut impl Hybrid<N, G, F>, segment: &mut Segment<N>) -> bool {
        let new = !segment.refined;
        if new {
            let slopes = REFINED_AT
                .map(|part| system.derivative(segment.start + part * segment.width, &segment.at_part(part)));
            self.work.evaluations += 2;
            segment.refine(&slopes);
        }
        new
    }

    fn restart(&mut self, slope: Slope, swings: bool) {
        if swings != self.swings {
            self.swings = swings;
            std::mem::swap(&mut self.wanted, &mut self.wanted_otherwise);
        }
        self.segment = None;
        self.read = None;
        self.guards = None;
        self.pace = Pace::default();
        if slope == Slope::Lost {
            self.slope = None;
        }
        self.work.restarts += u64::from(self.slope.is_none());
    }

    fn take(&mut self, system: &mut impl Hybrid<N, G, F>, event: Event) -> Result<(), IntegrationError> {
        let (count, since) = self.events_at_once;
        self.events_at_once = if self.t - since < SMALLEST_STEP { (count + 1, since) } else { (0, self.t) };
        if self.events_at_once.0 > MOST_EVENTS_AT_ONCE {
            return Err(IntegrationError::EventsPileUp { at_s: self.t });
        }
        let slope = system.cross(event, self.t, &mut self.x);
        self.work.events += 1;
        self.restart(slope, system.swings());
        Ok(())
    }

    fn count_step(&mut self) -> Result<(), IntegrationError> {
        let (since, before) = self.stretch;
        let tried = self.work.steps + self.work.rejected;
        if self.t - since >= STRETCH {
            self.stretch = (self.t, tried);
        } else if tried - before > MOST_STEPS {
            return Err(IntegrationError::NoProgress { at_s: self.t });
        }
        Ok(())
    }

    /// One accepted step, ended at the first event in it.
    fn step(&mut self, system: &mut impl Hybrid<N, G, F>, horizon: f64) -> Result<(), IntegrationError> {
        self.count_step()?;
        system.sharpen(self.stiffness.implicit);
        let ahead = system.ahead(self.t, &self.x);
        if ahead.until <= self.t && ahead.event.is_some() {
            self.pending = ahead.event;
            return Ok(());
        }
        let limit = ahead.until.min(horizon);
        let slope = match self.slope {
            Some(slope) => slope,
            None => {
                self.work.evaluations += 1;
                system.derivative(self.t, &self.x)
            }
        };
        // No step is short enough for a slope that is no number.
        if !slope.iter().all(|rate| rate.is_finite()) {
            return Err(IntegrationError::NotANumber { at_s: self.t });
        }
        let (Taken { mut segment, x, end_slope, .. }, end) = self.accepted(system, slope, limit)?;
        self.work.steps += 1;
        match self.first_event(system, &mut segment, end, &x) {
            Some((event, at)) => {
                self.x = segment.at(at);
                self.t = at;
                self.slope = None;
                self.pending = Some(event);
            }
            None => {
                self.x = x;
                self.t = end;
                self.slope = end_slope.filter(|_| !self.stiffness.implicit);
                self.pending = ahead.event.filter(|_| end == ahead.until);
            }
        }
        self.segment = Some(segment);
        self.read = None;
        Ok(())
    }

    /// Tries steps until the error is small enough: the step, and when it ends.
    fn accepted(
        &mut self,
        system: &mut impl Hybrid<N, G, F>,
        slope: [f64; N],
        limit: f64,
    ) -> Result<(Taken<N>, f64), IntegrationError> {
        let slopes = self.stiffness.implicit.then(|| self.slopes(system, slope));
        loop {
            let room = limit - self.t;
            // A remainder of less than a tenth of a step would cost as much as a whole one.
            let limited = self.wanted >= 0.9 * room;
            // Two equal steps to the end rather than a long one and a short one.
            let even = room < 2.0 * self.wanted && room.is_finite();
            let h = if limited {
                room
            } else if even {
                0.5 * room
            } else {
                self.wanted
            };
            let end = if limited { limit } else { self.t + h };
            system.try_step(h);
            let trial = match &slopes {
                Some(slopes) => self.implicit_trial(system, slope, slopes, h),
                None if system.core_alone() => self.explicit_trial::<CORE>(system, slope, h),
                None => self.explicit_trial::<N>(system, slope, h),
            };
            let error = trial.error;
            if !error.is_finite() {
                self.wanted = 0.1 * h;
            } else {
                let next = h * self.pace.factor(h, error, trial.order);
                if let Some(taken) = trial.taken {
                    // A step cut short by an event says nothing of the wanted size.
                    self.wanted = if limited { next.max(self.wanted) } else { next };
                    self.note_step(&taken, limited);
                    return Ok((taken, end));
                }
                self.wanted = next;
            }
            self.work.rejected += 1;
            self.pace.reject();
            if self.wanted < SMALLEST_STEP {
                return Err(if error.is_finite() {
                    IntegrationError::StepTooSmall { at_s: self.t, step_s: self.wanted }
                } else {
                    IntegrationError::NotANumber { at_s: self.t }
                });
            }
        }
    }

    /// A step cut short says nothing of how far a method might go.
    fn note_step(&mut self, taken: &Taken<N>, limited: bool) {
        if !limited {
            let moved: [f64; N] = std::array::from_fn(|i| taken.x[i] - self.x[i]);
            self.stiffness.note(taken.stiffness, self.error_norm(&moved, &taken.x));
        }
    }

    /// The largest error of a state over what is allowed.
    fn error_norm<const M: usize>(&self, error: &[f64; M], x: &[f64; N]) -> f64 {
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for i in 0..M {
            let ratio = error[i].abs() / self.scale[i].max(x[i].abs());
            largest = largest.max(ratio);
            sum += ratio;
        }
        // What is no number is in no maximum.
        if f64::is_finite(sum) { largest / self.tolerance } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests;
