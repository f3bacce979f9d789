//! Own drives drawn at random: parts of the catalogue, load, friction, pressures and gains, and the models of valve and
//! friction. Nobody tuned anything to them.

use pneudrive_design::own_drive::rig_file;
use pneudrive_design::question::{Answers, question_of};
use pneudrive_sim::rig::unit_interval;
use pneudrive_sim::{Rig, keys};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Friction and valve of an own drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Sticking and Coulomb friction; the valve by its conductance.
    Dry,
    /// LuGre friction; the valve by its conductance.
    Bristles,
    /// LuGre friction, and a flow node between the lands of the valve.
    BristlesFlowNode,
}

/// The test of an own drive.
#[derive(Clone, Copy, Debug)]
pub struct Steps<'a> {
    /// When the drive steps to another place, s.
    pub at_s: &'a [f64],
    /// How long it lasts, s.
    pub duration_s: f64,
}

const CYLINDERS: [&str; 10] = [
    "iso-15552-32",
    "iso-15552-40",
    "iso-15552-50",
    "iso-15552-63",
    "iso-6432-20",
    "iso-6432-25",
    "rodless-16",
    "rodless-25",
    "rodless-32",
    "rodless-40",
];
const VALVES: [&str; 4] =
    ["proportional-5-3-100", "proportional-5-3-350", "proportional-5-3-700", "proportional-5-3-1400"];
const TUBES: [&str; 4] = ["nylon-6x4", "nylon-8x5.7", "pu-8x5", "pu-10x6.5"];

/// Conductance of a square metre of a sharp-edged port, m3/(s Pa) per m2: choked air of 20 degrees Celsius, and a
/// coefficient of discharge of 0.7.
const CONDUCTANCE_OF_AREA: f64 = 1.4e-3;

/// Random numbers of a seed.
struct Draw(ChaCha8Rng);

impl Draw {
    fn part(&mut self) -> f64 {
        unit_interval(&mut self.0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    fn by_ratio(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.part())
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.part() * all.len() as f64) as usize]
    }
}

/// The own drive of a seed. Answers that make no rig, such as a load that its supply cannot hold, are drawn again.
pub fn own_drive(seed: u64, kind: Kind, steps: Steps) -> Rig {
    (0..100)
        .find_map(|again| drawn(seed + 1_000_000 * again, kind, steps))
        .expect("most draws are valid rigs")
}

fn drawn(seed: u64, kind: Kind, steps: Steps) -> Option<Rig> {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let name = format!("own {seed} {kind:?}");
    let text = rig_file(&name, &answers(&mut draw)).ok()?;
    let as_built = Rig::read(&name, &text).ok()?;
    let mut settings = test(&as_built, steps, &mut draw);
    settings.extend(gains(&as_built, &mut draw));
    if kind != Kind::Dry {
        settings.push("load.friction=lugre".to_owned());
        settings.push(format!("load.bristle_stiffness_n_per_m={:?}", draw.by_ratio(5e4, 1e6)));
        settings.push(format!("load.stribeck_velocity_m_s={:?}", draw.by_ratio(0.005, 0.05)));
    }
    if kind == Kind::BristlesFlowNode {
        settings.extend(flow_node(&as_built));
    }
    Rig::read_with(&name, &text, &settings).ok()
}

fn answers(draw: &mut Draw) -> Answers {
    let friction = draw.by_ratio(5.0, 150.0);
    let mut given = vec![
        ("law", "gain-profile".to_owned()),
        ("cylinder", draw.one_of(&CYLINDERS).to_owned()),
        ("stroke", format!("{:.0} mm", draw.by_ratio(80.0, 600.0))),
        ("mass", format!("{:.2} kg", draw.by_ratio(1.0, 40.0))),
        ("incline", format!("{} deg", draw.one_of(&[0, 0, 0, 30, 90]))),
        ("friction", format!("{friction:.1} N")),
        ("breakaway", format!("{:.1} N", friction * draw.between(1.1, 3.5))),
        ("valve", draw.one_of(&VALVES).to_owned()),
        ("hysteresis", format!("{:.2} %", draw.between(0.1, 1.0))),
        ("overlap", format!("{:.2} %", draw.between(-2.0, 3.0))),
        ("supply", format!("{:.2} bar(g)", draw.between(4.0, 8.0))),
        ("resolution", format!("{} um", draw.one_of(&[5, 10, 20]))),
    ];
    if draw.part() < 0.5 {
        given.push(("tube", draw.one_of(&TUBES).to_owned()));
        given.push(("tube-length", format!("{:.2} m", draw.between(0.2, 1.5))));
    }
    let mut answers = Answers::default();
    for (name, text) in &given {
        answers.answer(question_of(name).expect("a question"), text);
    }
    answers
}

/// Steps from anywhere to anywhere in the inner 70 % of the stroke.
fn test(rig: &Rig, steps: Steps, draw: &mut Draw) -> Vec<String> {
    let (stroke, count) = (rig.get(&keys::actuator::STROKE_M), rig.get(&keys::encoder::MM_PER_COUNT) * 1e-3);
    let mut place = || (stroke * draw.between(0.15, 0.85) / count) as i64;
    let start = place();
    let moves: Vec<String> = [(0.0, start)]
        .into_iter()
        .chain(steps.at_s.iter().map(|at_s| (*at_s, place())))
        .map(|(at_s, counts)| format!("[{at_s:?}, {counts}]"))
        .collect();
    vec![
        format!("test.moves=[{}]", moves.join(", ")),
        format!("test.duration_s={:?}", steps.duration_s),
        format!("test.position_m={:?}", (start as f64 + 0.5) * count),
    ]
}

/// Velocity and acceleration feedback between half and twice of what the data sheets give.
fn gains(rig: &Rig, draw: &mut Draw) -> Vec<String> {
    [
        ("velocity_gain", rig.get(&keys::controller::VELOCITY_GAIN)),
        ("acceleration_gain", rig.get(&keys::controller::ACCELERATION_GAIN)),
    ]
    .map(|(key, gain)| {
        let drawn = (gain as f64 * draw.by_ratio(0.5, 2.0)).min(65_535.0);
        format!("controller.{key}={}", drawn as i64)
    })
    .into()
}

/// Ports, lands and spool of a valve that passes what the data sheet says.
fn flow_node(rig: &Rig) -> Vec<String> {
    let conductance = rig.number_at("valve.sonic_conductance_m3_per_s_pa").expect("an own drive has it");
    let port = (conductance / CONDUCTANCE_OF_AREA * 4.0 / std::f64::consts::PI).sqrt() * 1e3;
    vec![
        "valve.model=flow-node".to_owned(),
        "valve.characteristic=lands".to_owned(),
        "valve.underlap_mm=0.0063".to_owned(),
        format!("valve.port_diameter_mm={port:?}"),
        format!("valve.sleeve_diameter_mm={:?}", 3.0 * port),
        format!("valve.spool_diameter_mm={:?}", 3.0 * port - 0.015),
        format!("valve.spool_rod_diameter_mm={:?}", 2.0 * port),
    ]
}
