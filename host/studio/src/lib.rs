//! `pneudrive studio`: designs, tries out and commissions a drive in the browser.
//!
//! ```text
//! page (host/page)  ->  guard  ->  its requests on threads of their own  ->  page
//!                              ->  rig files of one folder
//!                              ->  a rig at a port
//! ```
//!
//! The server keeps no rig: every request brings the text of the rig file and the settings of the page. So a killed
//! server loses nothing.
//!
//! | module | holds |
//! |---|---|
//! | [`token`], [`guard`], `refusal_response` | which requests are allowed, the headers of every answer, and refusals |
//! | [`served`] | the files of the page, and its requests |
//! | [`files`] | rig files that are opened and saved |
//! | [`study`] | studies for the page, with progress line by line |
//! | [`commission`] | commissions a rig at a port from the page |
//! | [`server`], [`connections`] | the routes, the address, and which connections may stay |

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod commission;
pub mod connections;
pub mod files;
pub mod guard;
mod refusal_response;
pub mod served;
pub mod server;
pub mod study;
pub mod token;

pub use pneudrive_page::rigs::Opened;
pub use server::{Options, Studio};
