//! The valve on the bench (7.1.1): its null, and the saturation of its flow.

use crate::characteristics::valve_models::{Compared, flow};
use crate::characteristics::{CURVES, Characteristic, SUPPLY_FAMILY_PA, pressure_gain};
use anyhow::{Context, Result};
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

use crate::drives::rig;
use crate::{Agreement, Chart, Entry, Exhibit, Experiment, Found, Line, Measured, Reading};

const OWN_SPREAD: &str = "the five nulls of the table lie within 0.003 mm";

pub(super) const EXHIBITS: [Exhibit; 3] = [
    Exhibit {
        section: "7.1.1.3",
        place: "Tab. 7.1",
        about: "The null of the valve does not depend on the supply pressure",
        lost: "Fig. 7.3, the pressure gain characteristics",
        commands: &["pneudrive characterise servo-b-thesis pressure-gain --out DIR"],
        entries: &[
            Entry::number("null 1", "null at 0.5065 MPa", ["9.572", "mm"], 0.003, OWN_SPREAD),
            Entry::number("null 2", "null at 0.4052 MPa", ["9.572", "mm"], 0.003, OWN_SPREAD),
            Entry::number("null 3", "null at 0.3039 MPa", ["9.572", "mm"], 0.003, OWN_SPREAD),
            Entry::number("null 4", "null at 0.2026 MPa", ["9.573", "mm"], 0.003, OWN_SPREAD),
            Entry::number("null 5", "null at 0.1013 MPa", ["9.570", "mm"], 0.003, OWN_SPREAD),
            Entry::sentence("fit", "The fitting errors of curves 4 and 5 are slightly higher."),
        ],
        why: "The micrometer's zero is a matter of its mounting: ours is put where curve 1 has its null, so what counts is how far the five lie apart. The fitting errors of curves 4 and 5 are larger than the others as parts of their supply pressure, and not in kPa: our gauges are read to 1 kPa at every pressure.",
        experiment: Experiment::Own(nulls),
        takes_s: 0.2,
    },
    Exhibit {
        section: "7.1.1.3",
        place: "Fig. 7.4",
        about: "Flow gain at a supply port of 317 kPa",
        lost: "the measured and the calculated flow gain",
        commands: &["pneudrive characterise servo-b-thesis flow-gain --out DIR"],
        entries: &[
            Entry::number("density", "density of air", ["1.2", "kg/m3"], 0.05, "printed to two digits"),
            Entry::sentence("reverse", "The reverse flow curves coincide for all values of P1."),
        ],
        why: "",
        experiment: Experiment::Own(flow_gain),
        takes_s: 0.1,
    },
    Exhibit {
        section: "7.1.1.3",
        place: "Fig. 7.5",
        about: "The flow node saturates, a single restriction does not",
        lost: "the curves of the two models",
        commands: &["pneudrive characterise servo-b-thesis valve-models --out DIR"],
        entries: &[
            Entry::sentence(
                "saturation",
                "The flow saturates at wide openings, which the single restriction model does not show.",
            ),
            Entry::sentence(
                "narrow",
                "The upstream flow head makes no substantial variation at small flow rates.",
            ),
            Entry::sentence(
                "wide",
                "The upstream flow head is significant when the valve is more than half-open.",
            ),
        ],
        why: "",
        experiment: Experiment::Own(saturation),
        takes_s: 0.1,
    },
];

/// The micrometer reading of the thesis at curve 1, mm.
const MICROMETER_MM: f64 = 9.572;

/// Resolution of the gauges, Pa.
const GAUGE_PA: f64 = 1e3;

fn curve(rig: &Rig, name: &str) -> Result<Characteristic> {
    let curve = CURVES.iter().find(|curve| curve.name == name).context("there is no such curve")?;
    Ok((curve.measure)(rig)?)
}

fn nulls() -> Result<Measured> {
    let rig = rig("servo-b-thesis", &[])?;
    let null = |above: f64| {
        let supply = rig.get(&keys::exhaust::PRESSURE_PA) + above;
        let readings = pressure_gain::read_blocked_ports(&rig, supply, GAUGE_PA)?;
        Some(pressure_gain::null_by_least_squares(&rig, supply, &readings))
    };
    let nulls: Vec<pressure_gain::Null> = SUPPLY_FAMILY_PA.iter().filter_map(|above| null(*above)).collect();
    let first = nulls.first().context("the pressures of blocked ports do not cross")?.position;
    let mut readings: Vec<Reading> = (1..)
        .zip(&nulls)
        .map(|(number, null)| {
            let (place, within) = (MICROMETER_MM + 1e3 * (null.position - first), 2e3 * null.deviation);
            let rests_on =
                "least squares over 21 places, gauges read to 1 kPa; the range is twice the standard error";
            Reading::read(&format!("null {number}"), place, within, 4, rests_on)
        })
        .collect();
    readings.push(fit(&nulls));
    let mut charts = of_curve(&curve(&rig, "pressure-gain")?, &["both blocked ports (Fig. 7.3)"]);
    charts.iter_mut().for_each(paired);
    Ok(Measured { readings, charts })
}

/// The misfits of the five curves, in kPa and as parts of their supply pressures: the thesis does not say which it means.
fn fit(nulls: &[pressure_gain::Null]) -> Reading {
    let kpa: Vec<f64> = nulls.iter().map(|null| 1e-3 * null.misfit_pa).collect();
    let percent: Vec<f64> = kpa.iter().zip(SUPPLY_FAMILY_PA).map(|(kpa, above)| 1e5 * kpa / above).collect();
    let higher = |misfits: &[f64]| misfits[3..].iter().all(|low| misfits[..3].iter().all(|high| low > high));
    let agreement = match (higher(&kpa), higher(&percent)) {
        (true, true) => Agreement::Agrees,
        (false, false) => Agreement::Differs,
        _ => Agreement::InPart,
    };
    let list =
        |misfits: &[f64]| misfits.iter().map(|misfit| format!("{misfit:.2}")).collect::<Vec<_>>().join(", ");
    let text = format!(
        "the misfits of curves 1 to 5 are {} kPa, or {} % of the supply pressure",
        list(&kpa),
        list(&percent)
    );
    Reading {
        key: "fit".to_owned(),
        found: Found::Shows { text, agreement },
        rests_on: "the same five fits".to_owned(),
    }
}

/// The curves of both ports at a supply pressure in one colour, and named once.
fn paired(chart: &mut Chart) {
    for (place, line) in chart.lines.iter_mut().enumerate() {
        line.colour = Some(place / 2);
        line.name = if place % 2 == 0 { line.name.replace("P1, ", "") } else { String::new() };
    }
}

/// Each graph of a bench test.
fn of_curve(found: &Characteristic, titles: &[&str]) -> Vec<Chart> {
    let chart = |(graph, title): (&crate::characteristics::Graph, &&str)| Chart {
        title: (*title).to_owned(),
        across: found.across,
        up: graph.title,
        lines: graph.series.iter().map(|series| Line::new(&series.name, &series.x, &series.y)).collect(),
        ..Chart::default()
    };
    found.graphs.iter().zip(titles).map(chart).collect()
}

fn flow_gain() -> Result<Measured> {
    let rig = rig("servo-b-thesis", &[])?;
    let density = rig.get(&keys::exhaust::PRESSURE_PA)
        / (rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K) * rig.get(&keys::exhaust::TEMPERATURE_K));
    let readings = vec![
        Reading::exact("density", density, 3, "C(2), C(7), C(8)"),
        Reading::nothing(
            "reverse",
            "on the bench each port is solved on its own, so no test of it could fail",
        ),
    ];
    let charts = of_curve(&curve(&rig, "flow-gain")?, &["by supply pressure", "by back pressure (Fig. 7.4)"]);
    Ok(Measured { readings, charts })
}

/// Pressures of supply port and port 1 in Fig. 7.4 and 7.5, Pa.
const FIG_7_5_PA: [f64; 2] = [317e3, 110e3];

fn saturation() -> Result<Measured> {
    let rig = rig("servo-b-thesis", &[])?;
    let at = |model, spool_mm: f64| flow(&rig, model, 1e-3 * spool_mm, FIG_7_5_PA[0], FIG_7_5_PA[1]);
    let gained = |model| at(model, 1.0) / at(model, 0.5);
    let [node, single] = [Compared::FlowNodeWithApproach, Compared::SingleRestriction].map(gained);
    let head = |spool_mm| {
        100.0 * (at(Compared::FlowNodeWithApproach, spool_mm) / at(Compared::FlowNode, spool_mm) - 1.0)
    };
    let bench = "flow of port 1 at 110 kPa from a supply port at 317 kPa";
    let readings = vec![
        Reading::shows(
            "saturation",
            node < 1.25 && single > 1.75,
            format!(
                "from half to full opening the flow grows by a factor of {node:.2}, that of a single restriction by {single:.2}"
            ),
            bench,
        ),
        Reading::shows(
            "narrow",
            head(0.05) < 5.0,
            format!("at 0.05 mm it makes {:.1} %, at 0.1 mm {:.1} %", head(0.05), head(0.1)),
            bench,
        ),
        Reading::shows(
            "wide",
            head(0.5) > 5.0 && head(1.0) > head(0.5),
            format!("at half opening it makes {:.0} %, at full opening {:.0} %", head(0.5), head(1.0)),
            bench,
        ),
    ];
    let charts = of_curve(
        &curve(&rig, "valve-models")?,
        &["supply port at 589 kPa", "supply port at 317 kPa (Fig. 7.5)"],
    );
    Ok(Measured { readings, charts })
}
