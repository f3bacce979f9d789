//! From answers to a rig file.

use std::f64::consts::PI;

use pneudrive_sim::rig::{Source, all_keys};
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Accuracy, Rig, keys, run};

use super::*;
use crate::parts::{Family, parts};

const OWN: &[(&str, &str)] = &[
    ("cylinder", "iso-15552-32"),
    ("stroke", "250 mm"),
    ("mass", "8 kg"),
    ("valve", "proportional-5-3-350"),
];

fn with(more: &[(&'static str, &'static str)]) -> Vec<(&'static str, &'static str)> {
    OWN.iter()
        .copied()
        .filter(|(name, _)| !more.iter().any(|(other, _)| other == name))
        .chain(more.iter().copied())
        .collect()
}

fn rig(given: &[(&str, &str)]) -> Rig {
    let text = rig_file("own", &Answers::of(given)).unwrap_or_else(|wrong| panic!("{wrong:?}"));
    Rig::read("own.toml", &text).unwrap_or_else(|problems| panic!("{problems}\n{text}"))
}

fn refusal(given: &[(&str, &str)]) -> String {
    let wrong = rig_file("own", &Answers::of(given)).expect_err("refused");
    assert_eq!(wrong.len(), 1, "{wrong:?}");
    wrong[0].to_string()
}

#[test]
fn four_answers_make_a_drive_that_runs() {
    let rig = rig(OWN);
    assert_eq!(rig.get(&keys::actuator::BORE_M), 0.032);
    assert_eq!(rig.get(&keys::actuator::STROKE_M), 0.25);
    let run = run(&rig, Accuracy::of(&rig)).expect("it runs");
    assert!(run.rows.last().is_some_and(|row| row.time > 2.0), "to the end of its test");
}

/// What the gains to begin with are for: a step over half of the stroke arrives, whatever the valve's overlap turns out to be.
#[test]
fn the_first_step_of_a_gain_profile_arrives_within_2_percent_of_the_stroke() {
    for more in FIRST_STEPS {
        let own = rig(&with(&[more, &[("law", "gain-profile")]].concat()));
        let stroke = own.get(&keys::actuator::STROKE_M);
        for overlap_mm in [0.0, 0.025, 0.05] {
            let (end, furthest) = first_step(&own, overlap_mm);
            assert!((end - 0.75 * stroke).abs() < 0.02 * stroke, "{more:?} {overlap_mm}: ends at {end} m");
            assert!(furthest < 0.80 * stroke, "{more:?} {overlap_mm}: not far beyond, to {furthest} m");
        }
    }
}

/// The law that positions is written wherever it can be. A step of it ends within a fifth of a millimetre whatever the valve's
/// overlap turns out to be; that of the press within a twentieth.
#[test]
fn the_first_step_of_a_drive_that_has_a_model_arrives_within_a_fifth_of_a_millimetre() {
    for more in FIRST_STEPS {
        let own = rig(&with(more));
        let has_tubes = more.iter().any(|(question, _)| *question == "tube");
        let law = if has_tubes { Law::GainProfile } else { Law::Cascade };
        assert_eq!(own.get(&keys::controller::LAW), law, "{more:?}");
        let target = 0.75 * own.get(&keys::actuator::STROKE_M);
        let within = if more.is_empty() { 0.05e-3 } else { 0.2e-3 };
        for overlap_mm in [0.0, 0.025, 0.05].into_iter().filter(|_| law == Law::Cascade) {
            let (end, furthest) = first_step(&own, overlap_mm);
            assert!((end - target).abs() < within, "{more:?} {overlap_mm}: ends at {end} m");
            assert!(furthest < target + 2.0 * within, "{more:?} {overlap_mm}: not beyond, to {furthest} m");
        }
    }
}

#[test]
fn a_law_without_gains_to_begin_with_is_refused_by_its_answer() {
    let refused = refusal(&with(&[("law", "pid")]));
    assert!(refused.starts_with("--law: must be \"cascade\" or \"gain-profile\", is \"pid\""), "{refused}");
    let tubes = with(&[("law", "cascade"), ("tube", "pu-6x4"), ("tube-length", "0.5 m")]);
    let refused = refusal(&tubes);
    assert!(refused.starts_with("--law: \"cascade\" makes no rig, as controller.law"), "{refused}");
    assert!(refused.contains("the valve at the cylinder"), "{refused}");
}

#[test]
fn a_file_says_why_its_drive_has_gains_instead_of_a_model() {
    let tubes = [("tube", "pu-6x4"), ("tube-length", "0.5 m")];
    let line = |more: &[(&'static str, &'static str)]| {
        let text = rig_file("own", &Answers::of(&with(more))).expect("a rig");
        text.lines().find(|line| line.starts_with("law = ")).expect("a law").to_owned()
    };
    let why = line(&tubes);
    assert!(
        why.starts_with("law = \"gain-profile\"") && why.contains("# \"cascade\" needs tubing.model"),
        "{why}"
    );
    assert!(why.ends_with("the valve at the cylinder; `pneudrive tune` finds the gains"), "{why}");
    let told = remarks(&Answers::of(&with(&tubes)));
    assert!(told.iter().any(|one| one.contains("the valve at the cylinder; so the drive gets")), "{told:?}");
    assert_eq!(remarks(&Answers::of(&with(&[]))), Vec::<String>::new(), "nothing is lacking");
    let chosen = [&tubes[..], &[("law", "gain-profile")]].concat();
    assert!(line(&chosen).ends_with("# given"), "it was asked for");
}

#[test]
fn the_built_in_press_is_what_four_answers_make() {
    let text = rig_file("press", &Answers::of(OWN)).expect("a rig");
    assert_eq!(builtin("press"), Some(&*text), "sim/rigs/press.toml is that file");
}

/// Drives of the catalogue whose first step is simulated.
const FIRST_STEPS: [&[(&str, &str)]; 8] = [
    &[],
    &[("mass", "30 kg")],
    &[("cylinder", "rodless-25"), ("stroke", "600 mm")],
    &[("resolution", "5 um")],
    &[("tube", "pu-6x4"), ("tube-length", "0.5 m")],
    &[
        ("cylinder", "iso-15552-63"),
        ("stroke", "500 mm"),
        ("mass", "40 kg"),
        ("valve", "proportional-5-3-700"),
    ],
    &[("cylinder", "iso-6432-20"), ("stroke", "100 mm"), ("mass", "2 kg"), ("valve", "proportional-5-3-100")],
    &[("valve", "proportional-5-3-2000"), ("mass", "2 kg")],
];

/// Where a drive ends whose valve turns out to have this overlap, and the furthest place that it comes to, m.
fn first_step(own: &Rig, overlap_mm: f64) -> (f64, f64) {
    let rig = own.with_numbers(&[("valve.underlap_mm", overlap_mm)]).expect("valid");
    let run = run(&rig, Accuracy::of(&rig)).expect("it runs");
    let end = run.rows.last().expect("rows").plant.position;
    (end, run.rows.iter().map(|row| row.plant.position).fold(0.0, f64::max))
}

#[test]
fn every_value_of_the_file_says_where_it_comes_from() {
    let rig = rig(OWN);
    for key in all_keys().filter(|key| rig.is_set(key)) {
        let origin = rig.origin(key);
        assert_ne!(origin.source, Source::Default, "{}", key.path);
        if origin.source != Source::Given {
            assert!(!origin.from.is_empty(), "{}", key.path);
        }
        if origin.source == Source::Unknown {
            assert!(origin.range.is_some(), "{}", key.path);
        }
    }
}

/// By hand: 350 l/min with b = 0.3 are 1.3765 dm3/(s bar) (see [`crate::conductance`]); b from 0.18 to 0.44 makes it uncertain.
#[test]
fn a_nominal_flow_becomes_a_conductance_with_its_range() {
    let rig = rig(&with(&[("flow", "350 l/min")]));
    let key = &keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA;
    assert!((rig.get(key).expect("C") - 1.3765e-8).abs() < 1e-12);
    let [low, high] = rig.origin(key).range.expect("a range");
    assert!((1.24e-8..1.26e-8).contains(&low) && (1.46e-8..1.49e-8).contains(&high), "{low} {high}");
}

#[test]
fn figures_of_the_data_sheet_stand_as_given() {
    let rig = rig(&with(&[
        ("conductance", "1.4 dm3/(s bar)"),
        ("critical-ratio", "0.3"),
        ("bandwidth", "100 Hz"),
        ("friction", "25 N"),
    ]));
    assert_eq!(rig.get(&keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA), Some(1.4e-8));
    assert_eq!(rig.origin(&keys::iso6358::CRITICAL_RATIO).source, Source::Given);
    assert_eq!(rig.origin(&keys::friction::COULOMB_EXTEND_N).source, Source::Given);
    let stiffness = rig.get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2);
    assert!((stiffness / (628.318_530_7_f64.powi(2)) - 1.0).abs() < 1e-5, "{stiffness}");
}

#[test]
fn every_cylinder_with_every_class_of_valve_runs() {
    for cylinder in parts(Family::Cylinder) {
        for valve in ["proportional-5-3-100", "proportional-5-3-2000"] {
            rig(&with(&[("cylinder", &cylinder.name.clone().leak()[..]), ("valve", valve)]));
        }
    }
}

#[test]
fn tubes_add_their_volume_and_their_friction() {
    let near = rig(OWN);
    let far = rig(&with(&[("tube", "nylon-6x4"), ("tube-length", "2 m")]));
    let volume = |rig: &Rig| rig.get(&keys::actuator::RESIDUAL_VOLUME_1_M3);
    let tube = std::f64::consts::PI * 4e-6 * 2.0;
    assert!((volume(&far) - volume(&near) - tube).abs() < 1e-9, "25 cm3 of tube");
    assert_eq!(far.get(&keys::tubing::LENGTH_M), 2.0);
}

#[test]
fn a_supply_is_gauge_or_absolute_and_says_which() {
    let supply = |text: &'static str| rig(&with(&[("supply", text)])).get(&keys::supply::PRESSURE_PA);
    assert_eq!(supply("6 bar(g)"), 701_325.0);
    assert_eq!(supply("7 bar(a)"), 700_000.0);
    for text in ["6 bar", "0.6 MPa", "600 kPa", "600000 Pa", "87 psi", "0,6 MPa"] {
        let told =
            format!("--supply: \"{text}\" may be gauge or absolute: write \"{text}(g)\" or \"{text}(a)\"");
        assert_eq!(refusal(&with(&[("supply", text)])), told);
    }
    assert_eq!(supply("7 bara"), 700_000.0);
    assert_eq!(supply("600000 Pa(a)"), 600_000.0);
    assert_eq!(supply("0.6 MPa(g)"), 701_325.0);
}

#[test]
fn bad_figures_are_named_with_what_to_do() {
    for (more, expected) in [
        (&[("critical-ratio", "1.2")][..], "--critical-ratio: 1.2 is none: b lies from 0 to below 1"),
        (&[("critical-ratio", "0.528")], "--critical-ratio: 0.528 is that of a nozzle"),
        (
            &[("rod", "40 mm")],
            "--rod: the rod of 40 mm is not thinner than the bore of 32 mm: are they swapped?",
        ),
        (&[("tube-length", "150 m"), ("tube-bore", "4 mm")], "--tube-length: 150 m is no tube between"),
        (&[("tube", "nylon-6x4")], "--tube: how long is it?"),
        (&[("flow", "350")], "--flow: needs a unit"),
        (
            &[("flow", "350 l/min, 6 to 5 bar")],
            "--flow: \"6 bar\" may be gauge or absolute: write bar(g) or bar(a)",
        ),
        (&[("flow", "350 l/min, 5 to 6 bar(g)")], "--flow: \"5 to 6 bar(g)\": the pressure falls"),
        (&[("flow", "350 l/min"), ("kv", "0.3")], "--kv: is one figure too many beside --flow"),
        (
            &[("cylinder", "iso-15552-33")],
            "--cylinder: the catalogue has no cylinder iso-15552-33; did you mean",
        ),
        (&[("supply", "0.2 bar(g)")], "--supply: \"0.2 bar(g)\" leaves next to no pressure"),
        (
            &[("friction", "50 N"), ("breakaway", "40 N")],
            "--breakaway: 40 N is below the running friction of 50 N",
        ),
    ] {
        let message = refusal(&with(more));
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn a_large_piston_gets_stops_that_leave_its_dead_volume() {
    let bore_100 = [("cylinder", ""), ("bore", "100 mm"), ("rod", "25 mm")];
    for more in [&bore_100[..], &[("cylinder", "iso-15552-80"), ("supply", "8 bar(g)")]] {
        let rig = rig(&with(more));
        let pressed =
            PI / 4.0 * rig.get(&keys::actuator::BORE_M).powi(2) * rig.get(&keys::supply::PRESSURE_PA);
        let gives_way = pressed / rig.get(&keys::stop::STOP_STIFFNESS_N_PER_M);
        assert!((1e-3..2.001e-3).contains(&gives_way), "{more:?}: {gives_way} m");
    }
    assert!(!rig(OWN).is_set(&keys::stop::STOP_STIFFNESS_N_PER_M), "the usual ones do");
}

/// By hand: 804 mm2 under 6 bar hold 482 N; 30 kg and 0.37 kg of piston and rod weigh 298 N.
#[test]
fn a_vertical_drive_starts_at_pressures_that_hold_its_load() {
    let pressures = |more: &[(&'static str, &'static str)]| {
        let rig = rig(&with(more));
        let start = run(&rig, Accuracy::of(&rig)).expect("it runs").rows[0].plant;
        start.pressures.map(|pressure| pressure / rig.get(&keys::supply::PRESSURE_PA))
    };
    let [first, second] = pressures(&[("incline", "90 deg"), ("mass", "30 kg")]);
    assert!((first - 0.9).abs() < 1e-4 && (0.3..0.6).contains(&second), "{first} {second}");
    let [_, level] = pressures(&[]);
    assert!((level - 0.6).abs() < 1e-6, "{level}");
    for hanging in [("incline", "-90 deg"), ("force", "300 N")] {
        let pressures = pressures(&[hanging, ("mass", "30 kg")]);
        assert!(pressures.iter().all(|part| (0.14..1.0).contains(part)), "{hanging:?}: {pressures:?}");
    }
}

#[test]
fn a_load_that_the_supply_cannot_hold_is_refused_by_the_answer_that_pulls() {
    for (more, expected) in [
        (
            &[("incline", "90 deg"), ("mass", "400 kg")][..],
            "--mass: \"400 kg\" pulls with 3926 N along the stroke in all, and the supply holds 483 N on this piston",
        ),
        (&[("incline", "90 deg"), ("force", "-1 kN")], "--force: \"-1 kN\" pulls with 1082 N"),
    ] {
        let message = refusal(&with(more));
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn an_answer_beyond_what_a_rig_can_have_is_named_itself() {
    for (more, expected) in [
        (&[("stroke", "30 m")][..], "--stroke: \"30 m\" makes no rig, as actuator.stroke_m "),
        (&[("incline", "120 deg")], "--incline: \"120 deg\" makes no rig, as load.incline_deg "),
        (&[("resolution", "1 m")], "--resolution: \"1 m\" makes no rig, as encoder.mm_per_count "),
    ] {
        let message = refusal(&with(more));
        assert!(message.starts_with(expected), "{message}");
    }
}

#[test]
fn a_flow_without_its_pressures_is_taken_as_nominal_and_said_to_be() {
    let remarks = |flow: &'static str| remarks(&Answers::of(&with(&[("flow", flow)])));
    let [remark] = &remarks("350 l/min")[..] else { panic!("one remark") };
    assert!(remark.contains("no pressures") && remark.contains("6 to 5 bar(g)"), "{remark}");
    assert!(remarks("350 l/min, 6 to 5 bar(g)").is_empty());
    let key = &keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA;
    let [bare, stated, free] = ["350 l/min", "350 l/min, 6 to 5 bar(g)", "350 l/min, 6 to 0 bar(g)"]
        .map(|flow| rig(&with(&[("flow", flow)])));
    assert_eq!(bare.get(key), stated.get(key));
    assert!(bare.origin(key).from.contains("taken from 6 to 5 bar(g)"), "{:?}", bare.origin(key));
    // Free flow is choked: 350/60 l/s over 7 bar are 0.833 dm3/(s bar), whatever b is.
    assert!((free.get(key).expect("C") - 0.83333e-8).abs() < 1e-12, "{:?}", free.get(key));
}

#[test]
fn everything_that_is_missing_is_said_at_once() {
    let wrong = rig_file("own", &Answers::default()).expect_err("nothing is known");
    let questions: Vec<&str> = wrong.iter().map(|refusal| refusal.question).collect();
    assert_eq!(questions, ["bore", "flow"], "the cylinder first, and the valve");
}
