//! The map of ARCHITECTURE.md, held against what cargo says of the crates.
//!
//! ```text
//! The map           every crate with its folder, and no other; a crate uses only crates that stand above it
//! Who uses whom     every use, and no other
//! workspaces        as many as the text says, each with a row
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo;
use serde::Deserialize;

/// The document.
const FILE: &str = "ARCHITECTURE.md";

/// Which crate uses which, by their folders.
pub type Uses = BTreeMap<String, BTreeSet<String>>;

/// What a document says of the crates.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Map {
    /// The crates, in their order.
    pub crates: Vec<String>,
    /// Those that use others.
    pub uses: Uses,
    /// The workspaces that are listed, and the word for how many there are.
    pub workspaces: Vec<String>,
    pub number: String,
}

impl Map {
    /// Reads the map of the project.
    ///
    /// # Errors
    /// When there is none, or a line of it is not of its form.
    pub fn of_project(root: &Path) -> Result<Map> {
        Map::read(&std::fs::read_to_string(root.join(FILE)).context(FILE)?)
    }

    /// Reads the map in a text.
    ///
    /// # Errors
    /// When there is none, or a line of it is not of its form.
    pub fn read(text: &str) -> Result<Map> {
        // A line that begins with a space continues the one before.
        let first = |line: &str| line.split(' ').next().filter(|name| !name.is_empty()).map(str::to_owned);
        let crates = block(text, "## The map")?.lines().filter_map(first).collect();
        let uses = block(text, "Who uses whom")?.lines().map(arrows).collect::<Result<_>>()?;
        let (before, table) =
            text.split_once(" workspaces:\n").context("it does not count the workspaces")?;
        let rows = table.trim_start().lines().take_while(|line| line.starts_with('|'));
        let name = |row: &str| Some(row.strip_prefix("| `")?.split_once('`')?.0.to_owned());
        let number = before.split_whitespace().next_back().unwrap_or_default().to_owned();
        Ok(Map { crates, uses, workspaces: rows.filter_map(name).collect(), number })
    }
}

/// The lines between the next two fences behind a heading.
fn block<'a>(text: &'a str, heading: &str) -> Result<&'a str> {
    let mut parts = text.split_once(heading).with_context(|| format!("no {heading}"))?.1.split("```\n");
    parts.nth(1).with_context(|| format!("no block below {heading}"))
}

/// A line `FOLDER -> FOLDER` or `FOLDER -> { FOLDER, FOLDER (a remark) }`.
fn arrows(line: &str) -> Result<(String, BTreeSet<String>)> {
    let (from, to) = line.split_once(" -> ").with_context(|| format!("no arrow in {line}"))?;
    let plain = |part: &str| part.split_once(" (").map_or(part, |(name, _)| name).trim().to_owned();
    let to = to.trim_start_matches('{').trim_end_matches('}').split(", ").map(plain).collect();
    Ok((from.trim().to_owned(), to))
}

/// What cargo says: all crates with what they use, and the folders of the workspaces.
///
/// # Errors
/// When cargo cannot be asked.
pub fn of_cargo(root: &Path) -> Result<(Uses, BTreeSet<String>)> {
    let mut uses = Uses::new();
    let workspaces = workspaces(root, root)?;
    for folder in &workspaces {
        uses.extend(uses_in(root, &root.join(folder))?);
    }
    Ok((uses, workspaces))
}

/// The folders that have a manifest with a workspace, `.` the root.
fn workspaces(root: &Path, folder: &Path) -> Result<BTreeSet<String>> {
    let mut found = BTreeSet::new();
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
    if manifest.lines().any(|line| line == "[workspace]") {
        found.insert(named(root, folder));
    }
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let is_hidden = |name: &str| name.starts_with('.') || name == "target" || name == "node_modules";
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !path.is_symlink() && !is_hidden(&name) {
            found.extend(workspaces(root, &path)?);
        }
    }
    Ok(found)
}

/// A folder as seen from the root.
fn named(root: &Path, folder: &Path) -> String {
    let name = folder.strip_prefix(root).unwrap_or(folder).to_string_lossy().replace('\\', "/");
    if name.is_empty() { ".".to_owned() } else { name }
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
}

/// `kind` is None of what the crate itself uses, and says `dev` of what its tests do.
#[derive(Deserialize)]
struct Dependency {
    kind: Option<String>,
    path: Option<PathBuf>,
}

fn uses_in(root: &Path, workspace: &Path) -> Result<Uses> {
    let mut metadata = cargo::in_folder(workspace, &["metadata", "--format-version", "1", "--no-deps"]);
    let output = metadata.output().context("cargo can't be started")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    let metadata: Metadata = serde_json::from_slice(&output.stdout)?;
    let own = |package: Package| {
        let used = package.dependencies.into_iter().filter(|used| used.kind.is_none());
        let folder = package.manifest_path.parent().map(|folder| named(root, folder));
        (folder.unwrap_or_default(), used.filter_map(|used| Some(named(root, &used.path?))).collect())
    };
    Ok(metadata.packages.into_iter().map(own).collect())
}

/// Where a map and the crates differ, and uses that go up the map.
pub fn broken(map: &Map, uses: &Uses, workspaces: &BTreeSet<String>) -> Vec<String> {
    let mut broken = Vec::new();
    let listed: BTreeSet<String> = map.crates.iter().cloned().collect();
    broken.extend(differing("The map", &listed, &uses.keys().cloned().collect()));
    let none = BTreeSet::new();
    for (folder, used) in uses {
        let said = map.uses.get(folder).unwrap_or(&none);
        broken.extend(differing(&format!("Who uses whom: {folder}"), said, used));
        let place = |name: &String| map.crates.iter().position(|listed| listed == name);
        let upward = used.iter().filter(|name| place(name) >= place(folder));
        broken.extend(
            upward.map(|name| format!("{folder} uses {name}, which does not stand above it in the map")),
        );
    }
    let gone = map.uses.keys().filter(|folder| !uses.contains_key(*folder));
    broken.extend(gone.map(|folder| format!("Who uses whom: there is no crate {folder}")));
    broken.extend(differing("workspaces", &map.workspaces.iter().cloned().collect(), workspaces));
    let words = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
    if words.get(workspaces.len()) != Some(&map.number.as_str()) {
        broken.push(format!("there are {} workspaces, and not {}", workspaces.len(), map.number));
    }
    broken
}

/// What the document says and is not so, and what is so and the document does not say.
fn differing(what: &str, said: &BTreeSet<String>, is: &BTreeSet<String>) -> Option<String> {
    let list = |names: Vec<&String>| names.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    let (over, under) = (list(said.difference(is).collect()), list(is.difference(said).collect()));
    (said != is).then(|| format!("{what}: too many [{over}], missing [{under}]"))
}
