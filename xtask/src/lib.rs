//! The commands of developers and CI, which run the same (`cargo xtask ci`).
//!
//! | module | holds |
//! |---|---|
//! | [`steps`] | the commands: fmt, lint, test, docs, probe, ci |
//! | [`tally`] | what passed, what failed; work continues after a failure |
//! | [`flashed`] | runs the image of the Nucleo board with models of its peripherals |
//! | [`boards`] | builds the images for the Nucleo board and the Pico 2 and judges their size and their control |
//! | [`book`] | the documents as a book of pages |
//! | [`dist`] | a release: crates, wheel, images, bills of materials, sums |
//! | [`deny`] | licences, sources and advisories of other people's code |
//! | [`link`] | the link under faults: often, and in all its states |
//! | [`targets`] | builds for other systems |
//! | [`web`] | the studio's page as a folder of files, with the designer as WebAssembly |
//! | [`tools`] | installs the programs that tests need besides Rust |
//! | [`programs`] | the test programs of the workspace, run side by side |
//! | [`examples`] | the examples for readers of the libraries, run and compared |
//! | [`axe`] | fetches the checker of barriers in a page |
//! | [`python`] | builds, installs and tests the Python package |
//! | [`fmu`] | has another program load the FMUs |
//! | [`venv`] | environments of Python for tests |
//! | [`probe`] | builds the probe image of the firmware and judges it |
//! | [`image`] | reads an image: its symbols, its code, forbidden content |
//! | [`forbidden`] | which symbols those are |
//! | [`memory`] | what the images take of flash, memory and stack |
//! | [`instructions`] | what the simulator needs for its runs, and the table that holds it |
//! | [`processors`] | the simulator's results on emulated processors |
//! | [`stack`] | the most stack that a function of an image takes |
//! | [`frame`] | the stack use of an instruction |
//! | [`thumb`] | the instructions of a section, as far as the verdict needs them |
//! | `first_component` | tries the component that a page has its reader type |
//! | `structure`, `documents` | tests of the sources' structure, and of what the documents say of files |

pub mod axe;
pub mod boards;
pub mod book;
pub mod deny;
pub mod dist;
#[cfg(test)]
mod documents;
pub mod examples;
#[cfg(test)]
mod first_component;
pub mod flashed;
pub mod fmu;
pub mod forbidden;
pub mod frame;
pub mod image;
pub mod instructions;
pub mod link;
pub mod memory;
pub mod probe;
pub mod processors;
pub mod programs;
pub mod python;
pub mod stack;
pub mod steps;
#[cfg(test)]
mod structure;
pub mod tally;
pub mod targets;
pub mod thumb;
pub mod tools;
pub mod venv;
pub mod web;
