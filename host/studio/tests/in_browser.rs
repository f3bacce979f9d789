//! All tests of this crate in a browser, as one program: `cargo xtask test web`.

mod browser;
mod browser_access;
mod browser_commission;
mod browser_compare;
mod browser_keys;
mod browser_memory;
mod browser_pictures;
mod browser_stop;
mod browser_study;
mod browser_window;
mod chromium;
mod opened;
mod simulated;
