//! What records tell without a model of the air: the simpler tests of thesis 7.1.
//!
//! ```text
//! F = P_1 A_1 - P_2 A_2 - P_e A_R2 + F_const - k y     measured force on the load but its weight (6.25, 6.31)
//! F = M (a + g sin(incline)) + K_C v + F_c,ext [v > 0] - F_c,ret [v < 0]  least squares while it slips
//! F - M g sin(incline) at the last sample before it moves   stiction, unless it yields (7.1.3.1)
//! ```
//!
//! The incline is that of the rig file. The weight goes with the mass that the balance has found, or with that of the file where
//! no record shows it; its error is part of the error of the stiction.
//!
//! Speed and acceleration are differences of positions over `HALF_WIDTH` samples to either side, the force a mean over
//! the same ones. The hysteresis is how far apart the spool stands at the same command on the way up and on the way
//! down, as in 7.1.2.1.
//!
//! Friction that is elastic before it slips yields long before the force reaches the stiction: the load then moves slowly while
//! the force goes on rising. Such a record does not show the stiction.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};
use pneudrive_sim::Rig;
use pneudrive_sim::component::actuator::{Actuator, cushion};
use pneudrive_sim::component::load::{self, Load};
use pneudrive_sim::keys;

use super::recording::Recording;
use pneudrive_report::Table;

/// Samples to either side of which a difference is formed.
const HALF_WIDTH: usize = 6;

/// Speed from which the load is taken to slip, m/s.
const SLIPS: f64 = 0.02;

/// Samples at rest before a breakaway counts.
const REST: usize = 16;

/// Fewest commands that the spool has passed in both directions.
const FEWEST_COMMANDS: usize = 5;

/// Counts by which a drive that moves has left its place.
const MOVED: f64 = 2.0;

/// A load yields if the force rises by more than this part after it has begun to move and before it slips.
const YIELDS: f64 = 0.2;

/// A value with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// The value, in the unit of its field.
    pub value: f64,
    /// Its standard error, in the same unit.
    pub error: f64,
}

/// The figures; None where the records do not show one. Arrays hold extension, then retraction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Stiction, N.
    pub stiction: [Option<Figure>; 2],
    /// Whether every breakaway of the direction was of a load that yielded first.
    pub yields: [bool; 2],
    /// Coulomb friction, N.
    pub coulomb: [Option<Figure>; 2],
    /// Viscous friction, N s/m.
    pub viscous: Option<Figure>,
    /// Moving mass, kg.
    pub mass: Option<Figure>,
    /// Top speed, m/s.
    pub top_speed: [Option<f64>; 2],
    /// Top acceleration, m/s^2.
    pub top_acceleration: [Option<f64>; 2],
    /// Width of the spool's loop, mm.
    pub hysteresis_mm: Option<f64>,
}

/// A load that moves.
struct Instant {
    speed: f64,
    acceleration: f64,
    /// All forces but weight and friction, N.
    force: f64,
}

/// The forces on a load but its friction, from what the gauges show.
struct Forces {
    actuator: Actuator,
    load: Load,
    /// Positions in front of the cushions, m.
    known: RangeInclusive<f64>,
}

impl Figures {
    /// As a table, beside the keys of the rig file that they belong to.
    #[must_use]
    pub fn table(&self, rig: &Rig) -> Table {
        let [extend, retract] = ["extend", "retract"];
        let mut rows = Vec::new();
        let mut row = |name: &str, unit: &str, figure: Option<Figure>, key: Option<&str>| {
            let Some(Figure { value, error }) = figure else { return };
            // Two digits of the error, and as many decimals of the value.
            let decimals =
                if error > 0.0 { (1.0 - error.log10().floor()).clamp(0.0, 9.0) as usize } else { 3 };
            let value = format!("{value:.decimals$}");
            let error = if error > 0.0 { format!("{error:.decimals$}") } else { String::new() };
            let file =
                key.and_then(|key| Some(format!("{key} = {}", rig.number_at(key)?))).unwrap_or_default();
            rows.push(vec![format!("{name}, {unit}"), value, error, file]);
        };
        let plain = |value: Option<f64>| value.map(|value| Figure { value, error: 0.0 });
        for (i, direction) in [extend, retract].into_iter().enumerate() {
            let key = |kind: &str| format!("load.{kind}_{direction}_n");
            row(&format!("stiction, {direction}"), "N", self.stiction[i], Some(&key("static")));
            row(
                &format!("dry friction while it slips, {direction}"),
                "N",
                self.coulomb[i],
                Some(&key("coulomb")),
            );
        }
        row("viscous friction", "N s/m", self.viscous, Some(keys::load::VISCOUS_N_S_PER_M.path));
        row("mass", "kg", self.mass, Some(keys::load::MASS_KG.path));
        for (i, direction) in [extend, retract].into_iter().enumerate() {
            row(&format!("top speed, {direction}"), "m/s", plain(self.top_speed[i]), None);
            row(&format!("top acceleration, {direction}"), "m/s^2", plain(self.top_acceleration[i]), None);
        }
        row("width of the spool's loop", "mm", plain(self.hysteresis_mm), None);
        for (direction, _) in [extend, retract].into_iter().zip(self.yields).filter(|(_, yields)| *yields) {
            let why = "cannot be seen: the load yields before it slips".to_owned();
            rows.push(vec![format!("stiction, {direction}, N"), why, String::new(), String::new()]);
        }
        Table::new(
            "read off the records, without a model of the air, calibration taken as exact",
            ["figure", "measured", "standard error", "file"],
            rows,
        )
    }

    /// The figures of all records together.
    #[must_use]
    pub fn of(rig: &Rig, recordings: &[Recording]) -> Figures {
        let forces = Forces::of(rig);
        let moving: Vec<Instant> =
            recordings.iter().flat_map(|recording| instants(&forces, recording)).collect();
        let mut figures = Figures::default();
        figures.balance(&moving, forces.uphill());
        let weight = forces.weight(figures.mass);
        let breakaways: Vec<Breakaway> =
            recordings.iter().flat_map(|recording| breakaways(&forces, weight, recording)).collect();
        let of_direction = |sign: f64| breakaways.iter().filter(move |one| one.direction == sign);
        let most = |of: &dyn Fn(&Instant) -> f64, sign: f64| {
            let largest = moving.iter().map(|instant| sign * of(instant)).fold(f64::MIN, f64::max);
            (largest > 0.0).then_some(largest)
        };
        let both = |of: &dyn Fn(&Instant) -> f64| [most(of, 1.0), most(of, -1.0)];
        Figures {
            // The most exact record: the one whose force rises slowest.
            stiction: [1.0, -1.0].map(|sign| {
                let sharp = of_direction(sign).filter(|one| !one.yields).map(|one| one.force);
                sharp.min_by(|a, b| a.error.total_cmp(&b.error))
            }),
            yields: [1.0, -1.0]
                .map(|sign| of_direction(sign).any(|_| true) && of_direction(sign).all(|one| one.yields)),
            top_speed: both(&|instant| instant.speed),
            top_acceleration: both(&|instant| instant.acceleration),
            hysteresis_mm: hysteresis_mm(recordings),
            ..figures
        }
    }

    /// The force balance of a load that slips, and weighs `uphill` m/s^2 of its mass against extension.
    fn balance(&mut self, moving: &[Instant], uphill: f64) {
        let slipping: Vec<&Instant> = moving.iter().filter(|instant| instant.speed.abs() > SLIPS).collect();
        let seen = [1.0, -1.0].map(|sign| slipping.iter().any(|instant| instant.speed * sign > 0.0));
        let columns = 2 + seen.iter().filter(|&&seen| seen).count();
        if slipping.len() < 10 * columns || columns == 2 {
            return;
        }
        let matrix = DMatrix::from_fn(slipping.len(), columns, |row, column| {
            let Instant { speed, acceleration, .. } = slipping[row];
            match column {
                0 => *acceleration + uphill,
                1 => *speed,
                2 if seen[0] => f64::from(*speed > 0.0),
                _ => -f64::from(*speed < 0.0),
            }
        });
        let forces = DVector::from_iterator(slipping.len(), slipping.iter().map(|instant| instant.force));
        let Some(inverse) = matrix.tr_mul(&matrix).try_inverse() else { return };
        let found = &inverse * matrix.tr_mul(&forces);
        let left = (&forces - &matrix * &found).norm_squared();
        // Neighbours share their samples: each tells as much as a part of one.
        let shared = (2 * HALF_WIDTH) as f64;
        let variance = shared * left / (slipping.len() - columns) as f64;
        let figure = |i: usize| Figure { value: found[i], error: (variance * inverse[(i, i)]).sqrt() };
        (self.mass, self.viscous) = (Some(figure(0)), Some(figure(1)));
        self.coulomb = [seen[0].then(|| figure(2)), seen[1].then(|| figure(columns - 1))];
    }
}

impl Forces {
    fn of(rig: &Rig) -> Forces {
        let [low, high] = cushion::between(rig);
        Forces { actuator: Actuator::of(rig), load: Load::of(rig), known: low..=high }
    }

    /// What gravity takes from the acceleration of an extending load, m/s^2.
    fn uphill(&self) -> f64 {
        load::GRAVITY * self.load.uphill
    }

    /// The part of the weight that acts against extension, N, with the mass that was found or that of the file.
    fn weight(&self, found: Option<Figure>) -> Figure {
        let mass = found.unwrap_or(Figure { value: self.load.mass, error: 0.0 });
        Figure { value: mass.value * self.uphill(), error: mass.error * self.uphill().abs() }
    }

    /// Whether the sensors tell of the air that pushes: they do not where the spear of a cushion is in.
    fn are_known(&self, recording: &Recording, k: usize) -> bool {
        let position = &recording.channels[0];
        self.known.contains(&(position.offset + position.measured[k] * position.scale))
    }

    /// All forces on the load at a sample but its weight and its friction, N.
    fn at(&self, recording: &Recording, k: usize) -> f64 {
        let si = |c: usize| {
            recording.channels[c].offset + recording.channels[c].measured[k] * recording.channels[c].scale
        };
        let without_weight = Load { uphill: 0.0, ..self.load };
        self.actuator.force(si(1), si(2)) + without_weight.standing_force(si(0))
    }
}

fn period(recording: &Recording) -> f64 {
    1e-6 * recording.timing.period_us as f64
}

/// The samples throughout which the drive moves.
fn instants(forces: &Forces, recording: &Recording) -> Vec<Instant> {
    let position = &recording.channels[0];
    let y = |k: usize| position.measured[k] * position.scale;
    let half_width_s = HALF_WIDTH as f64 * period(recording);
    let moves = |k: usize| {
        let step = |i: usize| position.measured[i + 1] - position.measured[i];
        let (first, last) = (step(k - HALF_WIDTH), step(k + HALF_WIDTH - 1));
        first * last > 0.0
    };
    let last = position.measured.len().saturating_sub(HALF_WIDTH);
    let at = |k: usize| {
        let around = k - HALF_WIDTH..=k + HALF_WIDTH;
        let weight = |i: usize| (HALF_WIDTH + 1 - i.abs_diff(k)) as f64;
        let (sum, weights) = around.fold((0.0, 0.0), |(sum, weights), i| {
            (sum + weight(i) * forces.at(recording, i), weights + weight(i))
        });
        Instant {
            speed: (y(k + HALF_WIDTH) - y(k - HALF_WIDTH)) / (2.0 * half_width_s),
            acceleration: (y(k + HALF_WIDTH) - 2.0 * y(k) + y(k - HALF_WIDTH))
                / (half_width_s * half_width_s),
            force: sum / weights,
        }
    };
    (HALF_WIDTH..last).filter(|&k| moves(k) && forces.are_known(recording, k)).map(at).collect()
}

/// A load that leaves its rest.
struct Breakaway {
    /// 1: extension; -1: retraction.
    direction: f64,
    /// The size of the force before it; its error is how far the force changed in a sample then, and that of the weight.
    force: Figure,
    /// Whether the force went on rising while the load moved slowly.
    yields: bool,
}

/// Each breakaway from a rest of a load of a weight.
fn breakaways(forces: &Forces, weight: Figure, recording: &Recording) -> Vec<Breakaway> {
    let force = |k: usize| forces.at(recording, k) - weight.value;
    let counts = &recording.channels[0].measured;
    let mut found = Vec::new();
    let mut rest = 0;
    for k in 1..counts.len() {
        let left = counts[k] - counts[rest];
        if left.abs() < MOVED {
            continue;
        }
        // It was at rest until the last sample with the count of the rest.
        let until = (rest..k).rev().find(|&i| counts[i] == counts[rest]).unwrap_or(rest);
        if until - rest >= REST && forces.are_known(recording, until) {
            let direction = left.signum();
            let [before, at] = [until - 1, until].map(|i| direction * force(i));
            let rise = (at - before).abs();
            found.push(Breakaway {
                direction,
                force: Figure { value: at, error: rise.hypot(weight.error) },
                yields: yields(force, recording, until, direction, Figure { value: at, error: rise }),
            });
        }
        rest = k;
    }
    found
}

/// Whether the force goes on rising after a load has begun to move at a sample, until it slips or turns back.
fn yields(
    force: impl Fn(usize) -> f64,
    recording: &Recording,
    from: usize,
    direction: f64,
    first: Figure,
) -> bool {
    let position = &recording.channels[0];
    let speed = |k: usize| {
        let moved = position.measured[k + HALF_WIDTH] - position.measured[k - HALF_WIDTH];
        direction * moved * position.scale / (2.0 * HALF_WIDTH as f64 * period(recording))
    };
    let last = position.measured.len().saturating_sub(HALF_WIDTH);
    let slow = (from..last).take_while(|&k| (0.0..SLIPS).contains(&speed(k)));
    let highest = slow.map(|k| direction * force(k)).fold(first.value, f64::max);
    highest - first.value > (YIELDS * highest).max(3.0 * first.error)
}

/// The mean distance between the spool's branches up and down, over the commands that both have passed.
fn hysteresis_mm(recordings: &[Recording]) -> Option<f64> {
    let mut branches: [BTreeMap<i16, (f64, u32)>; 2] = Default::default();
    for recording in recordings {
        let spool = &recording.channels[3];
        if spool.taken.is_empty() {
            continue;
        }
        let mut branch = None;
        for k in 1..recording.commands.len() {
            let change = recording.commands[k].counts - recording.commands[k - 1].counts;
            if change != 0 {
                // What stood just before the next step has settled.
                if let Some::<usize>(branch) = branch {
                    let place: &mut (f64, u32) =
                        branches[branch].entry(recording.commands[k - 1].counts).or_default();
                    place.0 += 1e3 * (spool.offset + spool.scale * spool.measured[k]);
                    place.1 += 1;
                }
                branch = Some(usize::from(change < 0));
            }
        }
    }
    let [up, down] = &branches;
    let mean = |(sum, n): &(f64, u32)| sum / f64::from(*n);
    let both: Vec<f64> =
        up.iter().filter_map(|(counts, place)| Some(mean(down.get(counts)?) - mean(place))).collect();
    (both.len() >= FEWEST_COMMANDS).then(|| both.iter().sum::<f64>() / both.len() as f64)
}

#[cfg(test)]
mod tests;
