//! `pneudrive completions` and `pneudrive man`: the command line's description for shells and for man.

use std::path::Path;

use anyhow::{Context, Result};
use clap::Command;
use clap_mangen::Man as Page;
use pneudrive_records::own_file::{make_writable, refuse_to_replace};
use pneudrive_records::whole_file::put;

use super::reference;
use crate::cli::{Completions, Man};
use crate::output::Stream;

/// The name of the program, and of its first page.
const NAME: &str = "pneudrive";

/// The start of each page, by which the program recognises those that it may replace.
const MARK: &str = ".ie \\n(.g .ds Aq \\(aq\n.el .ds Aq '\n.TH pneudrive";

/// The same of the pages in Markdown.
const MARKDOWN_MARK: &str = "<!-- pneudrive man --markdown -->";

pub(super) fn completions(arguments: &Completions, mut whole: Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut whole, NAME, &mut script);
    Stream::Output.note(Stream::Output.write(&script));
    Ok(())
}

pub(super) fn man(arguments: &Man, whole: Command) -> Result<()> {
    make_writable(&arguments.out)?;
    let mut command = whole.disable_help_subcommand(true);
    command.build();
    if arguments.markdown {
        return book(&arguments.out, &command);
    }
    let pages = pages(&command)?;
    let path = |name: &str| arguments.out.join(format!("{name}.1"));
    for (name, _) in &pages {
        refuse_to_replace(&path(name), MARK)?;
    }
    for (name, page) in &pages {
        put(&path(name), page)?;
    }
    say!("{}: {} pages, from {NAME}.1 on", arguments.out.display(), pages.len());
    Ok(())
}

/// The reference as the book takes it.
fn book(folder: &Path, command: &Command) -> Result<()> {
    let pages = reference::pages(command)
        .map(|(name, text)| (folder.join(name), format!("{MARKDOWN_MARK}\n\n{text}")));
    for (path, _) in &pages {
        refuse_to_replace(path, MARKDOWN_MARK)?;
    }
    for (path, text) in &pages {
        put(path, text)?;
        say!("{}", path.display());
    }
    Ok(())
}

/// The page of a command with its name, and the pages of its subcommands.
fn pages(command: &Command) -> Result<Vec<(String, String)>> {
    let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
    let mut page = Vec::new();
    Page::new(command.clone()).title(&name).render(&mut page).context("a page of man")?;
    let page = String::from_utf8(page).context("a page of man")?;
    let mut all = vec![(name, page)];
    for subcommand in command.get_subcommands() {
        all.extend(pages(subcommand)?);
    }
    Ok(all)
}
