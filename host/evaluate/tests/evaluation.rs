//! The figures of moves on simulated drives: what a record shows, and what it is too short for.

use pneudrive_evaluate::evaluation::{LimitCycle, Motion, Move, moves};
use pneudrive_evaluate::transient::Transient;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Accuracy, Rig, run};

/// The transient of a built-in rig with settings.
fn simulated(name: &str, settings: &[&str]) -> Transient {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let rig = Rig::read_with(name, builtin(name).expect("a built-in rig"), &settings)
        .unwrap_or_else(|problems| panic!("{problems}"));
    let run = run(&rig, Accuracy::of(&rig)).unwrap_or_else(|error| panic!("{name}: {error}"));
    Transient::of_run(name, &StoredRun::of(&rig, &run))
}

/// The step of a transient as a record of so many seconds has it.
fn step(transient: &Transient, seconds: f64) -> Move {
    let part = transient.between(0.0, seconds);
    moves(&part, &Motion::of(&part), None, 0.05).pop().expect("a step")
}

const STEP: [&str; 2] = ["test.moves=[[0.0, 8192], [0.3, 14192]]", "test.duration_s=8.0"];

/// Rigs with a step of 72 mm at 0.3 s: with too much load for their gains, with much friction, and as they are.
fn drives() -> Vec<(&'static str, Vec<&'static str>)> {
    let heavy = ["load.mass_kg=20.0", "controller.velocity_gain=200"];
    let heavier = ["load.mass_kg=40.0", "controller.velocity_gain=200"];
    let sticky = ["load.static_extend_n=120", "load.static_retract_n=90"];
    let with = |name, settings: &[&'static str]| (name, [STEP.as_slice(), settings].concat());
    vec![
        with("servo-b-tuned", &heavy),
        with("servo-b-tuned", &heavier),
        with("servo-b-tuned", &sticky),
        with("servo-a-tuned", &heavy),
        with("servo-a-tuned", &heavier),
        with("servo-c-tuned", &heavy),
        with("servo-a", &[]),
        with("servo-a-tuned", &[]),
        with("servo-b", &[]),
        with("servo-b-tuned", &[]),
        with("servo-c", &[]),
        with("servo-c-tuned", &[]),
        with("lut-stepper", &[]),
        with("lut-solenoid", &[]),
        with("burrows", &[]),
    ]
}

#[test]
fn a_drive_that_swings_by_77_mm_to_either_side_is_seen_to_do_so_in_1_7_s() {
    let heavy = simulated("servo-b-tuned", &drives()[0].1);
    let LimitCycle::Sustained(found) = step(&heavy, 2.0).limit_cycle else { panic!("it swings") };
    assert!((found.swing_mm / 2.0 - 75.0).abs() < 3.0 && (found.frequency_hz - 3.4).abs() < 0.1, "{found:?}");
    let LimitCycle::Sustained(later) = step(&heavy, 8.0).limit_cycle else { panic!("it swings") };
    assert!((found.swing_mm / later.swing_mm - 1.0).abs() < 0.05, "{found:?} {later:?}");
}

/// What is told of a limit cycle after a time holds for all longer records of it.
#[test]
fn a_longer_record_confirms_what_a_shorter_one_decides() {
    let mut decided = [0; 2];
    for (name, settings) in drives() {
        let drive = simulated(name, &settings);
        let last = step(&drive, 8.0);
        let what = |seconds: f64| format!("{name} {:?} in {seconds} s", &settings[2..]);
        for seconds in [0.6, 1.0, 1.5, 2.0, 3.0, 4.5] {
            let short = step(&drive, seconds);
            match (short.limit_cycle, last.limit_cycle) {
                (LimitCycle::Undecided(_), _) => {}
                (LimitCycle::None { .. }, LimitCycle::None { .. }) => decided[0] += 1,
                (LimitCycle::Sustained(short), LimitCycle::Sustained(long)) => {
                    let ratio = short.swing_mm / long.swing_mm;
                    assert!((0.75..1.25).contains(&ratio), "{}: {short:?} {long:?}", what(seconds));
                    decided[1] += 1;
                }
                (short, long) => panic!("{}: {short:?}, later {long:?}", what(seconds)),
            }
            for (short, last) in [
                (short.overshoot_mm, last.overshoot_mm),
                (short.settling_s, last.settling_s),
                (short.rise_s, last.rise_s),
            ] {
                let same =
                    |(short, last): (f64, f64)| short <= last * 1.01 + 1e-6 && short >= 0.75 * last - 1e-6;
                assert!(short.zip(last).is_none_or(same), "{}: {short:?} {last:?}", what(seconds));
            }
        }
    }
    assert!(
        decided[0] >= 12 && decided[1] >= 12,
        "none and limit cycles that were decided early: {decided:?}"
    );
}

#[test]
fn a_step_that_is_cut_while_it_goes_on_shows_nothing_of_its_end() {
    let drive = simulated("servo-b-tuned", &STEP);
    let cut = step(&drive, 0.45);
    assert!(matches!(cut.limit_cycle, LimitCycle::Undecided(_)), "{cut:?}");
    let figures = [cut.rise_s, cut.overshoot_mm, cut.settling_s, cut.steady_error_mm];
    assert_eq!(figures, [None; 4], "{cut:?}");
}
