//! The parameters in force, the controller's configuration, the move records, and their origin.

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::law::cascade::kept::{Kept, Learned};
use pneudrive_controller::parameters::{KEPT, id};
use pneudrive_controller::{Config, Parameters};

use crate::move_records::MoveRecords;
use crate::storage::{Load, Outcome, hash_of};
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
    config: Config,
    parameters: Parameters,
    hash: u32,
    /// The same without what the law keeps.
    hash_but_kept: u32,
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
        Ok(Prepared::made(parameters, config))
    }

    fn made(parameters: Parameters, config: Config) -> Prepared {
        let hash = hash_of(parameters.iter());
        let hash_but_kept = hash_of(parameters.iter().filter(|(id, _)| !KEPT.contains(id)));
        Prepared { parameters, config, hash, hash_but_kept }
    }

    /// The same, whose law keeps nothing.
    ///
    /// # Errors
    /// As for [`Prepared::of`].
    pub(crate) fn afresh(mut self) -> Result<Prepared, ConfigError> {
        for (id, value) in Kept::default().values() {
            let set = self.parameters.set(id, value);
            debug_assert_eq!(set, Ok(()), "{id}");
        }
        Prepared::of(self.parameters)
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
        Prepared::made(Parameters::default(), Config::default())
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
    /// The number of saves, and the fingerprint of the last one without what the law keeps.
    saves: u32,
    saved_hash: Option<u32>,
    ignored: u16,
    /// What was learned is to be stored once the drive rests, if it is worth it.
    learned: bool,
    /// The null offset that was saved last, counts or steps, and what was kept then of what the law has learned.
    saved_null: i16,
    saved_learned: Learned,
    /// Armings since the reset that have kept something, and from which one on that may be stored.
    carried: u32,
    due: u32,
}

/// Between two writes of what the law has learned there are no more armings than this.
const MOST_CARRIED: u32 = 4096;

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
        self.saved_hash = as_stored.then_some(prepared.hash_but_kept);
        self.saved_null = prepared.config.law.null_offset;
        self.saved_learned = Kept::of(&prepared.parameters).learned;
        self.in_force = prepared;
        self.records = records;
        true
    }

    /// Puts other parameters in force. What was learned is still stored by itself if they are the same, as with a new test alone.
    pub fn replace(&mut self, prepared: Prepared) {
        self.learned &= prepared.hash == self.in_force.hash;
        self.in_force = prepared;
    }

    /// Puts other move records in force. What was learned is no longer stored by itself if they differ: that would store the
    /// records as well, and nobody has asked for it. It waits for the next save.
    #[cold]
    #[inline(never)]
    pub(crate) fn replace_records(&mut self, records: MoveRecords) {
        let changed = records != self.records;
        self.records_changed |= changed;
        self.learned &= !changed;
        self.records = records;
    }

    /// Puts in force what was learned: these parameters otherwise equal those in force. If the earlier ones
    /// were stored, these will be, too (`save_learned`).
    pub fn learn(&mut self, learned: &Prepared) {
        self.learned |= self.is_saved();
        self.carried = self.carried.saturating_add(1);
        // A copy of the whole would keep the control interrupt waiting.
        let Prepared { parameters, config, hash, hash_but_kept } = &mut self.in_force;
        for id in KEPT.into_iter().chain([id::NULL_OFFSET_COUNTS]) {
            let taken = learned.parameters.get(id).map(|value| parameters.set(id, value));
            debug_assert_eq!(taken, Some(Ok(())), "{id}");
        }
        config.law.learn(&learned.config.law);
        (*hash, *hash_but_kept) = (learned.hash, learned.hash_but_kept);
    }

    /// Stores what was learned if the null offset has moved by at least a 512th of the largest command since the last save, or what
    /// the law keeps by as much as it says, because each save wears the flash. The latter is stored at the 1st, 4th, 16th arming after
    /// a reset and so on, and each 4096th at last: a load that wanders does not wear it out either. That the law begins afresh is stored
    /// at once, as what was stored before may be why. It is tried once: what cannot be stored is learned again after the next reset.
    ///
    /// # Errors
    /// As for [`Configuration::save`].
    #[cold]
    #[inline(never)]
    pub(crate) fn save_learned(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        if !self.learned || !(self.null_has_moved() || self.law_has_moved()) {
            return Ok(());
        }
        self.learned = false;
        self.save(store)
    }

    fn null_has_moved(&self) -> bool {
        let moved = self.config().law.null_offset.abs_diff(self.saved_null);
        moved >= (self.config().limits.largest_command.unsigned_abs() / 512).max(1)
    }

    fn law_has_moved(&self) -> bool {
        let kept = Kept::of(self.parameters());
        (kept.is_afresh() || self.carried >= self.due) && kept.is_worth_storing(&self.saved_learned)
    }

    /// Stores that the law of a drive which has tripped begins afresh, if it stands otherwise in the flash and the other parameters are
    /// those stored. In force stays what it has tripped with: its record is read with that.
    ///
    /// # Errors
    /// As for [`Configuration::save`].
    #[cold]
    #[inline(never)]
    pub(crate) fn save_afresh(&mut self, kept: &Kept, store: &mut impl Store) -> Result<(), NotStored> {
        if !(kept.is_afresh() && self.is_saved() && kept.is_worth_storing(&self.saved_learned)) {
            return Ok(());
        }
        let mut parameters = self.parameters().clone();
        for (id, value) in kept.values() {
            let set = parameters.set(id, value);
            debug_assert_eq!(set, Ok(()), "{id}");
        }
        self.saves = store.save(&parameters, &self.records)?;
        self.note_saved(kept.learned);
        Ok(())
    }

    /// Stores parameters and move records for the next reset.
    ///
    /// # Errors
    /// When they are not stored; the earlier save is intact then.
    #[cold]
    #[inline(never)]
    pub fn save(&mut self, store: &mut impl Store) -> Result<(), NotStored> {
        self.saves = store.save(self.parameters(), &self.records)?;
        self.note_saved(Kept::of(self.parameters()).learned);
        Ok(())
    }

    /// What the next reset would load are the parameters in force, but for what the law has kept.
    fn note_saved(&mut self, learned: Learned) {
        self.saved_hash = Some(self.in_force.hash_but_kept);
        self.saved_null = self.config().law.null_offset;
        self.saved_learned = learned;
        self.due = self.carried.saturating_add(self.carried.saturating_mul(3).clamp(1, MOST_CARRIED));
        self.records_changed = false;
        self.learned = false;
        self.source = Source::Stored;
        self.ignored = 0;
    }

    /// Whether the stored configuration is lost and nothing was stored since.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.source == Source::Damaged
    }

    /// Whether the next reset would load these parameters and move records, apart from what was learned.
    #[must_use]
    pub fn is_saved(&self) -> bool {
        (self.learned || self.saved_hash == Some(self.in_force.hash_but_kept)) && !self.records_changed
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

#[cfg(test)]
mod tests {
    use pneudrive_controller::choice::Adapt;
    use pneudrive_controller::parameters::id;

    use super::*;
    use crate::fault_log::Event;

    /// A store that takes everything.
    #[derive(Default)]
    struct Taking {
        saves: u32,
    }

    impl Store for Taking {
        fn load(&mut self) -> Load {
            Load::defaults(Outcome::NeverSaved)
        }
        fn boot(&self) -> u32 {
            1
        }
        fn save(&mut self, _: &Parameters, _: &MoveRecords) -> Result<u32, NotStored> {
            self.saves += 1;
            Ok(self.saves)
        }
        fn log(&mut self, _: u8, _: u32, _: i32, _: u64) {}
        fn event(&self, _: usize) -> Option<Event> {
            None
        }
        fn events(&self) -> usize {
            0
        }
        fn flush(&mut self) -> Result<(), NotStored> {
            Ok(())
        }
    }

    /// The saves of so many armings, the nth of which keeps this mass.
    fn saves(armings: u32, mass: impl Fn(u32) -> i32) -> u32 {
        let (mut configuration, mut store) = (Configuration::default(), Taking::default());
        configuration.save(&mut store).expect("taken");
        for arming in 1..=armings {
            let mut learned = configuration.parameters().clone();
            for (id, value) in [(id::ADAPT, Adapt::Kept as i32), (id::KEPT_MASS, mass(arming))] {
                learned.set(id, value).expect("in range");
            }
            configuration.learn(&Prepared::of(learned).expect("they go together"));
            configuration.save_learned(&mut store).expect("taken");
        }
        store.saves - 1
    }

    /// A sector bears 10,000 erases, and each save erases one of two slots.
    #[test]
    fn a_load_that_is_another_one_at_each_arming_does_not_wear_the_flash_out() {
        let wandering = |arming| if arming % 2 == 0 { 65_536 } else { 85_000 };
        assert_eq!(
            saves(20_000, wandering),
            2 * 10,
            "at ever rarer armings, and at each one behind that begins afresh"
        );
        assert_eq!(saves(20_000, |arming| 65_536 + arming as i32 % 4000), 0, "less than a 16th");
    }
}
