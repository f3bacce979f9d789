//! A valve whose null moves (8.4, `valve.null_drift_mm_per_h`).

use pneudrive_sim::plant::Snapshot;
use pneudrive_sim::{Accuracy, Rig, run};

/// An open loop with an on-off valve, whose spool moves at a constant speed or stands still.
fn rows(settings: &[&str]) -> Vec<Snapshot> {
    let common = [
        "controller.loop=open",
        "controller.delay_s=1e-6",
        "operator.model=on-off",
        "operator.switch_time_s=1",
        "test.duration_s=0.8",
    ];
    let settings: Vec<String> = common.iter().chain(settings).map(|text| (*text).to_owned()).collect();
    let rig = Rig::read_with("drifting", "", &settings).expect("a valid rig");
    run(&rig, Accuracy::of(&rig)).expect("a transient").rows.iter().map(|row| row.plant).collect()
}

/// A spool at rest over a null that retracts at 1 mm/s opens the valve as one that extends at 1 mm/s over a null at rest,
/// with the edges of the lands on either side of the start.
#[test]
fn a_null_that_drifts_opens_the_valve_as_a_spool_that_moves_the_other_way() {
    for (lap, null) in [(0.0, 0.0), (0.05, 0.0), (-0.03, 0.2)] {
        // The spool sets out a microsecond later, which is a nanometre of its way.
        let with = |settings: [&str; 2], null: f64| {
            let place = [format!("valve.underlap_mm={lap}"), format!("valve.null_offset_mm={null:?}")];
            rows(&[&settings[..], &[&place[0], &place[1]]].concat())
        };
        let spool = with(["test.moves=[[0.0, 1]]", "valve.null_drift_mm_per_h=0"], null);
        let drift = with(["test.moves=[[0.0, 0]]", "valve.null_drift_mm_per_h=-3600"], null + 1e-6);
        assert_eq!(spool.len(), drift.len());
        for (k, (spool, drift)) in spool.iter().zip(&drift).enumerate() {
            assert_eq!(drift.spool, 0.0, "the spool itself stands still");
            // The spool sets out a microsecond later.
            assert!(
                (spool.position - drift.position).abs() < 2e-6,
                "lap {lap}, row {k}: {spool:?} {drift:?}"
            );
            let apart = [0, 1].map(|i| (spool.pressures[i] - drift.pressures[i]).abs());
            assert!(apart.iter().all(|&pa| pa < 1.0), "lap {lap}, row {k}: {apart:?} Pa");
        }
        assert!(drift[drift.len() - 1].position > drift[0].position + 0.02, "lap {lap}: it moves");
    }
}
