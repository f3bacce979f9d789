//! Hysteresis in whole runs of the continuous controller: the transient of the reference case
//! B_closed_cont with a loop that has a width.

use pneudrive_sim::{Accuracy, Method, Rig, Run, run};

const USUAL: Accuracy = Accuracy { method: Method::DormandPrince, tolerance: 1e-11 };
const FINE: Accuracy = Accuracy { method: Method::DormandPrince, tolerance: 1e-12 };
const MERSON: Accuracy = Accuracy { method: Method::Merson, tolerance: 1e-12 };

fn simulate(settings: &[&str], accuracy: Accuracy) -> Run {
    let text = include_str!("cases/B_closed_cont.toml");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig =
        Rig::read_with("B_closed_cont", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    run(&rig, accuracy).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

/// The largest distance between two transients, m.
fn distance(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.rows.len(), b.rows.len());
    let apart = a.rows.iter().zip(&b.rows).map(|(a, b)| (a.plant.position - b.plant.position).abs());
    apart.fold(0.0, f64::max)
}

/// A narrow loop asks for events that follow each other closely: the load crosses it within a step.
#[test]
fn a_hysteresis_that_vanishes_takes_its_effect_with_it() {
    for model in ["operator.model=solenoid", "operator.model=solenoid-empirical"] {
        let with =
            |percent: &str| simulate(&[model, &format!("operator.hysteresis_percent={percent}")], USUAL);
        let none = with("0");
        let [small, vanishing] = ["1e-3", "1e-6"].map(|percent| distance(&with(percent), &none));
        assert!(small < 3e-5 && vanishing < 2e-3 * small, "{model}: {small} m, {vanishing} m");
    }
}

/// Neither a step size nor a method is in the transient: every turn of the command is found once.
#[test]
fn methods_and_tolerances_agree_on_the_transient_and_on_every_event_in_it() {
    for dither in ["operator.dither_mm=0", "operator.dither_mm=0.2"] {
        let settings = ["operator.hysteresis_percent=5", dither];
        let usual = simulate(&settings, USUAL);
        for accuracy in [FINE, MERSON] {
            let other = simulate(&settings, accuracy);
            assert_eq!(
                other.work.integrator.n_events, usual.work.integrator.n_events,
                "{dither} {accuracy:?}"
            );
            assert!(distance(&other, &usual) < 1e-8, "{dither} {accuracy:?}: {} m", distance(&other, &usual));
        }
    }
}

/// At coarse tolerances a step is longer than the load needs for an entry of the profile, or the command
/// for the slack.
#[test]
fn at_a_coarse_tolerance_events_do_not_pile_up() {
    let gains = ["controller.velocity_gain=1", "controller.acceleration_gain=1"];
    for percent in
        ["operator.hysteresis_percent=0", "operator.hysteresis_percent=1e-3", "operator.hysteresis_percent=5"]
    {
        let [fine, coarse] = [1e-10, 1e-6].map(|tolerance| {
            simulate(&[percent, gains[0], gains[1]], Accuracy { tolerance, ..Accuracy::default() })
        });
        assert!(distance(&fine, &coarse) < 1e-4, "{percent}: {} m", distance(&fine, &coarse));
        simulate(&[percent, gains[0], gains[1]], Accuracy { tolerance: 1e-3, ..Accuracy::default() });
    }
}

#[test]
fn a_finer_trace_does_not_change_the_steps() {
    for percent in ["operator.hysteresis_percent=0", "operator.hysteresis_percent=5"] {
        let [coarse, fine] = ["test.trace_period_s=0.0013", "test.trace_period_s=0.0001"].map(|period| {
            simulate(&[percent, "operator.dither_mm=0.2", "test.duration_s=1.3", period], Accuracy::default())
        });
        assert_eq!(fine.work, coarse.work, "{percent}");
    }
}

/// A test begins where the command before has left the spool; a command beyond the loop makes that one forget it.
#[test]
fn the_side_of_the_loop_on_which_a_test_begins_is_the_spools_place_until_a_command_passes_it() {
    for model in ["solenoid-empirical", "solenoid"] {
        let with = |side: &str| {
            let settings = [
                "controller.law=\"gain-profile\"",
                "controller.loop=open",
                "operator.dither_mm=0",
                "operator.hysteresis_percent=5",
                "test.moves=[[0.0, 0], [0.05, 800]]",
                "test.duration_s=0.3",
            ]
            .map(str::to_owned);
            let own = [format!("operator.model={model}"), format!("operator.hysteresis_side={side}")];
            let rig = Rig::builtin("servo-b")
                .expect("a built-in rig")
                .with_settings(&[&settings[..], &own].concat());
            run(&rig.expect("valid"), USUAL).expect("a run")
        };
        let [lower, middle, upper] = ["-1", "0", "1"].map(with);
        let spool = |run: &Run, at: usize| run.rows[at].plant.spool;
        // 5 % of the range of 1 mm to either side; stiction holds a spool that has a mass.
        let half = if model == "solenoid" { 0.0 } else { 0.05e-3 };
        for (run, side) in [(&lower, -half), (&middle, 0.0), (&upper, half)] {
            assert!((spool(run, 1) - side).abs() < 1e-12, "{model}: {} m", spool(run, 1));
        }
        let last = middle.rows.len() - 1;
        assert!((spool(&lower, last) - spool(&upper, last)).abs() < 1e-9, "{model} has forgotten it");
    }
}
