//! Studies of the rig of the page: what `sweep`, `tune` and `identify` do, with their figures, and the command line of each.
//!
//! ```text
//! plan(study)  ->  command line, size of the work, and what is wrong with it: as one types
//! work(study)  ->  progress ... progress  ->  { "result", "page", "settings" }
//! ```
//!
//! `result` is that of the command's `--json` (docs/json.md), `page` holds the notes, tables and graphs of its page, and
//! `settings` are what a user may take over, as `key=value`.

mod exhibit;
mod identify;
mod meter;
mod sweep;
mod tune;

use pneudrive_optimise::sweep::metric::FIGURES;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::refusal::Refusal;

/// What is to be done.
#[derive(Debug, Deserialize)]
#[serde(tag = "study", rename_all = "kebab-case")]
pub enum Study {
    /// Keys vary, figures of the moves are collected.
    Sweep(sweep::Asks),
    /// Gains for a step.
    Tune(tune::Asks),
    /// Parameters of the rig from records.
    Identify(identify::Asks),
}

/// Who waits for a study.
pub struct Audience<'a> {
    /// Hears how far it is: `what` is done, how much of it, of how much; 0 of 0 where nobody knows.
    pub hears: &'a mut (dyn FnMut(Value) + Send),
    /// Whether it waits: once it does not, no more runs are begun.
    pub waits: &'a (dyn Fn() -> bool + Sync),
}

impl Study {
    /// Reads what a page asks for.
    ///
    /// # Errors
    /// When it is no study.
    pub fn read(body: &Value) -> Result<Study, Refusal> {
        Study::deserialize(body).map_err(|error| Refusal::wrong(error.to_string()))
    }

    /// What would be done: the command line that does the same, and the size of the work.
    ///
    /// # Errors
    /// With what is wrong with it.
    pub fn plan(&self) -> Result<Value, Refusal> {
        match self {
            Study::Sweep(asks) => asks.plan(),
            Study::Tune(asks) => asks.plan(),
            Study::Identify(asks) => asks.plan(),
        }
    }

    /// Does it, as long as somebody waits.
    ///
    /// # Errors
    /// With what is wrong with it, or that nobody waits any more.
    pub fn work(&self, audience: Audience<'_>) -> Result<Value, Refusal> {
        match self {
            Study::Sweep(asks) => asks.work(audience),
            Study::Tune(asks) => asks.work(audience),
            Study::Identify(asks) => asks.work(audience),
        }
    }
}

/// What a page needs to ask for studies: the figures of a move that a sweep collects, and what a tuning begins with.
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
