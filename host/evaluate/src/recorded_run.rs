//! A simulated run as the TARGET file that a rig would record of it: for programs that read such files, without a rig.

use anyhow::Result;
use pneudrive_app::recorder::recorded;
use pneudrive_protocol::{RecordCrc, RecordedSample, VERSION};
use pneudrive_records::record::{Record, RecordHead};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::target::TargetFile;
use pneudrive_sim::{Rig, Run};

/// The file of a run of a rig: every sample from the start on.
///
/// ```
/// use pneudrive_evaluate::recorded_run::recorded_run;
/// use pneudrive_evaluate::replay::replay;
/// use pneudrive_sim::{Accuracy, Rig, run};
///
/// let rig = Rig::builtin("servo-a").expect("a built-in rig");
/// let mut file = recorded_run(&rig, &run(&rig, Accuracy::of(&rig))?)?;
/// assert_eq!(replay(&file)?.differences, 0, "the controller makes the same of its inputs once more");
///
/// file.samples[1000].1.command += 1;
/// assert_eq!(replay(&file)?.first.map(|first| first.index), Some(1000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the run has more samples than a file can number.
pub fn recorded_run(rig: &Rig, run: &Run) -> Result<TargetFile> {
    let samples: Vec<RecordedSample> =
        run.observations.iter().filter(|seen| seen.running).map(recorded).collect();
    let mut crc = RecordCrc::new();
    samples.iter().for_each(|sample| crc.update(&sample.to_bytes()));
    let spool: i64 = samples.iter().map(|sample| i64::from(sample.spool)).sum();
    let head = RecordHead {
        test: rig.name().to_owned(),
        samples: samples.len(),
        first_index: 0,
        decimation: 1,
        pre_trigger: 0,
        measured_period_ns: rig.period_us().get() * 1000,
        mean_spool_raw: (spool / samples.len().max(1) as i64) as i16,
        crc32: crc.finish(),
    };
    let info = Info {
        version: VERSION,
        firmware: concat!("pneudrive ", env!("CARGO_PKG_VERSION")).to_owned(),
        build: String::new(),
        board: "simulation".to_owned(),
        record_capacity: samples.len() as u32,
    };
    let parameters = RigParameters { values: rig.parameters(), lacking: Vec::new() };
    Ok(TargetFile::new(&Record { head, samples }, &info, &parameters)?.with_test(&rig.sequence()))
}
