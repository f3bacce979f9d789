//! Many moves of a drive in many armings, while its plant changes between armings or between two moves of one.
//!
//! Each arming is a run of moves to places drawn between the ends of the range, at least [`LEAST_MM`] away from each other and
//! [`MOVE_S`] apart. A drive with `controller.adapt = "kept"` begins it with what the armings before have taught it.
//!
//! | figure of a move | definition |
//! |---|---|
//! | within a band | it stays there for the last [`REST_S`] |
//! | deviation | largest distance of the piston from the trajectory of its law |
//! | overshoot | how far the piston goes beyond the target, in the direction of the move |

use anyhow::{Result, ensure};
use pneudrive_controller::law::cascade::kept::{Changed, Kept, Learned};
use pneudrive_evaluate::parallel;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::component::load::Load;
use pneudrive_sim::rig::unit_interval;
use pneudrive_sim::{Accuracy, Plant, Rig, Run, keys, run_changing};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::Plan;
use super::arrival::{BANDS_MM, to_its_end};
use super::course::{HOLD_S, at_count, range, with_test};
use super::draw::draws;
use super::score::{OVERSHOOT_MM, median};
use crate::tuning::Proportion;

/// How long a move lasts, s.
pub const MOVE_S: f64 = 2.0;
/// For this long at the end of its move a piston is to stay within a band, s.
pub const REST_S: f64 = 0.5;
/// The shortest move, mm.
pub const LEAST_MM: f64 = 10.0;

/// On a trajectory of its own.
const TRAJECTORY: f64 = 1.0;

/// Random numbers of the places; those of the draws have streams of their own.
const PLACES: u64 = 8;

/// How often a drive is armed, and how many moves it makes then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Soak {
    /// Armings.
    pub armings: usize,
    /// Moves of each, fewer than [`pneudrive_controller::sequencer::MAX_MOVES`].
    pub moves: usize,
    /// Before this move of each arming, from 0 on, load and supply become those of the plant behind the change.
    pub change_at: Option<usize>,
}

/// What one move shows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MoveSeen {
    /// Whether it ends within each band of [`BANDS_MM`].
    within: [bool; BANDS_MM.len()],
    deviation_mm: f64,
    beyond_mm: f64,
}

/// Moves of all draws and armings.
#[derive(Clone, Debug, PartialEq)]
pub struct MovesScore {
    /// Those that end within each band of [`BANDS_MM`].
    pub within: [Proportion; BANDS_MM.len()],
    /// Median and largest deviation, mm.
    pub deviation_mm: Option<[f64; 2]>,
    /// Largest overshoot, mm.
    pub beyond_mm: f64,
    /// Those that overshoot by more than [`OVERSHOOT_MM`].
    pub overshoots: usize,
}

/// A soak of all draws.
#[derive(Clone, Debug, PartialEq)]
pub struct SoakScore {
    /// All moves; with a change in between those before it, the first one behind it, and the others.
    pub moves: Vec<MovesScore>,
    /// Runs that did not come to their end: draw, arming, and why.
    pub trips: Vec<String>,
    /// The least and the largest of what was kept after any arming.
    pub kept: [Learned; 2],
    /// Armings that began afresh: what was learned stayed at a bound, or jumped, or the run before had tripped.
    pub afresh: [usize; 3],
    /// Runs that ended with an estimate at a bound.
    pub at_bound: usize,
}

/// One arming: its moves, or why it did not come to its end, and what was kept behind it.
struct Shown {
    moves: Vec<MoveSeen>,
    trip: Option<String>,
    kept: Kept,
}

/// A soak on the draws of a plan. `plants` makes the rig of an arming, from 0 on, of that of a draw: before and behind the change.
/// `progress` is called after each arming.
///
/// # Errors
/// When a rig cannot have this test, or no place is [`LEAST_MM`] away from every other.
pub fn soak(
    rig: &Rig,
    plan: &Plan,
    soak: &Soak,
    plants: impl Fn(usize, &Rig) -> Result<[Rig; 2]> + Sync,
    progress: impl Fn() + Sync,
) -> Result<SoakScore> {
    let drawn: Vec<(u64, Rig)> = draws(rig, plan.spread, plan.seed, plan.draws)?
        .iter()
        .zip(0..)
        .map(|(draw, n)| Ok((n, draw.rig(rig)?)))
        .collect::<Result<_>>()?;
    let one = |(n, drawn): &(u64, Rig)| {
        let mut random = ChaCha8Rng::seed_from_u64(plan.seed.wrapping_mul(1 << 20).wrapping_add(*n));
        random.set_stream(PLACES);
        in_turn(soak, &mut random, |arming| plants(arming, drawn), &progress)
    };
    let all = parallel::map(&drawn, one, |_| {}).into_iter().collect::<Result<Vec<_>>>()?;
    Ok(score(soak, &all))
}

/// The armings of a draw, each with what the ones before have taught.
fn in_turn(
    soak: &Soak,
    random: &mut ChaCha8Rng,
    plants: impl Fn(usize) -> Result<[Rig; 2]>,
    progress: impl Fn(),
) -> Result<Vec<Shown>> {
    let mut kept = Kept::default();
    let mut shown = Vec::with_capacity(soak.armings);
    for arming in 0..soak.armings {
        let [plant, behind] = plants(arming)?;
        let places = places(&plant, soak.moves, random)?;
        let rig = with_moves(&plant, &places)?;
        let run = run_changing(&rig, Accuracy::of(&rig), &kept, change(soak, &rig, &behind))?;
        kept = run.kept.unwrap_or(kept);
        shown.push(Shown { moves: seen(&rig, &run, &places), trip: to_its_end(&run).err(), kept });
        progress();
    }
    Ok(shown)
}

/// Gives the plant load and supply of another rig before its move.
fn change<'a>(soak: &Soak, rig: &Rig, behind: &'a Rig) -> impl FnMut(u64, &mut Plant) + use<'a> {
    let at = soak.change_at.map(|n| sample_of(rig, n));
    move |k, plant| {
        if Some(k) == at {
            plant.set_load(Load::of(behind));
            plant.set_supply_pressure(behind.get(&keys::supply::PRESSURE_PA));
        }
    }
}

/// The first sample of a move.
fn sample_of(rig: &Rig, n: usize) -> u64 {
    (begin_s(n) * 1e6 / f64::from(rig.period_us().get())).ceil() as u64
}

fn begin_s(n: usize) -> f64 {
    HOLD_S + n as f64 * MOVE_S
}

/// Where an arming begins, and the targets of its moves, counts.
fn places(rig: &Rig, moves: usize, random: &mut ChaCha8Rng) -> Result<Vec<i64>> {
    let ([low, high], least) = (range(rig), (LEAST_MM / mm_per_count(rig)).ceil() as i64);
    ensure!(high - low >= 2 * least, "the moves need {} mm between the ends of the range", 2.0 * LEAST_MM);
    let mut places: Vec<i64> = Vec::with_capacity(moves + 1);
    while places.len() <= moves {
        let next = low + (unit_interval(random) * (high - low) as f64).round() as i64;
        if places.last().is_none_or(|last| (next - last).abs() >= least) {
            places.push(next);
        }
    }
    Ok(places)
}

fn with_moves(rig: &Rig, places: &[i64]) -> Result<Rig> {
    let moves = places[1..].iter().enumerate().map(|(n, to)| format!(", [{:?}, {to}]", begin_s(n)));
    let moves = format!("test.moves=[[0.0, {}]{}]", places[0], moves.collect::<String>());
    with_test(rig, moves, begin_s(places.len() - 1), places[0])
}

/// The moves that a run has come to the end of.
fn seen(rig: &Rig, run: &Run, places: &[i64]) -> Vec<MoveSeen> {
    let row_at = |n: usize| run.rows.partition_point(|row| row.time < begin_s(n));
    let ends: Vec<f64> = places.iter().map(|&place| at_count(rig, place)).collect();
    (0..places.len() - 1)
        .map_while(|n| {
            let rows = &run.rows[row_at(n)..row_at(n + 1)];
            let last = rows.last().filter(|last| last.time > begin_s(n + 1) - 0.01)?;
            let [from, to] = [ends[n], ends[n + 1]];
            let at = |row: &pneudrive_sim::trace::Row| 1e3 * row.plant.position;
            let off = |row: &pneudrive_sim::trace::Row| {
                let known = row.known.filter(|known| known.stage == TRAJECTORY)?;
                Some((1e3 * known.reference - at(row)).abs())
            };
            let rest = &rows[rows.partition_point(|row| row.time < last.time - REST_S)..];
            Some(MoveSeen {
                within: BANDS_MM.map(|band| rest.iter().all(|row| (at(row) - to).abs() <= band)),
                deviation_mm: rows.iter().filter_map(off).fold(0.0, f64::max),
                beyond_mm: rows.iter().map(|row| (to - from).signum() * (at(row) - to)).fold(0.0, f64::max),
            })
        })
        .collect()
}

fn score(soak: &Soak, all: &[Vec<Shown>]) -> SoakScore {
    let shown = || all.iter().flatten();
    let ends = match soak.change_at {
        Some(at) => vec![0, at, at + 1, soak.moves],
        None => vec![0, soak.moves],
    };
    let part = |ends: &[usize]| {
        let of_arming = |shown: &Shown| {
            (ends[0]..ends[1]).map(|n| shown.moves.get(n).copied()).collect::<Vec<Option<MoveSeen>>>()
        };
        moves_score(&shown().flat_map(of_arming).collect::<Vec<_>>())
    };
    let trips = all.iter().enumerate().flat_map(|(draw, armings)| {
        armings.iter().enumerate().filter_map(move |(arming, shown)| {
            shown.trip.as_ref().map(|why| format!("draw {draw}, arming {arming}: {why}"))
        })
    });
    let begins_afresh =
        |why| shown().filter(|shown| shown.kept.armings == 0 && shown.kept.changed == why).count();
    SoakScore {
        moves: ends.windows(2).map(part).collect(),
        trips: trips.collect(),
        kept: extremes(shown().map(|shown| shown.kept.learned)),
        afresh: [Changed::AtBound, Changed::Jumped, Changed::Tripped].map(begins_afresh),
        at_bound: shown().filter(|shown| shown.kept.at_bound > 0).count(),
    }
}

/// A move that a run did not come to the end of is within nothing.
fn moves_score(moves: &[Option<MoveSeen>]) -> MovesScore {
    let ended = || moves.iter().flatten();
    let within =
        |band: usize| Proportion { met: ended().filter(|seen| seen.within[band]).count(), of: moves.len() };
    let deviations: Vec<f64> = ended().map(|seen| seen.deviation_mm).collect();
    let worst = deviations.iter().copied().fold(0.0, f64::max);
    MovesScore {
        within: [0, 1, 2].map(within),
        deviation_mm: median(deviations).map(|middle| [middle, worst]),
        beyond_mm: ended().map(|seen| seen.beyond_mm).fold(0.0, f64::max),
        overshoots: ended().filter(|seen| seen.beyond_mm > OVERSHOOT_MM).count(),
    }
}

/// The least and the largest of each estimate.
fn extremes(all: impl Iterator<Item = Learned>) -> [Learned; 2] {
    let each = |one: Learned, other: Learned, of: fn(i32, i32) -> i32| Learned {
        mass: of(one.mass, other.mass),
        friction: of(one.friction, other.friction),
        force: of(one.force, other.force),
        viscous: of(one.viscous, other.viscous),
        pace: of(one.pace, other.pace),
        looseness: of(one.looseness, other.looseness),
    };
    let join = |[low, high]: [Learned; 2], next| [each(low, next, i32::min), each(high, next, i32::max)];
    all.map(|one| [one, one]).reduce(|so_far, [next, _]| join(so_far, next)).unwrap_or_default()
}
