//! Parameters of the rig of the page from the records on it.

use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_identify::figures::Figures;
use pneudrive_identify::parameter::{Parameter, usual};
use pneudrive_identify::recording::Recording;
use pneudrive_identify::{Identification, identify, report};
use pneudrive_sim::{Accuracy, Rig};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Audience, exhibit};
use crate::compare::Record;
use crate::page_rig::{PageRig, quoted};
use crate::refusal::HttpRefusal;

/// A rig, its records, and the keys to fit.
#[derive(Debug, Deserialize)]
pub struct IdentifyRequest {
    #[serde(flatten)]
    asked: PageRig,
    records: Vec<Record>,
    /// Keys to fit; without any, those that are never known exactly.
    #[serde(default)]
    fit: Vec<String>,
}

impl IdentifyRequest {
    pub fn plan(&self) -> Result<Value, HttpRefusal> {
        let rig = self.asked.rig()?;
        let fitted = self.parameters(&rig)?;
        self.recordings(&rig)?;
        let names = self.records.iter().map(|record| format!("{} ", quoted(&record.name)));
        let fit = if self.fit.is_empty() { String::new() } else { format!("--fit {} ", self.fit.join(",")) };
        let rest = format!("{}{fit}--out identified", names.collect::<String>());
        let unknown = |parameter: &Parameter| json!({ "key": parameter.key.path, "assumed_within": parameter.assumed_within() });
        let (count, records) = (fitted.len(), self.records.len());
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        Ok(json!({
            "command": self.asked.command("identify", &rest),
            "excitation": self.asked.command("identify", "--plan PORT --out plan"),
            "size": format!("{count} unknown{} in {records} record{}", plural(count), plural(records)),
            "unknowns": usual(&rig).iter().map(unknown).collect::<Vec<_>>(),
        }))
    }

    pub fn work(&self, audience: Audience<'_>) -> Result<Value, HttpRefusal> {
        let rig = self.asked.rig()?;
        let (recordings, fitted) = (self.recordings(&rig)?, self.parameters(&rig)?);
        if recordings.is_empty() {
            return Err(HttpRefusal::wrong("drop a TARGET file of the rig on the page first"));
        }
        let (accuracy, read) = (Accuracy::of(&rig), Figures::of(&rig, &recordings));
        let mut tell = |what: &str| (audience.hears)(json!({ "what": what, "done": 0, "all": 0 }));
        let cancel = CancelToken::cancelled_unless(audience.waits);
        let found = identify(&rig, &recordings, fitted, accuracy, &mut tell, cancel);
        let wrong = |error: &anyhow::Error| HttpRefusal::wrong(format!("{error:#}"));
        let found = found.map_err(|error| HttpRefusal::gone_or(&error, wrong))?;
        let mut page = report::page(&rig, &recordings, accuracy, &found, read.table(&rig));
        page.notes.splice(0..0, report::refusal(&found).map(|why| format!("No fit: {why}.")));
        let mut result = json!({ "read_off": report::read_off(&read) });
        if let (Value::Object(result), Value::Object(fields)) =
            (&mut result, report::to_json(&found, &recordings))
        {
            result.extend(fields);
        }
        Ok(json!({ "result": result, "page": exhibit::to_json(&page), "settings": settings(&found) }))
    }

    fn parameters(&self, rig: &Rig) -> Result<Vec<Parameter>, HttpRefusal> {
        if self.fit.is_empty() {
            return Ok(usual(rig));
        }
        let fit = self.fit.iter().map(|key| Parameter::of(rig, key));
        fit.collect::<Result<_, _>>().map_err(|error| HttpRefusal::wrong(format!("{error:#}")))
    }

    fn recordings(&self, rig: &Rig) -> Result<Vec<Recording>, HttpRefusal> {
        let recording = |record: &Record| {
            let recording = Recording::of(&record.name, &record.target()?, rig);
            recording.map_err(|error| HttpRefusal::wrong(format!("{error:#}")))
        };
        self.records.iter().map(recording).collect()
    }
}

/// The values of the fitted rig file, as `key=value`; none if the fit is refused.
fn settings(found: &Identification) -> Vec<String> {
    if !found.fits {
        return Vec::new();
    }
    let seen = found.estimates.iter().map(|one| (one.parameter.key.path, one.value));
    let shifted = found.unidentifiable.iter().filter(|one| one.value != one.parameter.start);
    let shifted = shifted.map(|one| (one.parameter.key.path, one.value));
    seen.chain(shifted).map(|(key, value)| format!("{key}={value:?}")).collect()
}
