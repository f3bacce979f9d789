//! Order of convergence on problems with known answers, and events against closed forms.

use super::*;
use crate::{Event, System};

/// A system without events: its right-hand side alone.
struct Smooth<F>(F);

impl<const N: usize, F: FnMut(f64, &[f64; N]) -> [f64; N]> System<N, 0, 0> for Smooth<F> {
    fn derivative(&mut self, t: f64, x: &[f64; N]) -> [f64; N] {
        self.0(t, x)
    }
    fn guards(&mut self, _: f64, _: &[f64; N]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; N]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// A harmonic oscillator: smooth, x = (cos t, -sin t).
fn oscillator(_: f64, x: &[f64; 2]) -> [f64; 2] {
    [x[1], -x[0]]
}

/// The oscillator's error at t = 2 in steps of exactly `h`.
fn error_with_step(method: Method, h: f64) -> f64 {
    let mut integrator = Integrator::<2, 0, 0>::new(method, 1e6, [1.0; 2], [1.0, 0.0]);
    integrator.short_steps = ShortSteps::NEVER;
    let steps = (2.0 / h).round() as u32;
    for step in 1..=steps {
        integrator.step_size = 1.0;
        let t = f64::from(step) * h;
        integrator.integrate_to(&mut Smooth(oscillator), t, t).expect("smooth");
    }
    assert_eq!(integrator.statistics().n_steps, u64::from(steps));
    let x = integrator.state(2.0);
    (x[0] - 2.0_f64.cos()).hypot(x[1] + 2.0_f64.sin())
}

#[test]
fn the_error_falls_with_the_order_of_the_method() {
    for (method, order) in [(Method::DormandPrince, 5.0), (Method::Merson, 4.0)] {
        let observed = (error_with_step(method, 0.1) / error_with_step(method, 0.05)).log2();
        assert!((observed - order).abs() < 0.2, "{method:?}: {observed}");
    }
}

/// x' = x^2 from 1: x = 1/(1-t): not linear.
fn riccati(_: f64, x: &[f64; 1]) -> [f64; 1] {
    [x[0] * x[0]]
}

#[test]
fn the_order_holds_on_a_nonlinear_problem() {
    let error = |method, h: f64| {
        let mut integrator = Integrator::<1, 0, 0>::new(method, 1e6, [1.0], [1.0]);
        integrator.short_steps = ShortSteps::NEVER;
        for step in 1..=(0.5 / h).round() as u32 {
            integrator.step_size = 1.0;
            integrator
                .integrate_to(&mut Smooth(riccati), f64::from(step) * h, f64::from(step) * h)
                .expect("smooth");
        }
        (integrator.state(0.5)[0] - 2.0).abs()
    };
    for (method, order) in [(Method::DormandPrince, 5.0), (Method::Merson, 4.0)] {
        let observed = (error(method, 0.1) / error(method, 0.05)).log2();
        assert!(observed > order - 0.3, "{method:?}: {observed}");
    }
}

#[test]
fn the_dense_output_is_as_good_between_the_ends_of_a_step() {
    for (method, order) in [(Method::DormandPrince, 5.0), (Method::Merson, 4.0)] {
        let error = |h: f64| {
            let mut integrator = Integrator::<2, 0, 0>::new(method, 1e6, [1.0; 2], [1.0, 0.0]);
            integrator.step_size = 1.0;
            integrator.integrate_to(&mut Smooth(oscillator), h, h).expect("smooth");
            let x = integrator.state(0.4 * h);
            (x[0] - (0.4 * h).cos()).hypot(x[1] + (0.4 * h).sin())
        };
        let observed = (error(0.2) / error(0.1)).log2();
        assert!((observed - order).abs() < 0.3, "{method:?}: {observed}");
    }
}

#[test]
fn a_tighter_tolerance_gives_a_smaller_error() {
    let error = |tolerance| {
        let mut integrator =
            Integrator::<2, 0, 0>::new(Method::DormandPrince, tolerance, [1.0; 2], [1.0, 0.0]);
        integrator.integrate_to(&mut Smooth(oscillator), 10.0, 10.0).expect("smooth");
        (integrator.state(10.0)[0] - 10.0_f64.cos()).abs()
    };
    assert!(error(1e-6) < 1e-4);
    assert!(error(1e-10) < 1e-8);
}

/// A ball on a floor without loss of energy: parabolas between bounces at known times.
struct Ball {
    bounces: Vec<f64>,
}

impl System<2, 1, 0> for Ball {
    fn derivative(&mut self, _: f64, x: &[f64; 2]) -> [f64; 2] {
        [x[1], -10.0]
    }
    fn guards(&mut self, _: f64, x: &[f64; 2]) -> [f64; 1] {
        [x[0]]
    }
    fn handle_event(&mut self, event: Event, t: f64, x: &mut [f64; 2]) -> Derivative {
        assert_eq!(event, Event::Guard(0));
        self.bounces.push(t);
        *x = [0.0, -x[1]];
        Derivative::Discontinuous
    }
}

#[test]
fn events_are_hit_to_a_picosecond() {
    let mut ball = Ball { bounces: Vec::new() };
    let mut integrator = Integrator::<2, 1, 0>::new(Method::DormandPrince, 1e-9, [1.0; 2], [1.0, 0.0]);
    integrator.integrate_to(&mut ball, 4.0, 4.0).expect("a ball");
    let fall = 0.2_f64.sqrt();
    assert_eq!(ball.bounces.len(), 4);
    for (i, at) in ball.bounces.iter().enumerate() {
        let expected = fall * (1.0 + 2.0 * i as f64);
        assert!((at - expected).abs() < 1e-12, "bounce {i}: {at} {expected}");
    }
}

/// A guard that dips below zero and comes back within one step.
struct Dip;

impl System<1, 1, 0> for Dip {
    fn derivative(&mut self, _: f64, _: &[f64; 1]) -> [f64; 1] {
        [1.0]
    }
    fn guards(&mut self, _: f64, x: &[f64; 1]) -> [f64; 1] {
        [(x[0] - 0.6) * (x[0] - 0.6) - 0.0001]
    }
    fn handle_event(&mut self, _: Event, t: f64, x: &mut [f64; 1]) -> Derivative {
        assert!((t - 0.59).abs() < 1e-9, "{t}");
        x[0] += 1.0;
        Derivative::Discontinuous
    }
}

#[test]
fn a_guard_that_comes_back_within_one_step_is_seen() {
    let mut integrator = Integrator::<1, 1, 0>::new(Method::DormandPrince, 1e-3, [1.0], [0.0]);
    integrator.step_size = 1.0;
    integrator.integrate_to(&mut Dip, 1.0, 1.0).expect("a line");
    assert_eq!(integrator.statistics().n_events, 1);
}

/// A guard that begins at zero, and comes back before the step is first looked into.
#[derive(Default)]
struct Return {
    came_back: Option<f64>,
}

impl System<1, 1, 0> for Return {
    fn derivative(&mut self, _: f64, _: &[f64; 1]) -> [f64; 1] {
        [1.0]
    }
    fn guards(&mut self, _: f64, x: &[f64; 1]) -> [f64; 1] {
        [if self.came_back.is_some() { 1.0 } else { x[0] * (0.02 - x[0]) }]
    }
    fn handle_event(&mut self, _: Event, t: f64, _: &mut [f64; 1]) -> Derivative {
        self.came_back = Some(t);
        Derivative::Discontinuous
    }
}

#[test]
fn a_guard_that_begins_at_zero_and_comes_back_at_once_is_crossed_where_it_comes_back() {
    let mut integrator = Integrator::<1, 1, 0>::new(Method::DormandPrince, 1e-3, [1.0], [0.0]);
    integrator.step_size = 1.0;
    let mut system = Return::default();
    integrator.integrate_to(&mut system, 0.5, 1.0).expect("a line");
    let at = system.came_back.expect("an event");
    assert!((at - 0.02).abs() < 1e-12, "{at}");
}

/// A right-hand side that fails.
fn broken(t: f64, _: &[f64; 1]) -> [f64; 1] {
    [if t > 0.5 { f64::NAN } else { 1.0 }]
}

#[test]
fn a_state_that_stops_being_a_number_is_said_with_its_time() {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-6, [1.0], [0.0]);
    let error = integrator.integrate_to(&mut Smooth(broken), 1.0, 1.0).expect_err("not a number");
    assert!(matches!(error, IntegrationError::NotANumber { at_s } if (at_s - 0.5).abs() < 1e-6), "{error}");
}

/// Where a first slope is no number the others are none, however short the step.
#[test]
fn a_slope_that_is_no_number_ends_a_run_at_once() {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-6, [1.0], [0.0]);
    integrator.now.t = 1.0;
    let error = integrator.integrate_to(&mut Smooth(broken), 2.0, 2.0).expect_err("not a number");
    assert_eq!(
        (error, integrator.statistics().n_rhs_evaluations),
        (IntegrationError::NotANumber { at_s: 1.0 }, 1)
    );
}

/// A rotation so fast that its steps come to nothing, though each one succeeds.
fn whirl(_: f64, x: &[f64; 2]) -> [f64; 2] {
    [1e9 * x[1], -1e9 * x[0]]
}

#[test]
fn a_run_that_would_take_for_ever_is_ended_and_said_so() {
    let mut integrator = Integrator::<2, 0, 0>::new(Method::DormandPrince, 1e-6, [1.0; 2], [1.0, 0.0]);
    let error = integrator.integrate_to(&mut Smooth(whirl), 1.0, 1.0).expect_err("too fast");
    assert!(matches!(error, IntegrationError::NoProgress { at_s } if at_s < 1e-3), "{error}");
}

/// A leak that empties a vessel within a second, by a law that has no root of what is not there.
struct Vessel;

impl System<1, 0, 0> for Vessel {
    fn derivative(&mut self, _: f64, x: &[f64; 1]) -> [f64; 1] {
        [-1.0 / x[0].sqrt()]
    }

    fn guards(&mut self, _: f64, _: &[f64; 1]) -> [f64; 0] {
        []
    }

    fn beyond_model(&self, x: &[f64; 1]) -> Option<&'static str> {
        (x[0] < 0.01).then_some("the vessel is empty")
    }

    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 1]) -> Derivative {
        Derivative::Continuous
    }
}

#[test]
fn a_state_that_its_equations_do_not_hold_for_is_told_in_the_words_of_the_system() {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-8, [1.0], [1.0]);
    let error = integrator.integrate_to(&mut Vessel, 1.0, 1.0).expect_err("empty after 2/3 s");
    let IntegrationError::BeyondModel { at_s, why } = error else { panic!("{error}") };
    assert!(why == "the vessel is empty" && (at_s - 2.0 / 3.0).abs() < 1e-3, "{error}");
}

/// A fast decay towards a slow oscillation (Prothero and Robinson): x = cos t.
fn chase(t: f64, x: &[f64; 1]) -> [f64; 1] {
    [-1e6 * (x[0] - t.cos()) - t.sin()]
}

#[test]
fn steps_at_the_bound_of_stability_are_hardly_rejected() {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-8, [1.0], [1.0]);
    integrator.integrate_to(&mut Smooth(chase), 9e-5, 9e-5).expect("a solution");
    let Statistics { n_steps, n_rejected_steps, .. } = integrator.statistics();
    let explicit = !integrator.stiffness.implicit;
    assert!(explicit && n_steps > 20 && n_rejected_steps <= 2, "{explicit} {n_steps} {n_rejected_steps}");
}

#[test]
fn a_stiff_stretch_is_followed_in_steps_of_what_happens_in_it() {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-8, [1.0], [1.0]);
    integrator.integrate_to(&mut Smooth(chase), 3.0, 3.0).expect("a solution");
    assert!(
        integrator.stiffness.implicit && integrator.statistics().n_steps < 1000,
        "{:?}",
        integrator.statistics()
    );
    assert!((integrator.state(3.0)[0] - 3.0_f64.cos()).abs() < 1e-7);
}

/// The error of the method for short steps at t = 0.5 on x' = x^2 in steps of `h`, and that of its dense output.
fn short_errors(h: f64) -> (f64, f64) {
    let mut now = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1.0, [1.0], [1.0]).now;
    let mut inside = 0.0_f64;
    for _ in 0..(0.5 / h).round() as u32 {
        let slope = riccati(now.t, &now.x);
        let (system, mut accepted) = (&mut Smooth(riccati), AcceptedStep::NONE);
        let trial = now.short_step::<1, 0, 0>(system, &slope, h, &mut accepted);
        assert!(trial.is_small());
        let middle = now.t + 0.4 * h;
        inside = inside.max((accepted.dense.at(middle)[0] - 1.0 / (1.0 - middle)).abs());
        (now.t, now.x) = (now.t + h, accepted.x);
    }
    ((now.x[0] - 2.0).abs(), inside)
}

#[test]
fn the_method_for_short_steps_is_of_order_3_at_their_ends_and_between() {
    let (coarse, fine) = (short_errors(0.025), short_errors(0.0125));
    for observed in [(coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2()] {
        assert!(observed > 2.8 && observed < 4.3, "{observed}");
    }
}

/// An oscillator whose right-hand side may jump a hundred times a second.
struct Interrupted;

impl System<2, 0, 0> for Interrupted {
    fn derivative(&mut self, t: f64, x: &[f64; 2]) -> [f64; 2] {
        oscillator(t, x)
    }
    fn guards(&mut self, _: f64, _: &[f64; 2]) -> [f64; 0] {
        []
    }
    fn next_time_event(&self, t: f64) -> f64 {
        ((100.0 * t + 1e-6).floor() + 1.0) / 100.0
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 2]) -> Derivative {
        Derivative::Discontinuous
    }
}

#[test]
fn steps_that_events_end_long_before_the_error_counts_take_four_evaluations() {
    for (tolerance, evaluations) in [(1e-5, 4.2), (1e-11, 7.2)] {
        let mut integrator =
            Integrator::<2, 0, 0>::new(Method::DormandPrince, tolerance, [1.0; 2], [1.0, 0.0]);
        integrator.integrate_to(&mut Interrupted, 10.0, 10.0).expect("smooth");
        let taken = integrator.statistics().n_rhs_evaluations as f64 / 1000.0;
        assert!(taken < evaluations, "{tolerance}: {taken}");
        assert!((integrator.state(10.0)[0] - 10.0_f64.cos()).abs() < 30.0 * tolerance, "{tolerance}");
    }
}

/// The implicit method's error at t = 0.5 on x' = x^2 in steps of `h`, and that of its dense output.
fn implicit_errors(h: f64) -> (f64, f64) {
    let mut integrator = Integrator::<1, 0, 0>::new(Method::DormandPrince, 1e-11, [1.0], [1.0]);
    let mut inside = 0.0_f64;
    for _ in 0..(0.5 / h).round() as u32 {
        let slope = riccati(integrator.now.t, &integrator.now.x);
        let slopes = integrator.now.linearize(&mut Smooth(riccati), &slope, 0);
        // Whatever its error, the step is accepted.
        integrator.now.tolerance = 1.0;
        let (system, mut accepted) = (&mut Smooth(riccati), AcceptedStep::NONE);
        let trial = integrator.now.rosenbrock_step::<1, 0, 0>(system, &slope, &slopes, h, &mut accepted);
        integrator.now.tolerance = 1e-11;
        assert!(trial.is_small());
        let middle = integrator.now.t + 0.5 * h;
        inside = inside.max((accepted.dense.at(middle)[0] - 1.0 / (1.0 - middle)).abs());
        (integrator.now.t, integrator.now.x) = (integrator.now.t + h, accepted.x);
    }
    ((integrator.now.x[0] - 2.0).abs(), inside)
}

#[test]
fn the_implicit_method_is_of_order_4() {
    let (coarse, fine) = (implicit_errors(0.025), implicit_errors(0.0125));
    let order = (coarse.0 / fine.0).log2();
    assert!((order - 4.0).abs() < 0.4, "{order}");
    let inside = (coarse.1 / fine.1).log2();
    assert!(inside > 3.3, "{inside}");
}

/// A fast decay of x towards cos t, behind it an oscillator that may rest, and a state that always does.
struct Partly {
    n_moving: usize,
}

impl System<4, 0, 0> for Partly {
    fn derivative(&mut self, t: f64, x: &[f64; 4]) -> [f64; 4] {
        let [fast] = chase(t, &[x[0]]);
        if self.n_moving == 1 { [fast, 0.0, 0.0, 0.0] } else { [fast, x[2], -x[1], 0.0] }
    }
    fn n_moving(&self) -> usize {
        self.n_moving
    }
    fn guards(&mut self, _: f64, _: &[f64; 4]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 4]) -> Derivative {
        Derivative::Discontinuous
    }
}

#[test]
fn states_that_rest_change_no_bit_of_the_others_and_cost_no_derivative() {
    for (n_moving, saved) in [(1, 3), (3, 1)] {
        let x = [1.0, 1.0, 0.0, 7.0];
        let mut whole = Integrator::<4, 0, 0>::new(Method::DormandPrince, 1e-8, [1.0; 4], x);
        let mut in_parts = Integrator::<4, 0, 0, 1, 3>::of_parts(Method::DormandPrince, 1e-8, [1.0; 4], x);
        whole.integrate_to(&mut Partly { n_moving }, 3.0, 3.0).expect("a solution");
        in_parts.integrate_to(&mut Partly { n_moving }, 3.0, 3.0).expect("a solution");
        assert!(whole.stiffness.implicit && in_parts.stiffness.implicit);
        assert_eq!(in_parts.statistics(), whole.statistics());
        for t in [2.999, 3.0] {
            assert_eq!(in_parts.state(t).map(f64::to_bits), whole.state(t).map(f64::to_bits), "{n_moving}");
        }
        let mut all = Integrator::<4, 0, 0>::new(Method::DormandPrince, 1e-8, [1.0; 4], x);
        all.integrate_to(&mut AllMove(Partly { n_moving }), 3.0, 3.0).expect("a solution");
        let (all, part) = (all.statistics(), in_parts.statistics());
        assert_eq!((all.n_steps, all.n_rejected_steps), (part.n_steps, part.n_rejected_steps));
        let linearized = (all.n_rhs_evaluations - part.n_rhs_evaluations) / saved;
        assert!(linearized > 10 && (all.n_rhs_evaluations - part.n_rhs_evaluations) % saved == 0);
    }
}

/// The same system, which does not say that states rest.
struct AllMove(Partly);

impl System<4, 0, 0> for AllMove {
    fn derivative(&mut self, t: f64, x: &[f64; 4]) -> [f64; 4] {
        self.0.derivative(t, x)
    }
    fn guards(&mut self, _: f64, _: &[f64; 4]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 4]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// Air that is all but at rest behind a wide valve: its flow goes with the root of a difference of 1e-10 of the
/// pressures, which settles within a nanosecond.
fn wide_valve(_: f64, x: &[f64; 2]) -> [f64; 2] {
    let difference = x[0] - x[1];
    let flow = 8e4 * difference.signum() * difference.abs().sqrt();
    [0.4, flow - 0.4]
}

#[test]
fn a_root_that_bends_within_the_tolerance_does_not_make_steps_crawl() {
    let mut integrator =
        Integrator::<2, 0, 0>::new(Method::DormandPrince, 1e-9, [1.0; 2], [1.0, 1.0 - 1e-10]);
    integrator.integrate_to(&mut Smooth(wide_valve), 0.02, 0.02).expect("it is not too stiff");
    let steps = integrator.statistics().n_steps;
    let [one, other] = *integrator.state(0.02);
    assert!((one - 1.008).abs() < 1e-8 && (one - other).abs() < 1e-8, "{one} {other}");
    assert!(steps < 5000, "{steps}");
}
