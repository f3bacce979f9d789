//! A small graph as inline SVG: the page has dozens of them side by side and opens at once.

use std::fmt::Write;

use super::reading::ends;
use pneudrive_report::{COLOURS, escaped};

/// A graph of lines over one axis, with the printed values of the thesis shaded.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// Its title.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub across: &'static str,
    /// Name and unit of the vertical axis.
    pub up: &'static str,
    /// The lines.
    pub lines: Vec<Line>,
    /// Printed values along the horizontal axis, from and to.
    pub printed_across: Vec<[f64; 2]>,
    /// Printed values along the vertical axis, from and to.
    pub printed_up: Vec<[f64; 2]>,
}

/// A line of a graph; values that are not numbers leave a gap.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// For the legend.
    pub name: String,
    /// Its points, x and y.
    pub points: Vec<[f64; 2]>,
    /// Whether its points are marked, too.
    pub dots: bool,
    /// Its colour, by number; the next one if None.
    pub colour: Option<usize>,
}

impl Line {
    /// A line of values over positions.
    #[must_use]
    pub fn new(name: impl Into<String>, x: &[f64], y: &[f64]) -> Line {
        let points = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
        Line { name: name.into(), points, dots: false, colour: None }
    }

    /// The same with its points marked.
    #[must_use]
    pub fn dotted(self) -> Line {
        Line { dots: true, ..self }
    }
}

/// The drawing and the field inside its axes: left, top, right, bottom; pixels.
const SIZE: [f64; 2] = [340.0, 216.0];
const FIELD: [f64; 4] = [46.0, 8.0, 332.0, 176.0];

/// More points of a line cannot be distinguished.
const MAX_POINTS: usize = 700;

impl Chart {
    /// The graph with its title and legend.
    #[must_use]
    pub fn svg(&self) -> String {
        let frame = Frame::around(self);
        let mut drawing = frame.axes(self.across, self.up);
        drawing += &frame.printed(self);
        for (line, colour) in self.coloured() {
            drawing += &frame.line(line, colour);
        }
        let [width, height] = SIZE;
        format!(
            "<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">{drawing}</svg>{}</figure>\n",
            escaped(&self.title),
            escaped(&self.title).replace('"', "&quot;"),
            self.legend()
        )
    }

    fn coloured(&self) -> impl Iterator<Item = (&Line, &'static str)> {
        let colour = |(place, line): (usize, &Line)| COLOURS[line.colour.unwrap_or(place) % COLOURS.len()];
        self.lines.iter().enumerate().map(move |(place, line)| (line, colour((place, line))))
    }

    fn legend(&self) -> String {
        let named = self.coloured().filter(|(line, _)| !line.name.is_empty());
        let one = |(line, colour): (&Line, &str)| {
            format!("<span><i style=\"background:{colour}\"></i>{}</span>", escaped(&line.name))
        };
        let printed = if self.printed_across.is_empty() && self.printed_up.is_empty() {
            ""
        } else {
            "<span><i class=\"printed\"></i>printed</span>"
        };
        format!("<div class=\"legend\">{}{printed}</div>", named.map(one).collect::<String>())
    }
}

/// The range of the axes.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    fn around(chart: &Chart) -> Frame {
        let of = |axis: usize, printed: &[[f64; 2]]| {
            let drawn = chart.lines.iter().flat_map(|line| &line.points).map(|point| point[axis]);
            let all: Vec<f64> =
                drawn.chain(printed.iter().flatten().copied()).filter(|v| v.is_finite()).collect();
            ends(&all)
        };
        Frame { x: widened(of(0, &chart.printed_across), 0.0), y: widened(of(1, &chart.printed_up), 0.06) }
    }

    fn across(&self, x: f64) -> f64 {
        FIELD[0] + (x - self.x[0]) / (self.x[1] - self.x[0]) * (FIELD[2] - FIELD[0])
    }

    fn up(&self, y: f64) -> f64 {
        FIELD[3] - (y - self.y[0]) / (self.y[1] - self.y[0]) * (FIELD[3] - FIELD[1])
    }

    fn axes(&self, across: &str, up: &str) -> String {
        let [left, top, right, bottom] = FIELD;
        let mut text = String::new();
        for (value, labels) in ticks(self.y, 5) {
            let y = self.up(value);
            let _ = write!(
                text,
                "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/><text class=\"end\" x=\"{:.0}\" y=\"{:.1}\">{labels}</text>",
                left - 4.0,
                y + 3.5
            );
        }
        for (value, labels) in ticks(self.x, 6) {
            let x = self.across(value);
            let _ = write!(
                text,
                "<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\"/><text class=\"mid\" x=\"{x:.1}\" y=\"{:.0}\">{labels}</text>",
                bottom + 13.0
            );
        }
        let [middle, below] = [f64::midpoint(left, right), bottom + 30.0];
        let beside = f64::midpoint(top, bottom);
        let _ =
            write!(text, "<text class=\"mid name\" x=\"{middle}\" y=\"{below}\">{}</text>", escaped(across));
        let _ = write!(
            text,
            "<text class=\"mid name\" transform=\"translate(10 {beside}) rotate(-90)\">{}</text>",
            escaped(up)
        );
        text
    }

    /// The printed values of the thesis, shaded.
    fn printed(&self, chart: &Chart) -> String {
        let [left, top, right, bottom] = FIELD;
        let area = |x: f64, y: f64, width: f64, height: f64| {
            format!(
                "<rect class=\"printed\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                width.max(1.5),
                height.max(1.5)
            )
        };
        let across = chart.printed_across.iter().map(|[from, to]| {
            area(self.across(*from), top, self.across(*to) - self.across(*from), bottom - top)
        });
        let up = chart
            .printed_up
            .iter()
            .map(|[from, to]| area(left, self.up(*to), right - left, self.up(*from) - self.up(*to)));
        across.chain(up).collect()
    }

    fn line(&self, line: &Line, colour: &str) -> String {
        let step = line.points.len().div_ceil(MAX_POINTS).max(1);
        let points: Vec<[f64; 2]> = line.points.iter().step_by(step).copied().collect();
        let places = |part: &[[f64; 2]]| {
            let places = part.iter().map(|[x, y]| format!("{:.1},{:.1}", self.across(*x), self.up(*y)));
            places.collect::<Vec<_>>().join(" ")
        };
        let parts = points.split(|[_, y]| !y.is_finite()).filter(|part| !part.is_empty());
        let lines = parts.map(|part| format!("<polyline points=\"{}\" stroke=\"{colour}\"/>", places(part)));
        let dots = points.iter().filter(|[_, y]| line.dots && y.is_finite()).map(|[x, y]| {
            format!(
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.4\" fill=\"{colour}\"/>",
                self.across(*x),
                self.up(*y)
            )
        });
        lines.chain(dots).collect()
    }
}

/// A span without room at its ends, or without length, widened by a part of itself.
fn widened([low, high]: [f64; 2], part: f64) -> [f64; 2] {
    match high - low {
        span if span > 0.0 => [low - part * span, high + part * span],
        _ if low.is_finite() => [low - 0.5, high + 0.5],
        _ => [0.0, 1.0],
    }
}

/// About this many round values within a span, with enough digits to distinguish them.
fn ticks([low, high]: [f64; 2], about: usize) -> Vec<(f64, String)> {
    let rough = (high - low) / about as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * power);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let [first, last] = [(low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64];
    let tick = |number: i64| {
        let value = number as f64 * step;
        (value, super::reading::rounded(value, decimals))
    };
    (first..=last).map(tick).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_span() {
        let labels = |span| ticks(span, 5).into_iter().map(|(_, labels)| labels).collect::<Vec<_>>();
        assert_eq!(labels([0.0, 1.0]), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels([-3.0, 4.0]), ["-2", "0", "2", "4"]);
        assert_eq!(labels([0.0123, 0.0187]), ["0.014", "0.016", "0.018"]);
        assert_eq!(labels([100.0, 600.0]), ["100", "200", "300", "400", "500", "600"]);
    }

    #[test]
    fn a_gap_parts_a_line_and_what_is_printed_is_shaded() {
        let chart = Chart {
            title: "a < b".to_owned(),
            lines: vec![Line::new("ours", &[0.0, 1.0, 2.0, 3.0], &[1.0, f64::NAN, 2.0, 3.0]).dotted()],
            printed_up: vec![[1.5, 2.5]],
            ..Chart::default()
        };
        let svg = chart.svg();
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert_eq!(svg.matches("<circle").count(), 3);
        assert_eq!(svg.matches("<rect class=\"printed\"").count(), 1);
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn a_chart_of_nothing_or_of_one_value_has_axes_all_the_same() {
        for lines in [vec![], vec![Line::new("", &[1.0], &[2.0])]] {
            let svg = Chart { lines, ..Chart::default() }.svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
