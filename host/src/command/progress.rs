//! Progress of long work.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::output::takes_escapes;

/// A bar on a terminal; elsewhere a line at each quarter.
pub(super) struct Progress {
    bar: ProgressBar,
    what: String,
    /// The counted things.
    of: &'static str,
    printed: u64,
}

impl Progress {
    pub fn new(what: &str) -> Progress {
        Progress::of(what, "samples")
    }

    /// Counts something other than samples.
    pub fn of(what: &str, of: &'static str) -> Progress {
        let target = if takes_escapes() {
            ProgressDrawTarget::stderr_with_hz(10)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let style = ProgressStyle::with_template("{msg:<12} [{bar:40}] {pos}/{len} ({per_sec}, {eta} left)");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress { bar, what: what.to_owned(), of, printed: 0 }
    }

    /// Counts samples whose total is not known.
    pub fn endless(what: &str, advice: &str) -> Progress {
        let progress = Progress::new(what);
        let style = ProgressStyle::with_template(&format!(
            "{{msg:<12}} {{spinner}} {{human_pos}} samples in {{elapsed}} ({advice})"
        ));
        progress.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        if progress.bar.is_hidden() {
            tell!("{what}: {advice}");
        }
        Progress { printed: u64::MAX, ..progress }
    }

    /// Starts from earlier work, which does not count for the rate.
    pub fn begin_at(&mut self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
        self.bar.reset_eta();
        self.printed = (4 * done).checked_div(all).unwrap_or(0);
    }

    pub fn at(&mut self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done.min(all));
        let quarter = (4 * done.min(all)).checked_div(all).unwrap_or(0);
        if self.bar.is_hidden() && quarter > self.printed {
            self.printed = quarter;
            tell!("{}: {done} of {all} {}", self.what, self.of);
        }
    }

    /// Does something that may also write to the terminal.
    pub fn aside<T>(&self, act: impl FnOnce() -> T) -> T {
        self.bar.suspend(act)
    }

    pub fn done(self) {
        self.bar.finish_and_clear();
    }
}
