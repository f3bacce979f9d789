//! A TOML file that is being read: the position of each key, and the errors in the file.

use std::ops::Range;

use toml_edit::Document;

use super::syntax;
use crate::rig::{Problem, Problems};

/// A TOML file that is being read, and the problems found so far.
#[derive(Clone, Debug)]
pub struct TomlFile<'a> {
    /// Its name for messages, or the part of the command line.
    pub source: &'a str,
    text: &'a str,
    /// Where each of its lines ends, bytes.
    line_ends: Vec<usize>,
    /// The problems.
    pub problems: Vec<Problem>,
}

impl<'a> TomlFile<'a> {
    /// Nothing of it has been read.
    #[must_use]
    pub fn new(source: &'a str, text: &'a str) -> TomlFile<'a> {
        let line_ends = text.match_indices('\n').map(|(place, _)| place);
        TomlFile { source, text, line_ends: line_ends.collect(), problems: Vec::new() }
    }

    /// Its tables and keys; None if it is not TOML, which is noted.
    pub fn document(&mut self) -> Option<Document<&'a str>> {
        let noted = |error| self.problems.push(syntax::problem(self.source, self.text, &error));
        Document::parse(self.text).map_err(noted).ok()
    }

    /// Notes an error in a key.
    pub fn problem(&mut self, line: Option<usize>, key: &str, message: String) {
        self.problems.push(Problem { source: self.source.to_owned(), line, key: key.to_owned(), message });
    }

    /// The line, counted from 1, of something in the file.
    #[must_use]
    pub fn line_of(&self, span: Option<Range<usize>>) -> Option<usize> {
        span.map(|span| 1 + self.line_ends.partition_point(|end| *end < span.start))
    }

    /// The values, if there is no problem.
    ///
    /// # Errors
    /// Everything that was found wrong.
    pub fn end<T>(self, read: T) -> Result<T, Problems> {
        if self.problems.is_empty() { Ok(read) } else { Err(Problems(self.problems)) }
    }
}
