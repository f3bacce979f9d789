//! Stacked graphs with a common axis: zooming one zooms all.

/// Height of a panel, and of a figure's axis with its title, pixels.
const PANEL_HEIGHT: usize = 235;
const FRAME_HEIGHT: usize = 75;

/// Height of a single panel.
const SINGLE_HEIGHT: usize = 400;

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
    /// The curves.
    pub curves: Vec<Curve>,
    /// The shaded areas behind the curves.
    pub bands: Vec<Shade>,
}

/// A shaded area between two curves over the same axis.
#[derive(Clone, Debug, Default)]
pub struct Shade {
    /// Its name in the legend.
    pub name: String,
    /// Positions along the shared axis.
    pub x: Vec<f64>,
    /// Its lower edge, one value for each x.
    pub low: Vec<f64>,
    /// Its upper edge.
    pub high: Vec<f64>,
    /// Its colour, that of the curve that it belongs to, such as `#1f4e9c`.
    pub colour: &'static str,
    /// Whether each value holds until the next one.
    pub steps: bool,
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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// Positions along the shared axis.
    pub x: Vec<f64>,
    /// Values, one for each x.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub look: Look,
    /// Its colour, such as `#1f4e9c`; None: the next colour of the library.
    pub colour: Option<&'static str>,
}

impl Curve {
    /// A line in the next colour.
    #[must_use]
    pub fn new(name: &str, x: Vec<f64>, y: Vec<f64>) -> Curve {
        Curve { name: name.to_owned(), x, y, ..Curve::default() }
    }

    /// Whether its place in the legend serves another curve, too: both have the same name and the same colour.
    pub(super) fn is_in_legend_of(&self, other: &Curve) -> bool {
        self.colour.is_some() && self.colour == other.colour && self.name == other.name
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
}
