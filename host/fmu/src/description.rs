//! modelDescription.xml (FMI 3.0, 2.4 and 4.4; FMI 2.0, 2.2 and 4.3).

use std::fmt::Write;

use pneudrive_sim::Rig;

use crate::part::Part;
use crate::signal::Kind;
use crate::standard::Standard;
use crate::variable::{Role, Variable, variables};

/// A unit of the rig files in SI: its name there, how many of the base unit it is, and the exponents of its base units
/// as attributes.
struct Unit {
    name: &'static str,
    factor: f64,
    exponents: &'static str,
}

const fn unit(name: &'static str, factor: f64, exponents: &'static str) -> Unit {
    Unit { name, factor, exponents }
}

/// Counts and steps are plain numbers. A gauge pressure or a temperature in degrees is no unit of a key.
const UNITS: [Unit; 34] = [
    unit("m", 1.0, "m=\"1\""),
    unit("mm", 1e-3, "m=\"1\""),
    unit("um", 1e-6, "m=\"1\""),
    unit("s", 1.0, "s=\"1\""),
    unit("ms", 1e-3, "s=\"1\""),
    unit("us", 1e-6, "s=\"1\""),
    unit("kg", 1.0, "kg=\"1\""),
    unit("K", 1.0, "K=\"1\""),
    unit("N", 1.0, "kg=\"1\" m=\"1\" s=\"-2\""),
    unit("Pa", 1.0, "kg=\"1\" m=\"-1\" s=\"-2\""),
    unit("kPa", 1e3, "kg=\"1\" m=\"-1\" s=\"-2\""),
    unit("MPa", 1e6, "kg=\"1\" m=\"-1\" s=\"-2\""),
    unit("m3", 1.0, "m=\"3\""),
    unit("m/s", 1.0, "m=\"1\" s=\"-1\""),
    unit("mm/s", 1e-3, "m=\"1\" s=\"-1\""),
    unit("m/s2", 1.0, "m=\"1\" s=\"-2\""),
    unit("mm/s2", 1e-3, "m=\"1\" s=\"-2\""),
    unit("mm/s3", 1e-3, "m=\"1\" s=\"-3\""),
    unit("mm/h", 1e-3 / 3600.0, "m=\"1\" s=\"-1\""),
    unit("kg/s", 1.0, "kg=\"1\" s=\"-1\""),
    unit("Hz", 1.0, "s=\"-1\""),
    unit("1/s", 1.0, "s=\"-1\""),
    unit("1/s2", 1.0, "s=\"-2\""),
    unit("N s/m", 1.0, "kg=\"1\" s=\"-1\""),
    unit("N/m", 1.0, "kg=\"1\" s=\"-2\""),
    unit("N/mm", 1e3, "kg=\"1\" s=\"-2\""),
    unit("J/(kg K)", 1.0, "m=\"2\" s=\"-2\" K=\"-1\""),
    unit("W/(m2 K)", 1.0, "kg=\"1\" s=\"-3\" K=\"-1\""),
    unit("m3/(s Pa)", 1.0, "m=\"4\" s=\"1\" kg=\"-1\""),
    unit("deg", std::f64::consts::PI / 180.0, "rad=\"1\""),
    unit("rad", 1.0, "rad=\"1\""),
    unit("%", 0.01, ""),
    unit("mm/count", 1e-3, "m=\"1\""),
    unit("mm/step", 1e-3, "m=\"1\""),
];

fn unit_of(variable: &Variable) -> Option<&'static Unit> {
    let float = variable.kind == Kind::Float64;
    UNITS.iter().find(|unit| float && unit.name == variable.unit())
}

/// modelDescription.xml of a part of a rig whose file is `rig_text`.
#[must_use]
pub fn model_description(standard: Standard, part: Part, rig: &Rig, rig_text: &str) -> String {
    let variables = variables(part, rig);
    let mut xml = head(standard, part, rig, rig_text);
    xml += "  <UnitDefinitions>\n";
    let used = |unit: &&Unit| variables.iter().filter_map(unit_of).any(|other| other.name == unit.name);
    for Unit { name, factor, exponents } in UNITS.iter().filter(used) {
        let factor = if *factor == 1.0 { String::new() } else { format!(" factor=\"{factor:?}\"") };
        let base = [*exponents, factor.trim_start()].join(" ");
        line(&mut xml, 4, format_args!("<Unit name=\"{name}\"><BaseUnit {}/></Unit>", base.trim()));
    }
    xml += "  </UnitDefinitions>\n";
    xml += "  <LogCategories>\n    <Category name=\"logStatusError\" description=\"Why a call failed.\"/>\n  </LogCategories>\n";
    let period_s = f64::from(rig.period_us().get()) / 1e6;
    // The end of the test's last sample: importers take whole steps.
    let stop = (f64::from(rig.last_sample()) + 1.0) * f64::from(rig.period_us().get()) / 1e6;
    line(
        &mut xml,
        2,
        format_args!(
            "<DefaultExperiment startTime=\"0.0\" stopTime=\"{stop:?}\" stepSize=\"{period_s:?}\"/>"
        ),
    );
    xml += "  <ModelVariables>\n";
    variables.iter().for_each(|variable| line(&mut xml, 4, format_args!("{}", element(standard, variable))));
    xml += "  </ModelVariables>\n";
    structure(standard, &mut xml, &variables);
    xml + "</fmiModelDescription>\n"
}

fn line(xml: &mut String, indent: usize, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(xml, "{:indent$}{text}", "");
}

/// What a part is, in a line.
pub(crate) fn about(part: Part) -> &'static str {
    match part {
        Part::Plant => "valve, tubes, cylinder, load and sensors: a command in, a sample out",
        Part::Controller => "the controller, bit for bit that of the firmware: a sample in, a command out",
        Part::Drive => "controller and plant, joined: a setpoint in",
    }
}

fn head(standard: Standard, part: Part, rig: &Rig, rig_text: &str) -> String {
    let what = about(part);
    let (name, token) = (escaped(rig.name()), part.token(rig_text));
    let (identifier, word) = (part.identifier(), part.word());
    let period_s = f64::from(rig.period_us().get()) / 1e6;
    let fmi_version = standard.version();
    let (token_word, able) = match standard {
        Standard::Fmi2 => (
            "guid",
            "canHandleVariableCommunicationStepSize=\"true\"\n    canGetAndSetFMUstate=\"true\"".to_owned(),
        ),
        Standard::Fmi3 => (
            "instantiationToken",
            format!(
                "canHandleVariableCommunicationStepSize=\"true\"\n    fixedInternalStepSize=\"{period_s:?}\"\n    canGetAndSetFMUState=\"true\""
            ),
        ),
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiModelDescription
  fmiVersion=\"{fmi_version}\"
  modelName=\"{name}, {word}\"
  {token_word}=\"{token}\"
  description=\"Servo-pneumatic drive {name}, {what}. Its sample period is {period_s:?} s; between two samples it holds.\"
  generationTool=\"pneudrive {version}\"
  variableNamingConvention=\"structured\">
  <CoSimulation
    modelIdentifier=\"{identifier}\"
    {able}/>
",
        version = env!("CARGO_PKG_VERSION")
    )
}

/// The element of a variable.
fn element(standard: Standard, variable: &Variable) -> String {
    let &Variable { name, reference, kind, start, range, meaning, .. } = variable;
    let continuous = kind == Kind::Float64;
    let (causality, variability) = match variable.role {
        Role::Time => ("independent", "continuous"),
        // An input holds over a step.
        Role::Input(_) => ("input", "discrete"),
        Role::Output(_) => ("output", if continuous { "continuous" } else { "discrete" }),
        _ => ("parameter", if variable.is_tunable() { "tunable" } else { "fixed" }),
    };
    let initial = if matches!(variable.role, Role::Output(_)) { " initial=\"calculated\"" } else { "" };
    let mut attributes = String::new();
    let mut add = |name: &str, value: &dyn std::fmt::Display| {
        let _ = write!(attributes, " {name}=\"{value}\"");
    };
    if let Some(unit) = unit_of(variable) {
        add("unit", &unit.name);
    }
    if let Some([least, most]) = range {
        add("min", &least);
        add("max", &most);
    }
    if let Some(start) = start {
        add("start", &start);
    }
    let common = format!(
        "name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\" description=\"{}\"{initial}",
        escaped(meaning)
    );
    match standard {
        Standard::Fmi2 => {
            format!("<ScalarVariable {common}><{}{attributes}/></ScalarVariable>", word_of_2(kind))
        }
        Standard::Fmi3 => format!("<{} {common}{attributes}/>", kind.word()),
    }
}

/// The type of a variable under FMI 2.0. Its Integer has 32 bits.
fn word_of_2(kind: Kind) -> &'static str {
    match kind {
        Kind::Float64 | Kind::Int64 => "Real",
        Kind::Int32 => "Integer",
        Kind::Boolean => "Boolean",
    }
}

/// An output is the result of the last step: no input reaches it without a step.
fn structure(standard: Standard, xml: &mut String, variables: &[Variable]) {
    xml.push_str("  <ModelStructure>\n");
    for element in ["Output", "InitialUnknown"] {
        let independent = if element == "Output" { " dependencies=\"\"" } else { "" };
        let outputs = variables.iter().zip(1..).filter(|(one, _)| matches!(one.role, Role::Output(_)));
        match standard {
            // Variables by their places, from 1.
            Standard::Fmi2 => {
                line(xml, 4, format_args!("<{element}s>"));
                outputs.for_each(|(_, place)| {
                    line(xml, 6, format_args!("<Unknown index=\"{place}\"{independent}/>"));
                });
                line(xml, 4, format_args!("</{element}s>"));
            }
            Standard::Fmi3 => outputs.for_each(|(Variable { reference, .. }, _)| {
                line(xml, 4, format_args!("<{element} valueReference=\"{reference}\"{independent}/>"));
            }),
        }
    }
    xml.push_str("  </ModelStructure>\n");
}

/// A text in an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}
