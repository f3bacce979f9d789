//! The result of a sweep as a Parquet file: the columns of the CSV, with types. Built with `--features parquet`.
//!
//! | column | type |
//! |---|---|
//! | `point` | INT64 |
//! | varied quantities | DOUBLE, or text if a level is a word |
//! | metrics and the ends of their ranges | DOUBLE, null where the run does not show it |
//! | `converged` | BOOLEAN, null of a point without a run |
//! | `fault`, `failure` | text |

use std::sync::Arc;

use anyhow::Result;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use super::{Axis, CONVERGED, Row, Sweep};

/// The bytes of the file.
///
/// # Errors
/// When the library refuses a column.
pub fn file(sweep: &Sweep, rows: &[Row]) -> Result<Vec<u8>> {
    let made_by = concat!("pneudrive ", env!("CARGO_PKG_VERSION")).to_owned();
    let properties = WriterProperties::builder().set_created_by(made_by).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema(sweep)?, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let axes = sweep.axes.len();
    let mut place = 0;
    let figures = sweep.figure_columns().len();
    while let Some(mut column) = group.next_column()? {
        match place {
            0 => put_points(&mut column, rows)?,
            place if place <= axes => put_levels(&mut column, &sweep.axes[place - 1], rows, place - 1)?,
            place if place <= axes + figures => put_figure(&mut column, sweep, rows, place - 1 - axes)?,
            place if place == axes + figures + 1 => {
                put_texts(&mut column, rows.iter().map(|row| &*row.fault))?
            }
            _ => put_texts(&mut column, rows.iter().map(|row| &*row.failure))?,
        }
        column.close()?;
        place += 1;
    }
    group.close()?;
    Ok(writer.into_inner()?)
}

fn schema(sweep: &Sweep) -> Result<TypePtr> {
    let axis = |axis: &Axis| {
        if axis.is_named() { text(&axis.name) } else { number(&axis.name, Repetition::REQUIRED) }
    };
    let figure = |name: &String| {
        if name == CONVERGED { switch(name) } else { number(name, Repetition::OPTIONAL) }
    };
    let point =
        Type::primitive_type_builder("point", Physical::INT64).with_repetition(Repetition::REQUIRED).build();
    let fields: Vec<_> = std::iter::once(Ok(point?))
        .chain(sweep.axes.iter().map(axis))
        .chain(sweep.figure_columns().iter().map(figure))
        .chain([text("fault"), text("failure")])
        .map(|field| field.map(Arc::new))
        .collect::<Result<_>>()?;
    Ok(Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?))
}

fn number(name: &str, repetition: Repetition) -> Result<Type> {
    Ok(Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(repetition).build()?)
}

fn switch(name: &str) -> Result<Type> {
    let of_switch = Type::primitive_type_builder(name, Physical::BOOLEAN);
    Ok(of_switch.with_repetition(Repetition::OPTIONAL).build()?)
}

fn text(name: &str) -> Result<Type> {
    let of_text =
        Type::primitive_type_builder(name, Physical::BYTE_ARRAY).with_logical_type(Some(LogicalType::String));
    Ok(of_text.with_repetition(Repetition::REQUIRED).build()?)
}

fn put_points(column: &mut SerializedColumnWriter<'_>, rows: &[Row]) -> Result<()> {
    let points: Vec<i64> = rows.iter().map(|row| row.point as i64).collect();
    column.typed::<Int64Type>().write_batch(&points, None, None)?;
    Ok(())
}

fn put_levels(
    column: &mut SerializedColumnWriter<'_>,
    axis: &Axis,
    rows: &[Row],
    place: usize,
) -> Result<()> {
    let levels = rows.iter().map(|row| &*row.levels[place]);
    if axis.is_named() {
        return put_texts(column, levels);
    }
    let levels: Vec<f64> = levels.map(|level| axis.place(level)).collect();
    column.typed::<DoubleType>().write_batch(&levels, None, None)?;
    Ok(())
}

/// Values that are there, and for each row whether it has one.
fn put_figure(
    column: &mut SerializedColumnWriter<'_>,
    sweep: &Sweep,
    rows: &[Row],
    place: usize,
) -> Result<()> {
    let metrics = sweep.metrics.len();
    let ends = if sweep.ensemble > 1 { 2 * metrics } else { 0 };
    match place {
        place if place < metrics => put_numbers(column, rows, |row| row.metrics[place]),
        place if place < metrics + ends => {
            let [metric, end] = [(place - metrics) / 2, (place - metrics) % 2];
            put_numbers(column, rows, |row| Some(row.ends[metric]?[end]))
        }
        _ => put_switches(column, rows),
    }
}

fn put_numbers(
    column: &mut SerializedColumnWriter<'_>,
    rows: &[Row],
    of: impl Fn(&Row) -> Option<f64>,
) -> Result<()> {
    let values: Vec<f64> = rows.iter().filter_map(&of).collect();
    let there: Vec<i16> = rows.iter().map(|row| i16::from(of(row).is_some())).collect();
    column.typed::<DoubleType>().write_batch(&values, Some(&there), None)?;
    Ok(())
}

fn put_switches(column: &mut SerializedColumnWriter<'_>, rows: &[Row]) -> Result<()> {
    let values: Vec<bool> = rows.iter().filter_map(|row| row.converged).collect();
    let there: Vec<i16> = rows.iter().map(|row| i16::from(row.converged.is_some())).collect();
    column.typed::<BoolType>().write_batch(&values, Some(&there), None)?;
    Ok(())
}

fn put_texts<'a>(
    column: &mut SerializedColumnWriter<'_>,
    texts: impl Iterator<Item = &'a str>,
) -> Result<()> {
    let texts: Vec<ByteArray> = texts.map(ByteArray::from).collect();
    column.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;
    use crate::sweep::Source;

    const SWEEP: &str = "rig = \"servo-b\"\n[vary]\nload.mass_kg = [1.5, 1.7]\nvalve.model = [\"flow-node\", \"single-restriction\"]\n[metrics]\nsettling = \"settling_s\"\n";

    fn sweep() -> Sweep {
        let rig = |name: &str| {
            let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig").to_owned();
            Ok(Source { name: name.to_owned(), text })
        };
        let source = Source { name: "s.toml".to_owned(), text: SWEEP.to_owned() };
        Sweep::read(source, rig).unwrap_or_else(|problems| panic!("{problems}"))
    }

    /// The fields of a point's row.
    fn expected(point: i64, mass: f64, valve: &str, metric: Field, fault: &str) -> Vec<Field> {
        let words = |text: &str| Field::Str(text.to_owned());
        let converged = Field::Bool(point == 0);
        vec![
            Field::Long(point),
            Field::Double(mass),
            words(valve),
            metric,
            converged,
            words(fault),
            words(""),
        ]
    }

    #[test]
    fn a_result_reads_back_with_its_types_its_gaps_and_in_every_bit() {
        let sweep = sweep();
        let row = |point: usize, metric, fault: &str| Row {
            point,
            levels: sweep.levels(point).into_iter().map(str::to_owned).collect(),
            metrics: vec![metric],
            ends: Vec::new(),
            converged: Some(point == 0),
            fault: fault.to_owned(),
            failure: String::new(),
        };
        let rows = [row(0, Some(0.1 + 0.2), ""), row(1, None, "encoder-step"), row(3, Some(-0.0), "")];
        let bytes = file(&sweep, &rows).expect("a file");
        assert_eq!(bytes, file(&sweep, &rows).expect("a file"), "the same bytes each time");
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).expect("Parquet");
        let read: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .expect("rows")
            .map(|row| row.expect("a row").into_columns().into_iter().map(|(_, field)| field).collect())
            .collect();
        assert_eq!(
            read,
            [
                expected(0, 1.5, "flow-node", Field::Double(0.1 + 0.2), ""),
                expected(1, 1.5, "single-restriction", Field::Null, "encoder-step"),
                expected(3, 1.7, "single-restriction", Field::Double(-0.0), ""),
            ]
        );
    }
}
