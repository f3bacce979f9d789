//! What is looked for, and the keys that it becomes.
//!
//! The law's gains are integers whose size depends on valve, encoder and period. Looked for are therefore
//!
//! ```text
//! e_near, e_far   error at which the profile alone opens the valve whole: at small errors, at large ones   mm
//! e_knee          error at which the profile is halfway between                                            mm
//! T_d, T_a        Kv = K_far T_d / (window T),   Ka = K_far T_a^2 / (windows T^2)                          s
//! Kp[i]           K_far + (K_near - K_far) / (1 + (e / e_knee)^2),   K = scale full / e
//! ```
//!
//! with `full` the command that opens the valve whole and T the sample period; and beside them the dead band, the
//! null offset and, where the valve has one, the dither.

use anyhow::{Result, bail};
use pneudrive_sim::Rig;

/// A gene: from 0 to 1 a range of something.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gene {
    low: f64,
    high: f64,
    logarithmic: bool,
}

const fn ratio(low: f64, high: f64) -> Gene {
    Gene { low, high, logarithmic: true }
}

const fn linear(low: f64, high: f64) -> Gene {
    Gene { low, high, logarithmic: false }
}

impl Gene {
    fn value(&self, share: f64) -> f64 {
        if self.logarithmic {
            self.low * libm::pow(self.high / self.low, share)
        } else {
            self.low + share * (self.high - self.low)
        }
    }
}

/// Genes in their order; those that a rig has not are skipped.
const E_NEAR: Gene = ratio(0.15, 30.0);
const E_FAR: Gene = ratio(3.0, 150.0);
const E_KNEE: Gene = ratio(0.03, 10.0);
const T_D: Gene = ratio(0.003, 0.15);
/// Above, a count of acceleration throws the valve over.
const T_A: Gene = ratio(0.001, 0.04);
const VELOCITY_WINDOW: Gene = linear(2.0, 12.0);
const ACCELERATION_WINDOW: Gene = linear(1.0, 8.0);
/// Fractions of the distance that counts as settled.
const DEAD_BAND: Gene = linear(0.0, 1.0);
/// Fractions of the whole command.
const NULL_OFFSET: Gene = linear(-0.02, 0.02);
/// mm of the spool, Hz.
const DITHER: Gene = linear(0.0, 0.6);
const DITHER_HZ: Gene = linear(20.0, 120.0);

/// Gains of a profile that are less than this apart are one.
const ALIKE: f64 = 1.02;

/// Most that a gain can be.
const MOST_GAIN: f64 = 65_535.0;

/// The genes of a rig.
#[derive(Clone, Debug)]
pub struct Space {
    genes: Vec<Gene>,
    has_profile: bool,
    has_dither: bool,
    mm_per_count: f64,
    period_s: f64,
    /// The command that opens the valve whole, times the scale of the law.
    full: f64,
    /// The same without the scale, counts.
    full_counts: f64,
    settled_mm: f64,
}

impl Space {
    /// What there is to be looked for on a rig.
    ///
    /// # Errors
    /// When its law has no gains.
    pub fn of(rig: &Rig, settled_mm: f64) -> Result<Space> {
        if rig.word("controller.loop") != "closed" || rig.word("controller.model") != "sampled" {
            bail!(
                "gains are looked for in closed loop, with the controller that is flashed: controller.loop=closed, controller.model=sampled"
            );
        }
        let law = rig.word("controller.law");
        if law == "on-off" {
            bail!(
                "the on-off law of {} has no gain that a step could be tuned with; choose controller.law=gain-profile",
                rig.name()
            );
        }
        let has_profile = law == "gain-profile";
        let has_dither = rig.word("operator.model").starts_with("solenoid");
        let full_counts = match rig.word("operator.model") {
            "stepper" => rig.integer("operator.max_steps") as f64,
            _ => 2048.0,
        };
        let mut genes = vec![E_FAR, T_D, T_A, VELOCITY_WINDOW, ACCELERATION_WINDOW, DEAD_BAND, NULL_OFFSET];
        genes.extend(if has_profile { &[E_NEAR, E_KNEE][..] } else { &[] });
        genes.extend(if has_dither { &[DITHER, DITHER_HZ][..] } else { &[] });
        Ok(Space {
            genes,
            has_profile,
            has_dither,
            mm_per_count: rig.number("encoder.mm_per_count"),
            period_s: rig.number("controller.period_s"),
            full: full_counts * rig.integer("controller.scale") as f64,
            full_counts,
            settled_mm,
        })
    }

    /// How many genes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.genes.len()
    }

    /// Whether there are none: never.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.genes.is_empty()
    }

    /// What genes from 0 to 1 become, as `key=value`.
    #[must_use]
    pub fn settings(&self, shares: &[f64]) -> Vec<String> {
        let mut values = self.genes.iter().zip(shares).map(|(gene, share)| gene.value(*share));
        let mut next = || values.next().expect("as many shares as genes");
        let gain_at = |error_mm: f64| self.full / (error_mm / self.mm_per_count);
        let far = gain_at(next());
        let (t_d, t_a) = (next(), next());
        let windows = [next().round(), next().round()];
        let dead_band_counts = (next() * self.settled_mm / self.mm_per_count).floor();
        let null_counts = (next() * self.full_counts).round();
        let samples = |time: f64| time / self.period_s;
        let gain = |value: f64| value.round().clamp(0.0, MOST_GAIN);
        let mut settings = vec![
            format!("controller.velocity_gain={}", gain(far * samples(t_d) / windows[0])),
            format!(
                "controller.acceleration_gain={}",
                gain(far * samples(t_a).powi(2) / (windows[0] * windows[1]))
            ),
            format!("controller.velocity_window_samples={}", windows[0]),
            format!("controller.acceleration_window_samples={}", windows[1]),
            format!("controller.dead_band_counts={dead_band_counts}"),
            format!("controller.null_offset_counts={null_counts}"),
        ];
        if self.has_profile {
            settings.extend(self.profile(gain_at(next()).max(far), far, next()));
        } else {
            settings.push(format!("controller.proportional_gain={}", gain(far).max(1.0)));
        }
        if self.has_dither {
            settings.push(format!("operator.dither_mm={:.3}", next()));
            settings.push(format!("operator.dither_hz={:.1}", next()));
        }
        settings
    }

    /// The profile, as long as it is another than at large errors, in spans of a sixth of the knee.
    fn profile(&self, near: f64, far: f64, knee_mm: f64) -> [String; 2] {
        let knee = knee_mm / self.mm_per_count;
        let span = (knee / 6.0).round().max(1.0);
        let entry = |i: usize| {
            let error = (i as f64 + 0.5) * span;
            (far + (near - far) / (1.0 + (error / knee).powi(2))).round().clamp(0.0, MOST_GAIN)
        };
        let last = far.round().clamp(0.0, MOST_GAIN);
        let near = (0..255).map(entry).take_while(|gain| *gain > ALIKE * last);
        let entries: Vec<String> = near.chain([last]).map(|gain| gain.to_string()).collect();
        [
            format!("controller.profile_span_counts={span}"),
            format!("controller.gain_profile=[{}]", entries.join(", ")),
        ]
    }
}
