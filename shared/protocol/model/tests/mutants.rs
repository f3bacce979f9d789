//! The checker finds what is planted.

use pneudrive_protocol_model::host::Job::{self, Configures, Homes, Runs};
use pneudrive_protocol_model::host::Plan;
use pneudrive_protocol_model::mutant::Mutant;
use pneudrive_protocol_model::{Budget, Link};

const NOTHING: Budget = Budget { faults: 0, resets: 0, power_cuts: 0, silences: 0 };

fn is_found(mutant: Mutant, job: Job, budget: Budget, property: &str) {
    let link = || {
        let plans =
            [Plan::new(job, "one", 0x1001, 100, [11, 12]), Plan::new(job, "other", 0x2002, 200, [21, 22])];
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
