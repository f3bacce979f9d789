//! A drive whose host is busy with something else than the drive.

use std::time::Duration;

use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;

/// Twice `safety.host_silence_s`: as a terminal that is held, or a disk that is slow.
const BUSY: Duration = Duration::from_secs(1);

#[test]
fn a_drive_goes_on_while_who_is_told_of_it_takes_its_time() {
    let settings = ["test.duration_s=2", "test.moves=[[0.0, 9000]]"].map(str::to_owned);
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig").with_settings(&settings).expect("valid");
    let served = VirtualRig::new(rig.clone(), 0, Pace { fast: false, live: false }).expect("a rig");
    let served = Background::start(served, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut host = Client::connect(served.port()).expect("an answer");
    host.download_test(&rig).expect("disarmed");
    host.arm().expect("referenced");
    host.start().expect("armed");
    let mut told = 0;
    let followed = host.follow(&false.into(), |_| {
        told += 1;
        std::thread::sleep(BUSY);
    });
    assert_eq!(followed.expect("no fault").mode, Mode::Done);
    assert!(told > 0);
}
