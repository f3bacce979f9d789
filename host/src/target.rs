//! TARGETxx.DAT: a recorded transient as a text file (thesis 5.5.2), exactly as DESIGN section 3 has
//! it.
//!
//! A file is written whole or not at all, and never over another one.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use crc::{CRC_32_ISO_HDLC, Crc};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::RecordedSample;

use crate::client::{Info, Record, RigParameters};
use crate::foreign::{NAME, cleaned};
use crate::stream_file;
use crate::whole_file::{Staged, sync_folder};

/// First line's value.
const FORMAT: &str = "pneudrive-target 1";

/// Header of the data lines.
pub(crate) const COLUMNS: &str =
    "index,position_counts,pressure_1_raw,pressure_2_raw,dac_counts,error_counts,spool_raw";

/// A TARGET file, or what has been streamed of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetFile {
    /// The `# key = value` lines, in order.
    pub header: Vec<(String, String)>,
    /// Index k and channels of the stored samples.
    pub samples: Vec<(i32, RecordedSample)>,
}

impl TargetFile {
    /// The file of a record, with everything that its reader needs to know.
    ///
    /// # Errors
    /// When a sample has an index that files do not count to.
    pub fn new(record: &Record, info: &Info, parameters: &RigParameters) -> Result<TargetFile> {
        let head = &record.head;
        let mut header = described(FORMAT, &head.test, info, parameters);
        let place = header.iter().position(|(key, _)| key == "mm_per_count").unwrap_or(header.len());
        let taken = [
            ("measured_period_us", format!("{}", f64::from(head.measured_period_ns) / 1e3)),
            ("decimation", head.decimation.to_string()),
            ("pre_trigger", head.pre_trigger.to_string()),
        ];
        header.splice(place..place, taken.map(|(key, value)| (key.to_owned(), value)));
        let place = header.iter().position(|(key, _)| key.starts_with("param.")).unwrap_or(header.len());
        header.insert(place, ("mean_spool_raw".to_owned(), head.mean_spool_raw.to_string()));
        let numbered = head.indices().zip(&record.samples).map(|(index, sample)| numbered(index, *sample));
        let samples: Vec<(i32, RecordedSample)> = numbered.collect::<Result<_>>()?;
        header.push(("crc32".to_owned(), format!("{:08x}", crc32(&data_lines(&samples)))));
        Ok(TargetFile { header, samples })
    }

    /// The value of a header line.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        self.header.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// A number of the header.
    ///
    /// # Errors
    /// When the header has no such line or it is no number.
    pub fn number(&self, key: &str) -> Result<f64> {
        let text = self.get(key).ok_or_else(|| anyhow!("the header has no line `# {key} = ...`"))?;
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| anyhow!("the header's {key} is {text:?}, not a number"))
    }

    /// A number of the header that is more than 0.
    ///
    /// # Errors
    /// When the header has no such line or it is another number, or none.
    pub fn positive(&self, key: &str) -> Result<f64> {
        match self.number(key)? {
            number if number > 0.0 => Ok(number),
            number => bail!("the header's {key} is {number}; it must be more than 0"),
        }
    }

    /// The text of the file.
    #[must_use]
    pub fn to_text(&self) -> String {
        header_text(&self.header) + COLUMNS + "\n" + &data_lines(&self.samples)
    }

    /// Takes a file's text apart.
    ///
    /// # Errors
    /// With the line of what is wrong, or when the CRC does not fit the data.
    pub fn from_text(text: &str) -> Result<TargetFile> {
        let mut file = TargetFile { header: Vec::new(), samples: Vec::new() };
        let mut lines = text.lines().enumerate();
        loop {
            let Some((number, line)) = lines.next() else {
                bail!("the file ends before its data: it has no line `{COLUMNS}`");
            };
            if line == COLUMNS {
                break;
            }
            // A file that has been through many systems may end its lines with more than one CR.
            let pair = line.trim_end_matches('\r').strip_prefix("# ").and_then(|line| line.split_once(" = "));
            let Some((key, value)) = pair else {
                bail!("line {}: expected `# key = value` or `{COLUMNS}`, found {line:?}", number + 1);
            };
            file.header.push((key.to_owned(), value.to_owned()));
        }
        match file.get("format") {
            Some(FORMAT) => {
                file.samples = lines.map(|(number, line)| sample_of(number, line)).collect::<Result<_>>()?;
                file.check_crc()?;
            }
            Some(stream_file::FORMAT) => file.samples = stream_file::samples(lines, text.ends_with('\n'))?,
            Some(other) => {
                bail!("its format is {other:?}; this program reads {FORMAT:?} and {:?}", stream_file::FORMAT)
            }
            None => bail!("it is no TARGET file: its header has no `# format = {FORMAT}`"),
        }
        Ok(file)
    }

    /// The sample period that the board has measured, us; of a stream, which has no measured one, that asked for.
    ///
    /// # Errors
    /// When the header does not have it.
    pub fn period_us(&self) -> Result<f64> {
        self.positive(if self.is_streamed() { "sample_period_us" } else { "measured_period_us" })
    }

    /// Whether it was streamed, and not downloaded.
    #[must_use]
    pub fn is_streamed(&self) -> bool {
        self.get("format") == Some(stream_file::FORMAT)
    }

    fn check_crc(&self) -> Result<()> {
        let stated = self.get("crc32").ok_or_else(|| anyhow!("the header has no crc32"))?;
        let actual = format!("{:08x}", crc32(&data_lines(&self.samples)));
        if stated != actual {
            bail!("its data are damaged or cut: the CRC is {actual}, the header says {stated}");
        }
        Ok(())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// With the file and the line of what is wrong.
    pub fn read(path: &Path) -> Result<TargetFile> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let Ok(text) = String::from_utf8(bytes) else {
            bail!("{} is no text: it is neither a TARGET file nor a run folder", path.display());
        };
        TargetFile::from_text(&text).with_context(|| path.display().to_string())
    }

    /// Writes the file under the next free number in a folder, and tells its path.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn write_next(&self, folder: &Path) -> Result<PathBuf> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let staged = Staged::write(folder, "TARGET", &[self.to_text().as_bytes()])
            .with_context(|| format!("cannot write a TARGET file into {}", folder.display()))?;
        let path = place(staged.path(), folder)?;
        sync_folder(folder);
        Ok(path)
    }
}

/// Gives a whole file the first free name. A link never replaces what is there.
fn place(partial: &Path, folder: &Path) -> Result<PathBuf> {
    for number in 1..=999 {
        let path = folder.join(format!("TARGET{number:02}.DAT"));
        match fs::hard_link(partial, &path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            // A file system without links: a name that is free now is taken by renaming.
            Err(_) if !path.exists() => {
                fs::rename(partial, &path).with_context(|| format!("cannot write {}", path.display()))?;
                return Ok(path);
            }
            Err(_) => {}
        }
    }
    bail!("{} holds TARGET01.DAT to TARGET999.DAT; move some away", folder.display())
}

/// Header lines that tell which rig and which parameters the samples of a file are of. Parameters that the
/// firmware does not have are left out.
pub(crate) fn described(
    format: &str,
    test: &str,
    info: &Info,
    parameters: &RigParameters,
) -> Vec<(String, String)> {
    let RigParameters { values, lacking } = parameters;
    let get = |id: u16| f64::from(values.get(id).unwrap_or(0));
    let full_scale = f64::from((1u32 << values.get(id::SENSOR_BITS).unwrap_or(12)) - 1);
    let scale = |min: u16, max: u16| (get(max) - get(min)) / full_scale;
    let mut header: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| header.push((key.to_owned(), value));
    put("format", format.to_owned());
    // A header is lines: a name with a line break in it would make a file that cannot be read.
    put("test", cleaned(test, NAME));
    put("firmware", cleaned(&info.firmware, NAME));
    put("build", cleaned(&info.build, NAME));
    put("sample_period_us", format!("{}", get(id::PERIOD_US)));
    put("mm_per_count", format!("{}", get(id::ENCODER_PM_PER_COUNT) / 1e9));
    put("pressure_scale_pa", format!("{}", scale(id::PRESSURE_MIN_PA, id::PRESSURE_MAX_PA)));
    put("pressure_offset_pa", format!("{}", get(id::PRESSURE_MIN_PA)));
    put("spool_scale_mm", format!("{}", scale(id::SPOOL_MIN_NM, id::SPOOL_MAX_NM) / 1e6));
    put("spool_offset_mm", format!("{}", get(id::SPOOL_MIN_NM) / 1e6));
    for parameter in TABLE.iter().filter(|parameter| !lacking.contains(&parameter.id)) {
        put(&format!("param.{}", parameter.name), parameter_text(values, parameter.id, parameter.len));
    }
    header
}

/// The text of header lines.
pub(crate) fn header_text(header: &[(String, String)]) -> String {
    header.iter().map(|(key, value)| format!("# {key} = {value}\n")).collect()
}

/// A sample under its index k.
fn numbered(index: i64, sample: RecordedSample) -> Result<(i32, RecordedSample)> {
    let index = i32::try_from(index)
        .map_err(|_| anyhow!("sample {index} is beyond the last that a file counts, {}", i32::MAX))?;
    Ok((index, sample))
}

/// The value of a parameter; equal entries at the end of a list are said once, as in a rig file.
pub(crate) fn parameter_text(parameters: &Parameters, first: u16, len: u16) -> String {
    let values: Vec<i32> = (first..first + len).filter_map(|id| parameters.get(id)).collect();
    let last = values.last().copied().unwrap_or(0);
    let repeated = values.iter().rev().take_while(|&&value| value == last).count();
    let kept = values.len() - repeated + 1;
    values[..kept.min(values.len())].iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

fn data_lines(samples: &[(i32, RecordedSample)]) -> String {
    samples.iter().map(|(index, sample)| data_line(i64::from(*index), sample)).collect()
}

/// A sample's line, with its LF.
pub(crate) fn data_line(index: i64, s: &RecordedSample) -> String {
    let RecordedSample { position, pressure_1, pressure_2, command, error, spool } = s;
    format!("{index},{position},{pressure_1},{pressure_2},{command},{error},{spool}\n")
}

/// The sample of a line, whose number counts from 0.
pub(crate) fn sample_of(number: usize, line: &str) -> Result<(i32, RecordedSample)> {
    fields(line).ok_or_else(|| anyhow!("line {}: expected seven whole numbers, found {line:?}", number + 1))
}

fn fields(line: &str) -> Option<(i32, RecordedSample)> {
    let mut fields = line.split(',');
    let mut next = || fields.next();
    let index = next()?.parse().ok()?;
    let sample = RecordedSample {
        position: next()?.parse().ok()?,
        pressure_1: next()?.parse().ok()?,
        pressure_2: next()?.parse().ok()?,
        command: next()?.parse().ok()?,
        error: next()?.parse().ok()?,
        spool: next()?.parse().ok()?,
    };
    fields.next().is_none().then_some((index, sample))
}

fn crc32(data: &str) -> u32 {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(data.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::client::RecordHead;

    fn file() -> TargetFile {
        let samples = (0..4).map(|i| RecordedSample {
            position: 8192 + i,
            pressure_1: 1332,
            pressure_2: 1638,
            command: -3,
            error: 5,
            spool: 2047,
        });
        let head = RecordHead {
            test: "servo-b".to_owned(),
            samples: 4,
            decimation: 2,
            pre_trigger: 2,
            first_index: -3,
            measured_period_ns: 1_300_250,
            mean_spool_raw: 2047,
            crc32: 0,
        };
        let record = Record { head, samples: samples.collect() };
        let info = Info {
            version: 1,
            firmware: "pneudrive 0.1.0".to_owned(),
            build: "test".to_owned(),
            board: "virtual".to_owned(),
            record_capacity: 4389,
        };
        TargetFile::new(&record, &info, &RigParameters::default()).expect("counted")
    }

    /// The whole text: whoever reads these files reads it so.
    #[test]
    fn the_text_is_the_fixed_format() {
        let text = file().to_text();
        let expected_start = "\
# format = pneudrive-target 1
# test = servo-b
# firmware = pneudrive 0.1.0
# build = test
# sample_period_us = 1300
# measured_period_us = 1300.25
# decimation = 2
# pre_trigger = 2
# mm_per_count = 0.01205
# pressure_scale_pa = 244.2002442002442
# pressure_offset_pa = 0
# spool_scale_mm = 0.0006105006105006105
# spool_offset_mm = -1.25
# mean_spool_raw = 2047
# param.period_us = 1300
";
        assert!(text.starts_with(expected_start), "{text}");
        let expected_end = "\
# param.gain_profile = 8192,6144,4096,2048,1280,768,512,384,320,288,256
# crc32 = cab50838
index,position_counts,pressure_1_raw,pressure_2_raw,dac_counts,error_counts,spool_raw
-3,8192,1332,1638,-3,5,2047
-1,8193,1332,1638,-3,5,2047
0,8194,1332,1638,-3,5,2047
2,8195,1332,1638,-3,5,2047
";
        assert!(text.ends_with(expected_end), "{text}");
    }

    #[test]
    fn what_was_written_is_read_again() {
        assert_eq!(TargetFile::from_text(&file().to_text()).expect("whole"), file());
    }

    #[test]
    fn every_cut_and_every_changed_digit_is_noticed() {
        let text = file().to_text();
        for end in 0..text.len() - 1 {
            assert!(TargetFile::from_text(&text[..end]).is_err(), "cut after {end} bytes");
        }
        let data = text.find("index,").expect("a header") + COLUMNS.len() + 1;
        for (at, digit) in text.char_indices().skip(data).filter(|(_, c)| c.is_ascii_digit()) {
            let other = if digit == '7' { "8" } else { "7" };
            let changed = format!("{}{other}{}", &text[..at], &text[at + 1..]);
            assert!(TargetFile::from_text(&changed).is_err(), "changed digit at {at}");
        }
    }

    #[test]
    fn ends_of_lines_belong_to_no_value() {
        let text = file().to_text().replacen("# test = servo-b\n", "# test = servo-b\r\r\n", 1);
        assert_eq!(TargetFile::from_text(&text).expect("whole").get("test"), Some("servo-b"));
    }

    #[test]
    fn foreign_files_are_refused_by_what_they_are() {
        let error = |text: &str| format!("{:#}", TargetFile::from_text(text).expect_err("foreign"));
        assert!(error("").contains("ends before its data"));
        assert!(error("time_s,position_m\n0,1\n").contains("line 1"));
        let later = file().to_text().replace("pneudrive-target 1", "pneudrive-target 9");
        assert!(error(&later).contains("pneudrive-target 9"));
    }

    #[test]
    fn files_get_the_next_free_number_and_never_replace_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = |path: PathBuf| path.file_name().expect("a name").to_string_lossy().into_owned();
        assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET01.DAT");
        fs::write(folder.path().join("TARGET02.DAT"), "mine").expect("written");
        assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET03.DAT");
        for number in 4..=99 {
            fs::write(folder.path().join(format!("TARGET{number:02}.DAT")), "").expect("written");
        }
        assert_eq!(name(file().write_next(folder.path()).expect("written")), "TARGET100.DAT");
        assert_eq!(fs::read_to_string(folder.path().join("TARGET02.DAT")).expect("there"), "mine");
        let left = fs::read_dir(folder.path()).expect("a folder").filter_map(Result::ok);
        assert!(left.map(|entry| entry.file_name()).all(|name| !name.to_string_lossy().contains("partial")));
    }
}
