//! A page of this program: notes, tables and graphs in one file that opens without a network.
//!
//! Graphs are drawn by the plotting library that the page carries: they zoom, and each saves itself as
//! SVG or PNG.

mod figure;

use std::path::Path;

use anyhow::{Context, Result};
use plotly::Plot;

pub use figure::{Curve, Figure, Look, Panel};

use crate::run_folder;

/// Marks a page as ours, so that writing it again replaces nothing else.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"pneudrive\">";

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

/// A table with a heading; its cells are plain text.
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
        run_folder::refuse_foreign(path, GENERATOR)?;
        run_folder::put(path, &self.to_html()?)
    }

    /// The page as text.
    ///
    /// # Errors
    /// When the plotting library has no script to put into it.
    pub fn to_html(&self) -> Result<String> {
        let title = escaped(&self.title);
        let notes: String = self.notes.iter().map(|note| format!("<p>{}</p>\n", escaped(note))).collect();
        let tables: String = self.tables.iter().map(Table::to_html).collect();
        let figures: String = (1..).zip(&self.figures).map(|(n, figure)| section(n, figure)).collect();
        let script = if self.figures.is_empty() { String::new() } else { plotly_script()? };
        Ok(format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{GENERATOR}\n<title>{title}</title>\n\
             <style>{STYLE}</style>\n{script}\n</head>\n<body>\n<h1>{title}</h1>\n{notes}{tables}{figures}\
             </body>\n</html>\n"
        ))
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

    fn to_html(&self) -> String {
        let row = |tag: &str, cells: &[String]| {
            let cells: String =
                cells.iter().map(|text| format!("<{tag}>{}</{tag}>", escaped(text))).collect();
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

/// The script of the plotting library, without the formula renderer that comes with it.
fn plotly_script() -> Result<String> {
    let scripts = Plot::offline_js_sources();
    let script = scripts.split_inclusive("</script>").find(|script| script.contains("plotly.js v"));
    script.map(|script| script.trim().to_owned()).context("the plotting library brings no script")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

const STYLE: &str = "body{font-family:system-ui,sans-serif;margin:2rem auto;max-width:72rem;padding:0 1rem;color:#222}\
h1{font-size:1.5rem}h2{font-size:1.1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{padding:.25rem .9rem;border-bottom:1px solid #ddd;text-align:right}\
th:first-child,td:first-child{text-align:left}\
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

    #[test]
    fn the_page_needs_no_network_and_holds_its_data() {
        let html = page().to_html().expect("a page");
        let own = &html[..html.find("<script").expect("a script")];
        assert!(own.contains("<title>step &amp; hold</title>"));
        assert!(!html.contains("<script src") && !own.contains("http"));
        assert!(html.contains("4.125") && html.contains("Plotly.newPlot"));
        assert!(html.contains("<td>60.00</td>"));
    }

    #[test]
    fn a_page_without_graphs_carries_no_script() {
        let html = Page { figures: Vec::new(), ..page() }.to_html().expect("a page");
        assert!(!html.contains("<script"));
    }

    #[test]
    fn the_columns_of_a_table_of_text_stand_under_each_other() {
        assert_eq!(page().tables[0].to_text(), "move     mm\n1     60.00\n");
    }
}
