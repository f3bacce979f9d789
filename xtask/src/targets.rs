//! Builds for other systems: the command for Windows, with all its features. [`web`](crate::web) builds the designer
//! for a browser.

use anyhow::Result;
use pneudrive_build::cargo::{self, in_root, run};

use crate::tally::Tally;

/// Packages that must compile for a target.
struct Other {
    target: &'static str,
    what: &'static str,
    packages: &'static [&'static str],
}

const OTHERS: [Other; 1] =
    [Other { target: "x86_64-pc-windows-gnu", what: "the command for Windows", packages: &["pneudrive"] }];

/// Checks all of them; a target that is missing is installed, or it is a failure.
pub fn check_all(tally: &mut Tally) {
    for other in &OTHERS {
        tally.check(other.what, || {
            cargo::ensure_target(other.target)?;
            other.check()
        });
    }
}

/// What is not compiled, as its target is not installed.
#[must_use]
pub fn missing() -> Option<String> {
    let missing = OTHERS.iter().find(|other| !matches!(cargo::has_target(other.target), Ok(true)))?;
    let (what, target) = (missing.what, missing.target);
    Some(format!("{what} is not compiled, as there is no target {target} (rustup target add {target})"))
}

impl Other {
    fn check(&self) -> Result<()> {
        let packages: Vec<&str> = self.packages.iter().flat_map(|name| ["--package", name]).collect();
        run(&mut in_root(&[&["check", "--target", self.target, "--all-features"], &packages[..]].concat()))
    }
}
