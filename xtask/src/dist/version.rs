//! The version of the release: that of the workspace, which all other files repeat.

use std::fs;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{root, run};
use toml_edit::DocumentMut;

/// Workspaces of their own, and where they say their version.
const WORKSPACES: [(&str, &[&str]); 5] = [
    ("Cargo.toml", &["workspace", "package"]),
    ("firmware/Cargo.toml", &["workspace", "package"]),
    ("firmware/pico2/Cargo.toml", &["workspace", "package"]),
    ("hil-tests/flashed-image/Cargo.toml", &["package"]),
    ("host/python/Cargo.toml", &["package"]),
];

const CHANGELOG: &str = "CHANGELOG.md";
const CITATION: &str = "CITATION.cff";
const UNRELEASED: &str = "unreleased";

/// The version; every file names the same, and the oldest compiler that will do is the one that tests run with.
///
/// # Errors
/// With the file that says otherwise.
pub fn check() -> Result<String> {
    let [(first, keys), ..] = WORKSPACES;
    let version = value(&read(first)?, keys, "version").with_context(|| first.to_owned())?;
    let toolchain = value(&read("rust-toolchain.toml")?, &["toolchain"], "channel")?;
    for (file, keys) in WORKSPACES {
        let text = read(file)?;
        same(file, &version, &value(&text, keys, "version").with_context(|| file.to_owned())?)?;
        let oldest = value(&text, keys, "rust-version").with_context(|| file.to_owned())?;
        same(file, &toolchain, &format!("{oldest}.0"))?;
    }
    let document: DocumentMut = read(first)?.parse().context(first)?;
    let crates = document["workspace"]["dependencies"].as_table().context("workspace.dependencies")?;
    for (name, entry) in crates.iter().filter(|(_, entry)| entry.get("path").is_some()) {
        if let Some(named) = entry.get("version").and_then(|version| version.as_str()) {
            same(&format!("{first}: {name}"), &version, named)?;
        }
    }
    same(CHANGELOG, &version, heading(&read(CHANGELOG)?)?.0)?;
    same(CITATION, &version, field(&read(CITATION)?, "version").context(CITATION)?)?;
    Ok(version)
}

/// Dates the sections of the changelog and of the citation today, and commits that.
///
/// # Errors
/// When something is not committed, or the version was released before.
pub fn date() -> Result<()> {
    let (changelog, citation) = (read(CHANGELOG)?, read(CITATION)?);
    let (version, date) = heading(&changelog)?;
    ensure!(git(&["status", "--porcelain"])?.is_empty(), "commit all changes before a release");
    ensure!(
        date == UNRELEASED,
        "{CHANGELOG}: {version} was released on {date}; begin the section of the next version"
    );
    ensure!(git(&["tag", "--list", &tag_of(version)])?.is_empty(), "there is a tag {}", tag_of(version));
    let today = git(&["log", "-1", "--date=format:%Y-%m-%d", "--format=%cd"])?;
    let (version, dated) = (version.to_owned(), with_date(&changelog, &today)?);
    fs::write(root().join(CHANGELOG), dated).context(CHANGELOG)?;
    let citation: Vec<&str> = citation.lines().filter(|line| !line.starts_with("date-released:")).collect();
    fs::write(root().join(CITATION), format!("{}\ndate-released: {today}\n", citation.join("\n")))?;
    run(Command::new("git")
        .args(["commit", "--all", "--quiet", "-m"])
        .arg(format!("release: {version}"))
        .current_dir(root()))
}

/// Tags the last commit as the release.
///
/// # Errors
/// When git refuses.
pub fn tag() -> Result<()> {
    let version = check()?;
    let message = format!("pneudrive {version}");
    run(Command::new("git")
        .args(["tag", "--annotate", &tag_of(&version), "-m", &message])
        .current_dir(root()))
}

fn tag_of(version: &str) -> String {
    format!("v{version}")
}

fn with_date(changelog: &str, today: &str) -> Result<String> {
    let (version, date) = heading(changelog)?;
    let line = |date: &str| format!("\n## {version}, {date}\n");
    Ok(changelog.replacen(&line(date), &line(today), 1))
}

/// Version and date of the newest section.
fn heading(changelog: &str) -> Result<(&str, &str)> {
    let line = changelog.lines().find_map(|line| line.strip_prefix("## "));
    line.and_then(|line| line.split_once(", "))
        .with_context(|| format!("{CHANGELOG}: no heading \"## VERSION, DATE\""))
}

/// A field of the citation.
fn field<'a>(citation: &'a str, name: &str) -> Result<&'a str> {
    let line = citation.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
    line.with_context(|| format!("no line {name:?}"))
}

fn value(text: &str, keys: &[&str], key: &str) -> Result<String> {
    let document: DocumentMut = text.parse()?;
    let item = keys.iter().chain([&key]).try_fold(document.as_item(), |item, key| item.get(key));
    let item = item.and_then(|item| item.as_str()).with_context(|| format!("no {}.{key}", keys.join(".")))?;
    Ok(item.to_owned())
}

fn same(file: &str, wanted: &str, named: &str) -> Result<()> {
    ensure!(wanted == named, "{file} says {named}, and not {wanted}");
    Ok(())
}

fn read(file: &str) -> Result<String> {
    fs::read_to_string(root().join(file)).with_context(|| file.to_owned())
}

/// What git prints, without the end of the line.
///
/// # Errors
/// When it fails, with its own words.
pub fn git(arguments: &[&str]) -> Result<String> {
    let output = Command::new("git").args(arguments).current_dir(root()).output().context("git")?;
    ensure!(output.status.success(), "git: {}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANGES: &str =
        "# Changelog\n\nText.\n\n## 0.2.0, unreleased\n\nNew.\n\n## 0.1.0, 2026-11-01\n\nFirst.\n";

    #[test]
    fn every_file_names_the_version_of_the_workspace() {
        check().expect("one version");
    }

    #[test]
    fn the_newest_section_is_dated_and_no_other() {
        assert_eq!(heading(CHANGES).expect("a heading"), ("0.2.0", "unreleased"));
        let dated = with_date(CHANGES, "2026-12-24").expect("a heading");
        assert_eq!(dated, CHANGES.replace("unreleased", "2026-12-24"));
        assert!(heading("# Changelog\n\n## Unreleased\n").is_err());
    }
}
