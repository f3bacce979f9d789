//! `pneudrive replay`.

use anyhow::{Context, Result};
use pneudrive_evaluate::known::replay_of_rig;
use pneudrive_evaluate::replay::{ComparedQuantity, Difference, Replay, replay};
use pneudrive_records::target::TargetFile;
use pneudrive_records::whole_file::put;
use pneudrive_records::words;
use pneudrive_sim::Rig;
use pneudrive_sim::trace::push_number;

use super::figures;
use super::rig_source::load_rig;
use crate::cli::Replay as Arguments;
use crate::exit::Exit;
use crate::json;

/// Samples shown before and after the first different one.
const AROUND: usize = 3;

pub(super) fn execute(arguments: &Arguments) -> Result<()> {
    let name = arguments.file.display().to_string();
    let file = TargetFile::read(&arguments.file)?;
    let rig = arguments.rig.as_ref().map(|rig| load_rig(rig, &arguments.settings)).transpose()?;
    let replay = match &rig {
        Some(rig) => replay_of_rig(&name, &file, rig)?,
        None => replay(&file).with_context(|| name.clone())?,
    };
    for note in &replay.notes {
        tell!("note: {note}");
    }
    json::figures(|| figures::replay(&name, &replay));
    if let (Some(rig), Some(out)) = (&rig, &arguments.out) {
        put(out, &known_csv(&replay, rig, file.period_us()? / 1e6))?;
        say!("{}: what the law knew at each sample", out.display());
    }
    match replay.first {
        None => say!("{name}: {}\n{}", verdict(&replay), ending(&replay)),
        Some(first) => {
            say!("{}", around(&replay, first));
            return Err(Exit::NotBorneOut.error(format!("{name}: {}", parting(&replay, first))));
        }
    }
    Ok(())
}

/// The recorded position, and what the law knew, a line for each sample. Time is in s from the start of the run.
fn known_csv(replay: &Replay, rig: &Rig, period_s: f64) -> String {
    let columns = replay.known_columns(rig);
    let names = columns.iter().map(|(extra, _)| extra.name);
    let mut text = ["time_s", "position_counts"].into_iter().chain(names).collect::<Vec<_>>().join(",");
    text.push('\n');
    for (k, sample) in replay.recorded.iter().enumerate() {
        push_number(&mut text, k as f64 * period_s);
        let values =
            std::iter::once(f64::from(sample.position)).chain(columns.iter().map(|(_, values)| values[k]));
        for value in values {
            text.push(',');
            push_number(&mut text, value);
        }
        text.push('\n');
    }
    text
}

fn verdict(replay: &Replay) -> String {
    let samples = replay.recorded.len();
    let what = if replay.stepper { "command and spool location" } else { "command" };
    let moves = if replay.open_loop { "; open loop: its moves are taken from the commands" } else { "" };
    format!("{samples} samples, every {what} as recorded{moves}")
}

/// How the run has ended.
fn ending(replay: &Replay) -> String {
    let last = replay.recorded.len().saturating_sub(1);
    match tripped(replay) {
        Some(tripped) => tripped,
        None => format!(
            "it ends with sample {last}, which does not trip the controller: the test was over, the recorder was full, or the drive was stopped from outside"
        ),
    }
}

fn tripped(replay: &Replay) -> Option<String> {
    let (fault, k) = replay.tripped?;
    let meaning = words::fault_meaning(fault.code());
    Some(format!("the controller trips at sample {k}: {} ({meaning})", words::fault_name(fault)))
}

/// The first difference between record and replay, in one line.
fn parting(replay: &Replay, first: Difference) -> String {
    let Difference { index, what, recorded, replayed, inferred } = first;
    let sides = match what {
        ComparedQuantity::Sample => "the run continues in the record, but is over in the replay".to_owned(),
        _ => format!("{} {recorded} recorded, {replayed} replayed", what.name()),
    };
    let count = format!("{} of {} samples differ", replay.differences, replay.recorded.len());
    let why = if inferred {
        "; its setpoint is that of another sample, because its own error is at the limit of 16 bits"
    } else {
        ""
    };
    let tripped = tripped(replay).map_or(String::new(), |tripped| format!("; in the replay {tripped}"));
    format!("sample {index}: {sides} ({count}{why}{tripped})")
}

/// The first sample that differs and its neighbours, as recorded and as replayed.
fn around(replay: &Replay, first: Difference) -> String {
    let at = first.index as usize;
    let spool = if replay.stepper { "  spool" } else { "" };
    let mut lines = vec![
        "                                        recorded               replayed".to_owned(),
        format!("       k    position    P1    P2  command  error  spool  command  error{spool}"),
    ];
    let end = replay.recorded.len().min(at + AROUND + 1);
    for k in at.saturating_sub(AROUND)..end {
        lines.push(both_sides(replay, k, if k == at { '>' } else { ' ' }));
    }
    lines.join("\n")
}

fn both_sides(replay: &Replay, k: usize, mark: char) -> String {
    let (r, o) = (&replay.recorded[k], &replay.replayed[k]);
    let pressures = match replay.no_pressures {
        true => format!("{:>5} {:>5}", "-", "-"),
        false => format!("{:>5} {:>5}", r.pressure_1, r.pressure_2),
    };
    let inputs = format!("{k:>7} {:>11} {pressures}", r.position);
    let recorded = format!("{:>8} {:>6} {:>6}", r.command, r.error, r.spool);
    let spool = if replay.stepper { format!(" {:>6}", o.spool) } else { String::new() };
    format!("{mark}{inputs} {recorded} {:>8} {:>6}{spool}", o.command, o.error)
}
