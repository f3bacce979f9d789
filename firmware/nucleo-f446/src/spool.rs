//! Where the spool of a stepper valve is, through a reset ([`pneudrive_nucleo_plan::spool`]).

use core::ptr::{read_volatile, write_volatile};

use pneudrive_controller::drive::SpoolLocation;
use pneudrive_nucleo_plan::spool;

use crate::reset::Kept;

#[unsafe(link_section = ".uninit.spool")]
static SPOOL: Kept<[u32; 2]> = Kept::new();

/// Keeps where the spool is. Only whoever has the board calls it.
pub fn keep(location: SpoolLocation) {
    // SAFETY: the board belongs to one task at a time, and nobody else writes this.
    unsafe { write_volatile(SPOOL.get(), spool::words(location)) }
}

/// Where it was before the reset, if that was kept.
pub fn kept() -> Option<SpoolLocation> {
    // SAFETY: any eight bytes are two numbers; as for writing.
    spool::location(unsafe { read_volatile(SPOOL.get()) })
}
