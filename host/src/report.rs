//! The page with the graphs: one file that opens without a network.
//!
//! All graphs share their time axis, so zooming one zooms all: position with setpoint, both
//! pressures together, spool, command, error.

use std::path::Path;

use anyhow::{Context, Result};
use plotly::common::{Anchor, DashType, Font, Line, LineShape, Mode, Orientation};
use plotly::layout::{Axis, HoverMode, Legend, Margin};
use plotly::{Layout, Plot, Scatter};

use crate::deviation::{self, Deviation};
use crate::run_folder;
use crate::transient::Transient;

/// Marks a page as ours, so that writing it again replaces nothing else.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"pneudrive\">";

/// A page in the making.
pub struct Report<'a> {
    /// Its heading.
    pub title: &'a str,
    /// What the reader should know first; plain text, a paragraph each.
    pub notes: &'a [String],
    /// What is drawn; the first is the reference.
    pub transients: &'a [Transient],
    /// A table for each transient but the first.
    pub deviations: &'a [(String, Vec<Deviation>)],
}

/// One row of graphs: title with unit, and the channels in it with their legends.
const GRAPHS: [(&str, &[(usize, &str)]); 5] = [
    ("position, mm", &[(0, "setpoint"), (1, "position")]),
    ("pressures, kPa", &[(2, "P1"), (3, "P2")]),
    ("spool, mm", &[(4, "spool")]),
    ("command, counts", &[(5, "command")]),
    ("error, counts", &[(6, "error")]),
];

/// A colour for each channel; transients differ by their dashes and shade.
const COLOURS: [[&str; 7]; 3] = [
    ["#7f7f7f", "#1f4e9c", "#c0392b", "#1e8449", "#6c3483", "#1f4e9c", "#935116"],
    ["#b5b5b5", "#5b9bf0", "#f1948a", "#7dcea0", "#bb8fce", "#5b9bf0", "#e0a458"],
    ["#d0d0d0", "#17a2b8", "#e67e22", "#9acd32", "#ff69b4", "#17a2b8", "#b8860b"],
];

impl Report<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// When the file cannot be written, or the plotting library has no script to put into it.
    pub fn write(&self, path: &Path) -> Result<()> {
        run_folder::refuse_foreign(path, GENERATOR)?;
        run_folder::put(path, &self.to_html()?)
    }

    /// The page.
    ///
    /// # Errors
    /// When the plotting library has no script to put into it.
    pub fn to_html(&self) -> Result<String> {
        let title = escaped(self.title);
        let notes: String = self.notes.iter().map(|note| format!("<p>{}</p>\n", escaped(note))).collect();
        let tables: String = self.deviations.iter().map(|(name, rows)| html_table(name, rows)).collect();
        let graphs = self.plot().to_inline_html(Some("graphs"));
        let script = plotly_script()?;
        Ok(format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{GENERATOR}\n<title>{title}</title>\n\
             <style>{STYLE}</style>\n{script}\n</head>\n<body>\n<h1>{title}</h1>\n{notes}{tables}\
             <div class=\"graphs\">{graphs}</div>\n</body>\n</html>\n"
        ))
    }

    fn plot(&self) -> Plot {
        let mut plot = Plot::new();
        for (row, (_, channels)) in GRAPHS.iter().enumerate() {
            for (number, transient) in self.transients.iter().enumerate() {
                for &(channel, label) in *channels {
                    // The setpoint is the same for all.
                    if number == 0 || channel != 0 {
                        plot.add_trace(trace(transient, number, channel, label, row));
                    }
                }
            }
        }
        plot.set_layout(layout());
        plot.set_configuration(plotly::Configuration::new().responsive(true).display_logo(false));
        plot
    }
}

fn trace(
    transient: &Transient,
    number: usize,
    channel: usize,
    label: &str,
    row: usize,
) -> Box<dyn plotly::Trace> {
    let points = transient.time.iter().zip(&transient.channels[channel]);
    let (time, values): (Vec<f64>, Vec<Option<f64>>) =
        points.map(|(time, value)| (*time, value.is_finite().then_some(*value))).unzip();
    let dash = if number == 0 { DashType::Solid } else { DashType::Dash };
    let stepped = matches!(channel, 0 | 5);
    let line = Line::new()
        .color(COLOURS[number % COLOURS.len()][channel])
        .width(1.5)
        .dash(dash)
        .shape(if stepped { LineShape::Hv } else { LineShape::Linear });
    let name = if channel == 0 { label.to_owned() } else { format!("{label}, {}", transient.name) };
    Scatter::new(time, values).mode(Mode::Lines).line(line).name(name).y_axis(axis_name(row))
}

fn axis_name(row: usize) -> String {
    if row == 0 { "y".to_owned() } else { format!("y{}", row + 1) }
}

fn layout() -> Layout {
    let share = 1.0 / GRAPHS.len() as f64;
    let axis = |row: usize| {
        let top = 1.0 - row as f64 * share;
        Axis::new().title(GRAPHS[row].0).domain(&[top - share + 0.03, top]).zero_line(false)
    };
    Layout::new()
        .height(1250)
        .margin(Margin::new().top(30).right(20).left(70).bottom(50))
        .font(Font::new().size(13))
        .hover_mode(HoverMode::XUnified)
        .legend(Legend::new().orientation(Orientation::Horizontal).y(1.01).y_anchor(Anchor::Bottom))
        .x_axis(Axis::new().title("time, s").anchor(axis_name(GRAPHS.len() - 1)))
        .y_axis(axis(0))
        .y_axis2(axis(1))
        .y_axis3(axis(2))
        .y_axis4(axis(3))
        .y_axis5(axis(4))
}

/// The script of the plotting library, without the formula renderer that comes with it.
fn plotly_script() -> Result<String> {
    let scripts = Plot::offline_js_sources();
    let script = scripts.split_inclusive("</script>").find(|script| script.contains("plotly.js v"));
    script.map(|script| script.trim().to_owned()).context("the plotting library brings no script")
}

fn html_table(name: &str, deviations: &[Deviation]) -> String {
    let cell = |tag: &str, text: &str| format!("<{tag}>{}</{tag}>", escaped(text));
    let head: String = deviation::HEADINGS.iter().map(|heading| cell("th", heading)).collect();
    let rows: String = deviations
        .iter()
        .map(|row| {
            let cells: String = deviation::cells(row).iter().map(|text| cell("td", text)).collect();
            format!("<tr>{cells}</tr>\n")
        })
        .collect();
    format!("<h2>{}</h2>\n<table>\n<tr>{head}</tr>\n{rows}</table>\n", escaped(name))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

const STYLE: &str = "body{font-family:system-ui,sans-serif;margin:2rem auto;max-width:72rem;padding:0 1rem;color:#222}\
h1{font-size:1.5rem}h2{font-size:1.1rem}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{padding:.25rem .9rem;border-bottom:1px solid #ddd;text-align:right}\
th:first-child,td:first-child,th:nth-child(2),td:nth-child(2){text-align:left}\
.graphs{margin-top:1.5rem}";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transient::CHANNELS;

    #[test]
    fn the_page_needs_no_network_and_holds_its_data() {
        let channels: [Vec<f64>; CHANNELS.len()] = std::array::from_fn(|i| vec![i as f64 + 0.125; 2]);
        let transient = Transient { name: "a<b".to_owned(), time: vec![0.0, 1.0], channels };
        let report = Report {
            title: "step & hold",
            notes: &["first".to_owned()],
            transients: &[transient],
            deviations: &[],
        };
        let html = report.to_html().expect("a page");
        let own = &html[..html.find("<script").expect("a script")];
        assert!(own.contains("<title>step &amp; hold</title>"));
        assert!(!html.contains("<script src") && !own.contains("http"));
        assert!(html.contains("4.125") && html.contains("Plotly.newPlot"));
    }
}
