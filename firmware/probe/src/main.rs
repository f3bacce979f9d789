//! The smallest image that links the controller. It never runs: `cargo xtask probe` reads it, to see
//! that no float, no panic and no trapping division is left in what the compiler made of it.
//!
//! Every function here is exported, so the compiler knows nothing of its arguments and can prove no
//! path of the controller dead; `probe.x` keeps them all.
#![no_std]
#![no_main]

use core::num::NonZeroU32;
use core::panic::PanicInfo;

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::drive::DacConfig;
use pneudrive_controller::parameters::{self, Parameter, SetError};
use pneudrive_controller::sequencer::SequenceError;
use pneudrive_controller::{Command, Config, Fault, Move, Parameters, Refusal, Sample, Sequence, State};

/// Gives each call an exported function.
macro_rules! probes {
    ($($name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $call:expr;)*) => {$(
        #[unsafe(no_mangle)]
        fn $name($($argument: $type),*) $(-> $result)? {
            $call
        }
    )*};
}

#[cfg(feature = "guilty")]
mod guilty;

probes! {
    probe_sample(config: &Config, sequence: &Sequence, state: &mut State, input: &Sample) =
        pneudrive_controller::sample(config, sequence, state, input);
    probe_output(config: &Config, state: &mut State) -> Command = pneudrive_controller::output(config, state);
    probe_state() -> State = State::default();
    probe_start(config: &Config, sequence: &Sequence, state: &mut State) -> Result<(), Refusal> =
        state.start(config, sequence);
    probe_home(state: &mut State, config: &Config) -> Result<(), Refusal> = state.home(config);
    probe_arm_checked(state: &mut State, config: &Config) -> Result<(), Refusal> = state.arm(config);
    probe_seek_null(state: &mut State) -> Result<(), Refusal> = state.seek_null();
    probe_at_null(state: &mut State) -> Result<(), Refusal> = state.at_null();
    probe_reference_at(state: &mut State, position: i32) = state.reference(position);
    probe_learned(state: &State) -> i32 = state.learned_null_offset();

    probe_reference(state: &mut State) = state.supervisor.set_referenced();
    probe_arm(state: &mut State) -> Result<(), Refusal> = state.supervisor.arm();
    probe_disarm(state: &mut State) = state.supervisor.disarm();
    probe_trip(state: &mut State, fault: Fault) = state.supervisor.trip(fault);
    probe_fault(code: u8) -> Option<Fault> = Fault::from_code(code);
    probe_refusal(code: u8) -> Option<Refusal> = Refusal::from_code(code);

    probe_configure(parameters: &Parameters) -> Result<Config, ConfigError> = Config::new(parameters);
    probe_advice(error: ConfigError) -> &'static str = error.advice();
    probe_code(dac: &DacConfig, counts: i16) -> u16 = dac.code(counts).get();

    probe_parameters() -> Parameters = Parameters::default();
    probe_set(parameters: &mut Parameters, id: u16, value: i32) -> Result<(), SetError> =
        parameters.set(id, value);
    probe_get(parameters: &Parameters, id: u16) -> Option<i32> = parameters.get(id);
    probe_pairs(parameters: &Parameters, pairs: &mut [(u16, i32)]) =
        pairs.iter_mut().zip(parameters.iter()).for_each(|(stored, pair)| *stored = pair);
    probe_lookup(id: u16) -> Option<&'static Parameter> = parameters::lookup(id);
    probe_by_name(name: &str) -> Option<&'static Parameter> = parameters::by_name(name);

    probe_sequence(duration_samples: u32) -> Sequence = Sequence::new(duration_samples);
    probe_push(sequence: &mut Sequence, next: Move) -> Result<(), SequenceError> = sequence.push(next);
    probe_move(time_us: u32, period_us: NonZeroU32, target: i32) -> Move =
        Move::at_time_us(time_us, period_us, target);
}

/// Its presence in the image tells that a panic can be reached. Not inlined, so that it keeps its name.
#[panic_handler]
#[inline(never)]
fn panic(_: &PanicInfo) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
