//! `pneudrive studio`: a drive designed, tried out and commissioned in the browser.
//!
//! ```text
//! page (host/page)  ->  guard  ->  its requests on threads of their own  ->  page
//!                              ->  rig files of one folder
//!                              ->  a rig at a port
//! ```
//!
//! The server keeps no rig: every request brings the text of the rig file and the settings made on the page, so a killed
//! server loses nothing.
//!
//! | module | holds |
//! |---|---|
//! | [`token`], [`guard`], [`refused`] | who may ask, what every answer says to the browser, and how the server says no |
//! | [`served`] | the files of the page, and its requests |
//! | [`files`] | rig files that are opened and saved |
//! | [`study`] | long work that the page asks for, told of line by line |
//! | [`commission`] | a rig at a port, moved from the page |
//! | [`server`], [`door`] | the routes, the address, and who may keep a connection |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod commission;
pub mod door;
pub mod files;
pub mod guard;
pub mod refused;
pub mod served;
pub mod server;
pub mod study;
pub mod token;

pub use pneudrive_page::rigs::Opened;
pub use server::{Options, Studio};
