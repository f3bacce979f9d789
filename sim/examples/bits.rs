//! A hash over every bit of the run of each built-in rig: rows, readings and commands. The same on every processor, as
//! `cargo xtask processors` shows.

use pneudrive_sim::rig::BUILTIN;
use pneudrive_sim::{Accuracy, Rig, Run, run};

fn main() {
    for (name, _) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let run = run(&rig, Accuracy::of(&rig)).expect("a built-in rig can be simulated");
        println!("{name} {:016x}", hash(&run));
    }
}

/// FNV-1a over words of 64 bits.
fn hash(run: &Run) -> u64 {
    let rows = run.rows.iter().flat_map(|row| row.values().map(f64::to_bits));
    let readings = run.readings.iter().flat_map(|reading| {
        let [one, two] = reading.pressures;
        [reading.position, one, two, reading.spool].map(f64::to_bits)
    });
    let commands = run.commands.iter().map(|command| command.counts as u64);
    let words = rows.chain(readings).chain(commands);
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3))
}
