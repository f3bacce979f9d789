//! The rig file that explains what the tests of the plan show.
//!
//! ```text
//! the rig file, or with the effect that explains the rest to noise, or with friction that gives way like bristles
//! ```
//!
//! The first of these that leaves nothing but noise is taken. If none does, the one that follows the position best is taken, where it does so
//! within the tolerance of the rig file: then no interval is to be trusted, and the trial moves tell whether the drive positions with it.

use anyhow::Result;
use pneudrive_evaluate::cancel::CancelToken;
use pneudrive_evaluate::evaluation::tolerance_mm;
use pneudrive_identify::Identification;
use pneudrive_identify::parameter::usual;
use pneudrive_identify::plan::Recorded;
use pneudrive_identify::report;
use pneudrive_link::client::Client;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::component::friction::{Friction, FrictionKind, FrictionModel};
use pneudrive_sim::key::Choice;
use pneudrive_sim::{Rig, keys};
use serde_json::json;

use crate::cli::{Commission, Identify};
use crate::command::identify;
use crate::command::interrupts::Interrupts;
use crate::command::rig_source::{load_choice, load_rig};
use crate::exit::Exit;
use crate::json;

/// The rig file with what the tests of `identify --plan` show, and what is to be known of it besides. It is read anew: the law of a rig that
/// was only changed by numbers does not know them.
pub(super) fn identified(
    arguments: &Commission,
    rig: &Rig,
    client: &mut Client,
    interrupts: &Interrupts,
) -> Result<(Rig, Option<String>)> {
    let mut plan = Identify::of_plan(&arguments.rig, &arguments.port.port, &arguments.out, arguments.pages);
    let (recorded, kept) = identify::planned(&plan, client)?;
    let best = best(&mut plan, rig, &recorded, interrupts);
    // Interrupted, the next call fits these records.
    interrupts.refuse_if_seen()?;
    let best = match best {
        Ok(best) => best,
        Err(error) => return kept.end().and(Err(error)),
    };
    let refusal = report::refusal(&best.found);
    plan.rig.settings.clone_from(&best.settings);
    plan.despite_misfit = best.found.spectrum.is_testable() && best.follows_mm <= tolerance_mm(Some(rig));
    json::figures(|| json!({ "settings": best.settings, "follows_mm": best.follows_mm }));
    identify::written(&plan, &recorded.fitted, identify::read_off(rig, &recorded), &best.found)?;
    kept.end()?;
    if let Some(table) = report::tables(&best.found).first() {
        say!("{}\n{}", table.heading, table.to_text());
    }
    if let Some(refusal) = &refusal
        && !plan.despite_misfit
    {
        return Err(Exit::NotBorneOut.error(refusal.clone()));
    }
    let note = refusal.map(|refusal| {
        format!(
            "{refusal} to their noise, so no interval of fitted.toml is to be trusted; it follows the position within {:.3} mm (root mean square), and the trial moves tell whether the drive positions with it.",
            best.follows_mm
        )
    });
    Ok((load_rig(&arguments.out.join(identify::FITTED).to_string_lossy(), &[])?, note))
}

/// A fit, the settings of its rig file, and how far the model is off the recorded position, mm (root mean square).
struct Fit {
    found: Identification,
    settings: Vec<String>,
    follows_mm: f64,
}

impl Fit {
    fn of(plan: &Identify, recorded: &Recorded, interrupts: &Interrupts) -> Result<Fit> {
        let rig = load_choice(&plan.rig)?;
        let is_live = || !interrupts.look();
        let cancel = CancelToken::cancelled_unless(&is_live);
        let found = identify::searched(plan, (&recorded.fitted, usual(&rig)), cancel);
        interrupts.refuse_if_seen()?;
        let found = found?;
        let [position, ..] = &found.channels;
        let counts = position.as_ref().map_or(f64::INFINITY, |position| position.after);
        Ok(Fit { settings: plan.rig.settings.clone(), follows_mm: counts * mm_per_count(&rig), found })
    }
}

fn best(plan: &mut Identify, rig: &Rig, recorded: &Recorded, interrupts: &Interrupts) -> Result<Fit> {
    let given = plan.rig.settings.clone();
    let mut best = Fit::of(plan, recorded, interrupts)?;
    for other in [of_the_cause, of_the_friction] {
        let Some(refusal) = report::refusal(&best.found) else { break };
        let Some((why, settings)) = other(rig, &best.found) else { continue };
        say!("{refusal}; again with {why}: {}", settings.join(", "));
        plan.rig.settings = [&given[..], &settings].concat();
        let fit = match Fit::of(plan, recorded, interrupts) {
            Err(error) => {
                interrupts.refuse_if_seen()?;
                say!("that fit failed: {error:#}");
                continue;
            }
            Ok(fit) => fit,
        };
        if fit.found.fits || fit.follows_mm < best.follows_mm {
            best = fit;
        }
    }
    Ok(best)
}

/// An effect that the rig file lacks, and the settings that have it.
type Other = Option<(String, Vec<String>)>;

/// The one that leaves nothing but noise, where no other explains as much.
fn of_the_cause(_: &Rig, found: &Identification) -> Other {
    let causes = &found.causes;
    let is_alone = causes.fitted.iter().filter(|cause| cause.as_good_as_best).count() == 1;
    let best = causes.fitted.first().filter(|_| is_alone && causes.explain_to_noise())?;
    Some((best.effect.name.to_owned(), best.setting.split(' ').map(str::to_owned).collect()))
}

/// Seals give way like a spring before they slide. What a rigid friction leaves does not point to that.
fn of_the_friction(rig: &Rig, _: &Identification) -> Other {
    let gives_way = |rig: &Rig| !Friction::of(rig).scale().is_empty();
    let with = |word: &str| vec![keys::friction::FRICTION.setting(word)];
    let mut others = FrictionKind::WORDS.iter().map(|(word, _)| with(word));
    let other = others.find(|other| rig.with_settings(other).is_ok_and(|rig| gives_way(&rig)));
    other
        .filter(|_| !gives_way(rig))
        .map(|other| ("friction that gives way before it slides".to_owned(), other))
}
