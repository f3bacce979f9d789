//! Notes, tables and graphs of a report, for the page.

use pneudrive_report::{Curve, Figure, Look, Page, Panel, Shade};
use serde_json::{Value, json};

use crate::simulation::to_json as table;

/// A report. A missing number is null and leaves a gap.
pub(super) fn to_json(page: &Page) -> Value {
    json!({
        "title": page.title,
        "notes": page.notes,
        "tables": page.tables.iter().map(table).collect::<Vec<_>>(),
        "figures": page.figures.iter().map(figure).collect::<Vec<_>>(),
    })
}

fn figure(figure: &Figure) -> Value {
    json!({
        "heading": figure.heading,
        "across": figure.across,
        "logarithmic": figure.logarithmic,
        "panels": figure.panels.iter().map(panel).collect::<Vec<_>>(),
    })
}

fn panel(panel: &Panel) -> Value {
    json!({
        "title": panel.title,
        "logarithmic": panel.logarithmic,
        "curves": panel.curves.iter().map(curve).collect::<Vec<_>>(),
        "bands": panel.bands.iter().map(band).collect::<Vec<_>>(),
    })
}

fn curve(curve: &Curve) -> Value {
    let look = match curve.look {
        Look::Line => "line",
        Look::Dashed => "dashed",
        Look::Steps => "steps",
        Look::DashedSteps => "dashed steps",
        Look::Points => "points",
    };
    json!({ "name": curve.name, "x": curve.x, "y": curve.y, "look": look, "colour": curve.colour })
}

fn band(band: &Shade) -> Value {
    let look = if band.steps { "steps" } else { "line" };
    json!({ "name": band.name, "x": band.x, "low": band.low, "high": band.high, "look": look, "colour": band.colour })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_none_is_null() {
        let curves = vec![Curve::new("a", vec![0.0, 1.0], vec![2.0, f64::NAN])];
        let page =
            Page { figures: vec![Figure::over_time(vec![Panel::new("p", curves)])], ..Page::default() };
        let drawn = &to_json(&page)["figures"][0];
        assert_eq!(drawn["across"], "time, s");
        assert_eq!(drawn["panels"][0]["curves"][0]["y"], json!([2.0, null]));
    }
}
