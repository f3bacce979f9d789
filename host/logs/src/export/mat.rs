//! A MAT-file of version 5, uncompressed, as MathWorks' "MAT-File Format" describes it.
//!
//! A header of 128 bytes, then a matrix for each variable: `time_s` and the signals as columns of doubles, `about` as a
//! text of lines `key = value`. A data element is a tag (type, bytes) and its data, padded to a multiple of 8.

use anyhow::{Result, bail};

use crate::signals::Signals;

/// Data types (table 1-1).
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

/// Classes of arrays (table 1-3).
const OF_CHARACTERS: u32 = 4;
const OF_DOUBLES: u32 = 6;

/// Bytes of the longest element.
const LONGEST: usize = i32::MAX as usize;

/// The longest name of a variable.
const LONGEST_NAME: usize = 63;

/// The bytes of the file.
///
/// # Errors
/// When a signal is too long, or its name.
pub fn file(signals: &Signals) -> Result<Vec<u8>> {
    let mut bytes = header();
    let about: String = signals.about.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
    bytes.extend(text("about", &about));
    let time = ("time_s", &signals.time_s);
    for (name, values) in
        std::iter::once(time).chain(signals.signals.iter().map(|one| (&*one.name, &one.values)))
    {
        if 8 * values.len() > LONGEST - 1024 || name.len() > LONGEST_NAME {
            bail!(
                "{name} has {} values: more than a MAT-file of version 5 can hold; choose mcap or csv",
                values.len()
            );
        }
        bytes.extend(column(name, values));
    }
    Ok(bytes)
}

fn header() -> Vec<u8> {
    let mut bytes =
        format!("{:116}", concat!("MATLAB 5.0 MAT-file, pneudrive ", env!("CARGO_PKG_VERSION"))).into_bytes();
    bytes.extend([0; 8]);
    bytes.extend(0x0100u16.to_le_bytes());
    bytes.extend(*b"IM");
    bytes
}

fn column(name: &str, values: &[f64]) -> Vec<u8> {
    let data = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    matrix(name, OF_DOUBLES, [values.len(), 1], &element(DOUBLE, data))
}

fn text(name: &str, text: &str) -> Vec<u8> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let data = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    matrix(name, OF_CHARACTERS, [1, units.len()], &element(UINT16, data))
}

fn matrix(name: &str, class: u32, size: [usize; 2], data: &[u8]) -> Vec<u8> {
    let flags = [class, 0].into_iter().flat_map(u32::to_le_bytes).collect();
    let size = size.into_iter().flat_map(|size| (size as i32).to_le_bytes()).collect();
    let parts = [
        element(UINT32, flags),
        element(INT32, size),
        element(INT8, name.as_bytes().to_vec()),
        data.to_vec(),
    ];
    element(MATRIX, parts.concat())
}

fn element(of: u32, mut data: Vec<u8>) -> Vec<u8> {
    let mut bytes = of.to_le_bytes().to_vec();
    bytes.extend((data.len() as u32).to_le_bytes());
    data.resize(data.len().next_multiple_of(8), 0);
    bytes.extend(data);
    bytes
}
