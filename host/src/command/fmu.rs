//! `pneudrive fmu`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use pneudrive_fmu::archive::{fmu, library_name, rig_file};
use pneudrive_fmu::variable::{Role, Variable, variables};
use pneudrive_fmu::{Library, Part, Standard};
use pneudrive_records::whole_file::{is_device, put};
use serde_json::json;

use super::rig_source::rig_text;
use crate::cli::Fmu;
use crate::exit::Exit;
use crate::json;

pub(super) fn execute(arguments: &Fmu) -> Result<()> {
    let part = match (arguments.plant, arguments.controller) {
        (true, _) => Part::Plant,
        (_, true) => Part::Controller,
        _ => Part::Drive,
    };
    let standard = Standard::ALL
        .into_iter()
        .find(|one| one.version() == arguments.fmi)
        .context("--fmi is 2.0 or 3.0")?;
    let (source, text) = rig_text(&arguments.rig.rig)?;
    let (rig, text) = rig_file(&source, &text, &arguments.rig.settings)?;
    let path = arguments.out.clone().unwrap_or_else(|| beside(&arguments.rig.rig, part));
    if path.exists() && !is_device(&path) && !arguments.overwrite {
        bail!(
            "{} already exists; choose another name with --out, or replace it with --overwrite",
            path.display()
        );
    }
    let libraries = match arguments.library.as_slice() {
        [] => vec![Library::read(&built()?)?],
        files => files.iter().map(|file| Library::read(file)).collect::<Result<_>>()?,
    };
    let platforms = libraries.iter().map(|library| standard.platform(library)).collect::<Result<Vec<_>>>()?;
    let platform = platforms.join(", ");
    put(&path, &fmu(standard, part, &rig, &text, &libraries)?)?;
    let all = variables(part, &rig);
    let count = |is: fn(&Variable) -> bool| all.iter().filter(|variable| is(variable)).count();
    let inputs = count(|variable| matches!(variable.role, Role::Input(_)));
    let outputs = count(|variable| matches!(variable.role, Role::Output(_)));
    let parameters = count(Variable::is_parameter);
    let period_s = f64::from(rig.period_us().get()) / 1e6;
    let (part, name, fmi) = (part.word(), rig.name(), standard.version());
    json::figures(|| {
        json!({
            "file": path, "part": part, "rig": name, "platform": platform, "fmi": fmi,
            "inputs": inputs, "outputs": outputs, "parameters": parameters, "period_s": period_s,
        })
    });
    say!(
        "{}: {part} of {name}, FMI {fmi} for {platform}; inputs: {inputs}, outputs: {outputs}, parameters: {parameters}; a step is {period_s} s",
        path.display()
    );
    Ok(())
}

/// The file of a part in the current folder, named after its rig.
fn beside(rig: &str, part: Part) -> PathBuf {
    let name = Path::new(rig).file_stem().unwrap_or_default().to_string_lossy();
    PathBuf::from(format!("{name}-{}.fmu", part.word()))
}

/// The library that cargo has made with this program.
fn built() -> Result<PathBuf> {
    let name = library_name();
    let program = std::env::current_exe().context("where this program is")?;
    let folder = program.parent().unwrap_or(Path::new("."));
    let places = [folder.join(&name), folder.join("deps").join(&name)];
    places.iter().find(|place| place.is_file()).cloned().ok_or_else(|| {
        Exit::NotThere.error(format!(
            "there is no {name} beside this program ({}); build it with `cargo build --release -p pneudrive-fmu-library`, and name it with --library target/release/{name}",
            folder.display()
        ))
    })
}
