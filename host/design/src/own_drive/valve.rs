//! The valve by ISO 6358, and the spool that opens it.

use std::f64::consts::PI;

use pneudrive_sim::component::operator;
use pneudrive_sim::component::valve::lands;
use pneudrive_sim::component::valve::model::{by_conductance, by_map};
use pneudrive_sim::keys;

use super::cylinder::{middle, part_of};
use crate::flow_answer::StatedFlow;
use crate::flow_map;
use crate::parts::{Family, Part, find};
use crate::question::{AnswerProblem, Answers};
use crate::rig_file::{Number, RigFile};

/// Spool travel to either side, mm. No figure of the valve: the paths open in proportion, so only ratios to it count.
const TRAVEL_MM: f64 = 1.0;
/// The damping ratio of a spool with a position loop, and its range.
const DAMPING: (f64, [f64; 2]) = (0.7, [0.5, 1.0]);
/// The class whose ranges stand in for missing figures of a valve.
const CLASS: &str = "proportional-5-3-350";

/// C of the answers, m^3/(s Pa).
pub(super) fn sonic_conductance(answers: &Answers) -> Result<f64, AnswerProblem> {
    if let Some(rows) = measured_map(answers)? {
        return Ok(flow_map::largest_conductance(&rows));
    }
    let (named, class) = parts_of(answers)?;
    let ratio = critical_ratio(answers, named.as_ref().unwrap_or(&class))?;
    Ok(conductance(answers, named.as_ref(), &ratio)?.value)
}

/// The part of the command without motion: the overlap, half of the hysteresis, and the opening against the leakage.
pub(super) fn dead_zone(answers: &Answers) -> Result<f64, AnswerProblem> {
    let (named, class) = parts_of(answers)?;
    let part = named.as_ref().unwrap_or(&class);
    let overlap = usual(answers, "overlap", part, "overlap", "%")?.value;
    let hysteresis = usual(answers, "hysteresis", part, "hysteresis", "%")?.value;
    let leakage = figure_of(part, "leakage_in_centre", "%")?.value;
    // The hysteresis is of the range from end to end, two travels.
    Ok(1e-2 * (overlap + hysteresis + leakage).max(0.0))
}

/// The named valve, and the class that stands in for its missing figures.
fn parts_of(answers: &Answers) -> Result<(Option<Part>, Part), AnswerProblem> {
    let class = find(Family::Valve, CLASS).map_err(|message| AnswerProblem::new("valve", message))?;
    Ok((part_of(answers, "valve", Family::Valve)?, class))
}

pub(super) fn write(file: &mut RigFile, answers: &Answers) -> Result<(), AnswerProblem> {
    let (named, class) = parts_of(answers)?;
    let part = named.as_ref().unwrap_or(&class);
    if let Some(rows) = measured_map(answers)? {
        write_map(file, &rows, answers.text(MAP).unwrap_or_default());
        return spool(file, answers, part);
    }
    let ratio = critical_ratio(answers, part)?;
    file.word(&keys::valve::MODEL, by_conductance::MODEL, "by its conductance");
    file.optional(
        &keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA,
        &conductance(answers, named.as_ref(), &ratio)?,
    );
    file.optional(&keys::iso6358::CRITICAL_RATIO, &ratio);
    exhaust(file, named.as_ref());
    let ellipse = "the ellipse of ISO 6358; measured components lie near it";
    file.number(&keys::iso6358::SUBSONIC_INDEX, &Number::typical(0.5, [0.4, 0.6], ellipse));
    lands(file, answers, part)?;
    spool(file, answers, part)
}

/// The remark on an answer that says too little: a flow without its pressures.
pub(super) fn remark(answers: &Answers) -> Option<String> {
    let text = answers.text("flow")?;
    let stated = StatedFlow::read(text).ok()?;
    stated.pressures.is_none().then(|| {
        format!(
            "--flow: \"{text}\" has no pressures, and counts as the flow from 6 to 5 bar(g) at 20 degC; where the data sheet has others, write them: \"{text}, 6 to 5 bar(g)\""
        )
    })
}

/// The question for a measured map.
const MAP: &str = "flow-map";

/// The measured map of the answers.
fn measured_map(answers: &Answers) -> Result<Option<Vec<flow_map::Row>>, AnswerProblem> {
    let Some(path) = answers.text(MAP) else { return Ok(None) };
    let refuse = |message: String| AnswerProblem::new(MAP, message);
    let others = ["conductance", "critical-ratio", "flow", "kv", "cv", "overlap"];
    if let Some(other) = others.into_iter().find(|name| answers.text(name).is_some()) {
        return Err(refuse(format!("has the flow of the valve already: leave out --{other}")));
    }
    let bytes = std::fs::read(path).map_err(|error| refuse(format!("cannot read {path}: {error}")))?;
    let rows = flow_map::rows(&bytes).map_err(|message| refuse(format!("{path} is no map: {message}")))?;
    Ok(Some(rows))
}

fn write_map(file: &mut RigFile, rows: &[flow_map::Row], path: &str) {
    file.word(&keys::valve::MODEL, by_map::MODEL, "as measured");
    let scale = "a scale: the map is over the part of the travel";
    file.number(&keys::valve::SPOOL_TRAVEL_MM, &Number::computed(TRAVEL_MM, scale));
    let why = format!(
        "given: {path}; spool %, upstream and downstream kPa, flow and its standard deviation l/min (ANR)"
    );
    file.text(&keys::flow_map::FLOW_MAP, flow_map::to_toml(rows), &why);
    let shift = Number::computed(0.0, "the points as measured; two standard deviations to either side");
    file.number(&keys::flow_map::FLOW_MAP_SHIFT, &shift.within(Some([-2.0, 2.0])));
}

/// The path to the exhaust, where the catalogue has figures of its own for it.
fn exhaust(file: &mut RigFile, part: Option<&Part>) {
    let figure = |name: &str, unit: &str| {
        let (part, figure) = part.and_then(|part| Some((part, part.figure(name)?)))?;
        Some((figure.value_in(unit).ok()?, format!("{}: {}", part.name, figure.basis)))
    };
    for (key, name, unit) in [
        (&keys::iso6358::EXHAUST_SONIC_CONDUCTANCE_M3_PER_S_PA, "sonic_conductance_exhaust", "m3/(s Pa)"),
        (&keys::iso6358::EXHAUST_CRITICAL_RATIO, "critical_ratio_exhaust", ""),
    ] {
        if let Some((value, from)) = figure(name, unit) {
            file.optional(key, &Number::given(value, from));
        }
    }
}

/// Critical pressure ratio b.
fn critical_ratio(answers: &Answers, part: &Part) -> Result<Number, AnswerProblem> {
    let question = "critical-ratio";
    let ratio = usual(answers, question, part, "critical_ratio", "")?;
    if !(0.0..1.0).contains(&ratio.value) {
        let message =
            format!("{} is none: b lies from 0 to below 1, and from 0.1 to 0.5 for valves", ratio.value);
        return Err(AnswerProblem::new(question, message));
    }
    if ratio.value > 0.5 {
        let message = format!(
            "{} is that of a nozzle (0.528), not of a valve: 0.1 to 0.5. Many pages print it; leave it out if the data sheet has none",
            ratio.value
        );
        return Err(AnswerProblem::new(question, message));
    }
    // The middle of the range that 5/3 spool valves have.
    let value = if ratio.source == pneudrive_sim::rig::Source::Unknown { 0.3 } else { ratio.value };
    Ok(Number { value, ..ratio })
}

/// C, from the flow figure that is known.
fn conductance(answers: &Answers, part: Option<&Part>, ratio: &Number) -> Result<Number, AnswerProblem> {
    let figures = ["conductance", "flow", "kv", "cv"];
    let given: Vec<&str> = figures.into_iter().filter(|name| answers.text(name).is_some()).collect();
    if let [_, second, ..] = given[..] {
        let question = figures.into_iter().find(|name| *name == second).unwrap_or("flow");
        let message = format!("is one figure too many beside --{}: both say how much passes", given[0]);
        return Err(AnswerProblem::new(question, message));
    }
    if let Some(sonic) = answers.number("conductance")? {
        return Ok(Number::given(sonic, answers.text("conductance").unwrap_or_default()));
    }
    let of_part = |name: &str, unit: &str| part.and_then(|part| part.figure(name)?.value_in(unit).ok());
    let nominal = |flow: f64, from: String| by_flow(&StatedFlow { flow, pressures: None }, ratio, from);
    if let Some(text) = answers.text("flow") {
        let stated = StatedFlow::read(text).map_err(|message| AnswerProblem::new("flow", message))?;
        let taken = if stated.pressures.is_some() { "" } else { ", taken from 6 to 5 bar(g)" };
        return Ok(by_flow(&stated, ratio, format!("a flow of {text}{taken}")));
    }
    for (question, water) in [("kv", 1.0), ("cv", 0.865)] {
        if let Some(value) = answers.number(question)? {
            let kv = value * water;
            let from = format!(
                "{question} = {value}: Qn = 1189 Kv l/min, Kv = 0.865 Cv, for small drops; 15 % either way"
            );
            return Ok(widened(nominal(1189e-3 / 60.0 * kv, from), 0.15));
        }
    }
    if let (Some(part), Some(sonic)) = (part, of_part("sonic_conductance", "m3/(s Pa)")) {
        return Ok(Number::given(sonic, part.name.clone()));
    }
    match (part, of_part("nominal_flow", "m3/s")) {
        (Some(part), Some(flow)) => Ok(nominal(flow, format!("{}, its nominal flow", part.name))),
        _ => Err(AnswerProblem::new(
            "flow",
            "is needed, such as \"350 l/min\" (6 to 5 bar(g)), or --conductance, --kv, --cv, or a --valve of the catalogue",
        )),
    }
}

/// C of a flow, over the range of b.
fn by_flow(stated: &StatedFlow, ratio: &Number, from: String) -> Number {
    let sonic = |b: f64| stated.conductance(b).sonic;
    let ends = ratio.range.map(|[low, high]| [sonic(high), sonic(low)]);
    Number::computed(sonic(ratio.value), format!("{from}, and b (ISO 6358, 20 degC)")).within(ends)
}

fn widened(number: Number, part: f64) -> Number {
    let [low, high] = number.range.unwrap_or([number.value; 2]);
    number.within(Some([low * (1.0 - part), high * (1.0 + part)]))
}

/// How the lands open, and the leakage when they are shut.
fn lands(file: &mut RigFile, answers: &Answers, part: &Part) -> Result<(), AnswerProblem> {
    let scale = "a scale: the paths open in proportion, so only ratios to it count";
    file.number(&keys::valve::SPOOL_TRAVEL_MM, &Number::computed(TRAVEL_MM, scale));
    file.word(
        &keys::lands::CHARACTERISTIC,
        lands::CharacteristicKind::Linear,
        "in proportion to the spool, beyond its overlap",
    );
    let overlap = usual(answers, "overlap", part, "overlap", "%")?;
    let from = format!("{} of the spool's travel", described(&overlap, "%"));
    file.number(&keys::valve::UNDERLAP_MM, &overlap.map(|percent| 1e-2 * percent * TRAVEL_MM, from));
    let leakage = figure_of(part, "leakage_in_centre", "%")?;
    file.number(&keys::lands::LEAKAGE_PERCENT, &leakage);
    Ok(())
}

/// How the spool follows its command: (6.32) with the critical frequency as its natural one.
fn spool(file: &mut RigFile, answers: &Answers, part: &Part) -> Result<(), AnswerProblem> {
    let bandwidth = usual(answers, "bandwidth", part, "critical_frequency", "Hz")?;
    let hysteresis = usual(answers, "hysteresis", part, "hysteresis", "%")?;
    file.word(
        &keys::operator::MODEL,
        operator::OperatorKind::Empirical,
        "a spool with a position loop: second order",
    );
    let codes = "the converter of a board has codes for so many to either side of its middle";
    file.integer(&keys::operator::MAX_COMMAND_COUNTS, operator::MAX_WITH_CODES, codes);
    let from = format!("(2 pi f)^2, f = {}", described(&bandwidth, "Hz"));
    file.number(
        &keys::empirical::STIFFNESS_PER_MASS_PER_S2,
        &bandwidth.map(|f| (2.0 * PI * f).powi(2), from),
    );
    let (ratio, ends) = DAMPING;
    let at = |ratio: f64| 4.0 * PI * ratio * bandwidth.value;
    let from = "damping ratio of 0.7, between 0.5 and 1: -3 dB at the natural frequency";
    file.number(&keys::empirical::DAMPING_PER_S, &Number::typical(at(ratio), ends.map(at), from));
    file.number(&keys::hysteresis::HYSTERESIS_PERCENT, &hysteresis);
    let none = "no dither: the valve's own amplifier sees to it";
    file.number(&keys::dither::DITHER_MM, &Number::typical(0.0, [0.0, 0.05], none));
    file.number(&keys::amplifier::SATURATION_MM, &Number::computed(TRAVEL_MM, "the spool's travel"));
    Ok(())
}

/// An answer, or the usual value: unknown within its range.
fn usual(
    answers: &Answers,
    question: &'static str,
    part: &Part,
    figure: &str,
    unit: &str,
) -> Result<Number, AnswerProblem> {
    match answers.number(question)? {
        Some(value) => Ok(Number::given(value, answers.text(question).unwrap_or_default())),
        None => figure_of(part, figure, unit),
    }
}

/// A figure of a part: its value, or the middle of its range.
fn figure_of(part: &Part, name: &str, unit: &str) -> Result<Number, AnswerProblem> {
    let refuse = |message: String| AnswerProblem::new("valve", message);
    let class = find(Family::Valve, CLASS).map_err(refuse)?;
    let figure = part.figure(name).or_else(|| class.figure(name));
    let figure = figure.ok_or_else(|| refuse(format!("{} has no {name}", part.name)))?;
    if figure.value.is_some() {
        return figure.value_in(unit).map(|value| Number::given(value, &figure.basis)).map_err(refuse);
    }
    let range = figure.range_in(unit).map_err(refuse)?;
    Ok(middle(range.ok_or_else(|| refuse(format!("{} has no {name}", part.name)))?, &figure.basis))
}

/// "50 to 130 Hz, unknown" or "100 Hz".
fn described(number: &Number, unit: &str) -> String {
    match number.range {
        Some([low, high]) => format!("{low} to {high} {unit} ({})", number.source.word()),
        None => format!("{} {unit}", number.value),
    }
}
