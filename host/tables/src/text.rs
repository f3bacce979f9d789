//! Bytes as text.

use crate::Problem;

const UTF_8_MARK: &[u8] = &[0xef, 0xbb, 0xbf];

/// An encoding that is not UTF-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wide {
    LittleEndian,
    BigEndian,
}

/// The text of a file that is written by hand or by this program: UTF-8, with or without a byte order mark.
///
/// # Errors
/// When it has another encoding: with its name, and what to do.
pub fn utf8(bytes: &[u8]) -> Result<String, Problem> {
    match wide(bytes) {
        Some(_) => Err(Problem::new("it is UTF-16: save it as UTF-8")),
        None => narrow(bytes),
    }
}

/// The same of a text that came as UTF-8: without its byte order mark.
#[must_use]
fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The text of another program's file: UTF-8 or UTF-16.
///
/// # Errors
/// When it has another encoding: with its name, and what to do.
pub fn decoded(bytes: &[u8]) -> Result<String, Problem> {
    let Some(order) = wide(bytes) else { return narrow(bytes) };
    let (pairs, rest) = bytes.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(Problem::new("it is UTF-16 and ends within a character: it is cut; export it again"));
    }
    let units = pairs.iter().map(|&pair| match order {
        Wide::LittleEndian => u16::from_le_bytes(pair),
        Wide::BigEndian => u16::from_be_bytes(pair),
    });
    let text: Result<String, _> = char::decode_utf16(units).collect();
    let text = text.map_err(|_| Problem::new("it begins as UTF-16, and is damaged: save it as UTF-8"))?;
    Ok(without_mark(&text).to_owned())
}

/// UTF-16 by its mark or, without one, by the zeros in its first characters.
fn wide(bytes: &[u8]) -> Option<Wide> {
    match bytes {
        [0xff, 0xfe, ..] => Some(Wide::LittleEndian),
        [0xfe, 0xff, ..] => Some(Wide::BigEndian),
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => Some(Wide::LittleEndian),
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => Some(Wide::BigEndian),
        _ => None,
    }
}

fn narrow(bytes: &[u8]) -> Result<String, Problem> {
    let bytes = bytes.strip_prefix(UTF_8_MARK).unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| not_utf8(bytes, error.valid_up_to()))?;
    match text.find('\0') {
        Some(place) => {
            Err(Problem::new(format!("line {} has a zero byte: it is no text", line_of(bytes, place))))
        }
        None => Ok(text.to_owned()),
    }
}

fn not_utf8(bytes: &[u8], place: usize) -> Problem {
    let line = line_of(bytes, place);
    let byte = bytes.get(place).copied().unwrap_or_default();
    // Text with one byte per character contains no control characters.
    let is_text = bytes.iter().all(|byte| !matches!(byte, 0..=8 | 14..=31));
    Problem::new(if is_text {
        format!(
            "line {line} has the byte {byte:02x}, which is not UTF-8: it is probably Latin-1 (Windows-1252); save it as UTF-8"
        )
    } else {
        format!("line {line} has the byte {byte:02x}: it is no text")
    })
}

fn line_of(bytes: &[u8], place: usize) -> usize {
    1 + bytes[..place].iter().filter(|&&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn unicode_is_read_with_and_without_its_mark() {
        for text in ["t\tx\n", "\u{feff}t\tx\n"] {
            for bytes in
                [text.as_bytes().to_vec(), wide(text, u16::to_le_bytes), wide(text, u16::to_be_bytes)]
            {
                assert_eq!(decoded(&bytes).as_deref(), Ok("t\tx\n"), "{bytes:?}");
            }
        }
        assert_eq!(decoded("\u{b5}m\n".as_bytes()).as_deref(), Ok("\u{b5}m\n"));
        assert_eq!(decoded(b"").as_deref(), Ok(""));
    }

    #[test]
    fn another_encoding_is_refused_by_its_name_with_what_to_do() {
        let of = |bytes: &[u8]| decoded(bytes).expect_err("refused").to_string();
        let latin = of(b"t,x\n0,1 \xb5m\n");
        assert!(latin.contains("line 2 has the byte b5") && latin.contains("Latin-1"), "{latin}");
        assert!(latin.ends_with("save it as UTF-8"), "{latin}");
        assert!(of(b"\x89PNG\r\n\x1a\n").contains("no text"));
        assert!(of(b"ab\0").contains("no text"));
        assert!(of(&[0xff, 0xfe, 0x30]).contains("is cut"));
        let refusal = utf8(&wide("\u{feff}a = 1\n", u16::to_le_bytes)).expect_err("refused").to_string();
        assert_eq!(refusal, "it is UTF-16: save it as UTF-8");
        assert_eq!(utf8("\u{feff}a = 1\n".as_bytes()).as_deref(), Ok("a = 1\n"));
    }
}
