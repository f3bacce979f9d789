//! `pneudrive device learned`.

use anyhow::Result;
use pneudrive_controller::choice::Adapt;
use pneudrive_controller::law::cascade::kept::{Changed, Kept};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_sim::component::actuator::Actuator;
use pneudrive_sim::{Rig, keys};
use serde_json::json;

use super::super::rig_source::load_rig;
use crate::json;

pub(super) fn execute(client: &mut Client, rig: Option<&str>, forget: bool) -> Result<()> {
    let rig = rig.map(|rig| load_rig(rig, &[])).transpose()?;
    if forget {
        return forget_it(client);
    }
    let shown = Shown::of(&client.parameters()?, rig.as_ref());
    json::figures(|| shown.figures());
    say!("{}", shown.text());
    Ok(())
}

/// Begins afresh: neither what is kept nor what the last run has learned counts any more.
fn forget_it(client: &mut Client) -> Result<()> {
    let was_stored = client.config_state()?.saved;
    // A change of any parameter takes what the last run has learned with it.
    client.set_parameters(id::KEPT_AT_BOUND, &[1])?;
    client.change_parameters(&Kept::default().values())?;
    let stored = if was_stored { client.save_parameters().map(|()| "") } else { Ok(FORGOTTEN_UNTIL_RESET) };
    let shown = Shown::of(&client.parameters()?, None);
    json::figures(|| shown.figures());
    say!("forgotten: the next run begins with what the rig file says{}", stored?);
    Ok(())
}

const FORGOTTEN_UNTIL_RESET: &str = "; other parameters have changed since they were stored, so nothing was stored: `device config save` does";

/// What a drive keeps, in units.
struct Shown {
    keeps: bool,
    kept: Kept,
    changed: Option<(&'static str, &'static str)>,
    lag_ms: f64,
    /// kg and N, as far as the rig file is there.
    mass_kg: Option<f64>,
    force_n: Option<f64>,
}

/// A part in 2^-16.
fn part(value: i32) -> f64 {
    f64::from(value) / 65_536.0
}

/// A number in 2^-24.
fn fine(value: i32) -> f64 {
    f64::from(value) / 16_777_216.0
}

impl Shown {
    fn of(parameters: &RigParameters, rig: Option<&Rig>) -> Shown {
        let get = |id| parameters.values.get(id).unwrap_or(0);
        let kept = Kept::of(&parameters.values);
        let lag_ms = part(get(id::CASCADE_SPOOL_LAG)) * f64::from(get(id::PERIOD_US)) / 1e3;
        // The supply on area 1.
        let newtons = rig.map(|rig| rig.get(&keys::supply::PRESSURE_PA) * Actuator::of(rig).area_1);
        let stiction = fine(get(id::CASCADE_STICTION));
        Shown {
            keeps: get(id::ADAPT) == Adapt::Kept as i32,
            kept,
            changed: changed(parameters),
            lag_ms: lag_ms * part(kept.learned.pace),
            mass_kg: rig.map(|rig| rig.get(&keys::load::MASS_KG) * part(kept.learned.mass)),
            force_n: newtons.map(|newtons| newtons * stiction * fine(kept.learned.force)),
        }
    }

    fn figures(&self) -> serde_json::Value {
        let learned = &self.kept.learned;
        json!({
            "adapt": if self.keeps { Adapt::Kept.word() } else { Adapt::Afresh.word() },
            "armings": self.kept.armings, "changed": self.changed.map(|(word, _)| word),
            "mass_ratio": part(learned.mass), "friction_ratio": part(learned.friction),
            "lag_ratio": part(learned.pace), "viscous_ratio": 1.0 + fine(learned.viscous),
            "force_stictions": fine(learned.force), "looseness": learned.looseness,
            "lag_ms": self.lag_ms, "mass_kg": self.mass_kg, "force_n": self.force_n,
        })
    }

    fn text(&self) -> String {
        if !self.keeps {
            return "nothing is kept: each arming begins with what the rig file says (controller.adapt = \"kept\" keeps)"
                .to_owned();
        }
        let learned = &self.kept.learned;
        let in_units =
            |value: Option<f64>, unit| value.map_or(String::new(), |value| format!(", {value:.2} {unit}"));
        let mut lines = vec![
            format!("kept of     {} armings", self.kept.armings),
            format!("mass        {:.3} of the rig file{}", part(learned.mass), in_units(self.mass_kg, "kg")),
            format!("friction    {:.3} of the rig file", part(learned.friction)),
            format!("viscous     {:.3} of the rig file", 1.0 + fine(learned.viscous)),
            format!("force       {:.3} stictions{}", fine(learned.force), in_units(self.force_n, "N")),
            format!("valve lag   {:.3} of the rig file, {:.2} ms", part(learned.pace), self.lag_ms),
            format!("looseness   {}", learned.looseness),
        ];
        lines.extend(self.changed.map(|(_, advice)| format!("changed     {advice}")));
        lines.join("\n")
    }
}

/// Why the law of a drive that keeps what it learns began afresh of late: a word, and what that means.
pub(super) fn changed(parameters: &RigParameters) -> Option<(&'static str, &'static str)> {
    let keeps = parameters.values.get(id::ADAPT) == Some(Adapt::Kept as i32);
    match Kept::of(&parameters.values).changed {
        _ if !keeps => None,
        Changed::No => None,
        Changed::AtBound => Some((
            "at-bound",
            "what it learned stayed at a bound, and it began afresh: check mass, force and valve of the rig file",
        )),
        Changed::Jumped => Some((
            "jumped",
            "a run found another drive than the one before, and it began afresh: a load that differs from run to run is not kept",
        )),
        Changed::Tripped => Some(("tripped", "a run tripped, and it began afresh: see `device faults`")),
    }
}
