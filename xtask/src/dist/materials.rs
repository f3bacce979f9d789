//! What a program is made of: a bill of materials (CycloneDX), and the licences of other people's code with the place where
//! its source is to be had.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use pneudrive_build::cargo::{THUMB, THUMB_V8, built, in_folder, root, run};
use toml_edit::{DocumentMut, value};

use super::Source;
use crate::tools::CargoTool;

const CYCLONEDX: CargoTool = CargoTool { name: "cargo-cyclonedx", version: "0.5.9", features: &[] };
const ABOUT: CargoTool = CargoTool { name: "cargo-about", version: "0.9.3", features: &["cli"] };

/// A program that is given away.
struct Program {
    name: &'static str,
    /// The folder of its workspace, and its own.
    workspace: &'static str,
    package: &'static str,
    target: &'static str,
}

const PROGRAMS: [Program; 4] = [
    Program { name: "command", workspace: "", package: "host", target: "x86_64-unknown-linux-gnu" },
    Program {
        name: "wheel",
        workspace: "host/python",
        package: "host/python",
        target: "x86_64-unknown-linux-gnu",
    },
    Program { name: "nucleo-f446", workspace: "firmware", package: "firmware/nucleo-f446", target: THUMB },
    Program { name: "pico2", workspace: "firmware/pico2", package: "firmware/pico2", target: THUMB_V8 },
];

/// Writes `NAME.cdx.json` and `NAME-notices.txt` of each program.
///
/// # Errors
/// When a tool cannot be built, or a licence is not among those of `deny.toml`.
pub fn make(source: &Source, out: &Path) -> Result<()> {
    let (bills, notices) = (CYCLONEDX.ensure()?, ABOUT.ensure()?);
    fs::create_dir_all(out)?;
    let config = config(&fs::read_to_string(source.folder().join("deny.toml")).context("deny.toml")?)?;
    PROGRAMS.iter().try_for_each(|program| {
        bill(program, source, &bills, out)?;
        notice(program, source, &notices, &config, out).with_context(|| program.name)
    })
}

/// The tool writes one beside each package of the workspace.
fn bill(program: &Program, source: &Source, tool: &Path, out: &Path) -> Result<()> {
    let Program { name, workspace, package, target } = program;
    let manifest = source.folder().join(package).join("Cargo.toml");
    let mut call = in_folder(&source.folder().join(workspace), &[]);
    let mut call = with_program(&mut call, tool, "cyclonedx");
    call.arg("--manifest-path").arg(&manifest).args(["--format", "json", "--spec-version", "1.5", "--quiet"]);
    call.args(["--no-build-deps", "--target", target, "--override-filename", "bill"]);
    run(source.without_folders(&mut call)?)?;
    let written = manifest.with_file_name("bill.json");
    fs::copy(&written, out.join(format!("{name}.cdx.json")))
        .with_context(|| written.display().to_string())
        .map(drop)
}

fn notice(program: &Program, source: &Source, tool: &Path, config: &DocumentMut, out: &Path) -> Result<()> {
    let mut config = config.clone();
    config["targets"] = value(toml_edit::Array::from_iter([program.target]));
    let file = built("dist-about.toml")?;
    fs::write(&file, config.to_string()).with_context(|| file.display().to_string())?;
    let mut call = in_folder(&source.folder().join(program.workspace), &[]);
    let mut call = with_program(&mut call, tool, "about");
    call.args(["generate", "--locked", "--fail", "--config"]).arg(&file);
    call.arg("--manifest-path").arg(source.folder().join(program.package).join("Cargo.toml"));
    call.arg("--output-file").arg(out.join(format!("{}-notices.txt", program.name)));
    call.arg(root().join("xtask/dist/notices.hbs"));
    run(source.without_folders(&mut call)?)
}

/// A command of cargo that is a program in the folder of tools, called where `call` would be.
fn with_program(call: &mut std::process::Command, tool: &Path, name: &str) -> std::process::Command {
    let mut command = std::process::Command::new(tool);
    command.arg(name).env_remove("RUSTUP_TOOLCHAIN");
    if let Some(folder) = call.get_current_dir().map(PathBuf::from) {
        command.current_dir(folder);
    }
    command
}

/// What cargo-about is told: the licences that `deny.toml` allows, of what is linked alone.
fn config(rules: &str) -> Result<DocumentMut> {
    let rules: DocumentMut = rules.parse().context("deny.toml")?;
    let allowed =
        rules.get("licenses").and_then(|licences| licences.get("allow")).context("licenses.allow")?;
    let mut config = DocumentMut::new();
    config["accepted"] = allowed.clone();
    config["ignore-build-dependencies"] = value(true);
    config["ignore-dev-dependencies"] = value(true);
    config["private"]["ignore"] = value(true);
    Ok(config)
}
