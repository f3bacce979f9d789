//! `pneudrive thesis`.

use anyhow::Result;
use pneudrive_records::own_file::{GENERATOR, make_writable, refuse_to_replace};
use pneudrive_records::whole_file::put;
use pneudrive_thesis::{Exhibit, exhibits, golden, html, lasts, run, summary_line, within};

use super::figures;
use super::long_work::about;
use super::progress::Progress;
use crate::cli::Thesis as Arguments;
use crate::exit::Exit;
use crate::json;

/// Names of the files.
const PAGE: &str = "thesis.html";
const NUMBERS: &str = "thesis.toml";

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    let wanted = wanted(arguments.only.as_deref())?;
    make_writable(&arguments.out)?;
    let [page, numbers] = [PAGE, NUMBERS].map(|name| arguments.out.join(name));
    refuse_to_replace(&page, GENERATOR)?;
    refuse_to_replace(&numbers, golden::MARK)?;
    let starts = usize::from(arguments.starts);
    say!("{} tables, figures and sections of the thesis: {}", wanted.len(), about(lasts(&wanted, starts)));
    let mut progress = Progress::of("reproducing", "experiments");
    let shown = run(&wanted, starts, |done, all| progress.at(done as u64, all as u64));
    progress.done();
    let shown = shown?;
    json::figures(|| figures::thesis(&shown));
    put(&page, &html(&shown))?;
    put(&numbers, &golden::to_toml(&shown))?;
    say!("{}\n{}, {}", summary_line(&shown), page.display(), numbers.display());
    Ok(())
}

/// The exhibits to reproduce.
fn wanted(only: Option<&str>) -> Result<Vec<&'static Exhibit>> {
    let Some(section) = only else { return Ok(exhibits()) };
    let found = within(section);
    if found.is_empty() {
        let mut sections: Vec<&str> = exhibits().iter().map(|exhibit| exhibit.section).collect();
        sections.dedup();
        return Err(Exit::Usage.error(format!(
            "nothing of section {section} is reproduced; choose one of {}, or a section that contains them, such as 7.1",
            sections.join(", ")
        )));
    }
    Ok(found)
}
