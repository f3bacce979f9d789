//! Rigs: what goes together, what is refused, and what follows from what.

use super::*;
use crate::follow::{Timing, follow};
use crate::keys;
use crate::plant::Accuracy;
use pneudrive_controller::choice::Law;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Parameters};

/// The problems of a file, a line each.
pub(crate) fn problems(text: &str) -> Vec<String> {
    match Rig::read("rig.toml", text) {
        Ok(_) => panic!("accepted: {text}"),
        Err(Problems(problems)) => problems.iter().map(ToString::to_string).collect(),
    }
}

pub(crate) fn only_problem(text: &str) -> String {
    let found = problems(text);
    assert_eq!(found.len(), 1, "{found:?}");
    found.into_iter().next().expect("one")
}

pub(crate) fn read(text: &str) -> Rig {
    Rig::read("rig.toml", text).unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn the_empty_file_is_servo_drive_b() {
    let empty = read("");
    let servo_b = Rig::builtin("servo-b").expect("built in");
    for (key, value) in servo_b.entries().filter(|(key, _)| key.path != "name") {
        assert_eq!(empty.value(key.path), Some(value), "{}", key.path);
    }
}

#[test]
fn keys_of_another_model_are_accepted_and_mentioned_with_their_neutral_values() {
    let rig = read("[operator]\nmax_steps = 40\n[tubing]\nmodel = \"none\"\ndrop_slope = 0.4\n");
    assert_eq!(rig.unused(), ["operator.max_steps", "tubing.drop_slope"]);
}

#[test]
fn what_does_not_go_together_is_refused_at_its_key() {
    for (text, expected) in [
        (
            "[controller]\ndelay_s = 0.0013\n",
            "rig.toml:2: controller.delay_s: must be below controller.period_s",
        ),
        ("[controller]\nperiod_s = 0.00130005\n", "must be a whole number of microseconds"),
        (
            "[test]\nduration_s = 3600\ntrace_period_s = 1e-6\n",
            "makes 3600000000 rows in test.duration_s; 10000000",
        ),
        ("[exhaust]\npressure_pa = 700000\n", "must be below supply.pressure_pa"),
        ("[valve]\ndischarge_supply = 1\n", "must not be above 0.9 with upstream_mach"),
        (
            "[controller]\nmodel = \"continuous\"\n[operator]\nmodel = \"on-off\"\n",
            "a stepper and an on-off valve need samples",
        ),
        (
            "[controller]\nmodel = \"continuous\"\nloop = \"open\"\n[safety]\nend_max_mm = 200\n",
            "its open loop is not held back at safety.end_min_mm and safety.end_max_mm",
        ),
        ("[valve]\nspool_diameter_mm = 11\n", "must not be above valve.sleeve_diameter_mm"),
        ("[actuator]\nrod_diameter_m = 0.05\n", "must be below actuator.bore_m"),
        ("[load]\ncoulomb_extend_n = 80\n", "must not be above load.static_extend_n"),
        ("[operator]\ncoulomb_friction_n = 4\n", "must not be above operator.static_friction_n"),
        ("[operator]\ndither_hz = 0\n", "a dither needs a frequency"),
        ("[sensors]\nspool_min_mm = 2\n", "must be below sensors.spool_max_mm"),
        ("[encoder]\npolarity = 0\n", "must be 1 or -1"),
        ("[test]\nmoves = []\n", "must have 1 to 64 moves, has 0"),
        ("[test]\nmoves = [[1.0, 1], [0.5, 2]]\n", "must be in order of time"),
        ("[test]\nmoves = [[-1.0, 1]]\n", "times must be whole microseconds"),
        ("[test]\nmoves = [[0.0, 90000]]\n", "outside the stroke of 0 to 24896 counts"),
        (
            "[test]\nmoves = [[0.0, 1], [2.0, 2]]\nrepeat_every_s = 2.001\n",
            "longer than the time of the last move, 2 s",
        ),
        ("[test]\nmoves = [[0.0]]\n", "must be a list of [time in s, counts]"),
        ("[test]\nposition_m = 0.4\n", "must not be above actuator.stroke_m"),
        ("[test]\nmoves = [[0.0, 1]]\ntargets = [2]\n", "give either targets or moves, not both"),
        ("[load]\nconstant_force_n = 90000\n", "load.constant_force_n: the supply cannot hold the load"),
        ("[tubing]\nmodel = \"analytical\"\nlength_m = 0.1\n", "make the tube longer or narrower"),
        ("[actuator]\nresidual_volume_2_m3 = 1e-9\n", "pressed into its stop"),
        (
            "[supply]\nmodel = \"receiver\"\n[test]\nreceiver_pressure_pa = 5e6\n[actuator]\nresidual_volume_1_m3 = 1e-3\n",
            "pressed into its stop",
        ),
        ("[controller]\ngain_profile = []\n", "must have 1 to 256 entries, has 0"),
        ("[controller]\nvelocity_gain = 1.5\n", "must be a whole number, not a float"),
        ("[[load]]\nmass_kg = 1\n", "write [load], not [[load]]"),
    ] {
        let message = only_problem(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn targets_are_moves_at_multiples_of_the_forced_exit_time() {
    let rig = read("[test]\ntargets = [8192, 16384, 8192]\n");
    assert_eq!(rig.moves(), [(0.0, 8192), (1.42, 16_384), (2.84, 8192)]);
}

#[test]
fn the_controller_is_given_what_the_rig_says() {
    assert_eq!(read("[controller]\nloop = \"open\"\n").parameters().get(id::OPEN_LOOP), Some(1));
    let parameters = read("[controller]\nvelocity_gain = 1000\n").parameters();
    assert_eq!(parameters.get(id::VELOCITY_GAIN), Some(1000));
    assert_eq!(parameters.get(id::ENCODER_PM_PER_COUNT), Some(12_050_000));
    assert_eq!(read("").parameters(), Parameters::default(), "the empty file is the thesis's controller");
}

#[test]
fn counts_of_a_command_default_to_those_of_the_drive_stage() {
    let (dac, stepper) = (read(""), read("[operator]\nmodel = \"stepper\"\n"));
    let of = |rig: &Rig| [id::SCALE, id::DEAD_ZONE_COUNTS].map(|id| rig.parameters().get(id));
    assert_eq!((of(&dac), of(&stepper)), ([Some(256), Some(102)], [Some(65_536), Some(4)]));
    let given = read(
        "[operator]\nmodel = \"stepper\"\n[controller]\nlaw = \"moore-proportional\"\nscale = 256\ndead_zone_counts = 0\n",
    );
    assert_eq!(of(&given), [Some(256), Some(0)]);
}

#[test]
fn what_the_file_leaves_open_follows_a_setting_there_and_back() {
    let of = |rig: &Rig| {
        let gain = [id::PRESSURE_FEEDBACK_GAIN, id::PRESSURE_DAMPING_GAIN].map(|id| rig.parameters().get(id));
        (rig.parameters().get(id::SCALE), gain)
    };
    let set = |rig: &Rig, setting: &str| rig.with_settings(&[setting.to_owned()]).expect("valid");
    let dac = read("");
    let stepper = set(&dac, "operator.model=stepper");
    assert_eq!([&dac, &stepper].map(|rig| of(rig).0), [Some(256), Some(65_536)]);
    assert_eq!(of(&set(&stepper, "operator.model=solenoid")), of(&dac));
    let relay = set(&dac, "controller.law=on-off");
    assert_eq!(of(&relay).1, [Some(775), Some(0)]);
    assert_eq!(of(&set(&relay, "controller.law=proportional")), of(&dac));
    assert_eq!(of(&dac).1, [Some(775), Some(0)], "the parameter of the relay is none of this law");
}

#[test]
fn what_is_late_is_so_before_the_next_sample_at_any_period() {
    let of = |settings: &str| {
        let rig = read(&format!("[controller]\n{settings}"));
        [id::LATE_SAMPLE_US, id::LATE_OUTPUT_US].map(|id| rig.parameters().get(id))
    };
    assert_eq!(of(""), [Some(100), Some(100)]);
    assert_eq!(of("period_s = 0.0001\ndelay_s = 0.00004\n"), [Some(50), Some(30)]);
    let message = only_problem("[safety]\nlate_sample_us = 1300\n");
    assert!(
        message.contains("safety.late_sample_us: late_sample_us must be less than period_us"),
        "{message}"
    );
    let message = only_problem("[safety]\nlate_output_us = 800\n");
    assert!(
        message.contains("safety.late_output_us") && message.contains("less than period_us"),
        "{message}"
    );
    let message = only_problem("[safety]\nmax_speed_m_s = 100\n[controller]\nperiod_s = 0.1\n");
    assert!(message.contains("safety.max_speed_m_s"), "{message}");
}

#[test]
fn the_pressure_feedback_of_a_relay_is_counts_of_error_for_a_kpa() {
    let rig = read("[controller]\nlaw = \"on-off\"\n");
    // 1 MPa in 4095 raw counts, 12.4 counts a kPa, times the scale: 12.4 * 0.2442 * 256.
    assert_eq!(rig.parameters().get(id::PRESSURE_FEEDBACK_GAIN), Some(775));
    let message = only_problem("[controller]\nlaw = \"on-off\"\npressure_feedback_gain = 2000\n");
    assert!(message.contains("controller.pressure_feedback_gain: the controller's parameter pressure_feedback_gain cannot be 125031"), "{message}");
}

#[test]
fn every_law_is_the_controllers_of_its_name() {
    for &law in Law::ALL {
        // One needs a drive of which it has a model.
        let setting = format!("controller.law={}", law.word());
        let rig = match law {
            Law::Cascade => {
                Rig::read_with("press", include_str!("../../tests/cascade/press.toml"), &[setting])
            }
            _ => Rig::read_with("rig.toml", "", &[setting]),
        };
        let rig = rig.unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(rig.parameters().get(id::LAW), Some(law as i32), "{law:?}");
    }
}

#[test]
fn targets_that_wait_for_the_one_before_have_no_times_and_need_to_be_targets() {
    let rig =
        read("[controller]\nexit_on_dead_band = true\ndead_band_counts = 20\n[test]\ntargets = [100, 200]\n");
    assert_eq!(rig.moves(), [(0.0, 100), (0.0, 200)]);
    let parameters = rig.parameters();
    let of = |id| parameters.get(id);
    assert_eq!(
        (of(id::ON_ARRIVAL), of(id::TOLERANCE_COUNTS)),
        (Some(1), Some(19)),
        "less than the dead band"
    );
    assert_eq!((of(id::FORCED_EXIT_US), of(id::MONITORING_US)), (Some(1_420_000), Some(0)));
    let message = only_problem("[controller]\nexit_on_dead_band = true\n");
    assert!(message.contains("controller.exit_on_dead_band: needs test.targets"), "{message}");
}

#[test]
fn an_impulse_stands_on_top_of_the_moves() {
    let rig =
        |impulse: &str| read(&format!("[test]\nmoves = [[0.0, 100], [0.5, 200]]\nimpulse = {impulse}\n"));
    assert_eq!(rig("[0.2, 0.1, 50]").moves(), [(0.0, 100), (0.2, 150), (0.3, 100), (0.5, 200)]);
    assert_eq!(rig("[0.4, 0.2, 50]").moves(), [(0.0, 100), (0.4, 150), (0.5, 250), (0.6, 200)]);
    assert_eq!(rig("[0.5, 0.2, -50]").moves(), [(0.0, 100), (0.5, 150), (0.7, 200)]);
    for wrong in ["[-0.1, 0.1, 50]", "[0.1, 0, 50]", "[0.1, 0.1, 0.5]"] {
        let found = problems(&format!("[test]\nimpulse = {wrong}\n"));
        assert!(found.iter().any(|problem| problem.contains("test.impulse: ")), "{found:?}");
    }
}

/// Once its setpoint was its height above 0, near full retraction.
#[test]
fn an_impulse_before_the_first_setpoint_is_refused_and_before_the_first_command_is_not() {
    let late = "[test]\nmoves = [[0.5, 9000]]\nimpulse = [0.2, 0.1, 50]\n";
    let message = only_problem(late);
    assert!(message.contains("test.impulse: begins before the first move, at 0.5 s"), "{message}");
    let open = read(&format!("[controller]\nloop = \"open\"\n{}", late.replace("9000", "90")));
    assert_eq!(open.moves(), [(0.2, 50), (0.3, 0), (0.5, 90)]);
}

#[test]
fn a_pressure_that_the_drive_cannot_have_is_an_open_sensors_where_the_range_shows_it() {
    let of = |text: &str| {
        let parameters = read(text).parameters();
        [id::SENSOR_LOW_RAW, id::SENSOR_HIGH_RAW].map(|id| parameters.get(id).expect("a parameter"))
    };
    assert_eq!(of(""), [63, 4032], "an open wire leaves 40 or 4050 of 4095");
    assert_eq!(of("[sensors]\npressure_min_pa = 101300\n"), [-1, 4032], "a gauge reads 0 at the exhaust");
    assert_eq!(of("[sensors]\npressure_max_pa = 700000\nbits = 10\n"), [15, 32_767]);
    let gauge =
        |max_pa: u32| of(&format!("[sensors]\npressure_min_pa = 101300\npressure_max_pa = {max_pa}\n"));
    assert_eq!(gauge(701_300), [-1, 4032], "the supply is below its top: a reading there tells no pressure");
    assert_eq!(gauge(590_000), [-1, 32_767], "the supply is at its top");
    assert_eq!(of("[safety]\nsensor_watch = false\n"), [-1, 32_767]);
    assert_eq!(of("[sensors]\npressure = false\n"), [63, 4032], "sensors that are put on later are watched");
    assert_eq!(of("[sensors]\npressure = false\n[safety]\nsensor_watch = false\n"), [-1, 32_767]);
}

#[test]
fn a_rig_without_pressure_sensors_tells_its_controller_and_feeds_nothing_back() {
    let of = |text: &str| read(text).parameters().get(id::PRESSURE_SENSORS);
    assert_eq!([of(""), of("[sensors]\npressure = false\n")], [Some(1), Some(0)]);
    let relay = "[sensors]\npressure = false\n[controller]\nlaw = \"on-off\"\n";
    let message = only_problem(relay);
    assert!(
        message
            .contains("controller.pressure_feedback_gain: must be 0 with sensors.pressure = false, is 12.4"),
        "{message}"
    );
    assert_eq!(of(&format!("{relay}pressure_feedback_gain = 0\n")), Some(0));
    let event = "[sensors]\npressure = false\n[[faults.event]]\nkind = \"sensor-open\"\nat_s = 0.1\n";
    let message = only_problem(&format!("{event}sensor = \"pressure-2\"\n"));
    assert!(message.contains("faults.event: a pressure sensor cannot come off"), "{message}");
    assert_eq!(of(&format!("{event}sensor = \"spool\"\n")), Some(0));
}

/// A stroke of 250 mm is 25,000 counts of 10 um, but 0.25 / 1e-5 may be a rounding error less.
#[test]
fn a_move_to_the_end_of_the_stroke_is_one_that_the_controller_takes() {
    for (mm_per_count, stroke) in [(0.01, 0.25), (0.01, 0.35), (0.005, 0.1), (0.024, 0.6), (0.001, 0.3)] {
        let last = (stroke * 1e3 / mm_per_count + 0.5_f64).floor() as i64;
        let rig = read(&format!(
            "[actuator]\nstroke_m = {stroke}\n[encoder]\nmm_per_count = {mm_per_count}\n[test]\nposition_m = 0.05\nmoves = [[0.0, {last}]]\n"
        ));
        let end = rig.parameters().get(id::END_MAX_COUNTS).map(i64::from);
        assert_eq!(end, Some(last), "{stroke} m by {mm_per_count} mm");
    }
}

#[test]
fn setpoints_beyond_a_soft_limit_are_refused() {
    let message = only_problem("[safety]\nend_max_mm = 150\n");
    assert!(message.contains("safety.end_max_mm: setpoint 16384 lies beyond it"), "{message}");
    let ends = |text: &str| {
        let parameters = read(text).parameters();
        [id::END_MIN_COUNTS, id::END_MAX_COUNTS].map(|id| parameters.get(id).expect("a parameter"))
    };
    assert_eq!(ends("[safety]\nend_max_mm = 200\n"), [0, 16_597]);
    assert_eq!(ends(""), [0, 24_896], "the stroke of 300 mm");
    assert_eq!(
        ends("[controller]\nloop = \"open\"\n"),
        [-i32::MAX, i32::MAX],
        "it may push against its stops"
    );
}

/// -1 m is -3.6e9 counts of 300 mm/2^30: it once came to +7e8, and a run with moves that the check had passed panicked.
#[test]
fn a_soft_limit_beyond_what_the_controller_can_count_holds_no_setpoint_back() {
    let fine = "[encoder]\nmodel = \"potentiometer\"\nbits = 30\n[safety]\nend_min_mm = -1000\n[test]\nmoves = [[0.0, 9000]]\nduration_s = 0.01\n";
    let rig = read(fine);
    assert_eq!(rig.parameters().get(id::END_MIN_COUNTS), Some(-i32::MAX));
    crate::run(&rig, crate::Accuracy::of(&rig)).expect("it runs");
}

#[test]
fn the_last_entry_of_the_gain_profile_repeats() {
    let parameters = read("[controller]\ngain_profile = [900, 300]\n").parameters();
    let entry = |i: u16| parameters.get(id::GAIN_PROFILE + i);
    assert_eq!((entry(0), entry(1), entry(2), entry(255)), (Some(900), Some(300), Some(300), Some(300)));
}

#[test]
fn every_key_is_explained_with_its_facts() {
    for key in all_keys() {
        let text = explain(key.path).expect("a key");
        assert!(text.contains(key.meaning) && text.contains("default"), "{text}");
        assert!(key.unit().is_empty() || text.contains(key.unit()), "{text}");
        assert!(key.thesis.is_empty() || text.contains(key.thesis), "{text}");
    }
    assert!(explain("mass_kg").expect("a name").contains("load.mass_kg"));
    assert!(explain("load").expect("a table").contains("load.viscous_n_s_per_m"));
    assert_eq!(explain("").expect("all").lines().count(), all_keys().count());
    assert!(explain("nonsense").is_err());
}

#[test]
fn a_spread_draws_the_same_rig_for_the_same_seed_and_stays_within_bounds() {
    let nominal = Rig::builtin("servo-b").expect("built in");
    let drawn = nominal.spread(0.1, 7).expect("in range");
    assert_eq!(drawn, nominal.spread(0.1, 7).expect("in range"));
    assert_ne!(drawn, nominal.spread(0.1, 8).expect("in range"));
    assert_eq!(drawn.parameters(), nominal.parameters(), "the controller is not drawn");
    let mut changed = 0;
    for (key, value) in drawn.entries() {
        let Some(Value::Number(before)) = nominal.value(key.path) else { continue };
        let Value::Number(after) = value else { panic!("{} changed its kind", key.path) };
        if key.path == "sensors.noise_counts" {
            assert_eq!(*after, 1.0);
        } else {
            assert!((after - before).abs() <= 0.1 * before.abs() + 1e-12, "{}", key.path);
            changed += usize::from(after != before);
        }
    }
    assert!(changed > 15, "{changed}");
    assert!(nominal.spread(0.6, 1).is_err());
}

#[test]
fn without_a_spread_nothing_is_drawn() {
    let nominal = Rig::builtin("servo-b").expect("built in");
    let same = nominal.spread(0.0, 3).expect("in range");
    for (key, value) in nominal.entries().filter(|(key, _)| key.path != "sensors.noise_counts") {
        assert_eq!(same.value(key.path), Some(value), "{}", key.path);
    }
}

#[test]
fn another_test_is_held_against_the_rig_that_it_is_for() {
    let long = "[actuator]\nstroke_m = 1.0\n[test]\ntargets = [8192, 70000]\nrepeat_every_s = 2.0\n";
    let rig = Rig::read("long", long).expect("valid");
    let settings = ["test.moves=[[0.0, 60000]]", "test.position_m=0.6"].map(str::to_owned);
    let tested = rig.with_test(&settings).expect("60,000 counts are within a stroke of a metre");
    assert_eq!((tested.moves(), tested.get(&keys::test::POSITION_M)), (vec![(0.0, 60_000)], 0.6));
    assert_eq!(tested.get(&keys::test::REPEAT_EVERY_S), None, "nothing is left of the other test");
    let beyond = rig.with_test(&["test.moves=[[0.0, 90000]]".to_owned()]).expect_err("outside the stroke");
    assert!(beyond.to_string().contains("outside the stroke"), "{beyond}");
    assert!(rig.with_settings(&["load.mass_kg=none".to_owned()]).is_err());
}

#[test]
fn a_key_that_is_asked_for_by_a_near_miss_is_guessed() {
    for (name, says) in [
        ("load.mas_kg", "did you mean load.mass_kg?"),
        ("mas_kg", "did you mean mass_kg?"),
        ("vlave", "did you mean valve?"),
    ] {
        let problem = super::explain(name).expect_err("a slip");
        assert!(problem.message.ends_with(says), "{name}: {}", problem.message);
    }
}

/// Once such rigs passed, and their runs ended as "too stiff", after steps of nanoseconds.
#[test]
fn a_lag_that_the_valve_makes_nothing_of_is_refused_with_one_that_does() {
    let rig = |lag_s: &str| {
        format!(
            "[valve]\nmodel = \"single-restriction\"\nsleeve_diameter_mm = 48.0\nspool_diameter_mm = 48.0\nflow_force = \"none\"\n[tubing]\nmodel = \"analytical\"\nlength_m = 10.0\ndiameter_mm = 2.0\nlag_s = {lag_s}\n"
        )
    };
    let message = only_problem(&rig("1e-4"));
    assert!(message.contains("tubing.lag_s: the valve passes"), "{message}");
    let (_, enough) = message.split_once("at least ").expect("a lag that will do");
    read(&rig(&enough[..enough.find(',').expect("more words")]));
    read(&rig("0.0"));
    read("[tubing]\nlag_s = 1e-5\n");
}

/// Behind the empirical tube the ratio of a flow of m times the one that loses half is 2^m. Once such rigs passed, and their
/// runs ended at the start, as "no number".
#[test]
fn a_lag_within_which_a_wide_valve_raises_the_pressure_at_once_is_refused() {
    let rig = |conductance: f64, lag_s: &str| {
        format!(
            "[valve]\nmodel = \"iso-6358\"\ncharacteristic = \"linear\"\nflow_force = \"none\"\ncritical_ratio = 0.2\nsonic_conductance_m3_per_s_pa = {conductance:e}\n[tubing]\nlag_s = {lag_s}\n"
        )
    };
    let message = only_problem(&rig(4.2e-7, "0.02"));
    assert!(
        message.contains("tubing.lag_s: the valve passes") && message.contains("write 0, or"),
        "{message}"
    );
    read(&rig(4.2e-7, "0.0"));
    let message = only_problem(&rig(2.8e-7, "0.001"));
    let (_, enough) = message.split_once("at least ").expect("a lag that will do");
    let long_enough = read(&rig(2.8e-7, &enough[..enough.find(',').expect("more words")]));
    let opened = Command { counts: 2047, step: 0, drive_enable: true };
    let timing = Timing { period_us: 1000, delay_us: 500 };
    follow(&long_enough, Accuracy::of(&long_enough), timing, &[opened; 20]).expect("a transient");
}

/// Once this named the table alone.
#[test]
fn parameters_that_do_not_go_together_are_refused_by_the_key_to_change() {
    for (text, named) in [
        ("[controller]\nhoming_command_counts = 0\n", "controller.homing_command_counts: "),
        (
            "[operator]\nmodel = \"stepper\"\npulse_width_us = 1000\ndirection_setup_us = 1000\n",
            "operator.pulse_width_us: ",
        ),
    ] {
        let message = only_problem(text);
        assert!(message.contains(named), "{text:?}: {message}");
    }
}
