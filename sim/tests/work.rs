//! What runs cost, in counts: a slower program fails here without a clock. An unexplained saving fails too;
//! write the table anew (CONTRIBUTING.md) with the reason in the commit.

#[allow(dead_code)]
#[path = "../examples/cost/table.rs"]
mod table;

#[test]
fn every_built_in_rig_and_every_reference_case_costs_what_its_row_says() {
    let page = std::fs::read_to_string(table::PAGE).expect("tests/counts/work.md");
    let stated = table::of_page(&page).expect("a table");
    let found = table::rows().expect("rigs that can be read");
    assert_eq!(found.lines().count(), stated.lines().count());
    for (found, stated) in found.lines().zip(stated.lines()) {
        assert_eq!(found, stated);
    }
}
