//! What threads cost: a sweep on two threads beside two processes that do half of it each, in turns.
//!
//! `cargo bench -p pneudrive --bench sweep_threads`; a number behind `--` is the count of runs, 200 without.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

const ROUNDS: usize = 5;

fn sweep(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder).args(["sweep", "s.toml"]).args(arguments);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program runs")
}

/// Seconds until all have ended.
fn seconds(start: impl FnOnce() -> Vec<Child>) -> f64 {
    let begin = Instant::now();
    for mut child in start() {
        assert!(child.wait().expect("it was started").success());
    }
    begin.elapsed().as_secs_f64()
}

fn main() {
    let runs: usize = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(200);
    let folder = tempfile::tempdir().expect("a folder");
    let text = format!(
        "rig = \"servo-b-tuned\"\n[vary]\nload.mass_kg = {{ uniform = [1.12, 2.08] }}\n\
         [draw]\ncount = {runs}\n[metrics]\nsettling = \"settling_s\"\n"
    );
    fs::write(folder.path().join("s.toml"), text).expect("written");
    let mut ratios: Vec<f64> = (0..ROUNDS)
        .map(|round| {
            let out = |name: &str| format!("{name}-{round}");
            let threads = seconds(|| vec![sweep(folder.path(), &["--threads", "2", "--out", &out("whole")])]);
            let processes = seconds(|| {
                let shard = |shard: &str, name: &str| {
                    sweep(folder.path(), &["--threads", "1", "--shard", shard, "--out", &out(name)])
                };
                vec![shard("1/2", "one"), shard("2/2", "two")]
            });
            println!("{runs} runs: two threads {threads:.2} s, two processes {processes:.2} s");
            processes / threads
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    println!("two threads are {:.2} times as fast as two processes (median of {ROUNDS})", ratios[ROUNDS / 2]);
}
