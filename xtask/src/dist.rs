//! A release, made from a commit alone: packages of the crates, the wheel, images of the boards, what they are made of, and
//! sums of all files.
//!
//! | module | holds |
//! |---|---|
//! | `version` | the version, and that all files name the same one |
//! | `source` | the commit, checked out where every release is made |
//! | `images` | the images of the boards, in the files that programmers take |
//! | `wheel` | the Python package for Linux |
//! | `materials` | bills of materials, and notices of other people's code |
//! | `sums` | the SHA-256 of each file |
//!
//! The same commit and the same tools make the same bytes, whoever makes them: the sources lie in one folder, the folders of
//! cargo and of the toolchain have other names in the programs, and the only date is that of the commit.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use pneudrive_build::cargo::built;

use crate::tally::Tally;
use source::Source;

mod images;
mod materials;
mod packages;
mod source;
mod sums;
mod version;
mod wheel;

/// The options of a release.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// Make the release twice, and compare the bytes.
    pub twice: bool,
    /// Date the changelog before, in a commit of its own, and tag that commit once all is made.
    pub tag: bool,
}

/// Makes the release of the last commit in `out`.
pub fn make(tally: &mut Tally, out: Option<PathBuf>, extras: Extras) {
    tally.check("one version everywhere", || version::check().map(drop));
    if extras.tag && tally.failed() == 0 {
        tally.check("date of the release", version::date);
    }
    if tally.failed() == 0 {
        let made = out.map_or_else(|| built("dist"), Ok).and_then(|out| all(tally, &out, extras));
        if let Err(error) = made {
            tally.check("release", || Err(error));
        }
    }
    if extras.tag && tally.failed() == 0 {
        tally.check("tag", version::tag);
    }
}

/// Checks that all files state the same version, and that each library can be packaged: the checks of a release that take
/// seconds.
pub fn check(tally: &mut Tally) {
    tally.check("packages of the libraries", || {
        version::check()?;
        packages::list()
    });
}

fn all(tally: &mut Tally, out: &Path, extras: Extras) -> Result<()> {
    let source = Source::of_head()?;
    let folder = out.join(source.name());
    make_once(tally, &source, &folder)?;
    if extras.twice && tally.failed() == 0 {
        let again = out.join(format!("{}-again", source.name()));
        make_once(tally, &source, &again)?;
        tally.check("the same bytes twice", || same(&folder, &again));
    }
    println!("{}", folder.display());
    Ok(())
}

fn make_once(tally: &mut Tally, source: &Source, out: &Path) -> Result<()> {
    if out.exists() {
        fs::remove_dir_all(out).with_context(|| out.display().to_string())?;
    }
    fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    source.check_out()?;
    tally.check("crates", || packages::make(source, &out.join("crates")));
    tally.check("images of the boards", || images::make(source, &out.join("firmware")));
    tally.check("wheel", || wheel::make(source, &out.join("python")));
    tally.check("bills of materials and notices", || materials::make(source, &out.join("materials")));
    tally.check("sums", || {
        for name in ["CHANGELOG.md", "CITATION.cff", "LICENSE-APACHE", "LICENSE-MIT"] {
            fs::copy(source.folder().join(name), out.join(name)).with_context(|| name.to_owned())?;
        }
        fs::write(out.join("BUILD.txt"), source.described()?)?;
        sums::write(out)
    });
    Ok(())
}

fn same(one: &Path, other: &Path) -> Result<()> {
    let (one, other) = (sums::read(one)?, sums::read(other)?);
    let differing: Vec<&str> =
        one.iter().filter(|line| !other.contains(line)).filter_map(|line| line.split("  ").nth(1)).collect();
    ensure!(one.len() == other.len(), "{} files and {}", one.len(), other.len());
    if !differing.is_empty() {
        bail!("made twice, these differ: {}", differing.join(", "));
    }
    println!("{} files are the same", one.len());
    Ok(())
}
