//! The interface of a system to the integrator.

/// A hybrid system of N states: smooth as long as its modes stay, with G guards that are cheap and E that are
/// expensive.
///
/// A mode ends in one of two ways: at a time that is known beforehand ([`System::step_limit`]), at which a step is
/// made to end, or where a guard becomes negative, which the integrator finds on the dense output of a step.
pub trait System<const N: usize, const G: usize, const E: usize> {
    /// dx/dt in the present modes. It must be smooth a little beyond them, as a step looks past its events.
    fn derivative(&mut self, t: f64, x: &[f64; N]) -> [f64; N];

    /// Not negative as long as the present modes hold. They are evaluated inside a step as well, so that a guard
    /// that becomes negative and comes back is seen.
    fn guards(&mut self, _t: f64, _x: &[f64; N]) -> [f64; G] {
        const { assert!(G == 0, "a system with guards must define them") };
        [f64::INFINITY; G]
    }

    /// As [`System::guards`], for guards that are expensive: they are evaluated at the end of a step only.
    fn end_guards(&mut self, _t: f64, _x: &[f64; N]) -> [f64; E] {
        [f64::INFINITY; E]
    }

    /// The first time after `t` at which the modes change for any state; infinite if there is none.
    ///
    /// ```
    /// use pneudrive_solver::{Derivative, Event, Integrator, Method, System};
    ///
    /// /// A slide at 1 m/s that a command turns round every second.
    /// struct Slide(f64);
    ///
    /// impl System<1, 0, 0> for Slide {
    ///     fn derivative(&mut self, _t: f64, _x: &[f64; 1]) -> [f64; 1] {
    ///         [self.0]
    ///     }
    ///     fn next_time_event(&self, t: f64) -> f64 {
    ///         t.floor() + 1.0
    ///     }
    ///     fn handle_event(&mut self, _event: Event, _t: f64, _x: &mut [f64; 1]) -> Derivative {
    ///         self.0 = -self.0;
    ///         Derivative::Discontinuous
    ///     }
    /// }
    ///
    /// let mut integrator = Integrator::new(Method::DormandPrince, 1e-9, [1.0], [0.0]);
    /// let [place] = *integrator.state_at(&mut Slide(1.0), 3.25)?;
    /// assert!((place - 0.75).abs() < 1e-12, "it is on its second way back");
    /// # Ok::<(), pneudrive_solver::IntegrationError>(())
    /// ```
    fn next_time_event(&self, _t: f64) -> f64 {
        f64::INFINITY
    }

    /// The longest step in which the integrator sees every change of the guards.
    fn max_step(&self) -> f64 {
        f64::INFINITY
    }

    /// How far a step from `t` may go. A system that can tell its next event from the present state says it here,
    /// and keeps the guard of that event positive: then nothing has to be searched for.
    fn step_limit(&mut self, t: f64, _x: &[f64; N]) -> StepLimit {
        StepLimit { until: self.next_time_event(t), event: Some(Event::Time) }.within(t + self.max_step())
    }

    /// Tightens whatever is solved iteratively in [`System::derivative`], or loosens it again: while derivatives
    /// are differenced for a Jacobian, they need all their digits.
    fn tighten(&mut self, _tight: bool) {}

    /// A step of size `h` is about to be tried: an error of dx/dt counts `h` times in it.
    fn begin_step(&mut self, _h: f64) {}

    /// Whether a state oscillates in the present modes, in many steps a period. Step sizes with and without an oscillation
    /// are remembered apart, and errors are taken to follow their trend in it.
    fn oscillates(&self) -> bool {
        false
    }

    /// How many guards may change in the present modes: the first ones. Those after them keep a positive value.
    fn n_guards(&self) -> usize {
        G
    }

    /// How many states move in the present modes: the first ones. Those after them have no derivative.
    fn n_moving(&self) -> usize {
        N
    }

    /// Why the equations do not hold in a state that no step leads on from: the event, and the remedy. None if they
    /// hold. The integrator asks once an integration has failed, or makes hardly any progress.
    fn beyond_model(&self, _x: &[f64; N]) -> Option<&'static str> {
        None
    }

    /// Changes the modes at an event, and the state if it jumps. Returns the effect on dx/dt.
    fn handle_event(&mut self, _event: Event, _t: f64, _x: &mut [f64; N]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// How far a step may go, and the event that comes then, if one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimit {
    /// When.
    pub until: f64,
    /// The event.
    pub event: Option<Event>,
}

impl StepLimit {
    /// The same, but no farther than to `until`.
    #[must_use]
    #[inline]
    pub fn within(self, until: f64) -> StepLimit {
        if until < self.until { StepLimit { until, event: None } } else { self }
    }
}

/// The end of a smooth stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The time of [`System::next_time_event`].
    Time,
    /// The guard of this index becomes negative.
    Guard(usize),
    /// The end guard of this index becomes negative.
    EndGuard(usize),
}

/// The effect of an event on dx/dt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derivative {
    /// It is continuous, with another curvature, and need not be evaluated again.
    Continuous,
    /// It may have jumped.
    Discontinuous,
}
