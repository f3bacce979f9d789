//! `pneudrive virtual`.

use std::sync::atomic::AtomicBool;

use anyhow::Result;

use super::load_choice;
use crate::cli::Virtual;
use crate::virtual_rig::{Door, Pace, VirtualRig};

pub(super) fn execute(arguments: &Virtual) -> Result<()> {
    let nominal = load_choice(&arguments.rig)?;
    let rig = match arguments.spread {
        Some(fraction) => nominal.spread(fraction, arguments.seed)?,
        None => nominal,
    };
    let mut door = Door::open(&arguments.listen)?;
    let port = door.port_name().to_owned();
    let name = rig.name().to_owned();
    let pace = Pace { fast: arguments.fast, live: arguments.live };
    let mut virtual_rig = VirtualRig::new(rig, arguments.seed, pace)?;
    say!("{name} is on {port}");
    say!("try: pneudrive device --port {port} info    (end with Ctrl-C)");
    virtual_rig.serve(&mut door, &AtomicBool::new(false))
}
