//! The data that a board keeps through a reset and a power cut: the configuration and the fault log.

use core::borrow::BorrowMut;
use core::ops::Range;

use embedded_storage::nor_flash::NorFlash;
use pneudrive_controller::Parameters;
use pneudrive_protocol::session::NO_BOOT;

use crate::fault_log::{Event, FaultLog, FaultStore, Memory, Recovery, Restored};
use crate::move_records::MoveRecords;
use crate::storage::{ConfigStore, LayoutError, Load, Outcome};

/// The flash could not be written, or did not hold the written data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotStored;

/// The store of a board. Everything but [`Store::log`] is for a disarmed drive: flash stalls the processor.
pub trait Store {
    /// The configuration to start with.
    fn load(&mut self) -> Load;

    /// The number of this boot: different for each, whatever ended the one before. [`NO_BOOT`]: what is kept cannot
    /// tell.
    fn boot(&self) -> u32;

    /// Stores the configuration; returns the number of saves, wrapping.
    ///
    /// # Errors
    /// When it is not stored; the one before is whole then.
    fn save(&mut self, parameters: &Parameters, records: &MoveRecords) -> Result<u32, NotStored>;

    /// Logs a fault: its code, sample, position (counts) and time since the reset (us). Takes the time of
    /// one event, in memory.
    fn log(&mut self, code: u8, index: u32, position: i32, time_us: u64);

    /// The nth event of the log; 0 is the newest.
    fn event(&self, nth: usize) -> Option<Event>;

    /// How many events there are.
    fn events(&self) -> usize;

    /// Stores the events logged since the last time.
    ///
    /// # Errors
    /// When it is not stored; it stays in memory.
    fn flush(&mut self) -> Result<(), NotStored>;
}

/// A board without flash. By default it cannot tell its boots apart.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStore {
    /// The number of this boot.
    pub boot: u32,
}

impl Store for NoStore {
    fn load(&mut self) -> Load {
        Load::defaults(Outcome::NeverSaved)
    }

    fn boot(&self) -> u32 {
        self.boot
    }

    fn save(&mut self, _: &Parameters, _: &MoveRecords) -> Result<u32, NotStored> {
        Err(NotStored)
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

/// The layout of a flash: byte ranges of whole sectors, two for the configuration and two for the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The slots of the configuration.
    pub config: [Range<u32>; 2],
    /// The slots of the fault log.
    pub faults: [Range<u32>; 2],
}

/// A flash, and memory that a reset leaves as it is.
#[derive(Debug)]
pub struct FlashStore<F, M> {
    flash: F,
    config: ConfigStore,
    faults: FaultStore,
    log: FaultLog<M>,
    boot: u32,
}

impl<F: NorFlash, M: BorrowMut<Memory>> FlashStore<F, M> {
    /// Loads everything after a reset, counts the boot, and reports the state of the log.
    ///
    /// # Errors
    /// When the layout does not fit the flash.
    pub fn take_up(
        mut flash: F,
        layout: Layout,
        memory: M,
    ) -> Result<(Self, Recovery, Restored), LayoutError> {
        let config = ConfigStore::new(&flash, layout.config)?;
        let faults = FaultStore::new(&flash, layout.faults)?;
        let (mut log, recovery) = FaultLog::recover(memory);
        let restored = log.restore(&faults, &mut flash);
        let boot = log.count_boot(&faults, &mut flash).unwrap_or(NO_BOOT);
        Ok((FlashStore { flash, config, faults, log, boot }, recovery, restored))
    }

    /// The data that a reset leaves as they are: the flash and the memory.
    pub fn into_parts(self) -> (F, M) {
        (self.flash, self.log.into_memory())
    }

    /// The flash, to be looked at.
    #[must_use]
    pub fn flash(&self) -> &F {
        &self.flash
    }
}

impl<F: NorFlash, M: BorrowMut<Memory>> Store for FlashStore<F, M> {
    fn load(&mut self) -> Load {
        self.config.load(&mut self.flash)
    }

    fn boot(&self) -> u32 {
        self.boot
    }

    fn save(&mut self, parameters: &Parameters, records: &MoveRecords) -> Result<u32, NotStored> {
        self.config.save(&mut self.flash, parameters, records).map_err(|_| NotStored)
    }

    fn log(&mut self, code: u8, index: u32, position: i32, time_us: u64) {
        self.log.record(code, index, position, time_us);
    }

    fn event(&self, nth: usize) -> Option<Event> {
        self.log.nth_newest(nth)
    }

    fn events(&self) -> usize {
        self.log.events()
    }

    fn flush(&mut self) -> Result<(), NotStored> {
        self.log.flush(&self.faults, &mut self.flash).map(|_| ()).map_err(|_| NotStored)
    }
}
