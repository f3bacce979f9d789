//! Checks the documents' statements about files, links and programs.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use pneudrive_build::cargo::root;

/// A document: its path in the project, and its text.
struct Page {
    path: String,
    text: String,
}

impl Page {
    fn of(path: &str) -> Page {
        let text = fs::read_to_string(root().join(path)).unwrap_or_else(|why| panic!("{path}: {why}"));
        Page { path: path.to_owned(), text }
    }

    /// The texts between backticks within a line.
    fn code(&self) -> impl Iterator<Item = &str> {
        self.text.lines().flat_map(|line| line.split('`').skip(1).step_by(2))
    }

    /// Where its links lead.
    fn links(&self) -> impl Iterator<Item = &str> {
        self.text.split("](").skip(1).filter_map(|rest| rest.split(')').next())
    }

    /// Its headings, as links name them.
    fn headings(&self) -> BTreeSet<String> {
        let headings = self.text.lines().filter_map(|line| line.strip_prefix('#'));
        let kept = |one: char| one.is_alphanumeric() || one == '-' || one == ' ';
        headings
            .map(|line| line.trim_start_matches('#').trim().to_lowercase())
            .map(|line| line.chars().filter(|&one| kept(one)).collect::<String>().replace(' ', "-"))
            .collect()
    }

    /// The words that follow these in calls of cargo: `named("--example ")` gives the names of examples.
    fn named<'a>(&'a self, before: &'a str) -> impl Iterator<Item = &'a str> {
        let calls = self.text.lines().filter_map(|line| Some(line.split_once("cargo ")?.1));
        calls.flat_map(move |call| call.split(before).skip(1)).map(|rest| {
            let end = rest.find(|one: char| !(one.is_alphanumeric() || one == '_' || one == '-'));
            &rest[..end.unwrap_or(rest.len())]
        })
    }
}

/// The documents of a folder and of those in it.
fn inside(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder").filter_map(Result::ok);
    let of = |entry: fs::DirEntry| {
        let path = format!("{folder}/{}", entry.file_name().to_str().expect("a name"));
        match entry.path().is_dir() {
            true => inside(&path),
            false => Vec::from_iter(path.ends_with(".md").then_some(path)),
        }
    };
    entries.flat_map(of).collect()
}

/// The documents that speak of today's sources.
fn pages() -> Vec<Page> {
    let others = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "hil-tests/flashed-image/README.md"];
    let boards = ["firmware/nucleo-f446/README.md", "firmware/pico2/README.md", "host/python/README.md"];
    others
        .into_iter()
        .chain(boards)
        .map(str::to_owned)
        .chain(inside("docs"))
        .map(|path| Page::of(&path))
        .collect()
}

/// `a/{b,c}.rs` as `a/b.rs` and `a/c.rs`.
fn expanded(path: &str) -> Vec<String> {
    let Some((before, (inside, after))) =
        path.split_once('{').and_then(|(before, rest)| Some((before, rest.split_once('}')?)))
    else {
        return vec![path.to_owned()];
    };
    inside.split(',').flat_map(|one| expanded(&format!("{before}{one}{after}"))).collect()
}

/// Whether a text names a file or folder of the project: it begins with a folder that the project has.
fn is_path(text: &str) -> bool {
    let first = text.split('/').next().expect("a first part");
    let is_plain =
        !text.contains(|one: char| one.is_whitespace() || "<*$".contains(one)) && !text.contains("...");
    text.contains('/') && !first.is_empty() && first != "target" && is_plain && root().join(first).is_dir()
}

/// The files below a folder of this name, for every crate: `examples`, `tests`, `benches`.
fn programs(folder: &Path, of: &str, found: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).expect("a folder").filter_map(Result::ok) {
        let (path, name) = (entry.path(), entry.file_name().into_string().expect("a name"));
        if !path.is_dir() || name == "target" || name.starts_with('.') {
            continue;
        }
        if name == of {
            let inside = fs::read_dir(&path).expect("a folder").filter_map(Result::ok);
            found.extend(inside.filter_map(|one| Some(one.path().file_stem()?.to_str()?.to_owned())));
        }
        programs(&path, of, found);
    }
}

#[test]
fn every_file_and_folder_that_a_document_names_is_there() {
    let mut missing = Vec::new();
    let mut count = 0;
    for page in pages() {
        for path in page.code().filter(|text| is_path(text)).flat_map(expanded) {
            count += 1;
            if !root().join(&path).exists() {
                missing.push(format!("{}: {path}", page.path));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
    assert!(count > 200, "{count} paths were looked at");
}

#[test]
fn every_link_leads_to_a_file_and_a_heading_of_it() {
    let mut dead = Vec::new();
    for page in pages() {
        for link in page.links().filter(|link| !link.contains("://")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let here = Path::new(&page.path);
            let to = if file.is_empty() { here.to_owned() } else { here.with_file_name(file) };
            let is_there = root().join(&to).exists();
            let has = || Page::of(&to.to_string_lossy()).headings().contains(heading);
            if !is_there || (!heading.is_empty() && !has()) {
                dead.push(format!("{}: {link}", page.path));
            }
        }
    }
    assert!(dead.is_empty(), "{dead:#?}");
}

#[test]
fn every_page_is_in_the_contents_of_the_book() {
    let contents = Page::of("docs/SUMMARY.md");
    let listed: BTreeSet<String> = contents.links().map(|link| format!("docs/{link}")).collect();
    let mut missing = inside("docs");
    missing.retain(|page| page != "docs/SUMMARY.md" && !listed.contains(page));
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn every_example_and_test_program_that_a_document_calls_is_there() {
    let mut missing = Vec::new();
    for (before, folder) in [("--example ", "examples"), ("--test ", "tests"), ("--bench ", "benches")] {
        let mut found = BTreeSet::new();
        programs(root(), folder, &mut found);
        for page in pages() {
            let unknown = page.named(before).filter(|name| !found.contains(*name));
            missing.extend(unknown.map(|name| format!("{}: {before}{name}", page.path)));
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn the_map_has_every_workspace_and_no_other() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("a manifest");
    let manifest: toml_edit::DocumentMut = manifest.parse().expect("TOML");
    let apart = manifest["workspace"]["exclude"].as_array().expect("the folders that are excluded");
    let mut workspaces: BTreeSet<&str> = apart.iter().filter_map(|folder| folder.as_str()).collect();
    workspaces.insert(".");
    let page = Page::of("ARCHITECTURE.md");
    let table = page.text.split("| workspace |").nth(1).expect("the table of workspaces");
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let listed: BTreeSet<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
    assert_eq!(listed, workspaces);
}
