//! The checker finds what is planted.

use pneudrive_link_states::host::Job::{self, Configures, Follows, Holds, Homes, Rests, Runs, Stops};
use pneudrive_link_states::host::Plan;
use pneudrive_link_states::mutant::Mutant;
use pneudrive_link_states::{Budget, Link};

const NOTHING: Budget =
    Budget { faults: 0, resets: 0, power_cuts: 0, silences: 0, waits: 0, inputs: 0, gateway: false };

fn is_found(mutant: Mutant, job: Job, budget: Budget, property: &str) {
    is_found_with(mutant, [job, job], budget, property);
}

fn is_found_with(mutant: Mutant, [one, other]: [Job; 2], budget: Budget, property: &str) {
    let link = || {
        let plans =
            [Plan::new(one, "one", 0x1001, 100, [11, 12]), Plan::new(other, "other", 0x2002, 200, [21, 22])];
        Link::new(plans, budget).cut_at(0..160)
    };
    link().visit(1).expect("without the defect the same states are right");
    let story = link().with(mutant).visit(1).expect_err("the defect is found");
    assert!(story.contains(&format!("not so: {property}")), "{story}");
}

#[test]
fn a_rig_that_does_not_look_who_owns_it_moves_for_a_host_that_has_not_armed_it() {
    is_found(Mutant::IgnoresOwner, Runs, NOTHING, "no move without its own host's arm");
}

#[test]
fn a_rig_that_starts_whatever_it_has_runs_another_hosts_test() {
    is_found(Mutant::IgnoresNameOfStart, Runs, NOTHING, "no run of another host's test");
}

#[test]
fn a_configuration_that_is_saved_in_parts_is_neither_old_nor_new_after_a_power_cut() {
    let budget = Budget { power_cuts: 1, ..NOTHING };
    is_found(Mutant::SavesInParts, Configures, budget, "the configuration is the old or the new one");
}

#[test]
fn a_record_that_is_not_named_is_another_one() {
    is_found(Mutant::IgnoresNameOfRecord, Runs, NOTHING, "a record that is delivered is the one recorded");
}

#[test]
fn a_rig_that_takes_requests_from_before_its_reset_homes_for_a_host_that_has_not_armed_it_since() {
    let budget = Budget { resets: 1, ..NOTHING };
    is_found(Mutant::IgnoresBoot, Homes, budget, "no move without its own host's arm");
}

#[test]
fn a_stop_that_is_swallowed_while_a_fault_is_acknowledged_lets_the_inputs_begin() {
    // The first stop is acknowledged, the second one is swallowed, then a start.
    let budget = Budget { inputs: 2, ..NOTHING };
    let property = "no record of the inputs before a stop is acknowledged";
    is_found_with(Mutant::SwallowsStop, [Stops, Stops], budget, property);
}

#[test]
fn a_number_that_is_read_at_once_begins_another_record() {
    let budget = Budget { inputs: 2, ..NOTHING };
    is_found_with(
        Mutant::ReadsNumberAtOnce,
        [Stops, Rests],
        budget,
        "no record of a number that has not stayed",
    );
}

#[test]
fn a_gateway_whose_copies_count_as_heard_keeps_the_drive_moving_for_a_host_that_says_nothing() {
    let budget = Budget { waits: 2, gateway: true, ..NOTHING };
    let property = "no move for an owner that says nothing new";
    is_found_with(Mutant::HearsCopies, [Follows, Rests], budget, property);
}

#[test]
fn a_rig_that_misses_nobody_holds_for_an_owner_long_gone() {
    let budget = Budget { silences: 1, ..NOTHING };
    is_found_with(Mutant::NeverMissesHost, [Holds, Rests], budget, "no hold for an owner long gone");
}
