//! A run that is streamed to disk, so that its length is not limited by the board's memory.
//!
//! Text with LF, like a TARGET file: lines `# key = value`, the column header, one line of integers per sample. Samples
//! are written as they arrive, so a program that is killed loses none of them; the end is written once everything is on
//! the disk. A line `# gap = 3 samples before index 120` marks missing samples; the end of the file has the number of
//! samples and of missing ones, and the CRC-32 of all lines after the header. The header ends with its own CRC-32, which
//! an interrupted stream has, too. [`crate::target::TargetFile`] reads it.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, Result, anyhow, bail};
use pneudrive_controller::Sequence;
use pneudrive_protocol::{RecordCrc, RecordedSample, StreamedSample};

use crate::record_text::{COLUMNS, crc_text, data_line, described, header_text, sample_of};
use crate::rig_info::{Info, RigParameters};
use crate::test_lines;
use crate::whole_file;

/// The value of the first line.
pub const FORMAT: &str = "pneudrive-stream 1";

/// Key of the header's last line: the CRC-32 of the lines before it.
pub(crate) const HEADER_CRC: &str = "header_crc32";

/// The beginning of the last line.
const CRC: &str = "# crc32 = ";

/// The most samples of a file that is read: more exceed the memory of a small machine.
pub const MAX_SAMPLES: usize = 10_000_000;

/// The destination of a stream.
pub trait Disk: Write {
    /// Brings everything written to the disk, so that it survives a power cut.
    ///
    /// # Errors
    /// When the disk does not accept it.
    fn sync(&mut self) -> io::Result<()>;
}

impl Disk for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// A file that a run is streamed to.
#[derive(Debug)]
pub struct StreamFile<W = File> {
    path: PathBuf,
    out: W,
    every: u32,
    /// Index of the next sample if none is missing.
    due: u32,
    samples: u64,
    missing: u64,
    /// Of all lines after the header.
    crc: RecordCrc,
}

impl StreamFile {
    /// Creates the file for every Nth sample of a run of the test `sequence`. It must not exist yet.
    ///
    /// # Errors
    /// When it exists, or cannot be written.
    pub fn create(
        path: &Path,
        test: &str,
        every: u16,
        info: &Info,
        parameters: &RigParameters,
        sequence: &Sequence,
    ) -> Result<StreamFile> {
        let file = OpenOptions::new().write(true).create_new(true).open(path);
        let file = file.with_context(|| format!("cannot make {}", path.display()))?;
        let mut file = StreamFile::over(file, path, every);
        file.describe(test, info, parameters, sequence)?;
        Ok(file)
    }

    /// Writes the header anew before the first sample, with other parameters.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn describe_again(
        &mut self,
        test: &str,
        info: &Info,
        parameters: &RigParameters,
        sequence: &Sequence,
    ) -> Result<()> {
        let emptied = self.out.set_len(0).and_then(|()| self.out.rewind());
        emptied.with_context(|| format!("cannot write {}", self.path.display()))?;
        self.describe(test, info, parameters, sequence)
    }

    fn describe(
        &mut self,
        test: &str,
        info: &Info,
        parameters: &RigParameters,
        sequence: &Sequence,
    ) -> Result<()> {
        let mut header = described(FORMAT, test, info, parameters);
        header.insert(2, ("decimation".to_owned(), self.every.to_string()));
        header.extend(test_lines::lines(sequence));
        header.push((HEADER_CRC.to_owned(), crc_text(&header_text(&header))));
        self.write(&(header_text(&header) + COLUMNS + "\n"))
    }
}

impl<W: Disk> StreamFile<W> {
    fn over(out: W, path: &Path, every: u16) -> StreamFile<W> {
        StreamFile {
            path: path.to_owned(),
            out,
            every: u32::from(every.max(1)),
            due: 0,
            samples: 0,
            missing: 0,
            crc: RecordCrc::new(),
        }
    }

    /// Adds a sample, and a line about missing samples before it.
    ///
    /// # Errors
    /// When the disk does not accept it.
    pub fn add(&mut self, row: &StreamedSample) -> Result<()> {
        self.skip_to(row.index)?;
        self.due = row.index.saturating_add(self.every);
        self.samples += 1;
        self.add_line(&data_line(i64::from(row.index), &row.sample))
    }

    fn skip_to(&mut self, index: u32) -> Result<()> {
        let missing = index.saturating_sub(self.due).div_ceil(self.every);
        self.missing += u64::from(missing);
        if missing == 0 {
            Ok(())
        } else {
            self.add_line(&format!("# gap = {missing} samples before index {index}\n"))
        }
    }

    /// Ends the file and brings it to the disk; `samples_of_run` is the number of samples of the run, if known.
    ///
    /// # Errors
    /// When the disk does not accept it.
    pub fn end(&mut self, samples_of_run: Option<u32>) -> Result<()> {
        if let Some(end) = samples_of_run.filter(|&end| end > self.due) {
            self.skip_to(end)?;
        }
        self.add_line(&format!("# samples = {}\n# missing = {}\n", self.samples, self.missing))?;
        self.write(&format!("{CRC}{:08x}\n", self.crc.clone().finish()))?;
        self.out.sync().with_context(|| format!("cannot write {}", self.path.display()))?;
        whole_file::sync_folder(whole_file::folder_of(&self.path));
        Ok(())
    }

    fn add_line(&mut self, line: &str) -> Result<()> {
        self.crc.update(line.as_bytes());
        self.write(line)
    }

    fn write(&mut self, text: &str) -> Result<()> {
        self.out.write_all(text.as_bytes()).with_context(|| format!("cannot write {}", self.path.display()))
    }

    /// Samples in the file, and samples that are missing between them.
    #[must_use]
    pub fn counts(&self) -> (u64, u64) {
        (self.samples, self.missing)
    }
}

/// The samples in the numbered lines after the header, and whether a CRC at the end covers them. A program that was
/// killed leaves no end, and maybe a partial line: then the text does not end with a line break.
///
/// # Errors
/// With the line of the problem; also when there are fewer samples than the end says, or their CRC differs.
pub(crate) fn samples<'a>(
    lines: impl Iterator<Item = (usize, &'a str)>,
    ends_with_a_line: bool,
) -> Result<(Vec<(i32, RecordedSample)>, bool)> {
    let mut lines = lines.peekable();
    let mut crc = RecordCrc::new();
    let mut samples: Vec<(i32, RecordedSample)> = Vec::new();
    while let Some((number, line)) = lines.next() {
        if lines.peek().is_none() && !ends_with_a_line {
            break;
        }
        if let Some(stated) = line.strip_prefix(CRC) {
            check_crc(stated.trim_end(), crc.finish())?;
            return match lines.next() {
                None => Ok((samples, true)),
                Some((number, _)) => {
                    bail!("line {}: it comes after the CRC, which ends the file", number + 1)
                }
            };
        }
        crc.update(line.trim_end_matches('\r').as_bytes());
        crc.update(b"\n");
        if let Some(stated) = line.strip_prefix("# samples = ") {
            if stated.trim_end() != samples.len().to_string() {
                bail!(
                    "line {}: there should be {stated} samples before it, but there are {}",
                    number + 1,
                    samples.len()
                );
            }
        } else if !line.starts_with("# ") {
            add_sample(number, line, &mut samples)?;
        }
    }
    Ok((samples, false))
}

/// Adds the sample of a line, whose number counts from 0, to those before it.
fn add_sample(number: usize, line: &str, samples: &mut Vec<(i32, RecordedSample)>) -> Result<()> {
    let sample = sample_of(number, line).map_err(|error| too_late(line).unwrap_or(error))?;
    if let Some((before, _)) = samples.last().filter(|(before, _)| *before >= sample.0) {
        bail!("line {}: sample {} comes after sample {before}", number + 1, sample.0);
    }
    if samples.len() == MAX_SAMPLES {
        bail!("it has more than {MAX_SAMPLES} samples; split it, or stream every Nth with --every");
    }
    samples.push(sample);
    Ok(())
}

fn check_crc(stated: &str, actual: u32) -> Result<()> {
    if stated != format!("{actual:08x}") {
        bail!("its samples are damaged or changed: the CRC is {actual:08x}, the file says {stated}");
    }
    Ok(())
}

/// The error for a sample whose index is too large to be read: 32 days at 1.3 ms.
fn too_late(line: &str) -> Option<Error> {
    let index: u32 = line.split(',').next()?.parse().ok()?;
    let most = i32::MAX;
    (index > most as u32).then(|| {
        anyhow!("sample {index} is beyond the last one that can be read, {most}; cut the file there")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Disk for Vec<u8> {
        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A disk with a cache in front of it.
    #[derive(Default)]
    struct Cached {
        cached: usize,
        on_disk: usize,
        is_full: bool,
    }

    impl Write for Cached {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.cached += bytes.len();
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Disk for Cached {
        fn sync(&mut self) -> io::Result<()> {
            if self.is_full {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.on_disk = self.cached;
            Ok(())
        }
    }

    #[test]
    fn a_stream_that_has_ended_is_on_the_disk_to_its_last_byte_or_says_that_it_is_not() {
        let mut file = StreamFile::over(Cached::default(), Path::new("run.stream"), 1);
        file.add(&StreamedSample::default()).expect("cached");
        file.end(Some(1)).expect("on the disk");
        assert!(file.out.cached > 40);
        assert_eq!(file.out.on_disk, file.out.cached);

        let full = Cached { is_full: true, ..Cached::default() };
        let error = StreamFile::over(full, Path::new("run.stream"), 1).end(Some(0)).expect_err("no room");
        assert_eq!(error.to_string(), "cannot write run.stream");
    }

    const LINES: &str = "0,1,2,3,4,5,6\n2,1,2,3,4,5,6\n# gap = 1 samples before index 6\n6,1,2,3,4,5,6\n";

    fn read(text: &str) -> Result<Vec<i32>> {
        let (samples, _) = samples(text.lines().enumerate(), text.ends_with('\n'))?;
        Ok(samples.iter().map(|(index, _)| *index).collect())
    }

    #[test]
    fn a_stream_is_read_with_its_gaps_and_without_its_end() {
        let whole = format!("{LINES}# samples = 3\n# missing = 1\n");
        for text in [whole.as_str(), LINES, &format!("{LINES}8,1,2,3,4,5"), &format!("{LINES}8,1,2,3,4,5,6")]
        {
            assert_eq!(read(text).expect("a stream"), [0, 2, 6], "{text}");
        }
    }

    #[test]
    fn what_a_stream_cannot_hold_is_refused_by_its_line() {
        for (end, expected) in [
            ("# samples = 4\n", "line 5: there should be 4 samples before it, but there are 3"),
            ("6,1,2,3,4,5,6\n", "line 5: sample 6 comes after sample 6"),
            ("8,1,2\n", "line 5: expected seven whole numbers"),
            (
                "2147483648,1,2,3,4,5,6\n",
                "sample 2147483648 is beyond the last one that can be read, 2147483647",
            ),
        ] {
            let error = read(&format!("{LINES}{end}")).expect_err("refused").to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn gaps_are_marked_where_they_are_and_counted() {
        let mut file = StreamFile::over(Vec::new(), Path::new("x"), 10);
        for index in [0, 10, 40, 50] {
            file.add(&StreamedSample { index, ..StreamedSample::default() }).expect("memory");
        }
        file.end(Some(71)).expect("memory");
        assert_eq!(file.counts(), (4, 4));
        assert_eq!(
            String::from_utf8(file.out).expect("text"),
            "0,0,0,0,0,0,0\n10,0,0,0,0,0,0\n# gap = 2 samples before index 40\n40,0,0,0,0,0,0\n50,0,0,0,0,0,0\n\
             # gap = 2 samples before index 71\n# samples = 4\n# missing = 4\n# crc32 = 3219d851\n"
        );
    }

    #[test]
    fn a_run_that_is_whole_has_no_gap() {
        let mut file = StreamFile::over(Vec::new(), Path::new("x"), 10);
        for index in [0, 10] {
            file.add(&StreamedSample { index, ..StreamedSample::default() }).expect("memory");
        }
        file.end(Some(20)).expect("memory");
        assert_eq!(file.counts(), (2, 0));
    }

    #[test]
    fn a_changed_digit_of_a_whole_stream_is_noticed_and_a_cut_one_is_not_whole() {
        let mut file = StreamFile::over(Vec::new(), Path::new("x"), 1);
        for index in [0, 1, 5] {
            file.add(&StreamedSample { index, ..StreamedSample::default() }).expect("memory");
        }
        file.end(Some(6)).expect("memory");
        let text = String::from_utf8(file.out).expect("text");
        let read = |text: &str| samples(text.lines().enumerate(), text.ends_with('\n'));
        assert!(read(&text).expect("whole").1);
        assert!(read(&text.replace('\n', "\r\n")).expect("through another system").1);
        for (at, digit) in text.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
            let other = if digit == '7' { "8" } else { "7" };
            let changed = format!("{}{other}{}", &text[..at], &text[at + 1..]);
            // A line whose key was changed is read as a remark: then there is no CRC, and the reader is told so.
            assert!(!matches!(read(&changed), Ok((_, true))), "changed digit at {at}");
        }
        let end = text.find(CRC).expect("an end");
        assert!(!read(&text[..end]).expect("cut").1);
        assert!(read(&(text.clone() + "9,0,0,0,0,0,0\n")).is_err(), "a sample behind the end");
    }
}
