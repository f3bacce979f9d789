//! `pneudrive rig`.

use anyhow::{Result, anyhow};
use pneudrive_sim::rig::{BUILTIN, explain};

use super::rig_source::{load_rig, rig_text};
use crate::cli::Rig as Arguments;

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    match arguments {
        Arguments::List => list(),
        Arguments::Show { name } => show(name),
        Arguments::Check { file } => check(file),
        Arguments::Explain { key } => {
            say!("{}", explain(key).map_err(|problem| anyhow!("{problem}"))?.trim_end());
            Ok(())
        }
    }
}

fn list() -> Result<()> {
    for (name, text) in BUILTIN {
        let about = text.lines().next().unwrap_or("").trim_start_matches("# ");
        say!("{name:<16} {about}");
    }
    Ok(())
}

fn show(name: &str) -> Result<()> {
    say!("{}", rig_text(name)?.1.trim_end());
    Ok(())
}

fn check(file: &str) -> Result<()> {
    let rig = load_rig(file, &[])?;
    for key in rig.unused() {
        say!("{file}: {key} is not used by the chosen model");
    }
    say!("{file}: a valid rig ({})", rig.name());
    Ok(())
}
