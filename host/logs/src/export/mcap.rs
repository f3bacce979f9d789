//! MCAP (mcap.dev/spec): one channel `/drive`, one protobuf message a sample, which describes itself by a
//! FileDescriptorSet. PlotJuggler and Foxglove open it as it is.
//!
//! A message has `time_s`, the time from the start of the test, and a double for each signal. The log time of a message
//! counts from the first sample, ns: a record does not know the date of its samples.

use std::collections::BTreeMap;
use std::io::Cursor;

use anyhow::Result;
use mcap::WriteOptions;
use mcap::records::{MessageHeader, Metadata};
use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

use crate::signals::Signals;

/// Where PlotJuggler and Foxglove find the signals.
const TOPIC: &str = "/drive";

/// The package and the name of a message.
const PACKAGE: &str = "pneudrive";
const MESSAGE: &str = "Sample";

/// The bytes of the file.
///
/// # Errors
/// When the library refuses a message.
pub fn file(signals: &Signals) -> Result<Vec<u8>> {
    let library = concat!("pneudrive ", env!("CARGO_PKG_VERSION"));
    let options = WriteOptions::new().compression(None).library(library);
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let metadata: BTreeMap<String, String> = signals.about.iter().cloned().collect();
    writer.write_metadata(&Metadata { name: PACKAGE.to_owned(), metadata })?;
    let names = std::iter::once("time_s").chain(signals.signals.iter().map(|signal| &*signal.name));
    let schema = writer.add_schema(
        &format!("{PACKAGE}.{MESSAGE}"),
        "protobuf",
        &description(names).encode_to_vec(),
    )?;
    let channel_id = writer.add_channel(schema, TOPIC, "protobuf", &BTreeMap::new())?;
    let first = signals.time_s.first().copied().unwrap_or(0.0);
    for (k, time) in signals.time_s.iter().enumerate() {
        let log_time = ((time - first) * 1e9).round() as u64;
        let header = MessageHeader { channel_id, sequence: k as u32, log_time, publish_time: log_time };
        let values = std::iter::once(*time).chain(signals.signals.iter().map(|signal| signal.values[k]));
        writer.write_to_known_channel(&header, &message(values))?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// The fields of a message, by numbers from 1.
fn message(values: impl Iterator<Item = f64>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (field, value) in (1..).zip(values) {
        prost::encoding::double::encode(field, &value, &mut bytes);
    }
    bytes
}

/// The description of a message, for programs that do not know it.
fn description<'a>(names: impl Iterator<Item = &'a str>) -> FileDescriptorSet {
    let field = |(number, name): (i32, &str)| FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(Type::Double.into()),
        ..FieldDescriptorProto::default()
    };
    let message = DescriptorProto {
        name: Some(MESSAGE.to_owned()),
        field: (1..).zip(names).map(field).collect(),
        ..DescriptorProto::default()
    };
    let file = FileDescriptorProto {
        name: Some("pneudrive/sample.proto".to_owned()),
        package: Some(PACKAGE.to_owned()),
        message_type: vec![message],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    FileDescriptorSet { file: vec![file] }
}
