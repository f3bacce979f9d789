//! Sources with a planted fault each.

use std::fs;
use std::path::Path;

use super::{crates, of_crate};

/// A crate of these files; what breaks a rule in it.
fn broken(files: &[(&str, &str)]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join("src").join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    of_crate(folder.path()).expect("sources")
}

#[test]
fn a_planted_circle_of_three_siblings_is_found_with_its_uses() {
    let found = broken(&[
        ("lib.rs", "mod valve; mod network; mod rig;"),
        ("valve.rs", "use crate::network::Flow; pub struct Valve;"),
        ("network.rs", "mod node;"),
        ("network/node.rs", "pub fn of() { crate::rig::read() }"),
        ("rig.rs", "use super::valve::Valve; pub fn read() {}"),
    ]);
    let told = "a circle below the crate: network -> rig (network::node uses rig::read), \
                rig -> valve (rig uses valve::Valve), valve -> network (valve uses network::Flow)";
    assert_eq!(found, [told]);
}

#[test]
fn a_re_export_leads_to_where_the_thing_is() {
    let found = broken(&[
        ("lib.rs", "mod a; mod b; pub use b::Thing;"),
        ("a.rs", "use crate::Thing; pub struct Other;"),
        ("b.rs", "pub struct Thing; impl Thing { fn of(_: crate::a::Other) {} }"),
    ]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("a uses b::Thing"), "{found:?}");
}

#[test]
fn a_function_of_a_parent_is_not_for_its_children_and_a_type_is() {
    let found = broken(&[
        ("lib.rs", "mod a;"),
        ("a.rs", "mod b; pub struct Shared; fn helper() {}"),
        ("a/b.rs", "use super::{Shared, helper}; fn of(_: Shared) { helper() }"),
    ]);
    assert_eq!(found, ["a::b calls the function helper of its parent a"]);
}

#[test]
fn tests_may_use_what_they_test() {
    let found = broken(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "pub fn of() {} #[cfg(test)] mod tests { use crate::b; use super::of; }"),
        ("b.rs", "use crate::a::of;"),
    ]);
    assert_eq!(found, <[&str; 0]>::default());
}

#[test]
fn a_crate_that_depends_on_a_layer_above_it_is_found() {
    let manifest = "[dependencies]\nanyhow = \"1\"\npneudrive-sim.workspace = true\n";
    let found = crates::not_below("pneudrive-controller", 0, manifest).expect("a manifest");
    assert_eq!(found, ["pneudrive-controller depends on pneudrive-sim, which is not a layer below it"]);
    assert!(crates::not_below("pneudrive", 3, manifest).expect("a manifest").is_empty());
}

#[test]
fn every_crate_keeps_the_structure() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    super::check(root).unwrap_or_else(|error| panic!("{error:#}"));
}
