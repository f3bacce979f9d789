//! The number of a boot is that of no other one, whatever ended the one before.

use std::ops::Range;

use crate::nor_flash::{Flash, SECTOR, TEARS, Tear, TornWord};
use pneudrive_app::fault_log::{FaultLog, FaultStore, MEMORY_BYTES, Memory};
use proptest::prelude::*;

/// A slot with room for a log, its seal and two marks.
const SLOT: u32 = 5 * SECTOR as u32 + 512;
const SLOTS: [Range<u32>; 2] = [0..SLOT, SLOT..2 * SLOT];

/// A board: memory that survives a reset, flash that survives a power cut, and the numbers that it has told.
#[derive(Clone)]
struct Board<const WRITE: usize> {
    memory: Memory,
    flash: Flash<WRITE>,
    store: FaultStore,
    told: Vec<u32>,
}

impl<const WRITE: usize> Board<WRITE> {
    fn new(torn_word: TornWord) -> Self {
        let mut flash = Flash::new(12);
        flash.torn_word = torn_word;
        let store = FaultStore::new(&flash, SLOTS).expect("room for two");
        Board { memory: [0xa5; MEMORY_BYTES], flash, store, told: Vec::new() }
    }

    /// A boot that flushes what is left from before, and then so many faults, each on its own. Its number is told as soon as
    /// it is known.
    fn boot(&mut self, faults: u32) {
        let Board { memory, flash, store, told } = self;
        let (mut log, _) = FaultLog::recover(memory);
        log.restore(store, flash);
        let Ok(number) = log.count_boot(store, flash) else { return };
        assert!(!told.contains(&number), "boot {number} was there before: {told:?}");
        told.push(number);
        let _ = log.flush(store, flash);
        for k in 0..faults {
            assert_eq!(log.record(1, k, 0, 5).boot, number);
            let _ = log.flush(store, flash);
        }
    }

    /// A boot whose fault waits to be flushed, and a reset.
    fn boot_with_pending_fault(&mut self) {
        let (mut log, _) = FaultLog::recover(&mut self.memory);
        log.restore(&self.store, &mut self.flash);
        self.told.extend(log.count_boot(&self.store, &mut self.flash));
        log.record(1, 0, 0, 5);
    }

    fn lose_power(&mut self) {
        self.memory = [0x5a; MEMORY_BYTES];
        self.flash.reboot();
    }
}

#[test]
fn boots_count_up_through_resets_and_power_cuts() {
    let mut board = Board::<8>::new(TornWord::Forbidden);
    for boot in 0..100 {
        board.boot(0);
        if boot % 3 == 0 {
            board.lose_power();
        }
    }
    assert_eq!(board.told, (1..=100).collect::<Vec<u32>>());
}

#[test]
fn a_boot_erases_nothing_as_long_as_its_mark_has_room() {
    let mut board = Board::<8>::new(TornWord::Forbidden);
    board.boot(1);
    let erases = board.flash.erases.clone();
    let most = (SLOT as usize - 2528 - 32) / 32 - 1;
    for _ in 0..most {
        board.lose_power();
        board.boot(0);
    }
    assert_eq!(board.flash.erases, erases);
    board.boot(0);
    assert_ne!(board.flash.erases, erases, "there is no room for another one");
}

/// Each boot of a row is cut at every operation of the flash, in each way that a word or a sector can be torn, and the boot
/// after it is cut again there or goes on.
#[test]
fn a_power_cut_at_any_operation_leads_to_no_number_that_was_told() {
    let mut points = 0;
    for torn_word in [TornWord::Taken, TornWord::Refused] {
        for (boots, faults) in [(0, 0), (1, 0), (1, 1), (3, 2), (16, 0), (17, 1), (40, 3)] {
            let mut board = Board::<8>::new(torn_word);
            for _ in 0..boots {
                board.boot(0);
                board.lose_power();
            }
            points += cut_everywhere(&board, faults);
            board.boot_with_pending_fault();
            points += cut_everywhere(&board, faults);
        }
    }
    assert!(points > 2_000, "{points}");
    println!("{points} power cuts");
}

fn cut_everywhere(board: &Board<8>, faults: u32) -> usize {
    let mut whole = board.clone();
    whole.boot(faults);
    let operations = whole.flash.operations - board.flash.operations;
    for operation in 0..operations {
        for tear in TEARS {
            let mut board = board.clone();
            board.flash.cut_after(operation, tear);
            board.boot(faults);
            board.lose_power();
            for _ in 0..2 {
                board.boot(faults);
                board.lose_power();
            }
        }
    }
    operations * TEARS.len()
}

#[test]
fn a_flash_that_holds_nothing_gives_no_number() {
    let mut board = Board::<8>::new(TornWord::Forbidden);
    board.flash.cut_after(0, Tear::Untouched);
    board.boot(0);
    assert!(board.told.is_empty());
}

/// What flash held before boots were counted.
#[test]
fn a_log_from_before_boots_were_counted_is_kept_and_its_boots_go_on() {
    let mut board = Board::<8>::new(TornWord::Forbidden);
    let (mut log, _) = FaultLog::recover(&mut board.memory);
    for k in 0..3 {
        log.record(1, k, 0, 5);
    }
    log.flush(&board.store, &mut board.flash).expect("flushed");
    board.lose_power();
    let (mut log, _) = FaultLog::recover(&mut board.memory);
    log.restore(&board.store, &mut board.flash);
    assert_eq!(log.count_boot(&board.store, &mut board.flash), Ok(2));
    assert_eq!(log.events(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_number_is_told_twice_in_any_row_of_boots_faults_resets_and_power_cuts(
        row in proptest::collection::vec((0..3u32, any::<bool>(), 0..500usize, 0..TEARS.len()), 1..60),
        refused in any::<bool>(),
    ) {
        let mut board = Board::<4>::new(if refused { TornWord::Refused } else { TornWord::Taken });
        for (faults, loses_power, operation, tear) in row {
            if loses_power {
                board.flash.cut_after(operation, TEARS[tear]);
            }
            board.boot(faults);
            if loses_power {
                board.lose_power();
            }
        }
    }
}
