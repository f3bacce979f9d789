//! New setpoints at any time, while the load moves fast.

use super::{DRIVES, Draws, Drive, rig, settings};
use pneudrive_controller::{Mode, Move, Sequence, output, sample};

/// How a load is stopped: its deceleration, m/s^2, for how long it goes on before, s, and how far it may then be from there, m.
const BRAKED: f64 = 25.0;
const GOES_ON: f64 = 0.04;
const NEAR: f64 = 5e-3;
/// No load is faster, m/s.
const FASTEST: f64 = 1.2;

/// New setpoints between 5 and 95 % of the stroke, 10 to 400 ms apart. No drive trips, runs away or passes the ends of its stroke; and none
/// is ever farther from the path between where it got its setpoint and that than it takes to stop it.
#[test]
fn new_setpoints_in_motion_take_no_drive_beyond_what_it_takes_to_stop() {
    let mut draws = Draws(0x5be0_cd19_137e_2179);
    for (name, of) in DRIVES {
        let stroke = rig(&settings(of)).number_at("actuator.stroke_m").expect("a number");
        for index in 0..3 {
            let mut drive = Drive::drawn(of, &mut draws, 0.5 * stroke);
            let mut sequence = Sequence::new((6.0 / drive.period) as u32);
            sequence.push(Move::step(0, drive.start)).expect("room");
            drive.state.locate(0);
            drive.state.supervisor.arm().expect("at rest");
            drive.state.start(&drive.config, &sequence).expect("a run");
            let mut seen = drive.plant.sample().expect("a sample");
            let (mut due, mut between, mut most) = (0.05, [0.5 * stroke; 2], NEAR);
            for k in 0..=sequence.duration_samples {
                let time = f64::from(k) * drive.period;
                let now = drive.plant.look(time).expect("a state");
                if k > 0 && time >= due {
                    due = time + draws.between(0.01, 0.4);
                    let target = draws.between(0.05 * stroke, 0.95 * stroke);
                    drive.state.redirect(&drive.config, (target / drive.count) as i32).expect("it runs");
                    between = [now.position.min(target), now.position.max(target)];
                    let speed = now.velocity.abs();
                    most = NEAR + speed * GOES_ON + speed * speed / (2.0 * BRAKED);
                }
                let beyond = (between[0] - now.position).max(now.position - between[1]);
                assert!(
                    beyond <= most,
                    "{name}, draw {index}, {time} s: {beyond} m beyond, {most} m to stop"
                );
                let is_sound = (0.0..=stroke).contains(&now.position) && now.velocity.abs() < FASTEST;
                assert!(is_sound, "{name}, draw {index}, {time} s: {now:?}");
                sample(&drive.config, &sequence, &mut drive.state, &seen);
                assert_eq!(drive.state.supervisor.mode(), Mode::Running, "{name}, draw {index}, {time} s");
                seen = drive.plant.advance(output(&drive.config, &mut drive.state)).expect("a sample");
            }
        }
    }
}
