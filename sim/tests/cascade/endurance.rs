//! Moves on end, and rest for long.

use super::{Draws, Drive, rig, unlike};
use pneudrive_controller::{Mode, Move, Sample, Sequence, output, sample};
use pneudrive_sim::{Accuracy, Plant};

/// Samples of a move, of the end of it in which the load has to stand, and of rest.
const MOVE: u32 = 1000;
const END: u32 = 200;

/// Moves after which supply, load and friction are others.
const ALIKE: u32 = 10;

/// A drive that runs, and where it is in its samples.
struct Run {
    drive: Drive,
    sequence: Sequence,
    seen: Sample,
    /// Samples since the plant began.
    k: u32,
}

impl Run {
    fn of(mut drive: Drive) -> Run {
        let mut sequence = Sequence::new(10_000_000);
        sequence.push(Move::step(0, drive.start)).expect("room");
        drive.state.locate(0);
        drive.state.supervisor.arm().expect("at rest");
        drive.state.start(&drive.config, &sequence).expect("a run");
        let seen = drive.plant.sample().expect("a sample");
        let mut run = Run { drive, sequence, seen, k: 0 };
        // The move that its sequence begins with.
        run.step();
        run
    }

    /// A sample; returns the true place, m.
    fn step(&mut self) -> f64 {
        let Run { drive, sequence, seen, k } = self;
        sample(&drive.config, sequence, &mut drive.state, seen);
        let command = output(&drive.config, &mut drive.state);
        let place = drive.plant.look(f64::from(*k) * drive.period).expect("a state").position;
        *seen = drive.plant.advance(command).expect("a sample");
        *k += 1;
        place
    }

    /// To a place (counts); returns the error at the end, and between which places it was in the end of the move, m.
    fn go(&mut self, target: i32, samples: u32) -> (f64, f64) {
        self.drive.state.redirect(&self.drive.config, target).expect("it runs");
        let (mut low, mut high, mut place) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for n in 0..samples {
            place = self.step();
            if n + END >= samples {
                (low, high) = (low.min(place), high.max(place));
            }
        }
        assert_eq!(self.drive.state.supervisor.mode(), Mode::Running, "to {target}");
        ((place - (f64::from(target) + 0.5) * self.drive.count).abs(), high - low)
    }

    /// The same drive where it is, on a supply and with a load that are others.
    fn drift(&mut self, factors: [f64; 3]) {
        let now = self.drive.plant.look(f64::from(self.k) * self.drive.period).expect("a state");
        let mut real = unlike(&[], factors);
        let [one, two] = now.pressures;
        real.extend([
            format!("test.position_m={:?}", now.position),
            format!("test.pressure_1_pa={one:?}"),
            format!("test.pressure_2_pa={two:?}"),
            "test.moves=[[0.0, 0]]".to_owned(),
        ]);
        let real = rig(&real);
        self.drive.plant = Plant::new(&real, Accuracy { tolerance: 1e-8, ..Accuracy::of(&real) }, 1);
        (self.seen, self.k) = (self.drive.plant.sample().expect("a sample"), 0);
    }
}

/// Moves to drawn targets, supply, load and friction others after every ten. Each ends within a fifth of a millimetre and stands; nine
/// in ten within a twentieth.
fn moves_on_end(moves: u32) {
    let mut draws = Draws(0x510e_527f_ade6_82d1);
    let mut run = Run::of(Drive::unlike(&[], [1.0; 3], 0.125));
    let (mut near, mut worst, mut swings) = (0, 0.0_f64, 0.0_f64);
    for n in 0..moves {
        if n % ALIKE == ALIKE - 1 {
            let along = f64::from(n) / 150.0;
            run.drift([
                1.0 + 0.3 * along.sin(),
                1.0 + 0.3 * (1.7 * along).cos(),
                1.0 + 0.05 * (2.3 * along).sin(),
            ]);
        }
        let target = draws.between(0.01, 0.24);
        let (error, swing) = run.go((target / run.drive.count) as i32, MOVE);
        near += u32::from(error < 0.05e-3);
        worst = worst.max(error);
        swings = swings.max(swing);
    }
    let what =
        format!("{near} of {moves} within 0.05 mm, {worst} m off at most, {swings} m of motion in the end");
    println!("{what}");
    assert!(worst < 0.2e-3 && swings < 0.05e-3 && 10 * near >= 9 * moves, "{what}");
}

/// After a move nothing moves by more than a twentieth of a millimetre, while the shut valve leaks.
fn rest(samples: u32) {
    let mut run = Run::of(Drive::unlike(&[], [1.1, 0.8, 1.0], 0.06));
    let (error, _) = run.go(12_000, 2 * MOVE);
    let stood = run.step();
    let (mut low, mut high) = (stood, stood);
    for _ in 0..samples {
        let place = run.step();
        (low, high) = (low.min(place), high.max(place));
    }
    assert_eq!(run.drive.state.supervisor.mode(), Mode::Running);
    println!("{error} m off, {} m of motion", high - low);
    assert!(error < 0.05e-3 && high - low < 0.05e-3, "{error} m off, {} m of motion", high - low);
}

#[test]
fn forty_moves_on_end_each_end_where_they_shall() {
    moves_on_end(40);
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn a_thousand_moves_on_end_each_end_where_they_shall() {
    moves_on_end(1000);
}

#[test]
fn a_load_at_rest_for_twenty_seconds_stays_where_it_is() {
    rest(20_000);
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn a_load_at_rest_for_ten_minutes_stays_where_it_is() {
    rest(600_000);
}
