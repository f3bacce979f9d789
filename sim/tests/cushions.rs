//! End cushions (`actuator.cushion`) against closed forms: the speed at which a load meets its stop, the speed that a throttle lets it have,
//! mass and energy, and the way back.
//!
//! ```text
//! shut off, adiabatic   P V^n = P_0 V_0^n,   W(V) = (P V - P_0 V_0)/(n - 1): the work on the air
//! M v^2/2             = -W_1 - W_2 - W_p - P_e A_R (y - y_0)          all ports shut; no friction
//! throttle, choked    v = C rho_0 R sqrt(T_0 T)/(A - A_s)              where pressure and temperature stay
//! ```

mod in_a_drive;

use std::f64::consts::PI;

use pneudrive_sim::trace::{Extra, Row};
use pneudrive_sim::{Accuracy, Method, Recording, Rig, run_recorded};

use crate::settings::NO_FRICTION;

const N: f64 = 1.4;
const R: f64 = 286.76;
const OUTSIDE: f64 = 101_300.0;
const MASS: f64 = 1.6;
const STROKE: f64 = 0.3;
const BORE: f64 = PI / 4.0 * 0.05 * 0.05;
const ROD: f64 = PI / 4.0 * 0.025 * 0.025;
const SPEAR: f64 = PI / 4.0 * 0.03 * 0.03;
const DEAD: f64 = 2e-5;
/// C rho_0 sqrt(T_0) of 1 nm^3/(s Pa), kg sqrt(K)/(s Pa), over sqrt(T_0).
const CHOKED: f64 = 1e-9 * 1.185;

const CUSHION: &str = "actuator.cushion=\"adjustable\"";
const WITH_SPEAR: &str = "actuator.cushion_spear_diameter_m=0.03";
const LONG: [&str; 2] = ["actuator.cushion_1_length_m=0.14", "actuator.cushion_2_length_m=0.14"];
const SEALED: [&str; 3] = [
    "actuator.cushion_1_conductance_m3_per_s_pa=0",
    "actuator.cushion_2_conductance_m3_per_s_pa=0",
    "actuator.cushion_check_conductance_m3_per_s_pa=0",
];
/// A valve that is shut by an overlap without clearance.
const SHUT: [&str; 6] = [
    "controller.loop=open",
    "test.moves=[[0.0, 0]]",
    "operator.dither_mm=0",
    "valve.spool_diameter_mm=10",
    "valve.underlap_mm=0.5",
    "valve.null_offset_mm=0",
];
/// A wide valve by its conductance right at the cylinder.
const OPEN: [&str; 7] = [
    "valve.model=iso-6358",
    "valve.characteristic=linear",
    "valve.sonic_conductance_m3_per_s_pa=2e-8",
    "valve.critical_ratio=0.3",
    "tubing.model=none",
    "controller.loop=open",
    "operator.dither_mm=0",
];

fn rig(parts: &[&[&str]]) -> Rig {
    let settings: Vec<String> = parts.concat().iter().map(ToString::to_string).collect();
    Rig::read_with("cushioned", "", &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn refusal(settings: &[&str]) -> String {
    let lines: Vec<String> = settings.iter().map(|one| one.replace('=', " = ")).collect();
    Rig::read(
        "cushioned",
        &lines.join(
            "
",
        ),
    )
    .expect_err("refused")
    .to_string()
}

fn rows_at(rig: &Rig, tolerance: f64) -> Vec<Row> {
    let accuracy = Accuracy { method: Method::DormandPrince, tolerance };
    run_recorded(rig, accuracy, Recording { valve: true }, |_, _| {}).expect("a transient").rows
}

fn rows(parts: &[&[&str]]) -> Vec<Row> {
    rows_at(&rig(parts), 1e-11)
}

fn port_pressure(row: &Row, end: usize) -> f64 {
    Extra::named(["port_pressure_1_pa", "port_pressure_2_pa"][end]).expect("a column").value(row)
}

/// The air of servo-drive B with its ports shut.
struct Shut {
    start: f64,
    pressures: [f64; 2],
    length: f64,
    spear: f64,
}

impl Shut {
    /// A_1 and A_2, and the area of the spear of an end.
    const AREAS: [f64; 2] = [BORE, BORE - ROD];

    fn spear_area(&self, end: usize) -> f64 {
        (self.spear - [0.0, ROD][end]).max(0.0)
    }

    fn distance(end: usize, y: f64) -> f64 {
        if end == 0 { y } else { STROKE - y }
    }

    /// The volumes of chamber and pocket; without a spear in, of the whole as chamber.
    fn volumes(&self, end: usize, y: f64) -> [f64; 2] {
        let s = Shut::distance(end, y);
        if s >= self.length {
            return [Shut::AREAS[end] * s + DEAD, 0.0];
        }
        let spear = self.spear_area(end);
        [(Shut::AREAS[end] - spear) * s + 0.2 * DEAD, spear * s + 0.8 * DEAD]
    }

    /// P at the place where the spear goes in, or at the start.
    fn divided(&self, end: usize) -> f64 {
        let whole = |s: f64| Shut::AREAS[end] * s + DEAD;
        self.pressures[end] * (whole(Shut::distance(end, self.start)) / whole(self.length)).powf(N)
    }

    /// P of chamber and pocket.
    fn pressures_at(&self, end: usize, y: f64) -> [f64; 2] {
        let [volume, pocket] = self.volumes(end, y);
        let from = |pressure: f64, before: f64, now: f64| pressure * (before / now).powf(N);
        if pocket == 0.0 {
            let own = from(self.pressures[end], self.volumes(end, self.start)[0], volume);
            return [own, own];
        }
        let spear = self.spear_area(end);
        let before =
            [(Shut::AREAS[end] - spear) * self.length + 0.2 * DEAD, spear * self.length + 0.8 * DEAD];
        let now = [volume, pocket];
        [0, 1].map(|i| from(self.divided(end), before[i], now[i]))
    }

    /// Internal energy of all air, J.
    fn internal(&self, y: f64) -> f64 {
        let of = |end: usize| {
            let ([p, before], [v, pocket]) = (self.pressures_at(end, y), self.volumes(end, y));
            (p * v + before * pocket) / (N - 1.0)
        };
        of(0) + of(1)
    }

    /// v^2 at a position.
    fn speed_squared(&self, y: f64) -> f64 {
        let work = self.internal(self.start) - self.internal(y) - OUTSIDE * ROD * (y - self.start);
        2.0 * work / MASS
    }
}

/// A load that expanding air drives into a sealed cushion. Its air takes the kinetic energy up, or the load meets the stop at a speed.
#[test]
fn a_load_enters_a_sealed_cushion_and_meets_its_stop_at_the_speed_of_the_closed_form() {
    let driven = [
        ["0.12", "600e3", "50e3"],
        ["0.12", "600e3", "20e3"],
        ["0.18", "60e3", "700e3"],
        ["0.18", "15e3", "700e3"],
    ];
    let mut met = Vec::new();
    for spear in [0.0, 0.03] {
        for [start, one, two] in driven {
            let air = Shut {
                start: start.parse().expect("m"),
                pressures: [one, two].map(|p| p.parse().expect("Pa")),
                length: 0.1,
                spear: PI / 4.0 * spear * spear,
            };
            let given = [
                format!("test.position_m={start}"),
                format!("test.pressure_1_pa={one}"),
                format!("test.pressure_2_pa={two}"),
                format!("actuator.cushion_spear_diameter_m={spear}"),
            ];
            let given: Vec<&str> = given.iter().map(String::as_str).collect();
            let lengths = ["actuator.cushion_1_length_m=0.1", "actuator.cushion_2_length_m=0.1"];
            let short = [
                "test.duration_s=0.4",
                "load.stop_stiffness_n_per_m=1e7",
                "test.trace_period_s=5e-4",
                CUSHION,
            ];
            let rows = rows(&[&SHUT, &NO_FRICTION, &SEALED, &lengths, &short, &given]);
            // Until a stop is met.
            let free = rows.iter().take_while(|row| (0.0..=STROKE).contains(&row.plant.position));
            let (mut in_cushion, mut all) = (0, 0);
            for row in free {
                let (y, v) = (row.plant.position, row.plant.velocity);
                let expected = air.speed_squared(y);
                assert!((v * v - expected).abs() < 2e-7, "{start} {spear} at {y}: {v} m/s, v^2 {expected}");
                for end in 0..2 {
                    let [own, pocket] = air.pressures_at(end, y);
                    assert!((row.plant.pressures[end] / own - 1.0).abs() < 1e-7, "{end} at {y}");
                    assert!((port_pressure(row, end) / pocket - 1.0).abs() < 1e-7, "{end} at {y}: {pocket}");
                }
                in_cushion += usize::from(y < air.length || STROKE - y < air.length);
                all += 1;
            }
            assert!(in_cushion > 10 && all > 40, "{start} {spear}: {in_cushion} of {all}");
            met.push(all < rows.len());
        }
    }
    assert!(met.contains(&true) && met.contains(&false), "some are stopped, some meet their stop: {met:?}");
}

/// Full supply on one side, the surroundings on the other, through a valve that is no resistance; the throttle is shut. Between the
/// place where the spear goes in and the stop, with P_1 = P_s and P_p = P_e:
/// M (v^2 - v_l^2)/2 = (P_s A_1 - P_e (A_R + A_s)) l - W(l),  W the work of the air behind the spear from P_e on.
#[test]
fn a_bang_bang_drive_meets_its_stop_at_the_closed_form_of_the_impact_speed() {
    let wide = [
        "valve.sonic_conductance_m3_per_s_pa=1e-6",
        "test.moves=[[0.0, 2048]]",
        "load.mass_kg=20",
        "load.stop_stiffness_n_per_m=1e7",
    ];
    let rest = [
        "test.position_m=0.24",
        "supply.pressure_pa=300e3",
        "test.pressure_1_pa=300e3",
        "test.pressure_2_pa=102e3",
        "test.duration_s=0.25",
        "test.trace_period_s=1e-4",
    ];
    let length = 0.03;
    for (spear, more) in [(0.0, vec![]), (SPEAR - ROD, vec![WITH_SPEAR])] {
        let short = ["actuator.cushion_2_length_m=0.03", CUSHION];
        let rig = rig(&[&OPEN, &wide, &NO_FRICTION, &SEALED, &rest, &short, &more]);
        let rows = rows_at(&rig, 1e-9);
        let supply = rig.get(&pneudrive_sim::keys::supply::PRESSURE_PA);
        let at = |y: f64| {
            let i = rows.iter().position(|row| row.plant.position >= y).expect("it comes there");
            let [a, b] = [i - 1, i].map(|i| rows[i].plant);
            let part = (y - a.position) / (b.position - a.position);
            (a.velocity + part * (b.velocity - a.velocity), a.pressures)
        };
        let (enters, _) = at(STROKE - length);
        let (meets, _) = at(STROKE);
        let annulus = BORE - ROD - spear;
        let [before, after] = [annulus * length + 0.2 * DEAD, 0.2 * DEAD];
        let work = OUTSIDE * before * ((before / after).powf(N - 1.0) - 1.0) / (N - 1.0);
        let gained = (supply * BORE - OUTSIDE * (ROD + spear)) * length - work;
        let expected = (enters * enters + 2.0 * gained / 20.0).sqrt();
        println!("spear {spear}: enters at {enters}, meets at {meets}, expected {expected} m/s");
        assert!((meets / expected - 1.0).abs() < 2e-3, "{meets} m/s, not {expected}");
        assert!(meets < 0.97 * enters, "it is braked: {enters} to {meets}");
    }
}

/// v = C rho_0 R sqrt(T_0 T)/(A - A_s), whatever pressure drives the piston.
#[test]
fn a_choked_throttle_sets_the_speed_in_the_cushion() {
    for (end, begin, start) in
        [(1, "test.moves=[[0.0, 2000]]", "0.1"), (0, "test.moves=[[0.0, -2000]]", "0.2")]
    {
        for (spear, more) in [(0.0, vec![]), (SPEAR - [0.0, ROD][end], vec![WITH_SPEAR])] {
            let position = format!("test.position_m={start}");
            let rows = rows(&[&OPEN, &LONG, &more, &[CUSHION, begin, &position, "test.duration_s=1.2"]]);
            let mut seen = 0;
            for row in rows.iter().filter(|row| row.time > 0.6) {
                let plant = &row.plant;
                let s = Shut::distance(end, plant.position);
                if !(0.01..0.13).contains(&s) {
                    continue;
                }
                assert!(port_pressure(row, end) < 0.3 * plant.pressures[end], "choked");
                let annulus = Shut::AREAS[end] - spear;
                let expected = CHOKED * R * (293.15 * plant.temperatures[end]).sqrt() / annulus;
                assert!(
                    (plant.velocity.abs() / expected - 1.0).abs() < 0.03,
                    "{end} {spear} {} s: {} m/s, not {expected}",
                    row.time,
                    plant.velocity
                );
                seen += 1;
            }
            assert!(seen > 100, "{end} {spear}: {seen}");
        }
    }
}

/// The load swings into both cushions and out of them, with all ports of the valve shut. What is behind a spear and in its pocket keeps
/// mass and, with the load, energy: but for what is equalised as a spear comes out, which does no work and is conserved as well.
#[test]
fn a_load_that_swings_through_throttled_cushions_keeps_mass_and_energy() {
    let air = ["test.pressure_1_pa=600e3", "test.pressure_2_pa=60e3", "test.position_m=0.12"];
    let more = [
        "test.duration_s=0.8",
        "test.trace_period_s=2e-4",
        CUSHION,
        WITH_SPEAR,
        "actuator.cushion_1_length_m=0.1",
        "actuator.cushion_2_length_m=0.1",
    ];
    let rows = rows(&[&SHUT, &NO_FRICTION, &air, &more]);
    let shut = Shut { start: 0.12, pressures: [600e3, 60e3], length: 0.1, spear: SPEAR };
    let mut free_masses = Vec::new();
    let mut energies = Vec::new();
    let mut lost = 0.0_f64;
    for row in &rows {
        let (y, v) = (row.plant.position, row.plant.velocity);
        assert!((0.0..=STROKE).contains(&y), "no stop is met: {y}");
        let of = |end: usize| {
            let [own, pocket] = shut.volumes(end, y);
            (row.plant.pressures[end] * own + port_pressure(row, end) * pocket) / (N - 1.0)
        };
        energies.push(of(0) + of(1) + 0.5 * MASS * v * v + OUTSIDE * ROD * y);
        for end in 0..2 {
            lost = lost.max(row.plant.mass_flows[end].abs());
        }
        if (0.1..=0.2).contains(&y) {
            free_masses.push([0, 1].map(|end| {
                row.plant.pressures[end] * shut.volumes(end, y)[0] / (R * row.plant.temperatures[end])
            }));
        }
    }
    let apart = (rows.iter()).map(|row| row.plant.pressures[1] - port_pressure(row, 1)).fold(0.0, f64::max);
    assert!(apart > 5e4, "the cushion is at work: {apart} Pa");
    let back = rows.iter().skip_while(|row| row.plant.position < 0.2).filter(|row| row.plant.position < 0.2);
    assert!(back.count() > 50, "and the load comes out of it");
    let (low, high) = energies.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), e| (l.min(*e), h.max(*e)));
    assert!((high - low) / high < 1e-8, "{low} to {high} J");
    assert!(lost < 1e-12, "{lost} kg/s");
    for end in 0..2 {
        let first = free_masses[0][end];
        assert!(free_masses.iter().all(|both| (both[end] / first - 1.0).abs() < 1e-9), "mass {end}");
    }
}

/// The check valve lets air in. Without it a throttle that is nearly shut holds the piston back.
#[test]
fn a_piston_leaves_its_cushion_as_fast_as_without_one() {
    let start = [
        "test.position_m=0.0005",
        "test.moves=[[0.0, 2000]]",
        "test.duration_s=0.5",
        "test.pressure_1_pa=102e3",
        "test.pressure_2_pa=102e3",
    ];
    let until = |parts: &[&str]| {
        let rows = rows(&[&OPEN, &start, parts]);
        rows.iter().find(|row| row.plant.position > 0.04).map_or(f64::INFINITY, |row| row.time)
    };
    let narrow = "actuator.cushion_1_conductance_m3_per_s_pa=1e-11";
    let without = until(&[]);
    let with = until(&[CUSHION, narrow, "actuator.cushion_check_conductance_m3_per_s_pa=5e-8"]);
    let held = until(&[CUSHION, narrow, "actuator.cushion_check_conductance_m3_per_s_pa=0"]);
    println!("{without} {with} {held} s");
    assert!(with < 1.15 * without && held > 3.0 * without, "{without} {with} {held} s");
}

#[test]
fn both_ends_are_mirror_images_of_each_other() {
    let alike = [
        "actuator.model=symmetric",
        "load.static_extend_n=40",
        "load.static_retract_n=40",
        "load.coulomb_extend_n=20",
        "load.coulomb_retract_n=20",
        "valve.null_offset_mm=0",
        "test.pressure_1_pa=300e3",
        "test.pressure_2_pa=300e3",
        "test.duration_s=0.6",
        CUSHION,
        WITH_SPEAR,
    ];
    let of = |start: &str, counts: i32| {
        let more = [format!("test.position_m={start}"), format!("test.moves=[[0.0, {counts}]]")];
        let more: Vec<&str> = more.iter().map(String::as_str).collect();
        rows(&[&OPEN, &alike, &more])
    };
    let (out, back) = (of("0.1", 1800), of("0.2", -1800));
    let last = out.last().expect("rows").plant.position;
    assert!(last > 0.299, "{last}");
    for (one, other) in out.iter().zip(&back) {
        let (one, other) = (&one.plant, &other.plant);
        assert!((one.position + other.position - STROKE).abs() < 1e-8, "{} {}", one.position, other.position);
        assert!((one.pressures[1] / other.pressures[0] - 1.0).abs() < 1e-6);
    }
}

#[test]
fn an_open_loop_converges_with_the_tolerance() {
    let tubes = [&OPEN[5..], &["valve.model=flow-node"]].concat();
    for (valve, more) in [
        (&OPEN[..], &[][..]),
        (&OPEN[..], &["tubing.flow_control=meter-out", WITH_SPEAR]),
        (&OPEN[..], &["actuator.vented=chamber-2", "actuator.return_spring=retract"]),
        (&OPEN[..], &["supply.model=receiver", "sensors.pressure_lag_s=2e-3", WITH_SPEAR]),
        (&OPEN[..], &["load.friction=lugre", "supply.model=receiver"]),
        (&tubes, &[WITH_SPEAR]),
        (&tubes, &["tubing.lag_s=2e-3"]),
        (&tubes, &["tubing.model=analytical"]),
    ] {
        let open = [
            "test.moves=[[0.0, 900], [0.3, -1200], [0.6, 1000], [0.75, 0]]",
            "test.position_m=0.2",
            "test.duration_s=0.8",
            CUSHION,
        ];
        let rig = rig(&[valve, &open, more]);
        let exact = rows_at(&rig, 1e-12);
        let deepest = exact.iter().map(|row| row.plant.position).fold(0.0, f64::max);
        assert!(deepest > 0.285, "{more:?}: {deepest} m");
        let errors = [1e-6, 1e-8, 1e-10].map(|tolerance| {
            let rows = rows_at(&rig, tolerance);
            let apart = rows.iter().zip(&exact).map(|(a, b)| (a.plant.position - b.plant.position).abs());
            apart.fold(0.0, f64::max)
        });
        println!("{more:?}: {errors:?} m");
        assert!(errors[0] < 1e-5 && errors[1] < 1e-6 && errors[2] < 2e-8, "{more:?}: {errors:?}");
    }
}

/// The pocket's states take places that the drive does not need otherwise. Where they are changes nothing.
#[test]
fn the_places_of_the_pockets_states_change_nothing() {
    let open = [
        "test.moves=[[0.0, 1500]]",
        "test.position_m=0.2",
        "test.duration_s=0.4",
        CUSHION,
        WITH_SPEAR,
        "supply.model=receiver",
    ];
    let [sharp, lagged] = [&[][..], &["sensors.pressure_lag_s=2e-3"]].map(|more| rows(&[&OPEN, &open, more]));
    for (one, other) in sharp.iter().zip(&lagged) {
        assert!((one.plant.position - other.plant.position).abs() < 1e-9, "{} s", one.time);
    }
    assert!(sharp.last().expect("rows").plant.position > 0.29);
}
