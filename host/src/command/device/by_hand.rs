//! `pneudrive device go` and `device jog`: slow moves by hand, as the studio has them.

use anyhow::{Result, anyhow};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;
use pneudrive_session::slow_move;
use pneudrive_session::test_run::TestRun;
use pneudrive_sim::{Rig, keys};
use serde_json::json;

use crate::command::rig_source::load_rig;
use crate::command::run::run_test;
use crate::json;

/// The test that moves a drive with these parameters from a place, mm.
type Move<'a> = &'a dyn Fn(&Rig, &RigParameters, f64) -> Result<Rig>;

pub(super) fn go(client: &mut Client, rig: &str, to_mm: f64) -> Result<()> {
    moved(client, rig, &|rig, there, from_mm| slow_move::go(rig, there, from_mm, to_mm))
}

pub(super) fn jog(client: &mut Client, rig: &str, by_mm: f64) -> Result<()> {
    moved(client, rig, &|rig, there, from_mm| slow_move::jog(rig, there, from_mm, by_mm))
}

/// Moves the drive, which is armed for that and holds afterwards. What is refused changes nothing on it.
fn moved(client: &mut Client, rig: &str, test: Move<'_>) -> Result<()> {
    let (name, rig) = (rig, load_rig(rig, &[])?);
    let there = client.parameters()?;
    refuse_other_counts(name, &rig, &there)?;
    let units = Units::of(&there);
    let from = units.millimetres(client.status()?.position);
    let from_mm = from.ok_or_else(|| anyhow!("the rig does not tell how long a count of its encoder is"))?;
    run_test(client, TestRun::of(&test(&rig, &there, from_mm)?), None)?;
    let position = client.status()?.position;
    json::figures(
        || json!({ "from_mm": from_mm, "position_counts": position, "position_mm": units.millimetres(position) }),
    );
    say!("the axis is at {}, from {from_mm:.3} mm", units.length(position));
    say!("the drive holds; `pneudrive device disarm` releases it");
    Ok(())
}

/// Refuses a drive whose counts have another length than those of the rig file.
fn refuse_other_counts(name: &str, rig: &Rig, there: &RigParameters) -> Result<()> {
    let key = keys::encoder::MM_PER_COUNT.path;
    let length = id::ENCODER_PM_PER_COUNT;
    if there.values.get(length) == rig.parameters().get(length) {
        return Ok(());
    }
    Err(Failure::Refused.error(format!(
        "{key} of the drive is not that of {name}: name the drive's own rig file with --rig; nothing was changed"
    )))
}
