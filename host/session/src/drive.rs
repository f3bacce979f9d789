//! A drive armed, and told where its axis stands.

use anyhow::Result;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;

use crate::firmware_notes::{report_armed, report_boots, report_run_input};

/// Enables the drive with the valve at null; clears a fault. What does not protect it then goes to the log.
///
/// # Errors
/// When the rig refuses or does not answer.
pub fn arm(client: &mut Client) -> Result<()> {
    report_boots(client);
    report_armed(&client.arm()?);
    report_run_input(client);
    Ok(())
}

/// States that the axis stands at `count` now. Returns the zero of an absolute encoder, which is set for that; None of an
/// incremental one, whose counter is set.
///
/// # Errors
/// When the rig refuses or does not answer.
pub fn reference(client: &mut Client, count: i32) -> Result<Option<i32>> {
    let zero = match client.parameters()?.values.absolute_zero() {
        Some(zero) => set_zero(client, zero, count)?,
        None => None,
    };
    if zero.is_none() {
        client.reference(count)?;
    }
    Ok(zero)
}

/// Sets the zero of an absolute encoder so that the axis stands at `count`; None if the board has none that is absolute.
///
/// The first change brings what counts mean in line with the parameter, whatever was referenced before.
fn set_zero(client: &mut Client, zero: i32, count: i32) -> Result<Option<i32>> {
    let other = zero ^ 1;
    client.set_parameters(id::ENCODER_ZERO_COUNTS, &[other])?;
    let status = client.status()?;
    if !status.referenced {
        return Ok(None);
    }
    let zero = other.wrapping_add(count).wrapping_sub(status.position);
    client.set_parameters(id::ENCODER_ZERO_COUNTS, &[zero])?;
    Ok(Some(zero))
}
