//! `pneudrive device go` and `device jog`: slow moves by hand, as the studio has them.

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;
use pneudrive_session::slow_move::{self, JOG_MM_PER_S, Standing};
use pneudrive_session::test_run::TestRun;
use pneudrive_sim::component::encoder::mm_per_count;
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
    moved(client, rig, &|rig, there, from_mm| slow_move::jog(rig, there, from_mm, by_mm, JOG_MM_PER_S))
}

/// Moves the drive, which is armed for that and holds afterwards. What is refused changes nothing on it.
fn moved(client: &mut Client, rig: &str, test: Move<'_>) -> Result<()> {
    let (name, rig) = (rig, load_rig(rig, &[])?);
    let Standing { there, from_mm } = Standing::of(client, name, &rig)?;
    let units = Units::of(&there);
    let test = test(&rig, &there, from_mm)?;
    run_test(client, TestRun::of(&test), None)?;
    let position = client.status()?.position;
    tell_a_miss(&test, position);
    json::figures(
        || json!({ "from_mm": from_mm, "position_counts": position, "position_mm": units.millimetres(position) }),
    );
    say!("the axis is at {}, from {from_mm:.3} mm", units.length(position));
    say!("the drive holds; `pneudrive device disarm` releases it");
    Ok(())
}

/// Says so where a move has not come within the tolerance of its end.
fn tell_a_miss(test: &Rig, position: i32) {
    let Some(&(_, target)) = test.moves().last() else { return };
    let mm = mm_per_count(test);
    let off_mm = (i64::from(position) - target) as f64 * mm;
    let tolerance_mm = test.get(&keys::controller::TOLERANCE_COUNTS) as f64 * mm;
    if off_mm.abs() > tolerance_mm.max(mm) {
        let target_mm = target as f64 * mm;
        tell!(
            "note: it is {:.3} mm from {target_mm:.3} mm; `pneudrive device status` shows whether it still moves",
            off_mm.abs()
        );
    }
}
