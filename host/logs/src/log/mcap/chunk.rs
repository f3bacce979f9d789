//! The records of a file, out of its chunks: plain ones, and those that lz4 or zstd have compressed.

use std::io::Read;

use anyhow::{Context, Result, bail};
use mcap::MAGIC;
use mcap::read::LinearReader;
use mcap::records::{ChunkHeader, Record};

/// Bytes of the largest chunk.
const LARGEST: u64 = 1 << 30;

/// Hands on each record of a file.
///
/// # Errors
/// When the file is damaged, or `take` refuses a record.
pub fn each_record(bytes: &[u8], take: &mut dyn FnMut(Record<'_>) -> Result<()>) -> Result<()> {
    if bytes.len() < 2 * MAGIC.len() || !bytes.ends_with(MAGIC) {
        bail!(
            "it is cut: it does not end as an MCAP file does; `mcap recover` makes a whole file of what is there"
        );
    }
    for record in LinearReader::new(bytes)? {
        match record.context("it is damaged")? {
            Record::Chunk { header, data } => {
                let content = content(&header, &data).context("a chunk of it is damaged")?;
                for record in LinearReader::sans_magic(&content) {
                    take(record.context("a chunk of it is damaged")?)?;
                }
            }
            // Only repetitions of schemas and channels follow.
            Record::DataEnd(_) => break,
            record => take(record)?,
        }
    }
    Ok(())
}

fn content(header: &ChunkHeader, data: &[u8]) -> Result<Vec<u8>> {
    let size = header.uncompressed_size;
    if size > LARGEST {
        bail!("it has {size} bytes; at most {LARGEST} can be read");
    }
    let mut content = Vec::new();
    // A byte more than announced shows that there is more.
    let most = size + 1;
    match &*header.compression {
        "" => data.take(most).read_to_end(&mut content)?,
        "lz4" => lz4_flex::frame::FrameDecoder::new(data).take(most).read_to_end(&mut content)?,
        "zstd" => ruzstd::decoding::StreamingDecoder::new(data)?.take(most).read_to_end(&mut content)?,
        other => bail!("it is compressed by {other:?}; only lz4 and zstd can be read"),
    };
    if content.len() as u64 != size {
        bail!("it has {} bytes where {size} are announced", content.len());
    }
    Ok(content)
}
