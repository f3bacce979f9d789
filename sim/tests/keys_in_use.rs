//! Every key that a rig is said to use changes its transient; one that it does not use is refused where a file has it.

use std::collections::BTreeSet;

use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Observation};
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Key, Kind, Preset, Value, all_keys};
use pneudrive_sim::rigfile::{BUILTIN, builtin};
use pneudrive_sim::{Accuracy, Rig, run};

/// Keys that say something of the drive to other programs than the simulator.
const TOLD_TO_OTHERS: &[(&str, &str)] = &[
    ("name", "reports"),
    ("tolerance_percent", "identify"),
    ("tolerance_pa", "identify"),
    ("encoder.offset_tolerance_mm", "identify"),
    ("sensors.spool_offset_tolerance_mm", "identify"),
    ("operator.dither_adjustable", "tune"),
    ("sensors.home_switch_mm", "homing runs, which no test has"),
    ("encoder.polarity", "a board's wires"),
    ("test.decimation", "records"),
    ("test.tolerance_mm", "figures of moves, tune, sweep"),
    ("test.pre_trigger", "records"),
];

/// Keys of which a short test that goes well shows nothing: they change parameters of the controller.
const OF_THE_BOARD: &[&str] = &[
    "safety.",
    "controller.learn",
    "controller.adapt",
    "controller.homing",
    "controller.forced_exit_s",
    "controller.exit_on_dead_band",
    "controller.tolerance_counts",
    "controller.monitoring_s",
    "controller.dwell_s",
    "operator.pulse_width_us",
    "operator.direction_setup_us",
];

/// Built-in rigs with other models, so that each key is used in one of them at least.
const VARIANTS: &[(&str, &[&str])] = &[
    ("servo-b-tuned", &["valve.model=multiple-flow-node"]),
    (
        "servo-b-tuned",
        &[
            "valve.model=single-restriction",
            "valve.discharge_model=perry",
            "tubing.model=analytical",
            "actuator.return_spring=retract",
        ],
    ),
    (
        "servo-b",
        &[
            "valve.flow_force=experimental",
            "actuator.leakage=adiabatic",
            "actuator.heat_transfer_w_per_m2_k=100.0",
            "actuator.vented=chamber-2",
        ],
    ),
    (
        "servo-b-tuned",
        &["operator.model=solenoid-empirical", "load.friction=lugre", "actuator.leakage=laminar"],
    ),
    (
        "servo-b-tuned",
        &[
            "valve.model=iso-6358",
            "valve.characteristic=linear",
            "valve.sonic_conductance_m3_per_s_pa=1e-8",
            "valve.critical_ratio=0.3",
        ],
    ),
    (
        "servo-b-tuned",
        &[
            "valve.model=iso-6358",
            "valve.characteristic=table",
            "valve.characteristic_table=[[0.0, 1.0], [100.0, 100.0]]",
            "valve.sonic_conductance_m3_per_s_pa=1e-8",
            "valve.critical_ratio=0.3",
        ],
    ),
    (
        "servo-b-tuned",
        &[
            "valve.model=flow-map",
            "valve.flow_map=[[0, 700, 140, 4, 1], [0, 700, 560, 3, 1], [100, 700, 140, 800, 9], [100, 700, 560, 500, 9]]",
        ],
    ),
    ("servo-b-tuned", &["test.profile=s-curve", "test.moves=[[0.0, 9000]]", "controller.law=proportional"]),
    (
        "servo-b-tuned",
        &[
            "controller.law=moore-proportional",
            "controller.proportional_gain=500",
            "controller.learn_null_offset=true",
            "controller.learning_gain=20000",
        ],
    ),
    (
        "servo-b-tuned",
        &[
            "controller.law=pid",
            "controller.proportional_gain=500",
            "controller.integral_gain=200",
            "controller.integral_band_counts=1000",
        ],
    ),
    ("servo-b-tuned", &["encoder.model=potentiometer", "test.moves=[[0.0, 1500], [0.2, 1700]]"]),
    ("servo-b", &["controller.model=continuous"]),
    (
        "servo-b-tuned",
        &["valve.model=single-restriction", "tubing.model=none", "tubing.flow_control=meter-out"],
    ),
    (
        "servo-b-tuned",
        &[
            "supply.model=receiver",
            "supply.receiver_volume_m3=5e-4",
            "supply.receiver_heat_transfer_w_per_m2_k=50.0",
            "test.receiver_pressure_pa=650e3",
        ],
    ),
    (
        "servo-b-tuned",
        &[
            "supply.model=regulator",
            "supply.receiver_volume_m3=5e-4",
            "test.receiver_pressure_pa=600e3",
            "faults.event=[{ kind = \"supply-dip\", at_s = 0.03, duration_s = 0.1, pressure_pa = 2e5 }]",
        ],
    ),
    (
        "servo-b-tuned",
        &[
            "actuator.cushion=adjustable",
            "actuator.cushion_2_length_m=0.15",
            "actuator.cushion_spear_diameter_m=0.03",
            "test.position_m=0.2",
        ],
    ),
];

/// Tests, one of which makes a key count, as settings: that of the file; on a profile; to and fro in closed and in open loop;
/// into a stop; from rest at a stop; to targets; out of chambers that the exhaust fills.
fn tests(rig: &Rig) -> Vec<Vec<String>> {
    let metres_per_count =
        1e-12 * f64::from(rig.parameters().get(id::ENCODER_PM_PER_COUNT).expect("a length"));
    let full = rig.get(&keys::actuator::STROKE_M) / metres_per_count;
    let at = |part: f64| (part * full) as i64;
    let moves = |first: i64, after_s: f64, second: i64| {
        format!("test.moves=[[0.0, {first}], [{after_s:?}, {second}]]")
    };
    let thrown =
        [words(&["controller.loop=open", "test.profile=step"]), vec![moves(-2048, 0.1, 2048)]].concat();
    vec![
        vec![],
        vec!["test.profile=s-curve".to_owned(), format!("test.moves=[[0.0, {}]]", at(0.36))],
        vec![moves(at(0.24), 0.15, at(0.38))],
        vec!["test.profile=step".to_owned(), moves(at(0.32), 0.05, at(0.004))],
        thrown.clone(),
        words(&["test.position_m=0.0003", "test.pressure_1_pa=150000.0", "test.pressure_2_pa=550000.0"]),
        vec![format!("test.targets=[{}, {}]", at(0.3), at(0.36))],
        [words(&["test.pressure_1_pa=50000.0", "test.pressure_2_pa=50000.0"]), thrown].concat(),
    ]
}

fn words(settings: &[&str]) -> Vec<String> {
    settings.iter().map(|setting| (*setting).to_owned()).collect()
}

/// Keys of rigs that describe a part and change nothing there, with why.
const ALIKE: &[(&str, &str, &str)] = &[
    ("servo-c", "actuator.model", "a rodless cylinder has equal areas, whichever kind it is"),
    (
        "servo-a",
        "valve.spool_travel_mm",
        "a stepper goes by its steps; characterise goes to the ends of the travel",
    ),
    ("lut-stepper", "valve.spool_travel_mm", "as in servo-a"),
];

/// Values of other kinds than numbers, switches and words.
fn values_of(key: &str) -> &'static [&'static str] {
    match key {
        "controller.gain_profile" => &["[300, 200, 100]"],
        "valve.flow_force_inlet" | "valve.flow_force_outlet" => {
            &["[0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]"]
        }
        "valve.characteristic_table" => &["[[0.0, 5.0], [100.0, 100.0]]"],
        "valve.flow_map" => {
            &["[[0, 700, 140, 4, 1], [0, 700, 560, 3, 1], [100, 700, 140, 700, 9], [100, 700, 560, 400, 9]]"]
        }
        "faults.event" => &["[{ kind = \"stuck-spool\", at_s = 0.05 }]"],
        "test.moves" => &["[[0.0, 7000], [0.1, 7500]]", "[[0.0, 100], [0.1, -100]]"],
        "test.moves_mm" => &["[[0.0, 84.3], [0.1, 90.4]]", "[[0.0, 14], [0.1, 15]]"],
        "test.targets_mm" => &["[84.3, 90.4]", "[14, 15]"],
        "test.targets" => &["[7000, 7500]", "[100, -100]"],
        "test.move" => &["[{ profile = \"step\", to_counts = 7000 }]"],
        "test.impulse" => &["[0.05, 0.1, 50]", "[0.05, 0.1, -3000]"],
        "test.repeat_every_s" => &["0.1", "0.15"],
        "encoder.bits" => &["10", "14"],
        _ => &[],
    }
}

/// Other values of a key, as settings.
fn others(rig: &Rig, key: &Key) -> Vec<String> {
    let number = |value: f64| format!("{}={value:?}", key.path);
    let integer = |value: i64| format!("{}={value}", key.path);
    let mut found: Vec<String> =
        values_of(key.path).iter().map(|value| format!("{}={value}", key.path)).collect();
    match (key.kind, rig.value(key.path)) {
        (Kind::Number { min, max }, value) => {
            let own = if let Some(Value::Number(value)) = value { *value } else { 0.0 };
            let near = [1.1 * own, 0.9 * own, 2.0 * own, 0.5 * own, own + 0.01, own - 0.01];
            found.extend(near.into_iter().filter(|value| (min..=max).contains(value)).map(number));
            found.extend([0.5, 0.1, 0.3, 0.01, 1e-3].map(|part| number(min + part * (max - min))));
            found.extend([max, min].map(number));
        }
        (Kind::Integer { min, max }, value) => {
            let own = if let Some(Value::Integer(value)) = value { *value } else { 0 };
            let near = [2 * own, own / 2, own + 1, own - 1, own + 50, own - 50, own + 2000, max, min];
            found.extend(near.into_iter().filter(|value| (min..=max).contains(value)).map(integer));
        }
        (Kind::Switch, Some(Value::Switch(on))) => found.push(format!("{}={}", key.path, !on)),
        (Kind::Choice(words), _) => {
            found.extend(
                words.iter().filter(|(_, built)| *built).map(|(word, _)| format!("{}={word}", key.path)),
            );
        }
        _ => {}
    }
    found
}

/// Everything that is known of a run, or how it failed.
type Transient = Result<(u64, Vec<Observation>, Option<(Fault, u32)>), String>;

fn transient(rig: &Rig) -> Transient {
    let accuracy = Accuracy { tolerance: 1e-6, ..Accuracy::default() };
    let run = run(rig, accuracy).map_err(|error| error.to_string())?;
    Ok((run.bits(), run.observations, run.fault))
}

/// A rig in one of the tests, with its transient.
type Base = (Rig, Transient);

fn bases(rig: &Rig) -> Vec<Base> {
    let in_test = |test: Vec<String>| {
        let base = rig.with_settings(&test).ok()?;
        let own = transient(&base);
        Some((base, own))
    };
    tests(rig).into_iter().filter_map(in_test).collect()
}

/// How a key shows that a rig uses it.
enum Shown {
    Yes,
    No,
    /// No other value is accepted.
    Alone,
}

fn shown(bases: &[Base], key: &Key) -> Shown {
    let of_board = OF_THE_BOARD.iter().any(|start| key.path.starts_with(start));
    let mut is_alone = true;
    for (base, own) in bases {
        for setting in others(base, key) {
            let Ok(other) = base.with_settings(&[setting]) else { continue };
            let is_same = other.value(key.path) == base.value(key.path);
            if is_same || base.idle(key).is_some() || other.idle(key).is_some() {
                continue;
            }
            is_alone = false;
            let differs =
                if of_board { other.parameters() != base.parameters() } else { transient(&other) != *own };
            if differs {
                return Shown::Yes;
            }
        }
    }
    if is_alone { Shown::Alone } else { Shown::No }
}

fn is_told_to_others(key: &Key) -> bool {
    TOLD_TO_OTHERS.iter().any(|(end, _)| key.path.ends_with(end))
}

fn is_alike(rig: &str, key: &Key) -> bool {
    ALIKE.iter().any(|(start, path, _)| rig.starts_with(start) && key.path == *path)
}

/// Whether a file can say anything else than without the key.
fn has_other_values(key: &Key) -> bool {
    match key.kind {
        Kind::Choice(words) => words.iter().filter(|(_, built)| *built).count() > 1,
        kind => kind != Kind::DefaultOnly,
    }
}

/// The rigs: built-in ones, variants of them, and drives by their data sheets.
fn rigs() -> Vec<(String, Rig)> {
    let files = [
        ("poppet", include_str!("../../docs/examples/poppet.toml")),
        ("own drive", include_str!("../../host/evaluate/tests/cases/rest7207.toml")),
    ];
    let plain = BUILTIN.iter().map(|(name, text)| (*name, *text)).chain(files).map(|rig| (rig, &[][..]));
    let variants =
        VARIANTS.iter().map(|(name, settings)| ((*name, builtin(name).expect("a rig")), *settings));
    plain
        .chain(variants)
        .map(|((name, text), settings)| {
            let all = [words(settings), words(&["test.duration_s=0.35"])].concat();
            let rig =
                Rig::read_with(name, text, &all).unwrap_or_else(|problems| panic!("{name}: {problems}"));
            (format!("{name} {}", settings.join(" ")), rig)
        })
        .collect()
}

/// Keys that a rig is said to use: those of which another value changes nothing, and those of which one does.
fn of_rig(name: &str, rig: &Rig) -> (Vec<String>, BTreeSet<&'static str>) {
    let (mut dead, mut alive) = (Vec::new(), BTreeSet::new());
    let bases = bases(rig);
    let used = all_keys().filter(|key| rig.idle(key).is_none() && has_other_values(key));
    for key in used.filter(|key| !is_told_to_others(key) && !is_alike(name, key)) {
        match shown(&bases, key) {
            Shown::Yes => drop(alive.insert(key.path)),
            Shown::No => dead.push(format!("{name}: {}", key.path)),
            Shown::Alone => {}
        }
    }
    (dead, alive)
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn a_key_that_a_rig_uses_changes_its_transient() {
    let rigs = rigs();
    let found: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> = rigs.iter().map(|(name, rig)| scope.spawn(move || of_rig(name, rig))).collect();
        runs.into_iter().map(|rig| rig.join().expect("no panic")).collect()
    });
    let dead: Vec<String> = found.iter().flat_map(|(dead, _)| dead.clone()).collect();
    let alive: BTreeSet<&str> = found.iter().flat_map(|(_, alive)| alive.iter().copied()).collect();
    let untried: Vec<&str> = all_keys()
        .filter(|key| !is_told_to_others(key) && has_other_values(key) && !alive.contains(key.path))
        .map(|key| key.path)
        .collect();
    assert!(dead.is_empty() && untried.is_empty(), "{dead:#?}\nused in no rig: {untried:#?}");
}

fn refused(text: &str) -> String {
    Rig::read("rig", text).expect_err(text).to_string()
}

#[test]
fn a_key_of_a_file_that_does_nothing_there_is_refused_with_what_keeps_it_from_it() {
    for (text, says) in [
        (
            "[controller]\nmodel = \"continuous\"\nlearn_null_offset = true\n",
            "controller.learn_null_offset has no effect with controller.model = \"continuous\"",
        ),
        (
            "[controller]\nmodel = \"continuous\"\nvelocity_feed_forward = 5\n",
            "controller.velocity_feed_forward has no effect with",
        ),
        (
            "[controller]\nlearning_gain = 5\n",
            "controller.learning_gain has no effect with controller.learn_null_offset = false",
        ),
        (
            "[controller]\nloop = \"open\"\npressure_feedback_gain = 3.0\n",
            "controller.pressure_feedback_gain has no effect with controller.loop = \"open\"",
        ),
        (
            "[controller]\ndead_zone_counts = 7\n",
            "controller.dead_zone_counts has no effect with controller.law = \"gain-profile\"",
        ),
        (
            "[controller]\nlaw = \"cascade\"\nvelocity_gain = 5\n",
            "controller.velocity_gain has no effect with controller.law = \"cascade\"",
        ),
        (
            "[controller]\nlaw = \"cascade\"\nvelocity_dead_band = 5\n",
            "controller.velocity_dead_band has no effect with controller.law = \"cascade\"",
        ),
        (
            "[controller]\nlaw = \"cascade\"\nacceleration_feed_forward = 5\n",
            "controller.acceleration_feed_forward has no effect with controller.law = \"cascade\"",
        ),
        (
            "[controller]\nloop = \"open\"\nvelocity_dead_band = 5\n",
            "controller.velocity_dead_band has no effect with controller.loop = \"open\"",
        ),
        (
            "[controller]\nlaw = \"pid\"\nintegral_band_counts = 5\n",
            "controller.integral_band_counts has no effect with controller.integral_gain = 0",
        ),
        (
            "[valve]\nmodel = \"single-restriction\"\nport_diameter_mm = 4.0\n",
            "valve.port_diameter_mm has no effect with valve.model = \"single-restriction\"",
        ),
        (
            "[valve]\nconnector_diameter_mm = 4.0\n",
            "valve.connector_diameter_mm has no effect with valve.model = \"flow-node\"",
        ),
        ("[valve]\nland_length_m = 0.02\n", "valve.land_length_m has no effect: leave it out"),
        ("[valve]\ndischarge_reverse = 0.9\n", "valve.discharge_reverse has no effect: leave it out"),
        (
            "[load]\nvelocity_threshold_m_s = 1e-3\n",
            "load.velocity_threshold_m_s has no effect: leave it out",
        ),
        (
            "[tubing]\nmodel = \"none\"\ndrop_slope = 0.2\n",
            "tubing.drop_slope has no effect with tubing.model = \"none\"",
        ),
    ] {
        let message = refused(text).replace(": has no effect", " has no effect");
        assert!(message.contains(says), "{text}: {message}");
    }
}

#[test]
fn its_neutral_value_is_accepted_and_a_setting_may_take_the_effect_of_a_line_away() {
    for key in all_keys().filter(|key| !matches!(key.preset, Preset::Absent(_))) {
        if let (Some(value), false) =
            (Rig::read("rig", "").expect("valid").value(key.path), key.table().is_empty())
        {
            let text = format!("[{}]\n{} = {value}\n[operator]\n", key.table(), key.name());
            let text = if key.table() == "operator" { text.replace("\n[operator]\n", "\n") } else { text };
            Rig::read("rig", &text).unwrap_or_else(|problems| panic!("{problems}"));
        }
    }
    let file = "[tubing]\ndrop_slope = 0.2\n";
    let without = Rig::read_with("rig", file, &["tubing.model=none".to_owned()]).expect("valid");
    assert_eq!(without.unused(), ["tubing.drop_slope"]);
}
