//! Parquet: a column of doubles for the time and for each signal; null if a value is unknown. Facts about all samples
//! are in the file's key-value metadata.

use std::sync::Arc;

use anyhow::Result;
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::signals::Signals;

/// The bytes of the file.
///
/// # Errors
/// When the library refuses a column.
pub fn file(signals: &Signals) -> Result<Vec<u8>> {
    let columns: Vec<(&str, &[f64])> = std::iter::once(("time_s", &*signals.time_s))
        .chain(signals.signals.iter().map(|signal| (&*signal.name, &*signal.values)))
        .collect();
    let field = |(name, _): &(&str, &[f64])| {
        let of_numbers = Type::primitive_type_builder(name, Physical::DOUBLE);
        of_numbers.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("transient").with_fields(fields).build()?);
    let about = signals.about.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
    let properties = WriterProperties::builder()
        .set_created_by(concat!("pneudrive ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(about))
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, values) in columns {
        let Some(mut column) = group.next_column()? else { break };
        let there: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
        let known: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        column.typed::<DoubleType>().write_batch(&known, Some(&there), None)?;
        column.close()?;
    }
    group.close()?;
    Ok(writer.into_inner()?)
}
