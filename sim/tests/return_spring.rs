//! A return spring in the cylinder (`actuator.return_spring`): the closed forms of a mass on a spring, with and without air.

use pneudrive_sim::component::friction::{Contact, States};
use pneudrive_sim::component::load::Load;
use pneudrive_sim::component::stop::Side;
use pneudrive_sim::{Accuracy, Method, Rig, Run, keys, run};
use pneudrive_solver::{Derivative, Event, Integrator, System};

use pneudrive_controller::parameters::id;

use crate::settings::NO_FRICTION;

fn rig(name: &str, settings: &[&str]) -> Rig {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn simulate(rig: &Rig) -> Run {
    run(rig, Accuracy::of(rig)).expect("a transient")
}

const STROKE: f64 = 0.3;
const PRELOAD: f64 = 60.0;
const STIFFNESS: f64 = 500.0;
const SPRING: [&str; 2] =
    ["actuator.return_spring_preload_n=60", "actuator.return_spring_stiffness_n_per_m=500"];
const RETRACT: &str = "actuator.return_spring=retract";
const EXTEND: &str = "actuator.return_spring=extend";
/// A valve that is shut by an overlap without clearance.
const SHUT: [&str; 6] = [
    "controller.loop=open",
    "test.moves=[[0.0, 0]]",
    "test.duration_s=0.5",
    "operator.dither_mm=0",
    "valve.spool_diameter_mm=10",
    "valve.underlap_mm=0.5",
];

/// The load of a rig without a cylinder.
struct Alone(Load);

impl System<2, 0, 0> for Alone {
    fn derivative(&mut self, _: f64, x: &[f64; 2]) -> [f64; 2] {
        let applied = self.0.applied_force(0.0, Side::Free, x[0], x[1]);
        let body = self.0.body(applied, x[1], (Contact::Free, States::default()));
        [x[1], self.0.acceleration(&body)]
    }
    fn guards(&mut self, _: f64, _: &[f64; 2]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 2]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// y = y_e + (y_0 - y_e) cos(sqrt(k/M) t), y_e: where a constant force balances the spring.
#[test]
fn a_mass_on_the_spring_without_air_and_friction_swings_as_the_closed_form_does() {
    let at_end = PRELOAD + STIFFNESS * STROKE;
    for (end, force, middle) in
        [(RETRACT, 135.0, (135.0 - PRELOAD) / STIFFNESS), (EXTEND, -135.0, (at_end - 135.0) / STIFFNESS)]
    {
        let pushed = format!("load.constant_force_n={force}");
        let rig = rig("servo-b", &[&NO_FRICTION[..], &SPRING, &[end, &pushed]].concat());
        let (mass, start) = (rig.get(&keys::load::MASS_KG), middle - 0.1);
        let rate = (STIFFNESS / mass).sqrt();
        let mut alone = Alone(Load::of(&rig));
        let mut integrator =
            Integrator::<2, 0, 0>::new(Method::DormandPrince, 1e-12, [0.1, 1.0], [start, 0.0]);
        for step in 1..=200 {
            let t = 0.01 * f64::from(step);
            integrator.integrate_to(&mut alone, t, t).expect("smooth");
            let [y, v] = *integrator.state(t);
            let expected = middle + (start - middle) * (rate * t).cos();
            assert!((y - expected).abs() < 1e-9, "{end} at {t} s: {y} m, not {expected}");
            let energy = 0.5 * mass * v * v + 0.5 * STIFFNESS * (y - middle).powi(2);
            assert!((energy / (0.5 * STIFFNESS * 0.01) - 1.0).abs() < 1e-9, "{end} at {t} s: {energy} J");
        }
    }
}

/// P_1 A_1 = P_2 A_2 + P_e A_R - F_s. Nothing holds the piston but its air, and it stays where it is.
#[test]
fn a_test_starts_where_the_charged_chamber_balances_the_spring() {
    for (end, force) in [(RETRACT, -PRELOAD - STIFFNESS * 0.1), (EXTEND, PRELOAD + STIFFNESS * 0.2)] {
        let settings =
            [&SHUT[..], &NO_FRICTION, &SPRING, &[end, "test.position_m=0.1", "valve.null_offset_mm=0"]]
                .concat();
        let rig = rig("servo-b", &settings);
        let run = simulate(&rig);
        let (first, last) = (run.rows[0].plant, run.rows.last().expect("rows").plant);
        assert!((first.actuator_force + force).abs() < 1e-9, "{end}: {} N", first.actuator_force);
        assert!((last.position - 0.1).abs() < 1e-9, "{end}: {} m", last.position);
    }
}

/// Internal energy of the air, kinetic energy, that of the spring, and the work of the surroundings on the rod.
#[test]
fn a_piston_that_swings_on_its_air_and_its_spring_keeps_the_energy_of_all() {
    let blind = std::f64::consts::PI / 4.0 * 0.05 * 0.05;
    let rod_side = blind - std::f64::consts::PI / 4.0 * 0.025 * 0.025;
    for (end, stretched) in [(RETRACT, 0.0), (EXTEND, STROKE)] {
        let rig =
            rig("servo-b", &[&SHUT[..], &NO_FRICTION, &SPRING, &[end, "test.pressure_1_pa=500000"]].concat());
        let run = simulate(&rig);
        let energies: Vec<f64> = run
            .rows
            .iter()
            .map(|row| {
                let plant = &row.plant;
                let volumes = [blind * plant.position + 2e-5, rod_side * (STROKE - plant.position) + 2e-5];
                let internal = (plant.pressures[0] * volumes[0] + plant.pressures[1] * volumes[1]) / 0.4;
                let pressed = (plant.position - stretched).abs();
                let spring = PRELOAD * pressed + 0.5 * STIFFNESS * pressed * pressed;
                let kinetic = 0.5 * 1.6 * plant.velocity * plant.velocity;
                internal + spring + kinetic + 101_300.0 * (blind - rod_side) * plant.position
            })
            .collect();
        let travel = run.rows.iter().map(|row| row.plant.position).fold(0.0, f64::max);
        assert!(travel > 0.12, "{end}: the piston swings: {travel}");
        let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|of| energies.iter().copied().reduce(of).expect("rows"));
        assert!((high - low) / high < 1e-9, "{end}: {low} to {high} J");
    }
}

#[test]
fn an_open_loop_with_a_spring_converges_with_the_tolerance() {
    for (name, end) in [("servo-a", RETRACT), ("servo-b", EXTEND), ("servo-c", RETRACT)] {
        let open = [
            "controller.loop=open",
            "test.moves=[[0.0, 600], [0.15, 0], [0.25, -600], [0.4, 0]]",
            "test.duration_s=0.5",
            end,
            "actuator.return_spring_preload_n=2",
        ];
        let rig = rig(name, &open);
        let at = |tolerance| run(&rig, Accuracy { tolerance, ..Accuracy::default() }).expect("a transient");
        let exact = at(1e-12);
        let errors = [1e-6, 1e-8, 1e-10].map(|tolerance| {
            let pairs = at(tolerance).rows.into_iter().zip(&exact.rows);
            pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
        });
        println!("{name}: {errors:?} m");
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 2e-8, "{name}: {errors:?}");
    }
}

/// `cascade` knows no force that depends on the position: it has that in the middle of the stroke beforehand.
#[test]
fn the_law_by_a_model_knows_the_springs_force_in_the_middle_of_the_stroke() {
    let of = |settings: &[&str]| {
        let text = include_str!("cascade/press.toml");
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let rig = Rig::read_with("press", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
        let stroke = rig.get(&keys::actuator::STROKE_M);
        (rig.parameters().get(id::CASCADE_STANDING_FORCE).expect("a parameter"), stroke)
    };
    let (without, stroke) = of(&[]);
    for (end, sign) in [(RETRACT, 1.0), (EXTEND, -1.0)] {
        let (with, _) = of(&[&SPRING[..], &[end]].concat());
        let alike = format!("load.constant_force_n={}", -sign * (PRELOAD + 0.5 * STIFFNESS * stroke));
        assert_ne!(with, without);
        assert_eq!(with, of(&[&alike]).0, "{end}");
    }
}

#[test]
fn a_key_of_a_spring_without_a_spring_is_refused() {
    let problems = Rig::read("test", "[actuator]\nreturn_spring_preload_n = 70.0\n").expect_err("no spring");
    assert!(
        problems.to_string().contains("has no effect with actuator.return_spring = \"none\""),
        "{problems}"
    );
}
