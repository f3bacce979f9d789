//! What the supervisor makes of each fault of the twin: its named code, or nothing, because from what the
//! controller is given it cannot be noticed. docs/reference/faults.md has the same table in words.

use pneudrive_controller::Fault;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// The tuned drive B with an event during its first move.
fn simulate(event: &str, settings: &[&str]) -> Run {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with("test", &format!("{text}\n[[faults.event]]\n{event}\n"), &settings);
    run(&rig.unwrap_or_else(|problems| panic!("{problems}")), Accuracy::default()).expect("a transient")
}

/// The fault, and the seconds from the event at `at_s` to it.
fn noticed(event: &str, at_s: f64) -> (Fault, f64) {
    let run = simulate(&format!("{event}\nat_s = {at_s}"), &[]);
    let (fault, k) = run.fault.unwrap_or_else(|| panic!("{event} is not noticed"));
    let null = run.observations[k as usize..].iter().all(|seen| seen.command == 0);
    assert!(null, "{event}: null from the sample that trips");
    (fault, f64::from(k) * 1.3e-3 - at_s)
}

#[test]
fn swapped_tubes_run_the_drive_into_its_end_where_a_wide_open_valve_moves_nothing() {
    let (fault, after) = noticed("kind = \"swapped-tubes\"", 0.0);
    assert_eq!(fault, Fault::NoMotion);
    assert!(after < 1.7, "{after} s: a start from a standstill, the way to the end, and half a second");
}

#[test]
fn a_lost_encoder_is_a_valve_that_moves_nothing() {
    let (fault, after) = noticed("kind = \"encoder-loss\"", 0.35);
    assert_eq!(fault, Fault::NoMotion);
    assert!((0.49..0.52).contains(&after), "{after} s");
}

/// Once it was noticed only where the law asked for more than half of the valve.
#[test]
fn a_lost_encoder_is_noticed_below_half_of_the_valve_after_the_time_that_its_command_says() {
    let moves = ["test.moves=[[0.0, 8192], [1.0, 8500]]", "test.duration_s=8"];
    let run = simulate("kind = \"encoder-loss\"\nat_s = 0.9", &moves);
    let (fault, tripped) = run.fault.expect("noticed");
    assert_eq!(fault, Fault::NoMotion);
    let command = u32::from(run.observations[tripped as usize - 1].command.unsigned_abs());
    assert!((103..1024).contains(&command), "{command} of 2048 is open, by less than half");
    let moved_at = 1_000_000_u32.div_ceil(1300);
    let expected = (384 * (1024 - 102_u32)).div_ceil(command - 102);
    let took = tripped - moved_at;
    assert!(took.abs_diff(expected) <= 2, "{took} samples with {command} of 2048, not {expected}");
}

#[test]
fn an_encoder_that_jumps_trips_at_the_next_sample() {
    let (fault, after) = noticed("kind = \"encoder-jump\"\ncounts = -1000", 0.35);
    assert_eq!(fault, Fault::EncoderStep);
    assert!((0.0..=0.0013).contains(&after), "{after} s");
}

/// A jump that physics allows is a position that is wrong by so much.
#[test]
fn a_small_jump_of_the_encoder_cannot_be_noticed() {
    let run = simulate("kind = \"encoder-jump\"\ncounts = 100\nat_s = 0.35", &[]);
    assert_eq!(run.fault, None);
}

#[test]
fn an_open_pressure_sensor_trips_at_its_fourth_sample() {
    for sensor in ["pressure-1", "pressure-2"] {
        let (fault, after) = noticed(&format!("kind = \"sensor-open\"\nsensor = \"{sensor}\""), 0.35);
        assert_eq!(fault, Fault::SensorRange);
        assert!((0.0..=4.0 * 0.0013).contains(&after), "{sensor}: {after} s");
    }
}

/// The law does not use the spool's sensor, and a stepper has none.
#[test]
fn an_open_spool_sensor_is_not_judged() {
    assert_eq!(simulate("kind = \"sensor-open\"\nsensor = \"spool\"\nat_s = 0.35", &[]).fault, None);
}

/// Stuck open, the drive runs to its end and stays; stuck near null, it stands still away from the
/// setpoint, where the profile asks for more than half of the valve.
#[test]
fn a_stuck_spool_is_a_valve_that_moves_nothing() {
    let (fault, after) = noticed("kind = \"stuck-spool\"", 0.35);
    assert_eq!(fault, Fault::NoMotion);
    assert!(after < 1.2, "{after} s");
}

/// Pressures that fall are not judged: a drive with less supply is a slower drive.
#[test]
fn a_dip_of_the_supply_and_a_leak_cannot_be_noticed_while_the_drive_still_moves() {
    for event in ["kind = \"supply-dip\"", "kind = \"leak\"\ndiameter_mm = 0.5"] {
        assert_eq!(simulate(&format!("{event}\nat_s = 0.35"), &[]).fault, None, "{event}");
    }
}

#[test]
fn a_supply_that_fails_leaves_a_wide_open_valve_that_moves_nothing() {
    let event = "kind = \"supply-dip\"\npressure_pa = 110000\nduration_s = 3\nat_s = 0.1";
    let run = simulate(event, &["valve.underlap_mm=-0.05", "test.moves=[[0.0, 8192], [0.6, 16384]]"]);
    assert_eq!(run.fault.map(|(fault, _)| fault), Some(Fault::NoMotion));
}

/// A drive at rest asks for what its stiction and the null of its valve leave: no more than a shut valve may be asked for.
#[test]
fn a_sound_drive_that_moves_and_rests_for_20_s_trips_nothing() {
    for (name, text) in pneudrive_sim::rigfile::BUILTIN {
        let rig = Rig::read_with(name, text, &["test.duration_s=20".to_owned()]);
        let rig = rig.unwrap_or_else(|problems| panic!("{name}: {problems}"));
        let run = run(&rig, Accuracy::default()).expect("a transient");
        assert_eq!(run.fault, None, "{name}");
    }
}
