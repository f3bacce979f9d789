//! MCAP (mcap.dev/spec): one channel `/drive`, one protobuf message a sample, which describes itself by a
//! FileDescriptorSet. PlotJuggler and Foxglove open it as it is. Or a channel for each signal, in the CDR of ROS 2.
//!
//! A message has `time_s`, the time from the start of the test, and a double for each signal. The log time of a message
//! counts from the first sample, ns: a record does not know the date of its samples.

use std::collections::BTreeMap;
use std::io::Cursor;

use anyhow::Result;
use mcap::records::{MessageHeader, Metadata};
use mcap::{WriteOptions, Writer};
use prost::Message;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

use crate::signals::Signals;

/// Where PlotJuggler and Foxglove find the signals.
const TOPIC: &str = "/drive";

/// The package and the name of a message.
const PACKAGE: &str = "pneudrive";
const MESSAGE: &str = "Sample";

/// The head of a message in CDR: little endian.
const LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

/// The bytes of a file with messages in protobuf.
///
/// # Errors
/// When the library refuses a message.
pub fn file(signals: &Signals) -> Result<Vec<u8>> {
    let mut writer = begun(signals)?;
    let names = std::iter::once("time_s").chain(signals.signals.iter().map(|signal| &*signal.name));
    let schema = writer.add_schema(
        &format!("{PACKAGE}.{MESSAGE}"),
        "protobuf",
        &description(names).encode_to_vec(),
    )?;
    let channel = writer.add_channel(schema, TOPIC, "protobuf", &BTreeMap::new())?;
    for k in 0..signals.time_s.len() {
        let values =
            std::iter::once(signals.time_s[k]).chain(signals.signals.iter().map(|one| one.values[k]));
        writer.write_to_known_channel(&header(signals, channel, k), &message(values))?;
    }
    ended(writer)
}

/// The bytes of a file with messages of ROS 2: a topic for each signal, of std_msgs/Float64, which every ROS 2 knows.
///
/// # Errors
/// When the library refuses a message.
pub fn ros2(signals: &Signals) -> Result<Vec<u8>> {
    let mut writer = begun(signals)?;
    let schema = writer.add_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data\n")?;
    let mut channels = Vec::new();
    for signal in &signals.signals {
        let topic = format!("{TOPIC}/{}", signal.name);
        channels.push(writer.add_channel(schema, &topic, "cdr", &BTreeMap::new())?);
    }
    for k in 0..signals.time_s.len() {
        for (channel, signal) in channels.iter().zip(&signals.signals) {
            let message = [&LITTLE_ENDIAN[..], &signal.values[k].to_le_bytes()].concat();
            writer.write_to_known_channel(&header(signals, *channel, k), &message)?;
        }
    }
    ended(writer)
}

type Bytes = Writer<Cursor<Vec<u8>>>;

fn begun(signals: &Signals) -> Result<Bytes> {
    let library = concat!("pneudrive ", env!("CARGO_PKG_VERSION"));
    let options = WriteOptions::new().compression(None).library(library);
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let metadata: BTreeMap<String, String> = signals.about.iter().cloned().collect();
    writer.write_metadata(&Metadata { name: PACKAGE.to_owned(), metadata })?;
    Ok(writer)
}

/// The head of the message of a sample. Its time counts from the first one.
fn header(signals: &Signals, channel_id: u16, k: usize) -> MessageHeader {
    let log_time = ((signals.time_s[k] - signals.time_s[0]) * 1e9).round() as u64;
    MessageHeader { channel_id, sequence: k as u32, log_time, publish_time: log_time }
}

fn ended(mut writer: Bytes) -> Result<Vec<u8>> {
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
