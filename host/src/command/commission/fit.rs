//! The rig file that explains what the tests of the plan show.
//!
//! ```text
//! the rig file -> with the effect that explains the rest to noise -> with friction that gives way like bristles
//! ```
//!
//! The first of these that leaves nothing but noise is taken. A drive that none explains is not commissioned.

use anyhow::Result;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_identify::Identification;
use pneudrive_identify::parameter::usual;
use pneudrive_identify::plan::Recorded;
use pneudrive_identify::report;
use pneudrive_link::client::Client;
use pneudrive_sim::component::friction::FrictionKind;
use pneudrive_sim::key::Choice;
use pneudrive_sim::{Rig, keys};

use super::goes_on;
use crate::cli::{Commission, Identify};
use crate::command::identify;
use crate::command::interrupts::Interrupts;
use crate::command::rig_source::{load_choice, load_rig};
use crate::exit::Exit;

/// The rig file with what the tests of `identify --plan` show. It is read anew: the law of a rig that was only changed by numbers does not
/// know them.
pub(super) fn identified(
    arguments: &Commission,
    rig: &Rig,
    client: &mut Client,
    interrupts: &Interrupts,
) -> Result<Rig> {
    let mut plan = Identify::of_plan(&arguments.rig, &arguments.port.port, &arguments.out, arguments.pages);
    let recorded = identify::planned(&plan, client)?;
    let mut found = fitted(&plan, &recorded, interrupts)?;
    for other in [of_the_cause, of_the_friction] {
        let Some(refusal) = report::refusal(&found) else { break };
        let Some((why, settings)) = other(rig, &found) else { continue };
        say!("{refusal}; again with {why}: {}", settings.join(", "));
        plan.rig.settings = [&arguments.rig.settings[..], &settings].concat();
        found = fitted(&plan, &recorded, interrupts)?;
    }
    if let Some(table) = report::tables(&found).first() {
        say!("{}\n{}", table.heading, table.to_text());
    }
    match report::refusal(&found) {
        None => load_rig(&arguments.out.join(identify::FITTED).to_string_lossy(), &[]),
        Some(refusal) => Err(Exit::NotBorneOut.error(refusal)),
    }
}

fn fitted(plan: &Identify, recorded: &Recorded, interrupts: &Interrupts) -> Result<Identification> {
    let rig = load_choice(&plan.rig)?;
    let read_off = identify::read_off(&rig, recorded);
    let is_live = || !interrupts.look();
    let cancel = CancelToken::cancelled_unless(&is_live);
    let found = identify::fitted(plan, (&recorded.fitted, usual(&rig)), read_off, cancel);
    goes_on(interrupts)?;
    found
}

/// An effect that the rig file lacks, and the settings that have it.
type Other = Option<(String, Vec<String>)>;

/// The one that leaves nothing but noise.
fn of_the_cause(_: &Rig, found: &Identification) -> Other {
    let best = found.causes.fitted.first().filter(|_| found.causes.explain_to_noise())?;
    Some((best.effect.name.to_owned(), best.setting.split(' ').map(str::to_owned).collect()))
}

/// Seals give way like a spring before they slide; no trace of a rigid one shows that.
fn of_the_friction(rig: &Rig, _: &Identification) -> Other {
    let is_rigid = rig.get(&keys::friction::FRICTION) == FrictionKind::Coulomb;
    let bristles = keys::friction::FRICTION.setting(FrictionKind::LuGre.word());
    is_rigid.then(|| ("friction that gives way before it slides".to_owned(), vec![bristles]))
}
