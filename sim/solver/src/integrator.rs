//! The integrator: steps of one smooth stretch, ended at its first event.
//!
//! Between a step's ends the state can be read at any time, so a sample costs no step. Where an event leaves dx/dt
//! continuous, the next step has its first stage already.

use crate::dense_output::{AcceptedStep, TrialError};
use crate::error::{IntegrationError, MANY_STEPS, MAX_STEPS};
use crate::progress::Progress;
use crate::rosenbrock::Linearization;
use crate::statistics::Statistics;
use crate::step_size::{NEXT_TO_NONE, ShortSteps, StepControl};
use crate::stiffness::Stiffness;
use crate::system::{Derivative, Event, System};
use crate::tableau::{Method, Tableau};

/// Smallest step, s: below it, rounding of the time matters.
const MIN_STEP: f64 = 1e-13;

/// Most events within [`MIN_STEP`] of each other.
const MAX_EVENTS_AT_ONCE: u32 = 64;

/// More steps than this within [`STEP_COUNT_SPAN_S`] crawl: a sound system takes fewer.
const CRAWLING: u64 = 500;

/// The time in which [`MAX_STEPS`] may be tried, s.
const STEP_COUNT_SPAN_S: f64 = 1e-3;

/// The first step that is tried, s.
const FIRST_STEP: f64 = 1e-5;

/// An integration of a [`System`] of N states, G guards and E end guards, and where it is.
#[derive(Clone, Debug)]
pub struct Integrator<
    const N: usize,
    const G: usize,
    const E: usize,
    const FEW: usize = N,
    const SOME: usize = N,
> {
    tableau: &'static Tableau,
    now: Progress<N>,
    /// dx/dt at t, if it is known in the present modes.
    derivative: Option<[f64; N]>,
    /// The guards at t, if they are known in the present modes.
    guards: Option<[f64; G]>,
    /// The step that was accepted last, and whether it led to t in the present modes.
    step: AcceptedStep<N>,
    has_step: bool,
    /// The last requested state and its time; not a number if there is none. Resting states always have their present
    /// values.
    read: [f64; N],
    read_at: f64,
    /// The event at t, until it has been handled.
    pending: Option<Event>,
    /// The step size for the allowed error.
    step_size: f64,
    /// The step size for the allowed error in stretches of the other kind: with an oscillation if there is none now,
    /// else without.
    other_step_size: f64,
    oscillates: bool,
    short_steps: ShortSteps,
    control: StepControl,
    /// Events within [`MIN_STEP`], and since when.
    events_at_once: (u32, f64),
    stiffness: Stiffness,
    /// When the present [`STEP_COUNT_SPAN_S`] began, and the steps tried until then.
    step_count_span: (f64, u64),
    /// Whether there were more than [`CRAWLING`] since.
    crawls: bool,
    /// How many times more than [`CRAWLING`] steps were taken within the span, and the steps tried until the last
    /// time.
    crawled: (u32, u64),
}

/// A size that a step is tried with.
struct Proposal {
    h: f64,
    end: f64,
    /// Whether something else than the error ends the step.
    limited: bool,
}

impl<const N: usize, const G: usize, const E: usize> Integrator<N, G, E> {
    /// An integration from `x` at t = 0. A step's error may be `tolerance` times the larger of a state and its
    /// `scale`.
    #[must_use]
    pub fn new(method: Method, tolerance: f64, scale: [f64; N], x: [f64; N]) -> Self {
        Integrator::of_parts(method, tolerance, scale, x)
    }
}

impl<const N: usize, const G: usize, const E: usize, const FEW: usize, const SOME: usize>
    Integrator<N, G, E, FEW, SOME>
{
    /// The same of a system of which at times only the first FEW or the first SOME states move
    /// ([`System::n_moving`]): steps then leave the others alone.
    #[must_use]
    pub fn of_parts(method: Method, tolerance: f64, scale: [f64; N], x: [f64; N]) -> Self {
        Integrator {
            tableau: Tableau::of(method),
            now: Progress { t: 0.0, x, tolerance, scale, statistics: Statistics::default() },
            derivative: None,
            guards: None,
            step: AcceptedStep::NONE,
            has_step: false,
            read: x,
            read_at: f64::NAN,
            pending: None,
            step_size: FIRST_STEP,
            other_step_size: FIRST_STEP,
            short_steps: match method {
                Method::DormandPrince => ShortSteps::new(tolerance),
                Method::Merson => ShortSteps::NEVER,
            },
            oscillates: false,
            control: StepControl::default(),
            events_at_once: (0, 0.0),
            stiffness: Stiffness::default(),
            step_count_span: (0.0, 0),
            crawls: false,
            crawled: (0, 0),
        }
    }

    /// The work so far.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.now.statistics
    }

    /// The state at `t`, which must lie in the last step of [`Integrator::integrate_to`].
    #[must_use]
    #[inline]
    pub fn state(&mut self, t: f64) -> &[f64; N] {
        if self.read_at != t {
            self.read_at = t;
            if self.has_step && t < self.now.t {
                self.step.dense.bring_to::<FEW, SOME>(t, &mut self.read);
            } else {
                self.read = self.now.x;
            }
        }
        &self.read
    }

    /// Integrates to `t`, or a little beyond it, and gives the state there.
    ///
    /// ```
    /// use pneudrive_solver::{Derivative, Event, Integrator, Method, System};
    ///
    /// /// A vessel that empties with a time constant of 0.2 s: its gauge pressure, bar.
    /// struct Vessel;
    ///
    /// impl System<1, 0, 0> for Vessel {
    ///     fn derivative(&mut self, _t: f64, x: &[f64; 1]) -> [f64; 1] {
    ///         [-x[0] / 0.2]
    ///     }
    /// }
    ///
    /// let mut integrator = Integrator::new(Method::DormandPrince, 1e-10, [1.0], [6.0]);
    /// for t in [0.1, 0.2, 0.5] {
    ///     let [pressure] = *integrator.state_at(&mut Vessel, t)?;
    ///     assert!((pressure - 6.0 * f64::exp(-t / 0.2)).abs() < 1e-9);
    /// }
    /// # Ok::<(), pneudrive_solver::IntegrationError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Integrator::integrate_to`].
    pub fn state_at(
        &mut self,
        system: &mut impl System<N, G, E>,
        t: f64,
    ) -> Result<&[f64; N], IntegrationError> {
        self.integrate_to(system, t, f64::INFINITY)?;
        Ok(self.state(t))
    }

    /// Whether the last step has gone beyond `t`, so that [`Integrator::integrate_to`] has nothing to do.
    #[must_use]
    #[inline]
    pub fn has_passed(&self, t: f64) -> bool {
        t < self.now.t
    }

    /// The derivative of one state at `t`, as in [`Integrator::state`]; None where it may have jumped.
    #[must_use]
    pub fn derivative_of(&self, state: usize, t: f64) -> Option<f64> {
        match self.has_step {
            true => Some(self.step.dense.derivative_of(state, t.min(self.now.t))),
            false => self.derivative.map(|derivative| derivative[state]),
        }
    }

    /// Integrates to `t`, or a little beyond it, but not beyond `horizon`; handles every event up to and at `t`.
    ///
    /// # Errors
    /// When the state is no longer a number, steps or events pile up, or the system says that its equations do not hold.
    pub fn integrate_to(
        &mut self,
        system: &mut impl System<N, G, E>,
        t: f64,
        horizon: f64,
    ) -> Result<(), IntegrationError> {
        let steps = self.step_to(system, t, horizon);
        steps.map_err(|error| match system.beyond_model(&self.now.x) {
            Some(why) => IntegrationError::BeyondModel { at_s: error.at_s(), why },
            None => error,
        })
    }

    fn step_to(
        &mut self,
        system: &mut impl System<N, G, E>,
        t: f64,
        horizon: f64,
    ) -> Result<(), IntegrationError> {
        loop {
            if self.now.t <= t
                && let Some(event) = self.pending.take()
            {
                self.handle(system, event)?;
            } else if self.now.t < t {
                self.step(system, horizon.max(t))?;
            } else {
                return Ok(());
            }
        }
    }

    /// Ends the last step at `t`, because the system is changed from outside there. `change` is given the system
    /// and its state.
    pub fn interrupt<S: System<N, G, E>>(
        &mut self,
        system: &mut S,
        t: f64,
        change: impl FnOnce(&mut S, &mut [f64; N]) -> Derivative,
    ) {
        if t < self.now.t {
            if self.has_step {
                self.now.refine(system, &mut self.step.dense);
                self.now.x = self.step.dense.at(t);
            }
            self.pending = None;
            self.derivative = None;
        }
        self.now.t = t;
        let derivative = change(system, &mut self.now.x);
        self.restart(derivative, system.oscillates());
    }

    fn restart(&mut self, after: Derivative, oscillates: bool) {
        if oscillates != self.oscillates {
            self.oscillates = oscillates;
            std::mem::swap(&mut self.step_size, &mut self.other_step_size);
        }
        self.has_step = false;
        self.forget_read();
        self.guards = None;
        self.control = StepControl::default();
        if after == Derivative::Discontinuous {
            self.derivative = None;
        }
        self.now.statistics.n_restarts += u64::from(self.derivative.is_none());
    }

    fn handle(&mut self, system: &mut impl System<N, G, E>, event: Event) -> Result<(), IntegrationError> {
        let (count, since) = self.events_at_once;
        self.events_at_once =
            if self.now.t - since < MIN_STEP { (count + 1, since) } else { (0, self.now.t) };
        if self.events_at_once.0 > MAX_EVENTS_AT_ONCE {
            return Err(IntegrationError::EventsPileUp { at_s: self.now.t });
        }
        let after = system.handle_event(event, self.now.t, &mut self.now.x);
        self.now.statistics.n_events += 1;
        self.restart(after, system.oscillates());
        Ok(())
    }

    fn count_step(&mut self, system: &impl System<N, G, E>) -> Result<(), IntegrationError> {
        let (since, before) = self.step_count_span;
        let tried = self.now.statistics.n_steps + self.now.statistics.n_rejected_steps;
        if self.now.t - since >= STEP_COUNT_SPAN_S {
            self.step_count_span = (self.now.t, tried);
            (self.crawls, self.crawled.1) = (false, tried);
        } else if tried - before > MAX_STEPS
            || (tried - before > MANY_STEPS && system.beyond_model(&self.now.x).is_some())
        {
            return Err(IntegrationError::NoProgress { at_s: self.now.t });
        }
        if tried - self.crawled.1 > CRAWLING {
            (self.crawls, self.crawled) = (true, (self.crawled.0 + 1, tried));
        }
        Ok(())
    }

    /// One accepted step, ended at the first event in it.
    fn step(&mut self, system: &mut impl System<N, G, E>, horizon: f64) -> Result<(), IntegrationError> {
        self.count_step(system)?;
        system.tighten(self.stiffness.implicit);
        let limit = system.step_limit(self.now.t, &self.now.x);
        if limit.until <= self.now.t && limit.event.is_some() {
            self.pending = limit.event;
            return Ok(());
        }
        let derivative = &self.present_derivative(system);
        // No step is short enough for a derivative that is not a number.
        if !derivative.iter().all(|rate| rate.is_finite()) {
            return Err(IntegrationError::NotANumber { at_s: self.now.t });
        }
        let end = self.accepted_step(system, derivative, limit.until.min(horizon))?;
        self.now.statistics.n_steps += 1;
        let AcceptedStep { dense, x, end_derivative, .. } = &mut self.step;
        match self.now.first_event(system, &mut self.guards, dense, end, x) {
            Some((event, at)) => {
                self.now.x = dense.at(at);
                self.now.t = at;
                self.derivative = None;
                self.pending = Some(event);
            }
            None => {
                self.now.x = *x;
                self.now.t = end;
                self.derivative = end_derivative.filter(|_| !self.stiffness.implicit);
                self.pending = limit.event.filter(|_| end == limit.until);
            }
        }
        self.has_step = true;
        self.forget_read();
        Ok(())
    }

    fn forget_read(&mut self) {
        (self.read, self.read_at) = (self.now.x, f64::NAN);
    }

    #[inline(always)]
    fn present_derivative(&mut self, system: &mut impl System<N, G, E>) -> [f64; N] {
        match self.derivative {
            Some(derivative) => derivative,
            None => {
                self.now.statistics.n_rhs_evaluations += 1;
                system.derivative(self.now.t, &self.now.x)
            }
        }
    }

    /// Tries steps until the error of one is small enough, and tells when it ends.
    fn accepted_step(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        limit: f64,
    ) -> Result<f64, IntegrationError> {
        let linearization =
            self.stiffness.implicit.then(|| self.now.linearize(system, derivative, self.crawled.0));
        system.tighten(false);
        loop {
            let Proposal { h, end, limited } = self.propose(limit);
            if limited && linearization.is_none() && self.short_steps.fits(h) {
                let trial = self.try_short_step(system, derivative, h);
                if self.short_steps.note(h, trial.error) {
                    return Ok(end);
                }
                self.now.statistics.n_rejected_steps += 1;
            }
            let trial = self.try_step(system, derivative, linearization.as_ref(), h);
            let error = trial.error;
            if !error.is_finite() {
                self.step_size = 0.1 * h;
            } else {
                let next = h * self.control.factor(h, error, trial.order);
                if trial.is_small() {
                    if limited && linearization.is_none() {
                        self.short_steps.note_long(h, error);
                    }
                    // A step cut short that has next to no error says nothing about the size for the allowed one.
                    self.step_size =
                        if limited && error < NEXT_TO_NONE { next.max(self.step_size) } else { next };
                    self.note_stiffness(limited, next / h);
                    return Ok(end);
                }
                self.step_size = next;
            }
            self.now.statistics.n_rejected_steps += 1;
            self.control.reject(self.oscillates);
            if self.step_size < MIN_STEP {
                return Err(self.no_step(error));
            }
        }
    }

    fn no_step(&self, error: f64) -> IntegrationError {
        match error.is_finite() {
            true => IntegrationError::StepTooSmall { at_s: self.now.t, step_s: self.step_size },
            false => IntegrationError::NotANumber { at_s: self.now.t },
        }
    }

    #[inline(always)]
    fn propose(&self, limit: f64) -> Proposal {
        let room = limit - self.now.t;
        // A remainder of less than a tenth of a step would cost as much as a whole one.
        let limited = self.step_size >= 0.9 * room;
        // Two equal steps to the end rather than a long one and a short one.
        let even = room < 2.0 * self.step_size && room.is_finite();
        let h = match (limited, even) {
            (true, _) => room,
            (false, true) => 0.5 * room,
            (false, false) => self.step_size,
        };
        Proposal { h, end: if limited { limit } else { self.now.t + h }, limited }
    }

    #[inline(always)]
    fn try_step(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        linearization: Option<&Linearization<N>>,
        h: f64,
    ) -> TrialError {
        system.begin_step(h);
        match system.n_moving() {
            n if n <= FEW => self.try_step_of::<FEW>(system, derivative, linearization, h),
            n if n <= SOME => self.try_step_of::<SOME>(system, derivative, linearization, h),
            _ => self.try_step_of::<N>(system, derivative, linearization, h),
        }
    }

    /// The same by the method for short steps.
    #[inline(always)]
    fn try_short_step(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        h: f64,
    ) -> TrialError {
        system.begin_step(h);
        let step = &mut self.step;
        match system.n_moving() {
            n if n <= FEW => self.now.short_step::<FEW, G, E>(system, derivative, h, step),
            n if n <= SOME => self.now.short_step::<SOME, G, E>(system, derivative, h, step),
            _ => self.now.short_step::<N, G, E>(system, derivative, h, step),
        }
    }

    /// The same where the first M states move.
    #[inline(always)]
    fn try_step_of<const M: usize>(
        &mut self,
        system: &mut impl System<N, G, E>,
        derivative: &[f64; N],
        linearization: Option<&Linearization<N>>,
        h: f64,
    ) -> TrialError {
        let step = &mut self.step;
        match linearization {
            Some(linear) => self.now.rosenbrock_step::<M, G, E>(system, derivative, linear, h, step),
            None => self.now.explicit_step::<M, G, E>(self.tableau, system, derivative, h, step),
        }
    }

    /// A step cut short does not show how far a method might go. The errors of one method have no trend in common
    /// with the errors of the other.
    fn note_stiffness(&mut self, limited: bool, growth: f64) {
        if !limited && self.stiffness.note(self.step.stiffness, self.step.moved, growth, self.crawls) {
            self.control = StepControl::default();
        }
    }
}

#[cfg(test)]
mod tests;
