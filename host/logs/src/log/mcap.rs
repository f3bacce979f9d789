//! MCAP (mcap.dev/spec) with messages in protobuf, JSON or CDR (ROS 2): every number of every field of every topic.
//!
//! Messages come in the order of their log times, as the reference library reads them; the order in the file is that in which
//! they were written. Where more than one channel has a topic, each is a topic of its own: `/drive#1`, `/drive#2`.

mod cdr;
mod chunk;
mod json;
mod protobuf;

use std::collections::HashMap;

use anyhow::{Context, Result, bail};
use mcap::records::{Channel, Record};

use super::Series;
use json::of_json;
use protobuf::Messages;

/// The messages of a channel.
#[derive(Default)]
struct Topic {
    channel: u16,
    times_ns: Vec<u64>,
    /// In the order in which fields are met.
    fields: Vec<(String, Vec<f64>)>,
    places: HashMap<String, usize>,
}

/// The kind of a channel's messages.
enum Encoding {
    Protobuf(Messages),
    Cdr(cdr::Messages),
    Json,
    /// One that cannot be read.
    Other(String),
}

/// The data read so far.
#[derive(Default)]
struct Reading {
    schemas: HashMap<u16, (String, Vec<u8>)>,
    channels: HashMap<u16, (String, Encoding)>,
    topics: Vec<(String, Topic)>,
}

/// The series of a file.
///
/// # Errors
/// When it is damaged, or no message can be read.
pub fn read(bytes: &[u8]) -> Result<Vec<Series>> {
    let mut reading = Reading::default();
    chunk::each_record(bytes, &mut |record| reading.take(record))?;
    let Reading { mut topics, channels, .. } = reading;
    if topics.is_empty() {
        let other = channels.values().find_map(|(topic, encoding)| match encoding {
            Encoding::Other(encoding) => Some(format!("{topic} is in {encoding:?}")),
            _ => None,
        });
        match other {
            Some(other) => bail!("{other}: only protobuf, json and cdr can be read"),
            None => bail!("it has no messages"),
        }
    }
    name_channels(&mut topics);
    for (name, topic) in &mut topics {
        topic.sort();
        topic.check_first_stamp().with_context(|| name.clone())?;
    }
    let first = topics.iter().filter_map(|(_, topic)| topic.times_ns.first()).min().copied().unwrap_or(0);
    Ok(topics.into_iter().flat_map(|(name, topic)| topic.into_series(&name, first)).collect())
}

impl Reading {
    fn take(&mut self, record: Record<'_>) -> Result<()> {
        match record {
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, data.into_owned()));
            }
            Record::Channel(channel) => {
                let encoding =
                    self.encoding(&channel).with_context(|| format!("channel {}", channel.topic))?;
                self.channels.insert(channel.id, (channel.topic, encoding));
            }
            Record::Message { header, data } => {
                let (name, encoding) =
                    self.channels.get(&header.channel_id).context("a message has no channel")?;
                let numbers = numbers(encoding, &data).with_context(|| format!("a message of {name}"))?;
                if let Some(numbers) = numbers {
                    topic(&mut self.topics, name, header.channel_id).append(header.log_time, numbers);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn encoding(&self, channel: &Channel) -> Result<Encoding> {
        let schema = || self.schemas.get(&channel.schema_id).context("it has no schema");
        match &*channel.message_encoding {
            "json" => Ok(Encoding::Json),
            "protobuf" => {
                let (name, data) = schema()?;
                Messages::described(data, name).map(Encoding::Protobuf)
            }
            "cdr" => {
                let (name, data) = schema()?;
                cdr::Messages::described(data, name).map(Encoding::Cdr)
            }
            other => Ok(Encoding::Other(other.to_owned())),
        }
    }
}

fn topic<'a>(topics: &'a mut Vec<(String, Topic)>, name: &str, channel: u16) -> &'a mut Topic {
    let place = topics.iter().position(|(_, topic)| topic.channel == channel).unwrap_or_else(|| {
        topics.push((name.to_owned(), Topic { channel, ..Topic::default() }));
        topics.len() - 1
    });
    &mut topics[place].1
}

/// Numbers the channels that share a topic.
fn name_channels(topics: &mut [(String, Topic)]) {
    let names: Vec<String> = topics.iter().map(|(name, _)| name.clone()).collect();
    for (name, topic) in topics {
        if names.iter().filter(|other| *other == name).count() > 1 {
            *name = format!("{name}#{}", topic.channel);
        }
    }
}

/// A clock that is further behind the next message, ns, had no time yet when it stamped the first one.
const A_DAY_NS: u64 = 86_400_000_000_000;

impl Topic {
    fn append(&mut self, time_ns: u64, numbers: Vec<(String, f64)>) {
        let before = self.times_ns.len();
        self.times_ns.push(time_ns);
        for (field, number) in numbers {
            let place = *self.places.entry(field).or_insert_with_key(|field| {
                self.fields.push((field.clone(), vec![f64::NAN; before]));
                self.fields.len() - 1
            });
            self.fields[place].1.push(number);
        }
        self.fields.iter_mut().for_each(|(_, values)| values.resize(before + 1, f64::NAN));
    }

    /// Puts the messages in the order of their times; those with the same time keep the order of the file.
    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.times_ns.len()).collect();
        order.sort_by_key(|&place| self.times_ns[place]);
        self.times_ns = order.iter().map(|&place| self.times_ns[place]).collect();
        for (_, values) in &mut self.fields {
            *values = order.iter().map(|&place| values[place]).collect();
        }
    }

    /// Refuses a message that was stamped before its recorder had a time.
    fn check_first_stamp(&self) -> Result<()> {
        let without = self.times_ns.iter().take_while(|time| **time == 0).count();
        match self.times_ns.get(without) {
            Some(next) if without > 0 && *next > A_DAY_NS => bail!(
                "its first message has the log time 0 and the next one {next} ns: the recorder had no time yet; cut the beginning off, as with `mcap filter --start`"
            ),
            _ => Ok(()),
        }
    }

    fn into_series(self, topic: &str, first_ns: u64) -> Vec<Series> {
        let clock: Vec<f64> = self.times_ns.iter().map(|time| time.abs_diff(first_ns) as f64 / 1e9).collect();
        let series = |(field, values): (String, Vec<f64>)| Series {
            name: format!("{topic}.{field}"),
            clock_s: Some(clock.clone()),
            values,
        };
        self.fields.into_iter().map(series).collect()
    }
}

/// Fields and their numbers; None of a message in another encoding.
fn numbers(encoding: &Encoding, data: &[u8]) -> Result<Option<Vec<(String, f64)>>> {
    let mut numbers = Vec::new();
    match encoding {
        Encoding::Protobuf(messages) => messages.numbers(data, &mut numbers).context("it is damaged")?,
        Encoding::Cdr(messages) => messages.numbers(data, &mut numbers).context("it is damaged")?,
        Encoding::Json => of_json("", &serde_json::from_slice(data).context("it is damaged")?, &mut numbers),
        Encoding::Other(_) => return Ok(None),
    }
    Ok(Some(numbers))
}
