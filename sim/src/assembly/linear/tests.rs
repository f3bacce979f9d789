use super::*;
use crate::assembly::build;
use crate::assembly::{Integration, scale_of};
use crate::component::operator::Request;
use crate::values::Rig;
use pneudrive_solver::Method;

/// A drive of a rig, and where it is, 50 ms after its valve has opened.
fn moving(rig: &Rig) -> (Assembly, f64, StateVector) {
    let (parts, x) = build::drive(rig);
    let scale = scale_of(&parts);
    let mut assembly = Assembly::new(parts, &x);
    let mut integrator = Integration::of_parts(Method::DormandPrince, 1e-11, scale, x);
    let request = Request { counts: 900, step: 1 };
    for step in 0..20 {
        let t = 5e-4 * f64::from(step);
        integrator.interrupt(&mut assembly, t, |assembly, x| assembly.drive(t, x, request));
        integrator.integrate_to(&mut assembly, t + 5e-4, t + 5e-4).expect("integrated");
    }
    integrator.integrate_to(&mut assembly, T, T).expect("integrated");
    let x = *integrator.state(T);
    (assembly, T, x)
}

const T: f64 = 0.05;

fn rig(name: &str, settings: &[&str]) -> Rig {
    let text = crate::rigfile::builtin(name).expect("built in");
    let settings: Vec<String> = settings.iter().map(|text| (*text).to_owned()).collect();
    Rig::read_with(name, text, &settings).expect("valid")
}

fn rigs() -> Vec<Rig> {
    let all = ["tubing.lag_s=0.003", "sensors.pressure_lag_s=0.004", "load.friction=\"lugre\""];
    vec![
        rig("servo-a-tuned", &[]),
        rig("servo-b-tuned", &["operator.dither_mm=0"]),
        rig("servo-b-tuned", &["operator.model=\"solenoid-empirical\"", "operator.dither_mm=0"]),
        rig("servo-b-tuned", &all),
        rig("servo-b-tuned", &["supply.model=\"receiver\"", "operator.dither_mm=0"]),
        rig("press", &[]),
    ]
}

/// The error of a plain difference of each column to the model, for a step that is so many times the usual one: of the
/// row where it is largest, over what states of their usual sizes do to that row.
fn errors(equations: &mut Equations, model: &LinearModel, times: f64) -> Vec<f64> {
    let rows: Vec<&Vec<f64>> = model.a.iter().chain(&model.c).collect();
    let sizes: Vec<f64> = (0..model.states.len()).map(|j| equations.step(j) / STEP).collect();
    let effect =
        |row: &[f64]| row.iter().zip(&sizes).map(|(slope, size)| (slope * size).abs()).fold(0.0, f64::max);
    let mut at = model.state.clone();
    let column = |j: usize| {
        let step = times * STEP * sizes[j];
        let mut beside = |offset: f64| {
            at[j] = model.state[j] + offset;
            let values = equations.evaluate(&at, model.command_counts);
            at[j] = model.state[j];
            values
        };
        let (above, below) = (beside(step), beside(-step));
        let error =
            |i: usize| ((above[i] - below[i]) / (2.0 * step) - rows[i][j]) * sizes[j] / effect(rows[i]);
        (0..rows.len()).map(|i| error(i).abs()).fold(0.0, f64::max)
    };
    (0..sizes.len()).map(column).collect()
}

/// What rounding leaves of such an error.
const ROUNDING: f64 = 1e-8;

#[test]
fn differences_approach_the_model_in_second_order() {
    let mut others = Vec::new();
    for rig in rigs() {
        let (assembly, t, x) = moving(&rig);
        let model = assembly.linearise(t, &x, 900.0).expect("slopes");
        let mut equations = Equations::about(assembly, t, &x).expect("a spool that follows");
        let [coarse, fine] = [16.0, 8.0].map(|times| errors(&mut equations, &model, times));
        for (name, (coarse, fine)) in model.states.iter().zip(coarse.into_iter().zip(fine)) {
            let is_second = (3.8..=4.2).contains(&(coarse / fine));
            if !is_second && coarse > ROUNDING {
                others.push(format!("{}, {name}: {coarse:e}, {fine:e}", rig.name()));
            }
        }
    }
    assert!(others.is_empty(), "{others:#?}");
}

#[test]
fn what_follows_no_law_has_no_linear_model() {
    let (assembly, t, x) = moving(&rig("bang-bang", &[]));
    assert_eq!(assembly.linearise(t, &x, 0.0), Err(NotLinear::NoSpoolLaw));
}
