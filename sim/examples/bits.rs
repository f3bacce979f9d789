//! A hash over every bit of the run of each built-in rig: rows, readings and commands. The same on every processor, as
//! `cargo xtask processors` shows.

use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::{Accuracy, Rig, run};

fn main() {
    for (name, _) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let run = run(&rig, Accuracy::of(&rig)).expect("a built-in rig can be simulated");
        println!("{name} {:016x}", run.bits());
    }
}
