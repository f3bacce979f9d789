//! A drive that keeps what it has learned: what its runs begin with, in its records and over a power cut.

use pneudrive_controller::Parameters;
use pneudrive_controller::law::cascade::kept::Kept;
use pneudrive_controller::parameters::{KEPT, is_learned};
use pneudrive_evaluate::replay::replay;
use pneudrive_link::client::Client;
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Accuracy, Rig, run_keeping};

use super::Start;
use super::keeping::StartSupplied;
use super::run::{assert_is_the_simulation, replayed, rig, run_on};

/// Writes and erases of a save are more than this.
const MIN_OPERATIONS: u64 = 20;

/// The drive of 32 x 250 mm that keeps what it learns, with 11 kg where its file says 8.38.
fn heavier(settings: &[&str]) -> Rig {
    let kept = ["controller.adapt=kept", "test.moves_mm=[[0.0, 60], [0.1, 120]]", "test.position_m=0.06"];
    let rig = rig("press", &[&kept[..], settings].concat());
    rig.with_plant(&["load.mass_kg=11".to_owned()]).expect("a plant")
}

fn parameters(client: &mut Client) -> Parameters {
    client.parameters().expect("an answer").values
}

/// Three runs one after the other, each with what the ones before have learned: their records are the simulations that begin so, and
/// replay. Without the parameters of the header that say so they do not.
///
/// # Panics
/// When a record is another one, or a replay is not what it should be.
pub fn each_run_begins_with_what_the_ones_before_have_learned(start: Start) {
    let rig = heavier(&["test.duration_s=0.7"]);
    let target = start(&rig);
    let mut client = target.connect().expect("a rig that answers");
    let mut kept = Kept::default();
    for armings in 0..3 {
        let what = format!("{}, run {armings}", target.name());
        run_on(&mut client, &rig);
        assert_eq!(Kept::of(&parameters(&mut client)), kept, "{what}");
        let simulated = run_keeping(&rig, Accuracy::of(&rig), &kept).expect("a transient");
        let record = client.record(|_, _| {}).expect("a record");
        assert_is_the_simulation(&what, &record, &simulated.observations);
        assert_eq!(replayed(&mut client).first, None, "{what}");
        assert_eq!(replays_afresh(&mut client), armings == 0, "{what}");
        client.disarm().expect("an answer");
        kept = simulated.kept.expect("the run tells what it has learned");
        assert_eq!(kept.armings, armings + 1, "{what}: {kept:?}");
    }
    assert!(kept.learned.mass > 76_000, "11 kg instead of 8.38: {kept:?}");
}

/// Whether the record replays without what its header says of earlier runs.
fn replays_afresh(client: &mut Client) -> bool {
    let info = client.info().expect("an answer");
    let mut parameters = client.parameters().expect("an answer");
    for id in KEPT {
        let usual = Parameters::default().get(id).expect("in the table");
        parameters.values.set(id, usual).expect("in range");
    }
    let (record, test) = (client.record(|_, _| {}).expect("a record"), client.test().expect("an answer"));
    let file = TargetFile::new(&record, &info, &parameters).expect("samples that files count to");
    replay(&file.with_test(&test)).expect("a record that can be replayed").first.is_none()
}

/// The power goes at each operation of the flash in turn while an arming stores what was learned: after it, the drive has what it
/// had kept before or what it keeps now, whole, and nothing else has changed.
///
/// # Panics
/// When it has not.
pub fn a_power_cut_while_it_is_stored_leaves_the_old_or_the_new(start: StartSupplied) {
    let rig = heavier(&["test.duration_s=0.4"]);
    let old = rig.parameters();
    let mut target = start(&rig);
    let mut found_old = 0;
    for nth in 1.. {
        let mut client = target.connect().expect("a rig that answers");
        client.disarm().expect("an answer");
        client.import_parameters(&old).expect("disarmed");
        client.save_parameters().expect("disarmed");
        run_on(&mut client, &rig);
        client.disarm().expect("an answer");
        target.cut_power_at(nth);
        let armed = client.arm().is_ok();
        drop(client);
        target.power_up().expect("it starts again");
        let mut client = target.connect().expect("a rig that answers");
        let (state, found) = (client.config_state().expect("an answer"), parameters(&mut client));
        assert_eq!((state.source, state.saved, state.ignored), (1, true, 0), "stored, and in force");
        let kept = Kept::of(&found);
        let mut others = found.iter().zip(old.iter()).filter(|(found, old)| found != old);
        assert!(others.all(|((id, _), _)| is_learned(id)), "{}: {nth}", target.name());
        if armed && kept != Kept::default() {
            assert!(nth > MIN_OPERATIONS && kept.armings == 1, "{nth} is no operation of a save: {kept:?}");
            break;
        }
        assert!(kept == Kept::default() || kept.armings == 1, "a mixture, cut at {nth}: {kept:?}");
        found_old += u32::from(kept == Kept::default());
    }
    assert!(found_old > 0, "{}: no cut came before the new one was whole", target.name());
}
