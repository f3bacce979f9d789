//! The rig file that a tuning leaves: the whole result, and what was searched for it.

use anyhow::Result;
use pneudrive_records::rig_text;
use pneudrive_sim::rig::Key;
use pneudrive_sim::{Rig, keys};

use super::super::trial::Trial;
use super::super::{Space, Task, Tuned, fixed};
use super::verdict::verdict;

/// First line of a rig file that was written here.
pub const MARK: &str = "# Written by pneudrive tune";

/// How the lines behind it begin.
const LINES: [&str; 3] = ["# Searched: ", "# Fixed: ", "# Not searched: "];

/// Keys that belong to the result though no search changes all of them.
static RESULT: [&Key; 5] = [
    &keys::controller::LAW.key,
    &keys::controller::VELOCITY_FEED_FORWARD.key,
    &keys::controller::ACCELERATION_FEED_FORWARD.key,
    &keys::dither::DITHER_MM.key,
    &keys::dither::DITHER_HZ.key,
];

/// The rig file with the settings and the gains, and with law, feed-forward and dither even where they have their defaults. Its
/// first lines give its origin, and which keys were searched, fixed and left as they were.
///
/// # Errors
/// When the text is not TOML, or makes no rig to be tuned.
pub fn rig_file(task: &Task, tuned: &Tuned) -> Result<String> {
    let typed: Vec<String> = task.settings.iter().chain(&task.fixed).cloned().collect();
    let text = rig_text::with_settings(without_head(&task.source.1), &typed, "set for pneudrive tune")?;
    let text = rig_text::with_settings(&text, &tuned.after.settings, "found by pneudrive tune")?;
    // The rig's own test may not suit the step.
    let rig = Trial::of(task, &[])?.rig.with_settings(&tuned.after.settings)?;
    let text = rig_text::with_settings(&text, &implied(&rig), "as without this line")?;
    Ok(format!("{MARK}: {}\n{}{text}", verdict(task, tuned), head(task, &rig)?))
}

/// A file that was tuned before, without what was said of that.
fn without_head(text: &str) -> &str {
    let is_own = |line: &str| line.starts_with(MARK) || LINES.iter().any(|own| line.starts_with(own));
    let own: usize = text.split_inclusive('\n').take_while(|line| is_own(line)).map(str::len).sum();
    &text[own..]
}

/// What of the result the file does not say, as `key=value`.
fn implied(rig: &Rig) -> Vec<String> {
    let silent = RESULT.into_iter().filter(|key| rig.uses(key) && !rig.is_set(key));
    silent.filter_map(|key| Some(format!("{}={}", key.path, rig.value(key.path)?))).collect()
}

/// The lines on what was searched and what was not.
fn head(task: &Task, rig: &Rig) -> Result<String> {
    let held = fixed::keys(task);
    let searched = match task.budget.generations {
        0 => Vec::new(),
        _ => Space::of(rig, task.goal.settled_mm, &held)?.keys(),
    };
    let is_other = |key: &&Key| {
        rig.uses(key) && [&searched, &held].iter().all(|all| !all.iter().any(|one| one == key.path))
    };
    let others = RESULT.into_iter().filter(is_other).map(|key| key.path.to_owned()).collect();
    let line = |(begin, keys): (&str, Vec<String>)| match keys.as_slice() {
        [] => format!("{begin}none\n"),
        keys => format!("{begin}{}\n", keys.join(", ")),
    };
    Ok(LINES.into_iter().zip([searched, held, others]).map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_tuned_again_has_one_head() {
        let text = format!(
            "{MARK}: met\n{}a, b\n{}none\n{}c\n# of mine\nname = \"x\"\n",
            LINES[0], LINES[1], LINES[2]
        );
        assert_eq!(without_head(&text), "# of mine\nname = \"x\"\n");
        assert_eq!(without_head("name = \"x\"\n"), "name = \"x\"\n");
    }
}
