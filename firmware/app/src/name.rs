//! A name of limited length, kept without allocation.

/// A text of at most `N` bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Default for Name<N> {
    fn default() -> Self {
        Name { bytes: [0; N], len: 0 }
    }
}

impl<const N: usize> Name<N> {
    /// The text; a longer one is cut at a character.
    #[must_use]
    pub fn new(text: &str) -> Name<N> {
        let mut name = Name::default();
        let cut = (0..=text.len().min(N)).rev().find(|&end| text.is_char_boundary(end));
        let bytes = text.as_bytes().get(..cut.unwrap_or(0)).unwrap_or(&[]);
        for (to, from) in name.bytes.iter_mut().zip(bytes) {
            *to = *from;
        }
        name.len = bytes.len();
        name
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes.get(..self.len).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }
}
