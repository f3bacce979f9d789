//! Where the spool of a stepper valve is, through a reset ([`pneudrive_app::runtime::spool`]).

use core::ptr::{read_volatile, write_volatile};

use pneudrive_app::runtime::spool::SpoolMemory;

use crate::reset::Kept;

#[unsafe(link_section = ".uninit.spool")]
static SPOOL: Kept<[u32; 2]> = Kept::new();

/// The memory. There is one, and the board has it.
pub struct KeptSpool;

impl SpoolMemory for KeptSpool {
    #[inline]
    fn keep(&mut self, words: [u32; 2]) {
        // SAFETY: the board belongs to one task at a time, and nobody else writes this.
        unsafe { write_volatile(SPOOL.get(), words) }
    }

    fn kept(&self) -> [u32; 2] {
        // SAFETY: any eight bytes are two numbers; as for writing.
        unsafe { read_volatile(SPOOL.get()) }
    }
}
