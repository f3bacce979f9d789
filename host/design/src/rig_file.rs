//! A rig file that says of each value where it comes from.

use std::collections::BTreeMap;

use pneudrive_sim::key::{Choice, Typed};
use pneudrive_sim::rig::{Key, Source, all_keys};

/// A rig file on its way: a line for each key.
#[derive(Clone, Debug, Default)]
pub struct RigFile {
    /// The head above all tables: comments, and the name.
    head: String,
    /// The value in TOML, and a comment after it.
    lines: BTreeMap<&'static str, (String, String)>,
}

/// A number, and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The value, in the unit of its key.
    pub value: f64,
    /// Its origin.
    pub source: Source,
    /// The ends between which it lies, if they are known.
    pub range: Option<[f64; 2]>,
    /// The data sheet, the formula or the test that finds it.
    pub from: String,
}

impl Number {
    /// From a data sheet or a user.
    #[must_use]
    pub fn given(value: f64, from: impl Into<String>) -> Number {
        Number { value, source: Source::Given, range: None, from: from.into() }
    }

    /// By a formula.
    #[must_use]
    pub fn computed(value: f64, from: impl Into<String>) -> Number {
        Number { value, source: Source::Computed, range: None, from: from.into() }
    }

    /// A usual value.
    #[must_use]
    pub fn typical(value: f64, range: [f64; 2], from: impl Into<String>) -> Number {
        Number { value, source: Source::Typical, range: Some(range), from: from.into() }
    }

    /// Somewhere in a range; `from` names the test that finds it.
    #[must_use]
    pub fn unknown(value: f64, range: [f64; 2], from: impl Into<String>) -> Number {
        Number { value, source: Source::Unknown, range: Some(range), from: from.into() }
    }

    /// The upper end of its range, or its value.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.range.map_or(self.value, |[_, high]| high)
    }

    /// The same with the ends between which it lies.
    #[must_use]
    pub fn within(self, range: Option<[f64; 2]>) -> Number {
        Number { range, ..self }
    }

    /// The result of `make` for this number and for its ends; its origin is the same or `computed`.
    #[must_use]
    pub fn map(&self, make: impl Fn(f64) -> f64, from: impl Into<String>) -> Number {
        let range = self.range.map(|ends| {
            let ends = ends.map(&make);
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        });
        let source = if self.source == Source::Given { Source::Computed } else { self.source };
        Number { value: make(self.value), source, range, from: from.into() }
    }
}

impl RigFile {
    /// A file with a few lines of comment at its top, and the name of its rig.
    #[must_use]
    pub fn new(about: &[String], name: &str) -> RigFile {
        let comments: String = about.iter().map(|line| format!("# {line}\n")).collect();
        RigFile { head: format!("{comments}name = {name:?}\n"), ..RigFile::default() }
    }

    /// Gives a key a number.
    pub fn number(&mut self, key: &'static Typed<f64>, number: &Number) {
        self.real(key, number);
    }

    /// The same for a key that may be absent.
    pub fn optional(&mut self, key: &'static Typed<Option<f64>>, number: &Number) {
        self.real(key, number);
    }

    fn real(&mut self, key: &'static Key, number: &Number) {
        let value = format!("{:?}", rounded(number.value));
        let line = match (number.source, number.range) {
            (Source::Given, None) => (value, comment("given", &number.from)),
            (source, range) => {
                let range = range.map_or(String::new(), |[low, high]| {
                    format!(", low = {:?}, high = {:?}", rounded(low), rounded(high))
                });
                (format!("{{ {} = {value}{range}, from = {:?} }}", source.word(), number.from), String::new())
            }
        };
        self.lines.insert(key.path, line);
    }

    /// Gives a key a whole number.
    pub fn integer(&mut self, key: &'static Typed<i64>, value: i64, why: &str) {
        self.lines.insert(key.path, (value.to_string(), why.to_owned()));
    }

    /// Chooses a model.
    pub fn word<C: Choice>(&mut self, key: &'static Typed<C>, choice: C, why: &str) {
        self.lines.insert(key.path, (format!("{:?}", choice.word()), why.to_owned()));
    }

    /// Gives a key a value without a single TOML type.
    pub fn text(&mut self, path: &'static Key, value: String, why: &str) {
        self.lines.insert(path.path, (value, why.to_owned()));
    }

    /// The file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = self.head.clone();
        let mut table = "";
        for key in all_keys() {
            let Some((value, comment)) = self.lines.get(key.path) else { continue };
            if key.table() != table {
                table = key.table();
                text.push_str(&format!("\n[{table}]\n"));
            }
            let line = format!("{} = {value}", key.name());
            text.push_str(&if comment.is_empty() { line } else { format!("{line:<44} # {comment}") });
            text.push('\n');
        }
        text
    }
}

fn comment(source: &str, from: &str) -> String {
    if from.is_empty() { source.to_owned() } else { format!("{source}: {from}") }
}

/// Six digits: no figure of a data sheet has more.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::{Rig, keys};

    #[test]
    fn a_file_is_read_back_with_its_origins() {
        let mut file = RigFile::new(&["A drive.".to_owned()], "own");
        file.number(&keys::load::MASS_KG, &Number::given(8.0, "8 kg"));
        file.number(
            &keys::friction::STATIC_EXTEND_N,
            &Number::unknown(50.0, [20.0, 100.0], "identify --plan"),
        );
        file.number(&keys::actuator::STROKE_M, &Number::computed(0.25, "as ordered"));
        let text = file.to_toml();
        let rig = Rig::read("own.toml", &text).unwrap_or_else(|problems| panic!("{problems}\n{text}"));
        assert!(text.starts_with("# A drive.\nname = \"own\"\n\n[actuator]\n"), "{text}");
        assert_eq!(rig.get(&keys::load::MASS_KG), 8.0);
        assert_eq!(rig.origin(&keys::load::MASS_KG).source, Source::Given);
        let friction = rig.origin(&keys::friction::STATIC_EXTEND_N);
        assert_eq!((friction.source, friction.range), (Source::Unknown, Some([20.0, 100.0])));
        assert_eq!(rig.origin(&keys::actuator::STROKE_M).from, "as ordered");
    }

    #[test]
    fn what_is_made_of_a_number_has_the_ends_of_its_range() {
        let made = Number::unknown(2.0, [1.0, 4.0], "a test").map(|x| 1.0 / x, "its inverse");
        assert_eq!(made.range, Some([0.25, 1.0]));
        assert_eq!(made.source, Source::Unknown);
        assert_eq!(Number::given(2.0, "").map(|x| x * x, "squared").source, Source::Computed);
    }
}
