//! Types the first component of docs/howto/adding-a-component.md into a copy of the sources, and looks at what it does.

use std::fs;
use std::path::Path;
use std::process::Command;

use pneudrive_build::cargo::{built, in_folder, root, run};
use pneudrive_build::sources;

/// The page.
const PAGE: &str = "docs/howto/adding-a-component.md";

/// The folder of the component, and the file with the list that names it.
const MODELS: &str = "sim/src/component/friction";
const LIST: &str = "sim/src/component/friction.rs";

/// Its first fence of a language.
fn fence<'a>(page: &'a str, language: &str) -> &'a str {
    let begun = page.split_once(&format!("\n```{language}\n")).expect("a fence").1;
    begun.split_once("\n```").expect("its end").0
}

/// The text with each added line of a difference behind the line that the difference has before it.
fn with_lines(text: &str, difference: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let mut before = "";
    for line in difference.lines() {
        if let Some(added) = line.strip_prefix('+') {
            let place = lines.iter().position(|&one| one == before).expect(before);
            lines.insert(place + 1, added);
        } else {
            before = line.strip_prefix(' ').unwrap_or_default();
        }
    }
    lines.join("\n") + "\n"
}

/// What a command of the page prints, carried out by its program in a folder.
fn follow(program: &Path, folder: &Path, typed: &str) -> String {
    let output = Command::new(program).args(typed.split(' ')).current_dir(folder).output().expect("it runs");
    assert!(output.status.success(), "{typed}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Columns of a trace.
fn columns<const N: usize>(trace: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let header: Vec<&str> = trace.lines().next().expect("a header").split(',').collect();
    let places = names.map(|name| header.iter().position(|&one| one == name).expect(name));
    let rows = trace.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
    rows.map(|row| places.map(|place| row[place].parse().expect("a number"))).collect()
}

#[test]
fn lines_are_added_behind_those_that_a_difference_shows() {
    assert_eq!(with_lines("a\nb\nc\n", " a\n+1\n@@\n b\n+2"), "a\n1\nb\n2\nc\n");
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn the_first_component_of_the_page_can_be_typed_and_is_seen_in_a_trace() {
    let page = fs::read_to_string(root().join(PAGE)).expect(PAGE);
    // In the same folder each time: what is built for one of them takes much space.
    let (folder, target) =
        (built("first-component/sources").expect("a path"), built("first-component/built"));
    let _ = fs::remove_dir_all(&folder);
    sources::copy(&folder).expect("a copy");
    let typed = folder.join(MODELS).join("smooth.rs");
    assert!(page.contains("`smooth.rs`") && page.contains(&format!("`{MODELS}`")));
    fs::write(typed, fence(&page, "rust").to_owned() + "\n").expect("typed");
    let list = folder.join(LIST);
    let named = with_lines(&fs::read_to_string(&list).expect(LIST), fence(&page, "diff"));
    fs::write(list, named).expect("named");

    let target = target.expect("a path");
    let mut build = in_folder(&folder, &["build", "--quiet", "--package", "pneudrive"]);
    // Only the simulator is optimised: the commands of the page run for seconds.
    build.env("CARGO_TARGET_DIR", &target).env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    run(&mut build).expect("it is built");
    let program = target.join("debug").join(format!("pneudrive{}", std::env::consts::EXE_SUFFIX));
    let commands = page.lines().filter_map(|line| line.strip_prefix("cargo run --release -- "));
    let printed: Vec<String> = commands.map(|typed| follow(&program, &folder, typed)).collect();
    assert!(printed[0].contains("settles within 0.05 mm"), "{}", printed[0]);
    assert!(printed[1].contains("settles nowhere within 0.05 mm"), "{}", printed[1]);
    assert!(folder.join("report.html").exists());

    let trace = fs::read_to_string(folder.join("smooth/trace.csv")).expect("a trace");
    let rows = columns(&trace, ["velocity_m_s", "friction_n"]);
    let coulomb = rows.iter().map(|[_, friction]| *friction).fold(0.0, f64::max);
    for [velocity, friction] in rows.into_iter().filter(|[velocity, _]| *velocity > 0.0) {
        let closed = coulomb * (velocity / 0.01).tanh();
        assert!((friction - closed).abs() < 1e-6 * coulomb, "{velocity} m/s: {friction} N, not {closed} N");
    }
}
