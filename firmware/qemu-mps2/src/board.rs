//! What the board keeps, and the board as the application sees it.

use pneudrive_app::LockStep;
use pneudrive_app::fault_log::Memory;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::FlashStore;
use semihosting::io;

use crate::flash::BusFlash;

/// What is kept through a reset.
type Kept = FlashStore<BusFlash, &'static mut Memory>;

/// The emulated board, in lock step with its plant.
pub type EmulatedBoard = LockStep<Kept>;

/// The board with what it has kept.
pub fn take_up(memory: &'static mut Memory) -> io::Result<EmulatedBoard> {
    let kept = FlashStore::take_up(BusFlash::open()?, RamFlash::layout(), memory);
    let kept = kept.expect("the layout is that of this flash").0;
    Ok(LockStep::new("QEMU mps2-an386", kept).with_watchdog())
}
