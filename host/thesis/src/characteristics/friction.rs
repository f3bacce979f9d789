//! Static and dynamic friction by a slow rise of the supply (7.1.3.1, Fig. 7.10 and 7.11, Tab. 7.2).
//!
//! The valve is open by a quarter to one side. The supply rises from the pressure of the surroundings until the load
//! moves. If friction does not hold the load, as on a vertical axis, it rests on the air of one chamber. The supply
//! then begins at the pressure that carries it, rises to move it up and falls to let it down, both through that
//! chamber. The friction is the force of the cylinder, less the weight of the load:
//!
//! ```text
//! F = P_1 A_1 - P_2 A_2 - P_e A_r + F_standing
//! ```
//!
//! It is the static friction at the last reading before the load moves. At the first instant of constant speed, at
//! which nothing accelerates the mass, it is Coulomb's friction with the viscous part.

use super::{Characteristic, Figure, Graph, Reading, Unfit};
use pneudrive_controller::Command;
use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::component::actuator::Actuator;
use pneudrive_sim::component::friction::FrictionModel;
use pneudrive_sim::component::load::Load;
use pneudrive_sim::component::operator;
use pneudrive_sim::keys;
use pneudrive_sim::plant::{Accuracy, Plant, Snapshot};

pub(super) const ABOUT: &str =
    "static and dynamic friction by a slow rise of the supply (7.1.3.1, Fig. 7.10, 7.11)";

/// The supply rises a little every millisecond, and is read as often until the load moves.
const PERIOD_S: f64 = 1e-3;

/// The supply reaches the rig's own pressure in this many of these steps: in 100 s.
const STEPS: u32 = 100_000;

/// Before that the load is left alone for 50 ms.
const ALONE: u32 = 50;

/// Readings in a step once the load moves.
const IN_MOTION: u32 = 10;

/// From the first motion on the test lasts 3 s at most.
const AFTER: usize = 30_000;

/// Readings from one point of a graph to the next while nothing moves, and in motion.
const THINNED: [usize; 2] = [100, 10];

/// The direction in which the load is pushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Extending,
    Retracting,
}

impl Direction {
    fn sign(self) -> f64 {
        match self {
            Direction::Extending => 1.0,
            Direction::Retracting => -1.0,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Direction::Extending => "extending",
            Direction::Retracting => "retracting",
        }
    }

    /// Of a force, N.
    fn of(force: f64) -> Direction {
        if force < 0.0 { Direction::Retracting } else { Direction::Extending }
    }

    /// Where the test begins, of the stroke: most of it lies ahead.
    fn start(self) -> f64 {
        match self {
            Direction::Extending => 0.1,
            Direction::Retracting => 0.9,
        }
    }
}

/// The readings of the gauges at one instant.
#[derive(Clone, Copy, Debug)]
struct Gauges {
    time: f64,
    supply: f64,
    pressures: [f64; 2],
    velocity: f64,
    acceleration: f64,
    /// F, positive in the direction of the push, N.
    friction: f64,
}

impl Gauges {
    /// The readings for a load that `force` (N, towards extension) pushes against its friction.
    fn new(direction: Direction, time: f64, supply: f64, force: f64, seen: &Snapshot) -> Gauges {
        let sign = direction.sign();
        Gauges {
            time,
            supply,
            pressures: seen.pressures,
            velocity: sign * seen.velocity,
            acceleration: sign * seen.acceleration,
            friction: sign * force,
        }
    }
}

/// The rise of the supply for one direction, and the first reading at which the load moves.
struct Rise {
    direction: Direction,
    /// Speed up to which the load is held, m/s.
    creep: f64,
    readings: Vec<Gauges>,
    moving: Option<usize>,
}

pub(super) fn measure(rig: &Rig) -> Result<Characteristic, Unfit> {
    let rig = rig.on_bench();
    let rises = [rise(&rig, Direction::Extending)?, rise(&rig, Direction::Retracting)?];
    if rises.iter().any(|rise| rise.moving.is_some_and(|moving| moving < ALONE as usize)) {
        return Err(Unfit::NoPart("its load moves by itself, without air"));
    }
    let viscous = rig.get(&keys::load::VISCOUS_N_S_PER_M);
    let [extending, retracting] = &rises;
    let of_both =
        |y: fn(&Gauges) -> f64| rises.iter().map(|rise| rise.series(rise.direction.name(), y)).collect();
    Ok(Characteristic {
        notes: vec![
            "The valve is open by a quarter and the supply rises slowly from the pressure of the surroundings, in open loop. Friction is the force of the cylinder less what the load weighs, its spring and its constant force: static at the last reading before the load moves, dynamic at the first instant of constant speed.".to_owned(),
        ],
        across: "time, s",
        graphs: vec![
            Graph { title: "pressures, extending, kPa", series: extending.pressures() },
            Graph { title: "pressures, retracting, kPa", series: retracting.pressures() },
            Graph { title: "force against the friction, N", series: of_both(|reading| reading.friction) },
            Graph { title: "speed, mm/s", series: of_both(|reading| 1e3 * reading.velocity) },
        ],
        figures: rises.iter().flat_map(|rise| rise.figures(viscous)).collect(),
        ..Characteristic::default()
    })
}

/// How a load is moved: its support before, and the chamber.
struct Push {
    /// Where it begins, m.
    position: f64,
    /// The chambers' pressures before, Pa.
    pressures: [f64; 2],
    /// The supply before, and after all steps, Pa.
    supply: [f64; 2],
    /// The direction in which the valve alone would move it.
    valve: Direction,
}

impl Push {
    /// The one that moves the load of a rig in one direction.
    fn new(rig: &Rig, direction: Direction) -> Result<Push, Unfit> {
        let [exhaust, full] =
            [&keys::exhaust::PRESSURE_PA, &keys::supply::PRESSURE_PA].map(|key| rig.get(key));
        let position = direction.start() * rig.get(&keys::actuator::STROKE_M);
        let load = Load::of(rig);
        let standing = load.standing_force(position);
        let held =
            [&keys::friction::STATIC_RETRACT_N, &keys::friction::STATIC_EXTEND_N].map(|key| rig.get(key));
        if (-held[0]..=held[1]).contains(&standing) {
            return Ok(Push { position, pressures: [exhaust; 2], supply: [exhaust, full], valve: direction });
        }
        let actuator = Actuator::of(rig);
        let carries = Direction::of(-standing);
        let (chamber, area) = match carries {
            Direction::Extending => (0, actuator.area_1),
            Direction::Retracting => (1, actuator.area_2),
        };
        let carrying = exhaust + standing.abs() / area;
        if carrying >= full {
            return Err(Unfit::NoPart("the supply cannot hold its load"));
        }
        let mut pressures = [exhaust; 2];
        pressures[chamber] = carrying;
        let last = if direction == carries { full } else { exhaust };
        Ok(Push { position, pressures, supply: [carrying, last], valve: carries })
    }

    /// The supply at reading `k`, Pa: as fast for every load, and not beyond its last pressure.
    fn supply(&self, k: u32, range: f64) -> f64 {
        let [first, last] = self.supply;
        let moved = range * f64::from(k.saturating_sub(ALONE)) / f64::from(STEPS);
        first + (last - first).signum() * moved.min((last - first).abs())
    }
}

/// Pushes the load of a rig in one direction.
fn rise(rig: &Rig, direction: Direction) -> Result<Rise, Unfit> {
    let push = Push::new(rig, direction)?;
    let range = rig.get(&keys::supply::PRESSURE_PA) - rig.get(&keys::exhaust::PRESSURE_PA);
    let stroke = rig.get(&keys::actuator::STROKE_M);
    let start = [
        (keys::test::POSITION_M.path, push.position),
        (keys::test::PRESSURE_1_PA.path, push.pressures[0]),
        (keys::test::PRESSURE_2_PA.path, push.pressures[1]),
    ];
    let rig = rig.with_numbers(&start).expect("pressures between surroundings and supply, within the stroke");
    let mut plant = Plant::new(&rig, Accuracy::default(), 0).with_timing((1e6 * PERIOD_S) as u64, 1);
    let load = Load::of(&rig);
    let mut rise = Rise { direction, creep: load.friction.creep(), readings: Vec::new(), moving: None };
    for k in 0..ALONE + STEPS {
        let supply = push.supply(k, range);
        plant.set_supply_pressure(supply);
        plant.command(quarter(&rig, push.valve, k));
        let looks = if rise.moving.is_some() { IN_MOTION } else { 1 };
        for look in 0..looks {
            let time = (f64::from(k) + f64::from(look) / f64::from(looks)) * PERIOD_S;
            let seen = plant.look(time)?;
            // A stop pushes as well.
            if !(0.0..=stroke).contains(&seen.position) {
                return Ok(rise);
            }
            let force = seen.actuator_force + load.standing_force(seen.position);
            rise.readings.push(Gauges::new(direction, time, supply, force, &seen));
            if rise.is_over() {
                return Ok(rise);
            }
        }
        plant.next_sample()?;
    }
    Ok(rise)
}

/// The command that opens the valve by a quarter, at reading `k`. A stepper walks there step by step.
fn quarter(rig: &Rig, direction: Direction, k: u32) -> Command {
    let sign = direction.sign() as i8;
    if rig.get(&keys::operator::MODEL) == operator::OperatorKind::Stepper {
        let steps = (rig.get(&keys::stepper::MAX_STEPS) / 4).max(1);
        let creeps = i64::from(k) < steps;
        return Command { counts: 0, step: if creeps { sign } else { 0 }, drive_enable: true };
    }
    Command { counts: 512 * i16::from(sign), step: 0, drive_enable: true }
}

impl Rise {
    /// Records the first motion; returns whether the time after it is over.
    fn is_over(&mut self) -> bool {
        let last = self.readings.len() - 1;
        if self.moving.is_none() && self.readings[last].velocity.abs() > self.creep {
            self.moving = Some(last);
        }
        self.moving.is_some_and(|moving| last > moving + AFTER)
    }

    /// The static friction, to within the rise of the force from reading to reading.
    fn static_friction(&self) -> Reading {
        let Some(moving) = self.moving.filter(|moving| *moving > 0) else {
            return Reading::NotBetween([0.0, f64::from(ALONE + STEPS) * PERIOD_S]);
        };
        let before = &self.readings[moving.saturating_sub(50)..moving];
        let steps = before.windows(2).map(|pair| (pair[1].friction - pair[0].friction).abs());
        Reading::Read { value: self.readings[moving - 1].friction, within: steps.fold(1e-6, f64::max) }
    }

    /// Friction and speed where the mass is accelerated no longer, each to within its change from reading to reading.
    fn at_constant_speed(&self) -> [Reading; 2] {
        let moving = self.moving.unwrap_or(self.readings.len());
        let slows = |pair: &&[Gauges]| pair[0].acceleration > 0.0 && pair[1].acceleration <= 0.0;
        let found = self.readings[moving.min(self.readings.len())..].windows(2).find(slows);
        let Some([one, two]) = found else {
            let from = self.readings.get(moving).map_or(0.0, |reading| reading.time);
            return [Reading::NotBetween([from, self.readings[self.readings.len() - 1].time]); 2];
        };
        let part = one.acceleration / (one.acceleration - two.acceleration);
        let read = |of: fn(&Gauges) -> f64| Reading::Read {
            value: of(one) + part * (of(two) - of(one)),
            within: (of(two) - of(one)).abs().max(1e-6),
        };
        [read(|reading| reading.friction), read(|reading| reading.velocity)]
    }

    fn figures(&self, viscous: f64) -> Vec<Figure> {
        let named = |what: &str, reading, unit| Figure {
            name: format!("{what}, {}", self.direction.name()),
            reading,
            unit,
        };
        let [dynamic, speed] = self.at_constant_speed();
        let dry = match (dynamic, speed) {
            (Reading::Read { value, within }, Reading::Read { value: speed, within: of_speed }) => {
                Reading::Read { value: value - viscous * speed, within: within + viscous * of_speed }
            }
            _ => dynamic,
        };
        vec![
            named("static friction", self.static_friction(), "N"),
            named("dynamic friction at constant speed", dynamic, "N"),
            named("that speed", in_mm(speed), "mm/s"),
            named("dynamic friction less the viscous part", dry, "N"),
        ]
    }

    fn pressures(&self) -> Vec<Curve> {
        vec![
            self.series("supply", |reading| 1e-3 * reading.supply),
            self.series("P1", |reading| 1e-3 * reading.pressures[0]),
            self.series("P2", |reading| 1e-3 * reading.pressures[1]),
        ]
    }

    /// A part of the readings, more of the motion than of what was before it.
    fn series(&self, name: &str, y: fn(&Gauges) -> f64) -> Curve {
        let near = self.moving.unwrap_or(self.readings.len()).saturating_sub(THINNED[0]);
        let every = |k: usize| if k < near { THINNED[0] } else { THINNED[1] };
        let shown = self.readings.iter().enumerate().filter(|(k, _)| k % every(*k) == 0);
        let (x, y) = shown.map(|(_, reading)| (reading.time, y(reading))).unzip();
        Curve::new(name, x, y)
    }
}

fn in_mm(reading: Reading) -> Reading {
    match reading {
        Reading::Read { value, within } => Reading::Read { value: 1e3 * value, within: 1e3 * within },
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::servo_b as rig;
    use super::*;

    fn figure<'a>(found: &'a Characteristic, name: &str) -> &'a Figure {
        found.figures.iter().find(|figure| figure.name == name).expect(name)
    }

    fn assert_reads(found: &Characteristic, name: &str, expected: f64) {
        let Reading::Read { value, within } = figure(found, name).reading else { panic!("{name}: not read") };
        assert!((value - expected).abs() <= within, "{name}: {value} +- {within}, not {expected}");
        assert!(within < 0.02 * expected.abs(), "{name}: {value} is known to {within} only");
    }

    /// C(46) to C(49): the test finds the friction of the load, whatever the load weighs.
    #[test]
    fn the_slow_rise_finds_the_frictions_of_the_load() {
        for others in
            [&[][..], &["load.incline_deg=30"], &["load.constant_force_n=-12", "load.spring_n_per_m=40"]]
        {
            let found = measure(&rig(others)).expect("a load");
            for (direction, [stiction, coulomb]) in
                [("extending", [70.0, 40.0]), ("retracting", [40.0, 11.0])]
            {
                assert_reads(&found, &format!("static friction, {direction}"), stiction);
                assert_reads(
                    &found,
                    &format!("dynamic friction less the viscous part, {direction}"),
                    coulomb,
                );
            }
        }
    }

    /// A drive that is still gaining speed at its stop has no constant speed.
    #[test]
    fn no_built_in_rig_is_read_wrong() {
        for (name, _) in pneudrive_sim::rigfile::BUILTIN {
            let rig = Rig::builtin(name).expect("a built-in rig");
            let found = measure(&rig).expect("a load");
            for (direction, key) in [("extending", "extend"), ("retracting", "retract")] {
                let friction = |kind: &str| rig.number_at(&format!("load.{kind}_{key}_n")).expect("a number");
                assert_reads(&found, &format!("static friction, {direction}"), friction("static"));
                let dry = format!("dynamic friction less the viscous part, {direction}");
                if figure(&found, &dry).value().is_some() {
                    assert_reads(&found, &dry, friction("coulomb"));
                } else {
                    assert_eq!(*name, "burrows", "{dry}");
                }
            }
        }
    }

    /// The thesis takes the whole force at constant speed for Coulomb friction (7.1.3.1).
    #[test]
    fn the_force_at_constant_speed_holds_the_viscous_friction() {
        let found = measure(&rig(&["load.viscous_n_s_per_m=80"])).expect("a load");
        for direction in ["extending", "retracting"] {
            let value = |name: &str| figure(&found, &format!("{name}, {direction}")).value().expect("read");
            let viscous = 80.0 * 1e-3 * value("that speed");
            let whole = value("dynamic friction at constant speed");
            assert!(viscous > 0.5, "{direction}: it moves, with {viscous} N");
            assert!(
                (whole - viscous - value("dynamic friction less the viscous part")).abs() < 1e-9,
                "{direction}"
            );
        }
    }

    /// Bristles creep before they let go, the earlier the sooner friction falls with the speed.
    #[test]
    fn a_load_on_bristles_is_held_until_it_slides() {
        let bristles = ["load.friction=lugre", "load.film_growth_s=100", "load.stribeck_exponent=2"];
        let found = measure(&rig(&bristles)).expect("a load");
        for (direction, stiction) in [("extending", 70.0), ("retracting", 40.0)] {
            let read = figure(&found, &format!("static friction, {direction}")).value().expect("it slides");
            assert!((1.0 - 0.05..1.0).contains(&(read / stiction)), "{direction}: {read} N");
        }
    }

    #[test]
    fn a_load_that_the_supply_cannot_move_has_no_friction_to_read() {
        let held = ["load.static_extend_n=2000", "load.static_retract_n=2000"];
        let found = measure(&rig(&held)).expect("a load");
        for figure in &found.figures {
            assert!(matches!(figure.reading, Reading::NotBetween(_)), "{figure:?}");
        }
    }

    /// A drive by its data sheets, with these additions.
    fn own(settings: &[&str]) -> Rig {
        let by_conductance = [
            "valve.model=iso-6358",
            "valve.characteristic=linear",
            "valve.sonic_conductance_m3_per_s_pa=1.4e-8",
            "valve.critical_ratio=0.3",
            "valve.leakage_percent=1",
            "valve.underlap_mm=0.025",
            "operator.model=solenoid-empirical",
            "operator.dither_mm=0",
            "tubing.model=none",
            "load.static_extend_n=60",
            "load.static_retract_n=50",
            "load.coulomb_extend_n=30",
            "load.coulomb_retract_n=25",
        ];
        rig(&[&by_conductance[..], settings].concat())
    }

    /// Level, inclined either way and vertical, held by its friction or by air, pushed or pulled.
    #[test]
    fn the_frictions_of_a_drive_by_data_sheets_are_found_at_every_incline() {
        for others in [
            &[][..],
            &["load.incline_deg=30", "load.mass_kg=8"],
            &["load.incline_deg=-30", "load.mass_kg=20"],
            &["load.incline_deg=90", "load.mass_kg=4"],
            &["load.incline_deg=90", "load.mass_kg=8.4"],
            &["load.incline_deg=-90", "load.mass_kg=30"],
            &["load.incline_deg=90", "load.mass_kg=30", "load.constant_force_n=-50"],
        ] {
            let found = measure(&own(others)).unwrap_or_else(|unfit| panic!("{others:?}: {unfit}"));
            for (direction, [stiction, coulomb]) in
                [("extending", [60.0, 30.0]), ("retracting", [50.0, 25.0])]
            {
                assert_reads(&found, &format!("static friction, {direction}"), stiction);
                let dry = format!("dynamic friction less the viscous part, {direction}");
                if figure(&found, &dry).value().is_some() {
                    assert_reads(&found, &dry, coulomb);
                }
            }
        }
    }

    #[test]
    fn a_load_that_the_supply_cannot_hold_is_said_to_be() {
        let heavy = own(&["load.incline_deg=90", "load.mass_kg=400", "test.pressure_1_pa=300e3"]);
        assert_eq!(measure(&heavy), Err(Unfit::NoPart("the supply cannot hold its load")));
    }
}
