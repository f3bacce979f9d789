//! A page of this program: notes, tables and graphs, to be read in a browser without a network, or printed.
//!
//! A plotting library beside the page draws the graphs: they zoom, and each can be saved as SVG or PNG.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod figure;
mod library;
mod plot;

use std::path::Path;

use anyhow::Result;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::run_folder::Numbered;
use pneudrive_records::whole_file::{folder_of, is_device, put};

pub use figure::{COLOURS, Curve, Figure, Look, Panel, Shade};
pub use library::Library;
use library::packed;

/// A page in the making.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// The most important remarks for the reader; plain text, a paragraph each.
    pub notes: Vec<String>,
    /// Figures in numbers, before the graphs.
    pub tables: Vec<Table>,
    /// The graphs.
    pub figures: Vec<Figure>,
    /// Number and date of the runs that the graphs show (thesis I.1 (b)): below each graph, also of a saved one. May be empty.
    pub runs: String,
}

/// A table with a heading; its cells are plain text. One that names a page beside this one, such as
/// `impulse.html`, leads there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Its topic.
    pub heading: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Its rows, a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Page {
    /// The same page of a run that is being written.
    #[must_use]
    pub fn of_run(&self, run: &Numbered) -> Page {
        Page { runs: run.to_string(), ..self.clone() }
    }

    /// Writes the page, and its library where it needs one beside it.
    ///
    /// # Errors
    /// When a file cannot be written or is not of this program, or the plotting library has no script.
    pub fn write(&self, path: &Path, library: Library) -> Result<()> {
        self.write_with(path, None, library)
    }

    /// Writes the page with one figure after its first note, before everything else: the figure that answers the
    /// page's question.
    ///
    /// # Errors
    /// As [`Page::write`].
    pub fn write_led_by(&self, path: &Path, lead: &Figure, library: Library) -> Result<()> {
        self.write_with(path, Some(lead), library)
    }

    fn write_with(&self, path: &Path, lead: Option<&Figure>, library: Library) -> Result<()> {
        refuse_to_replace(path, GENERATOR)?;
        let page = self.text("", lead, library)?;
        if self.has_graphs(lead) && !is_device(path) {
            library.put_beside(folder_of(path))?;
        }
        put(path, &page)
    }

    /// The page for a file in `folder`, where its library is put if it needs one; `mark` goes into its head.
    ///
    /// # Errors
    /// As [`Page::write`].
    pub fn text_in(&self, folder: &Path, mark: &str, library: Library) -> Result<String> {
        if self.has_graphs(None) {
            library.put_beside(folder)?;
        }
        self.text(mark, None, library)
    }

    fn has_graphs(&self, lead: Option<&Figure>) -> bool {
        !self.figures.is_empty() || lead.is_some()
    }

    /// The page; `lead` stands before the tables.
    fn text(&self, mark: &str, lead: Option<&Figure>, library: Library) -> Result<String> {
        let title = escaped(&self.title);
        let (scripts, without) = match self.has_graphs(lead) {
            true => self.scripts(lead, library)?,
            false => Default::default(),
        };
        let content = self.content(lead, &without);
        Ok(format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{GENERATOR}{mark}\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{content}{scripts}</body>\n</html>\n"
        ))
    }

    /// The library, the data of the graphs, and the script that draws them; or the substitute for graphs without a
    /// library.
    fn scripts(&self, lead: Option<&Figure>, library: Library) -> Result<(String, String)> {
        let (element, without) = library.element()?;
        let graphs =
            packed("graphs", &plot::plots(lead.into_iter().chain(&self.figures), &self.runs).to_string())?;
        Ok((format!("{element}{graphs}<script>\n{DRAW}</script>\n"), without))
    }

    /// The first note, the lead, the other notes, tables and figures.
    fn content(&self, lead: Option<&Figure>, without: &str) -> String {
        let note = |note: &String| format!("<p>{}</p>\n", escaped(note));
        let (first, others) = self.notes.split_at(self.notes.len().min(1));
        let lead = lead.map(|figure| section(figure, without));
        let tables = self.tables.iter().map(Table::to_html);
        let figures = self.figures.iter().map(|figure| section(figure, without));
        first
            .iter()
            .map(note)
            .chain(lead)
            .chain(others.iter().map(note))
            .chain(tables)
            .chain(figures)
            .collect()
    }
}

impl Table {
    /// A table of these rows.
    pub fn new<C: Into<String>>(
        heading: impl Into<String>,
        columns: impl IntoIterator<Item = C>,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Table {
        Table {
            heading: heading.into(),
            columns: columns.into_iter().map(Into::into).collect(),
            rows: rows.into_iter().collect(),
        }
    }

    /// The table as lines of text, its columns aligned.
    #[must_use]
    pub fn to_text(&self) -> String {
        let lines: Vec<&Vec<String>> = std::iter::once(&self.columns).chain(&self.rows).collect();
        let width = |column: usize| {
            lines.iter().filter_map(|line| line.get(column)).map(|cell| cell.chars().count()).max()
        };
        let widths: Vec<usize> = (0..self.columns.len()).filter_map(width).collect();
        let line_of = |line: &Vec<String>| {
            let cells = line.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
                if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        lines.into_iter().map(line_of).collect()
    }

    /// Whether a column holds words, which begin at its left; figures end at its right.
    fn is_of_words(&self, column: usize) -> bool {
        let is_figure = |text: &String| text.starts_with(|c: char| c == '-' || c.is_ascii_digit());
        let mut cells = self.rows.iter().filter_map(|row| row.get(column)).filter(|text| !text.is_empty());
        cells.any(|text| !is_figure(text))
    }

    fn to_html(&self) -> String {
        let words: Vec<bool> = (0..self.columns.len()).map(|column| self.is_of_words(column)).collect();
        let cell = |tag: &str, (text, words): (&String, &bool)| {
            let class = if *words { " class=\"words\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", linked(text))
        };
        let row = |tag: &str, cells: &[String]| {
            let cells: String = cells.iter().zip(&words).map(|pair| cell(tag, pair)).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = self.rows.iter().map(|cells| row("td", cells)).collect();
        format!("<h2>{}</h2>\n<table>\n{}{rows}</table>\n", escaped(&self.heading), row("th", &self.columns))
    }
}

/// The place of a figure, with its heading and its save button; `without` is the text without a library.
fn section(figure: &Figure, without: &str) -> String {
    let heading = match figure.heading.as_str() {
        "" => String::new(),
        heading => format!("<h2>{}</h2>\n", escaped(heading)),
    };
    let axes: Vec<String> = figure.panels.iter().map(|panel| quoted(&panel.title)).collect();
    let axes = axes.join("; ");
    format!(
        "<section>\n{heading}<figure aria-label=\"{axes}\" data-without=\"{without}\"><div></div><figcaption>save as </figcaption></figure>\n</section>\n"
    )
}

/// A page beside this one as a link, other text as it is.
fn linked(text: &str) -> String {
    match text.strip_suffix(".html") {
        Some(name) if !name.contains([' ', '/']) => format!("<a href=\"{0}.html\">{0}</a>", quoted(name)),
        _ => escaped(text),
    }
}

/// A text with the characters that mean something in HTML escaped.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The same between quotation marks.
fn quoted(text: &str) -> String {
    escaped(text).replace('"', "&quot;")
}

/// How the pages of this program look, as CSS.
pub const STYLE: &str = include_str!("style.css");

const DRAW: &str = include_str!("draw.js");

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        let curve = Curve::new("a<b", vec![0.0, 1.0], vec![4.125, f64::NAN]);
        Page {
            title: "step & hold".to_owned(),
            notes: vec!["first".to_owned()],
            tables: vec![Table::new(
                "moves",
                vec!["move".to_owned(), "mm".to_owned()],
                vec![vec!["1".to_owned(), "60.00".to_owned()]],
            )],
            figures: vec![Figure::over_time(vec![Panel::new("position, mm", vec![curve])])],
            runs: String::new(),
        }
    }

    fn html(page: &Page) -> String {
        page.text("", None, Library::Linked).expect("a page")
    }

    #[test]
    fn a_page_asks_for_nothing_but_the_library_beside_it() {
        let html = html(&page());
        assert!(html.contains("<title>step &amp; hold</title>") && html.contains("<td>60.00</td>"));
        assert_eq!(html.matches("src=\"").count(), 1);
        assert!(html.contains("<script src=\"plotly-") && !html.contains("http"));
    }

    #[test]
    fn a_single_file_asks_for_nothing_and_is_no_longer_than_two_megabytes() {
        let html = page().text("", None, Library::Embedded).expect("a page");
        assert!(!html.contains("src=\"") && html.contains("id=\"library\""));
        assert!(html.len() < 2_000_000, "{}", html.len());
    }

    #[test]
    fn the_library_is_put_beside_a_page_once_and_replaces_no_file_of_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.html");
        page().write(&path, Library::Linked).expect("written");
        let names = |folder: &Path| {
            let entries = std::fs::read_dir(folder).expect("a folder");
            let names =
                entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
            names.filter(|name| name.ends_with(".js")).collect::<Vec<_>>()
        };
        let [library] = &names(folder.path())[..] else { panic!("one library") };
        let library = folder.path().join(library);
        let written = std::fs::metadata(&library).expect("there").modified().expect("a time");
        page().write(&folder.path().join("b.html"), Library::Linked).expect("written");
        assert_eq!(std::fs::metadata(&library).expect("there").modified().expect("a time"), written);
        std::fs::write(&library, "theirs").expect("written");
        let error = page().write(&path, Library::Linked).expect_err("theirs").to_string();
        assert!(error.contains("plotly-") && error.contains("not written by this program"), "{error}");
        let alone = tempfile::tempdir().expect("a folder");
        page().write(&alone.path().join("a.html"), Library::Embedded).expect("written");
        assert!(names(alone.path()).is_empty());
    }

    #[test]
    fn a_column_of_words_begins_at_its_left_and_one_of_figures_ends_at_its_right() {
        let html = Table::new(
            String::new(),
            ["drive", "error, mm", "unit"],
            vec![
                ["a", "-0.50", "mm"].map(str::to_owned).to_vec(),
                ["b", "-", ""].map(str::to_owned).to_vec(),
            ],
        )
        .to_html();
        assert!(
            html.contains("<td class=\"words\">a</td><td>-0.50</td><td class=\"words\">mm</td>"),
            "{html}"
        );
        assert!(html.contains("<th>error, mm</th><th class=\"words\">unit</th>"), "{html}");
    }

    #[test]
    fn a_cell_that_names_a_page_leads_to_it() {
        assert_eq!(linked("impulse.html"), "<a href=\"impulse.html\">impulse</a>");
        assert_eq!(linked("see impulse.html"), "see impulse.html");
        assert_eq!(linked("http://x.html"), "http://x.html");
    }

    #[test]
    fn a_page_without_graphs_carries_no_script() {
        let html = html(&Page { figures: Vec::new(), ..page() });
        assert!(!html.contains("<script"));
    }

    #[test]
    fn a_lead_stands_between_the_first_note_and_all_else() {
        let lead = Figure { heading: "the lead".to_owned(), ..page().figures[0].clone() };
        let led = Page { notes: vec!["first".to_owned(), "second".to_owned()], ..page() };
        let html = led.text("", Some(&lead), Library::Linked).expect("a page");
        let places = ["<p>first", "<h2>the lead", "<p>second", "<h2>moves"].map(|part| html.find(part));
        assert!(places.is_sorted() && places.iter().all(Option::is_some), "{places:?}");
    }

    #[test]
    fn the_columns_of_a_table_of_text_stand_under_each_other() {
        assert_eq!(page().tables[0].to_text(), "move     mm\n1     60.00\n");
    }
}
