//! A plant takes no memory while it runs: all that it needs is there from the start.

use std::alloc::System;

use pneudrive_controller::Command;
use pneudrive_sim::{Accuracy, Plant, Rig};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// What half a second of moves either way takes, looked at once a sample.
fn taken(rig: &Rig) -> usize {
    let mut plant = Plant::new(rig, Accuracy::of(rig), 0);
    let period = plant_period_s(rig);
    let region = Region::new(MEMORY);
    for k in 0..400_i32 {
        let counts = if k % 200 < 100 { 600 } else { -600 };
        let step = if k % 200 < 20 { 1 } else { 0 };
        plant.advance(Command { counts, step, ..Command::OFF }).expect("a transient");
        plant.look(period * f64::from(k + 1)).expect("a transient");
    }
    region.change().allocations
}

/// A plant that took memory would do so each time. The thread that runs the tests may take some beside it, once.
fn takes_none(rig: &Rig) {
    let least = (0..5).map(|_| taken(rig)).min();
    assert_eq!(least, Some(0), "{}", rig.name());
}

/// One test, as another one beside it would take memory of its own.
#[test]
fn no_sample_of_any_built_in_rig_takes_memory() {
    for (name, _) in pneudrive_sim::rigfile::BUILTIN {
        takes_none(&Rig::builtin(name).expect("a built-in rig"));
    }
}

fn plant_period_s(rig: &Rig) -> f64 {
    f64::from(rig.period_us().get()) * 1e-6
}
