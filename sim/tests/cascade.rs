//! The law "cascade": what it is for. Its integers are compared with its equations in `shared/controller/tests/cascade.rs`.

mod doubt;
mod endurance;
mod in_motion;
mod redirected;
mod thesis;

use pneudrive_controller::law::Running;
use pneudrive_controller::{Config, Fault, Mode, Move, Sequence, State, output, sample};
use pneudrive_sim::{Accuracy, Plant, Rig};

const PRESS: &str = include_str!("cascade/press.toml");

/// Other drives by their data sheets, as changes to the first.
const DRIVES: [(&str, &[&str]); 6] = [
    ("32 x 250 mm, 8 kg", &[]),
    ("the same, vertical", &["load.incline_deg=90"]),
    (
        "20 x 150 mm, 1 kg, 100 l/min",
        &[
            "valve.sonic_conductance_m3_per_s_pa=3.93283e-9",
            "actuator.stroke_m=0.15",
            "actuator.bore_m=0.02",
            "actuator.rod_diameter_m=0.008",
            "actuator.residual_volume_1_m3=2.63782e-6",
            "actuator.residual_volume_2_m3=2.21577e-6",
            "load.mass_kg=1.11175",
            "load.static_extend_n=19.1418",
            "load.static_retract_n=19.1418",
            "load.coulomb_extend_n=9.42478",
            "load.coulomb_retract_n=9.42478",
        ],
    ),
    ("32 x 250 mm, 8 kg, 0.5 ms", &["controller.period_s=0.0005", "controller.delay_s=0.0002"]),
    ("32 x 250 mm, 8 kg, an amplifier that opens the valve to 0.9", &["operator.amplifier_gain=0.9"]),
    ("32 x 250 mm, 8 kg, sensors with a lag of 2 ms", &["sensors.pressure_lag_s=0.002"]),
];

/// Numbers that look random and are the same everywhere (xorshift).
struct Draws(u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

fn rig(settings: &[String]) -> Rig {
    Rig::read_with("press", PRESS, settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn settings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(ToString::to_string).collect()
}

/// The settings of a plant with these factors of mass, friction and supply.
fn unlike(of: &[&str], [mass, friction, supply]: [f64; 3]) -> Vec<String> {
    let known = rig(&settings(of));
    let mut real = settings(of);
    // It only moves, whatever the law's model can be.
    real.push("controller.law=\"gain-profile\"".to_owned());
    for (key, by) in [
        ("load.mass_kg", mass),
        ("load.static_extend_n", friction),
        ("load.static_retract_n", friction),
        ("load.coulomb_extend_n", friction),
        ("load.coulomb_retract_n", friction),
        ("supply.pressure_pa", supply),
    ] {
        real.retain(|setting| !setting.starts_with(key));
        real.push(format!("{key}={}", by * known.number_at(key).expect("a number")));
    }
    real
}

/// A drive whose plant is not quite what its controller takes it for.
struct Drive {
    plant: Plant,
    config: Config,
    state: State,
    /// s, m.
    period: f64,
    count: f64,
    start: i32,
    /// How long the plant has run before, s.
    before: f64,
}

impl Drive {
    /// A plant with mass and friction within 30 % and a supply within 5 % of the file's, its load at a place (m).
    fn drawn(of: &[&str], draws: &mut Draws, start: f64) -> Drive {
        let factors = [draws.between(0.7, 1.3), draws.between(0.7, 1.3), draws.between(0.95, 1.05)];
        Drive::unlike(of, factors, start)
    }

    /// The same with these factors of mass, friction and supply.
    fn unlike(of: &[&str], factors: [f64; 3], start: f64) -> Drive {
        Drive::of_another(of, factors, &[], start)
    }

    /// The same on a plant with other settings besides.
    fn of_another(of: &[&str], factors: [f64; 3], also: &[&str], start: f64) -> Drive {
        let known = rig(&settings(of));
        let number = |key: &str| known.number_at(key).expect("a number");
        let count = number("encoder.mm_per_count") * 1e-3;
        let start = (start / count).floor() as i32;
        let mut real = unlike(of, factors);
        real.extend(settings(also));
        real.push(format!("test.position_m={}", (f64::from(start) + 0.5) * count));
        real.push(format!("test.moves=[[0.02, {start}]]"));
        let real = rig(&real);
        let parameters = known.parameters();
        Drive {
            plant: Plant::new(&real, Accuracy { tolerance: 1e-8, ..Accuracy::of(&real) }, 1),
            config: Config::new(&parameters).expect("a checked rig"),
            state: State::default(),
            period: number("controller.period_s"),
            count,
            start,
            before: 0.0,
        }
    }

    /// Runs moves; `see` gets the time and the true position at each sample.
    fn run(&mut self, sequence: &Sequence, mut see: impl FnMut(f64, f64)) -> Option<Fault> {
        self.state.locate(0);
        self.state.supervisor.arm().expect("at rest");
        self.state.start(&self.config, sequence).expect("a run");
        let mut seen = self.plant.sample().expect("a sample");
        for k in 0..=sequence.duration_samples {
            sample(&self.config, sequence, &mut self.state, &seen);
            let command = output(&self.config, &mut self.state);
            let time = f64::from(k) * self.period;
            let position = self.plant.look(self.before + time).expect("a state").position;
            see(time, position);
            seen = self.plant.advance(command).expect("a sample");
        }
        match self.state.supervisor.mode() {
            Mode::Fault(fault) => Some(fault),
            _ => None,
        }
    }

    fn law(&self) -> &pneudrive_controller::law::cascade::Cascade {
        let Running::Cascade(law) = self.state.law() else { panic!("the law that was chosen") };
        law
    }

    /// A step from where it stands.
    fn step(&self, counts: i32, seconds: f64) -> Sequence {
        let mut sequence = Sequence::new((seconds / self.period) as u32);
        sequence.push(Move::step((0.02 / self.period) as u32, self.start + counts)).expect("room");
        sequence
    }
}

/// Every draw comes within a twentieth of a millimetre and stays there, passes its target by no more than a tenth, and stands.
#[test]
fn a_drive_by_its_data_sheet_alone_positions_within_a_twentieth_of_a_millimetre() {
    let mut draws = Draws(0x9e37_79b9_7f4a_7c15);
    for (name, of) in DRIVES {
        let stroke = rig(&settings(of)).number_at("actuator.stroke_m").expect("a number");
        for index in 0..10 {
            let travel_m = if index % 2 == 0 { 0.06 } else { -0.06 };
            let [low, high] =
                [0.05 * stroke - f64::min(travel_m, 0.0), 0.95 * stroke - f64::max(travel_m, 0.0)];
            let start = draws.between(low, high);
            let mut drive = Drive::drawn(of, &mut draws, start);
            let counts = (travel_m / drive.count).round() as i32;
            let target = (f64::from(drive.start + counts) + 0.5) * drive.count;
            let sequence = drive.step(counts, 1.2);
            let (mut came, mut beyond, mut low, mut high) =
                (0.0_f64, 0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
            let fault = drive.run(&sequence, |time, position| {
                let error = position - target;
                if error.abs() > 0.05e-3 {
                    came = time;
                }
                beyond = beyond.max(error * travel_m.signum());
                if time > 0.6 {
                    (low, high) = (low.min(position), high.max(position));
                }
            });
            let what =
                format!("{name}, draw {index}: {came} s, {beyond:.6} m beyond, {:.6} m at rest", high - low);
            assert_eq!(fault, None, "{what}");
            assert!(came < 0.5 && beyond < 0.1e-3 && high - low < 0.05e-3, "{what}");
        }
    }
}

/// Whatever it does not know of its plant, a drive comes to rest and stays there: there and back, and within 0.2 mm there again.
#[test]
fn a_drive_that_is_not_what_its_rig_file_says_does_not_swing() {
    let mut draws = Draws(0x2545_f491_4f6c_dd1d);
    for (what, friction, also) in [
        (
            "a valve of 50 Hz",
            1.0,
            ["operator.stiffness_per_mass_per_s2=98696", "operator.damping_per_s=439.8"],
        ),
        ("friction on bristles", 1.0, ["load.friction=\"lugre\"", "load.constant_force_n=0"]),
        ("80 N on the rod", 1.0, ["load.constant_force_n=80", "load.friction=\"coulomb\""]),
        ("flow x 0.8", 1.0, ["valve.sonic_conductance_m3_per_s_pa=1.10119e-8", "load.constant_force_n=0"]),
        ("friction x 0.4", 0.4, ["load.constant_force_n=0", "load.friction=\"coulomb\""]),
    ] {
        for index in 0..3 {
            let factors =
                [draws.between(0.7, 1.3), friction * draws.between(0.7, 1.3), draws.between(0.95, 1.05)];
            let start = draws.between(0.05, 0.15);
            let mut drive = Drive::of_another(&[], factors, &also, start);
            let counts = 6000;
            let at = |seconds: f64| (seconds / drive.period) as u32;
            let mut sequence = Sequence::new(at(6.02));
            for (move_at, to) in [(0.02, counts), (2.02, 0), (4.02, counts)] {
                sequence.push(Move::step(at(move_at), drive.start + to)).expect("room");
            }
            let target = (f64::from(drive.start + counts) + 0.5) * drive.count;
            let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            let mut error = f64::NAN;
            let fault = drive.run(&sequence, |time, position| {
                let within = (time - 0.02) / 2.0;
                if within.fract() > 0.5 && within < 3.0 {
                    let [low, high] = &mut ends[within as usize];
                    (*low, *high) = (low.min(position), high.max(position));
                }
                error = position - target;
            });
            let swings = ends.map(|[low, high]| high - low);
            let what = format!("{what}, draw {index}: {swings:?} m, {error} m in the end");
            assert_eq!(fault, None, "{what}");
            assert!(swings[2] < 0.1e-3 && error.abs() < 0.2e-3, "{what}");
        }
    }
}

/// A spool of 50 Hz where the rig file says 81 is found to be slower in its first trajectory, and one of 81 Hz is not.
#[test]
fn the_lag_of_a_slower_valve_is_learned() {
    let slow = ["operator.stiffness_per_mass_per_s2=98696", "operator.damping_per_s=439.8"];
    for (also, [least, most]) in [(&slow[..], [1.3, 2.9]), (&[], [0.8, 1.2])] {
        let mut drive = Drive::of_another(&[], [1.1, 0.9, 1.0], also, 0.05);
        assert_eq!(drive.run(&drive.step(6000, 0.5), |_, _| {}), None);
        let pace = f64::from(drive.law().lag().pace) / 65_536.0;
        assert!((least..=most).contains(&pace), "{pace} is not from {least} to {most}");
    }
}

/// The law shuts the valve once the air pushes as it wants, so that the command alone would tell of no effort.
#[test]
fn a_jammed_rod_trips_the_stall_detector() {
    let mut drive = Drive::unlike(&[], [1.0, 100.0, 1.0], 0.1);
    let fault = drive.run(&drive.step(6000, 3.0), |_, _| {});
    assert_eq!(fault, Some(Fault::NoMotion));
}

/// A profile is followed as it comes: a sine of 60 mm at 1 Hz.
#[test]
fn a_sine_is_followed_within_six_tenths_of_a_millimetre() {
    let sine = ["test.moves=[]", "test.duration_s=3", "test.position_m=0.125005"];
    let text = PRESS.replace("moves = [[0.02, 12250]]\n", "")
        + "\n[[test.move]]\nprofile = \"sine\"\nto_mm = 125\namplitude_mm = 30\nfrequency_hz = 1\ncycles = 3\n";
    let rig =
        Rig::read_with("press", &text, &settings(&sine[1..])).unwrap_or_else(|problems| panic!("{problems}"));
    let run = pneudrive_sim::run(&rig, Accuracy::of(&rig)).expect("a run");
    let count = 1e-5;
    let errors = run
        .rows
        .iter()
        .filter(|row| row.time > 1.0)
        .map(|row| (row.plant.position - (f64::from(row.observation.setpoint) + 0.5) * count).abs());
    let largest = errors.fold(0.0, f64::max);
    assert!(run.fault.is_none() && largest < 0.6e-3, "{largest} m");
}

#[test]
fn a_rig_that_lacks_what_the_law_needs_is_refused_by_name() {
    for (change, what) in [
        ("sensors.pressure=false", "sensors.pressure = true"),
        ("sensors.pressure_lag_s=0.006", "sensors.pressure_lag_s of at most 0.005"),
        ("operator.dither_mm=0.1", "operator.dither_mm = 0"),
        ("operator.model=\"solenoid\"", "operator.model"),
        ("valve.model=\"flow-node\"", "valve.model = \"iso-6358\""),
        ("tubing.model=\"empirical\"", "tubing.model = \"none\""),
    ] {
        let refused = Rig::read_with("press", PRESS, &settings(&[change]));
        let text = refused.err().map(|problems| problems.to_string()).unwrap_or_default();
        assert!(text.contains("controller.law") && text.contains(what), "{change}: {text}");
    }
    let small = Rig::read_with(
        "press",
        PRESS,
        &settings(&["actuator.residual_volume_1_m3=1e-7", "load.stop_stiffness_n_per_m=1e8"]),
    );
    let text = small.err().map(|problems| problems.to_string()).unwrap_or_default();
    assert!(text.contains("cascade_dead_length_1"), "{text}");
}

#[test]
fn a_plant_that_is_drawn_does_not_tell_the_law_what_it_is() {
    let known = rig(&[]);
    let heavy = settings(&["load.mass_kg=11", "supply.pressure_pa=6.5e5"]);
    for (how, drawn) in [
        ("by its spread", known.spread(0.2, 7).expect("in range")),
        ("by its settings", known.with_plant(&heavy).expect("valid")),
        ("by its numbers", known.with_numbers(&[("load.mass_kg", 11.0)]).expect("valid")),
        (
            "twice",
            known
                .with_plant(&heavy)
                .and_then(|rig| rig.with_plant(&["load.mass_kg=12".to_owned()]))
                .expect("valid"),
        ),
        (
            "with another test",
            known.with_plant(&heavy).and_then(|rig| rig.with_test(&[""; 0])).expect("valid"),
        ),
        (
            "with a friction that the law has no model of",
            known.with_plant(&settings(&["load.friction=\"lugre\""])).expect("valid"),
        ),
    ] {
        assert_ne!(
            drawn.value("load.mass_kg").zip(drawn.value("load.friction")),
            known.value("load.mass_kg").zip(known.value("load.friction")),
            "{how}"
        );
        assert_eq!(drawn.parameters(), known.parameters(), "{how}");
    }
    let told = known.with_settings(&heavy).expect("valid");
    assert_ne!(told.parameters(), known.parameters(), "a setting of the file is known");
    let and_twelve =
        known.with_plant(&heavy).and_then(|rig| rig.with_settings(&settings(&["load.mass_kg=12"])));
    assert_ne!(
        and_twelve.expect("valid").parameters(),
        known.parameters(),
        "a setting after a draw is known"
    );
    let slower = known.with_plant(&settings(&["controller.period_s=0.002"])).expect("valid");
    assert_ne!(slower.parameters(), known.parameters(), "the controller knows its own settings");
}
