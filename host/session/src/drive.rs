//! A drive armed, homed, and told where its axis stands.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_protocol::Mode;
use pneudrive_records::words;

use crate::firmware_notes::{report_armed, report_boots, report_run_input};

/// Enables the drive with the valve at null; clears a fault. What does not protect it then goes to the log.
///
/// ```
/// use pneudrive_link::client::Client;
/// use pneudrive_protocol::Mode;
/// use pneudrive_rigs::virtual_rig::Background;
///
/// let served = Background::of(pneudrive_sim::Rig::builtin("servo-b").expect("a built-in rig"))?;
/// let mut client = Client::connect(served.port())?;
/// client.stop()?;
/// assert_eq!(client.status()?.mode, Mode::Fault);
/// pneudrive_session::drive::arm(&mut client)?;
/// assert_eq!(client.status()?.mode, Mode::Armed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the rig refuses or does not answer.
pub fn arm(client: &mut Client) -> Result<()> {
    report_boots(client);
    report_armed(&client.arm()?);
    report_run_input(client);
    Ok(())
}

/// How an axis came to its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Homed {
    /// It moved to its stop or switch.
    Moved,
    /// It has an absolute encoder, and needs none.
    Absolute,
}

/// Homes the axis and waits for the end. `goes_on` is asked meanwhile; an error of it stops the drive.
///
/// # Errors
/// When the drive refuses, trips or does not answer, and the error of `goes_on`.
pub fn home(client: &mut Client, goes_on: &mut dyn FnMut() -> Result<()>) -> Result<Homed> {
    report_boots(client);
    let parameters = client.parameters()?.values;
    if parameters.absolute_zero().is_some() && client.status()?.referenced {
        return Ok(Homed::Absolute);
    }
    let timeout_ms = parameters.get(id::HOMING_TIMEOUT_MS).unwrap_or(0).unsigned_abs();
    // The rig trips at its own timeout; an emulated one may run several times slower than real time.
    let longest = Duration::from_millis((10 * u64::from(timeout_ms)).max(5000));
    client.home()?;
    let begun = Instant::now();
    while client.status()?.mode == Mode::Homing {
        if begun.elapsed() > longest {
            client.stop()?;
            bail!(
                "homing was still running long after its timeout of {} s; the drive was stopped",
                f64::from(timeout_ms) / 1e3
            );
        }
        if let Err(error) = goes_on() {
            client.stop()?;
            return Err(error);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let status = client.status()?;
    if status.mode == Mode::Fault {
        return Err(Failure::Tripped.error(format!(
            "the drive tripped during homing: {} ({}); arming it clears the fault",
            words::fault_code_name(status.fault),
            words::fault_meaning(status.fault)
        )));
    }
    Ok(Homed::Moved)
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
