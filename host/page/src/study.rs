//! Studies of the page's rig: `sweep`, `tune` and `identify` with their figures, and the command line of each.
//!
//! ```text
//! plan(study)  ->  command line, size of the work, and what is wrong with it: as one types
//! work(study)  ->  progress ... progress  ->  { "result", "page", "settings" }
//! ```
//!
//! `result` is the document of the command's `--json` (docs/reference/json.md). `page` holds the notes, tables and graphs of
//! its page. `settings` are values that the user may take over, as `key=value`.

mod exhibit;
mod identify;
mod meter;
mod sweep;
mod tune;

use pneudrive_optimise::sweep::metric::FIGURES;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::refusal::HttpRefusal;

/// A study.
#[derive(Debug, Deserialize)]
#[serde(tag = "study", rename_all = "kebab-case")]
pub enum Study {
    /// Keys vary, and figures of the moves are collected.
    Sweep(sweep::SweepRequest),
    /// Gains for a step.
    Tune(tune::TuneRequest),
    /// Parameters of the rig from records.
    Identify(identify::IdentifyRequest),
}

/// The page that waits for a study.
pub struct Audience<'a> {
    /// Receives the progress: the task, the work done and the total; 0 of 0 where the total is unknown.
    pub hears: &'a mut (dyn FnMut(Value) + Send),
    /// Whether the page still waits; once it does not, no further run begins.
    pub waits: &'a (dyn Fn() -> bool + Sync),
}

impl Study {
    /// Reads a request for a study.
    ///
    /// # Errors
    /// When it is not a study.
    pub fn read(body: &Value) -> Result<Study, HttpRefusal> {
        Study::deserialize(body).map_err(|error| HttpRefusal::wrong(error.to_string()))
    }

    /// The plan: the equivalent command line, and the size of the work.
    ///
    /// # Errors
    /// Its problems.
    pub fn plan(&self) -> Result<Value, HttpRefusal> {
        match self {
            Study::Sweep(asks) => asks.plan(),
            Study::Tune(asks) => asks.plan(),
            Study::Identify(asks) => asks.plan(),
        }
    }

    /// Runs the study while somebody waits.
    ///
    /// # Errors
    /// The problems of the request, or that the page has stopped waiting.
    pub fn work(&self, audience: Audience<'_>) -> Result<Value, HttpRefusal> {
        match self {
            Study::Sweep(asks) => asks.work(audience),
            Study::Tune(asks) => asks.work(audience),
            Study::Identify(asks) => asks.work(audience),
        }
    }
}

/// The choices for studies: the figures of a move that a sweep can collect, and the defaults of a tuning.
#[must_use]
pub fn choices() -> Value {
    let figures = FIGURES.iter().map(|figure| json!({ "name": figure.name, "meaning": figure.meaning }));
    json!({ "figures": figures.collect::<Vec<_>>(), "goal": tune::Goal::default() })
}

#[cfg(test)]
mod tests {
    use http::StatusCode;

    use super::*;

    #[test]
    fn what_is_no_study_is_refused_with_its_name() {
        let refusal = Study::read(&json!({ "study": "steam" })).expect_err("no study");
        assert_eq!(refusal.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(refusal.message.contains("steam"), "{}", refusal.message);
    }
}
