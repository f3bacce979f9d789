//! Golden hashes: the results of each built-in rig and each reference case, bit for bit.
//!
//! `golden.toml` holds CRC-64 (XZ) of trace.csv, and of the samples of a TARGET file, each with its cause: the
//! words of the CHANGELOG line that says why the hash is what it is. `cargo xtask bless` replaces hashes that
//! have changed, under a new cause.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::{Context, Result, anyhow, bail, ensure};
use crc::{CRC_64_XZ, Crc};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::rigfile::BUILTIN;
use pneudrive_sim::trace::to_csv;
use pneudrive_sim::{Accuracy, Rig, run};
use toml_edit::{DocumentMut, Item};

use crate::body::{self, run_and_record};
use crate::{Target, VirtualTarget};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/golden.toml");
const CHANGELOG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../CHANGELOG.md");
const CASES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sim/tests/cases");

const ABOUT: &str = "\
# CRC-64 (XZ) of trace.csv of every built-in rig and reference case, and of the samples of TARGET files, which
# are the same on every level. A changed hash is a changed result: `cargo xtask bless --cause WORDS` replaces it,
# WORDS being those of a line of CHANGELOG.md that says why.
";

/// What the hashes of TARGET files are of.
const RECORDED: [&str; 3] = ["servo-b-tuned", "lut-stepper", "press"];

/// A result's hash, and the words of the CHANGELOG that account for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Golden {
    /// CRC-64 (XZ) in hexadecimal digits.
    pub crc64: String,
    /// Words that CHANGELOG.md holds.
    pub cause: String,
}

/// Results by what they are of: `trace servo-a`, `target servo-b-tuned`.
pub type Goldens = BTreeMap<String, Golden>;

/// The hashes of trace.csv of every built-in rig and reference case.
///
/// # Errors
/// When a rig cannot be read or simulated.
pub fn traces() -> Result<BTreeMap<String, String>> {
    let mut rigs: Vec<(String, String)> =
        BUILTIN.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    for file in std::fs::read_dir(CASES).context(CASES)? {
        let path = file.context(CASES)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            rigs.push((name, std::fs::read_to_string(&path)?));
        }
    }
    let hashed = |(name, text): &(String, String)| -> Result<(String, String)> {
        let rig = Rig::read(name, text).map_err(|problems| anyhow!("{name}: {problems}"))?;
        let run = run(&rig, Accuracy::of(&rig)).with_context(|| name.clone())?;
        Ok((format!("trace {name}"), hash(&to_csv(&run.rows))))
    };
    let steps: BTreeMap<String, String> = rigs.iter().map(hashed).collect::<Result<_>>()?;
    let profiled = PROFILED.iter().map(|name| {
        let rig = profiled(name);
        let run = run(&rig, Accuracy::of(&rig)).with_context(|| (*name).to_owned())?;
        Ok((format!("trace {name} profiles"), hash(&to_csv(&run.rows))))
    });
    Ok(steps.into_iter().chain(profiled.collect::<Result<Vec<_>>>()?).collect())
}

/// The rigs whose moves with profiles are hashed, too.
const PROFILED: [&str; 2] = ["servo-a-tuned", "servo-b-tuned"];

/// A rig on moves of every profile, with feed-forward.
fn profiled(name: &str) -> Rig {
    body::as_built_in(
        name,
        &[
            "controller.velocity_feed_forward=900",
            "controller.acceleration_feed_forward=700",
            "test.duration_s=4.4",
            body::PROFILES,
        ],
    )
}

/// The hashes of the samples of TARGET files of an execution level.
///
/// # Errors
/// When the execution level cannot be started.
///
/// # Panics
/// When a run does not come to its end.
pub fn records(start: impl Fn(&Rig) -> Result<Box<dyn Target>>) -> Result<BTreeMap<String, String>> {
    let hashed = |(name, rig): (String, Rig)| {
        let target = start(&rig)?;
        let record = run_and_record(&*target, &rig);
        let mut client = target.connect()?;
        let (info, parameters) = (client.info()?, client.parameters()?);
        let text = TargetFile::new(&record, &info, &parameters)?.to_text();
        // The header names the board; what it counted is the same on each.
        let samples: String =
            text.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join("\n");
        Ok((format!("target {name}"), hash(&samples)))
    };
    let steps = RECORDED.map(|name| (name.to_owned(), body::as_built_in(name, &["test.duration_s=0.6"])));
    let profiles = PROFILED.map(|name| (format!("{name} profiles"), profiled(name)));
    steps.into_iter().chain(profiles).map(hashed).collect()
}

/// The virtual rig, as an execution level of [`records`].
///
/// # Errors
/// When it cannot be started.
pub fn virtual_rig(rig: &Rig) -> Result<Box<dyn Target>> {
    Ok(Box::new(VirtualTarget::start(rig, "tcp:127.0.0.1:0")?))
}

fn hash(text: &str) -> String {
    const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);
    format!("{:016x}", CRC.checksum(text.as_bytes()))
}

/// What golden.toml holds.
///
/// # Errors
/// When it cannot be read.
pub fn golden_file() -> Result<Goldens> {
    let text = std::fs::read_to_string(FILE).context(FILE)?;
    let document: DocumentMut = text.parse().context(FILE)?;
    let golden = |(name, entry): (&str, &Item)| -> Result<(String, Golden)> {
        let field = |key: &str| {
            let value = entry.get(key).and_then(Item::as_str);
            value.map(str::to_owned).ok_or_else(|| anyhow!("{FILE}: {name} has no {key}"))
        };
        Ok((name.to_owned(), Golden { crc64: field("crc64")?, cause: field("cause")? }))
    };
    document.iter().map(golden).collect()
}

/// Says which results differ from the stated ones, which are new, and which are no more.
///
/// # Errors
/// When there are such.
pub fn compare(found: &BTreeMap<String, String>, golden_file: &Goldens, kind: &str) -> Result<()> {
    let changed =
        found.iter().filter(|(name, crc)| golden_file.get(*name).is_none_or(|golden| golden.crc64 != **crc));
    let changed: Vec<&str> = changed.map(|(name, _)| name.as_str()).collect();
    let gone = golden_file.keys().filter(|name| name.starts_with(kind) && !found.contains_key(*name));
    let gone: Vec<&str> = gone.map(String::as_str).collect();
    ensure!(
        changed.is_empty() && gone.is_empty(),
        "not the results of golden.toml: {changed:?}; no more there: {gone:?}. If that is meant, say why in \
         CHANGELOG.md and run `cargo xtask bless --cause WORDS`"
    );
    Ok(())
}

/// Whether the CHANGELOG holds a cause, however its lines are broken.
///
/// # Errors
/// When it cannot be read.
pub fn is_accounted_for(cause: &str) -> Result<bool> {
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let changelog = std::fs::read_to_string(CHANGELOG).context(CHANGELOG)?;
    let cause = words(cause);
    Ok(!cause.is_empty() && words(&changelog).contains(&cause))
}

/// Writes hashes that have changed, under this cause; tells which ones.
///
/// # Errors
/// When the CHANGELOG does not hold the cause, or a result cannot be had.
pub fn bless(cause: &str) -> Result<Vec<String>> {
    if !is_accounted_for(cause)? {
        bail!(
            "CHANGELOG.md has no line with the words {cause:?}; write there why results change, and give its words"
        );
    }
    let before = if std::path::Path::new(FILE).exists() { golden_file()? } else { Goldens::new() };
    let mut found = traces()?;
    found.extend(records(virtual_rig)?);
    let mut changed = Vec::new();
    let golden = |(name, crc64): (String, String)| match before.get(&name) {
        Some(golden) if golden.crc64 == crc64 => (name, golden.clone()),
        _ => {
            changed.push(name.clone());
            (name, Golden { crc64, cause: cause.to_owned() })
        }
    };
    let goldens: Goldens = found.into_iter().map(golden).collect();
    std::fs::write(FILE, text_of(&goldens)).context(FILE)?;
    Ok(changed)
}

fn text_of(goldens: &Goldens) -> String {
    let mut text = ABOUT.to_owned();
    for (name, Golden { crc64, cause }) in goldens {
        let cause = toml_edit::Value::from(cause.as_str());
        // Writing to a String cannot fail.
        let _ = write!(text, "\n[\"{name}\"]\ncrc64 = \"{crc64}\"\ncause = {cause}\n");
    }
    text
}
