//! The control laws (thesis 6.3.3, Appendix IX): a reference and what is measured to a demand. A law is a file here and its line
//! in the list `laws!` ([`crate::choice`]).
//!
//! A law has constants of its own ([`Settings`]) beside those that laws share ([`LawConfig`]), begins with each run, and is then
//! asked once a sample. What it remembers can be looked at ([`Running`]). `feedback` holds the sum that laws share.
//!
//! In open loop there is no law: the demand is the setpoint. What was learned of the valve's null ([`crate::learning`]) is added
//! to the null offset.

pub mod cascade;
mod feedback;
pub mod gain_profile;
pub mod moore_proportional;
pub mod on_off;
pub mod pid;
pub mod proportional;

use core::num::NonZeroU32;

use crate::choice::laws;
pub use crate::choice::{Law, Loop};
use crate::estimator::Motion;
use crate::fault::Fault;
use crate::parameters::{Parameters, id};
use crate::profile::Point;

/// The constants that laws share. Gains are plain numbers; `scale` makes the demand valve counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LawConfig {
    /// Open or closed loop.
    pub control_loop: Loop,
    /// Which law, and its own constants.
    pub settings: Settings,
    /// Kv, on counts per velocity window.
    pub velocity_gain: u16,
    /// Ka, on counts per velocity window per acceleration window.
    pub acceleration_gain: u16,
    /// |n_v| below this counts as standing still.
    pub velocity_dead_band: Option<NonZeroU32>,
    /// |n_p| below this asks for nothing; 0 switches it off.
    pub dead_band: u32,
    /// k5, on the raw quasi-transient pressure difference; 0: pressures are not fed back.
    pub pressure_gain: u16,
    /// L_DAC: 256 for the solenoid, 65536 for the stepper.
    pub scale: NonZeroU32,
    /// Added to the demand: the command at which the valve is at its null, counts.
    pub null_offset: i16,
    /// The share of the error at rest that goes into the null offset; 0: nothing is learned.
    pub learning_gain: u16,
    /// The largest command that the drive stage takes, valve counts.
    pub largest: i16,
}

impl LawConfig {
    /// Whether what the law of the other one has learned says nothing of this one.
    #[must_use]
    pub fn is_of_another_drive(&self, other: &LawConfig) -> bool {
        match (&self.settings, &other.settings) {
            (Settings::Cascade(own), Settings::Cascade(other)) => own.differ_but_for_what_is_kept(other),
            (own, other) => own != other,
        }
    }

    /// Takes over what an arming has learned: in all else the other one is the same.
    pub fn learn(&mut self, learned: &LawConfig) {
        self.null_offset = learned.null_offset;
        if let (Settings::Cascade(own), Settings::Cascade(learned)) = (&mut self.settings, &learned.settings)
        {
            own.learn(learned);
        }
    }
}

/// The gain of the law in force on pressures.
pub(crate) fn pressure_gain(parameters: &Parameters) -> u16 {
    parameters.scalar(match Law::of(parameters.scalar(id::LAW)) {
        Law::OnOff => id::PRESSURE_FEEDBACK_GAIN,
        _ => id::PRESSURE_DAMPING_GAIN,
    }) as u16
}

/// n_p, saturated to 32 bits; 0 in open loop.
pub(crate) fn error(config: &LawConfig, setpoint: i32, position: i32) -> i32 {
    match config.control_loop {
        Loop::Closed => setpoint.saturating_sub(position),
        Loop::Open => 0,
    }
}

/// What a law is to achieve at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Reference {
    /// n_p, counts.
    pub error: i32,
    /// n_f, of the setpoint's own motion.
    pub feed_forward: i64,
    /// That motion itself, while a profile moves the setpoint, for laws that follow it without n_f.
    pub point: Option<Point>,
}

/// What is measured at a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<'a> {
    pub motion: &'a Motion,
    /// Chamber pressures, raw.
    pub pressures: [i16; 2],
    /// Spool displacement, raw.
    pub spool: i16,
    /// What was learned of the valve's null, counts.
    pub learned: i32,
}

impl Measured<'_> {
    /// The command at which the valve is at its null, counts.
    pub fn null(&self, config: &LawConfig) -> i32 {
        i32::from(config.null_offset).saturating_add(self.learned)
    }
}

/// What the controller asks of a law.
pub(crate) trait ControlLaw: Default {
    /// Its own constants.
    type Settings;

    /// The error, counts, beyond which the law pushes the axis even while it has shut the valve on the air that
    /// pushes, so that the command does not show the effort. By default there is none: the command is the effort.
    fn pushes_beyond(_settings: &Self::Settings) -> u32 {
        u32::MAX
    }

    /// The fault that ends the run, if the law has found that its drive is not the one that it is set up for.
    fn fault(&self) -> Option<Fault> {
        None
    }

    /// As it begins a run: a drive at rest.
    fn begin(_config: &LawConfig, _settings: &Self::Settings) -> Self {
        Self::default()
    }

    /// The demand in valve counts, before the limits of the drive stage.
    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Self::Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32;
}

/// Makes the laws of their list: constants, state and calls.
macro_rules! control_laws {
    ($($word:literal $file:ident::$law:ident, $about:literal;)+) => {
        /// Which law, with its own constants.
        #[derive(Clone, Debug, PartialEq, Eq)]
        #[allow(clippy::large_enum_variant)] // There is one of it, and no heap.
        #[repr(u16)] // Read and compared as a gain is, which is one instruction less a sample.
        pub enum Settings {
            $(#[doc = $about] $law($file::Settings),)+
        }

        impl Settings {
            /// The constants of parameters that are each within their range.
            pub(crate) fn of(parameters: &Parameters) -> Settings {
                match Law::of(parameters.scalar(id::LAW)) {
                    $(Law::$law => Settings::$law($file::Settings::of(parameters)),)+
                }
            }

            /// The error beyond which the law pushes the axis whatever its command, counts.
            pub(crate) fn pushes_beyond(&self) -> u32 {
                match self {
                    $(Settings::$law(settings) => <$file::$law as ControlLaw>::pushes_beyond(settings),)+
                }
            }
        }

        /// The law that runs, with what it remembers from sample to sample.
        #[allow(clippy::large_enum_variant)] // There is one of it, and no heap.
        #[derive(Clone, Debug, Default, PartialEq, Eq)]
        pub enum Running {
            /// None yet.
            #[default]
            None,
            $(#[doc = $about] $law($file::$law),)+
        }

        impl Running {
            /// The law of a configuration as it begins a run.
            pub(crate) fn begin(config: &LawConfig) -> Running {
                match &config.settings {
                    $(Settings::$law(settings) => Running::$law($file::$law::begin(config, settings)),)+
                }
            }

            /// The fault that ends the run, if the law has found one.
            pub(crate) fn fault(&self) -> Option<Fault> {
                match self {
                    Running::None => None,
                    $(Running::$law(law) => law.fault(),)+
                }
            }

            /// The demand in valve counts, before the limits of the drive stage.
            pub(crate) fn demand(&mut self, config: &LawConfig, measured: Measured, reference: Reference) -> i32 {
                match (&mut *self, &config.settings) {
                    $((Running::$law(law), Settings::$law(settings)) => {
                        law.demand(config, settings, measured, reference)
                    })+
                    _ => {
                        // Another law was put in force during a run: it begins here.
                        *self = Running::begin(config);
                        measured.null(config)
                    }
                }
            }
        }
    };
}

laws!(control_laws);
