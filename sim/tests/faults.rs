//! What each fault does to a drive, in whole runs.

use pneudrive_controller::Observation;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// A run of a built-in rig ("" for the default one) with events, each in TOML, and settings.
fn simulate(rig: &str, events: &[&str], settings: &[&str]) -> Run {
    let rig = rig_with(rig, events, settings);
    run(&rig, Accuracy::of(&rig)).expect("a transient")
}

fn rig_with(rig: &str, events: &[&str], settings: &[&str]) -> Rig {
    let text = pneudrive_sim::rigfile::builtin(rig).unwrap_or("");
    let events: String = events.iter().map(|event| format!("\n[[faults.event]]\n{event}\n")).collect();
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    let rig = Rig::read_with(rig, &format!("{text}{events}"), &settings);
    rig.unwrap_or_else(|problems| panic!("{problems}"))
}

/// Rows from a time on, until another.
fn rows(run: &Run, from: f64, until: f64) -> impl Iterator<Item = &Row> + Clone {
    run.rows.iter().filter(move |row| row.time >= from && row.time < until)
}

fn at(run: &Run, time: f64) -> &Row {
    rows(run, time, f64::INFINITY).next().expect("a row")
}

/// A valve without leakage or dither on a cylinder whose piston does not move.
const HELD: [&str; 7] = [
    "controller.loop=open",
    "test.moves=[[0.0, 0]]",
    "operator.dither_mm=0",
    "operator.hysteresis_percent=0",
    "valve.spool_diameter_mm=10",
    "load.static_extend_n=9000",
    "load.static_retract_n=9000",
];

/// A valve that is wide open may move nothing.
const UNWATCHED: &str = "safety.no_motion_s=0";

fn held(more: &[&'static str]) -> Vec<&'static str> {
    HELD.iter().chain(more).copied().collect()
}

const TUBES: [&[&str]; 4] = [
    &["tubing.model=empirical"],
    &["tubing.model=empirical", "tubing.lag_s=0.005"],
    &["tubing.model=analytical"],
    &["tubing.model=none"],
];

fn dip(at_s: &str) -> String {
    format!("kind = \"supply-dip\"\nat_s = {at_s}\npressure_pa = 350000\nduration_s = 2")
}

/// A chamber that is charged: from the exhaust's pressure, through an open valve.
const CHARGED: [&str; 3] =
    ["test.moves=[[0.0, 512]]", "valve.spool_diameter_mm=9.98", "test.pressure_1_pa=110000"];

/// Lagged tubes take a few of their lags for it.
#[test]
fn in_a_dip_of_the_supply_less_air_flows_into_a_chamber_that_is_charged() {
    for tubes in TUBES {
        let settings = [held(&CHARGED).as_slice(), tubes, &["test.duration_s=0.05"]].concat();
        let flow = |events: &[&str]| at(&simulate("", events, &settings), 0.04).plant.mass_flows[0];
        let ratio = flow(&[&dip("0.01")]) / flow(&[]);
        assert!((0.4..0.7).contains(&ratio), "{tubes:?}: {ratio}, the supplies are as 0.594");
    }
}

#[test]
fn a_chamber_follows_a_dip_of_the_supply_down_and_up_again() {
    for tubes in TUBES.into_iter().filter(|tubes| tubes.len() == 1) {
        let settings =
            [held(&CHARGED).as_slice(), tubes, &["test.duration_s=6", "valve.upstream_mach=false"]].concat();
        let settled = |supply: &'static str| {
            let rest = simulate("", &[], &[settings.as_slice(), &[supply]].concat());
            rest.rows.last().expect("rows").plant.pressures[0]
        };
        let (low, full) = (settled("supply.pressure_pa=350000"), settled("supply.pressure_pa=589000"));
        assert!(low < 350e3 && full > 450e3, "{tubes:?}: {low} {full}");
        let run = simulate("", &[&dip("1.5")], &settings);
        for (time, expected) in [(1.49, full), (3.49, low), (5.9, full)] {
            let pressure = at(&run, time).plant.pressures[0];
            assert!((pressure / expected - 1.0).abs() < 2e-3, "{tubes:?}: {pressure} at {time}");
        }
    }
}

/// Discharge of a rigid volume through a choked hole (see `actuator/charging.rs`):
/// P = P_0 (1 + (n-1)/2 t/tau)^(-2n/(n-1)), tau = V / (A c). Exact from the event's very instant on.
#[test]
fn a_leak_empties_a_shut_chamber_as_the_closed_form_of_a_choked_discharge() {
    let settings = held(&["valve.underlap_mm=0.5", "test.pressure_1_pa=500000", "test.duration_s=0.3"]);
    let leak = "kind = \"leak\"\nat_s = 0.012345\nchamber = 1\ndiameter_mm = 1.5";
    let run = simulate("", &[leak], &settings);
    let volume = std::f64::consts::PI / 4.0 * 0.05 * 0.05 * 98.719_625e-3 + 2e-5;
    let area = std::f64::consts::PI / 4.0 * 1.5e-3 * 1.5e-3;
    let speed = (1.4 * 286.76 * 294.0_f64).sqrt() * (2.0 / 2.4_f64).powi(3);
    let mut compared = 0;
    for row in &run.rows {
        let since = (row.time - 0.012_345).max(0.0);
        let rest = 1.0 + 0.2 * since * area * speed / volume;
        let [pressure, temperature] = [5e5 * rest.powi(-7), 294.0 / (rest * rest)];
        if pressure > 101_300.0 / 0.528 {
            let plant = &row.plant;
            assert!((plant.pressures[0] / pressure - 1.0).abs() < 1e-9, "{}", row.time);
            assert!((plant.temperatures[0] / temperature - 1.0).abs() < 1e-9, "{}", row.time);
            compared += usize::from(since > 0.0);
        }
        assert_eq!(row.plant.pressures[1], run.rows[0].plant.pressures[1], "chamber 2 is shut");
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn a_leak_ends_at_the_pressure_of_the_surroundings_and_holds_no_step_back_there() {
    let settings = held(&["valve.underlap_mm=0.5", "test.duration_s=3"]);
    let run = simulate("", &["kind = \"leak\"\nat_s = 0\nchamber = 2\ndiameter_mm = 4"], &settings);
    let last = run.rows.last().expect("rows").plant;
    assert!((last.pressures[1] - 101_300.0).abs() < 1e-3, "{}", last.pressures[1]);
    assert!(run.work.integrator.n_steps < 5000, "{:?}", run.work.integrator);
}

#[test]
fn with_swapped_tubes_a_positive_command_retracts() {
    let settings = ["controller.loop=open", "test.moves=[[0.0, 512]]", "test.duration_s=0.3"];
    let travel = |run: &Run| run.rows.last().expect("rows").plant.position - run.rows[0].plant.position;
    assert!(travel(&simulate("servo-b", &[], &settings)) > 0.01);
    assert!(travel(&simulate("servo-b", &["kind = \"swapped-tubes\"\nat_s = 0"], &settings)) < -0.01);
}

/// The valve is symmetric: crossed tubes and the opposite command are the same drive.
#[test]
fn swapped_tubes_are_the_opposite_command() {
    for tubes in TUBES {
        let settings = |moves: &'static str| {
            let plain = ["controller.loop=open", "operator.dither_mm=0", "test.duration_s=0.8", moves];
            [&plain, tubes].concat()
        };
        let swapped = "kind = \"swapped-tubes\"\nat_s = 0";
        // So exactly that what remains is no matter of how the flows were found.
        let exactly =
            |rig: Rig| run(&rig, Accuracy { tolerance: 1e-11, ..Accuracy::default() }).expect("a transient");
        let crossed = exactly(rig_with("", &[swapped], &settings("test.moves=[[0.0, 400], [0.4, -300]]")));
        let opposite = exactly(rig_with("", &[], &settings("test.moves=[[0.0, -400], [0.4, 300]]")));
        for (a, b) in crossed.rows.iter().zip(&opposite.rows) {
            assert!((a.plant.position - b.plant.position).abs() < 1e-10, "{tubes:?} at {}", a.time);
            for (a, b) in a.plant.pressures.into_iter().zip(b.plant.pressures) {
                assert!((a - b).abs() < 1e-4, "{tubes:?}: {a} {b}");
            }
            for (a, b) in a.plant.mass_flows.into_iter().zip(b.plant.mass_flows) {
                assert!((a - b).abs() < 1e-9, "{tubes:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_drive_whose_tubes_are_swapped_runs_away_from_its_setpoint_to_a_stop() {
    let run = simulate("servo-b-tuned", &["kind = \"swapped-tubes\"\nat_s = 0.35"], &[UNWATCHED]);
    let end = run.rows.last().expect("rows").plant.position;
    assert!(!(0.0..=0.3).contains(&end), "on a stop: {end}");
}

#[test]
fn a_stuck_spool_stays_where_it_is_in_every_bit_with_every_operator() {
    let stuck = ["kind = \"stuck-spool\"\nat_s = 0.3517"];
    for (rig, settings) in [
        ("servo-b-tuned", &[][..]),
        ("servo-b-tuned", &["operator.model=solenoid-empirical"]),
        ("servo-b-tuned", &["valve.flow_force=analytical"]),
        ("servo-a-tuned", &[]),
        ("bang-bang", &["operator.switch_time_s=0.1"]),
    ] {
        let run = simulate(rig, &stuck, settings);
        let spool = at(&run, 0.3517).plant.spool;
        let before = rows(&run, 0.0, 0.3517).last().expect("a row").plant.spool;
        assert!(spool != 0.0 && (spool - before).abs() < 0.2e-3, "{rig}: from {before} to {spool}");
        assert!(rows(&run, 0.3517, f64::INFINITY).all(|row| row.plant.spool == spool), "{rig} {settings:?}");
        let asked = |row: &Row| row.plant.spool_command;
        let first = asked(at(&run, 0.3517));
        assert!(rows(&run, 0.3517, 3.2).any(|row| asked(row) != first), "{rig}: it is still asked to move");
    }
}

/// An output of the stepper at 300 * 1.3 ms + 0.5 ms: the fault comes first.
#[test]
fn a_spool_that_sticks_at_the_instant_of_an_output_does_not_take_its_step() {
    let settings = ["controller.loop=open", "test.moves=[[0.0, 0], [0.39, 20]]", "test.duration_s=0.5"];
    let spool = |at: &str| {
        let run = simulate("servo-a", &[&format!("kind = \"stuck-spool\"\nat_s = {at}")], &settings);
        run.rows.last().expect("rows").plant.spool
    };
    assert_eq!([spool("0.3905"), spool("0.390501")], [0.0, 0.0125e-3]);
}

#[test]
fn the_count_of_a_lost_encoder_freezes_while_the_drive_moves_on() {
    let run = simulate("servo-b-tuned", &["kind = \"encoder-loss\"\nat_s = 0.35"], &[]);
    let last_live = rows(&run, 0.0, 0.35).last().expect("a row").observation.position;
    let after = || rows(&run, 0.35, 1.0);
    assert!(after().all(|row| row.observation.position == last_live));
    let farthest = after().map(|row| row.plant.position).fold(0.0, f64::max);
    assert!(farthest > f64::from(last_live) * 0.01205e-3 + 0.05, "{farthest}");
}

#[test]
fn a_jump_of_the_encoder_shifts_every_later_count_by_its_number() {
    let jumps = ["kind = \"encoder-jump\"\nat_s = 0.35\ncounts = -100", "kind = \"encoder-jump\"\nat_s = 2"];
    let run = simulate("servo-b-tuned", &jumps, &["safety.max_speed_m_s=50"]);
    let off = |row: &Row| row.observation.position - (row.plant.position / 0.01205e-3 + 1e-9).floor() as i32;
    // The row of a sample has the count of that instant.
    assert!(rows(&run, 0.0, 0.35).all(|row| off(row) == 0));
    assert!(rows(&run, 0.35, 2.0).all(|row| off(row) == -100));
    assert!(rows(&run, 2.0, 4.0).all(|row| off(row) == 900));
    assert_eq!(run.fault, None);
}

#[test]
fn a_sensor_that_is_open_reads_zero_and_moves_nothing() {
    let healthy = simulate("servo-b-tuned", &[], &[]);
    for (sensor, channel) in [("pressure-1", 0), ("pressure-2", 1), ("spool", 2)] {
        let open = format!("kind = \"sensor-open\"\nat_s = 0.5\nsensor = \"{sensor}\"");
        let run = simulate("servo-b-tuned", &[&open], &["safety.sensor_watch=false"]);
        for (row, other) in run.rows.iter().zip(&healthy.rows) {
            let of = |row: &Row| {
                let seen = row.observation;
                [seen.pressure_1, seen.pressure_2, seen.spool]
            };
            let mut expected = of(other);
            if row.time >= 0.5 {
                expected[channel] = 0;
            }
            assert_eq!((of(row), row.plant), (expected, other.plant), "{sensor} at {}", row.time);
        }
        assert_eq!(run.work, healthy.work);
    }
}

/// The law does not need them: what is lost is what is seen.
#[test]
fn a_drive_without_pressure_sensors_moves_as_with_them_and_records_none() {
    let with = simulate("servo-b-tuned", &[], &[]);
    let without = simulate("servo-b-tuned", &[], &["sensors.pressure=false"]);
    assert_eq!((without.fault, without.rows.len()), (None, with.rows.len()));
    for (row, other) in without.rows.iter().zip(&with.rows) {
        let expected = Observation { pressure_1: 0, pressure_2: 0, ..other.observation };
        assert_ne!(other.observation.pressure_1, 0);
        assert_eq!((row.observation, row.plant), (expected, other.plant), "at {}", row.time);
    }
}

/// Reading the plant changes nothing, faults or not.
#[test]
fn a_fault_takes_the_same_steps_however_often_the_plant_is_looked_at() {
    let events = [
        "kind = \"supply-dip\"\nat_s = 0.35071\nduration_s = 0.2003",
        "kind = \"leak\"\nat_s = 0.4\nchamber = 2",
        "kind = \"swapped-tubes\"\nat_s = 1.13",
        "kind = \"stuck-spool\"\nat_s = 1.2",
    ];
    // Both end with a sample: 2000 * 1.3 ms.
    let end = "test.duration_s=2.6";
    let seldom = simulate("servo-b-tuned", &events, &[end]);
    let often = simulate("servo-b-tuned", &events, &[end, "test.trace_period_s=0.0001"]);
    assert_eq!(seldom.work.integrator, often.work.integrator);
    assert_eq!(seldom.observations, often.observations);
}

/// Thesis 8.2.5: with gains that can only be positive the spool command shows jerks, and the drive does
/// not come back from an overshoot.
#[test]
fn a_drive_with_positive_gains_only_jerks_after_an_overshoot_and_does_not_hold() {
    let faulty = simulate("servo-b-tuned", &[], &["faults.gain_bug=positive-error"]);
    let healthy = simulate("servo-b-tuned", &[], &[]);
    let overshoot = |run: &Run| {
        let row = rows(run, 0.3, 1.72).find(|row| row.observation.error < 0);
        row.map(|row| row.time).expect("it overshoots")
    };
    let from = overshoot(&faulty);
    let away: Vec<&Row> = rows(&faulty, from, from + 0.4).collect();
    assert!(away.iter().all(|row| row.observation.error < 0), "it never comes back");
    let reversals = |rows: &[&Row]| {
        let signs: Vec<i16> = rows.iter().map(|row| row.observation.command.signum()).collect();
        signs.windows(2).filter(|pair| pair[0] * pair[1] < 0).count()
    };
    assert!(reversals(&away) >= 10, "{} jerks", reversals(&away));
    let from = overshoot(&healthy);
    assert!(reversals(&rows(&healthy, from, from + 0.4).collect::<Vec<_>>()) < 10);
    let end = |run: &Run| at(run, 1.7).plant.position - 16_384.0 * 0.01205e-3;
    assert!(end(&faulty) > 0.1 && end(&healthy).abs() < 1e-3, "{} {}", end(&faulty), end(&healthy));
}

/// The trace has the command of the faulty law: what a standing drive of a negative error is given.
#[test]
fn the_trace_of_the_gain_bug_shows_its_command() {
    let run = simulate("servo-b-tuned", &[], &["faults.gain_bug=positive-error", UNWATCHED]);
    let resting = run.observations.iter().filter(|seen| seen.velocity == 0 && seen.acceleration == 0);
    let negative: Vec<_> = resting.filter(|seen| seen.error < 0).collect();
    assert!(negative.len() > 20 && negative.iter().all(|seen| seen.command > 0), "{}", negative.len());
    let driven = |row: &Row| f64::from(row.observation.command) / 2048.0 * 1e-3;
    assert!(run.rows.windows(2).all(|pair| pair[1].plant.spool_command == driven(&pair[0])));
}
