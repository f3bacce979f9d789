//! The PC's end of the flash bus.

use anyhow::{Result, bail, ensure};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_app::flash_bus::{DONE, Operation, Request};
use pneudrive_rigs::persistent_flash::{PersistentFlash, PowerOff};

use super::pipes::Pipes;
use crate::plant_server::Bus;

/// Serves the flash until the board has gone; true if its power was cut.
pub(super) fn serve(flash: &mut PersistentFlash, mut bus: Pipes) -> Result<bool> {
    while let Some(request) = bus.read()? {
        let Some(request) = Request::from_bytes(request) else {
            bail!("the board sent its flash an unknown request: {request:?}")
        };
        match carry_out(flash, request, &mut bus)? {
            Ok(answer) => bus.write(&answer)?,
            Err(PowerOff) => return Ok(true),
        }
    }
    Ok(false)
}

fn carry_out(
    flash: &mut PersistentFlash,
    Request { operation, offset, length }: Request,
    bus: &mut Pipes,
) -> Result<Result<Vec<u8>, PowerOff>> {
    if offset.checked_add(length).is_none_or(|end| end as usize > flash.capacity()) {
        bail!("the board requested {length} bytes at {offset}, which is outside its flash");
    }
    let mut bytes = vec![0; length as usize];
    Ok(match operation {
        Operation::Read => flash.read(offset, &mut bytes).map(|()| bytes),
        Operation::Erase => flash.erase(offset, offset + length).map(|()| vec![DONE]),
        Operation::Write => {
            ensure!(bus.fill(&mut bytes)?, "the board ended in the middle of a write");
            flash.write(offset, &bytes).map(|()| vec![DONE])
        }
    })
}
