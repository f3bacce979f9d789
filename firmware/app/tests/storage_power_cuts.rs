//! A power cut at any operation of a save leaves the old configuration or the new one, never neither.

use std::ops::Range;

use crate::nor_flash::{Flash, SECTOR, TEARS, Tear, record};
use pneudrive_app::move_records::MoveRecords;
use pneudrive_app::storage::{ConfigStore, Outcome};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use proptest::prelude::*;

const SLOT: u32 = 7 * SECTOR as u32;
const SLOTS: [Range<u32>; 2] = [0..SLOT, SLOT..2 * SLOT];

/// What a drive starts with: the saved velocity gain, or why there is none.
type Start = Result<i32, Outcome>;

#[derive(Clone)]
struct PowerCutBench<const WRITE: usize> {
    flash: Flash<WRITE>,
    store: ConfigStore,
}

impl<const WRITE: usize> PowerCutBench<WRITE> {
    fn new() -> Self {
        let flash = Flash::new(14);
        let store = ConfigStore::new(&flash, SLOTS).expect("room for two");
        PowerCutBench { flash, store }
    }

    /// One whose saves are numbered from here on.
    fn at_generation(generation: u32, gain: i32) -> Self {
        let mut drive = Self::new();
        let pair = |(id, value): (u16, i32)| [&id.to_le_bytes()[..], &value.to_le_bytes()[..]].concat();
        let entries: Vec<_> = with_gain(gain).iter().map(pair).collect();
        drive.flash.put(0, &record(b"PDcf", 1, 6, generation, &entries));
        drive
    }

    fn saved(mut self, gain: i32) -> Self {
        self.store.save(&mut self.flash, &with_gain(gain), &MoveRecords::default()).expect("saved");
        self
    }

    fn damaged(mut self, byte: u32) -> Self {
        self.flash.bytes[byte as usize] ^= 1;
        self
    }

    /// A save whose power goes after so many operations, and the reset that follows.
    fn cut(mut self, gain: i32, operations: usize, tear: Tear) -> Self {
        self.flash.cut_after(operations, tear);
        let saved = self.store.save(&mut self.flash, &with_gain(gain), &MoveRecords::default());
        assert_eq!(saved.is_err(), self.flash.is_powered_off(), "a save that was cut is not called saved");
        self.flash.reboot();
        self
    }

    fn start(&mut self) -> Start {
        let load = self.store.load(&mut self.flash);
        let gain = load.parameters.get(id::VELOCITY_GAIN).expect("known");
        assert_eq!(load.parameters, with_gain(gain), "a whole configuration, not a mixture");
        match load.outcome {
            Outcome::Loaded(report) => {
                assert_eq!((report.missing, report.unknown, report.out_of_range), (0, 0, 0));
                Ok(gain)
            }
            outcome => Err(outcome),
        }
    }

    /// Operations of the next save.
    fn operations(&self) -> usize {
        self.clone().saved(0).flash.operations - self.flash.operations
    }

    /// Cuts the next save at each of its operations, in each way; tells at how many.
    fn cut_everywhere(&self, old: Start) -> usize {
        let points = (0..self.operations()).flat_map(|operation| TEARS.map(|tear| (operation, tear)));
        points.map(|(operation, tear)| self.clone().survives(old, operation, tear)).count()
    }

    fn survives(self, old: Start, operation: usize, tear: Tear) {
        let mut drive = self.cut(NEW, operation, tear);
        let start = drive.start();
        assert!(start == old || start == Ok(NEW), "{start:?} after {operation} operations and {tear:?}");
        assert_eq!(drive.start(), start, "loading changes nothing");
        assert_eq!(drive.saved(NEXT).start(), Ok(NEXT), "{operation} {tear:?}");
    }
}

const NEW: i32 = 1001;
const NEXT: i32 = 1002;

fn with_gain(gain: i32) -> Parameters {
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, gain).expect("in range");
    parameters
}

/// The first save, the ones after it, across the wrap, and onto a damaged slot.
fn cut_every_kind_of_save<const WRITE: usize>() {
    let lost = PowerCutBench::<WRITE>::new().saved(1).saved(2).damaged(20).damaged(SLOT + 20);
    let only_lost = PowerCutBench::<WRITE>::new().saved(1).damaged(20);
    let points = [
        PowerCutBench::<WRITE>::new().cut_everywhere(Err(Outcome::NeverSaved)),
        PowerCutBench::<WRITE>::new().saved(1).cut_everywhere(Ok(1)),
        PowerCutBench::<WRITE>::new().saved(1).saved(2).cut_everywhere(Ok(2)),
        PowerCutBench::<WRITE>::at_generation(u32::MAX, 1).cut_everywhere(Ok(1)),
        PowerCutBench::<WRITE>::at_generation(u32::MAX - 1, 1).saved(2).cut_everywhere(Ok(2)),
        PowerCutBench::<WRITE>::new().saved(1).saved(2).damaged(20).cut_everywhere(Ok(2)),
        PowerCutBench::<WRITE>::new().saved(1).saved(2).damaged(SLOT + 20).cut_everywhere(Ok(1)),
        lost.cut_everywhere(Err(Outcome::Damaged)),
        only_lost.cut_everywhere(Err(Outcome::Damaged)),
    ];
    println!("{} power cuts with words of {WRITE} bytes", points.iter().sum::<usize>());
}

#[test]
fn a_power_cut_leaves_the_old_or_the_new_configuration_with_words_of_1_byte() {
    let drive = PowerCutBench::<1>::new();
    let points = drive.cut_everywhere(Err(Outcome::NeverSaved));
    println!("{} power cuts with words of 1 byte", points + drive.saved(1).saved(2).cut_everywhere(Ok(2)));
}

#[test]
fn a_power_cut_leaves_the_old_or_the_new_configuration_with_words_of_4_bytes() {
    cut_every_kind_of_save::<4>();
}

#[test]
fn a_power_cut_leaves_the_old_or_the_new_configuration_with_words_of_8_bytes() {
    cut_every_kind_of_save::<8>();
}

#[test]
fn a_power_cut_leaves_the_old_or_the_new_configuration_with_words_of_32_bytes() {
    cut_every_kind_of_save::<32>();
}

#[test]
fn a_second_cut_after_a_cut_first_save_still_finds_a_drive_that_was_never_saved() {
    let blank = PowerCutBench::<32>::new();
    for tear in TEARS {
        for operation in [0, 1, 30, blank.operations() - 2] {
            let mut once = blank.clone().cut(1, operation, tear);
            let old = once.start();
            once.cut_everywhere(old);
        }
    }
}

#[test]
fn the_new_configuration_holds_from_its_last_word_on() {
    let drive = PowerCutBench::<8>::new().saved(1);
    let seal_words = 32 / 8;
    let last = drive.operations() - seal_words;
    assert_eq!(drive.clone().cut(NEW, last - 1, Tear::Untouched).start(), Ok(1));
    assert_eq!(drive.clone().cut(NEW, last - 1, Tear::Done).start(), Ok(NEW));
    assert_eq!(drive.cut(NEW, last, Tear::Garbage(3)).start(), Ok(NEW));
}

fn tear() -> impl Strategy<Value = Tear> {
    prop_oneof![
        Just(Tear::Untouched),
        (1_usize..16).prop_map(Tear::Sixteenths),
        Just(Tear::Zeros),
        any::<u64>().prop_map(Tear::Garbage),
        any::<u64>().prop_map(Tear::GarbageToTheEnd),
        Just(Tear::Done),
    ]
}

proptest! {
    #[test]
    fn a_drive_lives_through_any_row_of_saves_and_power_cuts(
        generation in (0_u32..40).prop_map(|back| u32::MAX - back),
        saves in prop::collection::vec((0_usize..400, tear()), 1..60),
    ) {
        let mut drive = PowerCutBench::<8>::at_generation(generation, 0);
        let mut old = Ok(0);
        for (gain, (operation, tear)) in (1..).zip(saves) {
            drive = drive.cut(gain, operation, tear);
            let start = drive.start();
            prop_assert!(start == old || start == Ok(gain), "{:?}, not {:?} or {}", start, old, gain);
            old = start;
        }
    }
}
