//! `pneudrive rig`.

mod check;
mod new;

use anyhow::{Result, anyhow, bail};
use pneudrive_design::difference::{Difference, differences};
use pneudrive_design::values;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::{Value, explain};
use pneudrive_sim::rigfile::BUILTIN;
use serde_json::json;

use super::rig_source::{load_rig, rig_text};
use crate::cli::Rig as Arguments;
use crate::json;

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    match arguments {
        Arguments::New(arguments) => new::execute(arguments),
        Arguments::Parts { part } => new::list_parts(part.as_deref()),
        Arguments::List => list(),
        Arguments::Show { name, resolved, settings } => match (json::is_wanted(), resolved) {
            (true, _) => show_json(&load_rig(name, settings)?),
            (false, true) => show_resolved(&load_rig(name, settings)?),
            (false, false) if settings.is_empty() => show(name),
            (false, false) => {
                bail!("--set needs --resolved or --json: without them, the file is shown as it is")
            }
        },
        Arguments::Diff { one, other } => diff(one, other),
        Arguments::Check { file, quick } => check::execute(file, *quick),
        Arguments::Explain { key } => {
            say!("{}", explain(key).map_err(|problem| anyhow!("{problem}"))?.trim_end());
            Ok(())
        }
    }
}

fn list() -> Result<()> {
    let about = |text: &'static str| text.lines().next().unwrap_or("").trim_start_matches("# ");
    for (name, text) in BUILTIN {
        say!("{name:<16} {}", about(text));
    }
    let rigs = || BUILTIN.iter().map(|(name, text)| json!({ "name": name, "about": about(text) }));
    json::figures(|| json!({ "rigs": rigs().collect::<Vec<_>>() }));
    Ok(())
}

fn show(name: &str) -> Result<()> {
    say!("{}", rig_text(name)?.1.trim_end());
    Ok(())
}

fn show_resolved(rig: &Rig) -> Result<()> {
    say!("{}", values::to_toml(rig).trim_end());
    let counts = values::count(rig).map(|(source, count)| format!("{count} {}", source.word()));
    tell!("{}: {}", rig.name(), counts.join(", "));
    Ok(())
}

fn show_json(rig: &Rig) -> Result<()> {
    json::figures(|| json!({ "rig": rig.name(), "keys": values::to_json(rig) }));
    Ok(())
}

/// The differences of two rigs, one line per key.
fn diff(one: &str, other: &str) -> Result<()> {
    let rigs = [load_rig(one, &[])?, load_rig(other, &[])?];
    let found = differences(&rigs[0], &rigs[1]);
    let one = |one: &Difference<'_>| {
        let values = one.values.map(|value| value.map(values::value_to_json));
        json!({ "key": one.key.path, "unit": one.key.unit(), "values": values, "percent": one.percent() })
    };
    json::figures(|| json!({ "differences": found.iter().map(one).collect::<Vec<_>>() }));
    for difference in found {
        let [first, second] = difference.values.map(|value| value.map_or("-".to_owned(), Value::to_string));
        let unit = difference.key.unit();
        let percent = difference.percent().map_or(String::new(), |percent| format!("  ({percent:+.3} %)"));
        say!("{:<38} {first} -> {second} {unit}{percent}", difference.key.path);
    }
    Ok(())
}
