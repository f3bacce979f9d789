//! Texts from a device, made safe for a terminal, a message and a line of a file.

use pneudrive_protocol::MAX_TEXT;

/// Longest name, bytes: it always fits its message.
pub const NAME: usize = MAX_TEXT;

/// Longest sentence, bytes.
pub const SENTENCE: usize = 256;

/// The end of a text that was cut.
const CUT: &str = "...";

/// A text of a device with control and formatting characters escaped (`\n`, `\u{1b}`), cut to `longest` bytes. A clean
/// text is not changed, so the function is idempotent.
pub fn sanitised(text: &str, longest: usize) -> String {
    let mut clean = String::new();
    for character in text.chars() {
        if is_plain(character) {
            clean.push(character);
        } else {
            clean.extend(character.escape_debug());
        }
        if clean.len() > longest {
            let end = clean.floor_char_boundary(longest.saturating_sub(CUT.len()));
            return clean[..end].to_owned() + CUT;
        }
    }
    clean
}

/// Whether a character needs no escape. Quotes and backslashes need none, though Rust would escape them.
fn is_plain(character: char) -> bool {
    matches!(character, '"' | '\'' | '\\') || character.escape_debug().len() == 1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn an_ordinary_name_stays_as_it_is() {
        for name in ["pneudrive 0.1.0", "0.1.0+a1b2c3-dirty", "Prüfstand \"Süd\" C:\\x", ""] {
            assert_eq!(sanitised(name, NAME), name);
        }
    }

    #[test]
    fn what_moves_a_cursor_or_ends_a_line_is_escaped() {
        assert_eq!(sanitised("a\x1b[2J\n# b = c\r", NAME), r"a\u{1b}[2J\n# b = c\r");
        assert_eq!(sanitised("\u{9b}31m\u{202e}\u{2028}\0", NAME), r"\u{9b}31m\u{202e}\u{2028}\0");
    }

    #[test]
    fn a_long_text_is_cut_between_two_characters() {
        assert_eq!(sanitised(&"n".repeat(65), NAME), "n".repeat(61) + "...");
        assert_eq!(sanitised(&"ü".repeat(40), NAME), "ü".repeat(30) + "...");
    }

    proptest! {
        #[test]
        fn whatever_comes_is_short_and_plain_and_cleaning_it_again_changes_nothing(text in any::<String>()) {
            let clean = sanitised(&text, NAME);
            prop_assert!(clean.len() <= NAME && clean.chars().all(is_plain), "{clean:?}");
            prop_assert_eq!(sanitised(&clean, NAME), clean);
        }
    }
}
