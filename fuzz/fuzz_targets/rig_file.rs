#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| pneudrive_fuzz::rig_file(data));
