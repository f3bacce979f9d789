//! How often members of the ensemble of a run leave its band, in closed loops drawn at random. A band is that of the run and
//! its first seven perturbed runs, all at the tolerance of the run; the seven after these are drawn at other tolerances.

#[path = "../../../../sim/tests/drawn/mod.rs"]
mod drawn;

use drawn::Drawn;
use pneudrive_evaluate::parallel;
use pneudrive_optimise::ensemble::members;
use pneudrive_records::judged::Spacing;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// s: the two moves of a drawn loop, each as long as a second.
const MOVES: [[f64; 2]; 2] = [[0.1, 1.1], [1.1, 2.1]];

/// s: after the beginning of a move.
const UNDER_WAY: f64 = 0.2;
const AT_ITS_END: f64 = 0.95;

/// A figure that lies farther beyond a band than so many widths of it has left it.
const BEYOND: f64 = 0.2;

/// Figures of perturbed runs, and how many of them have left the band.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leaving {
    pub figures: u32,
    pub left: u32,
}

impl Leaving {
    pub fn share(&self) -> f64 {
        f64::from(self.left) / f64::from(self.figures)
    }
}

/// Of rigs drawn with these seeds, at tolerances that each rig has.
pub fn of_drawn<const N: usize>(
    seeds: std::ops::Range<u64>,
    tolerances: impl Fn(&Rig) -> [f64; N] + Sync,
) -> [Leaving; N] {
    let seeds: Vec<u64> = seeds.collect();
    let of_each = parallel::map(
        &seeds,
        |seed| {
            let drawn = drawn::closed_loop(*seed);
            of_rig(&drawn, tolerances(&drawn.rig))
        },
        |_| {},
    );
    of_each.into_iter().fold([Leaving::default(); N], |mut sums, each| {
        for (sum, one) in sums.iter_mut().zip(each) {
            (sum.figures, sum.left) = (sum.figures + one.figures, sum.left + one.left);
        }
        sums
    })
}

fn of_rig<const N: usize>(Drawn { name, rig }: &Drawn, tolerances: [f64; N]) -> [Leaving; N] {
    let accuracy = Accuracy::of(rig);
    let at = |rig: &Rig, tolerance| {
        let run = run(rig, Accuracy { tolerance, ..accuracy });
        figures(&run.unwrap_or_else(|error| panic!("{name} at {tolerance:e}: {error}")))
    };
    let all: Vec<Rig> =
        members(rig, Spacing { runs: 15, ..Spacing::default() }).into_iter().flatten().collect();
    let (near, others) = all.split_at(7);
    let band: Vec<_> = std::iter::once(rig).chain(near).map(|rig| at(rig, accuracy.tolerance)).collect();
    tolerances.map(|tolerance| {
        let figures = others.iter().flat_map(|other| at(other, tolerance).into_iter().enumerate());
        figures.fold(Leaving::default(), |Leaving { figures, left }, (i, figure)| Leaving {
            figures: figures + 1,
            left: left + u32::from(has_left(band.iter().map(|run| run[i]), figure)),
        })
    })
}

fn has_left(band: impl Iterator<Item = f64>, figure: f64) -> bool {
    let [low, high] =
        band.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], one| [low.min(one), high.max(one)]);
    let beyond = BEYOND * (high - low);
    figure < low - beyond || figure > high + beyond
}

/// Of each move: the position under way and at its end, the largest and the smallest one, m.
fn figures(run: &Run) -> Vec<f64> {
    let of_move = |[from, until]: [f64; 2]| {
        let rows = || run.rows.iter().filter(move |row| row.time >= from && row.time < until);
        let at = |time: f64| rows().find(|row| row.time >= from + time).map_or(0.0, |row| row.plant.position);
        let positions = || rows().map(|row| row.plant.position);
        [
            at(UNDER_WAY),
            at(AT_ITS_END),
            positions().fold(f64::NEG_INFINITY, f64::max),
            positions().fold(f64::INFINITY, f64::min),
        ]
    };
    MOVES.into_iter().flat_map(of_move).collect()
}
