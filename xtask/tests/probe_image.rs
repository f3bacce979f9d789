//! The probe on the real compiler: the controller's image is clean, and a guilty one is caught.

use std::path::Path;
use std::sync::Mutex;

use xtask::forbidden::Kind;
use xtask::image::{Finding, Image};
use xtask::probe::{self, Variant};
use xtask::stack::Stack;

/// One build at a time, since a build may install the target.
static BUILD: Mutex<()> = Mutex::new(());

fn findings(folder: &str, variant: Variant) -> Vec<Finding> {
    image(folder, variant).findings()
}

fn image(folder: &str, variant: Variant) -> Image {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let path = {
        let _one = BUILD.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        probe::build(&folder, variant).unwrap_or_else(|error| panic!("no image to judge: {error:#}"))
    };
    let image = probe::read(&path).unwrap_or_else(|error| panic!("{error:#}"));
    assert!(image.flash_bytes > 1000, "only {} bytes: the controller is not in it", image.flash_bytes);
    image
}

#[test]
fn the_controller_has_no_panic_no_float_and_no_division_routine() {
    assert_eq!(findings("honest", Variant::Honest), []);
}

#[test]
fn each_thing_that_must_not_be_there_is_caught_where_it_is() {
    let findings = findings("guilty", Variant::Guilty);
    let caught = |kind, function: &str| {
        findings.iter().any(|finding| {
            finding.kind == kind
                && (finding.what.ends_with(function) || finding.callers.iter().any(|c| c == function))
        })
    };
    assert!(caught(Kind::Panic, "probe_guilty_index"), "{findings:#?}");
    assert!(caught(Kind::FloatInstruction, "probe_guilty_float"), "{findings:#?}");
    assert!(caught(Kind::SoftFloat, "probe_guilty_soft_float"), "{findings:#?}");
    assert!(caught(Kind::Division, "probe_guilty_division"), "{findings:#?}");
}

#[test]
fn what_a_function_reaches_is_followed_to_the_panic() {
    let image = image("guilty", Variant::Guilty);
    let reaches_panic = |function| {
        let (reached, indirect) = image.reached_from(function);
        assert!(reached.contains(function) && indirect.is_empty(), "{reached:?} {indirect:?}");
        reached.iter().any(|name| Kind::of_symbol(name) == Some(Kind::Panic))
    };
    assert!(reaches_panic("probe_guilty_index"));
    assert!(!reaches_panic("probe_sample"));
}

#[test]
fn the_stack_of_a_sample_has_a_bound_and_what_calls_itself_has_none() {
    let image = image("guilty", Variant::Guilty);
    let sample = Stack::of(&image, "probe_sample").expect("a bound");
    let deepest = sample.path.last().expect("at least the function itself");
    assert_eq!(sample.path.first().map(String::as_str), Some("probe_sample"));
    assert!(sample.bytes >= Stack::of(&image, deepest).expect("a bound").bytes, "{sample:?}");
    assert!((40..1500).contains(&sample.bytes) && sample.indirect.is_empty(), "{sample:?}");

    let error = Stack::of(&image, "probe_guilty_recursion").expect_err("no bound").to_string();
    assert!(error.contains("probe_guilty_recursion calls itself"), "{error}");
    let called = Stack::of(&image, "probe_guilty_call").expect("what is seen of it");
    assert_eq!(called.indirect.len(), 1, "{called:?}");
    let error = Stack::of(&image, "no_such_function").expect_err("nothing").to_string();
    assert!(error.contains("no function no_such_function"), "{error}");
}
