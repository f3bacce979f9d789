//! Messages of ROS 2: CDR (OMG DDS-RTPS 2.5, 10.2; plain CDR of XCDR1), described by the text of their .msg files.
//!
//! ```text
//! schema    float64[] position        a type, a name, perhaps a default; NAME=value is a constant; # begins a comment
//!           axis_msgs/Cell[<=3] cells
//!           ====...                   between messages, 80 of them
//!           MSG: axis_msgs/Cell
//! message   00 01 00 00               its order of bytes: 01 little, 00 big endian
//!           numbers                   at multiples of their size from here on
//!           text, list                its length in 32 bits first; that of a text counts the zero at its end
//! ```
//!
//! A damaged or hostile file ends in an error.

use std::collections::HashMap;

use anyhow::{Context, Result, bail, ensure};

use super::json::below;

/// Messages within messages.
const DEEPEST: u32 = 32;

/// The messages of a schema.
pub struct Messages {
    kinds: HashMap<String, Vec<Field>>,
    top: String,
}

struct Field {
    name: String,
    of: Kind,
    many: Many,
}

enum Kind {
    /// Bytes, and the number that they stand for.
    Number(usize, fn(u64) -> f64),
    Text,
    Message(String),
}

enum Many {
    One,
    /// So many.
    Fixed(usize),
    /// As many as the message says.
    List,
}

impl Messages {
    /// The messages of a schema; a channel has those of this name, such as `axis_msgs/msg/Axis`.
    ///
    /// # Errors
    /// When a line of the schema is none.
    pub fn described(schema: &[u8], name: &str) -> Result<Messages> {
        let text = std::str::from_utf8(schema).context("its schema is no text")?;
        let top = short(name);
        let mut kinds = HashMap::from([(top.clone(), Vec::new())]);
        let mut kind = top.clone();
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if let Some(name) = line.strip_prefix("MSG:") {
                kind = short(name.trim());
                kinds.insert(kind.clone(), Vec::new());
            } else if !line.is_empty() && !line.starts_with("==") && !is_constant(line) {
                let package = kind.split('/').next().unwrap_or_default();
                let field = field(line, package).with_context(|| format!("its schema: {line:?}"))?;
                kinds.entry(kind.clone()).or_default().push(field);
            }
        }
        Ok(Messages { kinds, top })
    }

    /// The numbers of a message with the names of their fields.
    ///
    /// # Errors
    /// When the message is damaged, or in another form of CDR.
    pub fn numbers(&self, bytes: &[u8], numbers: &mut Vec<(String, f64)>) -> Result<()> {
        let (head, bytes) = bytes.split_at_checked(4).context("it ends too early")?;
        let is_little = match head {
            [0, 0, ..] => false,
            [0, 1, ..] => true,
            [high, low, ..] => {
                bail!("its form of CDR is {high:02x}{low:02x}; only 0000 and 0001 can be read")
            }
            _ => bail!("it ends too early"),
        };
        self.of_message("", &self.top, &mut Cdr { bytes, at: 0, is_little }, DEEPEST, numbers)
    }

    fn of_message(
        &self,
        path: &str,
        kind: &str,
        cdr: &mut Cdr<'_>,
        depth: u32,
        numbers: &mut Vec<(String, f64)>,
    ) -> Result<()> {
        let depth = depth.checked_sub(1).context("its messages are nested too deeply")?;
        let fields = self.kinds.get(kind).with_context(|| format!("its schema does not describe {kind}"))?;
        if fields.is_empty() {
            // An empty message has a byte, as an empty structure of C++ has.
            return cdr.number(1).map(drop);
        }
        for Field { name, of, many } in fields {
            let name = below(path, name);
            let count = match many {
                Many::One => {
                    self.of_value(name, of, cdr, depth, numbers)?;
                    continue;
                }
                Many::Fixed(count) => *count,
                Many::List => cdr.length()?,
            };
            for place in 0..count {
                self.of_value(below(&name, &place.to_string()), of, cdr, depth, numbers)?;
            }
        }
        Ok(())
    }

    fn of_value(
        &self,
        path: String,
        of: &Kind,
        cdr: &mut Cdr<'_>,
        depth: u32,
        numbers: &mut Vec<(String, f64)>,
    ) -> Result<()> {
        match of {
            Kind::Number(size, meaning) => numbers.push((path, meaning(cdr.number(*size)?))),
            Kind::Text => cdr.text()?,
            Kind::Message(kind) => self.of_message(&path, kind, cdr, depth, numbers)?,
        }
        Ok(())
    }
}

/// `axis_msgs/Axis` of `axis_msgs/msg/Axis`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// Whether a line declares a constant: `uint8 MODE_RUN=2`. A text may have the sign in its default.
fn is_constant(line: &str) -> bool {
    let name = line.split_once(char::is_whitespace).map_or("", |(_, rest)| rest.trim_start());
    let end =
        name.find(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_').unwrap_or(name.len());
    name[end..].trim_start().starts_with('=')
}

fn field(line: &str, package: &str) -> Result<Field> {
    let mut words = line.split_whitespace();
    let (kind, name) = (words.next().unwrap_or_default(), words.next().context("a field has no name")?);
    let (kind, many) = match kind.strip_suffix(']').and_then(|kind| kind.rsplit_once('[')) {
        None => (kind, Many::One),
        Some((kind, "")) => (kind, Many::List),
        Some((kind, most)) if most.starts_with("<=") => (kind, Many::List),
        Some((kind, count)) => (kind, Many::Fixed(count.parse().context("a list has no length")?)),
    };
    // A text may be bounded: string<=10.
    let of = match kind.split("<=").next().unwrap_or_default() {
        "bool" => Kind::Number(1, |raw| f64::from(u8::from(raw != 0))),
        "byte" | "char" | "uint8" => Kind::Number(1, |raw| raw as f64),
        "int8" => Kind::Number(1, |raw| f64::from(raw as i8)),
        "int16" => Kind::Number(2, |raw| f64::from(raw as i16)),
        "uint16" => Kind::Number(2, |raw| raw as f64),
        "int32" => Kind::Number(4, |raw| f64::from(raw as i32)),
        "uint32" => Kind::Number(4, |raw| raw as f64),
        "int64" => Kind::Number(8, |raw| raw as i64 as f64),
        "uint64" => Kind::Number(8, |raw| raw as f64),
        "float32" => Kind::Number(4, |raw| f64::from(f32::from_bits(raw as u32))),
        "float64" => Kind::Number(8, f64::from_bits),
        "string" => Kind::Text,
        "wstring" => bail!("a wstring cannot be read"),
        "Header" => Kind::Message("std_msgs/Header".to_owned()),
        "time" | "duration" => Kind::Message(format!("builtin_interfaces/{kind}")),
        kind if kind.contains('/') => Kind::Message(short(kind)),
        kind => Kind::Message(format!("{package}/{kind}")),
    };
    Ok(Field { name: name.to_owned(), of, many })
}

/// The bytes of a message behind its head.
struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
    is_little: bool,
}

impl Cdr<'_> {
    /// The next number of so many bytes.
    fn number(&mut self, size: usize) -> Result<u64> {
        let from = self.at.next_multiple_of(size);
        let bytes = self.bytes.get(from..from + size).context("it ends too early")?;
        self.at = from + size;
        let take = |raw: u64, byte: &u8| raw << 8 | u64::from(*byte);
        Ok(if self.is_little { bytes.iter().rev().fold(0, take) } else { bytes.iter().fold(0, take) })
    }

    /// The length of a list or text, which cannot have more parts than there are bytes left.
    fn length(&mut self) -> Result<usize> {
        let length = self.number(4)? as usize;
        ensure!(length <= self.bytes.len() - self.at, "it ends too early");
        Ok(length)
    }

    fn text(&mut self) -> Result<()> {
        self.at += self.length()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(schema: &str, bytes: &[u8]) -> Result<Vec<(String, f64)>> {
        let mut numbers = Vec::new();
        Messages::described(schema.as_bytes(), "a/msg/A")?.numbers(bytes, &mut numbers)?;
        Ok(numbers)
    }

    #[test]
    fn either_order_of_bytes_is_read() {
        let schema = "uint8 a\nint16 b\n";
        let wanted = [("a".to_owned(), 7.0), ("b".to_owned(), -2.0)];
        assert_eq!(numbers(schema, &[0, 1, 0, 0, 7, 0, 0xfe, 0xff]).expect("little endian"), wanted);
        assert_eq!(numbers(schema, &[0, 0, 0, 0, 7, 0, 0xff, 0xfe]).expect("big endian"), wanted);
    }

    #[test]
    fn what_is_no_message_is_refused() {
        let refused = |schema, bytes: &[u8]| format!("{:#}", numbers(schema, bytes).expect_err("refused"));
        assert!(refused("int16 a", &[0, 1, 0, 0, 1]).contains("ends too early"));
        assert!(refused("uint8[] a", &[0, 1, 0, 0, 255, 255, 255, 255]).contains("ends too early"));
        assert!(refused("int16 a", &[0, 6, 0, 0, 1, 0]).contains("its form of CDR is 0006"));
        assert!(refused("A a", &[0, 1, 0, 0]).contains("nested too deeply"));
        assert!(refused("B a", &[0, 1, 0, 0]).contains("does not describe a/B"));
        assert!(refused("int16", &[0, 1, 0, 0]).contains("a field has no name"));
        assert!(refused("wstring a", &[0, 1, 0, 0]).contains("wstring"));
    }

    #[test]
    fn a_default_is_no_constant() {
        let found =
            numbers("string a \"x = 1\"\nuint8 B=2\nuint8 C = 3\nuint8 d 4", &[0, 1, 0, 0, 1, 0, 0, 0, 0, 9]);
        assert_eq!(found.expect("a message"), [("d".to_owned(), 9.0)]);
    }
}
