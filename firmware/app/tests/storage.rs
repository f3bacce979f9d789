//! What the stored configuration promises while the power is on: format, migration, damage.

use std::ops::Range;

use crate::nor_flash::{Flash, SECTOR, crc32, record};
use embedded_storage::nor_flash::NorFlash;
use pneudrive_app::move_records::MoveRecords;
use pneudrive_app::storage::{
    ConfigStore, FORMAT, LayoutError, Load, Outcome, Report, SaveError, configuration_hash,
};
use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_protocol::ProfiledMove;
use proptest::prelude::*;

type Nor = Flash<8>;

const SLOT: u32 = 7 * SECTOR as u32;
const SLOTS: [Range<u32>; 2] = [0..SLOT, SLOT..2 * SLOT];

/// Five pairs of format 1 under generation 41: velocity gain 1000, an id that no program had, null
/// offset -3, a null code beyond its range, and entry 7 of the gain profile 99. Worked out apart from
/// the crate. DO NOT CHANGE: drives in the field hold this.
#[rustfmt::skip]
const FORMAT_1: [u8; 48] = [
    0x50, 0x44, 0x63, 0x66, 0x01, 0x00, 0x06, 0x00, 0x29, 0x00, 0x00, 0x00, 0x05, 0x00,
    0x07, 0x00, 0xe8, 0x03, 0x00, 0x00,
    0xc8, 0x00, 0xfb, 0xff, 0xff, 0xff,
    0x0e, 0x00, 0xfd, 0xff, 0xff, 0xff,
    0x14, 0x00, 0x9f, 0x86, 0x01, 0x00,
    0x07, 0x01, 0x63, 0x00, 0x00, 0x00,
    0x1b, 0x95, 0xdc, 0x9c,
];

struct StorageBench {
    flash: Nor,
    store: ConfigStore,
}

impl StorageBench {
    fn blank() -> StorageBench {
        let flash = Nor::new(14);
        let store = ConfigStore::new(&flash, SLOTS).expect("room for two");
        StorageBench { flash, store }
    }

    fn with_saved(configurations: &[&Parameters]) -> StorageBench {
        let mut bench = StorageBench::blank();
        for parameters in configurations {
            bench.save(parameters);
        }
        bench
    }

    fn save(&mut self, parameters: &Parameters) -> u32 {
        self.store.save(&mut self.flash, parameters, &MoveRecords::default()).expect("saved")
    }

    fn load(&mut self) -> Load {
        self.store.load(&mut self.flash)
    }

    fn loaded(&mut self) -> (Parameters, Report) {
        match self.load() {
            Load { parameters, outcome: Outcome::Loaded(report), .. } => (parameters, report),
            Load { outcome, .. } => panic!("{outcome:?}"),
        }
    }

    fn flip(&mut self, byte: u32, bit: u32) {
        self.flash.bytes[byte as usize] ^= 1 << bit;
    }
}

fn with_gain(gain: i32) -> Parameters {
    let mut parameters = Parameters::default();
    parameters.set(id::VELOCITY_GAIN, gain).expect("in range");
    parameters
}

fn pair((id, value): (u16, i32)) -> Vec<u8> {
    [id.to_le_bytes().as_slice(), value.to_le_bytes().as_slice()].concat()
}

fn pairs() -> u32 {
    Parameters::default().iter().count() as u32
}

fn record_bytes() -> u32 {
    14 + 6 * pairs() + 4
}

#[test]
fn a_blank_flash_was_never_saved_to_and_gives_the_defaults() {
    let load = StorageBench::blank().load();
    assert_eq!(
        load,
        Load {
            parameters: Parameters::default(),
            records: MoveRecords::default(),
            outcome: Outcome::NeverSaved
        }
    );
}

/// Nobody can tell such a word from one that was never programmed, and the hardware takes it as one.
#[test]
fn words_that_were_programmed_to_all_ones_are_still_blank_and_take_the_first_save() {
    let mut bench = StorageBench::blank();
    bench.flash.put(0, &[0xff]);
    bench.flash.write(8, &[0xff; 32]).expect("power");
    assert_eq!(bench.load().outcome, Outcome::NeverSaved);
    bench.save(&with_gain(1));
    assert_eq!(bench.loaded().0, with_gain(1));
    assert_eq!(bench.flash.erases, [0; 14], "an erase that is cut would leave what looks like a loss");
}

#[test]
#[should_panic(expected = "the word at 8 is written twice")]
fn the_flash_of_these_tests_does_not_let_a_word_with_a_zero_in_it_be_written_twice() {
    let mut flash = Nor::new(1);
    flash.write(8, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe]).expect("power");
    let _ = flash.write(8, &[0; 8]);
}

#[test]
fn what_was_saved_last_is_loaded() {
    let mut bench = StorageBench::blank();
    for generation in 1..=7 {
        let parameters = with_gain(generation as i32);
        assert_eq!(bench.save(&parameters), generation);
        let (loaded, report) = bench.loaded();
        assert_eq!(loaded, parameters);
        assert_eq!(report, Report { format: FORMAT, generation, ..Report::default() });
    }
}

#[test]
fn a_saved_configuration_has_the_layout_of_format_1() {
    let parameters = with_gain(77);
    let bench = StorageBench::with_saved(&[&parameters]);
    let entries: Vec<_> = parameters.iter().map(pair).collect();
    let expected = record(b"PDcf", 1, 6, 1, &entries);
    assert_eq!(bench.flash.bytes[..expected.len()], expected);
    assert_eq!(bench.flash.bytes[SLOT as usize - 32..SLOT as usize], [0; 32], "the seal");
    assert!(bench.flash.bytes[expected.len()..SLOT as usize - 32].iter().all(|&byte| byte == 0xff));
}

#[test]
fn the_bytes_of_format_1_are_read_for_ever() {
    let mut bench = StorageBench::blank();
    bench.flash.put(SLOTS[1].start, &FORMAT_1);
    let (loaded, report) = bench.loaded();
    let mut expected = with_gain(1000);
    expected.set(id::NULL_OFFSET_COUNTS, -3).expect("in range");
    expected.set(id::GAIN_PROFILE + 7, 99).expect("in range");
    assert_eq!(loaded, expected);
    let expected = Report {
        format: 1,
        generation: 41,
        unknown: 1,
        missing: pairs() as u16 - 4,
        out_of_range: 1,
        first_out_of_range: Some(id::NULL_CODE),
        other_damaged: false,
    };
    assert_eq!(report, expected);
}

#[test]
fn ids_that_an_earlier_program_did_not_have_keep_their_defaults() {
    let newest = &TABLE[TABLE.len() - 4..TABLE.len() - 1];
    let mut earlier = with_gain(500);
    newest.iter().for_each(|p| earlier.set(p.id, p.max).expect("in range"));
    let has = |&(id, _): &(u16, i32)| newest.iter().all(|p| p.id != id);
    let entries: Vec<_> = earlier.iter().filter(has).map(pair).collect();
    let mut bench = StorageBench::blank();
    bench.flash.put(0, &record(b"PDcf", 1, 6, 9, &entries));
    let (loaded, report) = bench.loaded();
    assert_eq!(loaded, with_gain(500));
    assert_eq!(report, Report { format: 1, generation: 9, missing: 3, ..Report::default() });
    assert_eq!(bench.save(&loaded), 10, "a migrated set is saved as today's");
    assert_eq!(bench.loaded().1, Report { format: 1, generation: 10, ..Report::default() });
}

#[test]
fn a_configuration_of_a_later_format_is_neither_loaded_nor_taken_for_damage() {
    let mut bench = StorageBench::with_saved(&[&with_gain(3)]);
    bench.flash.put(SLOTS[1].start, &record(b"PDcf", 2, 7, 2, &[vec![1; 7], vec![2; 7]]));
    let load = bench.load();
    assert_eq!(
        load,
        Load {
            parameters: Parameters::default(),
            records: MoveRecords::default(),
            outcome: Outcome::UnknownFormat(2)
        }
    );
    assert_eq!(bench.save(&with_gain(4)), 3);
    assert_eq!(bench.loaded().0, with_gain(4));
}

#[test]
fn a_record_of_another_kind_is_not_a_configuration() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    bench.flash.put(SLOTS[0].start, &record(b"PDfl", 1, 6, 99, &[vec![0; 6]]));
    assert_eq!(bench.loaded().0, with_gain(2));
}

#[test]
fn any_flipped_bit_of_the_newest_record_brings_back_the_one_before() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    let expected = Report { format: 1, generation: 1, other_damaged: true, ..Report::default() };
    for (byte, bit) in (SLOT..SLOT + record_bytes()).flat_map(|byte| (0..8).map(move |bit| (byte, bit))) {
        bench.flip(byte, bit);
        assert_eq!(bench.loaded(), (with_gain(1), expected), "bit {bit} of byte {byte}");
        bench.flip(byte, bit);
    }
}

#[test]
fn a_flipped_bit_beside_the_record_changes_nothing() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    for byte in SLOT + record_bytes()..2 * SLOT {
        bench.flip(byte, byte % 8);
        assert_eq!(bench.loaded().0, with_gain(2), "byte {byte}");
        bench.flip(byte, byte % 8);
    }
}

#[test]
fn two_damaged_slots_are_reported_and_trip() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    bench.flip(20, 0);
    bench.flip(SLOT + 20, 0);
    let load = bench.load();
    assert_eq!(
        load,
        Load {
            parameters: Parameters::default(),
            records: MoveRecords::default(),
            outcome: Outcome::Damaged
        }
    );
}

#[test]
fn damage_of_the_only_configuration_is_not_taken_for_a_blank_flash() {
    for byte in 0..record_bytes() {
        let mut bench = StorageBench::with_saved(&[&with_gain(1)]);
        bench.flip(byte, byte % 8);
        assert_eq!(bench.load().outcome, Outcome::Damaged, "byte {byte}");
    }
}

#[test]
fn a_save_heals_damage() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    bench.flip(20, 0);
    bench.flip(SLOT + 20, 0);
    bench.save(&with_gain(3));
    assert!(bench.loaded().1.other_damaged);
    bench.save(&with_gain(4));
    let (loaded, report) = bench.loaded();
    assert_eq!((loaded, report.other_damaged), (with_gain(4), false));
}

#[test]
fn bytes_that_the_flash_can_not_read_count_as_damage() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1), &with_gain(2)]);
    bench.flash.unreadable = SLOT + 100..SLOT + 101;
    let (loaded, report) = bench.loaded();
    assert_eq!((loaded, report.other_damaged), (with_gain(1), true));
    bench.flash.unreadable = 0..2 * SLOT;
    assert_eq!(bench.load().outcome, Outcome::Damaged);
}

#[test]
fn a_word_that_does_not_hold_what_was_written_fails_the_save_and_keeps_the_configuration() {
    let mut bench = StorageBench::with_saved(&[&with_gain(1)]);
    bench.flash.unreadable = SLOT + 100..SLOT + 101;
    assert_eq!(
        bench.store.save(&mut bench.flash, &with_gain(2), &MoveRecords::default()),
        Err(SaveError::NotAsWritten)
    );
    bench.flash.unreadable = 0..0;
    bench.flip(SLOT + 100, 0);
    assert_eq!(bench.loaded().0, with_gain(1));
}

#[test]
fn wear_alternates_between_the_slots() {
    let mut bench = StorageBench::blank();
    (0..101).for_each(|gain| {
        bench.save(&with_gain(gain));
    });
    let (first, second) = bench.flash.erases.split_at(7);
    assert_eq!(first, [50; 7], "the first save found a blank slot");
    assert_eq!(second, [50; 7]);
}

#[test]
fn the_newest_configuration_is_found_across_the_wrap_of_the_generation() {
    let mut bench = StorageBench::blank();
    let entries: Vec<_> = with_gain(0).iter().map(pair).collect();
    bench.flash.put(0, &record(b"PDcf", 1, 6, u32::MAX - 3, &entries));
    for step in 0..8_u32 {
        let generation = bench.save(&with_gain(step as i32));
        assert_eq!(generation, (u32::MAX - 2).wrapping_add(step));
        let (loaded, report) = bench.loaded();
        assert_eq!((loaded, report.generation), (with_gain(step as i32), generation));
    }
}

#[test]
fn slots_are_whole_sectors_of_the_flash_with_room_that_do_not_overlap() {
    let flash = Nor::new(14);
    let new = |first, second| ConfigStore::new(&flash, [first, second]).map(|_| ());
    assert_eq!(new(0..SLOT, SLOT..2 * SLOT), Ok(()));
    assert_eq!(new(SLOT..2 * SLOT, 0..SLOT), Ok(()));
    assert_eq!(new(8..SLOT, SLOT..2 * SLOT), Err(LayoutError::NotWholeSectors));
    assert_eq!(new(0..SLOT, SLOT..2 * SLOT - 8), Err(LayoutError::NotWholeSectors));
    assert_eq!(new(0..SLOT, SLOT..2 * SLOT + 512), Err(LayoutError::OutsideFlash));
    assert_eq!(new(0..SLOT, SLOT - 512..2 * SLOT - 512), Err(LayoutError::Overlap));
    assert_eq!(new(0..SLOT, 0..SLOT), Err(LayoutError::Overlap));
    assert_eq!(new(0..512, SLOT..2 * SLOT), Err(LayoutError::TooShort));
    assert_eq!(new(Range { start: SLOT, end: 0 }, SLOT..2 * SLOT), Err(LayoutError::TooShort));
}

/// Firmware without records reads them as unknown pairs, so it keeps the parameters.
#[test]
fn records_are_pairs_beside_the_parameters_and_come_back() {
    let told = ProfiledMove { at_sample: 9, target: -7, kind: 1, numbers: [300, 50, 7, 0, 0, 0] };
    let mut records = MoveRecords::default();
    records.put(2, told).expect("a place");
    let mut bench = StorageBench::blank();
    bench.store.save(&mut bench.flash, &with_gain(3), &records).expect("saved");
    let bytes: Vec<u8> = records.pairs().flat_map(pair).collect();
    assert_eq!(bytes[..12], [0x20, 0x80, 9, 0, 0, 0, 0x21, 0x80, 0xf9, 0xff, 0xff, 0xff]);
    assert_eq!(bytes[48..], [0x28, 0x80, 1, 0, 0, 0]);
    let written = 14 + 6 * pairs() as usize;
    assert_eq!(bench.flash.bytes[written..written + 54], bytes[..]);
    let load = bench.load();
    assert_eq!((&load.parameters, &load.records), (&with_gain(3), &records));
    assert!(matches!(load.outcome, Outcome::Loaded(Report { unknown: 0, out_of_range: 0, missing: 0, .. })));
}

#[test]
fn the_hash_is_the_crc_of_the_pairs_and_tells_configurations_apart() {
    let bytes: Vec<u8> = with_gain(5).iter().flat_map(pair).collect();
    assert_eq!(configuration_hash(&with_gain(5)), crc32(&bytes));
    assert_ne!(configuration_hash(&with_gain(5)), configuration_hash(&with_gain(6)));
}

proptest! {
    #[test]
    fn any_configuration_comes_back_as_it_was_saved(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<i32>()), 0..50),
    ) {
        let ids: Vec<u16> = Parameters::default().iter().map(|(id, _)| id).collect();
        let mut parameters = Parameters::default();
        for (index, value) in changes {
            let _ = parameters.set(*index.get(&ids), value);
        }
        prop_assert_eq!(StorageBench::with_saved(&[&parameters]).loaded().0, parameters);
    }

    #[test]
    fn any_pairs_are_loaded_or_counted(
        pairs in prop::collection::btree_map(any::<u16>().prop_filter("of no move record", |id| id >> 8 != 0x80), any::<i32>(), 0..200),
    ) {
        let mut bench = StorageBench::blank();
        let entries: Vec<_> = pairs.clone().into_iter().map(pair).collect();
        bench.flash.put(0, &record(b"PDcf", 1, 6, 1, &entries));
        let mut expected = Parameters::default();
        let taken = pairs.into_iter().filter(|&(id, value)| expected.set(id, value).is_ok()).count();
        let (loaded, report) = bench.loaded();
        prop_assert_eq!(loaded, expected);
        let left_out = usize::from(report.unknown + report.out_of_range);
        prop_assert_eq!(taken + left_out, entries.len());
    }

    #[test]
    fn no_bytes_in_the_flash_are_too_strange(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        header in any::<bool>(),
    ) {
        let mut bench = StorageBench::blank();
        bench.flash.put(0, &[if header { &b"PDcf"[..] } else { &[] }, &bytes].concat());
        prop_assert_eq!(bench.load().outcome, Outcome::NeverSaved, "no seal");
        bench.save(&with_gain(1));
        prop_assert_eq!(bench.loaded().0, with_gain(1));
    }
}
