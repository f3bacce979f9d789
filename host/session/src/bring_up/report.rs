//! The report of a bring-up, as text for a file.

use pneudrive_records::rig_info::Info;
use serde_json::{Value, json};

/// The verdict of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Right.
    Right,
    /// Wrong.
    Wrong,
    /// Not seen, or not tried.
    NotChecked,
}

impl Verdict {
    /// The verdict in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Right => "right",
            Verdict::Wrong => "WRONG",
            Verdict::NotChecked => "not checked",
        }
    }
}

/// A check: what was done and seen, what is right, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// What was done.
    pub did: String,
    /// What was seen, with units.
    pub saw: String,
    /// What is right.
    pub must: String,
    /// The verdict.
    pub verdict: Verdict,
    /// What to do if it is wrong: wires first, then settings.
    pub advice: Vec<String>,
}

impl Check {
    /// A check that was done. It is right if there is nothing to do.
    pub fn of(name: &'static str, did: &str, saw: String, must: &str, advice: Vec<String>) -> Check {
        let verdict = if advice.is_empty() { Verdict::Right } else { Verdict::Wrong };
        Check { name, did: did.to_owned(), saw, must: must.to_owned(), verdict, advice }
    }

    /// A check that was not done, and why.
    pub fn left_out(name: &'static str, why: &str) -> Check {
        Check {
            name,
            did: "nothing".to_owned(),
            saw: why.to_owned(),
            must: String::new(),
            verdict: Verdict::NotChecked,
            advice: Vec::new(),
        }
    }

    /// Its figures.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({
            "name": self.name,
            "did": self.did,
            "saw": self.saw,
            "must": self.must,
            "verdict": self.verdict.word().to_lowercase(),
            "advice": self.advice,
        })
    }
}

/// The findings of a bring-up.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Kind of board.
    pub board: String,
    /// Version of its firmware, and what it was built from.
    pub firmware: String,
    /// The checks, in their order.
    pub checks: Vec<Check>,
}

impl Report {
    pub(super) fn of(info: &Info) -> Report {
        let firmware = format!("{} ({}), protocol {}", info.firmware, info.build, info.version);
        Report { board: info.board.clone(), firmware, checks: Vec::new() }
    }

    /// The checks that are wrong.
    pub fn wrong(&self) -> impl Iterator<Item = &Check> {
        self.checks.iter().filter(|check| check.verdict == Verdict::Wrong)
    }

    /// The verdicts in one line.
    #[must_use]
    pub fn summary(&self) -> String {
        let count = |verdict| self.checks.iter().filter(|check| check.verdict == verdict).count();
        let [right, wrong, open] = [Verdict::Right, Verdict::Wrong, Verdict::NotChecked].map(count);
        format!("{right} checks right, {wrong} wrong, {open} not checked")
    }

    /// The report as a page of Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let row = |check: &Check| {
            let Check { name, did, saw, must, verdict, .. } = check;
            format!("| {name} | {did} | {saw} | {must} | {} |\n", verdict.word())
        };
        let rows: String = self.checks.iter().map(row).collect();
        let todo: String = self
            .wrong()
            .flat_map(|check| check.advice.iter().map(move |advice| format!("- {}: {advice}\n", check.name)))
            .collect();
        let todo = if todo.is_empty() { "Nothing.\n".to_owned() } else { todo };
        format!(
            "# Bring-up\n\n- board: {}\n- firmware: {}\n- {}\n\n| check | what was done | seen | must be | verdict |\n|---|---|---|---|---|\n{rows}\n## To do\n\n{todo}",
            self.board,
            self.firmware,
            self.summary()
        )
    }
}
