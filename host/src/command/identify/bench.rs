//! `pneudrive identify --plan`: runs the plan's tests on the rig at a port.

use std::path::Path;

use anyhow::{Error, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_identify::plan::{self, NEEDS_PRESSURES, Recorded, TestRig};
use pneudrive_link::client::Client;
use pneudrive_records::target::TargetFile;
use pneudrive_records::units::lacks_pressures;
use pneudrive_session::borrowed::lend;
use pneudrive_session::test_run::{TestRun, ready_for, wait_for_air};
use pneudrive_sim::Rig;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::keys;

use super::kept::Kept;
use crate::cli::RigChoice;
use crate::command::interrupts::Interrupts;
use crate::command::record::record;
use crate::command::rig_source::load_rig;
use crate::command::run::run_test;
use crate::exit::Exit;

/// An axis is level within this angle, degrees.
const LEVEL_DEG: f64 = 2.0;

/// Opens the valve for a moment, and refuses a drive that does not move as it should.
///
/// # Errors
/// As for [`plan::check_direction`].
pub(in crate::command) fn check_direction(
    choice: &RigChoice,
    client: &mut Client,
    folder: &Path,
) -> Result<()> {
    let open = with_loop(choice, Loop::Open)?;
    client.disarm()?;
    let count = client.status()?.position;
    lend(client, &[id::OPEN_LOOP], |client| {
        plan::check_direction(&mut AtPort { client, folder, kept: None, left_at: count }, &open, count)
    })
}

fn with_loop(choice: &RigChoice, control_loop: Loop) -> Result<Rig> {
    let with = keys::controller::LOOP.setting(control_loop.word());
    load_rig(&choice.rig, &[&choice.settings[..], &[with]].concat())
}

/// Runs the tests on a rig and writes their TARGET files to a folder.
pub(super) fn execute(choice: &RigChoice, client: &mut Client, folder: &Path) -> Result<(Recorded, Kept)> {
    let (closed, open) = (with_loop(choice, Loop::Closed)?, with_loop(choice, Loop::Open)?);
    let count = client.status()?.position;
    client.disarm()?;
    let parameters = client.parameters()?.values;
    if lacks_pressures(&parameters) {
        let port = client.port_name();
        bail!("the rig at {port} has no pressure sensors (pressure_sensors is 0): {NEEDS_PRESSURES}");
    }
    if let Some(note) = of_hanging_load(&closed) {
        tell!("{note}");
    }
    let mut kept = Kept::open(folder, &closed, count)?;
    if kept.len() > 0 {
        tell!(
            "the plan goes on behind the {} tests that an interrupted one has recorded; without {} it runs all of them",
            kept.len(),
            kept.path().display()
        );
    }
    let count = kept.count;
    // If this program is killed, the next plan restores the loop.
    let recorded = lend(client, &[id::OPEN_LOOP], |client| {
        let left_at = client.status()?.position;
        plan::run(&mut AtPort { client, folder, kept: Some(&mut kept), left_at }, &closed, &open, count)
    })
    .map_err(of_trip)?;
    Ok((recorded, kept))
}

/// The warning about a hanging load during a plan; None if the axis is level as far as a file can say.
pub(in crate::command) fn of_hanging_load(rig: &Rig) -> Option<String> {
    let incline = rig.get(&keys::load::INCLINE_DEG);
    (incline.abs() > LEVEL_DEG).then(|| {
        format!(
            "note: the axis is inclined by {incline} degrees. Between the tests, and if the drive trips, its valve is at null and only the air in the cylinder holds the load, which may sink: support it, or keep clear of its path"
        )
    })
}

/// A plan does not arm a drive that has tripped: the person at the drive has to look at it first.
fn of_trip(error: Error) -> Error {
    if Exit::after(&error) != Exit::Tripped {
        return error;
    }
    error.context(
        "the plan has ended: the valve is at its null, and only the air in the cylinder holds a load that hangs; the records so far are kept, and once the drive is armed and disarmed, the same command goes on behind them",
    )
}

/// A rig at a port, the folder for its records, and those that are there.
struct AtPort<'a> {
    client: &'a mut Client,
    folder: &'a Path,
    kept: Option<&'a mut Kept>,
    /// Where the last run left the piston, counts.
    left_at: i32,
}

impl TestRig for AtPort<'_> {
    fn run(&mut self, test: &Rig) -> Result<()> {
        // Ctrl-C ends a wait, and does not arm the drive any more.
        let interrupts = Interrupts::watch();
        ready_for(self.client, test, self.left_at, &mut || interrupts.refuse_if_seen())?;
        run_test(self.client, TestRun::of(test), None)?;
        self.left_at = self.client.status()?.position;
        // Armed, a drive that creeps at its null would trip while its record is fetched.
        self.client.disarm()
    }

    fn settle(&mut self) -> Result<()> {
        let interrupts = Interrupts::watch();
        wait_for_air(self.client, &mut || interrupts.refuse_if_seen())
    }

    fn record(&mut self, name: &str) -> Result<(String, TargetFile)> {
        let (path, file) = record(self.client, self.folder)?;
        say!("{}: {name}", path.display());
        Ok((path.file_name().unwrap_or_default().to_string_lossy().into_owned(), file))
    }

    fn kept(&mut self, name: &str) -> Option<(String, TargetFile)> {
        self.kept.as_deref_mut()?.record(name)
    }

    fn keep(&mut self, name: &str, file: &str) -> Result<()> {
        self.kept.as_deref_mut().map_or(Ok(()), |kept| kept.keep(name, file))
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_link::failure::Failure;
    use pneudrive_protocol::Mode;
    use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};

    use super::*;

    /// One that creeps at its null would trip while its record is fetched, however long that takes.
    #[test]
    fn a_drive_is_disarmed_as_soon_as_its_test_is_over() {
        let settings = ["controller.loop=open", "test.moves=[[0.0, 0]]", "test.duration_s=0.1"];
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let rig = rig.with_settings(&settings.map(str::to_owned)).expect("valid");
        let served = VirtualRig::new(rig.clone(), 1, Pace { fast: true, live: false }).expect("a rig");
        let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
        let mut client = Client::connect(served.port()).expect("it answers");
        let folder = tempfile::tempdir().expect("a folder");
        let mut kept = Kept::open(folder.path(), &rig, 0).expect("a folder");
        let left_at = client.status().expect("it answers").position;
        AtPort { client: &mut client, folder: folder.path(), kept: Some(&mut kept), left_at }
            .run(&rig)
            .expect("a run");
        assert_eq!(client.status().expect("it answers").mode, Mode::Disarmed);
    }

    #[test]
    fn a_load_that_hangs_is_told_of_before_a_plan_and_where_it_trips() {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        assert_eq!(of_hanging_load(&rig), None);
        let hanging = rig.with_settings(&["load.incline_deg=90".to_owned()]).expect("valid");
        let note = of_hanging_load(&hanging).expect("it hangs");
        assert!(note.contains("inclined by 90 degrees") && note.contains("support it"), "{note}");
        let tripped = of_trip(Failure::Tripped.error("the rig tripped"));
        assert!(
            format!("{tripped:#}")
                .contains("a load that hangs; the records so far are kept, and once the drive is armed and disarmed, the same command goes on behind them: the rig tripped")
        );
        assert_eq!(Exit::after(&tripped), Exit::Tripped);
        assert_eq!(format!("{:#}", of_trip(Failure::NoAnswer.error("gone"))), "gone");
    }
}
