//! The fault log through resets, damage of its memory, and power cuts.

use std::ops::Range;

use crate::nor_flash::{self, Flash, SECTOR, TEARS, record};
use pneudrive_app::fault_log::{
    EVENTS, Event, FaultLog, FaultStore, MEMORY_BYTES, Memory, Recovery, Restored,
};
use pneudrive_app::storage::LayoutError;
use proptest::prelude::*;

type Nor = Flash<8>;

const SLOT: u32 = 5 * SECTOR as u32 + 512;
const SLOTS: [Range<u32>; 2] = [0..SLOT, SLOT..2 * SLOT];

/// Events 3 and 4 as they were flushed in format 1. Worked out apart from the crate. DO NOT CHANGE:
/// drives in the field hold this.
#[rustfmt::skip]
const FORMAT_1: [u8; 68] = [
    0x50, 0x44, 0x66, 0x6c, 0x01, 0x00, 0x19, 0x00, 0x07, 0x00, 0x00, 0x00, 0x02, 0x00,
    0x03, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x60, 0xe3, 0x16, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x81, 0x04, 0x00, 0x00, 0xef, 0xff, 0xff, 0xff, 0x04,
    0x04, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,
    0x70, 0x11, 0x01, 0x00, 0x00, 0x20, 0x00, 0x00, 0x01,
    0xec, 0xef, 0x19, 0x49,
];

const EVENT_3: Event = Event { number: 3, boot: 2, time_us: 1_500_000, index: 1153, position: -17, code: 4 };
const EVENT_4: Event =
    Event { number: 4, boot: 2, time_us: 0x0102_0304_0506_0708, index: 70_000, position: 8192, code: 1 };

/// A board: memory that survives a reset, flash that survives a power cut.
#[derive(Clone)]
struct Board {
    memory: Memory,
    flash: Nor,
    store: FaultStore,
}

impl Board {
    /// One whose memory holds what it held when the power came.
    fn new() -> Board {
        let flash = Nor::new(12);
        let store = FaultStore::new(&flash, SLOTS).expect("room for two");
        Board { memory: [0xa5; MEMORY_BYTES], flash, store }
    }

    fn reset(&mut self) -> (FaultLog<&mut Memory>, Recovery) {
        FaultLog::recover(&mut self.memory)
    }

    /// A reset, `events` faults, and the flush if it is asked for.
    fn run(&mut self, events: u32, flush: bool) {
        let (mut log, _) = FaultLog::recover(&mut self.memory);
        log.restore(&self.store, &mut self.flash);
        (0..events).for_each(|k| {
            log.record(1, k, 0, u64::from(k));
        });
        if flush {
            log.flush(&self.store, &mut self.flash).expect("flushed");
        }
    }

    fn lose_power(&mut self) {
        self.memory = [0x5a; MEMORY_BYTES];
        self.flash.reboot();
    }

    /// After a power cut: what the flash gives back.
    fn restore(&mut self) -> (Restored, Vec<u32>) {
        let (mut log, recovery) = FaultLog::recover(&mut self.memory);
        assert_eq!(recovery, Recovery::Lost);
        let restored = log.restore(&self.store, &mut self.flash);
        (restored, numbers(&log))
    }
}

fn numbers<M: std::borrow::BorrowMut<Memory>>(log: &FaultLog<M>) -> Vec<u32> {
    log.newest_first().map(|event| event.number).collect()
}

/// First byte of the place of an event in memory.
fn place(number: usize) -> usize {
    8 + number % EVENTS * (Event::BYTES + 4)
}

#[test]
fn an_event_is_stored_little_endian_in_the_order_of_its_fields() {
    assert_eq!(EVENT_3.to_bytes(), FORMAT_1[14..39]);
    assert_eq!(EVENT_4.to_bytes(), FORMAT_1[39..64]);
    assert_eq!(Event::from_bytes(&EVENT_3.to_bytes()), EVENT_3);
    assert_eq!(Event::from_bytes(&EVENT_4.to_bytes()), EVENT_4);
}

#[test]
fn memory_after_a_power_cut_is_lost_and_the_log_starts_empty() {
    for byte in [0, 0x5a, 0xff] {
        let (log, recovery) = FaultLog::recover([byte; MEMORY_BYTES]);
        assert_eq!((recovery, log.boot()), (Recovery::Lost, 1));
        assert_eq!((log.newest(), log.needs_flush()), (None, false));
    }
}

#[test]
fn events_are_read_newest_first_with_what_was_logged() {
    let (mut log, _) = FaultLog::recover([0; MEMORY_BYTES]);
    let first = log.record(4, 1153, -17, 1_500_000);
    let second = log.record(1, 70_000, 8192, u64::MAX);
    assert_eq!(first, Event { number: 0, boot: 1, ..EVENT_3 });
    assert_eq!(second, Event { number: 1, boot: 1, time_us: u64::MAX, ..EVENT_4 });
    assert!(log.newest_first().eq([second, first]));
    assert_eq!(log.newest(), Some(second));
}

#[test]
fn the_log_survives_resets_and_counts_them() {
    let mut board = Board::new();
    assert_eq!(board.reset().1, Recovery::Lost);
    for boot in 2..6 {
        let (mut log, recovery) = board.reset();
        assert_eq!(recovery, Recovery::Kept { events: boot as usize - 2, damaged: 0 });
        assert_eq!(log.record(3, 0, 0, 0).boot, boot);
    }
    let (log, _) = board.reset();
    assert_eq!(log.newest_first().map(|event| event.boot).collect::<Vec<_>>(), [5, 4, 3, 2]);
}

#[test]
fn the_hundred_newest_events_are_kept() {
    let mut board = Board::new();
    let mut log = board.reset().0;
    for number in 0..350 {
        log.record(1, number, 0, 0);
        let oldest = (number + 1).saturating_sub(EVENTS as u32);
        assert_eq!(numbers(&log), (oldest..=number).rev().collect::<Vec<_>>());
    }
    let (log, recovery) = board.reset();
    assert_eq!(recovery, Recovery::Kept { events: EVENTS, damaged: 0 });
    assert_eq!(numbers(&log), (250..350).rev().collect::<Vec<_>>());
}

#[test]
fn any_flipped_bit_costs_the_event_that_it_is_in_and_is_reported() {
    let mut board = Board::new();
    board.run(100, false);
    for byte in place(0)..MEMORY_BYTES {
        let mut board = board.clone();
        board.memory[byte] ^= 1 << (byte % 8);
        let hit = ((byte - place(0)) / (Event::BYTES + 4)) as u32;
        let (log, recovery) = board.reset();
        assert_eq!(recovery, Recovery::Kept { events: 99, damaged: 1 }, "byte {byte}");
        assert_eq!(numbers(&log), (0..100).rev().filter(|&n| n != hit).collect::<Vec<_>>());
    }
}

#[test]
fn a_flipped_bit_of_the_boot_counter_costs_no_event() {
    let mut board = Board::new();
    board.run(3, false);
    for byte in 0..place(0) {
        let mut board = board.clone();
        board.memory[byte] ^= 0x10;
        let (log, recovery) = board.reset();
        assert_eq!(recovery, Recovery::Kept { events: 3, damaged: 0 });
        assert_eq!(log.boot(), 2, "counted on from the newest event");
    }
}

#[test]
fn a_reset_in_the_middle_of_logging_costs_no_other_event() {
    let mut before = Board::new();
    before.run(150, false);
    let mut after = before.clone();
    after.reset().0.record(9, 9, 9, 9);
    let bytes = place(150)..place(151);
    for cut in bytes.clone() {
        let mut board = before.clone();
        board.memory[bytes.start..cut].copy_from_slice(&after.memory[bytes.start..cut]);
        let events = numbers(&board.reset().0);
        assert_eq!(events[..98], (52..150).rev().collect::<Vec<_>>(), "{cut}");
    }
}

#[test]
fn the_memory_of_another_program_is_not_taken_for_a_log() {
    let mut memory = [0; MEMORY_BYTES];
    let plain = [&EVENT_3.to_bytes()[..], &nor_flash::crc32(&EVENT_3.to_bytes()).to_le_bytes()].concat();
    memory[place(3)..place(4)].copy_from_slice(&plain);
    assert_eq!(FaultLog::recover(memory).1, Recovery::Lost);
}

#[test]
fn what_was_flushed_comes_back_after_a_power_cut_and_numbers_go_on() {
    let mut board = Board::new();
    board.run(120, true);
    board.lose_power();
    let (mut log, recovery) = FaultLog::recover(&mut board.memory);
    assert_eq!(recovery, Recovery::Lost);
    assert_eq!(log.restore(&board.store, &mut board.flash), Restored::Events(100));
    assert_eq!(numbers(&log), (20..120).rev().collect::<Vec<_>>());
    assert!(!log.needs_flush());
    let event = log.record(1, 0, 0, 0);
    assert_eq!((event.number, event.boot), (120, 2));
}

#[test]
fn the_bytes_of_format_1_are_restored_for_ever() {
    let mut board = Board::new();
    board.flash.put(SLOTS[1].start, &FORMAT_1);
    let (mut log, _) = FaultLog::recover([0; MEMORY_BYTES]);
    assert_eq!(log.restore(&board.store, &mut board.flash), Restored::Events(2));
    assert!(log.newest_first().eq([EVENT_4, EVENT_3]));
    assert_eq!(log.boot(), 3);
}

#[test]
fn a_flush_writes_only_what_is_new() {
    let mut board = Board::new();
    let (mut log, _) = FaultLog::recover(&mut board.memory);
    let mut flush = |log: &mut FaultLog<&mut Memory>| {
        let due = log.needs_flush();
        assert_eq!(log.flush(&board.store, &mut board.flash), Ok(due));
        due
    };
    assert!(!flush(&mut log), "no event yet");
    log.record(1, 0, 0, 0);
    assert!(flush(&mut log));
    assert!(!flush(&mut log));
    log.record(1, 0, 0, 0);
    assert!(flush(&mut log));
}

#[test]
fn events_in_memory_stay_after_a_reset_and_are_compared_with_the_flash() {
    let mut board = Board::new();
    board.run(2, true);
    let (mut log, _) = FaultLog::recover(&mut board.memory);
    assert_eq!(log.restore(&board.store, &mut board.flash), Restored::NotNeeded);
    assert!(!log.needs_flush());
    log.record(1, 0, 0, 0);
    let (mut log, _) = FaultLog::recover(&mut board.memory);
    assert_eq!(log.restore(&board.store, &mut board.flash), Restored::NotNeeded);
    assert!(log.needs_flush(), "the third event is not in flash");
    assert_eq!(numbers(&log), [2, 1, 0]);
}

#[test]
fn a_power_cut_in_a_flush_leaves_the_old_log_and_the_first_of_the_new_events() {
    let mut points = 0;
    for (before, after) in [(0, 1), (1, 100), (130, 3)] {
        let mut board = Board::new();
        board.run(before, true);
        let old = { board.clone() }.after_power_cut();
        board.run(after, false);
        let new = { board.clone() }.flushed().after_power_cut();
        for operation in 0..board.operations() {
            for tear in TEARS {
                let mut board = board.clone();
                board.flash.cut_after(operation, tear);
                let found = board.flushed().after_power_cut();
                assert!(lies_between(&found.1, &old.1, &new.1), "{operation} {tear:?}: {found:?}");
                points += 1;
            }
        }
    }
    println!("{points} power cuts in flushes");
}

/// Whether a log holds all events up to one that is none before the newest old one, as the new one does.
fn lies_between(found: &[u32], old: &[u32], new: &[u32]) -> bool {
    let newest = found.first().copied();
    let kept = newest.map_or(0, |newest| (newest + 1).min(EVENTS as u32));
    let whole = newest.is_none_or(|newest| found.iter().copied().eq((newest + 1 - kept..=newest).rev()));
    whole && old.first().copied() <= newest && newest <= new.first().copied()
}

impl Board {
    /// What is left after a flush, whether its power goes or not.
    fn flushed(mut self) -> Board {
        let (mut log, _) = FaultLog::recover(&mut self.memory);
        log.restore(&self.store, &mut self.flash);
        let _ = log.flush(&self.store, &mut self.flash);
        self
    }

    fn after_power_cut(mut self) -> (Restored, Vec<u32>) {
        self.lose_power();
        self.restore()
    }

    /// Operations of the flush that is due.
    fn operations(&self) -> usize {
        self.clone().flushed().flash.operations - self.flash.operations
    }
}

#[test]
fn a_damaged_copy_falls_back_to_the_one_before_and_two_are_reported() {
    let mut board = Board::new();
    board.run(5, true);
    // The slots of this flash have room for 16 marks each; the next event is saved with the whole log.
    (0..17).for_each(|_| board.run(1, true));
    board.flash.bytes[SLOT as usize + 30] ^= 1;
    assert_eq!(board.clone().after_power_cut(), (Restored::Events(21), (0..21).rev().collect()));
    board.flash.bytes[30] ^= 1;
    assert_eq!(board.after_power_cut(), (Restored::Damaged, vec![]));
}

#[test]
fn a_log_of_a_later_format_and_none_at_all_are_told_apart() {
    let mut board = Board::new();
    assert_eq!(board.clone().after_power_cut(), (Restored::NeverSaved, vec![]));
    board.flash.put(0, &record(b"PDfl", 2, 30, 1, &[vec![0; 30]]));
    assert_eq!(board.after_power_cut(), (Restored::UnknownFormat(2), vec![]));
}

#[test]
fn a_record_of_format_1_whose_entries_are_not_events_gives_no_events() {
    let mut board = Board::new();
    board.flash.put(0, &record(b"PDfl", 1, 24, 1, &[vec![0; 24]]));
    assert_eq!(board.after_power_cut(), (Restored::Damaged, vec![]));
}

#[test]
fn slots_have_room_for_a_full_log() {
    let flash = Nor::new(12);
    let store = |first, second| FaultStore::new(&flash, [first, second]).map(|_| ());
    assert_eq!(store(0..SLOT, SLOT..2 * SLOT), Ok(()));
    assert_eq!(store(0..2048, SLOT..2 * SLOT), Err(LayoutError::TooShort));
}

/// What happens to a board.
#[derive(Clone, Debug)]
enum Happening {
    Faults(u32),
    Reset,
    Flush,
    PowerCut,
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        (1_u32..130).prop_map(Happening::Faults),
        Just(Happening::Reset),
        Just(Happening::Flush),
        Just(Happening::PowerCut),
    ]
}

proptest! {
    #[test]
    fn a_log_keeps_the_newest_hundred_of_what_was_not_lost(
        happenings in prop::collection::vec(happening(), 1..30),
    ) {
        let mut board = Board::new();
        let (mut all, mut flushed) = (0_u32, 0_u32);
        let mut kept = Vec::new();
        for happening in happenings {
            let (mut log, _) = FaultLog::recover(&mut board.memory);
            log.restore(&board.store, &mut board.flash);
            match happening {
                Happening::Faults(n) => {
                    (0..n).for_each(|k| { log.record(1, k, 0, 0); });
                    all += n;
                }
                Happening::Reset => {}
                Happening::Flush => {
                    log.flush(&board.store, &mut board.flash).expect("power");
                    flushed = all;
                }
                Happening::PowerCut => {
                    board.lose_power();
                    all = flushed;
                    continue;
                }
            }
            kept = numbers(&log);
            prop_assert_eq!(&kept, &(all.saturating_sub(100)..all).rev().collect::<Vec<_>>());
        }
        prop_assert!(kept.len() <= EVENTS);
    }

    #[test]
    fn no_memory_is_too_strange(
        seed in prop::collection::vec(any::<u8>(), MEMORY_BYTES),
        whole in prop::collection::vec((0..EVENTS, any::<u32>()), 0..5),
    ) {
        let mut donor = Board::new();
        let (mut log, _) = FaultLog::recover(&mut donor.memory);
        (0..100).for_each(|k| { log.record(1, k, 0, 0); });
        let mut memory: Memory = seed.try_into().expect("as long as the memory");
        for (from, to) in whole {
            let (from, to) = (place(from), place(to as usize % EVENTS));
            memory[to..to + 29].copy_from_slice(&donor.memory[from..from + 29]);
        }
        let (mut log, _) = FaultLog::recover(&mut memory);
        let next = log.record(2, 0, 0, 0);
        prop_assert_eq!(log.newest(), Some(next));
        prop_assert!(log.newest_first().count() <= EVENTS);
    }
}
