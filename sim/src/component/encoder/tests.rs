use super::*;

fn rig(text: &str) -> Rig {
    Rig::read("test", text).expect("valid")
}

fn potentiometer(more: &str) -> Rig {
    rig(&format!(
        "[encoder]\nmodel = \"potentiometer\"\n{more}[actuator]\nstroke_m = 0.3\n[test]\nmoves = [[0.0, 200]]\n"
    ))
}

#[test]
fn counts_are_whole_pulses_below_the_position() {
    let pulse = 0.01205e-3;
    assert_eq!(count(98.719625e-3, pulse), 8192);
    assert_eq!(count(8193.0 * pulse, pulse), 8193, "an exact pulse counts");
    assert_eq!(count(-0.1 * pulse, pulse), -1);
}

/// The board would add the zero to a negative count, and the twin knows no wiring.
#[test]
fn an_absolute_encoder_that_counts_down_is_refused_with_what_to_do() {
    let text = "[encoder]\nmodel = \"ssi\"\npolarity = -1\n[test]\nmoves = [[0.0, 200]]\n";
    let problems = Rig::read("test", text).expect_err("it counts down");
    assert_eq!(problems.0.len(), 1, "{problems}");
    assert!(problems.0[0].message.contains("exchange the ends"), "{problems}");
}

/// A test that begins there reads the count that was meant, with as much room to either side.
#[test]
fn the_middle_of_a_count_reads_as_that_count_and_half_a_count_from_its_ends() {
    let models = [
        "model = \"quadrature\"\n",
        "model = \"potentiometer\"\nbits = 10\nzero_mm = -5.1\nrange_mm = 320\n",
        "model = \"ssi\"\nzero_mm = -5.1234\n",
    ];
    for model in models {
        let rig =
            rig(&format!("[encoder]\n{model}[actuator]\nstroke_m = 0.3\n[test]\nmoves = [[0.0, 200]]\n"));
        for count in [20, 377] {
            let middle = middle(&rig, f64::from(count));
            assert_eq!(count_at(&rig, middle), f64::from(count), "{model}");
            for (part, reads) in [(-0.51, count - 1), (-0.49, count), (0.49, count), (0.51, count + 1)] {
                let reading = Encoder::at_rest(&rig, (middle + part) * pulse(&rig)) + zero_counts(&rig);
                assert_eq!(reading, reads, "{model}: {count}, {part}");
            }
        }
    }
}

#[test]
fn a_potentiometer_divides_its_range_into_the_counts_of_its_converter() {
    let rig = potentiometer("bits = 10\n");
    assert_eq!(mm_per_count(&rig), 300.0 / 1023.0);
    let mut encoder = Encoder::new(&rig, 0);
    let places = [0.0, 0.49 / 1023.0, 0.51 / 1023.0, 0.5, 1.0].map(|part| encoder.read(0.3 * part));
    assert_eq!(places, [0, 0, 1, 512, 1023]);
    assert_eq!([-0.01, 0.31].map(|beyond| encoder.read(beyond)), [0, 1023], "it stops at its ends");
}

#[test]
fn an_ssi_encoder_from_the_retracted_end_counts_what_a_quadrature_encoder_counts() {
    let mut ssi = Encoder::new(&rig("[encoder]\nmodel = \"ssi\"\n"), 0);
    let mut quadrature = Encoder::new(&rig(""), 0);
    for k in 0..3000 {
        let position = 1e-4 * f64::from(k);
        assert_eq!(ssi.read(position), quadrature.read(position), "at {position} m");
    }
}

#[test]
fn the_largest_deviation_is_that_of_the_data_sheet_and_both_ends_are_exact() {
    let rig = potentiometer("bits = 15\nlinearity_percent = 0.5\n");
    let (pulse, mut encoder) = (pulse(&rig), Encoder::new(&rig, 0));
    let deviations = (0..=1000).map(|k| {
        let position = 0.3e-3 * f64::from(k);
        f64::from(encoder.read(position)) * pulse - position
    });
    let deviations: Vec<f64> = deviations.collect();
    let largest = deviations.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
    assert!((largest - 0.005 * 0.3).abs() < pulse, "{largest} m");
    assert!(deviations[0].abs() < pulse && deviations[1000].abs() < pulse);
}

#[test]
fn the_noise_has_its_size_repeats_with_its_seed_and_leaves_that_of_the_pressures_alone() {
    let noisy = potentiometer("bits = 12\nnoise_counts = 3.0\n");
    let draw = |seed| {
        let mut encoder = Encoder::new(&noisy, seed);
        (0..4000).map(|_| f64::from(encoder.read(0.15))).collect::<Vec<_>>()
    };
    assert_eq!(draw(1), draw(1));
    assert_ne!(draw(1), draw(2));
    let mean = draw(1).iter().sum::<f64>() / 4000.0;
    let deviation = (draw(1).iter().map(|raw| (raw - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
    assert!((deviation - 3.0).abs() < 0.15, "{deviation} counts");
    let pressure = |more: &str| {
        let rig = potentiometer(&format!("{more}[sensors]\nnoise_counts = 1.0\n"));
        let mut sensors = crate::component::sensors::Sensors::new(&rig, 1);
        (0..100).map(|_| sensors.read(0.15, [5e5; 2], 0.0).pressure_1).collect::<Vec<_>>()
    };
    assert_eq!(pressure("noise_counts = 3.0\n"), pressure(""));
}

/// The count changes where the distance says, and nowhere nearer.
#[test]
fn a_reading_changes_at_its_distance_and_not_before() {
    for model in ["potentiometer", "ssi"] {
        let keys = format!("model = \"{model}\"\nzero_mm = -5\nrange_mm = 310\n");
        let keys = format!("[encoder]\n{keys}[test]\nmoves = [[0.0, 2000]]\n");
        let mut encoder = Encoder::new(&rig(&keys), 0);
        for k in 0..500 {
            let position = 0.597e-3 * f64::from(k);
            let (here, distance) = (encoder.read(position), encoder.distance(position));
            let around = |part: f64| [-1.0, 1.0].map(|side| position + side * part * distance);
            assert!(around(0.99).iter().all(|&near| encoder.read(near) == here), "{model} at {position} m");
            assert!(around(1.01).iter().any(|&far| encoder.read(far) != here), "{model} at {position} m");
        }
    }
}

#[test]
fn the_zero_is_told_in_counts_and_a_quadrature_encoder_has_none() {
    let rig_of = |model: &str| {
        rig(&format!("[encoder]\nmodel = \"{model}\"\nzero_mm = -2.41\n[test]\nmoves = [[0.0, 2000]]\n"))
    };
    assert_eq!(zero_counts(&rig_of("ssi")), -200);
    assert_eq!(zero_counts(&rig("")), 0);
}

#[test]
fn what_does_not_reach_over_the_stroke_is_refused_with_the_remedy() {
    for (text, said) in [
        (
            "model = \"ssi\"\nbits = 12\n",
            "the encoder measures to 49.345 mm, but the stroke is 300.000 mm: it takes more bits or longer counts",
        ),
        (
            "model = \"potentiometer\"\nrange_mm = 250\n",
            "the encoder measures to 250.000 mm, but the stroke is 300.000 mm: it takes a longer range",
        ),
        (
            "model = \"potentiometer\"\nzero_mm = 5\nrange_mm = 310\n",
            "from 0 to there the encoder would read 0",
        ),
        ("model = \"potentiometer\"\nrange_mm = 900\nbits = 8\n", "a count would be 3.529 mm"),
    ] {
        let text = format!("[encoder]\n{text}[actuator]\nstroke_m = 0.3\n[test]\nmoves = [[0.0, 20]]\n");
        let problems = Rig::read("test", &text).expect_err("refused").to_string();
        assert!(problems.contains(said), "{text}: {problems}");
    }
}
