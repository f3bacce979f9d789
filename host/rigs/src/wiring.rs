//! Faults of the wires and of the board of a virtual rig, and the hand that pushes its slide.
//!
//! They lie between the board and the drive, so plant and controller know nothing of them:
//!
//! ```text
//! plant -> hand -> encoder, pressures (wired wrongly) -> controller -> command (wired wrongly) -> plant
//! ```
//!
//! | fault | does |
//! |---|---|
//! | valve-inverted | the valve gets the negative of the command |
//! | tubes-swapped | each tube is on the other's port of the valve (`swapped-tubes` of `[[faults.event]]`, from the start) |
//! | encoder-swapped | the counter goes the other way, from where it stood at power-on |
//! | encoder-pull-up | a track of the encoder does not switch: the counter goes to and fro by one |
//! | pressures-swapped | each transmitter is on the other's input |
//! | pressure-floats | no transmitter and no pull-down at the input of pressure 1: it picks up the mains |
//! | enable-open | `drive_enable` does not reach the amplifier: the valve stays at its null |
//! | watchdog-dead | the watchdog does not reset a board that feeds it no more |
//!
//! A polarity that is set on the controller (`encoder.polarity`, `output_inverted`) mends its fault, as on a board.

use std::f64::consts::TAU;
use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};

use pneudrive_controller::drive::DriveConfig;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Config, Sample};
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::pulse;
use pneudrive_sim::keys;

/// How far a hand pushes the slide out, m.
const PUSH_M: f64 = 0.02;

/// How long it takes to push the slide out and back, us.
const PUSH_US: u64 = 2_000_000;

/// A drive that has been disabled for this long may be pushed again, us.
const PAUSE_US: u64 = 3_000_000;

/// Frequency of the mains, Hz.
const MAINS_HZ: f64 = 50.0;

/// A wire that is not where it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WiringFault {
    /// The valve gets the negative of the command.
    ValveInverted,
    /// Each tube is on the other's port of the valve.
    TubesSwapped,
    /// The tracks of the encoder are on each other's input.
    EncoderSwapped,
    /// A track of the encoder does not switch, because its pull-up is missing.
    EncoderPullUp,
    /// The transmitters are on each other's input.
    PressuresSwapped,
    /// The input of pressure 1 is open and has no pull-down.
    PressureFloats,
    /// The amplifier is never enabled.
    EnableOpen,
    /// The watchdog of the board never bites.
    WatchdogDead,
}

impl WiringFault {
    /// Every fault and its name.
    pub const ALL: [(WiringFault, &str); 8] = [
        (WiringFault::ValveInverted, "valve-inverted"),
        (WiringFault::TubesSwapped, "tubes-swapped"),
        (WiringFault::EncoderSwapped, "encoder-swapped"),
        (WiringFault::EncoderPullUp, "encoder-pull-up"),
        (WiringFault::PressuresSwapped, "pressures-swapped"),
        (WiringFault::PressureFloats, "pressure-floats"),
        (WiringFault::EnableOpen, "enable-open"),
        (WiringFault::WatchdogDead, "watchdog-dead"),
    ];
}

impl FromStr for WiringFault {
    type Err = String;

    fn from_str(name: &str) -> Result<WiringFault, String> {
        let found = WiringFault::ALL.iter().find(|(_, other)| *other == name);
        found.map(|(fault, _)| *fault).ok_or_else(|| {
            let names = WiringFault::ALL.map(|(_, name)| name);
            format!("choose one of {}", names.join(", "))
        })
    }
}

/// When a hand pushes the slide of a drive that is disabled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Pushes {
    #[default]
    Never,
    Once,
    AgainAndAgain,
}

#[derive(Debug, Default)]
struct Shared {
    faults: Vec<WiringFault>,
    pushes: Pushes,
}

/// The wires of a virtual rig, which can be changed while it runs. Clones share them.
#[derive(Clone, Debug, Default)]
pub struct Wiring(Arc<Mutex<Shared>>);

impl Wiring {
    fn with<T>(&self, act: impl FnOnce(&mut Shared) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Whether something is wrong.
    pub(crate) fn has(&self, fault: WiringFault) -> bool {
        self.with(|shared| shared.faults.contains(&fault))
    }

    /// Wires something wrongly. [`WiringFault::TubesSwapped`] is a matter of the plant and acts only from
    /// [`VirtualRig::wired`](crate::virtual_rig::VirtualRig::wired).
    pub fn spoil(&self, fault: WiringFault) {
        self.with(|shared| shared.faults.push(fault));
    }

    /// Puts a wire right.
    pub fn repair(&self, fault: WiringFault) {
        self.with(|shared| shared.faults.retain(|other| *other != fault));
    }

    /// A hand pushes the slide out by 20 mm and back within 2 s, once the drive is disabled.
    pub fn push(&self) {
        self.with(|shared| shared.pushes = Pushes::Once);
    }

    /// The same each time that the drive has been disabled for 3 s.
    pub fn push_again_and_again(&self) {
        self.with(|shared| shared.pushes = Pushes::AgainAndAgain);
    }

    /// The hand begins no other push.
    pub fn push_no_more(&self) {
        self.with(|shared| shared.pushes = Pushes::Never);
    }
}

/// The signals that board and drive exchange over these wires.
#[derive(Debug)]
pub(crate) struct Signals {
    pub wiring: Wiring,
    counts_per_push: f64,
    full_scale: f64,
    /// The polarities of encoder and valve that the rig's own parameters have, which suit right wires.
    suits: [bool; 2],
    /// The count at power-on.
    first: Option<i32>,
    /// Since when a push is under way, and since when the drive has been disabled, us.
    push_since: Option<u64>,
    disabled_since: Option<u64>,
}

impl Signals {
    pub fn of(rig: &Rig) -> Signals {
        let parameters = rig.parameters();
        Signals {
            wiring: Wiring::default(),
            counts_per_push: PUSH_M / pulse(rig),
            full_scale: f64::from((1u32 << rig.get(&keys::sensors::BITS)) - 1),
            suits: [id::ENCODER_INVERTED, id::OUTPUT_INVERTED].map(|id| parameters.get(id) == Some(1)),
            first: None,
            push_since: None,
            disabled_since: None,
        }
    }

    /// The clock of the board starts again: a hand lets go.
    pub fn restart(&mut self) {
        (self.push_since, self.disabled_since) = (None, None);
    }

    /// The controller's inputs from a sample at this time (us); `disabled`: a hand may push the slide.
    pub fn sensed(&mut self, config: &Config, sample: Sample, time_us: u64, disabled: bool) -> Sample {
        let pushed = self.pushed(time_us, disabled);
        let has = |fault| self.wiring.has(fault);
        let mut seen = Sample { position: sample.position.wrapping_add(pushed), ..sample };
        let first = *self.first.get_or_insert(seen.position);
        if has(WiringFault::EncoderSwapped) && config.encoder_inverted == self.suits[0] {
            seen.position = first.wrapping_mul(2).wrapping_sub(seen.position);
        }
        if has(WiringFault::EncoderPullUp) {
            seen.position = first.wrapping_add(i32::from(seen.position % 2 != 0));
        }
        if has(WiringFault::PressuresSwapped) {
            (seen.pressure_1, seen.pressure_2) = (seen.pressure_2, seen.pressure_1);
        }
        if has(WiringFault::PressureFloats) {
            let hum = (TAU * MAINS_HZ * time_us as f64 * 1e-6).sin();
            seen.pressure_1 = (self.full_scale * (0.5 + 0.25 * hum)) as i16;
        }
        seen
    }

    /// The part of a command that reaches the drive.
    pub fn driven(&self, config: &Config, command: Command) -> Command {
        let has = |fault| self.wiring.has(fault);
        let Command { counts, step, .. } = command;
        let inverted = matches!(config.drive, DriveConfig::Dac(dac) if dac.inverted) != self.suits[1];
        if has(WiringFault::EnableOpen) {
            Command { counts: 0, step: 0, ..command }
        } else if has(WiringFault::ValveInverted) && !inverted {
            Command { counts: counts.saturating_neg(), step: step.saturating_neg(), ..command }
        } else {
            command
        }
    }

    /// How far a hand has pushed the slide out, counts: half a wave of a squared sine.
    fn pushed(&mut self, time_us: u64, disabled: bool) -> i32 {
        let disabled_since = disabled.then(|| self.disabled_since.unwrap_or(time_us));
        self.disabled_since = disabled_since;
        let rested_us = disabled_since.map_or(0, |since| time_us.saturating_sub(since));
        if self.push_since.is_none() && disabled && self.begins(rested_us) {
            self.push_since = Some(time_us);
        }
        let Some(since) = self.push_since else { return 0 };
        let passed_us = time_us.saturating_sub(since);
        if passed_us >= PUSH_US {
            self.push_since = None;
            self.disabled_since = None;
            return 0;
        }
        let half_wave = (TAU / 2.0 * passed_us as f64 / PUSH_US as f64).sin();
        (self.counts_per_push * half_wave * half_wave) as i32
    }

    /// Whether a push begins on a drive that has been disabled for long enough.
    fn begins(&self, rested_us: u64) -> bool {
        self.wiring.with(|shared| match shared.pushes {
            Pushes::Never => false,
            Pushes::Once => {
                shared.pushes = Pushes::Never;
                true
            }
            Pushes::AgainAndAgain => rested_us >= PAUSE_US,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signals(faults: &[WiringFault]) -> Signals {
        let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let signals = Signals::of(&rig);
        faults.iter().for_each(|&fault| signals.wiring.spoil(fault));
        signals
    }

    fn sample(position: i32) -> Sample {
        Sample { position, pressure_1: 1000, pressure_2: 2000, ..Sample::default() }
    }

    const OUT: Command = Command { counts: 300, step: 1, drive_enable: true };

    #[test]
    fn right_wires_change_nothing() {
        let (mut signals, config) = (signals(&[]), Config::default());
        assert_eq!(signals.sensed(&config, sample(7), 0, true), sample(7));
        assert_eq!(signals.driven(&config, OUT), OUT);
    }

    #[test]
    fn swapped_tracks_count_down_from_where_the_counter_stood_unless_the_controller_turns_them() {
        let mut signals = signals(&[WiringFault::EncoderSwapped]);
        let config = Config::default();
        let seen = [7, 9, 4].map(|count| signals.sensed(&config, sample(count), 0, false).position);
        assert_eq!(seen, [7, 5, 10]);
        let turned = Config { encoder_inverted: true, ..config };
        assert_eq!(signals.sensed(&turned, sample(9), 0, false).position, 9);
    }

    #[test]
    fn a_track_that_does_not_switch_counts_to_and_fro_by_one() {
        let mut signals = signals(&[WiringFault::EncoderPullUp]);
        let config = Config::default();
        let seen = [8, 9, 400, 401].map(|count| signals.sensed(&config, sample(count), 0, false).position);
        assert_eq!(seen, [8, 9, 8, 9]);
    }

    #[test]
    fn a_valve_on_wrong_wires_gets_the_negative_and_one_that_is_not_enabled_nothing() {
        let config = Config::default();
        let driven = |fault| signals(&[fault]).driven(&config, OUT);
        assert_eq!(driven(WiringFault::ValveInverted), Command { counts: -300, step: -1, ..OUT });
        assert_eq!(driven(WiringFault::EnableOpen), Command { counts: 0, step: 0, ..OUT });
    }

    #[test]
    fn a_hand_pushes_the_slide_of_a_disabled_drive_out_and_back_once() {
        let (mut signals, config) = (signals(&[]), Config::default());
        signals.wiring.push();
        let mut at = |time_us, disabled| signals.sensed(&config, sample(0), time_us, disabled).position;
        assert_eq!(at(0, false), 0, "not while it is enabled");
        assert_eq!(at(1000, true), 0);
        let out = at(1000 + PUSH_US / 2, true);
        assert!((1655..=1660).contains(&out), "20 mm are 1660 counts of 12.05 um, not {out}");
        assert_eq!([at(1000 + PUSH_US, true), at(9 * PUSH_US, true)], [0, 0]);
    }
}
