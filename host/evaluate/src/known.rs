//! What the law of a record knew of its drive. The controller is deterministic: on the recorded inputs it computes the same
//! again.

use anyhow::{Result, bail};
use pneudrive_controller::parameters::{TABLE, id};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::Rig;
use pneudrive_sim::known::Units;
use pneudrive_sim::trace::Extra;

use crate::evaluation::refuse_other_rig;
use crate::replay::parameters::Header;
use crate::replay::{Replay, replay_watched};
use crate::transient::Transient;

/// Parameters of the law's model that its units go by.
const MODEL: [u16; 5] = [
    id::PERIOD_US,
    id::CASCADE_PRESSURE_GAIN,
    id::CASCADE_AREA_RATIO,
    id::CASCADE_ACCELERATION,
    id::CASCADE_SPOOL_LAG,
];

/// A replay with what its law knew, in the units of the rig that the record is of.
///
/// # Errors
/// When the record cannot be replayed, has another law, or is of a drive that its controller took for another one than this rig.
pub fn replay_of_rig(name: &str, file: &TargetFile, rig: &Rig) -> Result<Replay> {
    let Some(units) = Units::of(rig) else {
        bail!("{} has no law that knows its drive: controller.law = \"cascade\", in closed loop", rig.name());
    };
    refuse_other_rig(&Transient::of_target(name, file)?, rig)?;
    let (theirs, ours) = (Header::of(file)?.parameters, rig.parameters());
    let differs = |id: &&u16| theirs.get(**id) != ours.get(**id);
    if theirs.get(id::LAW) != ours.get(id::LAW) {
        bail!("{name} was recorded with another law than \"cascade\"");
    }
    if let Some(id) = MODEL.iter().find(differs) {
        let parameter =
            TABLE.iter().find(|parameter| parameter.id == *id).map_or("a parameter", |found| found.name);
        bail!(
            "{name} was recorded with another {parameter} than {} has: its law took it for another drive",
            rig.name()
        );
    }
    Ok(replay_watched(file, Some(&units))?)
}

impl Replay {
    /// The columns of what the law knew, a number for each recorded sample; not a number before its first. None without a rig.
    #[must_use]
    pub fn known_columns(&self, rig: &Rig) -> Vec<(&'static Extra, Vec<f64>)> {
        let value = |extra: &Extra| {
            let of = |known: &Option<_>| {
                known.as_ref().and_then(|known| extra.of_known(known)).unwrap_or(f64::NAN)
            };
            self.known.iter().map(of).collect()
        };
        let columns = Extra::of_law(rig).into_iter().filter(|_| !self.known.is_empty());
        columns.map(|extra| (extra, value(extra))).collect()
    }
}
