//! The last hundred faults, kept through resets and power cuts.
//!
//! The log is in memory that a reset leaves as it is. Each event has a CRC-32 of its own there. So logging takes the
//! time of one event, and a reset in the middle of it loses only that event. While the drive is disarmed,
//! [`FaultLog::flush`] copies new events to flash, for power cuts: each event as a mark in the free part of the log's
//! slots. Only when there is no room for marks is the log saved anew, which erases a slot.
//!
//! The log also counts the boots, in that memory and as marks. So each boot has a different number, also after a
//! power cut.
//!
//! At boot call [`FaultLog::recover`], then [`FaultLog::restore`] and [`FaultLog::count_boot`], and only then log the
//! first event.

mod mark;

use core::borrow::BorrowMut;
use core::ops::Range;

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
pub use pneudrive_protocol::Event;
use pneudrive_protocol::RecordCrc;

use crate::storage::{Found, LayoutError, Record, SaveError, Slots, marks};

/// Events that are kept.
pub const EVENTS: usize = 100;

const MAGIC: [u8; 4] = *b"PDfl";
const FORMAT: u16 = 1;
const CRC_BYTES: usize = 4;
const BOOT_BYTES: usize = 4 + CRC_BYTES;
const PLACE_BYTES: usize = Event::BYTES + CRC_BYTES;

/// Length of a full log in flash, bytes.
const LOG_BYTES: usize = EVENTS * Event::BYTES;

/// Length of the memory, bytes.
pub const MEMORY_BYTES: usize = BOOT_BYTES + EVENTS * PLACE_BYTES;

/// The memory that the log stands in. A board puts it where a reset does not clear it. Any bytes may
/// stand in it.
pub type Memory = [u8; MEMORY_BYTES];

/// The contents of the memory after a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recovery {
    /// Nothing that can be read: the power was off, or the memory is damaged. The log starts empty.
    Lost,
    /// The log.
    Kept {
        /// Events that are whole.
        events: usize,
        /// Places whose CRC is wrong: left out.
        damaged: usize,
    },
}

/// The contents of the flash after a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restored {
    /// No log was ever flushed whole.
    NeverSaved,
    /// The memory had events of its own, and they stay.
    NotNeeded,
    /// This many events came from flash.
    Events(usize),
    /// There was a log, and no copy of it can be read.
    Damaged,
    /// It is in this format of a later program.
    UnknownFormat(u16),
}

/// Where in flash the log is flushed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultStore {
    slots: Slots,
}

impl FaultStore {
    /// A store in two ranges of whole erase sectors, bytes from the start of the flash; for which flash, see
    /// [`ConfigStore::new`](crate::storage::ConfigStore::new).
    ///
    /// # Errors
    /// When the ranges can't hold two copies of the log.
    pub fn new<F: NorFlash>(flash: &F, slots: [Range<u32>; 2]) -> Result<FaultStore, LayoutError> {
        Ok(FaultStore { slots: Slots::new(flash, MAGIC, slots, LOG_BYTES)? })
    }
}

/// The log, over its memory: owned, or borrowed from wherever the board has put it.
#[derive(Debug)]
pub struct FaultLog<M> {
    memory: M,
    boot: u32,
    next: u32,
    /// Places that hold a whole event, one bit each. Places read after this was made are not checked again.
    whole: u128,
    /// The newest event in flash.
    flushed: Option<Event>,
    /// Whether the flash holds the number of this boot.
    counted: bool,
}

impl<M: BorrowMut<Memory>> FaultLog<M> {
    /// Takes the log up again after a reset, with everything whole in the memory, and counts the reset.
    #[cold]
    #[inline(never)]
    pub fn recover(memory: M) -> (Self, Recovery) {
        let mut log = FaultLog { memory, boot: 1, next: 0, whole: 0, flushed: None, counted: false };
        let damaged = log.drop_damaged();
        let stored_boot = log.stored_boot();
        let newest = log.places().filter_map(whole_event).max_by_key(|event| event.number);
        let boot = stored_boot.max(newest.map(|event| event.boot));
        log.next = newest.map_or(0, |event| event.number.wrapping_add(1));
        log.set_boot(boot.unwrap_or(0).wrapping_add(1));
        let recovery = match boot {
            None => Recovery::Lost,
            Some(_) => Recovery::Kept { events: log.events(), damaged },
        };
        (log, recovery)
    }

    /// The memory, as a reset leaves it.
    pub fn into_memory(self) -> M {
        self.memory
    }

    /// Takes over the flushed events if the memory holds none. Call it once after a reset, before the first event:
    /// numbers continue from those in flash.
    #[cold]
    #[inline(never)]
    pub fn restore<F: ReadNorFlash>(&mut self, store: &FaultStore, flash: &mut F) -> Restored {
        let record = match store.slots.find(flash) {
            Found::NeverSaved => return Restored::NeverSaved,
            Found::Damaged => return Restored::Damaged,
            Found::Whole(record) => record,
        };
        match record.header.format {
            1 => self.restore_format_1(store, flash, &record),
            later => Restored::UnknownFormat(later),
        }
    }

    #[cold]
    #[inline(never)]
    fn restore_format_1<F: ReadNorFlash>(
        &mut self,
        store: &FaultStore,
        flash: &mut F,
        record: &Record,
    ) -> Restored {
        let needed = self.newest().is_none();
        let mut newest = None;
        let whole = store.slots.read(flash, record, |bytes| {
            let event = Event::from_bytes(&bytes);
            newest = Some(event);
            if needed {
                self.put(&event);
            }
        });
        if !whole {
            if needed {
                self.forget();
            }
            return Restored::Damaged;
        }
        let [kept, _] = store.slots.free_parts(flash, LOG_BYTES);
        for event in marks::all(flash, kept).filter_map(|found| mark::event(&found)) {
            if newest.is_none_or(|newest: Event| newest.number < event.number) {
                newest = Some(event);
                if needed {
                    self.put(&event);
                }
            }
        }
        self.flushed = newest;
        match newest {
            Some(newest) if needed => self.go_on_after(&newest),
            _ => Restored::NotNeeded,
        }
    }

    fn go_on_after(&mut self, newest: &Event) -> Restored {
        self.next = newest.number.wrapping_add(1);
        self.set_boot(self.boot.max(newest.boot.wrapping_add(1)));
        Restored::Events(self.events())
    }

    /// Logs a fault: its code, the index k of the sample, the position in counts, and the microseconds since
    /// the reset. The oldest of more than a hundred makes room.
    pub fn record(&mut self, code: u8, index: u32, position: i32, time_us: u64) -> Event {
        let event = Event { number: self.next, boot: self.boot, time_us, index, position, code };
        self.put(&event);
        self.next = self.next.wrapping_add(1);
        event
    }

    /// The events, the newest first. One that was damaged is left out.
    pub fn newest_first(&self) -> impl Iterator<Item = Event> + '_ {
        self.numbers().rev().filter_map(|number| self.event(number))
    }

    fn oldest_first(&self) -> impl Iterator<Item = Event> + '_ {
        self.numbers().filter_map(|number| self.event(number))
    }

    /// The nth event, the newest being 0. Without damage this takes the time of one event.
    #[must_use]
    pub fn nth_newest(&self, nth: usize) -> Option<Event> {
        if self.events() < self.numbers().len() {
            return self.newest_first().nth(nth);
        }
        self.event(self.numbers().rev().nth(nth)?)
    }

    /// How many events there are.
    #[must_use]
    pub fn events(&self) -> usize {
        self.whole.count_ones() as usize
    }

    /// The newest event.
    #[must_use]
    pub fn newest(&self) -> Option<Event> {
        self.newest_first().next()
    }

    /// Resets so far, this one included. Before [`FaultLog::count_boot`], or without it, those between two power cuts without
    /// an event are not counted.
    #[must_use]
    pub fn boot(&self) -> u32 {
        self.boot
    }

    /// Whether there are events that are not in flash yet.
    #[must_use]
    pub fn needs_flush(&self) -> bool {
        let newest = self.newest();
        newest.is_some() && newest != self.flushed
    }

    /// Copies the events that are not in flash yet; tells whether there were any. Only while disarmed: where the marks have
    /// no more room it erases a slot, and takes as long as that takes.
    ///
    /// # Errors
    /// When the flash refuses or does not hold the written data. The log flushed before is intact then.
    #[cold]
    #[inline(never)]
    pub fn flush<F: NorFlash>(
        &mut self,
        store: &FaultStore,
        flash: &mut F,
    ) -> Result<bool, SaveError<F::Error>> {
        if !self.needs_flush() {
            return Ok(false);
        }
        if self.append(store, flash) {
            return Ok(true);
        }
        self.save(store, flash)?;
        if self.counted {
            self.mark(store, flash)?;
        }
        Ok(true)
    }

    /// Marks the events that are not in flash yet, the oldest first. False where the flash has no log that they could be
    /// added to, or no room.
    #[cold]
    #[inline(never)]
    fn append<F: NorFlash>(&mut self, store: &FaultStore, flash: &mut F) -> bool {
        let Some(flushed) = self.flushed else { return false };
        let [kept, _] = store.slots.free_parts(flash, LOG_BYTES);
        let is_new = |event: &Event| flushed.number < event.number;
        let mut add = |event| marks::add(flash, kept, &mark::of_event(&event));
        let added = self.oldest_first().filter(is_new).all(&mut add);
        if added {
            self.flushed = self.newest();
        }
        added
    }

    #[cold]
    #[inline(never)]
    fn save<F: NorFlash>(&mut self, store: &FaultStore, flash: &mut F) -> Result<(), SaveError<F::Error>> {
        store.slots.save(flash, FORMAT, || self.oldest_first().map(|event| event.to_bytes()))?;
        self.flushed = self.newest();
        Ok(())
    }

    /// Counts this boot in flash and returns its number, larger than that of any boot counted before. Call it once
    /// after [`FaultLog::restore`]. It writes one mark. Only when there is no room for marks does it save the log
    /// anew, which erases a slot.
    ///
    /// # Errors
    /// When the flash refuses or does not hold the written data. The number may then be that of an earlier boot.
    #[cold]
    #[inline(never)]
    pub fn count_boot<F: NorFlash>(
        &mut self,
        store: &FaultStore,
        flash: &mut F,
    ) -> Result<u32, SaveError<F::Error>> {
        let parts = store.slots.free_parts(flash, LOG_BYTES);
        let newest = |part| marks::all(flash, part).filter_map(|found| mark::boot(&found)).max();
        let counted = parts.into_iter().filter_map(newest).max();
        self.set_boot(self.boot.max(counted.unwrap_or(0).saturating_add(1)));
        if self.mark(store, flash).is_err() {
            // The slot that is erased is not the one with the marks.
            self.save(store, flash)?;
            self.mark(store, flash)?;
        }
        self.counted = true;
        Ok(self.boot)
    }

    /// Writes the number of this boot into the slot that the next save leaves alone.
    #[cold]
    #[inline(never)]
    fn mark<F: NorFlash>(&self, store: &FaultStore, flash: &mut F) -> Result<(), SaveError<F::Error>> {
        let [kept, _] = store.slots.free_parts(flash, LOG_BYTES);
        if marks::add(flash, kept, &mark::of_boot(self.boot)) { Ok(()) } else { Err(SaveError::NotAsWritten) }
    }

    /// Clears the places. The flash keeps what it has.
    fn forget(&mut self) {
        self.places_mut().for_each(|place| *place = [0; PLACE_BYTES]);
        self.whole = 0;
    }

    fn numbers(&self) -> Range<u32> {
        self.next.saturating_sub(EVENTS as u32)..self.next
    }

    fn event(&self, number: u32) -> Option<Event> {
        let place = place_of(number);
        if self.whole & bit(place) == 0 {
            return None;
        }
        let (bytes, _) = self.places().nth(place)?.split_first_chunk()?;
        Some(Event::from_bytes(bytes)).filter(|event| event.number == number)
    }

    #[cold]
    #[inline(never)]
    fn put(&mut self, event: &Event) {
        let place = place_of(event.number);
        let bytes = event.to_bytes();
        self.whole |= bit(place);
        let to = self.places_mut().nth(place).and_then(|to| to.split_first_chunk_mut());
        if let Some((to, rest)) = to {
            *to = bytes;
            if let Some(to) = rest.first_chunk_mut() {
                *to = crc(&bytes).to_le_bytes();
            }
        }
    }

    /// Clears the places that hold no whole event, notes the others, and counts those that were damaged.
    #[cold]
    #[inline(never)]
    fn drop_damaged(&mut self) -> usize {
        let (mut whole, mut damaged) = (0, 0);
        for (nth, place) in self.places_mut().enumerate() {
            if whole_event(place).is_some() {
                whole |= bit(nth);
            } else if *place != [0; PLACE_BYTES] {
                *place = [0; PLACE_BYTES];
                damaged += 1;
            }
        }
        self.whole = whole;
        damaged
    }

    fn places(&self) -> impl ExactSizeIterator<Item = &[u8; PLACE_BYTES]> {
        let memory: &Memory = self.memory.borrow();
        memory.get(BOOT_BYTES..).unwrap_or(&[]).as_chunks().0.iter()
    }

    fn places_mut(&mut self) -> impl ExactSizeIterator<Item = &mut [u8; PLACE_BYTES]> {
        let memory: &mut Memory = self.memory.borrow_mut();
        memory.get_mut(BOOT_BYTES..).unwrap_or(&mut []).as_chunks_mut().0.iter_mut()
    }

    fn stored_boot(&self) -> Option<u32> {
        let memory: &Memory = self.memory.borrow();
        let (boot, rest) = memory.split_first_chunk()?;
        (rest.first_chunk() == Some(&crc(boot).to_le_bytes())).then(|| u32::from_le_bytes(*boot))
    }

    fn set_boot(&mut self, boot: u32) {
        self.boot = boot;
        let bytes = boot.to_le_bytes();
        let memory: &mut Memory = self.memory.borrow_mut();
        let sealed = bytes.into_iter().chain(crc(&bytes).to_le_bytes());
        memory.iter_mut().zip(sealed).for_each(|(to, from)| *to = from);
    }
}

/// The bit of a place.
fn bit(place: usize) -> u128 {
    const { assert!(EVENTS <= u128::BITS as usize, "a bit for each place") };
    1u128.wrapping_shl(place as u32)
}

fn place_of(number: u32) -> usize {
    number as usize % EVENTS
}

/// The event in a place; None if the place is clear or damaged.
fn whole_event(place: &[u8; PLACE_BYTES]) -> Option<Event> {
    let (bytes, rest) = place.split_first_chunk()?;
    (rest == crc(bytes).to_le_bytes()).then(|| Event::from_bytes(bytes))
}

/// CRC-32 over magic and format, then the bytes, so that another program's memory is not mistaken for this one's.
fn crc(bytes: &[u8]) -> u32 {
    let mut crc = RecordCrc::new();
    crc.update(&MAGIC);
    crc.update(&FORMAT.to_le_bytes());
    crc.update(bytes);
    crc.finish()
}
