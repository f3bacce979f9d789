//! The output of `pneudrive --version`: the rigs and files that this program understands, and how it was built.

use std::sync::LazyLock;

use pneudrive_identify::report;
use pneudrive_optimise::sweep::journal;
use pneudrive_protocol::VERSION;
use pneudrive_records::{run_folder, stream_file, target};
use pneudrive_sim::rigfile::BUILTIN;

/// The version, and a line for each thing that differs between two programs.
#[must_use]
pub fn long() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(text);
    &TEXT
}

fn text() -> String {
    let files =
        [target::FORMAT, stream_file::FORMAT, run_folder::FORMAT, journal::MARK.trim_end(), report::FORMAT];
    let rigs: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
    let parquet = if cfg!(feature = "parquet") { "yes" } else { "no (built without --features parquet)" };
    let lines = [
        ("protocol", VERSION.to_string()),
        ("files", files.join(", ")),
        ("rigs", rigs.join(", ")),
        ("parquet", parquet.to_owned()),
        ("processor", format!("{}, {}", std::env::consts::ARCH, arithmetic())),
    ];
    let lines = lines.iter().map(|(name, text)| format!("\n{name:<11}{text}"));
    format!("{}{}", env!("CARGO_PKG_VERSION"), lines.collect::<String>())
}

/// How many numbers an instruction computes. It makes a difference to the time alone.
const fn arithmetic() -> &'static str {
    if cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128")) {
        "two numbers an instruction"
    } else {
        "one number an instruction"
    }
}
