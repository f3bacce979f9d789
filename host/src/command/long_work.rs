//! Long work: its expected duration is shown, and more than an hour needs confirmation.

use std::io::{IsTerminal, stderr, stdin};
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

use crate::exit::Exit;
use crate::output::Stream;

/// Longer work needs confirmation.
const LONG: Duration = Duration::from_secs(3600);

/// Whether work of this duration may begin: `--yes` or an answer at the terminal confirms it.
///
/// # Errors
/// When it is not confirmed.
pub(super) fn allow(what: &str, lasts: Duration, yes: bool) -> Result<()> {
    let somebody = stdin().is_terminal() && stderr().is_terminal();
    answered(
        what,
        lasts,
        yes,
        somebody.then_some(|| {
            let mut answer = String::new();
            stdin().read_line(&mut answer).map(|_| answer).unwrap_or_default()
        }),
    )
}

/// The same; `ask` is None where nobody can answer.
fn answered(what: &str, lasts: Duration, yes: bool, ask: Option<impl FnOnce() -> String>) -> Result<()> {
    if yes || lasts <= LONG {
        return Ok(());
    }
    let Some(ask) = ask else {
        return Err(Exit::Usage.error(format!("{what} would take {}; add --yes to run it", about(lasts))));
    };
    let question = format!("{what} will take {}. Continue? [y/N] ", about(lasts));
    Stream::Errors.note(Stream::Errors.write(question.as_bytes()));
    match ask().trim().to_lowercase().as_str() {
        "y" | "yes" => Ok(()),
        _ => bail!("{what} was cancelled"),
    }
}

/// A time as an estimate in words.
pub(super) fn about(time: Duration) -> String {
    match time.as_secs_f64() {
        seconds if seconds < 1.0 => "less than a second".to_owned(),
        seconds if seconds < 99.5 => format!("about {seconds:.0} s"),
        seconds if seconds < 5970.0 => format!("about {:.0} min", seconds / 60.0),
        seconds if seconds < 48.0 * 3600.0 => format!("about {:.1} h", seconds / 3600.0),
        seconds => format!("about {:.0} days", seconds / 86_400.0),
    }
}

/// Work in equal parts, whose first part gives the estimate for the rest.
pub(super) struct Pace {
    what: &'static str,
    yes: bool,
    begun: Instant,
    estimated: bool,
}

impl Pace {
    /// Work begins now.
    pub fn begin(what: &'static str, yes: bool) -> Pace {
        Pace { what, yes, begun: Instant::now(), estimated: false }
    }

    /// Reports the number of finished parts; after the first one, the time for the rest is estimated.
    ///
    /// # Errors
    /// When that is long and not confirmed.
    pub fn at(&mut self, done: usize, all: usize) -> Result<()> {
        if self.estimated || done == 0 {
            return Ok(());
        }
        self.estimated = true;
        let left = all.saturating_sub(done) as u32;
        allow(self.what, self.begun.elapsed() / done as u32 * left, self.yes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOBODY: Option<fn() -> String> = None;

    #[test]
    fn an_hour_is_not_asked_for_and_more_is() {
        let hours = |hours: u64| Duration::from_secs(3600 * hours);
        assert!(answered("the sweep", hours(1), false, NOBODY).is_ok());
        assert!(answered("the sweep", hours(9), true, NOBODY).is_ok());
        let refused = answered("the sweep", hours(9), false, NOBODY).expect_err("nobody says yes");
        assert_eq!(refused.to_string(), "the sweep would take about 9.0 h; add --yes to run it");
        assert_eq!(Exit::after(&refused), Exit::Usage);
        for (answer, goes_on) in [("y\n", true), ("Yes\n", true), ("\n", false), ("", false), ("no\n", false)]
        {
            let answered = answered("the sweep", hours(9), false, Some(|| answer.to_owned()));
            assert_eq!(answered.is_ok(), goes_on, "{answer:?}");
        }
    }

    #[test]
    fn a_time_is_said_in_the_unit_that_suits_it() {
        for (seconds, said) in [
            (0.2, "less than a second"),
            (41.2, "about 41 s"),
            (170.0, "about 3 min"),
            (5969.0, "about 99 min"),
            (9000.0, "about 2.5 h"),
            (260_000.0, "about 3 days"),
        ] {
            assert_eq!(about(Duration::from_secs_f64(seconds)), said);
        }
    }
}
