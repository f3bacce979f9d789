//! Puts execution levels into service.

use anyhow::Result;
use pneudrive_sim::Rig;

use crate::Target;

/// Puts an execution level into service as a new board is: the parameters of the rig downloaded, the axis referenced
/// where it stands.
///
/// # Errors
/// When the execution level does not answer, or refuses.
pub fn commission(target: &dyn Target, rig: &Rig) -> Result<()> {
    let mut client = target.connect()?;
    client.import_parameters(&rig.parameters())?;
    let position = client.status()?.position;
    client.reference(position)
}
