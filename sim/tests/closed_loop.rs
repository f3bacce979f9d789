//! The drive as its user sees it: requirements on the closed loop of the built-in rigs.

use pneudrive_sim::{Accuracy, Method, Rig, Run, run};

fn simulate(name: &str) -> Run {
    let rig = Rig::builtin(name).expect("a built-in rig");
    run(&rig, Accuracy::of(&rig)).expect("a transient")
}

/// Positions in mm between two times.
fn positions(run: &Run, from: f64, until: f64) -> Vec<f64> {
    let rows = run.rows.iter().filter(|row| row.time >= from && row.time < until);
    rows.map(|row| row.plant.position * 1e3).collect()
}

fn peak_to_peak(values: &[f64]) -> f64 {
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    high - low
}

fn when_beyond(run: &Run, after: f64, mm: f64) -> f64 {
    let row = run.rows.iter().find(|row| row.time >= after && row.plant.position * 1e3 >= mm);
    row.map(|row| row.time).expect("the position is reached")
}

const LOW: f64 = 8192.0 * 0.01205;
const HIGH: f64 = 16_384.0 * 0.01205;

/// The figures of cases/README.md for gains of 1, with upstream Mach numbers: a limit cycle.
#[test]
fn with_the_gains_of_the_thesis_drive_b_limit_cycles_by_centimetres() {
    let run = simulate("servo-b");
    for (from, until) in [(1.0, 1.7), (2.4, 3.1)] {
        let swing = peak_to_peak(&positions(&run, from, until));
        assert!((25.0..50.0).contains(&swing), "{swing} mm");
    }
    assert_eq!(run.fault, None);
}

#[test]
fn the_tuned_drive_b_rises_within_a_quarter_of_a_second_and_overshoots_by_less_than_a_millimetre() {
    let run = simulate("servo-b-tuned");
    let step = HIGH - LOW;
    let rise = when_beyond(&run, 0.3, LOW + 0.9 * step) - when_beyond(&run, 0.3, LOW + 0.1 * step);
    assert!((0.05..0.25).contains(&rise), "{rise} s");
    let highest = positions(&run, 0.3, 1.72).into_iter().fold(0.0, f64::max);
    assert!(highest < HIGH + 1.0, "{highest} mm");
    let lowest = positions(&run, 1.72, 3.1).into_iter().fold(f64::INFINITY, f64::min);
    assert!(lowest > LOW - 1.0, "{lowest} mm");
}

#[test]
fn the_tuned_drive_b_comes_to_a_standstill_within_a_millimetre() {
    let run = simulate("servo-b-tuned");
    for (from, until, setpoint) in [(1.0, 1.72, HIGH), (2.4, 3.1, LOW)] {
        let rest = positions(&run, from, until);
        assert_eq!(peak_to_peak(&rest), 0.0, "held by stiction, exactly");
        assert!((rest[0] - setpoint).abs() < 1.0, "{} mm from the setpoint", rest[0] - setpoint);
    }
}

/// A trip of the supervisor stops the cylinder: the valve goes to null at that sample's output.
#[test]
fn a_setpoint_that_drives_the_rod_too_fast_trips_the_supervisor_and_the_command_is_null() {
    let settings = ["safety.max_speed_m_s=0.3".to_owned()];
    let text = pneudrive_sim::rigfile::builtin("servo-b").expect("a built-in rig");
    let rig = Rig::read_with("servo-b", text, &settings).expect("valid");
    let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
    let (fault, k) = run.fault.expect("tripped");
    assert_eq!(fault, pneudrive_controller::Fault::EncoderStep);
    assert!(run.observations[k as usize..].iter().all(|seen| seen.command == 0));
    assert!(run.observations[k as usize - 1].command != 0);
}

/// Two methods of different order agree: neither's error is in the transient.
#[test]
fn merson_gives_the_same_transient_as_dormand_prince() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let merson = Accuracy { method: Method::Merson, tolerance: 1e-12 };
    let (a, b) = (simulate("servo-b-tuned"), run(&rig, merson).expect("a transient"));
    let farthest = a.rows.iter().zip(&b.rows).map(|(a, b)| (a.plant.position - b.plant.position).abs());
    let farthest = farthest.fold(0.0, f64::max);
    assert!(farthest < 1e-7, "{farthest} m");
}

/// Once a drawn coefficient of discharge of 1 made the flows search for a solution for ever.
#[test]
fn rigs_drawn_with_the_largest_spread_run_without_a_search() {
    for seed in 1..=6 {
        let nominal = Rig::builtin("servo-b").expect("a built-in rig");
        let rig = nominal.spread(0.5, seed).expect("a valid rig");
        let run = run(&rig, Accuracy { tolerance: 1e-8, ..Accuracy::default() }).expect("a transient");
        assert!(run.work.network.bracketed < 20, "seed {seed}: {:?}", run.work.network);
    }
}

/// Thesis 7.2.1: the drive with the stepper is stable, and rests away from its setpoint; the dead
/// zone of the profile is +-255 counts (EQUATIONS section 9).
#[test]
fn drive_a_is_stable_and_rests_within_the_dead_zone_of_its_profile() {
    let run = simulate("servo-a");
    let rest = positions(&run, 1.2, 1.72);
    assert!(peak_to_peak(&rest) < 0.5, "{} mm", peak_to_peak(&rest));
    assert!((rest[0] - HIGH).abs() < 255.0 * 0.01205, "{} mm", rest[0] - HIGH);
}

#[test]
fn the_tuned_drive_a_stands_still_within_an_eighth_of_a_millimetre() {
    let run = simulate("servo-a-tuned");
    for (from, until, setpoint) in [(1.2, 1.72, HIGH), (2.6, 3.1, LOW)] {
        let rest = positions(&run, from, until);
        assert_eq!(peak_to_peak(&rest), 0.0, "held by stiction, exactly");
        assert!((rest[0] - setpoint).abs() < 0.125, "{} mm from the setpoint", rest[0] - setpoint);
    }
    assert!(positions(&run, 0.3, 1.72).into_iter().fold(0.0, f64::max) < HIGH + 0.125);
}

#[test]
fn the_tuned_drive_c_stands_still_within_half_a_millimetre() {
    let run = simulate("servo-c-tuned");
    for (from, until, setpoint) in [(1.0, 1.72, HIGH), (2.4, 3.1, LOW)] {
        let rest = positions(&run, from, until);
        assert_eq!(peak_to_peak(&rest), 0.0, "held by stiction, exactly");
        assert!((rest[0] - setpoint).abs() < 0.5, "{} mm from the setpoint", rest[0] - setpoint);
    }
}

/// Thesis 7.3.1 and 7.3.2: the solenoid "had better response to input signal in terms of start-up delay
/// and stability" than the stepper, on the same cylinder and load.
#[test]
fn the_solenoid_valve_brings_the_heavy_drive_closer_and_sooner_than_the_stepper() {
    let solenoid = Rig::builtin("lut-solenoid").expect("a built-in rig");
    let stepper = Rig::builtin("lut-stepper").expect("a built-in rig");
    let stepper = stepper.with_test_of(&solenoid).expect("the same cylinder");
    let [stepper, solenoid] = [stepper, solenoid].map(|rig| run(&rig, Accuracy::of(&rig)).expect("a run"));
    let first_motion = |run: &Run| {
        let row = run.rows.iter().find(|row| row.time > 0.3 && row.plant.velocity != 0.0);
        row.map(|row| row.time - 0.3).expect("it moves")
    };
    assert!(first_motion(&solenoid) < first_motion(&stepper));
    let rest = |run: &Run| positions(run, 2.7, 3.0);
    assert_eq!((peak_to_peak(&rest(&stepper)), peak_to_peak(&rest(&solenoid))), (0.0, 0.0));
    assert!((rest(&solenoid)[0] - LOW).abs() < (rest(&stepper)[0] - LOW).abs());
}

/// Thesis 7.3.3: the valve has three states, and the relay with pressure feedback brings the load into
/// its dead zone; without velocity and pressure feedback it goes on swinging.
#[test]
fn burrows_relay_comes_to_rest_in_its_dead_zone_by_its_feedback_alone() {
    let run_with = |settings: &[&str]| {
        let text = pneudrive_sim::rigfile::builtin("burrows").expect("a built-in rig");
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        run(&Rig::read_with("burrows", text, &settings).expect("valid"), Accuracy::default()).expect("a run")
    };
    let fed_back = run_with(&[]);
    let last = fed_back.observations.last().expect("samples");
    assert!(last.error.unsigned_abs() < 60 && last.command == 0, "{last:?}");
    assert!(fed_back.observations.iter().all(|seen| [0, 2048, -2048].contains(&seen.command)));
    assert_eq!(peak_to_peak(&positions(&fed_back, 2.0, 3.0)), 0.0);
    let blind = run_with(&["controller.velocity_gain=0", "controller.pressure_feedback_gain=0"]);
    assert!(peak_to_peak(&positions(&blind, 2.0, 3.0)) > 1.0);
}

/// Thesis 9.1.2: pressure feedback imposes damping. Without any, the drive overshoots its step and swings.
#[test]
fn pressure_feedback_damps_a_drive_that_has_no_velocity_feedback() {
    let overshoot_mm = |gain: &str| {
        let settings = [
            "controller.velocity_gain=0",
            "controller.acceleration_gain=0",
            &format!("controller.pressure_feedback_gain={gain}"),
        ]
        .map(str::to_owned);
        let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
        let rig = Rig::read_with("servo-b-tuned", text, &settings).expect("valid");
        let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
        let reached = positions(&run, 0.3, 1.7);
        reached.iter().fold(f64::MIN, |most, mm| most.max(*mm)) - 16_384.0 * 0.01205
    };
    let (undamped, damped) = (overshoot_mm("0"), overshoot_mm("4"));
    assert!(undamped > 5.0 && damped < 0.5 * undamped, "{undamped} and {damped} mm");
}

/// Thesis 4.1: from stop to stop.
#[test]
fn the_bang_bang_drive_goes_from_stop_to_stop() {
    let run = simulate("bang-bang");
    let (out, back) = (positions(&run, 1.5, 1.6), positions(&run, 3.0, 3.1));
    assert!(out.iter().all(|mm| (300.0..301.0).contains(mm)), "{out:?}");
    assert!(back.iter().all(|mm| (-1.0..0.0).contains(mm)), "{back:?}");
}

/// The trip's sample has the null command that the supervisor permits, and the run ends there.
#[test]
fn the_supervisor_ends_a_run_of_the_continuous_controller() {
    let settings = ["controller.model=continuous", "safety.max_speed_m_s=0.3"];
    let rig = Rig::read_with("test", "", &settings.map(str::to_owned)).expect("valid");
    let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
    let last = run.observations.last().expect("samples");
    assert_eq!(run.fault, Some((pneudrive_controller::Fault::EncoderStep, last.index)));
    assert_eq!(last.command, 0);
}

/// Lock step, as an emulated board has it: a command in, a sample out.
#[test]
fn advancing_a_plant_by_its_commands_repeats_the_run_that_they_come_from() {
    use pneudrive_controller::Command;
    let run = simulate("servo-b-tuned");
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let mut plant = pneudrive_sim::Plant::new(&rig, Accuracy::of(&rig), 0);
    for pair in run.observations.windows(2) {
        let command = Command { counts: pair[0].command, step: 0, drive_enable: true };
        let sample = plant.advance(command).expect("a transient");
        assert_eq!((sample.position, sample.spool), (pair[1].position, pair[1].spool), "{}", pair[1].index);
    }
}

/// Once its setpoint was 0 until then, and it went for full retraction.
#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is_until_then() {
    let settings = ["test.moves=[[1.0, 12000]]", "test.duration_s=2"].map(str::to_owned);
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let rig =
        Rig::read_with("servo-b-tuned", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    let run = run(&rig, Accuracy::of(&rig)).expect("a transient");
    let held = run.observations.iter().take_while(|seen| seen.setpoint == 8192);
    assert_eq!(held.count(), 770, "8192 is the count of k = 0; 770 * 1.3 ms is the first sample from 1 s on");
    let before = &positions(&run, 0.0, 1.0);
    assert!(peak_to_peak(before) < 1.0, "{} mm", peak_to_peak(before));
}
