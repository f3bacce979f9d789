//! How programs and images are built, for `cargo xtask` and for the tests that run images.
//!
//! | module | holds |
//! |---|---|
//! | [`cargo`] | how cargo and rustup are called, and where they build |
//! | [`firmware`] | builds an image of the boards |
//! | [`sources`] | copies of the sources, to be changed |
//! | [`figures`] | tables of documents that programs write and tests hold |

pub mod cargo;
pub mod figures;
pub mod firmware;
pub mod sources;
