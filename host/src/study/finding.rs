//! What the model shows of a statement of the thesis, over a run and its neighbours.

use crate::range;

/// What the model shows of a statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// In figures of the runs.
    pub shows: String,
    /// Whether that is what the thesis says.
    pub verdict: Verdict,
}

/// Whether the model shows what the thesis says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It does.
    Agrees,
    /// It does not.
    Differs,
    /// What to compare with is not to be had, or the runs do not show it.
    Open,
    /// Runs of drives that differ by next to nothing do not all say the same.
    Depends,
}

impl Finding {
    pub(super) fn new(agrees: bool, shows: String) -> Finding {
        Finding { shows, verdict: if agrees { Verdict::Agrees } else { Verdict::Differs } }
    }

    /// The same where the runs may be too short to show it: `agrees` is None then.
    pub(super) fn decided(agrees: Option<bool>, shows: String) -> Finding {
        match agrees {
            Some(agrees) => Finding::new(agrees, shows),
            None => Finding { shows: shows + "; the runs do not decide it", verdict: Verdict::Open },
        }
    }

    /// What the runs of an ensemble show together, the nominal one first.
    pub(super) fn over(findings: &[Finding]) -> Finding {
        let nominal = &findings[0];
        let texts: Vec<&str> = findings.iter().map(|finding| finding.shows.as_str()).collect();
        let shows = in_ranges(&texts).unwrap_or_else(|| nominal.shows.clone());
        let count = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
        if count(nominal.verdict) == findings.len() {
            return Finding { shows, verdict: nominal.verdict };
        }
        let [agree, differ, open] = [Verdict::Agrees, Verdict::Differs, Verdict::Open].map(count);
        let shares = format!(
            "of {} runs that differ by next to nothing {agree} agree, {differ} differ and {open} do not decide it",
            findings.len()
        );
        Finding { shows: format!("{shows}; {shares}"), verdict: Verdict::Depends }
    }

    /// The thesis compares with a graph that the scan has lost.
    pub(super) fn open(shows: String) -> Finding {
        Finding { shows: shows + "; the graph to compare with is lost", verdict: Verdict::Open }
    }
}

impl Verdict {
    /// As it stands in the tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Differs => "differs",
            Verdict::Open => "open",
            Verdict::Depends => "depends",
        }
    }
}

/// The same sentence about several runs, with each figure as a range over them; None if the sentences are not the
/// same but for their figures.
fn in_ranges(texts: &[&str]) -> Option<String> {
    let pieces: Vec<Vec<&str>> = texts.iter().map(|text| pieces(text)).collect();
    let one = |place: usize| {
        let same: Vec<&str> = pieces.iter().map(|pieces| pieces[place]).collect();
        if same.iter().all(|piece| *piece == same[0]) {
            return Some(same[0].to_owned());
        }
        let values: Option<Vec<f64>> = same.iter().map(|piece| piece.parse().ok()).collect();
        let decimals = same[0].split_once('.').map_or(0, |(_, digits)| digits.len());
        Some(range::stated(&values?.into_iter().map(Some).collect::<Vec<_>>(), decimals))
    };
    let equally_long = pieces.iter().all(|other| other.len() == pieces[0].len());
    if equally_long { (0..pieces[0].len()).map(one).collect() } else { None }
}

/// A text cut into figures and what stands between them.
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
    use super::*;

    #[test]
    fn the_figures_of_a_sentence_become_ranges_over_the_runs() {
        let stated = in_ranges(&["it rises in 0.21 s, by -3.0 mm.", "it rises in 0.23 s, by -3.0 mm."]);
        assert_eq!(stated.as_deref(), Some("it rises in 0.21 (0.21 to 0.23) s, by -3.0 mm."));
        assert_eq!(in_ranges(&["it swings by 3 mm", "it comes to rest"]), None);
        assert_eq!(in_ranges(&["P1 - P2 is 7 kPa"; 3]).as_deref(), Some("P1 - P2 is 7 kPa"));
    }

    #[test]
    fn a_verdict_holds_if_it_is_that_of_every_run() {
        let finding = |agrees: bool, mm: f64| Finding::new(agrees, format!("it ends {mm:.1} mm off"));
        let all = Finding::over(&[finding(true, 1.0), finding(true, 2.0)]);
        assert_eq!(
            all,
            Finding { shows: "it ends 1.0 (1.0 to 2.0) mm off".into(), verdict: Verdict::Agrees }
        );
        let divided = Finding::over(&[finding(true, 1.0), finding(false, 1.0), finding(true, 1.0)]);
        assert_eq!(divided.verdict, Verdict::Depends);
        assert!(divided.shows.contains("of 3 runs that differ by next to nothing 2 agree, 1 differ"));
    }
}
