//! `pneudrive device config`.

use std::collections::BTreeMap;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, by_name};
use pneudrive_link::client::Client;
use pneudrive_records::parameter_names::{Written, names_of};
use pneudrive_records::whole_file::put;
use pneudrive_records::words::few;
use pneudrive_session::firmware_notes::report_missing;
use pneudrive_sim::Rig;
use serde_json::{Value, json};

use crate::cli::ConfigAction;
use crate::command::rig_source::rig_text;
use crate::json;

pub(super) fn execute(client: &mut Client, action: &ConfigAction) -> Result<()> {
    match action {
        ConfigAction::Get { name: None } => {
            print_all(&read(client)?);
            Ok(())
        }
        ConfigAction::Get { name: Some(name) } => print_one(name, &read(client)?),
        ConfigAction::Set { name, value } => {
            let (name, value) = name_and_value(name, value.as_deref())?;
            let (written, entry) = parameter_of(name)?;
            let value = written.value(value)?;
            client.set_parameters(written.parameter.id + entry, &[value])?;
            json::figures(|| json!({ "parameters": [entry_figures(&written, entry, value)] }));
            say!("{}", line(&written, entry, value));
            Ok(())
        }
        ConfigAction::Export { file } => {
            put(file, &exported(&read(client)?))?;
            say!("{}: the controller's parameters", file.display());
            Ok(())
        }
        ConfigAction::Import { from } => import(client, from),
        ConfigAction::Save => {
            client.save_parameters()?;
            say!("stored; they survive a reset");
            Ok(())
        }
    }
}

/// `NAME VALUE`, or `NAME=VALUE` as `--set` takes it.
fn name_and_value<'a>(name: &'a str, value: Option<&'a str>) -> Result<(&'a str, &'a str)> {
    match (value, name.split_once('=')) {
        (Some(value), _) => Ok((name, value)),
        (None, Some((name, value))) => Ok((name.trim(), value.trim())),
        (None, None) => bail!("{name} needs a value: `device config set {name} VALUE`"),
    }
}

fn print_all(parameters: &Parameters) {
    json::figures(|| {
        let one = |written: Written| parameter_figures(&written, None, &written.all_text(parameters));
        json!({ "parameters": Written::all().map(one).collect::<Vec<_>>() })
    });
    for written in Written::all() {
        let (value, meaning) = (written.all_text(parameters), written.parameter.meaning);
        say!("{:<40} {value:>12} {:<14} {meaning}", written.name, written.unit());
    }
}

fn print_one(name: &str, parameters: &Parameters) -> Result<()> {
    if let Some(list) = Written::named(name).filter(|written| written.parameter.len > 1) {
        json::figures(
            || json!({ "parameters": [parameter_figures(&list, None, &list.all_text(parameters))] }),
        );
        say!("{} = {}", list.name, list.all_text(parameters));
        return Ok(());
    }
    let (written, entry) = parameter_of(name)?;
    let value = parameters.get(written.parameter.id + entry).unwrap_or(0);
    json::figures(|| json!({ "parameters": [entry_figures(&written, entry, value)] }));
    say!("{}", line(&written, entry, value));
    Ok(())
}

/// A parameter with its value as in a rig file: a number, a word, or a list of numbers.
fn parameter_figures(written: &Written, entry: Option<u16>, value: &str) -> Value {
    let one = |text: &str| text.parse::<f64>().map_or_else(|_| json!(text), |number| json!(number));
    let value = match value.trim_start_matches('[').trim_end_matches(']') {
        list if list.contains(',') => list.split(',').map(|text| one(text.trim())).collect(),
        single => one(single),
    };
    json!({ "name": written.name, "entry": entry, "value": value, "unit": written.unit() })
}

fn entry_figures(written: &Written, entry: u16, value: i32) -> Value {
    parameter_figures(written, (written.parameter.len > 1).then_some(entry), &written.text(value))
}

fn import(client: &mut Client, from: &str) -> Result<()> {
    let (name, Named { parameters, unnamed }) = importable(from)?;
    if !unnamed.is_empty() {
        tell!("note: {from} does not name {}; their defaults are used", few(&names_of(&unnamed)));
    }
    let left_out = client.import_parameters(&parameters)?;
    if !left_out.is_empty() {
        tell!("note: its firmware has no {}; their defaults apply", few(&names_of(&left_out)));
    }
    say!("loaded the controller's parameters of {name}");
    Ok(())
}

/// The parameters of the rig; notes which ones its firmware does not have.
fn read(client: &mut Client) -> Result<Parameters> {
    let parameters = client.parameters()?;
    report_missing(&parameters);
    Ok(parameters.values)
}

/// The first line of an exported file, up to the number of its parameters.
const HEAD: &str = "# The controller's ";

/// A parameter, or an entry of a list, with its value.
fn line(written: &Written, entry: u16, value: i32) -> String {
    let entry = if written.parameter.len > 1 { format!("[{entry}]") } else { String::new() };
    format!("{}{entry} = {} {}", written.name, written.text(value), written.unit()).trim_end().to_owned()
}

/// All parameters, one `name = value` per line. The first line says how many there are, so that a truncated file is
/// refused.
fn exported(parameters: &Parameters) -> String {
    let line = |written: Written| format!("{} = {}\n", written.name, written.all_text(parameters));
    let count = TABLE.len();
    let head = format!("{HEAD}{count} parameters; `pneudrive device config import` takes them over.\n");
    std::iter::once(head).chain(Written::all().map(line)).collect()
}

/// The parameters in a file, and the names of those that it does not contain: these have their defaults.
#[derive(Debug, PartialEq)]
struct Named {
    parameters: Parameters,
    unnamed: Vec<&'static str>,
}

/// Name and parameters of a rig or of an exported file. The source is read once: it may be a pipe.
fn importable(from: &str) -> Result<(String, Named)> {
    let (source, text) = rig_text(from)?;
    if let Some(named) = parse_exported(&text) {
        return Ok((source.clone(), named.with_context(|| source)?));
    }
    // An empty rig file is valid: it is servo-drive B of the thesis.
    if !text.lines().any(is_content) {
        bail!("{source} is empty: it contains neither a parameter nor a key of a rig");
    }
    let rig = Rig::read(&source, &text)?;
    Ok((rig.name().to_owned(), Named { parameters: rig.parameters(), unnamed: Vec::new() }))
}

/// The parameters in an exported file; None for another kind of file, whose first line does not name a parameter.
fn parse_exported(text: &str) -> Option<Result<Named>> {
    let lines: Vec<(usize, &str)> = text.lines().enumerate().filter(|(_, line)| is_content(line)).collect();
    let Some(told) = count_text(text) else {
        let (_, first) = lines.first()?;
        by_name(first.split_once('=')?.0.trim())?;
        return Some(parse_lines(&lines));
    };
    Some(parse_lines(&lines).and_then(|named| {
        let found = TABLE.len() - named.unnamed.len();
        if found < told {
            bail!("its first line announces {told} parameters, and {found} are there: the file is truncated; export it again");
        }
        if !text.ends_with('\n') {
            bail!("its last line has no line break: the file may be truncated; export it again, or add the line break");
        }
        Ok(named)
    }))
}

/// The number of parameters that the first line announces.
fn count_text(text: &str) -> Option<usize> {
    text.strip_prefix(HEAD)?.split_once(' ')?.0.parse().ok()
}

fn parse_lines(lines: &[(usize, &str)]) -> Result<Named> {
    let mut parameters = Parameters::default();
    let mut seen: BTreeMap<&'static str, usize> = BTreeMap::new();
    for (index, line) in lines {
        let number = index + 1;
        let name = take_line(&mut parameters, line).with_context(|| format!("line {number}"))?;
        if let Some(before) = seen.insert(name, number) {
            bail!("line {number}: {name} is already set in line {before}");
        }
    }
    let names = TABLE.iter().map(|parameter| parameter.name);
    Ok(Named { parameters, unnamed: names.filter(|name| !seen.contains_key(name)).collect() })
}

fn is_content(line: &str) -> bool {
    !line.trim().is_empty() && !line.trim_start().starts_with('#')
}

/// Applies `name = value`, or `name = value,value` for a list, whose last entry repeats; returns the name.
fn take_line(parameters: &mut Parameters, line: &str) -> Result<&'static str> {
    let (name, text) = line.split_once('=').ok_or_else(|| anyhow!("{line:?} is not name = value"))?;
    let name = name.trim();
    let written = Written::named(name).ok_or_else(|| anyhow!("there is no parameter {name}"))?;
    written.put(text, parameters)?;
    Ok(written.parameter.name)
}

/// A parameter and the entry meant, from `name` or `name[entry]`.
fn parameter_of(text: &str) -> Result<(Written, u16)> {
    let (name, entry) = match text.strip_suffix(']').and_then(|text| text.split_once('[')) {
        Some((name, entry)) => (name, entry.parse::<u16>().ok()),
        None => (text, Some(0)),
    };
    let written = Written::named(name)
        .ok_or_else(|| anyhow!("there is no parameter {name}; `pneudrive device config get` lists them"))?;
    let len = written.parameter.len;
    if len > 1 && !text.ends_with(']') {
        bail!("{name} is a list: name an entry, such as {name}[3], with the entries 0 to {}", len - 1);
    }
    match entry {
        Some(entry) if entry < len => Ok((written, entry)),
        _ => bail!("{name} has the entries 0 to {}", len - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::parameters::id;

    #[test]
    fn what_is_exported_comes_back() {
        let mut parameters = Parameters::default();
        parameters.set(id::VELOCITY_GAIN, 2000).expect("in range");
        parameters.set(id::GAIN_PROFILE + 3, 99).expect("in range");
        let text = exported(&parameters);
        assert!(text.contains("\ncontroller.velocity_gain = 2000\n"), "{text}");
        assert!(text.contains("\ncontroller.gain_profile = 8192,6144,4096,99,"), "{text}");
        assert!(
            text.contains("\nsafety.hold_s = 60\n") && text.contains("\nencoder.mm_per_count = 0.01205\n")
        );
        assert_eq!(
            parse_exported(&text).expect("exported").expect("whole"),
            Named { parameters, unnamed: vec![] }
        );
    }

    /// As earlier versions wrote it: with the device's own names and units.
    #[test]
    fn a_file_that_was_exported_with_the_names_of_the_device_is_taken_over() {
        let mut parameters = Parameters::default();
        parameters.set(id::HOLD_MS, 1500).expect("in range");
        parameters.set(id::LAW, 3).expect("in range");
        let line = |parameter: &pneudrive_controller::parameters::Parameter| {
            let value =
                pneudrive_records::parameter_names::parameter_text(&parameters, parameter.id, parameter.len);
            format!("{} = {value}\n", parameter.name)
        };
        let lines: String = TABLE.iter().map(line).collect();
        let head = format!("{HEAD}55 parameters; `pneudrive device config import` takes them over.\n");
        for old in [head + &lines, lines] {
            let named = parse_exported(&old).expect("exported").expect("whole");
            assert_eq!(named, Named { parameters: parameters.clone(), unnamed: vec![] });
        }
    }

    #[test]
    fn a_file_that_was_cut_is_refused_wherever_that_was() {
        let text = exported(&Parameters::default());
        let folder = tempfile::tempdir().expect("a folder");
        let cut = folder.path().join("cut.txt");
        for end in 0..text.len() {
            std::fs::write(&cut, &text[..end]).expect("written");
            let error = format!("{:#}", importable(&cut.display().to_string()).expect_err("cut"));
            let reasons = ["is empty", "55 parameters, and ", "its last line has no line break", "line "];
            assert!(reasons.iter().any(|reason| error.contains(reason)), "{end}: {error}");
        }
    }

    #[test]
    fn a_file_of_a_few_parameters_leaves_the_others_as_by_default_and_tells_them() {
        let Named { parameters, unnamed } =
            parse_exported("scale = 512\n").expect("exported").expect("right");
        assert_eq!(parameters.get(id::SCALE), Some(512));
        assert!(unnamed.len() == TABLE.len() - 1 && !unnamed.contains(&"scale"), "{unnamed:?}");
    }

    #[test]
    fn a_line_that_is_wrong_is_named() {
        for (text, message) in [
            ("period_us = 1300\nspeed = 3\n", "there is no parameter speed"),
            ("# a comment\nperiod_us = 50\n", "period_us = 50 is out of range: 100 to 100000 us"),
            ("period_us = 1300\nsafety.hold_s = 3601\n", "safety.hold_s = 3601 is out of range: 0 to 3600 s"),
            ("period_us = 1300\nhold_ms = 1\nsafety.hold_s = 1\n", "hold_ms is already set in line 2"),
            ("period_us = 1,2\n", "period_us has 1 entries, not 2"),
            ("period_us = 1300\nscale\n", "is not name = value"),
            ("period_us = x\n", "\"x\" is not a whole number"),
            ("scale = 1\n\nscale = 2\n", "line 3: scale is already set in line 1"),
        ] {
            let error = parse_exported(text).expect("exported").expect_err("wrong");
            assert!(
                format!("{error:#}").contains(message) && format!("{error:#}").starts_with("line "),
                "{error:#}"
            );
        }
    }

    #[test]
    fn a_rig_file_is_none() {
        assert!(parse_exported("name = \"x\"\n").is_none());
        assert!(parse_exported("[load]\nmass_kg = 2\n").is_none());
        assert!(parse_exported("").is_none());
    }
}
