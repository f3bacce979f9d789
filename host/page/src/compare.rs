//! Overlays a TARGET file or a run folder on the page's run, aligned if requested, with the deviation, as `overlay` does.

use pneudrive_evaluate::alignment::Align;
use pneudrive_evaluate::deviation::{deviations, table};
use pneudrive_evaluate::evaluation::{self, Chambers, Motion, moves, refuse_other_rig, tolerance_mm};
use pneudrive_evaluate::known::replay_of_rig;
use pneudrive_evaluate::transient::{CHANNELS, Transient};
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Rig, run};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::columns::{Column, Columns};
use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;
use crate::simulation::{extra_curves, rig_of, to_json};

/// A record, and the rig of the page.
#[derive(Debug, Deserialize)]
pub struct Compared {
    #[serde(flatten)]
    asked: PageRig,
    record: Record,
    #[serde(default, with = "AlignName")]
    align: Align,
}

/// The page's names of the alignments.
#[derive(Deserialize)]
#[serde(remote = "Align", rename_all = "lowercase")]
enum AlignName {
    Start,
    Move,
    Correlation,
}

/// The record over a run.
#[derive(Debug, Deserialize)]
pub(crate) struct Record {
    /// The name of the file or of the folder.
    pub name: String,
    #[serde(flatten)]
    content: Content,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Content {
    /// A TARGET file or a streamed run.
    File { text: String },
    /// A run folder: its run.json and its trace.csv.
    Folder { run_json: String, trace_csv: String },
}

impl Record {
    /// Its transient.
    ///
    /// # Errors
    /// When the file or folder is damaged, or is of another kind.
    pub(crate) fn transient(&self) -> Result<Transient, HttpRefusal> {
        match &self.content {
            Content::File { .. } => {
                let transient = Transient::of_target(&self.name, &self.target()?);
                transient.map_err(|error| HttpRefusal::wrong(format!("{}: {error:#}", self.name)))
            }
            Content::Folder { run_json, trace_csv } => {
                let run = StoredRun::of_files(&self.name, run_json, trace_csv);
                let run = run.map_err(|error| HttpRefusal::wrong(format!("{error:#}")))?;
                Ok(Transient::of_run(&self.name, &run))
            }
        }
    }

    /// Its name. A run folder also has the name of its rig, from its run.json.
    fn title(&self) -> String {
        let Content::Folder { run_json, .. } = &self.content else { return self.name.clone() };
        let description: Option<Value> = serde_json::from_str(run_json).ok();
        let rig = description.as_ref().and_then(|description| description["rig"].as_str());
        rig.map_or_else(|| self.name.clone(), |rig| format!("{}, a run of {rig}", self.name))
    }

    /// The file as a rig has recorded it.
    ///
    /// # Errors
    /// When it is damaged, or is a simulated run.
    pub(crate) fn target(&self) -> Result<TargetFile, HttpRefusal> {
        match &self.content {
            Content::File { text } => TargetFile::from_text(text)
                .map_err(|error| HttpRefusal::wrong(format!("{}: {error:#}", self.name))),
            Content::Folder { .. } => {
                Err(HttpRefusal::wrong(format!("{} is a simulated run, and no record of a rig", self.name)))
            }
        }
    }
}

/// The curves of the record, shifted to lie over the simulation, and the deviation of the simulation from them.
///
/// # Errors
/// When the file is damaged or of another kind, the two cannot be aligned, or the rig cannot be simulated.
pub fn answer(Compared { asked, record, align }: &Compared) -> Result<Vec<u8>, HttpRefusal> {
    let mut recorded = record.transient()?;
    recorded.extras = record.known(asked);
    let figures = figures(record, &recorded, &asked.rig()?);
    let simulated = simulated(asked)?;
    recorded.error_in_counts_of(simulated.mm_per_count);
    let shift =
        align.shift(&simulated, &recorded).map_err(|error| HttpRefusal::wrong(format!("{error:#}")))?;
    recorded.shift(shift);
    let found = deviations(&recorded, &simulated);
    if found.is_empty() {
        return Err(HttpRefusal::wrong(format!("{} and the simulation have no time in common", record.name)));
    }
    let shifted = if shift == 0.0 { String::new() } else { format!(", shifted by {:.3} ms", 1e3 * shift) };
    let heading = format!("deviation of the simulation, one run, from {}{shifted}", record.title());
    let head = json!({ "name": record.name, "shift_s": shift, "figures": figures, "deviation": to_json(&table(&heading, &found)) });
    Ok(curves(&recorded).to_bytes(head))
}

/// The figures of a record's own moves, with the air only where it is of the same cylinder.
fn figures(record: &Record, recorded: &Transient, rig: &Rig) -> Value {
    let chambers = refuse_other_rig(recorded, rig).is_ok().then(|| Chambers::of(rig));
    let tolerance_mm = tolerance_mm(Some(rig));
    let moves = moves(recorded, &Motion::of(recorded), chambers.as_ref(), tolerance_mm);
    let mut table = evaluation::table(&[moves], tolerance_mm);
    table.heading = format!("{}: {}", record.title(), table.heading);
    to_json(&table)
}

impl Record {
    /// What the law of the record knew, if that of the page's rig has a model of its drive and the record can be replayed
    /// with it.
    fn known(&self, asked: &PageRig) -> Vec<(&'static Extra, Vec<f64>)> {
        let (Ok(rig), Ok(file)) = (asked.rig(), self.target()) else { return Vec::new() };
        let Ok(replay) = replay_of_rig(&self.name, &file, &rig) else { return Vec::new() };
        // Nothing is known before the run.
        let before = file.samples.iter().filter(|(index, _)| *index < 0).count();
        let whole = |values: Vec<f64>| [vec![f64::NAN; before], values].concat();
        replay.known_columns(&rig).into_iter().map(|(extra, values)| (extra, whole(values))).collect()
    }
}

/// The transient of a rig's run.
///
/// # Errors
/// When the rig is not valid, too long for a page, or cannot be integrated.
pub(crate) fn simulated(asked: &PageRig) -> Result<Transient, HttpRefusal> {
    let rig = rig_of(asked)?;
    let run = run(&rig, Accuracy::of(&rig)).map_err(|error| HttpRefusal::of(&error.into()))?;
    Ok(Transient::of_run(rig.name(), &StoredRun::of(&rig, &run)))
}

fn curves(transient: &Transient) -> Columns {
    let column = |(&(name, unit), values): (&(&'static str, &'static str), &Vec<f64>)| Column {
        name,
        unit,
        values: values.iter().map(|value| *value as f32).collect(),
    };
    let mut columns: Vec<Column> = CHANNELS.iter().zip(&transient.channels).map(column).collect();
    columns.extend(extra_curves(&transient.extras));
    Columns { time: transient.time.clone(), columns }
}
