//! Part I of docs/explanation/equations.md is all that one has to know of a drive by its data sheets: a program written from
//! it alone comes to the same transients.

use crate::independent;

#[test]
fn a_program_written_from_the_equations_alone_simulates_the_same_drives() {
    let drives: Vec<_> =
        (0..).filter_map(|seed| Some((seed, independent::drive(seed, 0.7)?))).take(2).collect();
    for (seed, (rig, run)) in &drives {
        let apart = independent::apart(rig, run);
        assert!(apart.until > 0.3, "drive {seed} has converged beyond its step: {apart:?}");
        assert!(apart.position < 1e-8 && apart.pressure < 0.1, "drive {seed}: {apart:?}");
    }
}
