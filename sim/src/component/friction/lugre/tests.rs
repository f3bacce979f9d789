//! Bristles and film against their closed forms.

use super::*;
use crate::component::friction::Friction;
use pneudrive_solver::{Derivative, Event, IntegrationError, Integrator, Method, System};

const MASS: f64 = 2.0;
const VISCOUS: f64 = 30.0;

/// The empty file with these settings.
fn friction(settings: &[&str]) -> LuGre {
    let settings = [&["load.friction=lugre"], settings].concat();
    let Friction::LuGre(model) = Friction::of(&Rig::read_with("test", "", &settings).expect("valid")) else {
        panic!("another model")
    };
    model
}

fn body(applied: f64, velocity: f64, states: States) -> Body {
    Body { mass: MASS, viscous: VISCOUS, applied, velocity, contact: Contact::Free, states }
}

/// A body that is led along at a velocity over time: friction alone moves.
struct Led<V>(LuGre, V);

impl<V: Fn(f64) -> f64> System<2, 0, 0> for Led<V> {
    fn derivative(&mut self, t: f64, x: &[f64; 2]) -> [f64; 2] {
        self.0.derivative(&body(0.0, (self.1)(t), *x))
    }
    fn guards(&mut self, _: f64, _: &[f64; 2]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 2]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// The states at each time of a body that is led along from rest.
fn led<V: Fn(f64) -> f64>(model: LuGre, velocity: V, times: &[f64]) -> Vec<States> {
    let mut led = Led(model, velocity);
    let mut integrator = Integrator::<2, 0, 0>::new(Method::DormandPrince, 1e-11, [1e-3, 1.0], [0.0; 2]);
    let mut state_at = |t: f64| {
        integrator.integrate_to(&mut led, t, t).expect("a solution");
        *integrator.state(t)
    };
    times.iter().map(|&t| state_at(t)).collect()
}

/// Friction at a constant speed once everything has settled, less its viscous part.
fn steady(model: &LuGre, v: f64) -> f64 {
    let [most, least] = model.forces.against(v);
    let (speed, [velocity, exponent]) = (v.abs(), model.stribeck);
    let film = (speed.min(model.film[0]) / model.film[0]).powf(2.0 / 3.0);
    v.signum() * (least + (most - least) * (1.0 - film) * (-(speed / velocity).powf(exponent)).exp())
}

#[test]
fn at_a_constant_speed_friction_comes_to_the_stribeck_curve_of_its_direction() {
    for settings in [&[][..], &["load.stribeck_exponent=2", "load.film_velocity_m_s=0.3"]] {
        let model = friction(settings);
        for v in [1e-3, 0.01, 0.04, 0.05, 0.2, 1.0, -1e-3, -0.02, -0.3] {
            // So far that bristles have settled, so long that the film has.
            let settled = led(model, |_| v, &[2.0 + 0.03 / f64::abs(v)])[0];
            // At constant speed the applied force is what friction takes.
            let held = body(steady(&model, v), v, settled);
            assert!((model.force(&held) - steady(&model, v)).abs() < 1e-6, "{v} m/s: {}", model.force(&held));
        }
        assert_eq!([steady(&model, 1.0), steady(&model, -1.0)], [40.0, -11.0], "Coulomb, C(47) and C(49)");
    }
}

/// Under a film as thin as at rest, z = g/s_0 (1 - exp(-s_0 x/g)) over the travel x.
#[test]
fn before_it_slides_the_load_is_on_a_spring_that_yields_as_an_exponential() {
    let (v, stiffness) = (1e-5, 3e5);
    let model = friction(&[
        "load.bristle_stiffness_n_per_m=3e5",
        "load.bristle_damping_n_s_per_m=0",
        "load.film_growth_s=100",
    ]);
    let travels = [1e-7, 1e-5, 1e-4, 3e-4, 1e-3];
    let states = led(model, |_| v, &travels.map(|travel| travel / v));
    for (travel, [z, film]) in travels.into_iter().zip(states) {
        let [most, least] = model.forces.against(v);
        let hold = least + (most - least) * (1.0 - film) * (-v / model.stribeck[0]).exp();
        let expected = hold * (1.0 - (-stiffness * travel / hold).exp());
        let found = model.force(&body(0.0, v, [z, film]));
        assert!((found / expected - 1.0).abs() < 2e-3, "{travel} m: {found} N, not {expected}");
        if travel < 1e-6 {
            assert!((found / (stiffness * travel) - 1.0).abs() < 1e-3, "the stiffness: {}", found / travel);
        }
    }
}

/// A mass on its friction under a force over time.
struct Pushed<F>(LuGre, F);

impl<F: Fn(f64) -> f64> System<4, 0, 0> for Pushed<F> {
    fn derivative(&mut self, t: f64, x: &[f64; 4]) -> [f64; 4] {
        let body = body((self.1)(t) - VISCOUS * x[1], x[1], [x[2], x[3]]);
        let [z, film] = self.0.derivative(&body);
        [x[1], (body.applied - self.0.force(&body)) / MASS, z, film]
    }
    fn guards(&mut self, _: f64, _: &[f64; 4]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 4]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// What became of a push: position, velocity, states, and what it cost.
fn pushed(
    model: LuGre,
    force: impl Fn(f64) -> f64,
    tolerance: f64,
    until: f64,
) -> Result<([f64; 4], u64), IntegrationError> {
    let scale = [0.1, 1.0, 1e-3, 1.0];
    let mut integrator = Integrator::<4, 0, 0>::new(Method::DormandPrince, tolerance, scale, [0.0; 4]);
    integrator.integrate_to(&mut Pushed(model, force), until, until)?;
    Ok((*integrator.state(until), integrator.statistics().n_rhs_evaluations))
}

#[test]
fn a_load_breaks_away_at_its_stiction_and_the_nearer_the_slower_the_force_grows() {
    for (sign, stiction) in [(1.0, 70.0), (-1.0, 40.0)] {
        let breaks_away_at = |rate: f64| {
            // What a creeping load has of film and of Stribeck's fall would let it go earlier.
            let model = friction(&["load.film_growth_s=100", "load.stribeck_exponent=2"]);
            let (mut pushed, mut t) = (Pushed(model, |t: f64| sign * rate * t), 0.0);
            let mut integrator =
                Integrator::<4, 0, 0>::new(Method::DormandPrince, 1e-10, [0.1, 1.0, 1e-3, 1.0], [0.0; 4]);
            while integrator.state(t)[1].abs() < 0.02 {
                t += 1e-3 * stiction / rate;
                integrator.integrate_to(&mut pushed, t, t).expect("a solution");
            }
            rate * t
        };
        let off = [100.0, 10.0, 1.0].map(|rate| (breaks_away_at(rate) / stiction - 1.0).abs());
        assert!(off[0] < 0.15 && off[1] < 0.3 * off[0] && off[2] < 0.3 * off[1], "{off:?}");
    }
}

#[test]
fn a_load_held_below_its_stiction_stays_where_its_bristles_have_yielded_to() {
    let slowly = |t: f64| 35.0 * (t / 10.0).min(1.0);
    let ([x, v, ..], _) = pushed(friction(&[]), slowly, 1e-10, 20.0).expect("a solution");
    let travel = -70.0 / 1e5 * (1.0_f64 - 35.0 / 70.0).ln();
    assert!(v.abs() < 1e-9 && (x / travel - 1.0).abs() < 0.02, "{x} m, not {travel}; {v} m/s");
}

/// f = 1 - exp(-t/t_g) from rest at more than v_b, then exp(-t/t_d) once the load stands.
#[test]
fn the_film_grows_and_thins_with_its_own_times() {
    let states = led(friction(&[]), |t| if t < 0.1 { 0.4 } else { 0.0 }, &[0.02, 0.1, 0.4]);
    let grown = 1.0 - (-0.1_f64 / 0.05).exp();
    let expected = [1.0 - (-0.02_f64 / 0.05).exp(), grown, grown * (-0.3_f64 / 0.2).exp()];
    for (state, expected) in states.into_iter().zip(expected) {
        assert!((state[1] - expected).abs() < 1e-8, "{} {expected}", state[1]);
    }
}

/// The loop of the source's measurements: at the same low speed more friction on the way up than on the way down.
#[test]
fn a_film_that_is_late_makes_a_loop_over_the_speed_which_is_wider_at_a_higher_frequency() {
    let width = |hz: f64| {
        let speed = move |t: f64| 0.03 - 0.03 * (std::f64::consts::TAU * hz * t).cos();
        let model = friction(&["load.film_decay_s=0.5"]);
        let states = led(model, speed, &[5.25 / hz, 5.75 / hz]);
        let [up, down] = [states[0], states[1]].map(|states| model.force(&body(0.0, 0.03, states)));
        up - down
    };
    let [slow, fast] = [0.05, 0.5].map(width);
    assert!(slow > 0.1 && fast > 2.0 * slow, "{slow} N at 0.05 Hz, {fast} N at 0.5 Hz");
}

#[test]
fn the_fluid_acts_as_a_mass_of_viscous_friction_times_its_lag() {
    let model = friction(&["load.fluid_lag_s=0.02"]);
    for (applied, states) in [(50.0, [1e-4, 0.2]), (-20.0, [0.0, 1.0])] {
        let body = body(applied, 0.3, states);
        let bristles = friction(&[]).force(&body);
        let acceleration = (applied - model.force(&body)) / MASS;
        assert!((acceleration * (MASS + VISCOUS * 0.02) - (applied - bristles)).abs() < 1e-12);
    }
}

#[test]
fn friction_gives_no_energy_over_a_cycle_however_large() {
    let model = friction(&[]);
    for amplitude in [1e-6, 1e-4, 1e-2, 0.5] {
        let period = 0.2;
        let speed = move |t: f64| amplitude * (std::f64::consts::TAU * t / period).sin();
        let times: Vec<f64> = (0..=2000).map(|i| period * (4.0 + f64::from(i) / 2000.0)).collect();
        let states = led(model, speed, &times);
        let power = |i: usize| speed(times[i]) * model.force(&body(0.0, speed(times[i]), states[i]));
        let lost: f64 = (0..2000).map(|i| 0.5 * (power(i) + power(i + 1)) * period / 2000.0).sum();
        assert!(lost >= 0.0, "{amplitude} m/s: {lost} J");
    }
}

#[test]
fn the_rate_of_the_force_is_its_slope_along_the_motion() {
    let model = friction(&["load.fluid_lag_s=0.01", "load.stribeck_exponent=2"]);
    for (v, states) in [(0.03, [3e-4, 0.3]), (-0.01, [1e-4, 0.1]), (0.4, [4e-4, 1.0])] {
        let (here, acceleration, applied_rate) = (body(60.0, v, states), 4.0, 700.0);
        let rates = model.derivative(&here);
        let later = |t: f64| {
            let states = [0, 1].map(|i| states[i] + rates[i] * t);
            model.force(&body(60.0 + applied_rate * t, v + acceleration * t, states))
        };
        let slope = (later(1e-6) - later(-1e-6)) / 2e-6;
        let rate = model.force_rate(&here, acceleration, applied_rate);
        assert!((rate / slope - 1.0).abs() < 1e-4, "{v} m/s: {rate} {slope} N/s");
    }
}

/// Stick, slide, turn about: soft bristles and stiff ones, whose rate of decay in a slide is s_0 v/g, 1e5 to 1e6 /s.
#[test]
fn soft_and_stiff_bristles_converge_with_the_tolerance_at_a_bounded_cost() {
    let force = |t: f64| 90.0 * (std::f64::consts::TAU * 4.0 * t).sin();
    for stiffness in ["1e4", "1e5", "1e6", "1e7"] {
        let model = friction(&[&format!("load.bristle_stiffness_n_per_m={stiffness}")]);
        let of = |tolerance| {
            pushed(model, force, tolerance, 0.5).unwrap_or_else(|why| panic!("{stiffness}: {why}"))
        };
        let ([exact, ..], _) = of(1e-12);
        let [(coarse, _), (middle, _), (fine, cost)] = [1e-6, 1e-8, 1e-10].map(of);
        let errors = [coarse, middle, fine].map(|state| (state[0] - exact).abs());
        println!("{stiffness}: {exact} {errors:?} {cost}");
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 1e-8, "{stiffness}: {errors:?}");
        assert!(cost < 2_000_000, "{stiffness}: {cost} evaluations");
    }
}
