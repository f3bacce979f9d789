//! A run that says it has converged is the one that a far finer integration by another method gives.

use pneudrive_sim::{Accuracy, Method, Rig};

use crate::pairs::drawn::Drawn;
use crate::pairs::{KINDS, PARTED_M, Pair, drawn_rig};

/// Its errors grow 5,000-fold over its test, and at 1e-11 and at 1e-13 they are nearly the same by chance.
#[test]
fn a_run_that_agrees_with_a_finer_one_by_chance_is_not_converged() {
    let text = include_str!("cases/converged_lugre.toml");
    let rig = Rig::read("converged_lugre", text).expect("a valid rig");
    let usual = Accuracy::of(&rig);
    let mut parted = 0;
    for accuracy in [usual, Accuracy { method: Method::Merson, tolerance: 1e-12 }] {
        let pair = Pair::of(&rig, accuracy);
        assert!(!pair.is_wrong(), "{accuracy:?}: {:e} m off, {:?}", pair.apart_m, pair.convergence);
        parted += u32::from(pair.apart_m > PARTED_M);
    }
    assert!(parted > 0, "the drive is one whose runs part");
}

#[test]
fn of_drawn_built_in_rigs_and_own_drives_all_that_say_so_are_off_by_no_more_than_they_say() {
    let mut converged = [0; KINDS.len()];
    for draw in 0..12 {
        let (kind, Drawn { name, rig }) = drawn_rig(draw);
        let pair = Pair::of(&rig, Accuracy::of(&rig));
        let [run, convergence] = pair.took;
        println!("{name}: {run:.2?}, its check of convergence {convergence:.2?}");
        assert!(!pair.is_wrong(), "{name}: {:e} m off, {:?}", pair.apart_m, pair.convergence);
        converged[kind] += u32::from(pair.convergence.is_converged());
    }
    assert!(converged.iter().all(|count| *count >= 1), "of 3 each: {converged:?}");
}
