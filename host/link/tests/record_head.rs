//! The head of a record whose CRC the rig does not come to the end of.

use anyhow::bail;
use pneudrive_protocol::{RecordInfo, ReplyBody, Request, RequestBody};

use crate::simulated_link::SimulatedRig;

/// Says of its record that it is not complete, whenever it is asked.
fn never_complete(request: &Request<'_>) -> Option<ReplyBody<'static>> {
    let info = RecordInfo {
        test: "a test",
        samples: 1,
        first_index: 0,
        decimation: 1,
        pre_trigger: 0,
        complete: false,
        measured_period_ns: 1_300_000,
        mean_spool_raw: 0,
        crc32: 0,
    };
    (request.body == RequestBody::RecordInfo).then_some(ReplyBody::RecordInfo(info))
}

#[test]
fn a_rig_that_is_at_its_crc_is_waited_for_as_long_as_wanted_and_five_seconds_at_most() {
    let rig = SimulatedRig::with_record(&[]).with_firmware(never_complete);
    let mut client = rig.connect().expect("an answer");
    let begun = rig.change(|simulation| simulation.now());
    let mut asked = 0;
    let ended = client.record_head_while(|| {
        asked += 1;
        if asked == 3 { bail!("not wanted any more") } else { Ok(()) }
    });
    assert_eq!((ended.expect_err("never").to_string().as_str(), asked), ("not wanted any more", 3));
    let took = rig.change(|simulation| simulation.now()) - begun;
    assert!(took.as_millis() < 100, "{took:?}");
    let ended = client.record_head().expect_err("never").to_string();
    assert!(ended.contains("is still recording"), "{ended}");
    let took = rig.change(|simulation| simulation.now()) - begun;
    assert!((5000..6000).contains(&took.as_millis()), "{took:?}");
}
