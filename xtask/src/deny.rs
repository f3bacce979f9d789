//! Other people's code: whether its licences and its sources are those that `deny.toml` allows, and whether advisories are
//! known of it.
//!
//! Licences and sources are judged here, from `cargo metadata`, in seconds and without a program that would have to be
//! built. Advisories are cargo-deny's, where it is installed and reaches their database.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo;
use serde::Deserialize;
use spdx::{Expression, Licensee};
use toml_edit::DocumentMut;

use crate::tally::Tally;

/// The one registry that code comes from.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The file with the allowed licences and sources.
const FILE: &str = "deny.toml";

/// The last line of cargo-deny when it knows of a weakness. Without that line it has failed before it could look.
const VERDICT: &str = "advisories FAILED";

/// The folders of the workspaces whose programs and images are given away. That of the flashed
/// image, whose emulator is under the GPL-2, runs tests alone.
const SHIPPED: [&str; 4] = ["", "firmware", "firmware/pico2", "host/python"];

/// A package, as cargo reports it.
#[derive(Clone, Debug, Deserialize)]
struct Package {
    name: String,
    version: String,
    license: Option<String>,
    source: Option<String>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

/// Judges licences and sources of all that is shipped; looks for advisories where that can be done.
pub fn check(tally: &mut Tally) {
    for folder in SHIPPED {
        let name = if folder.is_empty() { "the root workspace" } else { folder };
        tally.check(&format!("licences and sources of {name}"), || judge(&cargo::root().join(folder)));
    }
    match advisories(cargo::root()) {
        Ok(Advisories::None) => tally.check("advisories", || Ok(())),
        Ok(Advisories::Known(report)) => tally.check("advisories", || Err(anyhow::anyhow!(report))),
        Ok(Advisories::OutOfReach(why)) => tally.leave_out(format!("advisories were not looked up: {why}")),
        Err(error) => tally.check("advisories", || Err(error)),
    }
}

fn judge(workspace: &Path) -> Result<()> {
    let rules = std::fs::read_to_string(cargo::root().join(FILE)).context(FILE)?;
    let allowed = allowed(&rules)?;
    let packages = packages(workspace)?;
    let wrong: Vec<String> = packages.iter().filter_map(|package| objection(package, &allowed)).collect();
    println!("{} packages", packages.len());
    ensure!(wrong.is_empty(), "{}", wrong.join("; "));
    Ok(())
}

/// The licences that the file allows.
fn allowed(rules: &str) -> Result<Vec<Licensee>> {
    let rules: DocumentMut = rules.parse().context(FILE)?;
    let names = rules.get("licenses").and_then(|licences| licences.get("allow")?.as_array());
    let names = names.with_context(|| format!("{FILE}: licenses.allow is missing"))?;
    names
        .iter()
        .map(|name| {
            let name = name.as_str().with_context(|| format!("{FILE}: {name} is no text"))?;
            Licensee::parse(name).with_context(|| format!("{FILE}: {name} is no licence"))
        })
        .collect()
}

fn packages(workspace: &Path) -> Result<Vec<Package>> {
    let mut metadata = cargo::in_folder(workspace, &["metadata", "--format-version", "1", "--locked"]);
    let output = metadata.output().context("cargo can't be started")?;
    ensure!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr).trim());
    let metadata: Metadata = serde_json::from_slice(&output.stdout).context("cargo metadata")?;
    Ok(metadata.packages)
}

/// Why a package is not allowed; None if it is.
fn objection(package: &Package, allowed: &[Licensee]) -> Option<String> {
    let Package { name, version, license, source } = package;
    // The project's own.
    let source = source.as_deref()?;
    let what = if source != REGISTRY {
        format!("comes from {source}")
    } else if let Some(license) = license {
        match Expression::parse_mode(license, spdx::ParseMode::LAX) {
            Ok(terms) if terms.evaluate(|term| allowed.iter().any(|one| one.satisfies(term))) => return None,
            Ok(_) => format!("is under {license}, which {FILE} does not allow"),
            Err(_) => format!("is under {license}, which is no licence expression"),
        }
    } else {
        "names no licence".to_owned()
    };
    Some(format!("{name} {version} {what}"))
}

/// The known weaknesses of the code.
#[derive(Debug, PartialEq, Eq)]
enum Advisories {
    None,
    Known(String),
    OutOfReach(String),
}

fn advisories(root: &Path) -> Result<Advisories> {
    let mut deny = cargo::in_folder(root, &["deny", "--workspace", "check", "advisories"]);
    let output = deny.output().context("cargo can't be started")?;
    Ok(read(output.status.success(), &String::from_utf8_lossy(&[output.stdout, output.stderr].concat())))
}

/// The verdict of a report of cargo-deny.
fn read(is_content: bool, report: &str) -> Advisories {
    if is_content {
        Advisories::None
    } else if report.contains(VERDICT) {
        Advisories::Known(report.trim().to_owned())
    } else if report.contains("no such command") {
        Advisories::OutOfReach("there is no cargo-deny (cargo install cargo-deny --locked)".to_owned())
    } else {
        Advisories::OutOfReach(report.lines().next().unwrap_or("cargo-deny says nothing").to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(license: Option<&str>, source: Option<&str>) -> Package {
        let [license, source] = [license, source].map(|text| text.map(str::to_owned));
        Package { name: "gears".to_owned(), version: "1.2.3".to_owned(), license, source }
    }

    fn objection_to(license: &str) -> Option<String> {
        let allowed = allowed("[licenses]\nallow = [\"MIT\", \"MPL-2.0\"]").expect("two licences");
        objection(&package(Some(license), Some(REGISTRY)), &allowed)
    }

    #[test]
    fn a_package_needs_one_licence_that_is_allowed_or_all_of_those_that_hold_together() {
        assert_eq!(objection_to("MIT"), None);
        assert_eq!(objection_to("GPL-2.0 OR MIT"), None);
        assert_eq!(objection_to("MIT/Apache-2.0"), None, "as old manifests write it");
        let refused = |license| objection_to(license).is_some_and(|why| why.contains("gears 1.2.3"));
        assert!(refused("GPL-2.0") && refused("MIT AND GPL-3.0-only") && refused("as you like"));
    }

    #[test]
    fn a_package_without_a_licence_or_from_elsewhere_is_refused() {
        let allowed = allowed("[licenses]\nallow = [\"MIT\"]").expect("a licence");
        assert!(objection(&package(None, Some(REGISTRY)), &allowed).is_some());
        assert!(objection(&package(Some("MIT"), Some("git+https://example.org/gears")), &allowed).is_some());
        assert!(objection(&package(None, None), &allowed).is_none(), "the project's own");
    }

    #[test]
    fn advisories_that_could_not_be_looked_up_are_neither_none_nor_known() {
        assert_eq!(read(true, "advisories ok"), Advisories::None);
        assert!(matches!(
            read(false, "error[vulnerability]: gears\nadvisories FAILED"),
            Advisories::Known(_)
        ));
        let unreached = read(false, "[ERROR] the database cannot be fetched\nCaused by: no network");
        assert_eq!(unreached, Advisories::OutOfReach("[ERROR] the database cannot be fetched".to_owned()));
        assert!(matches!(read(false, "error: no such command: `deny`"), Advisories::OutOfReach(_)));
    }

    #[test]
    fn what_the_project_ships_is_allowed_by_its_own_file() {
        judge(cargo::root()).expect("licences and sources of the root workspace");
    }
}
