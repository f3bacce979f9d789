//! The design variables of the search, and the keys that they set.
//!
//! The law's gains are integers whose size depends on valve, encoder and period. The design variables are therefore
//!
//! ```text
//! e_near, e_far   error at which the profile alone opens the valve fully: at small errors, at large ones   mm
//! e_knee          error at which the profile is halfway between                                            mm
//! T_d, T_a        Kv = K_far T_d / (window T),   Ka = K_far T_a^2 / (windows T^2)                          s
//! Kp[i]           K_far + (K_near - K_far) / (1 + (e / e_knee)^2),   K = scale full / e
//! ```
//!
//! with `full` the command that opens the valve fully and T the sample period; in addition the dead band, the null offset
//! and, if the rig says that its user can set it (`operator.dither_adjustable`), the dither. Fixed keys keep the rig's value,
//! and genes that set nothing else are left out. A fixed profile keeps its span, too, and its last entry is K_far.

use anyhow::{Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::component::{controller, operator};
use pneudrive_sim::key::Typed;
use pneudrive_sim::keys;

use super::design_variable::{self, DesignVariable};

/// Gains of a profile that differ by less than this are equal.
const ALIKE: f64 = 1.02;

/// Largest gain.
const MAX_GAIN: f64 = 65_535.0;

const PROFILE: &str = keys::controller::GAIN_PROFILE.key.path;
const SPAN: &str = keys::controller::PROFILE_SPAN_COUNTS.key.path;
const PROPORTIONAL: &str = keys::controller::PROPORTIONAL_GAIN.key.path;

const DITHER: [&str; 2] = [keys::dither::DITHER_MM.key.path, keys::dither::DITHER_HZ.key.path];

/// Whether its amplifier can have a dither.
fn is_dithered(rig: &Rig) -> bool {
    rig.get(&keys::operator::MODEL).is_solenoid()
}

/// What there is to tune of the law that positions by a model of its drive, and the key of each.
const OF_MODEL: [(&DesignVariable, &Typed<f64>); 3] = [
    (&design_variable::DEAD_TIME_FACTOR, &keys::controller::CASCADE_DEAD_TIME_FACTOR),
    (&design_variable::FLOW_SHARE, &keys::controller::CASCADE_FLOW_SHARE),
    (&design_variable::OBSERVER_FACTOR, &keys::controller::CASCADE_OBSERVER_FACTOR),
];

/// The genes of a rig.
#[derive(Clone, Debug)]
pub struct Space {
    rig: Rig,
    variables: Vec<&'static DesignVariable>,
    fixed: Vec<String>,
    settled_mm: f64,
}

/// The result for a gene, beside the range of its search.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// Its name.
    pub what: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The value found.
    pub value: f64,
    /// The range that was searched.
    pub range: [f64; 2],
    /// Whether the value found is an end of that range which is not a natural one: a better value may lie beyond.
    pub at_limit: bool,
}

impl Space {
    /// The genes of a rig whose keys `fixed` stay as they are.
    ///
    /// # Errors
    /// When its law has no gains, or all of them are held.
    pub fn of(rig: &Rig, settled_mm: f64, fixed: &[String]) -> Result<Space> {
        if rig.get(&keys::controller::LOOP) != controller::Loop::Closed
            || rig.get(&keys::controller::MODEL) != controller::ControllerKind::Sampled
        {
            bail!(
                "gains are searched in closed loop, with the firmware's controller: controller.loop=closed, controller.model=sampled"
            );
        }
        let law = rig.get(&keys::controller::LAW);
        if law == controller::Law::OnOff {
            bail!(
                "the law \"{}\" of {} has no gain to tune; choose controller.law=gain-profile",
                law.word(),
                rig.name()
            );
        }
        let has_profile = law == controller::Law::GainProfile;
        let has_dither = is_dithered(rig) && rig.get(&keys::dither::DITHER_ADJUSTABLE);
        let is_held = |key: &str| fixed.iter().any(|other| other == key);
        let has_gain = !is_held(if has_profile { PROFILE } else { PROPORTIONAL });
        let dithers = !(is_held(DITHER[0]) && rig.get(&keys::dither::DITHER_MM) == 0.0);
        let variables = [
            (&design_variable::E_FAR, has_gain),
            (&design_variable::T_D, !is_held(keys::controller::VELOCITY_GAIN.path)),
            (&design_variable::T_A, !is_held(keys::controller::ACCELERATION_GAIN.path)),
            (&design_variable::VELOCITY_WINDOW, !is_held(keys::controller::VELOCITY_WINDOW_SAMPLES.path)),
            (
                &design_variable::ACCELERATION_WINDOW,
                !is_held(keys::controller::ACCELERATION_WINDOW_SAMPLES.path),
            ),
            (&design_variable::DEAD_BAND, !is_held(keys::controller::DEAD_BAND_COUNTS.path)),
            (&design_variable::NULL_OFFSET, !is_held(keys::controller::NULL_OFFSET_COUNTS.path)),
            (&design_variable::E_NEAR, has_profile && has_gain),
            (&design_variable::E_KNEE, has_profile && has_gain),
            (&design_variable::DITHER, has_dither && !is_held(DITHER[0])),
            (&design_variable::DITHER_HZ, has_dither && dithers && !is_held(DITHER[1])),
        ];
        let variables = match law {
            controller::Law::Cascade => {
                OF_MODEL.map(|(variable, key)| (variable, !is_held(key.key.path))).to_vec()
            }
            _ => variables.to_vec(),
        };
        let variables: Vec<_> = variables
            .into_iter()
            .filter_map(|(design_variable, is_free)| is_free.then_some(design_variable))
            .collect();
        if variables.is_empty() {
            bail!("every key that tune searches is fixed; fix fewer (--fix)");
        }
        Ok(Space { rig: rig.clone(), variables, fixed: fixed.to_vec(), settled_mm })
    }

    /// Keys of the valve that the search leaves as they are, because the rig does not say that its user can set them.
    #[must_use]
    pub fn left_alone(rig: &Rig) -> &'static [&'static str] {
        let is_set_by_its_maker = is_dithered(rig) && !rig.get(&keys::dither::DITHER_ADJUSTABLE);
        if is_set_by_its_maker { &DITHER } else { &[] }
    }

    /// What is searched, in words.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        self.variables.iter().map(|variable| variable.what).collect()
    }

    /// How many genes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.variables.len()
    }

    /// Whether there are none: never.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.variables.is_empty()
    }

    /// The settings for genes from 0 to 1, as `key=value`.
    #[must_use]
    pub fn settings(&self, shares: &[f64]) -> Vec<String> {
        if self.rig.knows_its_drive() {
            return self.of_model(shares);
        }
        let value = |design_variable: &DesignVariable| {
            let place = self.variables.iter().position(|other| other.what == design_variable.what);
            place.map(|place| design_variable.value(shares[place]))
        };
        let window = |design_variable: &DesignVariable, key: &Typed<i64>| {
            value(design_variable).unwrap_or(self.rig.get(key) as f64)
        };
        let windows = [
            window(&design_variable::VELOCITY_WINDOW, &keys::controller::VELOCITY_WINDOW_SAMPLES),
            window(&design_variable::ACCELERATION_WINDOW, &keys::controller::ACCELERATION_WINDOW_SAMPLES),
        ];
        let far = value(&design_variable::E_FAR).map_or_else(|| self.fixed_gain(), |mm| self.gain_at(mm));
        let samples = |time: f64| time / self.rig.get(&keys::controller::PERIOD_S);
        let gain = |value: f64| value.round().clamp(0.0, MAX_GAIN).to_string();
        let kv = value(&design_variable::T_D).map(|t_d| gain(far * samples(t_d) / windows[0]));
        let ka = value(&design_variable::T_A)
            .map(|t_a| gain(far * samples(t_a).powi(2) / (windows[0] * windows[1])));
        let dead_band =
            value(&design_variable::DEAD_BAND).map(|share| (share * self.settled_mm / self.mm()).floor());
        let null = value(&design_variable::NULL_OFFSET)
            .map(|percent| (percent / 100.0 * self.full_counts()).round());
        let profile = match (value(&design_variable::E_NEAR), value(&design_variable::E_KNEE)) {
            (Some(near), Some(knee)) => self.profile(self.gain_at(near).max(far), far, knee).map(Some),
            _ => [None, None],
        };
        let proportional = value(&design_variable::E_FAR).filter(|_| !self.has_profile());
        let [span, profile] = profile;
        let settings = [
            (keys::controller::VELOCITY_GAIN.path, kv),
            (keys::controller::ACCELERATION_GAIN.path, ka),
            (keys::controller::VELOCITY_WINDOW_SAMPLES.path, Some(windows[0].to_string())),
            (keys::controller::ACCELERATION_WINDOW_SAMPLES.path, Some(windows[1].to_string())),
            (keys::controller::DEAD_BAND_COUNTS.path, dead_band.map(|counts| counts.to_string())),
            (keys::controller::NULL_OFFSET_COUNTS.path, null.map(|counts| counts.to_string())),
            (SPAN, span),
            (PROFILE, profile),
            (PROPORTIONAL, proportional.map(|_| gain(far.max(1.0)))),
            (DITHER[0], value(&design_variable::DITHER).map(|mm| format!("{mm:.3}"))),
            (DITHER[1], value(&design_variable::DITHER_HZ).map(|hz| format!("{hz:.1}"))),
        ];
        let free = settings.into_iter().filter(|(key, _)| self.fixed.iter().all(|fixed| fixed != key));
        free.filter_map(|(key, value)| Some(format!("{key}={}", value?))).collect()
    }

    /// The keys that a search sets.
    #[must_use]
    pub fn keys(&self) -> Vec<String> {
        let settings = self.settings(&vec![0.5; self.len()]);
        settings.iter().filter_map(|one| Some(one.split_once('=')?.0.to_owned())).collect()
    }

    /// Those of a law that knows its drive, to a thousandth.
    fn of_model(&self, shares: &[f64]) -> Vec<String> {
        let set = |(variable, share): (&&'static DesignVariable, &f64)| {
            let (_, key) = OF_MODEL.iter().find(|(other, _)| other.what == variable.what)?;
            Some(key.setting(format_args!("{:.3}", variable.value(*share))))
        };
        self.variables.iter().zip(shares).filter_map(set).collect()
    }

    /// Where genes from 0 to 1 lie in their ranges.
    #[must_use]
    pub fn places(&self, shares: &[f64]) -> Vec<Optimum> {
        let place = |(design_variable, share): (&&'static DesignVariable, &f64)| Optimum {
            what: design_variable.what,
            unit: design_variable.unit,
            value: design_variable.value(*share),
            range: [design_variable.value(0.0), design_variable.value(1.0)],
            at_limit: design_variable.is_at_limit(*share),
        };
        self.variables.iter().zip(shares).map(place).collect()
    }

    /// Keys among settings whose gain is the largest that the controller takes.
    #[must_use]
    pub fn saturated(settings: &[String]) -> Vec<&str> {
        let most = MAX_GAIN.to_string();
        let is_most = |value: &str| value.trim_matches(['[', ']']).split(", ").any(|entry| entry == most);
        settings
            .iter()
            .filter_map(|one| one.split_once('='))
            .filter(|one| is_most(one.1))
            .map(|one| one.0)
            .collect()
    }

    fn has_profile(&self) -> bool {
        self.rig.get(&keys::controller::LAW) == controller::Law::GainProfile
    }

    fn mm(&self) -> f64 {
        mm_per_count(&self.rig)
    }

    /// The command that opens the valve fully, counts.
    fn full_counts(&self) -> f64 {
        operator::largest_command(&self.rig) as f64
    }

    /// The gain that opens the valve fully at an error.
    fn gain_at(&self, error_mm: f64) -> f64 {
        self.full_counts() * self.rig.get(&keys::controller::SCALE) as f64 / (error_mm / self.mm())
    }

    /// The gain at large errors where it is held.
    fn fixed_gain(&self) -> f64 {
        match self.rig.get(&keys::controller::GAIN_PROFILE).last() {
            Some(last) if self.has_profile() => *last as f64,
            _ => self.rig.get(&keys::controller::PROPORTIONAL_GAIN) as f64,
        }
    }

    /// Span and profile, as long as it is another than at large errors, in spans of a sixth of the knee or as held.
    fn profile(&self, near: f64, far: f64, knee_mm: f64) -> [String; 2] {
        let knee = knee_mm / self.mm();
        let is_held = self.fixed.iter().any(|key| key == SPAN);
        let span = if is_held {
            self.rig.get(&keys::controller::PROFILE_SPAN_COUNTS) as f64
        } else {
            (knee / 6.0).round().max(1.0)
        };
        let entry = |i: usize| {
            let error = (i as f64 + 0.5) * span;
            (far + (near - far) / (1.0 + (error / knee).powi(2))).round().clamp(0.0, MAX_GAIN)
        };
        let last = far.round().clamp(0.0, MAX_GAIN);
        let near = (0..255).map(entry).take_while(|gain| *gain > ALIKE * last);
        let entries: Vec<String> = near.chain([last]).map(|gain| gain.to_string()).collect();
        [span.to_string(), format!("[{}]", entries.join(", "))]
    }
}
