//! `pneudrive rig check`.

use anyhow::{Result, anyhow};
use pneudrive_controller::Fault;
use pneudrive_controller::config::unwatched;
use pneudrive_design::breakaway::Breakaway;
use pneudrive_design::values;
use pneudrive_optimise::runnable::{Obstacle, Remedy, obstacle};
use pneudrive_optimise::sensitivity::{Effect, Sensitivity, sensitivity};
use pneudrive_records::words;
use pneudrive_sim::component::actuator::cushion::between;
use pneudrive_sim::component::controller::{Law, Loop};
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::component::load::returning::Return;
use pneudrive_sim::rig::Source;
use pneudrive_sim::rigfile::builtin;
use pneudrive_sim::{Rig, keys};
use serde_json::{Value, json};

use crate::command::progress::Progress;
use crate::command::rig_source::load_rig;
use crate::json;

/// Effects that are shown one by one.
const SHOWN: usize = 8;

pub(super) fn execute(file: &str, quick: bool) -> Result<()> {
    let rig = load_rig(file, &[])?;
    for key in rig.unused() {
        say!("{file}: {key} has no effect here");
    }
    let is_to_run = builtin(file).is_none() && !quick;
    if is_to_run {
        try_test(file, &rig)?;
    }
    let remarks = return_remark(&rig).into_iter().chain(cushion_remark(&rig)).chain(stall_remarks(&rig));
    let remarks = remarks.chain(unwatched_remarks(&rig));
    remarks.for_each(|remark| say!("{file}: {remark}"));
    say!("{file}: a valid rig ({})", rig.name());
    say!("{file}: {}", moves(&rig));
    json::figures(|| json!({ "rig": rig.name(), "unused": rig.unused(), "moves": places(&rig) }));
    // The comments of the built-in rigs give the source of each value.
    if !is_to_run {
        return Ok(());
    }
    let counts = values::count(&rig).into_iter().filter(|(source, count)| {
        *count > 0 && matches!(source, Source::Typical | Source::Unknown | Source::Default)
    });
    let counts: Vec<String> = counts.map(|(source, count)| format!("{count} {}", source.word())).collect();
    if !counts.is_empty() {
        say!("{file}: {} values; these move the piston most in its test:", counts.join(", "));
        rank(&rig)?;
    }
    Ok(())
}

/// The moves of a test: when, to where in mm, and in counts; in open loop commands.
fn moves(rig: &Rig) -> String {
    let place = |one: &Value| match one["to_mm"].as_f64() {
        Some(mm) => format!("{mm:.3} mm ({} counts)", one["to_counts"]),
        None => format!("{} counts of the valve", one["to_counts"]),
    };
    let all = places(rig);
    let first = all
        .iter()
        .take(SHOWN)
        .map(|one| format!("at {} s {}", one["at_s"].as_f64().unwrap_or(0.0), place(one)));
    let more = all.len().saturating_sub(SHOWN);
    let rest = (more > 0).then(|| format!("and {more} more"));
    format!("moves: {}", first.chain(rest).collect::<Vec<_>>().join(", "))
}

fn places(rig: &Rig) -> Vec<Value> {
    let closed = rig.get(&keys::controller::LOOP) == Loop::Closed;
    let mm = |counts: i64| closed.then(|| counts as f64 * mm_per_count(rig));
    let place = |(at_s, to): (f64, i64)| json!({ "at_s": at_s, "to_counts": to, "to_mm": mm(to) });
    rig.moves().into_iter().map(place).collect()
}

/// That nothing brings the piston of a single-acting cylinder back from everywhere.
fn return_remark(rig: &Rig) -> Option<String> {
    let Return { least, friction } = Return::of(rig).filter(|found| !found.is_complete())?;
    Some(format!(
        "its piston does not come back from everywhere: air moves it one way only (actuator.vented), the least force that pushes it back is {:.0} N, and its friction holds {friction:.0} N; actuator.return_spring, load.spring_n_per_m or load.incline_deg can push more",
        least + 0.0
    ))
}

/// That a move ends where the throttle of a cushion has a say.
fn cushion_remark(rig: &Rig) -> Option<String> {
    let [low, high] = between(rig).map(|m| 1e3 * m);
    let within = |mm: &f64| *mm < low || *mm > high;
    let inside = places(rig).iter().filter_map(|one| one["to_mm"].as_f64()).find(within)?;
    let of_law = match rig.get(&keys::controller::LAW) {
        Law::Cascade => {
            "; the law \"cascade\" takes the flow of the valve for that of the chamber, and mostly ends outside its tolerance there, or trips (docs/howto/own-drive.md)"
        }
        _ => "",
    };
    Some(format!(
        "a move to {inside:.3} mm ends in an end cushion, whose throttle slows the load and which no law knows{of_law}; positions from {:.3} to {:.3} mm are in front of the cushions",
        low.max(0.0),
        high.min(1e3 * rig.get(&keys::actuator::STROKE_M))
    ))
}

/// What the stall detector makes of a load that breaks away late, or never.
fn stall_remarks(rig: &Rig) -> Vec<String> {
    let Some(found) = Breakaway::of(rig) else { return Vec::new() };
    let Breakaway { needed, held, asked, .. } = found;
    if !found.is_possible() {
        return vec![format!(
            "its load does not break away: that takes {needed:.0} N, and the supply has {held:.0} N on this piston; it trips with `no-motion`"
        )];
    }
    let mut remarks = Vec::new();
    if needed > asked && rig.get(&keys::controller::LAW) == Law::Cascade {
        remarks.push(format!(
            "its load breaks away at {needed:.0} N, and the law \"cascade\" asks for {asked:.0} N at most: it may trip with `no-motion`"
        ));
    }
    let (set, needs) = (rig.get(&keys::safety::NO_MOTION_S), found.no_motion_s());
    if set > 0.0 && set < needs && found.time.is_none_or(|time| set < time) {
        remarks.push(format!(
            "safety.no_motion_s = {set} is shorter than the air needs until the load breaks away: it may trip with `no-motion`; {needs:.3} leaves it the time"
        ));
    }
    remarks
}

/// The checks that the rig leaves off, for which its drive is armed only by who asks for that.
fn unwatched_remarks(rig: &Rig) -> Vec<String> {
    let remark = |check: Fault| {
        let name = words::fault_name(check);
        let why = match check {
            Fault::SensorRange if rig.get(&keys::safety::SENSOR_WATCH) => {
                ": the drive can have each pressure in the range of its sensors; those whose range ends above the supply are watched (sensors.pressure_max_pa)"
            }
            _ => "",
        };
        format!("its drive is not armed without `--without {name}`, as it would never trip with {name}{why}")
    };
    unwatched(&rig.parameters()).map(remark).collect()
}

/// Refuses a rig whose test cannot be simulated.
fn try_test(file: &str, rig: &Rig) -> Result<()> {
    let mut progress = Progress::of("looking for the cause", "runs");
    let found = obstacle(rig, |done, all| progress.at(done as u64, all as u64));
    progress.done();
    match found {
        Some(obstacle) => Err(anyhow!("{file}: {}", in_words(rig, &obstacle))),
        None => Ok(()),
    }
}

/// The reason why the test ends, and the values with which it would run.
fn in_words(rig: &Rig, Obstacle { cause, remedies }: &Obstacle) -> String {
    let line = |remedy: &Remedy| {
        let Remedy { key, value, instead } = remedy;
        let [value, instead] = [value, instead].map(|value| digits(*value));
        format!("\n  {}: with {instead} {} instead of {value} it runs", key.path, key.unit())
    };
    let others: String = remedies.iter().take(SHOWN).map(line).collect();
    format!("the test of {} cannot be simulated: {cause}{others}", rig.name())
}

fn rank(rig: &Rig) -> Result<()> {
    let mut progress = Progress::of("trying values", "runs");
    let found = sensitivity(rig, |done, all| progress.at(done as u64, all as u64));
    progress.done();
    let Sensitivity { effects, floor_m } = found?;
    json::figures(|| {
        let effects: Vec<Value> = effects.iter().map(|effect| figures(rig, effect)).collect();
        json!({ "effects": effects, "not_significant_below_mm": 1e3 * floor_m })
    });
    let matters = effects.iter().filter(|effect| effect.moves_m.is_none_or(|moves| moves > floor_m));
    for effect in matters.take(SHOWN) {
        say!("  {}", line(rig, effect));
    }
    if effects.len() > SHOWN {
        let next =
            effects[SHOWN].moves_m.map_or("as much".to_owned(), |moves| format!("{:.2} mm", 1e3 * moves));
        say!("  {} others: {next} at most, each on its own", effects.len() - SHOWN);
    }
    say!(
        "  (less than {:.3} mm is not significant: members of the ensemble of the run differ as much)",
        1e3 * floor_m
    );
    Ok(())
}

fn figures(rig: &Rig, effect: &Effect) -> Value {
    json!({
        "key": effect.key.path,
        "unit": effect.key.unit(),
        "value": rig.number_at(effect.key.path),
        "origin": effect.origin.source.word(),
        "tried": effect.ends,
        "moves_mm": effect.moves_m.map(|moves| 1e3 * moves),
    })
}

/// "load.mass_kg  8 kg, typical, 6 to 10: 12.35 mm".
fn line(rig: &Rig, effect: &Effect) -> String {
    let [low, high] = effect.ends;
    let unit = effect.key.unit();
    let value = rig.number_at(effect.key.path).unwrap_or(f64::NAN);
    let moves = effect
        .moves_m
        .map_or("the run fails at one end".to_owned(), |moves| format!("{:.2} mm", 1e3 * moves));
    let source = effect.origin.source.word();
    let [value, low, high] = [value, low, high].map(digits);
    let value = format!("{value} {unit}");
    format!("{:<38} {:<22} {source}, tried {low} to {high}: {moves}", effect.key.path, value.trim_end())
}

/// Four digits of a number, with an exponent only where needed.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}
