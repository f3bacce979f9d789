//! The number and the date of a run, and whether it may replace another (thesis I.1 (a) to (c)).
//!
//! The runs of a folder are counted: a run has the number after that of the run that it replaces. The date is that of the
//! clock, or of `SOURCE_DATE_EPOCH` (seconds since 1970), with which a run can be written again byte for byte.

use std::fmt;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use jiff::Timestamp;
use pneudrive_sim::Rig;

use super::RUN;
use super::json_file::read_json;
use super::replacement::settle;

/// What happens to a run of another rig in the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is kept, and the new one is refused.
    Keep,
    /// The new one replaces it.
    Overwrite,
}

/// The identity of a run in its folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbered {
    /// Its number in its folder, from 1 on.
    pub run: u64,
    /// When it was written, UTC, as `2026-11-22T14:05:00Z`.
    pub date: String,
}

impl fmt::Display for Numbered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "run {}, {}", self.run, self.date)
    }
}

impl Numbered {
    /// The identity of the next run in a folder.
    ///
    /// # Errors
    /// As [`refuse_other_rig`], and when `SOURCE_DATE_EPOCH` is not a time.
    pub(super) fn next(folder: &Path, rig: &Rig, existing: Existing) -> Result<Numbered> {
        // A run that a killed program left behind counts as the last one.
        if let Some(said) = settle(folder)? {
            log::info!("{said}");
        }
        refuse_other_rig(folder, rig, existing)?;
        let before = last_run(folder).and_then(|run| run["run"].as_u64()).unwrap_or(0);
        Ok(Numbered { run: before.saturating_add(1), date: date(std::env::var(EPOCH).ok())? })
    }

    /// The identity in the description of a run; None if the description lacks it.
    pub(super) fn of(description: &serde_json::Value) -> Option<Numbered> {
        Some(Numbered { run: description["run"].as_u64()?, date: description["date"].as_str()?.to_owned() })
    }
}

/// Refuses a folder with a run of another rig, unless it may be overwritten. Called before long work, and again before
/// writing.
///
/// # Errors
/// When there is such a run.
pub fn refuse_other_rig(folder: &Path, rig: &Rig, existing: Existing) -> Result<()> {
    let Some(run) = last_run(folder).filter(|_| existing == Existing::Keep) else { return Ok(()) };
    match run["rig"].as_str() {
        Some(other) if other != rig.name() => bail!(
            "{} has a run of {other}; choose another folder for {}, or replace it with --overwrite",
            folder.display(),
            rig.name()
        ),
        _ => Ok(()),
    }
}

/// The run in a folder, if this program has written one there.
fn last_run(folder: &Path) -> Option<serde_json::Value> {
    read_json(&folder.join(RUN)).ok()
}

/// The environment variable that fixes the date.
const EPOCH: &str = "SOURCE_DATE_EPOCH";

fn date(fixed: Option<String>) -> Result<String> {
    let Some(fixed) = fixed else {
        ensure!(!cfg!(target_family = "wasm"), "there is no clock here; set {EPOCH}, in seconds since 1970");
        return Ok(whole_seconds(Timestamp::now()));
    };
    let seconds = fixed.parse::<i64>().ok().and_then(|seconds| Timestamp::from_second(seconds).ok());
    let date = seconds.with_context(|| format!("{EPOCH} is {fixed:?}; it must be seconds since 1970"))?;
    Ok(whole_seconds(date))
}

fn whole_seconds(date: Timestamp) -> String {
    Timestamp::from_second(date.as_second()).unwrap_or(date).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_date_is_utc_in_whole_seconds_and_can_be_fixed() {
        assert_eq!(date(Some("1700000000".to_owned())).expect("a time"), "2023-11-14T22:13:20Z");
        let now = date(None).expect("a clock");
        assert!(now.len() == 20 && now.ends_with('Z'), "{now}");
        let refused = date(Some("yesterday".to_owned())).expect_err("no time").to_string();
        assert_eq!(refused, "SOURCE_DATE_EPOCH is \"yesterday\"; it must be seconds since 1970");
    }
}
