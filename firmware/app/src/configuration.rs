//! The parameters in force, the controller's configuration, the move records, and their origin.

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Parameters};

use crate::move_records::MoveRecords;
use crate::storage::{Load, Outcome, configuration_hash};
use crate::store::{NotStored, Store};

/// Where the parameters come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Source {
    /// None were ever stored: the thesis's parameters, or those set since.
    #[default]
    NeverSaved,
    /// As stored.
    Stored,
    /// Stored by another version of the firmware, and taken over.
    TakenOver,
    /// The stored ones are damaged or contradict each other.
    Damaged,
}

/// Parameters that fit together, the controller's configuration from them, and their fingerprint. Making one takes
/// tens of thousands of instructions, putting it in force few. By default the thesis's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prepared {
    parameters: Parameters,
    config: Config,
    hash: u32,
}

impl Prepared {
    /// Of these parameters.
    ///
    /// # Errors
    /// When they do not go together.
    #[cold]
    #[inline(never)]
    pub fn of(parameters: Parameters) -> Result<Prepared, ConfigError> {
        let config = Config::new(&parameters)?;
        let hash = configuration_hash(&parameters);
        Ok(Prepared { parameters, config, hash })
    }

    /// The parameters, by id.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The controller's configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }
}

impl Default for Prepared {
    fn default() -> Self {
        let parameters = Parameters::default();
        let hash = configuration_hash(&parameters);
        Prepared { parameters, config: Config::default(), hash }
    }
}

/// The configuration of the drive. By default the thesis's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Configuration {
    in_force: Prepared,
    records: MoveRecords,
    /// The records are not those that were saved last.
    records_changed: bool,
    source: Source,
    /// The number of saves, and the fingerprint of the last one.
    saves: u32,
    saved_hash: Option<u32>,
    ignored: u16,
    /// The learned null offset is to be stored once the drive rests, if it is worth it.
    learned: bool,
    /// The null offset that was saved last, counts or steps.
    saved_null: i16,
}

impl Configuration {
    /// Loads the stored configuration after a reset. Returns false if it is lost: the thesis's parameters are in
    /// force then, and the drive must not run on them.
    #[cold]
    #[inline(never)]
    pub fn take_up(&mut self, store: &mut impl Store) -> bool {
        let Load { parameters, records, outcome } = store.load();
        let report = match outcome {
            Outcome::NeverSaved => return true,
            Outcome::Damaged | Outcome::UnknownFormat(_) => None,
            Outcome::Loaded(report) => Some(report),
        };
        let Some((report, prepared)) = report.zip(Prepared::of(parameters).ok()) else {
            self.source = Source::Damaged;
            return false;
        };
        self.ignored = report.unknown.saturating_add(report.out_of_range);
        let as_stored = self.ignored == 0 && report.missing == 0;
        self.source = if as_stored { Source::Stored } else { Source::TakenOver };
        self.saves = report.generation;
        self.saved_hash = as_stored.then_some(prepared.hash);
        self.saved_null = prepared.config.law.null_offset;
        self.in_force = prepared;
        self.records = records;
        true
    }

    /// Puts other parameters in force. A learned null offset is still stored by itself if they are the same, as with a new test alone.
    pub fn replace(&mut self, prepared: Prepared) {
        self.learned &= prepared.hash == self.in_force.hash;
        self.in_force = prepared;
    }

    /// Puts other move records in force. A learned null offset is no longer stored by itself if they differ: that would store the
    /// records as well, and nobody has asked for it. It waits for the next save.
    #[cold]
    #[inline(never)]
    pub(crate) fn replace_records(&mut self, records: MoveRecords) {
        let changed = records != self.records;
        self.records_changed |= changed;
        self.learned &= !changed;
        self.records = records;
    }

    /// Puts the learned null offset in force: these parameters otherwise equal those in force. If the earlier ones
    /// were stored, these will be, too (`save_learned`).
    pub fn learn(&mut self, learned: &Prepared) {
        self.learned |= self.is_saved();
        // A copy of the whole would keep the control interrupt waiting.
        let Prepared { parameters, config, hash } = &mut self.in_force;
        let null_offset = learned.config.law.null_offset;
        if parameters.set(id::NULL_OFFSET_COUNTS, null_offset.into()).is_ok() {
            config.law.null_offset = null_offset;
            *hash = learned.hash;
        }
    }

    /// Stores the learned null offset if it has moved by at least a 512th of the largest command since the last save,
    /// because each save wears the flash. It is tried once: an offset that cannot be stored is learned again after
    /// the next reset.
    ///
    /// # Errors
    /// As for [`Configuration::save`].
    #[cold]
    #[inline(never)]
    pub(crate) fn save_learned(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        let moved = self.config().law.null_offset.abs_diff(self.saved_null);
        let worth = self.config().limits.largest_command.unsigned_abs() / 512;
        if !self.learned || moved < worth.max(1) {
            return Ok(());
        }
        self.learned = false;
        self.save(store)
    }

    /// Stores parameters and move records for the next reset.
    ///
    /// # Errors
    /// When they are not stored; the earlier save is intact then.
    #[cold]
    #[inline(never)]
    pub fn save(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        self.saves = store.save(self.parameters(), &self.records)?;
        self.saved_hash = Some(self.hash());
        self.saved_null = self.config().law.null_offset;
        self.records_changed = false;
        self.learned = false;
        self.source = Source::Stored;
        self.ignored = 0;
        Ok(())
    }

    /// Whether the stored configuration is lost and nothing was stored since.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.source == Source::Damaged
    }

    /// Whether the next reset would load these parameters and move records, apart from the learned null offset.
    #[must_use]
    pub fn is_saved(&self) -> bool {
        (self.learned || self.saved_hash == Some(self.hash())) && !self.records_changed
    }

    /// The move records.
    #[must_use]
    pub fn records(&self) -> &MoveRecords {
        &self.records
    }

    /// The parameters, by id.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.in_force.parameters
    }

    /// The controller's configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.in_force.config
    }

    /// Where the parameters come from.
    #[must_use]
    pub fn source(&self) -> Source {
        self.source
    }

    /// Number of saves, wrapping.
    #[must_use]
    pub fn saves(&self) -> u32 {
        self.saves
    }

    /// Stored values that were ignored: ids or values that this firmware does not know.
    #[must_use]
    pub fn ignored(&self) -> u16 {
        self.ignored
    }

    /// The fingerprint of the parameters in force.
    #[must_use]
    pub fn hash(&self) -> u32 {
        self.in_force.hash
    }
}
