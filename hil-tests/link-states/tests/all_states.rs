//! All states of two hosts and a rig, within bounds that take less than a minute; `cargo xtask link-states` goes further.

use pneudrive_link_states::host::Job::{self, Both, Configures, Follows, Holds, Homes, Rests, Runs, Stops};
use pneudrive_link_states::host::Plan;
use pneudrive_link_states::{Budget, Link};

const NOTHING: Budget =
    Budget { faults: 0, resets: 0, power_cuts: 0, silences: 0, waits: 0, inputs: 0, gateway: false };

/// Operations of a save at which the power goes: the erase, the first chunks, one in the middle, the last ones, the seal,
/// and what comes after it.
const CUTS: [u8; 8] = [0, 1, 2, 34, 65, 66, 67, 68];

fn hosts(jobs: [Job; 2], sessions: [u32; 2], budget: Budget) -> Link {
    let [one, other] = jobs;
    let plans = [
        Plan::new(one, "one", sessions[0], 100, [11, 12]),
        Plan::new(other, "other", sessions[1], 200, [21, 22]),
    ];
    Link::new(plans, budget).cut_at(CUTS)
}

fn holds(name: &str, link: Link) {
    match link.visit(1) {
        Ok(figures) => println!("{name}: {figures}"),
        Err(story) => panic!("{name}: {story}"),
    }
}

const TWO: [u32; 2] = [0x1001, 0x2002];

#[test]
fn two_hosts_that_configure_with_two_faults_a_reset_and_a_power_cut() {
    let budget = Budget { faults: 2, resets: 1, power_cuts: 1, ..NOTHING };
    holds("configures, configures", hosts([Configures, Configures], TWO, budget));
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn two_hosts_that_configure_with_a_power_cut_at_any_operation_of_the_flash() {
    let budget = Budget { power_cuts: 1, resets: 1, ..NOTHING };
    holds("configures, configures, any cut", hosts([Configures, Configures], TWO, budget).cut_at(0..160));
}

#[test]
fn a_host_that_runs_and_one_that_configures_with_a_reset_and_a_power_cut() {
    let budget = Budget { resets: 1, power_cuts: 1, ..NOTHING };
    holds("runs, configures", hosts([Runs, Configures], TWO, budget));
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn two_hosts_that_home_with_two_faults_and_a_reset() {
    let budget = Budget { faults: 2, resets: 1, ..NOTHING };
    holds("homes, homes", hosts([Homes, Homes], TWO, budget));
}

#[test]
fn a_host_that_homes_and_one_that_runs_with_a_fault_and_a_reset() {
    holds("homes, runs", hosts([Homes, Runs], TWO, Budget { faults: 1, resets: 1, ..NOTHING }));
}

#[test]
fn two_hosts_that_run_with_a_fault() {
    holds("runs, runs, fault", hosts([Runs, Runs], TWO, Budget { faults: 1, ..NOTHING }));
}

#[test]
fn two_hosts_that_run_with_a_reset() {
    holds("runs, runs, reset", hosts([Runs, Runs], TWO, Budget { resets: 1, ..NOTHING }));
}

#[test]
fn two_hosts_that_run_of_which_the_owner_falls_silent() {
    holds("runs, runs, silence", hosts([Runs, Runs], TWO, Budget { silences: 1, ..NOTHING }));
}

#[test]
fn two_hosts_that_configure_and_run_in_order() {
    holds("both, both", hosts([Both, Both], TWO, NOTHING));
}

#[test]
fn a_plc_whose_contacts_change_five_times_and_a_host_that_stops() {
    holds("stops, inputs", hosts([Stops, Rests], TWO, Budget { inputs: 5, ..NOTHING }));
}

#[test]
fn a_plc_and_a_host_that_stops_with_a_fault_and_a_reset() {
    let budget = Budget { faults: 1, resets: 1, inputs: 3, ..NOTHING };
    holds("stops, inputs, fault, reset", hosts([Stops, Rests], TWO, budget));
}

#[test]
fn a_plc_and_two_hosts_that_stop() {
    holds("stops, stops, inputs", hosts([Stops, Stops], TWO, Budget { inputs: 4, ..NOTHING }));
}

#[test]
fn a_plc_and_a_host_that_runs() {
    holds("runs, inputs", hosts([Runs, Rests], TWO, Budget { inputs: 2, ..NOTHING }));
}

#[test]
fn an_owner_that_a_gateway_repeats_and_that_falls_silent_by_halves() {
    let budget = Budget { waits: 2, gateway: true, ..NOTHING };
    holds("follows, homes, gateway", hosts([Follows, Homes], TWO, budget));
}

#[test]
fn a_drive_that_holds_for_an_owner_that_is_gone_with_a_fault_and_a_reset() {
    let budget = Budget { faults: 1, resets: 1, silences: 1, ..NOTHING };
    holds("holds, homes, silence", hosts([Holds, Homes], TWO, budget));
}
