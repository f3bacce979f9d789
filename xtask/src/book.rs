//! The book: the project's documents, with the reference that the program writes, as pages of mdBook. The pages keep the
//! places that they have in the project, so each of their links leads where it leads there.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use pneudrive_build::cargo::{self, built, run};

use crate::tools::CargoTool;

/// The program that makes it. It is under the MPL-2.0, a program of its own.
const MDBOOK: CargoTool = CargoTool { name: "mdbook", version: "0.5.4", features: &["search"] };

/// The table of contents, within the folder of documents.
const SUMMARY: &str = "docs/SUMMARY.md";

const CONFIG: &str = r#"[book]
title = "pneudrive"
language = "en"
src = "."

[build]
create-missing = false
# Without that of README.md, to which links would lead nowhere.
use-default-preprocessors = false

[output.html]
git-repository-icon = "fab-github"
"#;

/// Whether that program was built before.
#[must_use]
pub fn is_there() -> bool {
    MDBOOK.path().is_ok_and(|program| program.exists())
}

/// Builds that program from crates.io if it is not there.
///
/// # Errors
/// When it cannot be built.
pub fn ensure() -> Result<()> {
    MDBOOK.ensure().map(drop)
}

/// The folder of the pages where none is named.
///
/// # Errors
/// When the folder of what is built is not known.
pub fn usual_folder() -> Result<PathBuf> {
    built("book")
}

/// Makes the book.
///
/// # Errors
/// When a page cannot be made, is in no table of contents, or has a link that leads nowhere.
pub fn build(out: &Path) -> Result<()> {
    let sources = built("book-sources")?;
    gather(&sources)?;
    add_reference(&sources)?;
    run(Command::new(MDBOOK.path()?).arg("build").arg(&sources).arg("--dest-dir").arg(out))?;
    check_links(out)?;
    println!("{}", out.join("index.html").display());
    Ok(())
}

/// Copies the documents and their pictures to where they lie in the project.
fn gather(sources: &Path) -> Result<()> {
    if sources.exists() {
        fs::remove_dir_all(sources).with_context(|| sources.display().to_string())?;
    }
    let listed = Command::new("git")
        .args(["ls-files", "docs", "*.md", "*.ipynb", "LICENSE-*"])
        .current_dir(cargo::root())
        .output()?;
    ensure!(listed.status.success(), "git cannot list the documents");
    for path in String::from_utf8(listed.stdout)?.lines() {
        let (from, to) = (cargo::root().join(path), sources.join(path));
        fs::create_dir_all(to.parent().context("a folder")?)?;
        if path.starts_with("docs/") && path.ends_with(".md") {
            fs::write(to, with_tables(&from).with_context(|| path.to_owned())?)?;
        } else {
            fs::copy(from, to).with_context(|| path.to_owned())?;
        }
    }
    let summary = fs::read_to_string(sources.join(SUMMARY)).context(SUMMARY)?;
    // Its links lead from docs; mdBook reads it at the top.
    let summary = summary.replace("](", "](docs/").replace("](docs/../", "](");
    fs::write(sources.join("SUMMARY.md"), summary)?;
    // mdBook makes the contents itself.
    let readme =
        fs::read_to_string(sources.join("README.md"))?.replace(&format!("]({SUMMARY})"), "](toc.html)");
    fs::write(sources.join("README.md"), readme)?;
    fs::write(sources.join("book.toml"), CONFIG)?;
    Ok(())
}

/// A page with its tables. A table that a program writes, or a test holds, lies beside that; the page has a line with a link
/// to it and nothing else, in place of which the book has the table.
fn with_tables(page: &Path) -> Result<String> {
    let line = |line: &str| match table_of(line).map(|table| page.with_file_name(table)) {
        Some(table) => fs::read_to_string(&table).with_context(|| table.display().to_string()),
        None => Ok(format!("{line}\n")),
    };
    fs::read_to_string(page)?.lines().map(line).collect()
}

/// Where a line leads that is a link to Markdown outside of the documents: `[words](../../sim/tests/counts/work.md)`.
fn table_of(line: &str) -> Option<&str> {
    let (_, path) = line.strip_prefix('[')?.strip_suffix(')')?.split_once("](")?;
    (path.starts_with("../../") && path.ends_with(".md") && !path.contains('(')).then_some(path)
}

/// Puts what the program writes of itself behind the pages of the same names.
fn add_reference(sources: &Path) -> Result<()> {
    let written = built("book-reference")?;
    let out = written.to_str().context("a folder with a name in UTF-8")?;
    run(Command::new(cargo::command()?).args(["man", "--markdown", "--out", out]))?;
    for entry in fs::read_dir(&written)? {
        let entry = entry?;
        let page = sources.join("docs/reference").join(entry.file_name());
        let text = fs::read_to_string(&page).with_context(|| page.display().to_string())?;
        fs::write(&page, format!("{text}\n{}", fs::read_to_string(entry.path())?))?;
    }
    Ok(())
}

/// Every link within the book leads to a file of it, and every page but the one for printing is in the table of contents.
fn check_links(book: &Path) -> Result<()> {
    let mut dead = BTreeSet::new();
    for page in pages(book)? {
        let text = fs::read_to_string(&page)?;
        for link in ["href=\"", "src=\""].iter().flat_map(|before| text.split(before).skip(1)) {
            let link = link.split('"').next().unwrap_or_default();
            let file = link.split('#').next().unwrap_or_default();
            let is_outside = link.contains(':') || file.is_empty();
            if !is_outside && !page.with_file_name(file).exists() {
                dead.insert(format!("{}: {link}", page.strip_prefix(book)?.display()));
            }
        }
    }
    if !dead.is_empty() {
        bail!("links that lead nowhere: {}", Vec::from_iter(dead).join(", "));
    }
    Ok(())
}

/// The pages of a folder and of those in it. The page for printing repeats all others with links from the top, and the page of
/// an error is for servers.
fn pages(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if path.is_dir() {
            all.extend(pages(&path)?);
        } else if name.ends_with(".html") && !["print.html", "404.html", "toc.html"].contains(&name) {
            all.push(path);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_is_a_link_to_a_table_is_replaced_by_it() {
        assert_eq!(table_of("[The table](../../sim/tests/table.md)"), Some("../../sim/tests/table.md"));
        for other in ["See [it](../../sim/a.md)", "[it](../howto/a.md)", "[a](../../a.md), [b](../../b.md)"] {
            assert_eq!(table_of(other), None, "{other}");
        }
        let page = with_tables(&cargo::root().join("docs/reference/counts.md")).expect("a page");
        assert!(page.contains("\n| servo-a | ") && !page.contains("/work.md)"), "{page}");
    }
}
