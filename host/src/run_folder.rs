//! The folder of a simulated run: trace.csv and run.json, and band.csv where the run has neighbours.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_controller::parameters::TABLE;
use pneudrive_sim::rig::{Fields, Value};
use pneudrive_sim::trace::{COLUMNS, to_csv};
use pneudrive_sim::{Accuracy, Decision, Method, Rig, Run};
use serde_json::{Map, json};

use crate::band::{self, Band};
use crate::ensemble::{Judged, Spacing};
use crate::evaluation::{self, Move};
use crate::rig_text;
use crate::transient::{WHOLE_WINDOW, whole_window};
use crate::words;

/// `format` of run.json.
const FORMAT: &str = "pneudrive-run 1";

/// `controller.loop` of a run whose moves are commands.
const OPEN: &str = "open";

/// Keys of the windows over which the controller forms velocity and acceleration.
const WINDOWS: [&str; 2] = ["controller.velocity_window_samples", "controller.acceleration_window_samples"];

/// Writes trace.csv, run.json and, if there is a band, band.csv of a run into a folder. `moves` has the moves of the
/// run, and then those of each of its neighbours.
///
/// # Errors
/// When the folder cannot be written to, or holds a run.json that is not ours.
pub fn write(folder: &Path, rig: &Rig, judged: &Judged, moves: &[Vec<Move>]) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    let json_path = folder.join("run.json");
    if json_path.exists() && read_json(&json_path).is_err() {
        bail!("{} is not of this program; choose another folder", json_path.display());
    }
    let trace_path = folder.join("trace.csv");
    refuse_foreign(&trace_path, &COLUMNS.join(","))?;
    let band_path = folder.join("band.csv");
    refuse_foreign(&band_path, &band::header())?;
    put(&trace_path, &to_csv(&judged.run.rows))?;
    match &judged.band {
        Some(band) => put(&band_path, &band.to_csv())?,
        // One from before would be of another run.
        None if band_path.exists() => fs::remove_file(&band_path)
            .with_context(|| format!("cannot remove {}, which is of another run", band_path.display()))?,
        None => {}
    }
    let text = serde_json::to_string_pretty(&describe(rig, judged, moves))?;
    put(&json_path, &(text + "\n"))
}

/// Makes a folder if it is not there, and makes sure that it can be written to, before long work.
///
/// # Errors
/// When it cannot.
pub fn make_writable(folder: &Path) -> Result<()> {
    let probe = folder.join(format!(".pneudrive-{}.partial", std::process::id()));
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(&probe, ""))
        .and_then(|()| fs::remove_file(&probe))
        .with_context(|| format!("cannot write into the folder {}; choose another", folder.display()))
}

/// Refuses to replace a file that does not hold `mark`: it is somebody's own.
///
/// # Errors
/// When there is such a file.
pub fn refuse_foreign(path: &Path, mark: &str) -> Result<()> {
    match beginning(path) {
        Ok(text) if text.contains(mark) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        _ => bail!("{} is not of this program; choose another place", path.display()),
    }
}

/// Bytes at the beginning of a file that hold its mark, if it has one.
const BEGINNING: u64 = 1 << 16;

fn beginning(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(BEGINNING).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Writes a file whole or not at all.
///
/// # Errors
/// When it cannot be written.
pub fn put(path: &Path, content: &(impl AsRef<[u8]> + ?Sized)) -> Result<()> {
    put_pieces(path, &[content.as_ref()])
}

/// The same of a file that is made of several pieces. A device or a pipe is written to, not replaced.
///
/// # Errors
/// When it cannot be written.
pub fn put_pieces(path: &Path, pieces: &[&[u8]]) -> Result<()> {
    let write = |mut file: File| pieces.iter().try_for_each(|piece| file.write_all(piece));
    if fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        let written = File::options().write(true).open(path).and_then(write);
        return written.with_context(|| format!("cannot write {}", path.display()));
    }
    let partial = PathBuf::from(format!("{}.partial", path.display()));
    let written = File::create(&partial).and_then(write);
    let placed = written.and_then(|()| fs::rename(&partial, path));
    if placed.is_err() {
        let _ = fs::remove_file(&partial);
    }
    placed.with_context(|| format!("cannot write {}", path.display()))
}

fn describe(rig: &Rig, judged: &Judged, moves: &[Vec<Move>]) -> serde_json::Value {
    let (run, accuracy) = (&judged.run, judged.accuracy);
    let keys: Map<String, serde_json::Value> =
        rig.entries().map(|(key, value)| (key.path.to_owned(), json_of(value))).collect();
    let parameters = rig.parameters();
    let controller: Map<String, serde_json::Value> = TABLE
        .iter()
        .filter(|parameter| parameter.len == 1)
        .filter_map(|parameter| Some((parameter.name.to_owned(), json!(parameters.get(parameter.id)?))))
        .collect();
    let work = run.work;
    json!({
        "format": FORMAT,
        "program": format!("pneudrive {}", env!("CARGO_PKG_VERSION")),
        "rig": rig.name(),
        "method": format!("{:?}", accuracy.method),
        "tolerance": accuracy.tolerance,
        "samples": run.observations.len(),
        "rows": run.rows.len(),
        "decided": judged.decision.is_decided(),
        "undecided_from_s": judged.decision.undecided_from_s,
        "closest_edge": closest_edge(&judged.decision),
        "position_error_m": judged.decision.error_m,
        "ensemble": judged.band.as_ref().map(|_| json!({
            "runs": judged.spacing.runs,
            "relative_change": judged.spacing.relative,
        })),
        "moves": evaluation::to_json(moves),
        "fault": run.fault.map(|(fault, k)| json!({ "name": words::fault_name(fault), "sample": k })),
        "work": {
            "steps": work.integrator.steps,
            "rejected": work.integrator.rejected,
            "evaluations": work.integrator.evaluations,
            "restarts": work.integrator.restarts,
            "events": work.integrator.events,
            "flow_solutions": work.network.solutions,
            "flow_iterations": work.network.iterations,
        },
        "controller": controller,
        "keys": keys,
    })
}

fn closest_edge(decision: &Decision) -> Option<serde_json::Value> {
    decision.closest_edge.map(|edge| json!({ "distance_m": edge.distance_m, "at_s": edge.at_s }))
}

fn json_of(value: &Value) -> serde_json::Value {
    match value {
        Value::Number(value) => json!(value),
        Value::Integer(value) => json!(value),
        Value::Switch(on) => json!(on),
        Value::Word(word) => json!(word),
        Value::Integers(values) => json!(values),
        Value::Numbers(values) => json!(values),
        Value::Moves(moves) => json!(moves),
        Value::Events(events) => events.iter().map(json_of_event).collect(),
    }
}

fn json_of_event(fields: &Fields) -> serde_json::Value {
    fields.iter().map(|(name, value)| ((*name).to_owned(), json_of(value))).collect()
}

/// A run as it was written: its description and the columns of its trace.
#[derive(Clone, Debug)]
pub struct StoredRun {
    /// What the rig is called.
    pub rig: String,
    /// mm of stroke per encoder count.
    pub mm_per_count: f64,
    /// Whether its moves are commands.
    pub open_loop: bool,
    /// Windows of the controller's velocity and acceleration, samples.
    pub windows: [u8; 2],
    /// What it and its neighbours cover, if it has some.
    pub band: Option<Band>,
    /// How its neighbours were chosen; None of a run without neighbours.
    pub spacing: Option<Spacing>,
    /// How exactly it was integrated; None where this program does not know.
    pub accuracy: Option<Accuracy>,
    columns: Vec<Vec<f64>>,
}

impl StoredRun {
    /// A run that has not been written.
    #[must_use]
    pub fn of(rig: &Rig, run: &Run) -> StoredRun {
        let mut columns = vec![Vec::with_capacity(run.rows.len()); COLUMNS.len()];
        for row in &run.rows {
            for (column, value) in columns.iter_mut().zip(row.values()) {
                column.push(value);
            }
        }
        StoredRun {
            rig: rig.name().to_owned(),
            mm_per_count: rig.number("encoder.mm_per_count"),
            open_loop: rig.word("controller.loop") == OPEN,
            windows: WINDOWS.map(|key| rig.integer(key) as u8),
            band: None,
            spacing: None,
            accuracy: None,
            columns,
        }
    }

    /// The same with its band.
    #[must_use]
    pub fn of_judged(rig: &Rig, judged: &Judged) -> StoredRun {
        StoredRun {
            band: judged.band.clone(),
            spacing: judged.band.as_ref().map(|_| judged.spacing),
            accuracy: Some(judged.accuracy),
            ..StoredRun::of(rig, &judged.run)
        }
    }

    /// Reads a run folder.
    ///
    /// # Errors
    /// With the file and line of what is wrong.
    pub fn read(folder: &Path) -> Result<StoredRun> {
        let json_path = folder.join("run.json");
        if !json_path.exists() {
            bail!("{} is no run folder: it has no run.json", folder.display());
        }
        let description = read_json(&json_path)?;
        let rig = description["rig"].as_str().unwrap_or("run").to_owned();
        let wrong = |key: &str, must: &str| {
            anyhow!("{}: {key} is {}; {must}", json_path.display(), description["keys"][key])
        };
        let scale = "encoder.mm_per_count";
        let mm_per_count = description["keys"][scale]
            .as_f64()
            .filter(|mm| *mm > 0.0)
            .ok_or_else(|| wrong(scale, "it must be a number, more than 0"))?;
        let trace_path = folder.join("trace.csv");
        let text = fs::read_to_string(&trace_path)
            .with_context(|| format!("cannot read {}", trace_path.display()))?;
        let columns = columns_of(&text).with_context(|| trace_path.display().to_string())?;
        let open_loop = description["keys"]["controller.loop"] == OPEN;
        let window = |key: &str| {
            let samples = description["keys"][key].as_f64().and_then(whole_window);
            samples.ok_or_else(|| wrong(key, WHOLE_WINDOW))
        };
        let windows = [window(WINDOWS[0])?, window(WINDOWS[1])?];
        if columns[0].is_empty() {
            bail!("{} has no samples", folder.display());
        }
        // Runs of older programs do not tell.
        if let Some(rows) = description["rows"].as_u64().filter(|rows| *rows != columns[0].len() as u64) {
            bail!(
                "{} has {} of the {rows} rows of its run: it was cut",
                trace_path.display(),
                columns[0].len()
            );
        }
        let band_path = folder.join("band.csv");
        let has_band = !description["ensemble"].is_null() && band_path.exists();
        let band = has_band.then(|| Band::read(&band_path)).transpose()?;
        if band.as_ref().is_some_and(|band| band.time_s != columns[0]) {
            bail!("{}: band.csv and trace.csv are of two runs", folder.display());
        }
        Ok(StoredRun {
            rig,
            mm_per_count,
            open_loop,
            windows,
            band,
            spacing: spacing_of(&description),
            accuracy: accuracy_of(&description),
            columns,
        })
    }

    /// A column of the trace by its name.
    ///
    /// # Panics
    /// When there is no such column: a slip in the program.
    #[must_use]
    pub fn column(&self, name: &str) -> &[f64] {
        let index = COLUMNS.iter().position(|column| *column == name);
        &self.columns[index.unwrap_or_else(|| panic!("trace.csv has no column {name}"))]
    }
}

/// The rig of a run folder, with every value that it was run with.
///
/// # Errors
/// When run.json cannot be read, or this program does not take its values any more.
pub fn rig_of(folder: &Path) -> Result<Rig> {
    let path = folder.join("run.json");
    let description = read_json(&path)?;
    let keys = description["keys"].as_object().with_context(|| format!("{} has no keys", path.display()))?;
    let name = description["rig"].as_str().unwrap_or("run");
    Ok(Rig::read(name, &rig_text::of_keys(keys)?)?)
}

/// Whether the trace of a run folder is that of a run, to the last digit.
///
/// # Errors
/// When it cannot be read.
pub fn is_trace(folder: &Path, run: &Run) -> Result<bool> {
    let path = folder.join("trace.csv");
    let stored = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(stored == to_csv(&run.rows).as_bytes())
}

fn spacing_of(description: &serde_json::Value) -> Option<Spacing> {
    Some(Spacing {
        runs: usize::try_from(description["ensemble"]["runs"].as_u64()?).ok()?,
        relative: description["ensemble"]["relative_change"].as_f64()?,
    })
}

fn accuracy_of(description: &serde_json::Value) -> Option<Accuracy> {
    let methods = [Method::DormandPrince, Method::Merson];
    let method = methods.into_iter().find(|method| description["method"] == format!("{method:?}"))?;
    Some(Accuracy { method, tolerance: description["tolerance"].as_f64()? })
}

fn read_json(path: &Path) -> Result<serde_json::Value> {
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let value: serde_json::Value =
        serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))?;
    if value["format"] != FORMAT {
        bail!("{} is not a run of this program: its format is not {FORMAT:?}", path.display());
    }
    Ok(value)
}

fn columns_of(text: &str) -> Result<Vec<Vec<f64>>> {
    let mut lines = text.lines().enumerate();
    if lines.next().map(|(_, line)| line) != Some(COLUMNS.join(",").as_str()) {
        bail!("line 1: expected the header {}", COLUMNS.join(","));
    }
    let mut columns = vec![Vec::new(); COLUMNS.len()];
    for (number, line) in lines {
        let values: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let whole = |values: &Vec<f64>| values.len() == COLUMNS.len() && values.iter().all(|v| v.is_finite());
        let values = values.ok().filter(whole);
        let values =
            values.ok_or_else(|| anyhow!("line {}: expected {} numbers", number + 1, COLUMNS.len()))?;
        if columns[0].last().is_some_and(|last| values[0] <= *last) {
            bail!("line {}: its time is not after that of the line before", number + 1);
        }
        for (column, value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble::run_ensemble;
    use pneudrive_sim::rig::BUILTIN;

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
        assert!(made.success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe)
        });
        put(&pipe, "text").expect("written");
        assert_eq!(reader.join().expect("a reader").expect("text"), "text");
        assert!(!fs::metadata(&pipe).expect("there").is_file());
    }

    #[test]
    fn the_rig_of_a_run_folder_is_the_rig_that_was_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let fault = "\n[[faults.event]]\nkind = \"supply-dip\"\nat_s = 0.01\npressure_pa = 4e5\n";
        let with_fault = Rig::read("dips", fault).unwrap_or_else(|problems| panic!("{problems}"));
        let built_in = BUILTIN.iter().map(|(name, _)| Rig::builtin(name).expect("a built-in rig"));
        for rig in built_in.chain([with_fault]) {
            let rig = rig.with_numbers(&[("test.duration_s", 0.03)]).unwrap_or(rig);
            let spacing = Spacing { runs: 2, ..Spacing::default() };
            let ensemble = run_ensemble(&rig, Accuracy::of(&rig), spacing, |_, _| (), |_, _| {});
            write(folder.path(), &rig, &ensemble.expect("runs").nominal, &[]).expect("written");
            let read = rig_of(folder.path()).unwrap_or_else(|error| panic!("{}: {error:#}", rig.name()));
            for (key, value) in rig.entries() {
                assert_eq!(read.value(key.path), Some(value), "{}: {}", rig.name(), key.path);
            }
            let stored = StoredRun::read(folder.path()).expect("a run folder");
            assert_eq!((stored.spacing, stored.accuracy), (Some(spacing), Some(Accuracy::of(&rig))));
        }
    }

    #[test]
    fn a_file_that_cannot_be_placed_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir_all(folder.path().join("page.html/inside")).expect("a folder in its place");
        let error = put(&folder.path().join("page.html"), "text").expect_err("a folder is there");
        assert!(error.to_string().starts_with("cannot write "), "{error}");
        let left = fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 1, "the folder alone");
    }
}
