//! The model's answer to a statement of the thesis, at one start and over all of them.
//!
//! A start agrees, differs, or does not decide it. Of n starts the share that agrees is known within its 95 % interval
//! (Wilson), and so is the share that differs:
//!
//! ```text
//! agrees              the share that agrees is above two thirds, at the lower end of its interval
//! differs             the same of the share that differs
//! cannot be decided   one of these would hold if the undecided starts said the same
//! depends             none of them: it holds in some starts and not in others
//! ```
//!
//! Of 16 starts 15 must say the same, of 64 starts 51.

use pneudrive_evaluate::range;
use pneudrive_optimise::tuning::Proportion;

/// The model's answer to a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The answer, in figures of the runs.
    pub shows: String,
    /// Whether it agrees with the thesis.
    pub verdict: Verdict,
}

/// Whether the model agrees with the thesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It agrees.
    Agrees,
    /// It does not agree.
    Differs,
    /// There is nothing to compare with, or the runs do not show it.
    Open,
    /// It agrees from some starts and not from others.
    Depends,
}

/// A verdict needs more than this part of all starts.
const MAJORITY: f64 = 2.0 / 3.0;

impl Finding {
    pub(super) fn new(agrees: bool, shows: String) -> Finding {
        Finding { shows, verdict: if agrees { Verdict::Agrees } else { Verdict::Differs } }
    }

    /// The same where the runs may not show it: `agrees` is None then.
    pub(super) fn decided(agrees: Option<bool>, shows: String) -> Finding {
        match agrees {
            Some(agrees) => Finding::new(agrees, shows),
            None => Finding { shows, verdict: Verdict::Open },
        }
    }

    /// The thesis compares with its rig, or with a graph that the scan has lost.
    pub(super) fn open(shows: String) -> Finding {
        Finding { shows: format!("{shows}; {NO_REFERENCE}"), verdict: Verdict::Open }
    }

    /// The combined result of all starts, the unchanged rig first.
    pub(super) fn over(starts: &[Finding]) -> Finding {
        let texts: Vec<&str> = starts.iter().map(|finding| finding.shows.as_str()).collect();
        let shows = in_ranges(&texts).unwrap_or_else(|| format!("as the rig is: {}", texts[0]));
        if starts.iter().all(|finding| finding.shows.ends_with(NO_REFERENCE)) {
            return Finding { shows, verdict: Verdict::Open };
        }
        let count = |verdict| starts.iter().filter(|finding| finding.verdict == verdict).count();
        let [agree, differ, open] = [Verdict::Agrees, Verdict::Differs, Verdict::Open].map(count);
        let agreeing = Proportion { met: agree, of: starts.len() };
        let shares = format!("Starts that agree: {agreeing}; that differ: {differ}; undecided: {open}");
        Finding {
            shows: format!("{shows}. {shares}"),
            verdict: Verdict::of_shares(agree, differ, starts.len()),
        }
    }
}

/// The remark on statements that cannot be compared.
const NO_REFERENCE: &str = "what to compare with is lost";

impl Verdict {
    /// The verdict from the number of starts that agree and that differ; the others are undecided.
    fn of_shares(agree: usize, differ: usize, of: usize) -> Verdict {
        let open = of - agree - differ;
        let surely = |met: usize| Proportion { met, of }.interval()[0] > MAJORITY;
        match () {
            () if surely(agree) => Verdict::Agrees,
            () if surely(differ) => Verdict::Differs,
            () if surely(agree + open) || surely(differ + open) => Verdict::Open,
            () => Verdict::Depends,
        }
    }

    /// Its text in the tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Open => "cannot be decided",
            Verdict::Depends => "depends on the start",
        }
    }
}

/// The same sentence about several runs, with each figure as a range over them; None if the sentences differ in more
/// than their figures.
fn in_ranges(texts: &[&str]) -> Option<String> {
    let pieces: Vec<Vec<&str>> = texts.iter().map(|text| pieces(text)).collect();
    let one = |place: usize| {
        let same: Vec<&str> = pieces.iter().map(|pieces| pieces[place]).collect();
        if same.iter().all(|piece| *piece == same[0]) {
            return Some(same[0].to_owned());
        }
        let values: Option<Vec<f64>> = same.iter().map(|piece| piece.parse().ok()).collect();
        let decimals = same[0].split_once('.').map_or(0, |(_, digits)| digits.len());
        Some(range::with_range(&values?.into_iter().map(Some).collect::<Vec<_>>(), decimals))
    };
    let equally_long = pieces.iter().all(|other| other.len() == pieces[0].len());
    if equally_long { (0..pieces[0].len()).map(one).collect() } else { None }
}

/// A text cut into figures and the parts between them.
fn pieces(text: &str) -> Vec<&str> {
    let of_figure = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| of_figure(c) != of_figure(first)).unwrap_or(rest.len());
        let (piece, behind) = rest.split_at(end);
        // A full stop ends a sentence, not a figure.
        let figure = piece.trim_end_matches('.');
        if figure.is_empty() {
            pieces.push(piece);
        } else {
            pieces.extend([figure, &piece[figure.len()..]].into_iter().filter(|part| !part.is_empty()));
        }
        rest = behind;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;

    #[test]
    fn the_figures_of_a_sentence_become_ranges_over_the_runs() {
        let with_range = in_ranges(&["it rises in 0.21 s, by -3.0 mm.", "it rises in 0.23 s, by -3.0 mm."]);
        assert_eq!(with_range.as_deref(), Some("it rises in 0.21 (0.21 to 0.23) s, by -3.0 mm."));
        assert_eq!(in_ranges(&["it swings by 3 mm", "it comes to rest"]), None);
        assert_eq!(in_ranges(&["P1 - P2 is 7 kPa"; 3]).as_deref(), Some("P1 - P2 is 7 kPa"));
    }

    #[test]
    fn a_verdict_holds_if_all_but_one_of_sixteen_starts_say_it() {
        for (agree, differ, verdict) in [
            (16, 0, Verdict::Agrees),
            (15, 1, Verdict::Agrees),
            (14, 2, Verdict::Depends),
            (8, 8, Verdict::Depends),
            (1, 15, Verdict::Differs),
            (15, 0, Verdict::Agrees),
            (14, 1, Verdict::Open),
            (0, 0, Verdict::Open),
            (2, 2, Verdict::Depends),
            (1, 1, Verdict::Open),
        ] {
            assert_eq!(Verdict::of_shares(agree, differ, 16), verdict, "{agree} agree, {differ} differ");
        }
    }

    /// Drawn starts of drives whose true share is known: the statement about most starts is rarely wrong.
    #[test]
    fn a_statement_that_holds_from_two_thirds_of_drawn_starts_is_said_to_agree_once_in_forty_at_most() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut verdicts = |share: f64, starts: usize| -> Vec<Verdict> {
            let mut agrees = || f64::from(random.next_u32()) / 2f64.powi(32) < share;
            let mut one = || (0..starts).filter(|_| agrees()).count();
            (0..4000).map(|_| one()).map(|agree| Verdict::of_shares(agree, starts - agree, starts)).collect()
        };
        let part = |verdicts: &[Verdict], wanted| {
            verdicts.iter().filter(|verdict| **verdict == wanted).count() as f64 / verdicts.len() as f64
        };
        for starts in [16, 32, 64] {
            let edge = verdicts(MAJORITY, starts);
            assert!(part(&edge, Verdict::Agrees) < 0.025 && part(&edge, Verdict::Differs) == 0.0, "{starts}");
            let even = verdicts(0.5, starts);
            assert!(part(&even, Verdict::Depends) > 0.99, "{starts}");
            assert!(part(&verdicts(0.98, starts), Verdict::Agrees) > 0.9, "{starts}");
            assert!(part(&verdicts(0.02, starts), Verdict::Differs) > 0.9, "{starts}");
        }
    }

    #[test]
    fn shares_are_told_with_their_interval() {
        let finding =
            |agrees: Option<bool>, mm: f64| Finding::decided(agrees, format!("it ends {mm:.1} mm off"));
        let starts = [finding(Some(true), 1.0), finding(Some(false), 2.0), finding(None, 1.5)];
        let found = Finding::over(&starts);
        assert_eq!(found.verdict, Verdict::Depends);
        let expected = "it ends 1.0 (1.0 to 2.0) mm off. Starts that agree: 1 of 3, 33 % (6 to 79 %); that differ: 1; undecided: 1";
        assert_eq!(found.shows, expected);
    }

    #[test]
    fn what_has_nothing_to_be_held_against_stays_open_and_has_no_shares() {
        let found = Finding::over(&vec![Finding::open("it goes at 3 mm/s".to_owned()); 16]);
        assert_eq!(found.verdict, Verdict::Open);
        assert_eq!(found.shows, format!("it goes at 3 mm/s; {NO_REFERENCE}"));
    }
}
