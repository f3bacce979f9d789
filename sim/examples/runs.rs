//! Times runs of a built-in rig: `runs RIG COUNT` answers each line of its input with the mean seconds of COUNT runs.
//! host/python/tests/overhead.py holds the Python package against it.

use std::io::{BufRead, stdin};
use std::time::Instant;

use pneudrive_sim::{Accuracy, Rig, run};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, count] = arguments.as_slice() else { panic!("write: runs RIG COUNT") };
    let rig = Rig::builtin(name).expect("the name of a built-in rig");
    let count: u32 = count.parse().expect("a number of runs");
    for _ in stdin().lock().lines() {
        let begun = Instant::now();
        for _ in 0..count {
            run(&rig, Accuracy::of(&rig)).expect("a built-in rig can be simulated");
        }
        println!("{}", begun.elapsed().as_secs_f64() / f64::from(count));
    }
}
