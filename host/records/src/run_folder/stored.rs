//! Reading of a run folder.

use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::component::encoder::{EncoderKind, mm_per_count};
use pneudrive_sim::keys;
use pneudrive_sim::schedule::MOVE_FORMS;
use pneudrive_sim::trace::{COLUMNS, Extra, to_csv};
use pneudrive_sim::{Accuracy, Method, Rig, Run};
use serde_json::Map;

use crate::judged::{Judged, Spacing};

use super::checksum::checksum;
use super::holding::Holding;
use super::json_file::{json_of, read_json};
use super::replacement::settle;
use super::{BAND, CHECKSUMS, Numbered, OPEN, RUN, TRACE, WINDOWS};
use crate::band::Band;
use crate::window::{WHOLE_WINDOW, whole_window};
use crate::{rig_text, text_file};

/// The key of the encoder's scale, and the requirement on its value.
const SCALE: &str = keys::encoder::MM_PER_COUNT.key.path;
const MORE_THAN_0: &str = "it must be a number above 0";

/// A stored run: its description and the columns of its trace.
#[derive(Clone, Debug)]
pub struct StoredRun {
    /// The name of the rig.
    pub rig: String,
    /// Its number in its folder, and its date; None for one that is not written.
    pub numbered: Option<Numbered>,
    /// mm of stroke per encoder count.
    pub mm_per_count: f64,
    /// Whether its moves are commands.
    pub open_loop: bool,
    /// Windows of the controller's velocity and acceleration, samples.
    pub windows: [u8; 2],
    /// The range of the run and its perturbed runs, if it has any.
    pub band: Option<Band>,
    /// The number and distance of its perturbed runs; None without perturbed runs.
    pub spacing: Option<Spacing>,
    /// The accuracy of its integration; None if this program does not know the method.
    pub accuracy: Option<Accuracy>,
    /// Its optional columns.
    pub extras: Vec<&'static Extra>,
    /// The force that holds its load; None if this program no longer accepts the values of its rig.
    pub holding: Option<Holding>,
    columns: Vec<Vec<f64>>,
}

impl StoredRun {
    /// A run that has not been written.
    #[must_use]
    pub fn of(rig: &Rig, run: &Run) -> StoredRun {
        let mut columns = Vec::from(COLUMNS.map(|_| Vec::with_capacity(run.rows.len())));
        for row in &run.rows {
            for (column, value) in columns.iter_mut().zip(row.values()) {
                column.push(value);
            }
        }
        StoredRun {
            rig: rig.name().to_owned(),
            numbered: None,
            mm_per_count: mm_per_count(rig),
            open_loop: rig.get(&keys::controller::LOOP) == Loop::Open,
            windows: WINDOWS.map(|key| rig.get(key) as u8),
            band: None,
            spacing: None,
            accuracy: None,
            holding: Some(Holding::of(rig)),
            extras: Vec::new(),
            columns,
        }
    }

    /// The same with its band and all of its columns.
    #[must_use]
    pub fn of_judged(rig: &Rig, judged: &Judged) -> StoredRun {
        let run = StoredRun::of(rig, &judged.run);
        let value = |extra: &Extra| judged.run.rows.iter().map(|row| extra.value(row)).collect();
        let more: Vec<Vec<f64>> = judged.columns.iter().map(|extra| value(extra)).collect();
        StoredRun {
            extras: judged.columns.clone(),
            columns: [run.columns, more].concat(),
            band: judged.band.clone(),
            spacing: judged.band.as_ref().map(|_| judged.spacing),
            accuracy: Some(judged.accuracy),
            ..run
        }
    }

    /// Reads a run folder.
    ///
    /// # Errors
    /// With the file and the line of the problem.
    pub fn read(folder: &Path) -> Result<StoredRun> {
        if let Some(said) = settle(folder)? {
            log::info!("{said}");
        }
        let json_path = folder.join(RUN);
        if !json_path.exists() {
            bail!("{} is not a run folder: it has no run.json", folder.display());
        }
        let description = read_json(&json_path)?;
        let trace = read_text(&folder.join(TRACE))?;
        let run = StoredRun::of_texts(folder, &description, &trace)?;
        let band = read_band(folder, &description, &run.columns[0])?;
        Ok(StoredRun { band, ..run })
    }

    /// A run folder that is not on this machine, by the texts of its run.json and its trace.csv; without its band. `name` is for
    /// messages.
    ///
    /// # Errors
    /// As [`StoredRun::read`].
    pub fn of_files(name: &str, run_json: &str, trace: &str) -> Result<StoredRun> {
        let folder = Path::new(name);
        StoredRun::of_texts(folder, &json_of(&folder.join(RUN), run_json)?, trace)
    }

    fn of_texts(folder: &Path, description: &serde_json::Value, trace: &str) -> Result<StoredRun> {
        let json_path = folder.join(RUN);
        let mm_per_count = scale_of(&json_path, description)?;
        let (extras, columns) =
            columns_of(trace).with_context(|| folder.join(TRACE).display().to_string())?;
        let window = |key: &str| of_key(&json_path, description, key, whole_window, WHOLE_WINDOW);
        let windows = [window(WINDOWS[0].path)?, window(WINDOWS[1].path)?];
        check_rows(folder, description, columns[0].len())?;
        check(folder, description, TRACE, trace)?;
        Ok(StoredRun {
            rig: description["rig"].as_str().unwrap_or("run").to_owned(),
            numbered: Numbered::of(description),
            mm_per_count,
            open_loop: description["keys"][keys::controller::LOOP.path] == OPEN,
            windows,
            band: None,
            spacing: spacing_of(description),
            accuracy: accuracy_of(description),
            holding: rig_in(&json_path, description).ok().map(|rig| Holding::of(&rig)),
            extras,
            columns,
        })
    }

    /// A column of the trace by its name.
    ///
    /// # Panics
    /// When there is no such column: a bug in the program.
    #[must_use]
    pub fn column(&self, name: &str) -> &[f64] {
        let mut names = COLUMNS.into_iter().chain(self.extras.iter().map(|extra| extra.name));
        let index = names.position(|column| column == name);
        &self.columns[index.unwrap_or_else(|| panic!("trace.csv has no column {name}"))]
    }

    /// All columns of the trace with their names, in its order.
    pub fn into_columns(self) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
        let names = COLUMNS.into_iter().chain(self.extras.into_iter().map(|extra| extra.name));
        names.zip(self.columns)
    }
}

/// The rig of a run folder, with all values of the run.
///
/// # Errors
/// When run.json cannot be read, or this program no longer accepts its values.
pub fn rig_of(folder: &Path) -> Result<Rig> {
    let path = folder.join(RUN);
    rig_in(&path, &read_json(&path)?)
}

fn rig_in(path: &Path, description: &serde_json::Value) -> Result<Rig> {
    let keys = description["keys"].as_object().with_context(|| format!("{} has no keys", path.display()))?;
    let name = description["rig"].as_str().unwrap_or("run");
    Ok(Rig::read(name, &rig_text::of_keys(&with_one_form_of_moves(keys.clone()))?)?)
}

/// run.json has the default of test.moves beside the moves that hold; a rig file may not have both.
fn with_one_form_of_moves(mut keys: Map<String, serde_json::Value>) -> Map<String, serde_json::Value> {
    if MOVE_FORMS.iter().filter(|form| keys.contains_key(form.path)).count() > 1 {
        keys.remove(keys::test::MOVES.path);
    }
    keys
}

/// Whether the trace of a run folder equals that of a run, to the last digit, in the columns that every trace has.
///
/// # Errors
/// When it cannot be read.
pub fn is_trace(folder: &Path, run: &Run) -> Result<bool> {
    let text = read_text(&folder.join(TRACE))?;
    let expected = to_csv(&run.rows);
    let common = |line: &str| line.split(',').take(COLUMNS.len()).collect::<Vec<_>>().join(",");
    Ok(text.lines().count() == expected.lines().count()
        && text.lines().zip(expected.lines()).all(|(line, expected)| common(line) == expected))
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

fn read_text(path: &Path) -> Result<String> {
    text_file::read_own(path)
}

/// The band of a run whose trace has these times; None without perturbed runs, or if its program wrote none.
fn read_band(folder: &Path, description: &serde_json::Value, time_s: &[f64]) -> Result<Option<Band>> {
    let path = folder.join(BAND);
    let is_there = !description[CHECKSUMS][BAND].is_null() || path.exists();
    if description["ensemble"].is_null() || !is_there {
        return Ok(None);
    }
    check(folder, description, BAND, &read_text(&path)?)?;
    let band = Band::read(&path)?;
    if band.time_s != time_s {
        bail!("{}: band.csv and trace.csv belong to different runs", folder.display());
    }
    Ok(Some(band))
}

/// Checks that a trace has all rows of its run.
fn check_rows(folder: &Path, description: &serde_json::Value, rows: usize) -> Result<()> {
    if rows == 0 {
        bail!("{} has no samples", folder.display());
    }
    let told = &description["rows"];
    if *told != rows {
        bail!("{} has {rows} of the {told} rows of its run: it is truncated", folder.join(TRACE).display());
    }
    Ok(())
}

/// mm per count: the key or, for a potentiometer, which has none, the value from its range and converter.
fn scale_of(json_path: &Path, description: &serde_json::Value) -> Result<f64> {
    let above_0 = |mm: f64| (mm > 0.0).then_some(mm);
    if description["keys"][keys::encoder::MODEL.path] != EncoderKind::Potentiometer.word() {
        return of_key(json_path, description, SCALE, above_0, MORE_THAN_0);
    }
    let value = &description["mm_per_count"];
    let wrong = || anyhow!("{}: mm_per_count is {value}; {MORE_THAN_0}", json_path.display());
    value.as_f64().and_then(above_0).ok_or_else(wrong)
}

/// The value of a key, if `read` accepts it; otherwise, an error with the requirement.
fn of_key<T>(
    json_path: &Path,
    description: &serde_json::Value,
    key: &str,
    read: impl FnOnce(f64) -> Option<T>,
    must: &str,
) -> Result<T> {
    let value = &description["keys"][key];
    let wrong = || anyhow!("{}: {key} is {value}; {must}", json_path.display());
    value.as_f64().and_then(read).ok_or_else(wrong)
}

/// Checks that a file has the checksum in run.json.
fn check(folder: &Path, description: &serde_json::Value, name: &str, text: &str) -> Result<()> {
    if description[CHECKSUMS][name] != checksum(text) {
        bail!(
            "{} does not belong to run.json: it was changed or damaged, or is from another run",
            folder.join(name).display()
        );
    }
    Ok(())
}

/// The optional columns in the header of a trace.
fn extras_of(header: &str) -> Result<Vec<&'static Extra>> {
    let expected = || anyhow!("line 1: expected the header {}", COLUMNS.join(","));
    let more = header.strip_prefix(&COLUMNS.join(",")).ok_or_else(expected)?;
    let named = |name: &str| Extra::named(name).ok_or_else(|| anyhow!("line 1: there is no column {name}"));
    match more.strip_prefix(',') {
        Some(names) => names.split(',').map(named).collect(),
        None if more.is_empty() => Ok(Vec::new()),
        None => Err(expected()),
    }
}

fn columns_of(text: &str) -> Result<(Vec<&'static Extra>, Vec<Vec<f64>>)> {
    let mut lines = text.lines().enumerate();
    let extras = extras_of(lines.next().map_or("", |(_, line)| line))?;
    let width = COLUMNS.len() + extras.len();
    let mut columns = vec![Vec::new(); width];
    for (number, line) in lines {
        let values: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let whole = |values: &Vec<f64>| values.len() == width && values.iter().all(|v| v.is_finite());
        let values = values.ok().filter(whole);
        let values = values.ok_or_else(|| anyhow!("line {}: expected {width} numbers", number + 1))?;
        if columns[0].last().is_some_and(|last| values[0] <= *last) {
            bail!("line {}: its time is not after that of the line before", number + 1);
        }
        for (column, value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
    }
    Ok((extras, columns))
}
