//! `pneudrive rig new` and `rig parts`.

use std::io::{BufRead, IsTerminal, stdin};
use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Parser;
use pneudrive_design::own_drive::{remarks, rig_file};
use pneudrive_design::parts::{self, Family, Figure, Part};
use pneudrive_design::question::{AnswerProblem, Answers, QUESTIONS, Question, question_of};
use pneudrive_design::suggestion::{changed, suggestion};
use pneudrive_design::values;
use pneudrive_records::whole_file;
use pneudrive_sim::component::controller::Law;
use pneudrive_sim::{Rig, keys};
use serde_json::{Map, Value, json};

use crate::cli::{Cli, Command, NewRig};
use crate::command::tune;
use crate::json;

/// Questions that an answer to another one makes redundant.
const IDLE: &[(&str, &[&str])] = &[
    ("cylinder", &["bore", "rod"]),
    ("valve", &["conductance", "flow", "kv", "cv"]),
    ("conductance", &["flow", "kv", "cv"]),
    ("flow", &["kv", "cv"]),
    ("kv", &["cv"]),
    ("flow-map", &["conductance", "critical-ratio", "flow", "kv", "cv", "overlap"]),
    ("tube", &["tube-bore"]),
];

/// The question of the control law. Only the gain profile is tuned.
const LAW: &str = "law";

pub(super) fn execute(arguments: &NewRig) -> Result<()> {
    let file = &arguments.file;
    if file.exists() && !arguments.overwrite {
        bail!("{} already exists: choose another file, or add --overwrite", file.display());
    }
    let mut answers = arguments.answers.0.clone();
    if arguments.tune.is_some() && answers.text(LAW).is_none() {
        answers.answer(question_of(LAW).expect("a question"), Law::GainProfile.word());
    }
    if !arguments.no_questions && stdin().is_terminal() {
        ask(&mut answers, &mut stdin().lock())?;
    }
    let name = name_of(file)?;
    let text = rig_file(&name, &answers).map_err(|wrong| refused(arguments, &answers, &wrong))?;
    remarks(&answers).iter().for_each(|remark| tell!("{remark}"));
    whole_file::put(file, &text).with_context(|| format!("cannot write {}", file.display()))?;
    let rig = Rig::read(&name, &text)?;
    let counts = values::count(&rig).map(|(source, count)| format!("{count} {}", source.word()));
    json::figures(|| {
        let values: Map<String, Value> = values::count(&rig)
            .map(|(source, count)| (source.word().to_owned(), json!(count)))
            .into_iter()
            .collect();
        json!({ "file": file, "values": values })
    });
    say!("{}: a rig of {} values", file.display(), counts.join(", "));
    if let Some(folder) = &arguments.tune {
        return tuned(file, &rig, folder, arguments.generations);
    }
    say!("next: pneudrive simulate {} --out sim", file.display());
    if rig.get(&keys::controller::LAW) == Law::GainProfile {
        say!("      pneudrive {}", tuning(file, &rig, Path::new("tuned"), GENERATIONS).join(" "));
    }
    Ok(())
}

/// The problem of each answer, and a command with other answers that works.
fn refused(arguments: &NewRig, answers: &Answers, wrong: &[AnswerProblem]) -> anyhow::Error {
    let mut lines: Vec<String> = wrong.iter().map(ToString::to_string).collect();
    lines.extend(suggestion("own", answers).map(|others| {
        let changed = changed(answers, &others).join(", ");
        format!("this works: {}\n  with {changed}", command_of(arguments, &others))
    }));
    anyhow::anyhow!("{}", lines.join("\n"))
}

/// The command line of other answers.
fn command_of(arguments: &NewRig, answers: &Answers) -> String {
    let options = answers.given().map(|(name, text)| format!(" --{name} {}", quoted(text)));
    let flags = [(arguments.no_questions, " --no-questions"), (arguments.overwrite, " --overwrite")];
    let flags = flags.into_iter().filter_map(|(given, flag)| given.then_some(flag));
    format!(
        "pneudrive rig new {}{}{}",
        quoted(&arguments.file.display().to_string()),
        options.collect::<String>(),
        flags.collect::<String>()
    )
}

/// A word as shells take it.
fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./:,@%".contains(letter);
    match word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("\"{}\"", word.replace('"', "\\\"")),
    }
}

/// The step that gains are looked for, mm, at most; and of the stroke.
const STEP_MM: f64 = 60.0;
const STEP_SHARE: f64 = 0.4;
/// Generations of the search that is proposed.
const GENERATIONS: u16 = 10;

/// The arguments of the tuning of a new rig: friction that nobody has measured leaves a millimetre at best.
fn tuning(file: &Path, rig: &Rig, folder: &Path, generations: u16) -> Vec<String> {
    let stroke_mm = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let step = STEP_MM.min((STEP_SHARE * stroke_mm).floor());
    let tolerance = if rig.is_set(&keys::test::TOLERANCE_MM) { "" } else { " --tolerance-mm 1" };
    let options = format!("--step {step}{tolerance} --population 16 --generations {generations} --out");
    let paths = [file, folder].map(|path| path.display().to_string());
    let [file, folder] = paths;
    std::iter::once("tune".to_owned())
        .chain([file])
        .chain(options.split(' ').map(str::to_owned))
        .chain([folder])
        .collect()
}

/// Tunes the new rig, as the command that is shown does.
fn tuned(file: &Path, rig: &Rig, folder: &Path, generations: u16) -> Result<()> {
    let arguments = tuning(file, rig, folder, generations);
    tell!("pneudrive {}", arguments.join(" "));
    let command = Cli::try_parse_from(std::iter::once("pneudrive".to_owned()).chain(arguments))?.command;
    let Command::Tune(arguments) = command else { bail!("the tuning is no tuning") };
    tune::execute(&arguments)?;
    say!("next: pneudrive simulate {} --out step", folder.join("tuned.toml").display());
    Ok(())
}

fn name_of(file: &Path) -> Result<String> {
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    stem.map(str::to_owned).with_context(|| format!("{} is not a file name", file.display()))
}

/// Asks the open questions, one line each; an empty line takes the default.
fn ask(answers: &mut Answers, input: &mut impl BufRead) -> Result<()> {
    tell!("An empty line takes the value in brackets. Any unit of the quantity is accepted.");
    for question in QUESTIONS {
        while answers.text(question.name).is_none() && !is_idle(answers, question) {
            tell!("{}", prompt(question));
            let mut line = String::new();
            if input.read_line(&mut line)? == 0 {
                return Ok(());
            }
            answers.answer(question, &line);
            match check(answers, question) {
                Ok(()) if answers.text(question.name).is_some() || !question.without.is_empty() => break,
                Ok(()) => tell!("  this value is needed, such as \"{}\"", question.example),
                Err(message) => {
                    tell!("  {message}");
                    answers.answer(question, "");
                }
            }
        }
    }
    Ok(())
}

fn prompt(question: &Question) -> String {
    let without = if question.without.is_empty() { "needed" } else { question.without };
    format!("{}, such as \"{}\" [{without}]:", question.prompt, question.example)
}

/// Whether another answer has made a question redundant.
fn is_idle(answers: &Answers, question: &Question) -> bool {
    IDLE.iter().any(|(other, idle)| answers.text(other).is_some() && idle.contains(&question.name))
}

/// Checks an answer on its own.
fn check(answers: &Answers, question: &Question) -> Result<(), String> {
    let family = Family::ALL.into_iter().find(|family| family.word() == question.name);
    match (family, answers.text(question.name)) {
        (_, None) => Ok(()),
        (Some(family), Some(name)) => parts::find(family, name).map(|_| ()),
        (None, Some(_)) => answers.reading(question.name).map(|_| ()).map_err(|refusal| refusal.message),
    }
}

/// The catalogue: all parts, or one in full.
pub(super) fn list_parts(name: Option<&str>) -> Result<()> {
    let all: Vec<Part> = Family::ALL.into_iter().flat_map(parts::parts).collect();
    let Some(name) = name else {
        json::figures(|| json!({ "parts": all.iter().map(figures).collect::<Vec<_>>() }));
        for part in &all {
            say!("{:<10} {:<28} {}", part.family.word(), part.name, in_a_line(part));
        }
        return Ok(());
    };
    let Some(part) = all.iter().find(|part| part.name == name) else {
        bail!("the catalogue has no {name} (`pneudrive rig parts` lists all parts)");
    };
    json::figures(|| json!({ "parts": [figures(part)] }));
    say!("{} ({})", part.name, part.family.word());
    for (fact, text) in part.facts.iter().filter(|(fact, _)| fact != "class") {
        say!("  {fact}: {text}");
    }
    for figure in &part.figures {
        let range = figure.range.as_ref().map(|[low, high]| format!("{low} to {high}"));
        let value = figure.value.clone().or(range).unwrap_or_else(|| "unknown".to_owned());
        say!("  {:<32} {value:<28} {}", figure.name.replace('_', " "), figure.basis);
    }
    Ok(())
}

/// A part with its figures, each as the catalogue writes it.
fn figures(part: &Part) -> Value {
    let facts: Map<String, Value> =
        part.facts.iter().map(|(fact, text)| (fact.clone(), json!(text))).collect();
    let one = |figure: &Figure| json!({ "name": figure.name, "value": figure.value, "range": figure.range, "basis": figure.basis });
    json!({
        "family": part.family.word(),
        "name": part.name,
        "facts": facts,
        "figures": part.figures.iter().map(one).collect::<Vec<_>>(),
    })
}

/// The figures by which a part is chosen, and their words in the list of parts.
const CHOSEN_BY: [(&str, &str); 9] = [
    ("bore", "bore"),
    ("rod", "rod"),
    ("nominal_flow", "nominal flow"),
    ("sonic_conductance", "sonic conductance"),
    ("inner_diameter", "inner diameter"),
    ("resolution", "resolution"),
    ("range", "range"),
    ("range_gauge", "range"),
    ("response_time", "response time"),
];

/// What a part is, and the figures by which it is chosen, each once.
fn in_a_line(part: &Part) -> String {
    let about = part.fact("standard").or_else(|| part.fact("about")).or_else(|| part.fact("kind"));
    let is_told = |value: &str| about.is_some_and(|about| about.ends_with(value));
    let value = |(name, word): &(&str, &str)| {
        let figure = part.figure(name)?;
        let range = figure.range.as_ref().map(|[low, high]| format!("{low} to {high}"));
        let value = figure.value.clone().or(range).filter(|value| !is_told(value))?;
        Some(format!("{word} {value}"))
    };
    let figures = CHOSEN_BY.iter().filter_map(value).collect::<Vec<_>>().join(", ");
    let said = [about.unwrap_or_default(), figures.as_str()];
    said.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join("; ")
}
