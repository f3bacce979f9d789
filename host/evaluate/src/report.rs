//! The page of transients: position with setpoint, both pressures, spool, command and error over a common time axis.

use crate::transient::{COMMAND, Transient};
use pneudrive_report::{Curve, Figure, Look, Page, Panel, Shade, Table};

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

/// The page of some transients, the first of which is the reference, under the tables of their deviations.
#[must_use]
pub fn page(title: &str, notes: Vec<String>, transients: &[Transient], tables: Vec<Table>) -> Page {
    Page {
        title: title.to_owned(),
        notes,
        tables,
        figures: vec![Figure::over_time(panels(transients))],
        runs: runs(transients),
    }
}

/// Number and date of those transients that are runs of a folder, by name if there are several transients.
#[must_use]
pub fn runs(transients: &[Transient]) -> String {
    let of = |transient: &Transient| {
        let run = transient.numbered.as_ref()?;
        let name = if transients.len() > 1 { format!("{}: ", transient.name) } else { String::new() };
        Some(format!("{name}{run}"))
    };
    transients.iter().filter_map(of).collect::<Vec<_>>().join("; ")
}

/// The graphs of some transients, the first of which is the reference.
#[must_use]
pub fn panels(transients: &[Transient]) -> Vec<Panel> {
    let curves = |channels: &[(usize, &str)]| {
        let all = transients.iter().enumerate().flat_map(|(number, transient)| {
            channels.iter().map(move |&(channel, label)| (number, transient, channel, label))
        });
        // The setpoint is the same for all.
        all.filter(|(number, _, channel, _)| *number == 0 || *channel != 0)
            .map(|(number, transient, channel, label)| curve(transient, number, channel, label))
            .collect()
    };
    let bands = |channels: &[(usize, &str)]| {
        let all = transients.iter().enumerate().flat_map(|(number, transient)| {
            channels.iter().filter_map(move |&(channel, _)| shade(transient, number, channel))
        });
        all.collect()
    };
    let graphs = GRAPHS.iter();
    let graphs = graphs
        .map(|(title, channels)| Panel { bands: bands(channels), ..Panel::new(title, curves(channels)) });
    graphs.chain(extra_panels(transients)).collect()
}

/// Graphs of the columns that not every trace has: title with unit, what their names end in, and the factor from the unit
/// of the column. A name ends in its unit, which its label leaves out; a column without a unit is named whole.
const EXTRA_GRAPHS: [(&str, &str, f64); 11] = [
    ("pressures in supply and valve, kPa", "_pa", 1e-3),
    ("temperatures in supply and valve, K", "_k", 1.0),
    ("flows of supply and lands, g/s", "_kg_s", 1e3),
    ("places in the law, mm", "_mm", 1.0),
    ("velocities in the law, m/s", "_m_s", 1.0),
    ("forces in the law, N", "_n", 1.0),
    ("learned mass, kg", "_kg", 1.0),
    ("learned friction, parts", "_share", 1.0),
    ("learned lag, ms", "_ms", 1.0),
    ("phase of the law", "law_phase", 1.0),
    ("looseness of its rest", "law_looseness", 1.0),
];

/// Those of [`EXTRA_GRAPHS`] of which a transient has a column.
fn extra_panels(transients: &[Transient]) -> impl Iterator<Item = Panel> {
    EXTRA_GRAPHS.iter().filter_map(|&(title, end, factor)| {
        let curves = transients.iter().flat_map(|transient| {
            let of_graph = transient.extras.iter().filter(move |(extra, _)| extra.name.ends_with(end));
            of_graph.map(move |(extra, values)| {
                let label = extra.name.strip_suffix(end).filter(|label| !label.is_empty());
                let label = label.unwrap_or(extra.name).replace('_', " ");
                let values = values.iter().map(|value| factor * value).collect();
                Curve::new(&format!("{label}, {}", transient.name), transient.time.clone(), values)
            })
        });
        let curves: Vec<Curve> = curves.collect();
        (!curves.is_empty()).then(|| Panel::new(title, curves))
    })
}

/// The range of a simulated run and its perturbed runs.
fn shade(transient: &Transient, number: usize, channel: usize) -> Option<Shade> {
    let band = transient.band.as_ref()?;
    (!band.low[channel].is_empty()).then(|| Shade {
        name: format!("{} and its perturbed runs", transient.name),
        x: transient.time.clone(),
        low: band.low[channel].clone(),
        high: band.high[channel].clone(),
        colour: COLOURS[number % COLOURS.len()][channel],
        steps: channel == COMMAND,
    })
}

fn curve(transient: &Transient, number: usize, channel: usize, label: &str) -> Curve {
    Curve {
        name: if channel == 0 { label.to_owned() } else { format!("{label}, {}", transient.name) },
        x: transient.time.clone(),
        y: transient.channels[channel].clone(),
        look: match (matches!(channel, 0 | 5), number) {
            (true, 0) => Look::Steps,
            (true, _) => Look::DashedSteps,
            (false, 0) => Look::Line,
            (false, _) => Look::Dashed,
        },
        colour: Some(COLOURS[number % COLOURS.len()][channel]),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use pneudrive_sim::trace::EXTRAS;
    use pneudrive_sim::{Accuracy, Rig, run};

    use super::*;

    fn with_every_column() -> Transient {
        let rig = Rig::builtin("servo-b").expect("a built-in rig");
        let rig = rig.with_settings(&["test.duration_s=0.01".to_owned()]).expect("a valid rig");
        let trace = run(&rig, Accuracy::of_motion(&rig)).expect("a transient");
        let extras = EXTRAS.iter().map(|extra| (extra, vec![0.0])).collect();
        Transient { extras, ..Transient::of_simulation("one", &rig, &trace) }
    }

    #[test]
    fn each_curve_has_a_name_of_its_own() {
        let transients = [with_every_column()];
        let panels = extra_panels(&transients);
        let names: Vec<String> = panels.flat_map(|panel| panel.curves).map(|curve| curve.name).collect();
        assert_eq!(names.len(), EXTRAS.len(), "each column is in one graph");
        let unlike: BTreeSet<&String> = names.iter().collect();
        assert_eq!(unlike.len(), names.len(), "{names:#?}");
        for name in names {
            let label = name.strip_suffix(", one").expect("the transient is named");
            assert!(label.trim() == label && label != "law", "{name:?} says what it shows");
        }
    }
}
