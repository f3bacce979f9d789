//! Stiction and stops on a mass, with the load's own components and the integrator, against closed
//! forms.

use pneudrive_sim::Method;
use pneudrive_sim::component::friction::{Body, Contact, DryFriction, Friction, FrictionModel, States};
use pneudrive_sim::component::load::Load;
use pneudrive_sim::component::stop::{Side, Stops};
use pneudrive_solver::{Derivative, Event, Integrator, System};

/// A load that is pulled through a spring by its end at `pull * t`, and pushed by a constant force.
struct Pulled {
    load: Load,
    spring: f64,
    pull: f64,
    contact: Contact,
    side: Side,
    /// When the contact changed, and where.
    changes: Vec<(f64, f64)>,
}

impl Pulled {
    fn applied(&self, t: f64, x: &[f64; 2]) -> f64 {
        self.load.applied_force(self.spring * (self.pull * t - x[0]), self.side, x[0], x[1])
    }

    fn body(&self, t: f64, x: &[f64; 2]) -> Body {
        self.load.body(self.applied(t, x), x[1], (self.contact, States::default()))
    }
}

impl System<2, 2, 0> for Pulled {
    fn derivative(&mut self, t: f64, x: &[f64; 2]) -> [f64; 2] {
        [x[1], self.load.acceleration(&self.body(t, x))]
    }
    fn guards(&mut self, t: f64, x: &[f64; 2]) -> [f64; 2] {
        let friction = self.load.friction.guard(&self.body(t, x));
        [friction, self.load.stops.guard(self.side, x[0])]
    }
    fn handle_event(&mut self, event: Event, t: f64, x: &mut [f64; 2]) -> Derivative {
        if event == Event::Guard(1) {
            self.side = self.load.stops.after(self.side, x[0]);
            return Derivative::Discontinuous;
        }
        if self.contact != Contact::Stuck {
            x[1] = 0.0;
        }
        self.contact = self.load.friction.after(self.contact, self.applied(t, x));
        self.changes.push((t, x[0]));
        Derivative::Discontinuous
    }
}

const MASS: f64 = 1.6;

fn load(friction: DryFriction, force: f64, viscous: f64, stops: Stops) -> Load {
    Load {
        mass: MASS,
        viscous,
        constant_force: force,
        spring: 0.0,
        uphill: 0.0,
        friction: Friction::Coulomb(friction),
        stops,
    }
}

fn integrator(x: [f64; 2]) -> Integrator<2, 2, 0> {
    Integrator::new(Method::DormandPrince, 1e-12, [0.1, 1.0], x)
}

const SPRING: f64 = 1e4;
const PULL: f64 = 2e-3;
/// C(46), C(47).
const STATIC: f64 = 70.0;
const COULOMB: f64 = 40.0;

fn pulled_over_a_dry_surface() -> Pulled {
    let far = Stops::new(-1.0, 1.0, 1e6, 1e-3, 0.5, MASS);
    Pulled {
        load: load(DryFriction::symmetric(STATIC, COULOMB), 0.0, 0.0, far),
        spring: SPRING,
        pull: PULL,
        contact: Contact::Stuck,
        side: Side::Free,
        changes: Vec::new(),
    }
}

/// With u the stretch of the spring less F_c/k, a slip begins at u = A = (F_s - F_c)/k and u' = V, and
/// goes along a circle in (u, u'/w) until u' is V again, at u = -A: it takes
/// 2 (pi - atan(A w/V))/w and goes 2 A + V times that; the stick that follows takes 2 A/V.
#[test]
fn a_mass_pulled_slowly_over_a_dry_surface_sticks_and_slips_as_the_closed_form_does() {
    let mut pulled = pulled_over_a_dry_surface();
    integrator([0.0; 2]).integrate_to(&mut pulled, 14.0, 14.0).expect("a transient");
    let (amplitude, rate) = ((STATIC - COULOMB) / SPRING, (SPRING / MASS).sqrt());
    let slip = 2.0 * (std::f64::consts::PI - (amplitude * rate / PULL).atan()) / rate;
    let travel = 2.0 * amplitude + PULL * slip;
    assert_eq!(pulled.changes.len(), 8, "four slips and their ends");
    let mut begin = STATIC / SPRING / PULL;
    for (i, pair) in pulled.changes.chunks(2).enumerate() {
        let [(broke, from), (stuck, to)] = [pair[0], pair[1]];
        assert!((broke - begin).abs() < 1e-8, "slip {i}: at {broke} s, not {begin}");
        assert!((stuck - broke - slip).abs() < 1e-8, "slip {i}: {} s, not {slip}", stuck - broke);
        assert!((to - from - travel).abs() < 1e-10, "slip {i}: {} m, not {travel}", to - from);
        begin += slip + 2.0 * amplitude / PULL;
    }
}

#[test]
fn a_mass_that_sticks_has_no_velocity_at_all_while_the_force_on_it_grows() {
    let mut pulled = pulled_over_a_dry_surface();
    let mut integrator = integrator([0.0; 2]);
    let mut looks = 0;
    for step in 1..14_000 {
        let t = f64::from(step) * 1e-3;
        integrator.integrate_to(&mut pulled, t, t).expect("a transient");
        let x = integrator.state(t);
        if pulled.contact == Contact::Stuck {
            looks += 1;
            assert_eq!(x[1], 0.0, "at {t}");
            assert!(pulled.applied(t, x).abs() <= STATIC * (1.0 + 1e-12), "at {t}");
        }
    }
    assert!(looks > 13_000, "it sticks most of the time: {looks}");
}

/// 2 (F_s - F_c)/k: the slip of a spring that is pulled at no speed.
#[test]
fn the_slower_the_pull_the_nearer_is_a_slip_to_twice_the_drop_of_friction_over_the_stiffness() {
    let excess = |pull: f64| {
        let mut pulled = Pulled { pull, ..pulled_over_a_dry_surface() };
        let until = STATIC / SPRING / pull + 0.1;
        integrator([0.0; 2]).integrate_to(&mut pulled, until, until).expect("a transient");
        let [from, to] = [pulled.changes[0].1, pulled.changes[1].1];
        to - from - 2.0 * (STATIC - COULOMB) / SPRING
    };
    assert!((excess(1e-3) / excess(1e-4) - 10.0).abs() < 0.2, "{} {}", excess(1e-3), excess(1e-4));
    assert!(excess(1e-4) < 1e-5 && excess(1e-4) > 0.0);
}

const STIFFNESS: f64 = 1e6;

/// A mass without friction near the stop at 0.3 m, pushed with a force.
fn thrown(damping_ratio: f64, force: f64) -> Pulled {
    let stops = Stops::new(0.0, 0.3, STIFFNESS, 1e-3, damping_ratio, MASS);
    Pulled {
        load: load(DryFriction::symmetric(0.0, 0.0), force, 0.0, stops),
        spring: 0.0,
        pull: 0.0,
        contact: Contact::Free,
        side: Side::Free,
        changes: Vec::new(),
    }
}

/// Velocity and deepest penetration of a mass that comes at `speed` and has left the stop again.
fn bounce(damping_ratio: f64, speed: f64) -> (f64, f64) {
    let (mut mass, mut integrator) = (thrown(damping_ratio, 0.0), integrator([0.299, speed]));
    let mut deepest = 0.0_f64;
    for step in 1..=2000 {
        let t = f64::from(step) * 1e-5;
        integrator.integrate_to(&mut mass, t, t).expect("a transient");
        deepest = deepest.max(integrator.state(t)[0] - 0.3);
    }
    assert_eq!(mass.side, Side::Free, "it has left");
    (integrator.state(0.02)[1], deepest)
}

/// C(90): half a period of the mass on the stop's spring, with the amplitude v sqrt(M/K).
#[test]
fn a_stop_without_damping_gives_back_all_energy_and_yields_by_v_times_the_root_of_m_over_k() {
    for speed in [0.3, 1.0, 3.0] {
        let (back, deepest) = bounce(0.0, speed);
        assert!((back / speed + 1.0).abs() < 1e-9, "{speed} m/s: {back}");
        let yielding = speed * (MASS / STIFFNESS).sqrt();
        assert!((deepest / yielding - 1.0).abs() < 1e-4, "{speed} m/s: {deepest} m, not {yielding}");
    }
}

#[test]
fn a_stop_never_gives_more_energy_than_it_takes_and_less_with_more_damping() {
    for speed in [0.1, 0.5, 1.0, 3.0] {
        let mut last = speed;
        for damping_ratio in [0.1, 0.5, 1.0, 2.0] {
            let (back, deepest) = bounce(damping_ratio, speed);
            assert!(back <= 0.0 && -back < last, "{speed} m/s, damping {damping_ratio}: {back}");
            assert!(deepest <= speed * (MASS / STIFFNESS).sqrt(), "{speed} m/s: {deepest} m");
            last = -back;
        }
    }
}

/// EQUATIONS section 6: the overtravel at rest is F/K, 0.5 to 0.9 mm at 589 kPa.
#[test]
fn a_mass_pressed_into_a_stop_comes_to_rest_at_the_force_over_the_stiffness() {
    let mut mass = thrown(0.5, 900.0);
    let mut integrator = integrator([0.299, 0.0]);
    integrator.integrate_to(&mut mass, 1.0, 1.0).expect("a transient");
    let x = integrator.state(1.0);
    assert!((x[0] - 0.3 - 900.0 / STIFFNESS).abs() < 1e-9 && x[1].abs() < 1e-9, "{x:?}");
}
