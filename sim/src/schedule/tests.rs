use super::ramp::Limits;
use crate::values::Rig;
use pneudrive_controller::profile::Profile;
use proptest::prelude::*;

fn test(text: &str) -> Result<Rig, String> {
    Rig::read("rig.toml", text).map_err(|problems| problems.to_string())
}

fn refusal(text: &str) -> String {
    test(text).expect_err("refused")
}

/// The profiles of the moves of a rig.
fn profiles(text: &str) -> Vec<Profile> {
    test(text).expect("valid").sequence().moves().iter().map(|one| one.profile).collect()
}

#[test]
fn the_shortest_ways_are_those_of_the_closed_forms() {
    let trapezoid = Limits { velocity: 10.0, acceleration: 0.5, jerk: None };
    assert_eq!(trapezoid.shortest(1000.0), [100.0, 20.0, 0.0]);
    assert_eq!(trapezoid.shortest(50.0), [10.0, 10.0, 0.0], "a triangle: 5 reached after 10 samples");
    let s_curve = Limits { jerk: Some(0.05), ..trapezoid };
    assert_eq!(s_curve.shortest(1000.0), [100.0, 20.0, 10.0]);
    assert_eq!(s_curve.shortest(300.0), [30.0, 20.0, 10.0], "all limits are just reached");
    let [tv, ta, tj] = s_curve.shortest(100.0);
    assert_eq!((tv, tj), (ta + tj, 10.0), "the velocity is not reached");
    assert!((0.5 * ta * (ta + tj) - 100.0).abs() < 1e-9);
    let [tv, ta, tj] = s_curve.shortest(12.5);
    assert_eq!((tv, ta), (2.0 * tj, tj), "nor the acceleration");
    assert!((0.05 * 2.0 * tj.powi(3) - 12.5).abs() < 1e-9);
    let gentle = Limits { jerk: Some(0.01), ..trapezoid };
    let [_, ta, tj] = gentle.shortest(1e5);
    assert_eq!(ta, tj, "the acceleration is not reached before the velocity is");
    assert!((0.01 * tj * ta - 10.0).abs() < 1e-9);
}

#[test]
fn a_move_in_millimetres_is_one_in_counts_to_the_nearest() {
    let text = "[encoder]\nmm_per_count = 0.01\n[[test.move]]\nprofile = \"step\"\nto_mm = 100.006\n\
                [[test.move]]\nprofile = \"sine\"\nto_mm = 100\namplitude_mm = 20\nat_s = 0.5\ncycles = 2";
    let sequence = test(text).expect("valid").sequence();
    let [first, second] = [sequence.moves()[0], sequence.moves()[1]];
    assert_eq!((first.target, first.at_sample, second.target), (10_001, 0, 10_000));
    assert_eq!(second.extremes(), [8000, 12_000]);
}

#[test]
fn a_move_without_a_time_begins_when_the_one_before_is_over() {
    let text = "[[test.move]]\nprofile = \"step\"\nto_mm = 100\n[[test.move]]\nprofile = \"linear\"\nduration_s = 0.13\nto_mm = 150\n\
                [[test.move]]\nprofile = \"step\"\nto_mm = 90";
    let sequence = test(text).expect("valid").sequence();
    let at: Vec<u32> = sequence.moves().iter().map(|one| one.at_sample).collect();
    assert_eq!(at, [0, 0, 100]);
}

#[test]
fn the_profile_of_a_test_is_that_of_its_moves_and_targets() {
    let moves = "[test]\nmoves = [[0.0, 8192], [3.0, 16384]]\n";
    assert_eq!(profiles(moves), [Profile::Step; 2]);
    let curve = profiles(&format!("{moves}profile = \"s-curve\"\n"));
    assert!(curve.iter().all(|profile| matches!(profile, Profile::Ramp(_))), "{curve:?}");
    let slower = profiles(&format!("{moves}profile = \"s-curve\"\nvelocity_mm_s = 100\n"));
    assert!(slower[1].samples() > curve[1].samples());
    let targets = "[test]\ntargets = [8192, 16384]\nprofile = \"trapezoid\"\n";
    assert_eq!(profiles(targets).len(), 2);
}

/// From anywhere between the soft limits.
#[test]
fn the_first_ramp_is_long_enough_from_either_end() {
    let text = "[test]\nmoves = [[0.0, 5000]]\nprofile = \"trapezoid\"\nvelocity_mm_s = 300\nacceleration_mm_s2 = 1e6\n";
    let rig = test(text).expect("valid");
    let Profile::Ramp(ramp) = rig.sequence().moves()[0].profile else { panic!("a ramp") };
    let longest_mm = 300.0 - 5000.0 * 0.01205;
    let least = longest_mm / 300.0 / 0.0013;
    assert!((least..least + 2.0).contains(&f64::from(ramp.averages()[0])), "{ramp:?}");
}

#[test]
fn points_are_straight_lines_from_one_to_the_next() {
    let text = "[controller]\nperiod_s = 0.001\n[encoder]\nmm_per_count = 0.01\n[[test.move]]\nprofile = \"points\"\n\
                points = [[0, 100], [0.05, 120], [0.2, 90]]\n[[test.move]]\nprofile = \"step\"\nto_mm = 50";
    let sequence = test(text).expect("valid").sequence();
    let seen: Vec<(u32, i32, u32)> =
        sequence.moves().iter().map(|one| (one.at_sample, one.target, one.profile.samples())).collect();
    assert_eq!(seen, [(0, 10_000, 0), (0, 12_000, 50), (50, 9000, 150), (200, 5000, 0)]);
}

#[test]
fn a_sine_has_whole_cycles_and_a_chirp_its_frequencies() {
    let sine =
        "[[test.move]]\nprofile = \"sine\"\nto_mm = 150\namplitude_mm = 35\nfrequency_hz = 0.5\ncycles = 3";
    let [Profile::Wave(wave)] = profiles(sine)[..] else { panic!("a wave") };
    assert_eq!(wave.samples, 4615, "6 s at 1.3 ms");
    let turns = wave.rate as f64 * f64::from(wave.samples) / 2_f64.powi(64);
    assert!((turns - 3.0).abs() < 1e-12, "{turns}");
    let chirp = "[[test.move]]\nprofile = \"chirp\"\nto_mm = 150\namplitude_mm = 5\nfrequency_hz = 0.5\nend_frequency_hz = 20\nduration_s = 8";
    let [Profile::Wave(wave)] = profiles(chirp)[..] else { panic!("a wave") };
    let n = f64::from(wave.samples);
    let [rate, sweep] = [wave.rate as f64, wave.sweep as f64].map(|turns| turns / 2_f64.powi(64));
    let turns = n * rate + 0.5 * n * (n - 1.0) * sweep;
    assert!((turns - 82.0).abs() < 1e-6, "{turns} cycles");
    assert!((rate / 0.0013 - 0.5).abs() < 1e-9 && ((rate + n * sweep) / 0.0013 - 20.0).abs() < 0.01);
}

#[test]
fn every_shift_register_goes_through_all_its_states() {
    for order in 3..=16 {
        let taps = super::plan::taps(order);
        let (mut register, mut states) = (1_u32, 0);
        loop {
            register = (register >> 1) ^ if register & 1 == 1 { taps } else { 0 };
            states += 1;
            if register == 1 {
                break;
            }
        }
        assert_eq!(states, (1 << order) - 1, "{order} bits");
    }
}

#[test]
fn every_slip_of_a_profile_is_named_with_what_to_do() {
    let sine = "[[test.move]]\nprofile = \"sine\"\nto_mm = 150\n";
    for (text, expected) in [
        (format!("{sine}amplitude_mm = 151"), "setpoint -83 is outside the stroke of 0 to 24896 counts"),
        (
            "[[test.move]]\nprofile = \"points\"\npoints = [[0.1, 9], [0.1, 10]]".to_owned(),
            "move 2: its points must be a sample apart",
        ),
        (sine.to_owned(), "move 1: give either amplitude_mm or amplitude_counts"),
        (format!("{sine}amplitude_mm = 1\namplitude_counts = 5"), "give either amplitude_mm or amplitude_counts"),
        (format!("{sine}amplitude_mm = 1\nfrequency_hz = 300"), "move 1: has less than four samples a cycle"),
        ("[[test.move]]\nprofile = \"step\"".to_owned(), "move 1: give either to_mm or to_counts"),
        ("[[test.move]]\nprofile = \"glide\"".to_owned(), "test.move.profile: must be one of \"step\""),
        (
            format!("{sine}velocity_mm_s = 5"),
            "does not belong to a move with the profile sine, but to trapezoid, s-curve",
        ),
        (
            "[[test.move]]\nprofile = \"step\"\nto_mm = 9\n[[test.move]]\nprofile = \"linear\"\nto_mm = 100\nduration_s = 1\nat_s = 0.2\n\
             [[test.move]]\nprofile = \"step\"\nto_mm = 9\nat_s = 1".to_owned(),
            "move 3 begins at 1 s, before the profile of the move before it is over, at 1.2012 s",
        ),
        (
            "[test]\nmoves = [[0.0, 5]]\n[[test.move]]\nprofile = \"step\"\nto_mm = 9".to_owned(),
            "give either move or moves, not both",
        ),
        (
            "[[test.move]]\nprofile = \"linear\"\nto_mm = 9\nduration_s = 1\n[controller]\nmodel = \"continuous\"".to_owned(),
            "profiles need controller.model = \"sampled\"",
        ),
        (
            "[controller]\nloop = \"open\"\n[[test.move]]\nprofile = \"step\"\nto_mm = 9".to_owned(),
            "mm mean nothing in open loop",
        ),
    ] {
        let message = refusal(&text);
        assert!(message.contains(expected), "{message}\nfor {text}");
    }
}

proptest! {
    /// The limits of a planned ramp hold exactly: those of velocity, acceleration and jerk are d/V, d/(V A) and d/(V A J).
    #[test]
    fn a_planned_ramp_is_within_its_limits_and_on_time(
        distance in 1.0..3e5, velocity in 0.1..500.0, shape in 0.01..1.0, sharp in 0.01..1.0, curved in any::<bool>(),
    ) {
        let acceleration = velocity * shape;
        let limits = Limits { velocity, acceleration, jerk: curved.then_some(acceleration * sharp) };
        let distance: f64 = f64::round(distance);
        let [v, a, j] = limits.lengths(distance);
        let more = 1.0 + 1e-9;
        prop_assert!(distance / v <= velocity * more, "{v} {a} {j}");
        prop_assert!(distance / (v * a) <= acceleration * more, "{v} {a} {j}");
        if let Some(jerk) = limits.jerk {
            prop_assert!(distance / (v * a * j) <= jerk * more && v >= a + j, "{v} {a} {j}");
        }
        prop_assert!(v >= a && a >= j && j >= 1.0);
        let time: f64 = limits.shortest(distance).iter().sum();
        let samples = v + a + j - 2.0;
        prop_assert!((time - 1e-6..=time + 1.0 + 1e-6).contains(&samples), "{samples} samples for {time}: {v} {a} {j}");
    }
}

/// Once a finer encoder made a short distance of every move.
#[test]
fn moves_in_millimetres_go_to_the_same_places_by_any_encoder() {
    for (mm_per_count, counts) in [(0.01, [6250, 18_750]), (0.05, [1250, 3750]), (0.03, [2083, 6250])] {
        let encoder = format!("[encoder]\nmm_per_count = {mm_per_count}\n[test]\n");
        let rig = test(&format!("{encoder}moves_mm = [[0.0, 62.5], [0.2, 187.5]]")).expect("valid");
        assert_eq!(rig.moves(), [(0.0, counts[0]), (0.2, counts[1])]);
        let rig = test(&format!("{encoder}targets_mm = [62.5, 187.5]")).expect("valid");
        assert_eq!(rig.moves().iter().map(|one| one.1).collect::<Vec<_>>(), counts);
    }
}

#[test]
fn a_setting_of_moves_in_any_form_replaces_those_of_the_file() {
    let forms = [
        "moves=[[0.0, 1000]]",
        "moves_mm=[[0.0, 12.05]]",
        "targets=[1000]",
        "targets_mm=[12.05]",
        "move=[{profile=\"step\", to_mm=12.05}]",
    ];
    for file in forms {
        let text = format!("test.{}\n", file.replace("=[", " = ["));
        for setting in forms {
            let rig = Rig::read_with("rig.toml", &text, &[format!("test.{setting}")]);
            let rig = rig.unwrap_or_else(|problems| panic!("{file}, {setting}: {problems}"));
            assert_eq!(rig.moves(), [(0.0, 1000)], "{file}, {setting}");
        }
    }
}

#[test]
fn two_forms_of_moves_and_millimetres_in_open_loop_are_refused() {
    for (text, says) in [
        (
            "moves = [[0.0, 5]]\nmoves_mm = [[0.0, 5]]",
            "test.moves_mm: give either moves_mm or moves, not both",
        ),
        ("moves_mm = [[0.0, 5]]\ntargets = [5]", "test.targets: give either targets or moves_mm, not both"),
        ("targets = [5]\ntargets_mm = [5.0]", "test.targets_mm: give either targets_mm or targets, not both"),
        ("moves_mm = [[0.0, 301]]", "setpoint 24979 is outside the stroke of 0 to 24896 counts"),
        ("moves_mm = [[0.0]]", "rows of 2 numbers: [time in s; mm]"),
        ("moves = [[0.0, 12.5]]", "in mm write moves_mm"),
        ("targets_mm = []", "must be a list of 1 to 64 numbers"),
        ("targets_mm = [nan]", "must be a list of 1 to 64 numbers"),
    ] {
        let message = refusal(&format!("[test]\n{text}"));
        assert!(message.contains(says), "{text}: {message}");
    }
    for open in ["moves_mm = [[0.0, 5]]", "targets_mm = [5.0]"] {
        let message = refusal(&format!("[controller]\nloop = \"open\"\n[test]\n{open}"));
        assert!(message.contains("has no effect with controller.loop = \"open\""), "{message}");
    }
    // A setting may take away the effect of a line: millimetres never become commands.
    let set = ["controller.loop=open".to_owned()];
    let opened = Rig::read_with("rig.toml", "[test]\nmoves_mm = [[0.0, 12.05]]\n", &set).expect("valid");
    assert_ne!(opened.moves(), [(0.0, 1000)]);
}
