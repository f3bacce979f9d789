//! Hundreds of moves of drives that keep what they learn: none trips, and no estimate ends at its bound.

use pneudrive_controller::law::cascade::kept::Learned;

use super::drive;
use crate::positioning::soak::{Soak, soak};
use crate::positioning::{Plan, Spread};

/// The ends of what may be learned.
fn bounds() -> [Learned; 2] {
    [i32::MIN, i32::MAX].map(|end| {
        Learned { mass: end, friction: end, force: end, viscous: end, pace: end, looseness: end }.bounded()
    })
}

/// Whether all that was kept is between its bounds; friction, B and looseness may come to theirs.
fn is_inside([low, high]: [Learned; 2]) -> bool {
    let [least, most] = bounds();
    let between = |of: fn(&Learned) -> i32| of(&least) < of(&low) && of(&high) < of(&most);
    between(|kept| kept.mass) && between(|kept| kept.force) && between(|kept| kept.pace)
}

#[test]
fn three_hundred_moves_of_drives_that_keep_what_they_learn_neither_trip_nor_end_at_a_bound() {
    let rig = drive("32x250", &["controller.law=cascade", "controller.adapt=kept"]);
    let plan = Plan { spread: Spread::default(), draws: 2, seed: 1 };
    let asked = Soak { armings: 6, moves: 25, change_at: None };
    let score =
        soak(&rig, &plan, &asked, |_, drawn| Ok([drawn.clone(), drawn.clone()]), || {}).expect("it runs");
    assert_eq!((score.trips.as_slice(), score.afresh, score.at_bound), ([].as_slice(), [0; 3], 0));
    assert!(is_inside(score.kept), "{:?}", score.kept);
    let [moves] = score.moves.as_slice() else { panic!("nothing changes in between") };
    let [near, _, nearest] = moves.within;
    assert_eq!((near.met, near.of), (300, 300));
    // 98 % of the long soak do.
    assert!(nearest.met >= 290, "{nearest:?}");
}

/// The first move with twice and with half the load holds its target as those before do.
#[test]
fn a_load_that_is_exchanged_between_two_moves_is_learned_in_the_move_behind() {
    let rig = drive("32x250", &["controller.law=cascade"]);
    let plan = Plan { spread: Spread::default(), draws: 10, seed: 1 };
    let asked = Soak { armings: 1, moves: 12, change_at: Some(10) };
    for factor in [2.0, 0.5] {
        let exchanged = |_, drawn: &pneudrive_sim::Rig| {
            let mass = factor * drawn.number_at("load.mass_kg").expect("a mass");
            Ok([drawn.clone(), drawn.with_plant(&[format!("load.mass_kg={mass:?}")])?])
        };
        let score = soak(&rig, &plan, &asked, exchanged, || {}).expect("it runs");
        assert!(score.trips.is_empty(), "{:?}", score.trips);
        let nearest: Vec<_> = score.moves.iter().map(|part| part.within[2]).collect();
        let [_, first, others] = nearest.as_slice() else { panic!("{nearest:?}") };
        // 118 to 120 of 120 do. With a mass as certain as many moves make it, 26 to 38 of 120 do.
        assert!(first.met >= 9 && first.of == 10, "mass x {factor}: {first:?}");
        assert!(others.met >= 9 && others.of == 10, "mass x {factor}: {others:?}");
    }
}
