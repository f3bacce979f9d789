//! Signals as files of other programs. The same signals give the same bytes.

mod csv;
mod mat;
mod mcap;
#[cfg(any(test, feature = "parquet"))]
mod parquet;

use anyhow::Result;

use crate::signals::Signals;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A table as text.
    Csv,
    /// MATLAB 5, which SciPy and Octave read, too.
    Mat,
    /// MCAP with protobuf messages, for PlotJuggler and Foxglove.
    Mcap,
    /// MCAP with messages of ROS 2, for `ros2 bag play`.
    Ros2,
    /// Parquet, for pandas, Polars and DuckDB.
    Parquet,
}

/// All kinds, with their words and the endings of their files. An ending alone is the first kind that has it.
pub const FORMATS: [(Format, &str, &str); 5] = [
    (Format::Csv, "csv", "csv"),
    (Format::Mat, "mat", "mat"),
    (Format::Mcap, "mcap", "mcap"),
    (Format::Ros2, "ros2", "mcap"),
    (Format::Parquet, "parquet", "parquet"),
];

/// The bytes of the file of these signals.
///
/// # Errors
/// When the format cannot hold them, or this program is built without it.
pub fn file(signals: &Signals, format: Format) -> Result<Vec<u8>> {
    match format {
        Format::Csv => Ok(csv::file(signals).into_bytes()),
        Format::Mat => mat::file(signals),
        Format::Mcap => mcap::file(signals),
        Format::Ros2 => mcap::ros2(signals),
        #[cfg(feature = "parquet")]
        Format::Parquet => parquet::file(signals),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => {
            anyhow::bail!(
                "this program was built without Parquet; build it with `--features parquet`, or choose csv, mat or mcap"
            )
        }
    }
}

#[cfg(test)]
mod tests;
