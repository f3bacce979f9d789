//! Figures as the plotting library takes them: traces and a layout in JSON (plotly.js 3, figure reference). Curves over the
//! same axis share it: `x` of a trace is its place in the list of axes.

use serde_json::{Value, json};

use super::figure::{Curve, Figure, Look, Panel, Shade};

/// How much of a shade's colour is seen, of 255.
const OPACITY: u8 = 0x38;

/// Between two graphs at most, of the height of all.
const GAP: f64 = 0.03;

/// How many names one legend above all graphs may have; with more, each graph has a legend of its own beside it.
const MAX_IN_ONE_LEGEND: usize = 8;

/// Axes in the order of their first use.
#[derive(Default)]
struct Axes<'a>(Vec<&'a [f64]>);

impl<'a> Axes<'a> {
    fn place(&mut self, axis: &'a [f64]) -> usize {
        let same = |other: &&[f64]| other.iter().map(|x| x.to_bits()).eq(axis.iter().map(|x| x.to_bits()));
        self.0.iter().position(same).unwrap_or_else(|| {
            self.0.push(axis);
            self.0.len() - 1
        })
    }
}

/// The plots of figures, each with `runs` below it, and the axes of their curves.
pub(super) fn plots<'a>(figures: impl Iterator<Item = &'a Figure>, runs: &str) -> Value {
    let mut axes = Axes::default();
    let plots: Vec<Value> = figures.map(|figure| plot(figure, runs, &mut axes)).collect();
    let axes: Vec<Value> = axes.0.into_iter().map(|axis| numbers(axis, 9)).collect();
    json!({ "axes": axes, "plots": plots })
}

/// Traces, layout and configuration of a figure.
fn plot<'a>(figure: &'a Figure, runs: &str, axes: &mut Axes<'a>) -> Value {
    let mut traces = Vec::new();
    for (row, panel) in figure.panels.iter().enumerate() {
        for (place, band) in panel.bands.iter().enumerate() {
            let above = figure.panels[..row].iter().flat_map(|panel| &panel.bands);
            let told = above.chain(&panel.bands[..place]).any(|other| other.name == band.name);
            traces.extend(edges(band, axes.place(&band.x), row, !told));
        }
        for (place, curve) in panel.curves.iter().enumerate() {
            let above = figure.panels[..row].iter().flat_map(|panel| &panel.curves);
            let mut before = above.chain(&panel.curves[..place]);
            let is_told = before.any(|other| other.is_in_legend_of(curve));
            traces.push(trace(curve, axes.place(&curve.x), row, !is_told));
        }
    }
    let config = json!({ "responsive": true, "displaylogo": false });
    let mut layout = layout(figure);
    if traces.iter().filter(|trace| trace["showlegend"] == true).count() > MAX_IN_ONE_LEGEND {
        give_legends(&mut traces, &mut layout, figure.panels.len());
    }
    if !runs.is_empty() {
        layout["annotations"] = json!([below(runs)]);
    }
    json!({ "data": traces, "layout": layout, "config": config })
}

/// The lower edge, and the upper one that is filled down to it.
fn edges(band: &Shade, x: usize, row: usize, in_legend: bool) -> [Value; 2] {
    let edge = |values: &[f64]| {
        json!({
            "type": "scatter",
            "mode": "lines",
            "line": { "width": 0, "shape": shape(band.steps), "color": band.colour },
            "name": band.name,
            "legendgroup": band.name,
            "hoverinfo": "skip",
            "yaxis": axis_name(row),
            "x": x,
            "y": numbers(values, 6),
        })
    };
    let [mut low, mut high] = [&band.low, &band.high].map(|values| edge(values));
    low["showlegend"] = json!(false);
    high["showlegend"] = json!(in_legend);
    high["fill"] = json!("tonexty");
    high["fillcolor"] = json!(format!("{}{OPACITY:02x}", band.colour));
    [low, high]
}

fn trace(curve: &Curve, x: usize, row: usize, in_legend: bool) -> Value {
    let (steps, dash) = match curve.look {
        Look::Steps => (true, "solid"),
        Look::DashedSteps => (true, "dash"),
        Look::Dashed => (false, "dash"),
        Look::Line | Look::Points => (false, "solid"),
    };
    let mut trace = json!({
        "type": "scatter",
        "mode": if curve.look == Look::Points { "markers" } else { "lines" },
        "line": { "width": 1.5, "dash": dash, "shape": shape(steps) },
        "marker": { "size": 5 },
        "name": curve.name,
        "legendgroup": curve.name,
        "showlegend": in_legend,
        "yaxis": axis_name(row),
        "x": x,
        "y": numbers(&curve.y, 6),
    });
    if let Some(colour) = curve.colour {
        trace["line"]["color"] = json!(colour);
        trace["marker"]["color"] = json!(colour);
    }
    trace
}

fn shape(steps: bool) -> &'static str {
    if steps { "hv" } else { "linear" }
}

/// Values with this many significant digits, six being more than any screen shows; values that are not numbers leave
/// a gap.
fn numbers(values: &[f64], digits: usize) -> Value {
    let rounded = |value: &f64| format!("{value:.*e}", digits - 1).parse::<f64>().ok();
    values.iter().map(|value| json!(rounded(value).filter(|value| value.is_finite()))).collect()
}

fn layout(figure: &Figure) -> Value {
    let last = figure.panels.len().saturating_sub(1);
    let mut layout = json!({
        "height": figure.height(),
        "margin": { "t": 30, "r": 20, "l": 70, "b": 50 },
        "font": { "size": 13 },
        "hovermode": "x unified",
        "showlegend": true,
        "legend": { "orientation": "h", "y": 1.01, "yanchor": "bottom" },
        "xaxis": axis(&figure.across, figure.logarithmic),
    });
    layout["xaxis"]["anchor"] = json!(axis_name(last));
    let share = 1.0 / figure.panels.len() as f64;
    for (row, panel) in figure.panels.iter().enumerate() {
        let top = 1.0 - row as f64 * share;
        let bottom = if row == last { 0.0 } else { top - share + GAP.min(share / 7.0) };
        layout[axis_name(row).replace('y', "yaxis")] = vertical(panel, [bottom, top]);
    }
    layout
}

/// Gives each graph a legend of its own, at its upper right.
fn give_legends(traces: &mut [Value], layout: &mut Value, panels: usize) {
    for trace in traces {
        let axis = trace["yaxis"].as_str().unwrap_or_default();
        trace["legend"] = json!(axis.replace('y', "legend"));
    }
    for row in (0..panels).map(axis_name) {
        let top = layout[row.replace('y', "yaxis")]["domain"][1].clone();
        layout[row.replace('y', "legend")] =
            json!({ "x": 1.01, "y": top, "yanchor": "top", "font": { "size": 11 }, "tracegroupgap": 0 });
    }
}

/// Small text at the right end below a plot, beside the title of its axis.
fn below(text: &str) -> Value {
    json!({
        "text": text, "showarrow": false, "font": { "size": 10, "color": "#666666" },
        "xref": "paper", "x": 1, "xanchor": "right", "yref": "paper", "y": 0, "yanchor": "top", "yshift": -32,
    })
}

fn vertical(panel: &Panel, domain: [f64; 2]) -> Value {
    let mut axis = axis(&panel.title, panel.logarithmic);
    axis["domain"] = json!(domain);
    axis["zeroline"] = json!(false);
    axis
}

fn axis(title: &str, logarithmic: bool) -> Value {
    let mut axis = json!({ "title": { "text": title } });
    if logarithmic {
        axis["type"] = json!("log");
    }
    axis
}

fn axis_name(row: usize) -> String {
    if row == 0 { "y".to_owned() } else { format!("y{}", row + 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(colour: Option<&'static str>) -> Figure {
        let curve = || Curve { colour, ..Curve::new("same", vec![0.0, 1.0], vec![4.125, f64::NAN]) };
        Figure::over_time([(); 3].map(|()| Panel::new("", vec![curve()])).to_vec())
    }

    #[test]
    fn curves_of_one_name_and_colour_stand_in_the_legend_once() {
        let told = |colour: Option<&'static str>| {
            let plots = plots(std::iter::once(&figure(colour)), "");
            let traces = plots["plots"][0]["data"].as_array().expect("traces").clone();
            traces.iter().filter(|trace| trace["showlegend"] == true).count()
        };
        assert_eq!((told(None), told(Some("#1f4e9c"))), (3, 1));
    }

    #[test]
    fn a_figure_of_many_names_has_a_legend_beside_each_graph() {
        let of = |count: usize| {
            let curve = |k: usize| Curve::new(&k.to_string(), vec![0.0], vec![1.0]);
            let panel = Panel::new("", (0..count).map(curve).collect());
            plots(std::iter::once(&Figure::over_time(vec![panel.clone(), panel])), "")["plots"][0].clone()
        };
        let (few, many) = (of(MAX_IN_ONE_LEGEND / 2), of(MAX_IN_ONE_LEGEND));
        assert!(few["data"][0]["legend"].is_null() && few["layout"]["legend2"].is_null());
        assert_eq!(few["layout"]["legend"]["orientation"], "h");
        let legends = [0, MAX_IN_ONE_LEGEND].map(|k| many["data"][k]["legend"].clone());
        assert_eq!(legends, [json!("legend"), json!("legend2")]);
        for (legend, axis) in [("legend", "yaxis"), ("legend2", "yaxis2")] {
            assert_eq!(
                many["layout"][legend]["y"], many["layout"][axis]["domain"][1],
                "at the top of its graph"
            );
        }
    }

    #[test]
    fn number_and_date_of_a_run_stand_below_each_of_its_graphs() {
        let figures = [figure(None), figure(None)];
        let plots = plots(figures.iter(), "run 3, 2026-11-22T14:05:00Z");
        for plot in plots["plots"].as_array().expect("plots") {
            assert_eq!(plot["layout"]["annotations"][0]["text"], "run 3, 2026-11-22T14:05:00Z");
        }
    }

    #[test]
    fn curves_over_the_same_time_share_it_and_a_value_that_is_none_leaves_a_gap() {
        let plots = plots([figure(None), figure(None)].iter(), "");
        assert_eq!(plots["axes"], json!([[0.0, 1.0]]));
        for trace in plots["plots"][1]["data"].as_array().expect("traces") {
            assert_eq!((&trace["x"], &trace["y"]), (&json!(0), &json!([4.125, null])));
        }
    }

    #[test]
    fn graphs_stand_under_each_other_over_one_axis() {
        let plots = plots(std::iter::once(&figure(None)), "");
        let layout = &plots["plots"][0]["layout"];
        assert_eq!(layout["xaxis"]["anchor"], "y3");
        let top = |name: &str| layout[name]["domain"][1].as_f64().expect("a place");
        assert!(top("yaxis") > top("yaxis2") && top("yaxis2") > top("yaxis3"), "{layout}");
    }
}
