//! The PC's end of the flash bus.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};

use anyhow::{Context, Result, bail};
use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use pneudrive_app::flash_bus::{DONE, Operation, Request};

use crate::kept_flash::{Dark, KeptFlash};

/// Serves the flash until the board has gone; true when it went because its power was cut.
pub(super) fn serve(flash: &mut KeptFlash, mut requests: File, mut answers: File) -> Result<bool> {
    let mut request = [0; Request::BYTES];
    loop {
        match requests.read_exact(&mut request) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(false),
            Err(error) => return Err(error).context("the flash bus broke"),
        }
        let Some(request) = Request::from_bytes(request) else {
            bail!("the board asked its flash for what there is not: {request:?}")
        };
        match carry_out(flash, request, &mut requests)? {
            Ok(answer) => answers.write_all(&answer)?,
            Err(Dark) => return Ok(true),
        }
    }
}

fn carry_out(
    flash: &mut KeptFlash,
    Request { operation, offset, length }: Request,
    requests: &mut File,
) -> Result<Result<Vec<u8>, Dark>> {
    if offset.checked_add(length).is_none_or(|end| end as usize > flash.capacity()) {
        bail!("the board asked for {length} bytes at {offset}, which is outside of its flash");
    }
    let mut bytes = vec![0; length as usize];
    Ok(match operation {
        Operation::Read => flash.read(offset, &mut bytes).map(|()| bytes),
        Operation::Erase => flash.erase(offset, offset + length).map(|()| vec![DONE]),
        Operation::Write => {
            requests.read_exact(&mut bytes).context("the board ended in the middle of a write")?;
            flash.write(offset, &bytes).map(|()| vec![DONE])
        }
    })
}
