//! What is wrong with a file that is not TOML, and where.

use toml_edit::TomlError;

use crate::rig::Problem;

/// The line, and the key that is nearest above. A bracket that is not closed is found by the parser further down only, so
/// that is looked for first.
pub(super) fn problem(source: &str, text: &str, error: &TomlError) -> Problem {
    let end = error.span().map_or(text.len(), |span| span.start.min(text.len()));
    let here = line_at(text, end);
    let (line, message) = if error.message().contains("duplicate key") {
        (here, "it is given twice; put all of it in one place".to_owned())
    } else if let Some(line) = open_bracket(&text[..end]) {
        (line, "a bracket is opened here and not closed".to_owned())
    } else {
        let told = error.message().lines().collect::<Vec<_>>().join("; ");
        (here, format!("this is not TOML: {told}"))
    };
    Problem { source: source.to_owned(), line: Some(line), key: nearest_key(text, line), message }
}

/// The line, counted from 1, of a place in a text, bytes.
fn line_at(text: &str, place: usize) -> usize {
    1 + text[..place.min(text.len())].matches('\n').count()
}

/// The line at which the outermost bracket that is still open at the end of `text` was opened.
fn open_bracket(text: &str) -> Option<usize> {
    let mut open = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut in_string = false;
        for character in line.chars() {
            match character {
                '"' => in_string = !in_string,
                '#' if !in_string => break,
                '[' | '{' if !in_string => open.push(number + 1),
                ']' | '}' if !in_string => drop(open.pop()),
                _ => {}
            }
        }
    }
    open.first().copied()
}

/// The last key at or above a line, with its table.
fn nearest_key(text: &str, line: usize) -> String {
    let (mut table, mut key) = ("", "");
    for text in text.lines().take(line).map(str::trim) {
        if let Some(header) = text.strip_prefix('[').filter(|_| !text.contains('=')) {
            (table, key) = (header.trim_matches(['[', ']', ' ']), "");
        } else if let Some((name, _)) = text.split_once('=').filter(|_| !text.starts_with('#')) {
            key = name.trim();
        }
    }
    match (table, key) {
        ("", key) => key.to_owned(),
        (table, "") => format!("[{table}]"),
        (table, key) => format!("{table}.{key}"),
    }
}
