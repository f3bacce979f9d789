//! Notes of the tool-chain go to Python's `logging`, to the logger "pneudrive".

use log::{LevelFilter, Log, Metadata, Record};
use pyo3::prelude::*;

struct Notes;

impl Log for Notes {
    fn enabled(&self, about: &Metadata<'_>) -> bool {
        about.target().starts_with("pneudrive") || about.target().starts_with("_pneudrive")
    }

    fn log(&self, note: &Record<'_>) {
        if !self.enabled(note.metadata()) {
            return;
        }
        let text = note.args().to_string();
        // An interpreter that is shutting down accepts no notes.
        let _ = Python::try_attach(|py| {
            let logger = py.import("logging")?.call_method1("getLogger", ("pneudrive",))?;
            logger.call_method1("info", ("%s", text)).map(drop)
        });
    }

    fn flush(&self) {}
}

/// Has notes logged from now on.
pub fn begin() {
    static NOTES: Notes = Notes;
    if log::set_logger(&NOTES).is_ok() {
        log::set_max_level(LevelFilter::Info);
    }
}
