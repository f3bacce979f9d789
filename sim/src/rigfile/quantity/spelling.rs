//! Numbers and units as people write them.

use std::fmt::Write;

/// The number at the front of a text, and the rest.
///
/// # Errors
/// When there is none, or its comma may separate thousands.
pub fn number_and_unit(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    let is_number = |letter: char| letter.is_ascii_digit() || "+-\u{2212}.,eE".contains(letter);
    let most = text.find(|letter| !is_number(letter)).unwrap_or(text.len());
    let ends = (1..=most).rev().filter(|&end| text.is_char_boundary(end));
    for (number, unit) in ends.map(|end| text.split_at(end)) {
        let is_within = unit.starts_with(|next: char| next.is_ascii_digit() || ".,".contains(next));
        if let Some(number) = number_of(number)?.filter(|_| !is_within) {
            return Ok((number, unit.trim()));
        }
    }
    Err(format!("must be a number with a unit, such as \"6 bar(g)\", is \"{text}\""))
}

/// A number with a dot or a comma as the decimal sign; None of none.
fn number_of(text: &str) -> Result<Option<f64>, String> {
    let plain = text.replace('\u{2212}', "-");
    let read = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
    let Some((whole, part)) = plain.split_once(',') else { return Ok(read(&plain)) };
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let digits = whole.trim_start_matches(['-', '+']);
    if !is_digits(digits) || !is_digits(part) {
        return Ok(None);
    }
    if part.len() == 3 && digits.len() <= 3 && !digits.starts_with('0') {
        return Err(format!("\"{text}\" may be {whole}{part} or {whole}.{part}: write one of these"));
    }
    Ok(read(&format!("{whole}.{part}")))
}

/// A unit in plain letters: one sign for each group of signs that look alike, and symbols for words.
pub fn plain(unit: &str) -> String {
    let mut plain = String::new();
    for letter in unit.chars() {
        match letter {
            '\u{3bc}' => plain.push('\u{b5}'),
            '\u{b0}' | '\u{ba}' | '\u{2da}' => plain.push_str("deg"),
            '\u{2103}' => plain.push_str("degC"),
            '\u{2109}' => plain.push_str("degF"),
            '\u{b7}' | '\u{22c5}' | '\u{2219}' | '\u{2022}' | '\u{d7}' | '.' | '*' => plain.push(' '),
            '\u{2215}' | '\u{2044}' => plain.push('/'),
            '\u{b9}' => plain.push('1'),
            '\u{b2}' => plain.push('2'),
            '\u{b3}' => plain.push('3'),
            '\u{2212}' | '\u{207b}' => plain.push('-'),
            white if white.is_whitespace() => plain.push(' '),
            // A string takes every letter.
            other => drop(plain.write_char(other)),
        }
    }
    let one_space = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    match one_space.as_str() {
        "deg C" | "Celsius" => "degC".to_owned(),
        "deg F" | "Fahrenheit" => "degF".to_owned(),
        _ => one_space,
    }
}
