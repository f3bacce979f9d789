//! A page of this program: notes, tables and graphs in one file that opens without a network.
//!
//! The plotting library in the page draws the graphs: they zoom, and each can be saved as SVG or PNG.

mod figure;

use std::borrow::Cow;
use std::path::Path;
use std::sync::LazyLock;

use anyhow::{Context, Result};
use plotly::Plot;
use pneudrive_records::own_file::{GENERATOR, refuse_to_replace};
use pneudrive_records::whole_file::put_pieces;

pub use figure::{COLOURS, Curve, Figure, Look, Panel, Shade};

/// A page in the making.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// What the reader should know first; plain text, a paragraph each.
    pub notes: Vec<String>,
    /// Figures in numbers, before the graphs.
    pub tables: Vec<Table>,
    /// The graphs.
    pub figures: Vec<Figure>,
}

/// A table with a heading; its cells are plain text. One that names a page beside this one, such as
/// `impulse.html`, leads there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it is about.
    pub heading: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Its rows, a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Page {
    /// Writes the page.
    ///
    /// # Errors
    /// When the file cannot be written or is not of this program, or the plotting library has no script
    /// to put into it.
    pub fn write(&self, path: &Path) -> Result<()> {
        self.write_with(path, None)
    }

    /// Writes the page with a figure behind its first note, before everything else: the one that answers what the
    /// page is asked.
    ///
    /// # Errors
    /// As [`Page::write`].
    pub fn write_led_by(&self, path: &Path, lead: &Figure) -> Result<()> {
        self.write_with(path, Some(lead))
    }

    fn write_with(&self, path: &Path, lead: Option<&Figure>) -> Result<()> {
        refuse_to_replace(path, GENERATOR)?;
        let [head, script, body] = self.pieces("", lead)?;
        put_pieces(path, &[head.as_bytes(), script.as_bytes(), body.as_bytes()])
    }

    /// What stands before the script, the script, and the rest; `mark` goes into the head, and `lead` before the tables.
    ///
    /// # Errors
    /// When the plotting library has no script to put into it.
    pub fn pieces(&self, mark: &str, lead: Option<&Figure>) -> Result<[Cow<'static, str>; 3]> {
        let script = if self.figures.is_empty() && lead.is_none() { "" } else { plotly_script()? };
        let title = escaped(&self.title);
        let head = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{GENERATOR}{mark}\n<title>{title}</title>\n\
             <style>{STYLE}</style>\n"
        );
        let body = format!("\n</head>\n<body>\n<h1>{title}</h1>\n{}</body>\n</html>\n", self.content(lead));
        Ok([head.into(), script.into(), body.into()])
    }

    /// The first note, the lead, the other notes, tables and figures.
    fn content(&self, lead: Option<&Figure>) -> String {
        let note = |note: &String| format!("<p>{}</p>\n", escaped(note));
        let (first, others) = self.notes.split_at(self.notes.len().min(1));
        let lead = lead.map(|figure| section(0, figure));
        let tables = self.tables.iter().map(Table::to_html);
        let figures = (1..).zip(&self.figures).map(|(n, figure)| section(n, figure));
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

/// A figure with its heading and what saves it.
fn section(number: usize, figure: &Figure) -> String {
    let id = format!("figure-{number}");
    let heading = if figure.heading.is_empty() {
        String::new()
    } else {
        format!("<h2>{}</h2>\n", escaped(&figure.heading))
    };
    let graph = figure.plot().to_inline_html(Some(&id));
    let button = |format: &str| {
        format!(
            "<button type=\"button\" onclick=\"Plotly.downloadImage('{id}',{{format:'{format}',width:900,height:{}}})\">\
             {}</button>",
            figure.height(),
            format.to_uppercase()
        )
    };
    format!(
        "{heading}<div>{graph}</div>\n<p class=\"save\">save as {} {}</p>\n",
        button("svg"),
        button("png")
    )
}

/// The script of the plotting library, without the formula renderer that comes with it: megabytes, looked up once.
fn plotly_script() -> Result<&'static str> {
    static SCRIPT: LazyLock<Option<String>> = LazyLock::new(|| {
        let scripts = Plot::offline_js_sources();
        let script = scripts.split_inclusive("</script>").find(|script| script.contains("plotly.js v"));
        script.map(|script| script.trim().to_owned())
    });
    SCRIPT.as_deref().context("the plotting library has no script")
}

/// A page beside this one as a link, other text as it is.
fn linked(text: &str) -> String {
    match text.strip_suffix(".html") {
        Some(name) if !name.contains([' ', '/']) => {
            format!("<a href=\"{0}.html\">{0}</a>", escaped(name).replace('"', "&quot;"))
        }
        _ => escaped(text),
    }
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

pub(crate) const STYLE: &str = "body{font-family:system-ui,sans-serif;margin:2rem auto;max-width:72rem;padding:0 1rem;color:#222}\
h1{font-size:1.5rem}h2{font-size:1.1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums;display:block;overflow-x:auto}\
th,td{padding:.25rem .6rem;border-bottom:1px solid #ddd;text-align:right}\
th:first-child,td:first-child,.words{text-align:left}\
.save{color:#777;font-size:.8rem;text-align:right}";

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        let curve = Curve::new("a<b", vec![0.0, 1.0], vec![4.125, f64::NAN]);
        Page {
            title: "step & hold".to_owned(),
            notes: vec!["first".to_owned()],
            tables: vec![Table {
                heading: "moves".to_owned(),
                columns: vec!["move".to_owned(), "mm".to_owned()],
                rows: vec![vec!["1".to_owned(), "60.00".to_owned()]],
            }],
            figures: vec![Figure::over_time(vec![Panel::new("position, mm", vec![curve])])],
        }
    }

    fn html(page: &Page) -> String {
        page.pieces("", None).expect("a page").concat()
    }

    #[test]
    fn the_page_needs_no_network_and_holds_its_data() {
        let html = html(&page());
        let own = &html[..html.find("<script").expect("a script")];
        assert!(own.contains("<title>step &amp; hold</title>"));
        assert!(!html.contains("<script src") && !own.contains("http"));
        assert!(html.contains("4.125") && html.contains("Plotly.newPlot"));
        assert!(html.contains("<td>60.00</td>"));
    }

    #[test]
    fn a_column_of_words_begins_at_its_left_and_one_of_figures_ends_at_its_right() {
        let html = Table {
            heading: String::new(),
            columns: ["drive", "error, mm", "unit"].map(str::to_owned).to_vec(),
            rows: vec![
                ["a", "-0.50", "mm"].map(str::to_owned).to_vec(),
                ["b", "-", ""].map(str::to_owned).to_vec(),
            ],
        }
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
        let html = led.pieces("", Some(&lead)).expect("a page")[2].to_string();
        let places =
            ["<p>first", "<h2>the lead", "<p>second", "<h2>moves", "figure-1"].map(|part| html.find(part));
        assert!(places.is_sorted() && places.iter().all(Option::is_some), "{places:?}");
    }

    #[test]
    fn curves_of_one_name_and_colour_stand_in_the_legend_once() {
        let curve =
            |colour: Option<&'static str>| Curve { colour, ..Curve::new("same", vec![0.0], vec![0.0]) };
        let told = |colour: Option<&'static str>| {
            let panels = [(); 3].map(|()| Panel::new("", vec![curve(colour)]));
            let page = Page { figures: vec![Figure::over_time(panels.to_vec())], ..page() };
            html(&page).matches("\"showlegend\":true,").count()
        };
        assert_eq!(told(None) - told(Some("#1f4e9c")), 2);
    }

    #[test]
    fn the_columns_of_a_table_of_text_stand_under_each_other() {
        assert_eq!(page().tables[0].to_text(), "move     mm\n1     60.00\n");
    }
}
