//! Messages in protobuf (protobuf.dev/programming-guides/encoding) that are described by a FileDescriptorSet: the numbers
//! of all their fields.
//!
//! A damaged or hostile file ends in an error. (The crates that decode messages by their description panic on a damaged
//! description.)

use std::collections::HashMap;

use anyhow::{Context, Result, bail};
use prost::Message;
use prost::bytes::Buf;
use prost::encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet};

use super::json::below;

/// Messages within messages.
const DEEPEST: u32 = 32;

/// The messages of a description.
pub struct Messages {
    kinds: HashMap<String, Vec<Field>>,
    /// The full name of the messages of a channel.
    top: String,
}

/// A field of a message.
struct Field {
    name: String,
    tag: u32,
    of: Type,
    /// The full name of its message, if it is one.
    message: String,
    is_repeated: bool,
    /// Whether it is 0 if a message does not carry it.
    is_implied: bool,
}

/// The content of a field in a message.
enum Found<'a> {
    Number(f64),
    Message(&'a [u8]),
}

impl Messages {
    /// The messages of a description; a channel has those of this name.
    ///
    /// # Errors
    /// When the description is damaged, or does not have them.
    pub fn described(bytes: &[u8], name: &str) -> Result<Messages> {
        let set = FileDescriptorSet::decode(bytes).context("its schema is damaged")?;
        let mut kinds = HashMap::new();
        for file in &set.file {
            let package =
                if file.package().is_empty() { String::new() } else { format!(".{}", file.package()) };
            let is_third = file.syntax() == "proto3";
            file.message_type.iter().for_each(|message| describe(&package, message, is_third, &mut kinds));
        }
        let top = format!(".{name}");
        if !kinds.contains_key(&top) {
            bail!("its schema does not describe {name}");
        }
        Ok(Messages { kinds, top })
    }

    /// The numbers of a message with the names of their fields.
    ///
    /// # Errors
    /// When the message is damaged.
    pub fn numbers(&self, bytes: &[u8], numbers: &mut Vec<(String, f64)>) -> Result<()> {
        self.of_message("", &self.top, bytes, DEEPEST, numbers)
    }

    fn of_message(
        &self,
        path: &str,
        kind: &str,
        bytes: &[u8],
        depth: u32,
        numbers: &mut Vec<(String, f64)>,
    ) -> Result<()> {
        let depth = depth.checked_sub(1).context("its messages are nested too deeply")?;
        let fields = self.kinds.get(kind).with_context(|| format!("its schema does not describe {kind}"))?;
        let mut found = carried(fields, bytes)?;
        for field in fields {
            let mut values = found.remove(&field.tag).unwrap_or_default();
            if values.is_empty() && field.is_implied {
                values.push(Found::Number(0.0));
            }
            // If a field is not repeated, its last value holds.
            let skipped = if field.is_repeated { 0 } else { values.len().saturating_sub(1) };
            for (place, value) in values.into_iter().skip(skipped).enumerate() {
                let name = below(path, &field.name);
                let name = if field.is_repeated { below(&name, &place.to_string()) } else { name };
                match value {
                    Found::Number(number) => numbers.push((name, number)),
                    Found::Message(inner) => self.of_message(&name, &field.message, inner, depth, numbers)?,
                }
            }
        }
        Ok(())
    }
}

fn describe(
    prefix: &str,
    message: &DescriptorProto,
    is_third: bool,
    kinds: &mut HashMap<String, Vec<Field>>,
) {
    let name = format!("{prefix}.{}", message.name());
    message.nested_type.iter().for_each(|inner| describe(&name, inner, is_third, kinds));
    kinds.insert(name, message.field.iter().map(|field| Field::of(field, is_third)).collect());
}

impl Field {
    fn of(field: &FieldDescriptorProto, is_third: bool) -> Field {
        let is_repeated = field.label() == Label::Repeated;
        let may_be_absent = field.proto3_optional() || field.oneof_index.is_some();
        let is_number = !matches!(field.r#type(), Type::String | Type::Bytes | Type::Message | Type::Group);
        Field {
            name: field.name().to_owned(),
            tag: u32::try_from(field.number()).unwrap_or(0),
            of: field.r#type(),
            message: field.type_name().to_owned(),
            is_repeated,
            is_implied: is_third && is_number && !is_repeated && !may_be_absent,
        }
    }

    /// A number by the eight or four bytes, or the varint, that stand for it.
    fn number(&self, raw: u64) -> f64 {
        match self.of {
            Type::Double => f64::from_bits(raw),
            Type::Float => f64::from(f32::from_bits(raw as u32)),
            Type::Int32 | Type::Sfixed32 | Type::Enum => f64::from(raw as i32),
            Type::Int64 | Type::Sfixed64 => raw as i64 as f64,
            Type::Sint32 | Type::Sint64 => ((raw >> 1) as i64 ^ -((raw & 1) as i64)) as f64,
            Type::Bool => f64::from(u8::from(raw != 0)),
            _ => raw as f64,
        }
    }

    fn wire(&self) -> WireType {
        match self.of {
            Type::Double | Type::Fixed64 | Type::Sfixed64 => WireType::SixtyFourBit,
            Type::Float | Type::Fixed32 | Type::Sfixed32 => WireType::ThirtyTwoBit,
            Type::String | Type::Bytes | Type::Message | Type::Group => WireType::LengthDelimited,
            _ => WireType::Varint,
        }
    }
}

/// The contents of a message, by the numbers of its fields.
fn carried<'a>(fields: &[Field], mut bytes: &'a [u8]) -> Result<HashMap<u32, Vec<Found<'a>>>> {
    let mut found: HashMap<u32, Vec<Found<'a>>> = HashMap::new();
    while bytes.has_remaining() {
        let (tag, wire) = decode_key(&mut bytes)?;
        let field = fields.iter().find(|field| field.tag == tag);
        let Some(field) = field.filter(|field| field.wire() == wire || wire == WireType::LengthDelimited)
        else {
            skip_field(wire, tag, &mut bytes, DecodeContext::default())?;
            continue;
        };
        let values = found.entry(tag).or_default();
        if wire != WireType::LengthDelimited {
            values.push(Found::Number(field.number(raw(wire, &mut bytes)?)));
            continue;
        }
        let mut inner = piece(&mut bytes)?;
        match field.of {
            Type::Message => values.push(Found::Message(inner)),
            Type::String | Type::Bytes | Type::Group => {}
            // Numbers of a repeated field, one after the other.
            _ => {
                while inner.has_remaining() {
                    values.push(Found::Number(field.number(raw(field.wire(), &mut inner)?)));
                }
            }
        }
    }
    Ok(found)
}

fn piece<'a>(bytes: &mut &'a [u8]) -> Result<&'a [u8]> {
    let length = usize::try_from(decode_varint(bytes)?)?;
    let (piece, rest) = bytes.split_at_checked(length).context("it ends too early")?;
    *bytes = rest;
    Ok(piece)
}

fn raw(wire: WireType, bytes: &mut &[u8]) -> Result<u64> {
    Ok(match wire {
        WireType::Varint => decode_varint(bytes)?,
        WireType::SixtyFourBit => bytes.try_get_u64_le()?,
        _ => u64::from(bytes.try_get_u32_le()?),
    })
}
