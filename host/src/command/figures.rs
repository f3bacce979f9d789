//! The results of commands as JSON, by their types (docs/reference/json.md has every field). An unknown number is null.

use pneudrive_evaluate::deviation::Deviation;
use pneudrive_evaluate::replay::{ComparedQuantity, Difference, Replay};
use pneudrive_optimise::ladder::Variant;
use pneudrive_records::judged::Judged;
use pneudrive_records::words;
use pneudrive_sim::Rig;
use pneudrive_thesis::characteristics::{Characteristic, Figure, Reading};
use pneudrive_thesis::study::{Studied, Study};
use pneudrive_thesis::{Found as Shows, Printed, Shown};
use serde_json::{Value, json};

/// A simulated run; `moves` as run.json has them.
pub(super) fn run(rig: &Rig, judged: &Judged, moves: &Value) -> Value {
    json!({
        "rig": rig.name(),
        "samples": judged.run.observations.len(),
        "ensemble": judged.band.as_ref().map_or(1, |_| judged.spacing.runs),
        "converged": judged.convergence.is_converged(),
        "unconverged_from_s": judged.convergence.unconverged_from_s,
        "position_error_m": judged.convergence.error_m,
        "fault": judged.run.fault.map(|(fault, k)| json!({ "name": words::fault_name(fault), "sample": k })),
        "moves": moves,
    })
}

/// The deviations of a transient from a reference, channel by channel.
pub(super) fn deviations(all: &[Deviation]) -> Value {
    let one = |one: &Deviation| {
        json!({
            "channel": one.channel,
            "unit": one.unit,
            "samples": one.samples,
            "mean": one.mean,
            "standard_deviation": one.standard_deviation,
            "rms": one.mean_square.sqrt(),
            "largest": one.largest,
            "rms_over_range": one.fraction_of_range,
            "inside_band": one.within_band.map(|band| band.inside),
            "rms_beyond_band": one.within_band.map(|band| band.beyond),
        })
    };
    all.iter().map(one).collect()
}

/// A replay of the file of this name.
pub(super) fn replay(file: &str, replay: &Replay) -> Value {
    let difference = |first: Difference| {
        let outputs = (first.what != ComparedQuantity::Sample).then_some((first.recorded, first.replayed));
        json!({
            "sample": first.index,
            "what": first.what.name(),
            "recorded": outputs.map(|(recorded, _)| recorded),
            "replayed": outputs.map(|(_, replayed)| replayed),
        })
    };
    json!({
        "file": file,
        "samples": replay.recorded.len(),
        "differing": replay.differences,
        "first_difference": replay.first.map(difference),
        "tripped": replay.tripped.map(|(fault, k)| json!({ "name": words::fault_name(fault), "sample": k })),
        "notes": replay.notes,
    })
}

/// The figures of a component test.
pub(super) fn characteristic(name: &str, found: &Characteristic, files: [String; 2]) -> Value {
    let one = |one: &Figure| {
        let (within, sought) = match one.reading {
            Reading::Computed(_) => (None, None),
            Reading::Read { within, .. } => (Some(within), None),
            Reading::NotBetween(ends) => (None, Some(ends)),
        };
        json!({ "name": one.name, "value": one.value(), "within": within, "unit": one.unit, "not_between": sought })
    };
    let figures: Vec<Value> = found.figures.iter().map(one).collect();
    json!({ "name": name, "across": found.across, "figures": figures, "notes": found.notes, "files": files })
}

/// The findings of a study.
pub(super) fn study(study: &Study, studied: &Studied) -> Value {
    let one = |(statement, finding): (
        &pneudrive_thesis::study::Statement,
        &pneudrive_thesis::study::Finding,
    )| {
        json!({ "thesis": statement.thesis, "model": finding.shows, "verdict": finding.verdict.word() })
    };
    let findings: Vec<Value> = study.statements.iter().zip(&studied.findings).map(one).collect();
    json!({ "name": study.name, "section": study.section, "about": study.about, "findings": findings })
}

/// The printed values of the thesis beside ours.
pub(super) fn thesis(shown: &[Shown]) -> Value {
    let entries = shown.iter().flat_map(|one| {
        one.rows().map(|(entry, reading)| {
            let (value, range) = match reading.found {
                Shows::Figure { value, range, .. } | Shows::SizeOnly { value, range, .. } => {
                    (Some(value), Some(range))
                }
                Shows::TakenOver { value, .. } => (Some(value), None),
                Shows::Shows { .. } | Shows::Nothing(_) => (None, None),
            };
            let (printed, unit) = match entry.printed {
                Printed::Number { text, unit, .. } => (text, unit),
                Printed::Sentence(text) => (text, ""),
            };
            json!({
                "section": one.exhibit.section,
                "place": one.exhibit.place,
                "key": reading.key,
                "printed": printed,
                "unit": unit,
                "value": value,
                "least": range.map(|[least, _]| least),
                "most": range.map(|[_, most]| most),
                "verdict": reading.agreement(&entry).word(),
                "rests_on": reading.rests_on,
            })
        })
    });
    json!({ "entries": entries.collect::<Vec<_>>() })
}

/// The variants of `ladder`, each with its deviations from the reference: its own run, then each perturbed run.
pub(super) fn ladder(variants: &[Variant]) -> Value {
    let one = |variant: &Variant| {
        let [time, least, most] = variant.time_over_reference;
        json!({
            "component": variant.component,
            "model": variant.model,
            "evaluations_per_sample": variant.evaluations,
            "flow_iterations_per_sample": variant.flow_iterations,
            "time_over_reference": { "value": time, "least": least, "most": most },
            "converged": variant.convergence.is_converged(),
            "deviations": variant.deviations.iter().map(|all| deviations(all)).collect::<Vec<_>>(),
        })
    };
    json!({ "variants": variants.iter().map(one).collect::<Vec<_>>() })
}
