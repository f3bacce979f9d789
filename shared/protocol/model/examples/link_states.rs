//! Visits all states of two hosts that configure and run, within bounds that are given:
//! `link_states JOB JOB FAULTS RESETS POWER_CUTS SILENCES`, a job being `configures`, `runs`, `both` or `homes`. With `deep` behind
//! them it takes less memory.

use pneudrive_protocol_model::host::{Job, Plan};
use pneudrive_protocol_model::{Budget, Link};

fn job(name: &str) -> Job {
    match name {
        "configures" => Job::Configures,
        "runs" => Job::Runs,
        "both" => Job::Both,
        "homes" => Job::Homes,
        other => panic!("{other}: a job is configures, runs, both or homes"),
    }
}

fn main() -> std::process::ExitCode {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [one, other, faults, resets, power_cuts, silences, deep @ ..] = &given[..] else {
        panic!("two jobs and four numbers: faults, resets, power cuts, silences");
    };
    assert!(deep.is_empty() || deep == ["deep"], "behind the numbers `deep`, or nothing");
    let number = |text: &String| text.parse().unwrap_or_else(|error| panic!("{text}: {error}"));
    let budget = Budget {
        faults: number(faults),
        resets: number(resets),
        power_cuts: number(power_cuts),
        silences: number(silences),
    };
    let plans = [
        Plan::new(job(one), "one", 0x1001, 100, [11, 12]),
        Plan::new(job(other), "other", 0x2002, 200, [21, 22]),
    ];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let link = Link::new(plans, budget).cut_at([0, 1, 2, 34, 65, 66, 67, 68]);
    let visited = if deep.is_empty() { link.visit(threads) } else { link.visit_deep(threads) };
    match visited {
        Ok(figures) => println!("{}: {figures}", given.join(" ")),
        Err(story) => {
            println!("{}: {story}", given.join(" "));
            return std::process::ExitCode::FAILURE;
        }
    }
    std::process::ExitCode::SUCCESS
}
