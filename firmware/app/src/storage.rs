//! The configuration in flash.
//!
//! Parameters are stored as (id `u16`, value `i32`) pairs, never as structs. So an older set is
//! migrated, never dropped: an id that it lacks keeps its default, an id that today's table does not
//! know is left out and counted, and so is a value outside today's range. The table of move records is part of it
//! ([`move_records`](crate::move_records)).
//!
//! Two slots hold the configuration. A power cut at any operation of a save leaves the old one or the
//! new one whole. Flash is written only while the drive is disarmed: an erase stalls the processor.

pub(crate) mod marks;
mod slots;
mod stream;

use core::ops::Range;

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::SetError;
use pneudrive_protocol::RecordCrc;

use crate::move_records::{MAX_PAIRS, MoveRecords};
pub(crate) use slots::{Found, Record, Slots};
pub use slots::{LayoutError, SaveError};

const MAGIC: [u8; 4] = *b"PDcf";

/// Format in which a configuration is saved. A new one gets the next number, a line in
/// [`ConfigStore::load`] and a test with its bytes.
pub const FORMAT: u16 = 1;

/// Format 1: id, then value, little endian.
const PAIR_BYTES: usize = 6;

/// The result of reading the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// No configuration was ever saved whole: the flash is blank, or its first save was cut short.
    NeverSaved,
    /// A configuration was loaded.
    Loaded(Report),
    /// There was a configuration, but no slot can be read. Flash that held other data looks the same.
    Damaged,
    /// The newest configuration is in this format of a later program.
    UnknownFormat(u16),
}

/// How a configuration was loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Format it was saved in.
    pub format: u16,
    /// The number of saves, wrapping.
    pub generation: u32,
    /// Pairs whose id today's table does not know: left out.
    pub unknown: u16,
    /// Ids of today's table that it lacks: they keep their defaults.
    pub missing: u16,
    /// Pairs whose value is outside today's range: the ids keep their defaults. And move records with a profile that today's
    /// firmware does not know: they are left out.
    pub out_of_range: u16,
    /// The first id whose value is outside today's range.
    pub first_out_of_range: Option<u16>,
    /// The other slot can't be read. It may have held a newer configuration.
    pub other_damaged: bool,
}

/// The parameters to start with, and where they come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Load {
    /// The values of the flash over the defaults; the defaults alone unless the outcome is `Loaded`. Each is in its
    /// range; [`Config::new`](pneudrive_controller::Config::new) checks whether they fit together.
    pub parameters: Parameters,
    /// The move records of the flash; none unless the outcome is `Loaded`.
    pub records: MoveRecords,
    /// The outcome.
    pub outcome: Outcome,
}

/// Where the configuration is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigStore {
    slots: Slots,
}

impl ConfigStore {
    /// A store in two ranges of whole erase sectors, bytes from the start of the flash. Nothing is read
    /// or written yet.
    ///
    /// Read and write sizes of the flash must divide 32 bytes, and 32 its erase size; another flash does
    /// not compile.
    ///
    /// # Errors
    /// When the ranges can't hold two copies of today's configuration.
    pub fn new<F: NorFlash>(flash: &F, slots: [Range<u32>; 2]) -> Result<ConfigStore, LayoutError> {
        let pairs = Parameters::default().iter().count();
        Ok(ConfigStore { slots: Slots::new(flash, MAGIC, slots, (pairs + MAX_PAIRS) * PAIR_BYTES)? })
    }

    /// Loads the newest whole configuration. Unreadable data count as damaged.
    pub fn load<F: ReadNorFlash>(&self, flash: &mut F) -> Load {
        let record = match self.slots.find(flash) {
            Found::NeverSaved => return Load::defaults(Outcome::NeverSaved),
            Found::Damaged => return Load::defaults(Outcome::Damaged),
            Found::Whole(record) => record,
        };
        match record.header.format {
            1 => self.load_format_1(flash, &record),
            later => Load::defaults(Outcome::UnknownFormat(later)),
        }
    }

    #[cold]
    #[inline(never)]
    fn load_format_1<F: ReadNorFlash>(&self, flash: &mut F, record: &Record) -> Load {
        let mut taken = StoredConfiguration::new(record);
        let whole = self.slots.read(flash, record, |[i0, i1, v0, v1, v2, v3]| {
            taken.pair(u16::from_le_bytes([i0, i1]), i32::from_le_bytes([v0, v1, v2, v3]));
        });
        if whole { taken.loaded() } else { Load::defaults(Outcome::Damaged) }
    }

    /// Saves parameters and move records, and tells how many saves there were, wrapping. Only while disarmed: it erases
    /// a slot, and takes as long as that takes.
    ///
    /// # Errors
    /// When the flash refuses or does not hold the written data. The configuration saved before is whole then.
    pub fn save<F: NorFlash>(
        &self,
        flash: &mut F,
        parameters: &Parameters,
        records: &MoveRecords,
    ) -> Result<u32, SaveError<F::Error>> {
        self.slots.save(flash, FORMAT, || parameters.iter().chain(records.pairs()).map(pair_bytes))
    }
}

/// The fingerprint of parameters: CRC-32 (ISO-HDLC) of their pairs in the order of the table, as they
/// are stored. Equal on every execution level for equal parameters of equal tables.
#[must_use]
pub fn configuration_hash(parameters: &Parameters) -> u32 {
    hash_of(parameters.iter())
}

/// The same of some of them.
pub(crate) fn hash_of(parameters: impl Iterator<Item = (u16, i32)>) -> u32 {
    let mut crc = RecordCrc::new();
    parameters.for_each(|pair| crc.update(&pair_bytes(pair)));
    crc.finish()
}

fn pair_bytes((id, value): (u16, i32)) -> [u8; PAIR_BYTES] {
    let [i0, i1] = id.to_le_bytes();
    let [v0, v1, v2, v3] = value.to_le_bytes();
    [i0, i1, v0, v1, v2, v3]
}

impl Load {
    /// The start of a drive without a stored configuration.
    pub(crate) fn defaults(outcome: Outcome) -> Load {
        Load { parameters: Parameters::default(), records: MoveRecords::default(), outcome }
    }
}

/// Pairs taken over so far.
struct StoredConfiguration {
    parameters: Parameters,
    records: MoveRecords,
    report: Report,
}

impl StoredConfiguration {
    fn new(record: &Record) -> StoredConfiguration {
        let parameters = Parameters::default();
        let report = Report {
            format: record.header.format,
            generation: record.header.generation,
            missing: parameters.iter().count() as u16,
            other_damaged: record.other_damaged,
            ..Report::default()
        };
        StoredConfiguration { parameters, records: MoveRecords::default(), report }
    }

    #[cold]
    #[inline(never)]
    fn pair(&mut self, id: u16, value: i32) {
        if self.records.take(id, value) {
            return;
        }
        let set = self.parameters.set(id, value);
        let report = &mut self.report;
        if set == Err(SetError::UnknownId) {
            report.unknown = report.unknown.saturating_add(1);
            return;
        }
        report.missing = report.missing.saturating_sub(1);
        if set == Err(SetError::OutOfRange) {
            report.out_of_range = report.out_of_range.saturating_add(1);
            report.first_out_of_range = report.first_out_of_range.or(Some(id));
        }
    }

    fn loaded(self) -> Load {
        let StoredConfiguration { parameters, mut records, mut report } = self;
        report.out_of_range = report.out_of_range.saturating_add(records.sift());
        Load { parameters, records, outcome: Outcome::Loaded(report) }
    }
}
