//! The secret that a page shows with every request.

use std::fmt::{self, Write};

use anyhow::{Context, Result, bail};
use subtle::ConstantTimeEq;

/// Smallest and largest length of a token, bytes; the same as for a virtual rig.
const LENGTHS: std::ops::RangeInclusive<usize> = 16..=64;

/// The secret that page and server share.
#[derive(Clone)]
pub struct Token(String);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    /// A token of 128 random bits, as hexadecimal digits.
    ///
    /// # Errors
    /// When the system has no random numbers.
    pub fn draw() -> Result<Token> {
        let mut bits = [0; 16];
        getrandom::fill(&mut bits).context("the system gives no random numbers for the token")?;
        let mut text = String::new();
        bits.iter().try_for_each(|byte| write!(text, "{byte:02x}"))?;
        Ok(Token(text))
    }

    /// A token of the user's choice: 16 to 64 letters, digits, `-`, `.`, `_` or `~`, exactly as in an address.
    ///
    /// # Errors
    /// For any other text.
    pub fn new(text: &str) -> Result<Token> {
        let fits = |letter: char| letter.is_ascii_alphanumeric() || "-._~".contains(letter);
        if !LENGTHS.contains(&text.len()) || !text.chars().all(fits) {
            bail!(
                "PNEUDRIVE_TOKEN: the studio takes {} to {} letters, digits, -, ., _ or ~",
                LENGTHS.start(),
                LENGTHS.end()
            );
        }
        Ok(Token(text.to_owned()))
    }

    /// The token as in the address.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether a text is this token. The comparison takes the same time for all texts of its length.
    #[must_use]
    pub fn is(&self, text: &str) -> bool {
        self.0.as_bytes().ct_eq(text.as_bytes()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_tokens_differ_and_know_themselves() {
        let [one, other] = [Token::draw(), Token::draw()].map(|token| token.expect("random numbers"));
        assert_eq!(one.text().len(), 32);
        assert!(one.is(one.text()) && !one.is(other.text()) && !one.is(""));
    }

    #[test]
    fn a_chosen_token_is_long_enough_and_fits_an_address() {
        assert!(Token::new("correct-horse-battery").is_ok());
        for text in ["", "short", "with a space in it", "with#hash-and-more", &"x".repeat(65)] {
            assert!(Token::new(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_token_stays_out_of_the_log() {
        assert_eq!(format!("{:?}", Token::draw().expect("random numbers")), "Token(..)");
    }
}
