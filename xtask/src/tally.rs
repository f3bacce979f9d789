//! Passed and failed checks. A failure does not end the work: all of them are reported at the end.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::Result;

/// Counts of tests and of other checks.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    passed: u32,
    failed: u32,
    failures: Vec<String>,
    /// The steps with their times, in order.
    took: Vec<(String, Duration)>,
    /// The omitted checks, and their requirements.
    left_out: Vec<String>,
}

/// The result line of one test program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Tests that passed.
    pub passed: u32,
    /// Tests that failed.
    pub failed: u32,
}

impl Counts {
    /// The counts in a line `test result: ok. A passed; B failed; C ignored; ...`.
    #[must_use]
    pub fn in_line(line: &str) -> Option<Counts> {
        let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
        let count = |what: &str| {
            let part = counts.split(';').find_map(|part| part.trim().strip_suffix(what));
            part?.trim().parse().ok()
        };
        Some(Counts { passed: count(" passed")?, failed: count(" failed")? })
    }
}

/// The test that a line of a test program tells of as failed.
#[must_use]
pub fn failed_test(line: &str) -> Option<&str> {
    line.strip_prefix("test ")?.strip_suffix(" ... FAILED")
}

impl Tally {
    /// Does a check that counts as one.
    pub fn check(&mut self, name: &str, check: impl FnOnce() -> Result<()>) {
        match self.timed(name, |_| check()) {
            Ok(()) => self.passed += 1,
            Err(error) => self.fail(1, format!("{name}: {error:#}")),
        }
    }

    /// Does something under a heading, and notes how long it took.
    pub fn timed<T>(&mut self, name: &str, work: impl FnOnce(&mut Tally) -> T) -> T {
        println!("== {name}");
        let begin = Instant::now();
        let done = work(self);
        self.took.push((name.to_owned(), begin.elapsed()));
        done
    }

    /// Notes an omitted check, to be reported at the end: it is not a failure.
    pub fn leave_out(&mut self, what: String) {
        println!("NOT CHECKED: {what}");
        self.left_out.push(what);
    }

    /// Adds the counts of a test program.
    pub fn add(&mut self, counts: Counts) {
        self.passed += counts.passed;
        self.failed += counts.failed;
    }

    /// Notes a failure to be reported at the end, and counts it `count` times (0: it is counted already).
    pub fn fail(&mut self, count: u32, what: String) {
        self.failed += count;
        self.failures.push(what);
    }

    /// Adds the results of other work.
    pub fn absorb(&mut self, beside: Tally) {
        self.passed += beside.passed;
        self.failed += beside.failed;
        self.failures.extend(beside.failures);
        self.took.extend(beside.took);
        self.left_out.extend(beside.left_out);
    }

    /// The number of failures so far.
    #[must_use]
    pub fn failed(&self) -> u32 {
        self.failed
    }

    /// The last line.
    #[must_use]
    pub fn summary(&self) -> String {
        format!("{} passed, {} failed", self.passed, self.failed)
    }

    /// Reports the times, the omitted checks, the failures, then the last line.
    #[must_use]
    pub fn report(&self) -> ExitCode {
        println!();
        for (name, took) in &self.took {
            println!("{:>6.0} s  {name}", took.as_secs_f64());
        }
        for what in &self.left_out {
            println!("NOT CHECKED: {what}");
        }
        for failure in &self.failures {
            println!("failed: {failure}");
        }
        println!("{}", self.summary());
        if self.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn counts_are_read_from_the_result_line_only() {
        let ok =
            "test result: ok. 12 passed; 0 failed; 3 ignored; 0 measured; 7 filtered out; finished in 0.01s";
        assert_eq!(Counts::in_line(ok), Some(Counts { passed: 12, failed: 0 }));
        let bad = "test result: FAILED. 1 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out";
        assert_eq!(Counts::in_line(bad), Some(Counts { passed: 1, failed: 2 }));
        for other in ["running 3 tests", "test result: unknown", "12 passed; 0 failed", ""] {
            assert_eq!(Counts::in_line(other), None, "{other}");
        }
    }

    #[test]
    fn a_failure_is_counted_and_the_work_goes_on() {
        let mut tally = Tally::default();
        tally.check("first", || bail!("no"));
        tally.check("second", || Ok(()));
        tally.add(Counts { passed: 5, failed: 2 });
        assert_eq!(tally.summary(), "6 passed, 3 failed");
        assert_eq!(tally.failures, ["first: no"]);
        let timed: Vec<&str> = tally.took.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(timed, ["first", "second"]);
    }
}
