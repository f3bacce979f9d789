//! Sources with a planted fault each.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use super::crates::{self, Map, Uses};
use super::module::Modules;
use super::{libraries, of_crate, programs, vocabulary};

/// A crate of these files.
fn planted(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join("src").join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    folder
}

/// What breaks a rule in a crate of these files.
fn broken(files: &[(&str, &str)]) -> Vec<String> {
    let folder = planted(files);
    of_crate(folder.path(), &vocabulary::words(root()).expect("the table and the list")).expect("sources")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace")
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
fn a_library_that_is_named_outside_of_its_module_is_found_and_none_in_tests() {
    let folder = planted(&[
        ("lib.rs", "mod rig; mod rigfile;"),
        ("rig.rs", "pub fn of(error: &toml_edit::TomlError) {} #[cfg(test)] mod tests { use uom::si; }"),
        ("rigfile.rs", "mod value;"),
        ("rigfile/value.rs", "use toml_edit::Item; use uom::si;"),
    ]);
    let modules = Modules::read(&folder.path().join("src")).expect("sources");
    let named = |library| libraries::in_crate(&modules, library, "rigfile");
    assert_eq!(named("toml_edit"), ["rig names toml_edit, which is for rigfile alone"]);
    assert_eq!(named("uom"), <[&str; 0]>::default());
}

/// A map of three crates in two workspaces.
const MAP: &str = "## The map\n```\nlaw   integers\nplant a cylinder\nboard an image\n```\nWho uses whom:\n```\nplant -> law\n\
                   board -> { law (its sample), plant }\n```\nThere are two workspaces:\n\n| `.` | all |\n| `board` | its target |\n";

/// What the crates of the map use; `planted` as well.
fn uses(planted: &[(&str, &str)]) -> Uses {
    let all = [("plant", "law"), ("board", "law"), ("board", "plant")];
    let mut uses = Uses::from([("law".to_owned(), BTreeSet::new())]);
    for (from, to) in all.iter().chain(planted) {
        uses.entry((*from).to_owned()).or_default().insert((*to).to_owned());
    }
    uses
}

/// What is wrong with a map of these crates.
fn wrong(text: &str, uses: &Uses) -> Vec<String> {
    let workspaces = [".", "board"].map(str::to_owned).into();
    crates::broken(&Map::read(text).expect("a map"), uses, &workspaces)
}

#[test]
fn a_map_that_says_what_cargo_says_is_right() {
    assert_eq!(wrong(MAP, &uses(&[])), <[&str; 0]>::default());
}

#[test]
fn a_planted_upward_arrow_is_found_even_if_the_map_has_it() {
    let planted = uses(&[("law", "board")]);
    let upward = "law uses board, which does not stand above it in the map";
    assert_eq!(wrong(MAP, &planted), ["Who uses whom: law: too many [], missing [board]", upward]);
    let with_it = MAP.replace("plant -> law", "law -> board\nplant -> law");
    assert_eq!(wrong(&with_it, &planted), [upward]);
}

#[test]
fn a_map_that_lacks_a_crate_or_an_arrow_or_has_too_many_is_wrong() {
    for (from, to, told) in [
        ("plant a cylinder\n", "", "The map: too many [], missing [plant]"),
        ("law   integers", "law\nlink", "The map: too many [link], missing []"),
        (", plant }", " }", "Who uses whom: board: too many [], missing [plant]"),
        ("plant -> law", "plant -> law\nlink -> law", "Who uses whom: there is no crate link"),
        ("| `board` | its target |", "", "workspaces: too many [], missing [board]"),
        ("two workspaces", "seven workspaces", "there are 2 workspaces, and not seven"),
    ] {
        let found = wrong(&MAP.replace(from, to), &uses(&[]));
        assert!(found.iter().any(|found| found == told), "{told}: {found:?}");
    }
}

#[test]
fn a_second_spelling_of_a_law_a_parameter_or_its_key_is_found_and_none_in_tests() {
    let found = broken(&[
        ("lib.rs", "mod law; mod gains; mod tests_of;"),
        ("law.rs", "words! { pub enum Mine { Profile = \"gain-profile\", Relay = \"relay\" } }"),
        (
            "gains.rs",
            "const ALL: [&str; 2] = [\"velocity_gain\", \"gain\"]; fn key() -> &'static str { \"controller.period_s\" }",
        ),
        ("tests_of.rs", "#[cfg(test)] mod tests { const LAW: &str = \"on-off\"; }"),
    ]);
    let told =
        |module: &str, word: &str| format!("{module} spells {word:?}, which has its home in the controller");
    let all =
        [told("gains", "velocity_gain"), told("gains", "controller.period_s"), told("law", "gain-profile")];
    assert_eq!(found, all);
}

#[test]
fn quotes_in_characters_and_raw_texts_hide_no_spelling() {
    let found = broken(&[(
        "lib.rs",
        "const QUOTE: char = '\"'; const RAW: &str = r#\"a \"b\" c\"#; const ESCAPED: &str = \"\\\"\"; const LAW: &str = \"pid\";",
    )]);
    assert_eq!(found, [" spells \"pid\", which has its home in the controller"]);
}

#[test]
fn a_file_of_tests_that_no_program_takes_in_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let manifest =
        "[package]\nname = \"a\"\nautotests = false\n[[test]]\nname = \"all\"\n[[test]]\nname = \"own\"\n";
    let tests = folder.path().join("tests");
    fs::create_dir(&tests).expect("a folder");
    fs::write(folder.path().join("Cargo.toml"), manifest).expect("a file");
    for (name, text) in [("all.rs", "mod one;"), ("own.rs", ""), ("one.rs", ""), ("lost.rs", "")] {
        fs::write(tests.join(name), text).expect("a file");
    }
    assert_eq!(programs::forgotten(folder.path()).expect("files"), ["tests/lost.rs is in no test program"]);
}

/// The profile inherits the levels of single crates from release, not only that of all others.
#[test]
fn what_release_optimises_less_is_optimised_in_full_by_dist() {
    let text = fs::read_to_string(root().join("Cargo.toml")).expect("the workspace");
    let cargo: toml_edit::DocumentMut = text.parse().expect("TOML");
    let crates = |profile: &str| cargo["profile"][profile]["package"].as_table_like().expect("crates");
    let level = |profile: &str, name: &str| crates(profile).get(name)?.get("opt-level")?.as_integer();
    let less: Vec<&str> = crates("release")
        .iter()
        .map(|(name, _)| name)
        .filter(|name| level("release", name) != Some(3))
        .collect();
    assert!(less.contains(&"pneudrive"), "{less:?}");
    for name in less {
        assert_eq!(level("dist", name), Some(3), "{name}");
    }
}

#[test]
fn every_crate_keeps_the_structure() {
    super::check(root()).unwrap_or_else(|error| panic!("{error:#}"));
}
