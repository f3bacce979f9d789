//! The test of a transient for another simulation (thesis 5.5.2): the values that a rig takes from it.
//!
//! | of the rig | from a record | from a simulated run |
//! |---|---|---|
//! | moves, length | where the setpoint changes, or in open loop the command; with profiles the rig's own, if they are the recorded ones | its own |
//! | gains, `controller.*` | the parameters in the header | its own |
//! | position | the middle of the first sample's count | that of the last row |
//! | pressures | those of the first sample; its own where they were not measured | those of the last row |
//! | temperatures | its own, as no sensor reads them | those of the last row |
//!
//! A simulation begins at rest.

use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_controller::law::Loop;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Move, Parameters, Profile, Sequence};
use pneudrive_protocol::RecordedSample;
use pneudrive_records::parameter_names::Written;
use pneudrive_records::run_folder::StoredRun;
use pneudrive_records::target::TargetFile;
use pneudrive_records::test_lines;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder;
use pneudrive_sim::keys;

use crate::evaluation::refuse_other_rig;
use crate::replay::parameters::Header;
use crate::replay::{moves, samples};
use crate::transient::Transient;

/// A drive counts as moving above this speed, m/s.
const AT_REST_M_S: f64 = 1e-3;

/// A rig, and the values that it has taken from a transient, a sentence each.
#[derive(Clone, Debug)]
pub struct RigOfRecord {
    /// The rig, with the test of the transient.
    pub rig: Rig,
    /// The values that were taken, and those that could not be.
    pub notes: Vec<String>,
}

/// The rig as it was in a TARGET file or a streamed run, or as a run folder leaves it.
///
/// # Errors
/// When the transient is of another rig, is not whole, or its state is not one that the rig can start from.
pub fn taken_from(path: &Path, rig: &Rig) -> Result<RigOfRecord> {
    let taken = if path.is_dir() {
        from_end_of_run(&StoredRun::read(path)?, rig)
    } else {
        from_record(&path.display().to_string(), &TargetFile::read(path)?, rig)
    };
    taken.with_context(|| format!("{} cannot be used as a starting point", path.display()))
}

fn from_record(name: &str, file: &TargetFile, rig: &Rig) -> Result<RigOfRecord> {
    refuse_other_rig(&Transient::of_target(name, file)?, rig)?;
    let recorded = samples(file)?;
    let header = Header::of(file)?;
    let (gains, mut notes) = gains(&header.parameters, &rig.parameters());
    notes.extend(header.notes);
    let with_gains = rig.with_settings(&gains)?;
    let config =
        Config::new(&header.parameters).map_err(|error| anyhow::anyhow!("its parameters: {error:?}"))?;
    let first = *recorded.first().context("it has no samples")?;
    let period_s = f64::from(header.parameters.get(id::PERIOD_US).unwrap_or(0)) / 1e6;
    let test = test_lines::sequence(&file.header)?;
    if let Some(test) = test.filter(|test| test.moves().iter().any(|next| next.profile != Profile::Step)) {
        refuse_other_moves(&test, rig)?;
        notes.insert(0, format!("the initial state is that of {name}; its moves are those of the rig"));
        let start = start_of(file, first, rig)?;
        notes.extend(start.remark());
        return Ok(RigOfRecord { rig: with_gains.with_settings(&start.settings(Some(rig)))?, notes });
    }
    let moves = moves_of(&config, &recorded, first)?;
    let all: Vec<(f64, i32)> =
        moves.iter().map(|one| (f64::from(one.at_sample) * period_s, one.target)).collect();
    let start = start_of(file, first, rig)?;
    notes.extend(start.remark());
    let duration_s = period_s * (recorded.len() - 1).max(1) as f64;
    notes.insert(0, format!("{} moves and the initial state are those of {name}", all.len()));
    let test = test_of(&all, duration_s, &start, rig);
    Ok(RigOfRecord { rig: with_gains.with_test(&test)?, notes })
}

/// Refuses a record whose moves have profiles that the test of the rig does not have: a list of moves cannot say them.
fn refuse_other_moves(test: &Sequence, rig: &Rig) -> Result<()> {
    let own = rig.sequence();
    if test.moves() != own.moves() {
        bail!(
            "its moves have profiles and are not those of the rig file: give the [test] that was run, with --test or --set"
        );
    }
    if test.round() != own.round() {
        bail!(
            "its moves repeat every {} samples, those of the rig file every {} (0: never): set test.repeat_every_s as it was run",
            test.round(),
            own.round()
        );
    }
    Ok(())
}

/// The state of a drive at the first sample of its record: in the middle of its count.
fn start_of(file: &TargetFile, first: RecordedSample, rig: &Rig) -> Result<Start> {
    let [offset, scale] = [file.number("pressure_offset_pa")?, file.positive("pressure_scale_pa")?];
    let measured = !["pressure_1", "pressure_2"].iter().any(|name| file.is_unknown(name));
    let pressure = |raw: i16| offset + scale * f64::from(raw);
    Ok(Start {
        position_m: 1e-3 * file.positive("mm_per_count")? * encoder::middle(rig, f64::from(first.position)),
        pressures_pa: measured.then(|| [pressure(first.pressure_1), pressure(first.pressure_2)]),
        temperatures_k: None,
    })
}

/// The moves of a record that begins with the sample `first`. It has a move at the start of the test, too, if it does not
/// begin with the setpoint in force before any move: in closed loop the count of the first sample, in open loop null.
fn moves_of(config: &Config, recorded: &[RecordedSample], first: RecordedSample) -> Result<Vec<Move>> {
    let plan = moves::plans(config, recorded)?.into_iter().next().context("it has no moves")?;
    let of_record = plan.sequence.moves().iter().filter(|one| (one.at_sample as usize) < recorded.len());
    let mut all: Vec<Move> = of_record.copied().collect();
    let (before, asked) = match config.law.control_loop {
        Loop::Closed => (first.position, first.position.saturating_add(i32::from(first.error))),
        Loop::Open => (0, 0),
    };
    let begins = all.first().is_some_and(|one| one.at_sample == 0);
    if !begins && (asked != before || all.is_empty()) {
        all.insert(0, Move::step(0, asked));
    }
    Ok(all)
}

/// The gains that differ, as settings of a rig, and a sentence about each.
fn gains(recorded: &Parameters, own: &Parameters) -> (Vec<String>, Vec<String>) {
    let of_controller = Written::all().filter(|written| written.name.starts_with("controller."));
    // A timed test knows when its moves come, and not whether they waited for arrival.
    let taken = of_controller.filter(|written| !OF_ARRIVAL.contains(&written.name));
    let differ = taken.filter(|written| written.all_text(recorded) != written.all_text(own));
    differ
        .map(|written| {
            let [value, file] = [recorded, own].map(|parameters| written.all_text(parameters));
            let list = written.parameter.len > 1;
            let setting = if list { format!("[{value}]") } else { value.clone() };
            (
                format!("{}={setting}", written.name),
                format!("{} is {value}, as recorded; the rig file has {file}", written.name),
            )
        })
        .unzip()
}

/// Keys that belong to moves which wait for arrival.
const OF_ARRIVAL: [&str; 5] = [
    keys::controller::EXIT_ON_DEAD_BAND.key.path,
    keys::controller::TOLERANCE_COUNTS.key.path,
    keys::controller::MONITORING_S.key.path,
    keys::controller::DWELL_S.key.path,
    keys::controller::FORCED_EXIT_S.key.path,
];

fn from_end_of_run(run: &StoredRun, rig: &Rig) -> Result<RigOfRecord> {
    let last = |column: &str| run.column(column).last().copied().unwrap_or(f64::NAN);
    let speed = last("velocity_m_s").abs();
    if speed > AT_REST_M_S {
        bail!(
            "its drive still moves at {:.1} mm/s at the end, but a simulation begins at rest; let it run longer",
            1e3 * speed
        );
    }
    let start = Start {
        position_m: last("position_m"),
        pressures_pa: Some(["pressure_1_pa", "pressure_2_pa"].map(last)),
        temperatures_k: Some(["temperature_1_k", "temperature_2_k"].map(last)),
    };
    let at = last("time_s");
    let note = format!(
        "position, pressures and temperatures are those of the run of {} at its end, {at:.4} s{}",
        run.rig,
        run.numbered.as_ref().map_or_else(String::new, |one| format!(" ({one})"))
    );
    Ok(RigOfRecord { rig: rig.with_settings(&start.settings(None))?, notes: vec![note] })
}

const KEYS_OF_PRESSURES: [&str; 2] = [keys::test::PRESSURE_1_PA.key.path, keys::test::PRESSURE_2_PA.key.path];
const KEYS_OF_TEMPERATURES: [&str; 2] =
    [keys::test::TEMPERATURE_1_K.key.path, keys::test::TEMPERATURE_2_K.key.path];

/// The state that a simulation begins with.
struct Start {
    position_m: f64,
    /// Pressures of the chambers; None: those of the rig.
    pressures_pa: Option<[f64; 2]>,
    /// Temperatures of the chambers; None: those of the rig.
    temperatures_k: Option<[f64; 2]>,
}

impl Start {
    /// The values that differ from the transient's.
    fn remark(&self) -> Option<String> {
        let why = "its pressures were not measured: those at the start are the rig file's";
        self.pressures_pa.is_none().then(|| why.to_owned())
    }

    fn settings(&self, rig: Option<&Rig>) -> Vec<String> {
        let own = |key: &str| rig.and_then(|rig| rig.number_at(key));
        let mut all = vec![(keys::test::POSITION_M.path, Some(self.position_m))];
        for (keys, both) in
            [(KEYS_OF_PRESSURES, self.pressures_pa), (KEYS_OF_TEMPERATURES, self.temperatures_k)]
        {
            for (i, key) in keys.into_iter().enumerate() {
                all.push((key, both.map(|both| both[i]).or_else(|| own(key))));
            }
        }
        all.into_iter().filter_map(|(key, value)| Some(format!("{key}={:?}", value?))).collect()
    }
}

fn test_of(moves: &[(f64, i32)], duration_s: f64, start: &Start, rig: &Rig) -> Vec<String> {
    let moves: Vec<String> = moves.iter().map(|(at, counts)| format!("[{at:?}, {counts}]")).collect();
    let test = [
        keys::test::MOVES.setting(format_args!("[{}]", moves.join(", "))),
        keys::test::DURATION_S.setting(format_args!("{duration_s:?}")),
    ];
    test.into_iter().chain(start.settings(Some(rig))).collect()
}
