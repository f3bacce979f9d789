//! Visits all states of two hosts and a rig, within bounds that are given:
//! `link_states JOB JOB FAULTS RESETS POWER_CUTS SILENCES [WAITS INPUTS] [gateway] [deep]`, a job being `configures`, `runs`,
//! `both`, `homes`, `follows`, `holds`, `stops` or `rests`. WAITS are silences of half the time, INPUTS changes of a PLC's contacts. With
//! `gateway` frames are repeated as often as may be, with `deep` it takes less memory.

use pneudrive_link_states::host::{Job, Plan};
use pneudrive_link_states::{Budget, Link};

fn job(name: &str) -> Job {
    match name {
        "configures" => Job::Configures,
        "runs" => Job::Runs,
        "both" => Job::Both,
        "homes" => Job::Homes,
        "follows" => Job::Follows,
        "holds" => Job::Holds,
        "stops" => Job::Stops,
        "rests" => Job::Rests,
        other => panic!("{other}: a job is configures, runs, both, homes, follows, holds, stops or rests"),
    }
}

/// The bounds in numbers and words.
fn budget(given: &[String]) -> Budget {
    let number = |text: &String| text.parse::<u8>().unwrap_or_else(|error| panic!("{text}: {error}"));
    let numbers: Vec<u8> = given.iter().filter(|it| it.parse::<u8>().is_ok()).map(number).collect();
    let [faults, resets, power_cuts, silences, ref more @ ..] = numbers[..] else {
        panic!("two jobs and four numbers: faults, resets, power cuts, silences");
    };
    let (waits, inputs) = match *more {
        [] => (0, 0),
        [waits, inputs] => (waits, inputs),
        _ => panic!("behind the silences: waits and inputs, or nothing"),
    };
    let gateway = given.iter().any(|it| it == "gateway");
    Budget { faults, resets, power_cuts, silences, waits, inputs, gateway }
}

fn main() -> std::process::ExitCode {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [one, other, bounds @ ..] = &given[..] else { panic!("two jobs, and bounds") };
    let words = bounds.iter().filter(|it| it.parse::<u8>().is_err());
    words.for_each(|it| assert!(it == "gateway" || it == "deep", "{it}: a word is `gateway` or `deep`"));
    let budget = budget(bounds);
    let plans = [
        Plan::new(job(one), "one", 0x1001, 100, [11, 12]),
        Plan::new(job(other), "other", 0x2002, 200, [21, 22]),
    ];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let link = Link::new(plans, budget).cut_at([0, 1, 2, 34, 65, 66, 67, 68]);
    let deep = bounds.iter().any(|it| it == "deep");
    let visited = if deep { link.visit_deep(threads) } else { link.visit(threads) };
    match visited {
        Ok(figures) => println!("{}: {figures}", given.join(" ")),
        Err(story) => {
            println!("{}: {story}", given.join(" "));
            return std::process::ExitCode::FAILURE;
        }
    }
    std::process::ExitCode::SUCCESS
}
