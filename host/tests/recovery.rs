//! An identification finds what a virtual rig hides, as exactly as it says; docs/howto/identification.md has a hundred rigs.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::recorded_run::recorded_run;
use pneudrive_identify::figures::Figures;
use pneudrive_identify::parameter::{Parameter, usual};
use pneudrive_identify::recording::Recording;
use pneudrive_identify::{Identification, identify};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, Rig};

use crate::hidden_rigs::Hidden;
use crate::hidden_rigs::coverage::{Coverage, held, spread};
use crate::hidden_rigs::rigs::{any_rig, lacking_rig, live_rig, scaled_rig, shipped_rig};
use crate::program::folder;

fn pneudrive() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_pneudrive"))
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn the_intervals_hold_what_was_hidden_as_often_as_they_say() {
    let mut coverage = Coverage::default();
    let shipped = (1..=3).map(shipped_rig);
    for hidden in shipped.chain((1..=7).map(any_rig)) {
        let folder = folder();
        let trial = hidden.identify(pneudrive(), folder.path()).expect("an identification");
        println!("{}, seed {}: {}", hidden.name, hidden.seed, trial.summary());
        coverage.count(&trial);
    }
    println!("{coverage}");
    assert_eq!(coverage.refused, 0, "the model explains the data of all of them");
    let pooled = coverage.pooled();
    assert!(pooled.len() > 150, "{}", pooled.len());
    // Of a hundred rigs it is 95 to 97 %; ten scatter more, the more so as the errors of a rig depend on one another.
    assert!(held(&pooled) >= 0.88, "intervals too narrow");
    assert!((0.75..1.25).contains(&spread(&pooled)), "errors are not as large as they are said to be");
    assert!(coverage.runs < 10_000 * 10, "a rig costs {} runs", coverage.runs / 10);
}

/// A light load on a strongly dithered valve has moved by 1.1 mm before its first stroke.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_drive_that_its_dither_shakes_is_identified() {
    let folder = folder();
    let trial = scaled_rig(1015).identify(pneudrive(), folder.path()).expect("an identification");
    println!("{}", trial.summary());
    assert!(trial.fits && trial.told.iter().filter(|told| !told.holds()).count() <= 1);
}

/// Between the tests its air keeps what a move has left of warmth, and its spool the side of the hysteresis.
#[test]
fn a_drive_that_goes_on_between_the_tests_is_identified() {
    let folder = folder();
    let trial = live_rig(1).identify(pneudrive(), folder.path()).expect("an identification");
    println!("{}", trial.summary());
    assert!(trial.fits && trial.told.iter().filter(|told| !told.holds()).count() <= 1);
    assert!(trial.runs < 15_000, "{} runs", trial.runs);
}

/// The search ends before the minimum of a long valley, and an error of the clock that is no larger than its tolerance was named
/// as the cause of what was left.
#[test]
fn a_search_goes_on_from_where_the_fit_of_an_effect_has_come_without_needing_it() {
    let folder = folder();
    let trial = scaled_rig(1027).identify(pneudrive(), folder.path()).expect("an identification");
    println!("{}", trial.summary());
    assert!(trial.fits && trial.causes.is_empty());
    assert!(trial.evaluations < 300_000_000, "{} evaluations", trial.evaluations);
}

/// A leak of 0.0017 g/(s bar) moved the null by 15 standard errors in a fit that was said to be one: the residuals
/// together pass for noise.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_leak_is_noticed_by_its_trace_where_all_residuals_together_pass_for_noise() {
    let (folder, hidden) = (folder(), lacking_rig(58));
    assert!(hidden.lacks.as_ref().is_some_and(|lacks| lacks.contains("leakage")), "{hidden:?}");
    let trial = hidden.identify(pneudrive(), folder.path()).expect("an identification");
    println!("{}", trial.summary());
    assert!(!trial.fits);
    let leak = trial.causes.iter().find(|cause| cause.settings.contains("leakage")).expect("it is named");
    let (value, error) = leak.value.expect("a leak is a number");
    let hidden = hidden.truth().expect("valid").get(&keys::leakage::LEAKAGE_COEFFICIENT);
    assert!((value - hidden).abs() < 3.0 * error, "{leak:?}, hidden {hidden:e}");
    assert!(value > 5.0 * error, "{leak:?} is told from none");
}

/// The fit without it ends in another valley, from where another supply temperature seemed to explain all of it.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_cause_is_found_though_the_fit_without_it_ends_far_away() {
    let (folder, hidden) = (folder(), lacking_rig(20));
    assert!(hidden.lacks.as_ref().is_some_and(|lacks| lacks.contains("exhaust.pressure_pa")), "{hidden:?}");
    let trial = hidden.identify(pneudrive(), folder.path()).expect("an identification");
    println!("{}", trial.summary());
    let [exhaust] = trial.causes.as_slice() else { panic!("{:?}", trial.causes) };
    let (value, error) = exhaust.value.expect("a pressure is a number");
    let hidden = hidden.truth().expect("valid").get(&keys::exhaust::PRESSURE_PA);
    let lacking = 101_300.0 - hidden;
    assert!((value - hidden).abs() < 3.0 * error && error < 0.1 * lacking, "{exhaust:?}, hidden {hidden}");
}

/// What is recorded of a rig whose values are hidden.
struct Recorded {
    folder: tempfile::TempDir,
    hidden: Hidden,
}

/// A rig that was identified once for all tests.
fn recorded() -> &'static Recorded {
    static RECORDED: OnceLock<Recorded> = OnceLock::new();
    RECORDED.get_or_init(|| {
        let (folder, hidden) = (folder(), shipped_rig(1));
        hidden.identify(pneudrive(), folder.path()).expect("an identification");
        Recorded { folder, hidden }
    })
}

impl Recorded {
    fn model(&self) -> Rig {
        let open = ["controller.loop=open".to_owned()];
        Rig::read_with("model.toml", &self.hidden.model, &open).expect("valid")
    }

    fn truth(&self) -> Rig {
        self.hidden.truth().expect("valid")
    }

    fn recording(&self, number: usize) -> Recording {
        let path: PathBuf = self.folder.path().join(format!("identified/TARGET{number:02}.DAT"));
        Recording::of("a record", &TargetFile::read(&path).expect("recorded"), &self.model()).expect("whole")
    }

    /// A fit to some of the records.
    fn fit(&self, parameters: Vec<Parameter>, records: &[usize]) -> Identification {
        let recordings: Vec<_> = records.iter().map(|&number| self.recording(number)).collect();
        identify(&self.model(), &recordings, parameters, Accuracy::default(), &mut |_| {}, CancelToken::NEVER)
            .expect("a fit")
    }
}

/// The records of extensions alone: with a half open valve, and after a rest.
const EXTENSIONS: [usize; 2] = [4, 8];

#[test]
fn stiction_and_the_force_balance_are_near_what_was_hidden_without_a_model_of_the_air() {
    let recorded = recorded();
    let recordings: Vec<Recording> = (4..10).map(|number| recorded.recording(number)).collect();
    let figures = Figures::of(&recorded.model(), &recordings);
    for (figure, key, off) in [
        (figures.mass, "load.mass_kg", 0.02),
        (figures.viscous, "load.viscous_n_s_per_m", 0.1),
        (figures.coulomb[0], "load.coulomb_extend_n", 0.1),
        (figures.coulomb[1], "load.coulomb_retract_n", 0.2),
        (figures.stiction[0], "load.static_extend_n", 0.2),
        (figures.stiction[1], "load.static_retract_n", 0.2),
    ] {
        let (figure, hidden) = (figure.expect(key), recorded.truth().number_at(key).expect("a number"));
        println!("{key}: {figure:?}, hidden {hidden}");
        assert!((figure.value / hidden - 1.0).abs() < off, "{key}: {figure:?}, hidden {hidden}");
    }
    assert!(figures.top_speed.iter().all(|speed| speed.is_some_and(|speed| speed > 0.3)));
}

#[test]
fn what_no_sample_depends_on_is_neither_fitted_nor_told_an_interval_of() {
    let recorded = recorded();
    let found = recorded.fit(usual(&recorded.model()), &EXTENSIONS);
    for key in ["load.coulomb_retract_n", "load.static_retract_n"] {
        let unseen = found.unidentifiable.iter().find(|one| one.parameter.key.path == key).expect("not seen");
        assert!(unseen.confused_with.is_empty() && unseen.over_prior == 1.0, "{unseen:?}");
        assert_eq!(found.rig.number_at(key).expect("a number"), unseen.parameter.start, "it keeps its value");
    }
    assert!(found.fits, "{:?}", found.spectrum);
    let truth = recorded.truth();
    let missed = found.estimates.iter().filter(|told| {
        let truth = truth.number_at(told.parameter.key.path).expect("a number");
        !(told.interval[0]..=told.interval[1]).contains(&truth)
    });
    assert!(missed.count() <= 3, "{:?}", found.estimates);
}

/// A record that goes into the cushion at the extended end tells of its throttle, and nothing of the other one.
#[test]
fn the_throttle_of_a_cushion_is_found_from_a_record_that_goes_into_it() {
    let settings = [
        "controller.loop=open",
        "operator.dither_mm=0",
        "test.duration_s=0.9",
        "test.moves=[[0.0, 0], [0.05, 1200], [0.7, -1200], [0.85, 0]]",
        "actuator.cushion=adjustable",
        "actuator.cushion_1_length_m=0.06",
        "actuator.cushion_2_length_m=0.06",
    ];
    let file = Rig::builtin("servo-b").expect("a built-in rig").with_settings(&settings).expect("valid");
    let drive = file.with_settings(&["actuator.cushion_2_conductance_m3_per_s_pa=1.3e-9"]).expect("valid");
    let run = pneudrive_sim::run(&drive, Accuracy::of(&drive)).expect("a transient");
    let record = recorded_run(&drive, &run).expect("a record");
    let recordings = [Recording::of("TARGET01.DAT", &record, &file).expect("whole")];
    let throttles: Vec<Parameter> =
        usual(&file).into_iter().filter(|one| one.key.path.contains("cushion")).collect();
    let paths: Vec<&str> = throttles.iter().map(|one| one.key.path).collect();
    let both = [1, 2].map(|end| format!("actuator.cushion_{end}_conductance_m3_per_s_pa"));
    assert_eq!(paths, both, "both are fitted unless others are named");
    let found = identify(&file, &recordings, throttles, Accuracy::of(&file), &mut |_| {}, CancelToken::NEVER)
        .expect("a fit");
    let [estimate] = found.estimates.as_slice() else { panic!("{:?}", found.estimates) };
    let [least, most] = estimate.interval;
    println!("{}: {least} to {most}", estimate.parameter.key.path);
    assert_eq!(estimate.parameter.key.path, both[1]);
    assert!(found.fits && least < 1.3e-9 && 1.3e-9 < most && most - least < 0.2e-9, "{least} to {most}");
    assert!(found.unidentifiable.iter().any(|unseen| unseen.parameter.key.path == both[0]));
}

/// In extension, a constant force does what stiction and Coulomb friction do together: the data show their differences,
/// and each of them is as uncertain as the file's values of the others.
#[test]
#[ignore = "long: cargo xtask test long"]
fn forces_that_only_act_together_carry_one_another_in_their_intervals() {
    let recorded = recorded();
    let mut parameters = usual(&recorded.model());
    parameters.push(Parameter::of(&recorded.model(), "load.constant_force_n").expect("a number"));
    let found = recorded.fit(parameters, &EXTENSIONS);
    let truth = recorded.truth();
    // The rig lies on an incline, which is a constant force of its own.
    let weight =
        9.806_65 * truth.get(&keys::load::MASS_KG) * truth.get(&keys::load::INCLINE_DEG).to_radians().sin();
    let stiction =
        found.estimates.iter().find(|told| told.parameter.key.path == "load.static_extend_n").expect("told");
    assert!(stiction.assumed > 0.9, "{stiction:?}");
    assert!(stiction.rests_on.iter().any(|share| share.path == "load.constant_force_n"), "{stiction:?}");
    let [low, high] = stiction.interval;
    assert!(
        high - low > 40.0 && (low..=high).contains(&truth.get(&keys::friction::STATIC_EXTEND_N)),
        "{stiction:?}"
    );
    // What the two make together is known to a fraction of a newton.
    let given = stiction.conditional.as_ref().expect("known with another");
    assert!(given.standard_error < 0.2 && given.known.len() == 1, "{given:?}");
    let force = found.rig.get(&keys::load::CONSTANT_FORCE_N);
    let breakaway = truth.get(&keys::friction::STATIC_EXTEND_N) + weight;
    assert!((stiction.value - force - breakaway).abs() < 1.0, "{stiction:?} {force} {breakaway}");
}
