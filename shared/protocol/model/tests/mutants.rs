//! The checker finds what is planted.

use pneudrive_protocol_model::host::Job::{self, Configures, Runs};
use pneudrive_protocol_model::host::Plan;
use pneudrive_protocol_model::mutant::Mutant;
use pneudrive_protocol_model::{Budget, Link};

fn is_found(mutant: Mutant, job: Job, power_cuts: u8, property: &str) {
    let budget = Budget { faults: 0, resets: 0, power_cuts, silences: 0 };
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
    is_found(Mutant::IgnoresOwner, Runs, 0, "no move without its own host's arm");
}

#[test]
fn a_rig_that_starts_whatever_it_has_runs_another_hosts_test() {
    is_found(Mutant::IgnoresNameOfStart, Runs, 0, "no run of another host's test");
}

#[test]
fn a_configuration_that_is_saved_in_parts_is_neither_old_nor_new_after_a_power_cut() {
    is_found(Mutant::SavesInParts, Configures, 1, "the configuration is the old or the new one");
}

#[test]
fn a_record_that_is_not_named_is_another_one() {
    is_found(Mutant::IgnoresNameOfRecord, Runs, 0, "a record that is delivered is the one recorded");
}
