//! Stacked graphs with a common axis: zooming one zooms all.

use plotly::common::{Anchor, DashType, Fill, Font, HoverInfo, Line, LineShape, Marker, Mode, Orientation};
use plotly::layout::{Axis, AxisType, HoverMode, Legend, Margin};
use plotly::{Layout, Plot, Scatter};

/// Height of a panel, and of a figure's axis with its title, pixels.
const PANEL_HEIGHT: usize = 235;
const FRAME_HEIGHT: usize = 75;

/// Height of a single panel.
const SINGLE_HEIGHT: usize = 400;

/// The y axes that the plotting library has: the most panels of a figure.
const Y_AXES: [fn(Layout, Axis) -> Layout; 8] = [
    Layout::y_axis,
    Layout::y_axis2,
    Layout::y_axis3,
    Layout::y_axis4,
    Layout::y_axis5,
    Layout::y_axis6,
    Layout::y_axis7,
    Layout::y_axis8,
];

/// Colours of curves that are in several panels and once in the legend.
#[rustfmt::skip]
pub const COLOURS: [&str; 10] = [
    "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd",
    "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf",
];

/// Panels over one axis.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Its heading; may be empty.
    pub heading: String,
    /// Name and unit of the axis that all panels share.
    pub across: String,
    /// Whether that axis is logarithmic.
    pub logarithmic: bool,
    /// From top to bottom, eight at most.
    pub panels: Vec<Panel>,
}

/// Curves on one vertical axis.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Name and unit of the vertical axis.
    pub title: String,
    /// Whether it is logarithmic.
    pub logarithmic: bool,
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// What is shaded behind the curves.
    pub bands: Vec<Shade>,
}

/// A shaded area between two curves over the same axis.
#[derive(Clone, Debug, Default)]
pub struct Shade {
    /// For the legend.
    pub name: String,
    /// Along the shared axis.
    pub x: Vec<f64>,
    /// Its lower edge, as many as x.
    pub low: Vec<f64>,
    /// Its upper edge.
    pub high: Vec<f64>,
    /// Such as `#1f4e9c`: of the curve that it belongs to.
    pub colour: &'static str,
    /// Whether each value holds until the next one.
    pub steps: bool,
}

/// How much of a shade's colour is seen.
const OPACITY: u8 = 0x38;

impl Shade {
    /// The lower edge, and the upper one that is filled down to it.
    fn traces(&self, row: usize, in_legend: bool) -> [Box<dyn plotly::Trace>; 2] {
        let shape = if self.steps { LineShape::Hv } else { LineShape::Linear };
        let edge = |values: &[f64]| {
            let values: Vec<Option<f64>> =
                values.iter().map(|value| value.is_finite().then_some(*value)).collect();
            Scatter::new(self.x.clone(), values)
                .mode(Mode::Lines)
                .line(Line::new().width(0.0).shape(shape.clone()).color(self.colour))
                .name(&self.name)
                .legend_group(&self.name)
                .hover_info(HoverInfo::Skip)
                .y_axis(axis_name(row))
        };
        let filled = format!("{}{OPACITY:02x}", self.colour);
        [
            edge(&self.low).show_legend(false),
            edge(&self.high).show_legend(in_legend).fill(Fill::ToNextY).fill_color(filled),
        ]
    }
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// A line.
    #[default]
    Line,
    /// A dashed line.
    Dashed,
    /// Each value holds until the next one.
    Steps,
    /// The same, dashed.
    DashedSteps,
    /// Points alone.
    Points,
}

/// One curve. Values that are not numbers leave a gap.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// For the legend.
    pub name: String,
    /// Along the shared axis.
    pub x: Vec<f64>,
    /// As many as x.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub look: Look,
    /// Such as `#1f4e9c`; the library's next one if None.
    pub colour: Option<&'static str>,
}

impl Curve {
    /// A line in the next colour.
    #[must_use]
    pub fn new(name: &str, x: Vec<f64>, y: Vec<f64>) -> Curve {
        Curve { name: name.to_owned(), x, y, ..Curve::default() }
    }

    /// Whether its place in the legend serves another curve, too: both have the same name and the same colour.
    fn is_in_legend_of(&self, other: &Curve) -> bool {
        self.colour.is_some() && self.colour == other.colour && self.name == other.name
    }

    fn trace(&self, row: usize, in_legend: bool) -> Box<dyn plotly::Trace> {
        let values: Vec<Option<f64>> =
            self.y.iter().map(|value| value.is_finite().then_some(*value)).collect();
        let (shape, dash) = match self.look {
            Look::Steps => (LineShape::Hv, DashType::Solid),
            Look::DashedSteps => (LineShape::Hv, DashType::Dash),
            Look::Dashed => (LineShape::Linear, DashType::Dash),
            Look::Line | Look::Points => (LineShape::Linear, DashType::Solid),
        };
        let mut line = Line::new().width(1.5).dash(dash).shape(shape);
        let mut marker = Marker::new().size(5);
        if let Some(colour) = self.colour {
            (line, marker) = (line.color(colour), marker.color(colour));
        }
        let mode = if self.look == Look::Points { Mode::Markers } else { Mode::Lines };
        Scatter::new(self.x.clone(), values)
            .mode(mode)
            .line(line)
            .marker(marker)
            .name(&self.name)
            .legend_group(&self.name)
            .show_legend(in_legend)
            .y_axis(axis_name(row))
    }
}

impl Panel {
    /// Curves on a linear axis.
    #[must_use]
    pub fn new(title: &str, curves: Vec<Curve>) -> Panel {
        Panel { title: title.to_owned(), curves, ..Panel::default() }
    }
}

impl Figure {
    /// Panels over the time in seconds, without a heading.
    #[must_use]
    pub fn over_time(panels: Vec<Panel>) -> Figure {
        Figure { across: "time, s".to_owned(), panels, ..Figure::default() }
    }

    /// Height in pixels.
    pub(super) fn height(&self) -> usize {
        let panels = self.panels.len();
        FRAME_HEIGHT + if panels == 1 { SINGLE_HEIGHT } else { PANEL_HEIGHT * panels }
    }

    pub(super) fn plot(&self) -> Plot {
        let mut plot = Plot::new();
        for (row, panel) in self.panels.iter().enumerate() {
            for (place, band) in panel.bands.iter().enumerate() {
                let above = self.panels[..row].iter().flat_map(|panel| &panel.bands);
                let told = above.chain(&panel.bands[..place]).any(|other| other.name == band.name);
                band.traces(row, !told).into_iter().for_each(|trace| plot.add_trace(trace));
            }
            for (place, curve) in panel.curves.iter().enumerate() {
                let above = self.panels[..row].iter().flat_map(|panel| &panel.curves);
                let mut before = above.chain(&panel.curves[..place]);
                plot.add_trace(curve.trace(row, !before.any(|other| other.is_in_legend_of(curve))));
            }
        }
        plot.set_layout(self.layout());
        plot.set_configuration(plotly::Configuration::new().responsive(true).display_logo(false));
        plot
    }

    fn layout(&self) -> Layout {
        let last = self.panels.len().saturating_sub(1);
        let layout = Layout::new()
            .height(self.height())
            .margin(Margin::new().top(30).right(20).left(70).bottom(50))
            .font(Font::new().size(13))
            .hover_mode(HoverMode::XUnified)
            .show_legend(true)
            .legend(Legend::new().orientation(Orientation::Horizontal).y(1.01).y_anchor(Anchor::Bottom))
            .x_axis(axis(&self.across, self.logarithmic).anchor(axis_name(last)));
        let share = 1.0 / self.panels.len() as f64;
        let rows = Y_AXES.iter().zip(&self.panels).enumerate();
        rows.fold(layout, |layout, (row, (set, panel))| {
            let top = 1.0 - row as f64 * share;
            let bottom = if row == last { 0.0 } else { top - share + 0.03 };
            set(layout, axis(&panel.title, panel.logarithmic).domain(&[bottom, top]).zero_line(false))
        })
    }
}

fn axis(title: &str, logarithmic: bool) -> Axis {
    let axis = Axis::new().title(title);
    if logarithmic { axis.type_(AxisType::Log) } else { axis }
}

fn axis_name(row: usize) -> String {
    if row == 0 { "y".to_owned() } else { format!("y{}", row + 1) }
}
