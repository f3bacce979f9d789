//! A name of limited length.

use heapless::String;

/// The text in at most `N` bytes; a longer one is cut at a character.
#[must_use]
pub fn cut<const N: usize>(text: &str) -> String<N> {
    let within = text.get(..text.floor_char_boundary(N)).unwrap_or_default();
    String::try_from(within).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::cut;

    #[test]
    fn a_name_that_is_too_long_is_cut_and_never_within_a_character() {
        assert_eq!(cut::<4>("abcd"), "abcd");
        assert_eq!(cut::<4>("abcdefgh"), "abcd");
        assert_eq!(cut::<4>("abc\u{e4}"), "abc", "the last character has two bytes");
        assert_eq!(cut::<0>("a"), "");
    }
}
