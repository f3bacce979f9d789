//! The plant, as the controller sees it: a command in, a sample out.
//!
//! One [`Plant`] serves the simulator, the virtual rig and the emulated board alike, so all of them see the same
//! samples in every bit. Time is whole microseconds of the controller's clock. Samples come off the dense output of
//! the integrator and cost no step.

mod accuracy;

pub use crate::snapshot::{QUANTITIES, Quantity, Snapshot};
pub use accuracy::{Accuracy, PERTURBATION};

use pneudrive_controller::{Command, Sample};
use pneudrive_solver::{IntegrationError, Statistics, System};

use crate::assembly::build;
use crate::assembly::linear::{LinearModel, NotLinear};
use crate::assembly::{Assembly, Effects, Integration, StateVector, ValveState, scale_of, slot};
use crate::component::faults::SensorFaults;
use crate::component::load::Load;
use crate::component::operator::Request;
use crate::component::sensors::Sensors;
use crate::component::sensors::calibration::Reading;
use crate::component::supply::receiver::ReceiverState;
use crate::keys;
use crate::network::NetworkWork;
use crate::number::Pair;
use crate::values::{Rig, seconds};

/// A simulated rig without its controller: for a law of one's own, or none.
///
/// ```
/// use pneudrive_controller::Command;
/// use pneudrive_sim::{Accuracy, Plant, Rig};
///
/// let rig = Rig::builtin("servo-b").expect("a built-in rig");
/// let mut plant = Plant::new(&rig, Accuracy::default(), 0);
/// let start = plant.sample()?.position;
/// let wide_open = Command { counts: 2048, step: 0, drive_enable: true };
/// let mut there = start;
/// for _ in 0..100 {
///     there = plant.advance(wide_open)?.position;
/// }
/// assert!(there > start + 1000, "it extends by {} counts in 0.13 s", there - start);
/// # Ok::<(), pneudrive_sim::IntegrationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plant {
    assembly: Assembly,
    integrator: Integration,
    sensors: Sensors,
    sensor_faults: SensorFaults,
    /// The plant's time at sample 0, microseconds: how long it has run at null since its initial state.
    start_us: u64,
    period_us: u64,
    delay_us: u64,
    /// The length of a second of the controller's clock, s.
    clock: f64,
    /// Delay of the converter from one channel to the next, microseconds.
    channel_skew_us: u64,
    /// Request in force.
    request: Request,
    /// Request that takes effect at the output of the present sample; None once it has, or if it changes nothing.
    due: Option<Request>,
    /// Whether the command changed at the last output. Then it usually changes at the next one, too, and a step
    /// beyond that would be wasted.
    restless: bool,
    /// Number of the sample taken last.
    k: u64,
    /// Its time, s.
    sample_time: f64,
}

/// Allowed error of a flow over the tolerance, kg/s. In a step of half a millisecond this amounts to a sixth of the
/// allowed error of the mass in a chamber of 0.9 g. Most flows are far more exact, because the last correction
/// squares the error.
const FLOW: f64 = 0.3;

/// kg/s: flows need not be more exact than this until [`FLOW`] demands it.
const SMALL_FLOW_ERROR: f64 = 3e-10;

/// Allowed error of a flow over a tolerance above 3e-7, kg/s: too little to be seen in a step.
const FLOW_OF_LOOSE: f64 = 1e-3;

/// s: in longer steps the allowed error of the flows is proportionally smaller.
const SHORT_STEP: f64 = 0.5e-3;

/// At this tolerance and above, the effect of a flow error on the air in a long step is smaller than any requirement.
const LOOSE: f64 = 1e-9;

/// Allowed error of a flow at a tolerance, kg/s. Behind tubes that lag it acts on pressures at once.
fn flow_error(tolerance: f64, lags: bool) -> f64 {
    let loose = if lags { 0.0 } else { FLOW_OF_LOOSE * tolerance };
    (FLOW * tolerance).min(loose.max(SMALL_FLOW_ERROR))
}

/// The work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlantWork {
    /// The integrator's part.
    pub integrator: Statistics,
    /// The network's part.
    pub network: NetworkWork,
}

impl Plant {
    /// The plant of a rig in the initial state of its test, at t = 0. `seed` is for sensor noise.
    #[must_use]
    pub fn new(rig: &Rig, accuracy: Accuracy, seed: u64) -> Plant {
        let (mut parts, x) = build::drive(rig);
        parts.network = parts.network.with_flow_error(flow_error(accuracy.tolerance, parts.lag.is_some()));
        if accuracy.tolerance < LOOSE {
            parts.network = parts.network.by_steps_of(SHORT_STEP);
        }
        let scale = scale_of(&parts);
        let assembly = Assembly::new(parts, &x);
        let start_us = rig.microseconds(&keys::controller::START_S);
        let clock = 1.0 + 1e-2 * rig.get(&keys::controller::CLOCK_ERROR_PERCENT);
        Plant {
            clock,
            assembly,
            integrator: Integration::of_parts(accuracy.method, accuracy.tolerance, scale, x),
            sensors: Sensors::new(rig, seed),
            sensor_faults: SensorFaults::new(&rig.fault_events()),
            start_us,
            period_us: u64::from(rig.period_us().get()),
            delay_us: rig.microseconds(&keys::controller::DELAY_S),
            channel_skew_us: rig.microseconds(&keys::sensors::CHANNEL_SKEW_S),
            request: Request::default(),
            due: None,
            restless: false,
            k: 0,
            sample_time: clock * seconds(start_us),
        }
    }

    /// The same plant sampled at another period, and driven after another delay (microseconds).
    #[must_use]
    pub fn with_timing(mut self, period_us: u64, delay_us: u64) -> Plant {
        (self.period_us, self.delay_us) = (period_us, delay_us);
        self
    }

    /// The inputs of the sensors at the present sample: position and first pressure at its instant, the second
    /// pressure and the spool one and two channel skews later.
    ///
    /// # Errors
    /// When the integration fails before the last channel.
    #[inline(always)]
    pub fn reading(&mut self) -> Result<Reading, IntegrationError> {
        let begins_late = self.k == 0 && self.start_us > 0;
        match begins_late || self.channel_skew_us > 0 {
            true => self.read_in_turn(),
            false => Ok(self.reading_at(self.sample_time)),
        }
    }

    /// The same if the plant has run before its first sample, or if the converter reads the channels in turn.
    #[cold]
    #[inline(never)]
    fn read_in_turn(&mut self) -> Result<Reading, IntegrationError> {
        self.run_to(self.sample_time)?;
        let at_once = self.reading_at(self.sample_time);
        if self.channel_skew_us == 0 {
            return Ok(at_once);
        }
        // A copy goes ahead, so that reading changes nothing here.
        let mut ahead = self.clone();
        let [second, third] = [1, 2].map(|channel| ahead.read_channel(channel));
        Ok(Reading {
            pressures: [at_once.pressures[0], second?.pressures[1]],
            spool: third?.spool,
            ..at_once
        })
    }

    /// All sensors when the converter reads a channel of the present sample.
    fn read_channel(&mut self, channel: u64) -> Result<Reading, IntegrationError> {
        let t = self.time_of(self.k * self.period_us + channel * self.channel_skew_us);
        self.run_to(t)?;
        Ok(self.reading_at(t))
    }

    #[inline]
    fn reading_at(&mut self, t: f64) -> Reading {
        let x = self.integrator.state(t);
        let spool = self.assembly.spool(t, x);
        Reading { position: x[slot::POSITION], pressures: self.assembly.sensed_pressures(x), spool }
    }

    /// The sensors at the present sample.
    ///
    /// # Errors
    /// As [`Plant::reading`].
    pub fn sample(&mut self) -> Result<Sample, IntegrationError> {
        let reading = self.reading()?;
        Ok(self.sample_of(&reading))
    }

    /// The sensor values for a reading at the present sample instant.
    #[inline]
    pub fn sample_of(&mut self, reading: &Reading) -> Sample {
        let mut sample = self.sensors.read(reading.position, reading.pressures, reading.spool);
        self.sensor_faults.corrupt(self.k * self.period_us, &mut sample);
        sample
    }

    /// From sample k to sample k + 1, with `command` in force from the output in between.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn advance(&mut self, command: Command) -> Result<Sample, IntegrationError> {
        self.command(command);
        self.next_sample()?;
        self.sample()
    }

    /// Lets `command` take effect at the output of the present sample.
    #[inline]
    pub fn command(&mut self, command: Command) {
        let request = Request { counts: command.counts, step: command.step };
        self.due = Some(request).filter(|request| self.changes(*request));
        self.restless &= self.due.is_some();
    }

    /// Changes the supply pressure, that of the line in front of a receiver, or what a regulator is set to, from the present sample on,
    /// Pa absolute; within the range of `supply.pressure_pa`.
    pub fn set_supply_pressure(&mut self, pressure: f64) {
        let at = self.sample_time;
        let set =
            |assembly: &mut Assembly, x: &mut StateVector| assembly.set_supply_pressure(at, x, pressure);
        self.integrator.interrupt(&mut self.assembly, at, set);
    }

    /// Changes the load from the present sample on: its mass and forces; the model of its friction stays.
    pub fn set_load(&mut self, load: Load) {
        let at = self.sample_time;
        self.integrator.interrupt(&mut self.assembly, at, |assembly, x| assembly.set_load(x, load));
    }

    /// Changes the target of a continuous controller at the present sample, counts.
    pub(crate) fn set_target(&mut self, target: i32) {
        let at = self.sample_time;
        self.integrator.interrupt(&mut self.assembly, at, |assembly, x| assembly.set_target(at, x, target));
    }

    /// The command of a continuous controller at the present sample, counts.
    pub(crate) fn continuous_command(&mut self) -> Option<f64> {
        self.assembly.parts.continuous.as_ref()?;
        let x = self.integrator.state(self.sample_time);
        self.assembly.follow(x)
    }

    /// To sample k + 1.
    ///
    /// # Errors
    /// When the integration fails.
    #[inline]
    pub fn next_sample(&mut self) -> Result<(), IntegrationError> {
        let next = self.time_of((self.k + 1) * self.period_us);
        self.run_to(next)?;
        (self.k, self.sample_time) = (self.k + 1, next);
        Ok(())
    }

    /// The measurable quantities at `t`, from the present sample on to the next. Once the command is known, looking
    /// changes nothing: the steps are the same without it.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn look(&mut self, t: f64) -> Result<Snapshot, IntegrationError> {
        self.come_to(t)?;
        Ok(self.snapshot(t))
    }

    /// Comes to `t`, for what can be seen there.
    ///
    /// # Errors
    /// When the integration fails.
    #[inline]
    pub(crate) fn come_to(&mut self, t: f64) -> Result<(), IntegrationError> {
        self.run_to(self.plant_time(t))
    }

    /// Only position (m), velocity (m/s) and pressures (Pa) at `t`, to which the plant has come.
    #[inline]
    pub(crate) fn motion(&mut self, t: f64) -> (f64, f64, [f64; 2]) {
        let x = self.integrator.state(self.plant_time(t));
        let pressures = self.assembly.pressures(x);
        (x[slot::POSITION], x[slot::VELOCITY], pressures)
    }

    /// Integrates to `t`, through the present sample's output if that is due. Only the outputs limit how far a step
    /// may reach beyond, not the place where the caller stops.
    #[inline]
    fn run_to(&mut self, t: f64) -> Result<(), IntegrationError> {
        if self.due.is_none() && self.integrator.has_passed(t) { Ok(()) } else { self.run_on_to(t) }
    }

    fn run_on_to(&mut self, t: f64) -> Result<(), IntegrationError> {
        if let Some(request) = self.due {
            let output = self.output_time_of(self.k);
            self.integrator.integrate_to(&mut self.assembly, t.min(output), output)?;
            if t < output {
                return Ok(());
            }
            self.drive(output, request);
        }
        let horizon = if self.restless { self.output_time_of(self.k + 1) } else { f64::INFINITY };
        self.integrator.integrate_to(&mut self.assembly, t, horizon)
    }

    fn changes(&self, request: Request) -> bool {
        request.counts != self.request.counts || request.step != 0
    }

    fn drive(&mut self, at: f64, request: Request) {
        self.due = None;
        self.restless = true;
        self.request = request;
        self.integrator.interrupt(&mut self.assembly, at, |assembly, x| assembly.drive(at, x, request));
    }

    /// The measurable quantities at `t`, to which the plant has come.
    pub(crate) fn snapshot(&mut self, t: f64) -> Snapshot {
        let t = self.plant_time(t);
        let [one, two] = match self.assembly.pocket_mass() {
            None => slot::MASS.map(|mass| self.integrator.derivative_of(mass, t)),
            Some(pocket) => self.rates_with_pocket(pocket, t),
        };
        let x = self.integrator.state(t);
        self.assembly.follow(x);
        let Effects { air, actuator_force, friction_force, acceleration } = self.assembly.effects(x);
        let flows = match one.zip(two) {
            Some((one, two)) => self.assembly.port_flows_of(Pair::new([one, two]), &air),
            None => self.assembly.port_flows(t, x),
        };
        Snapshot {
            position: x[slot::POSITION],
            velocity: x[slot::VELOCITY],
            acceleration,
            pressures: air.pressure.to_array(),
            temperatures: air.temperature.to_array(),
            spool: self.assembly.spool(t, x),
            spool_command: self.assembly.parts.operator.commanded(),
            mass_flows: flows.to_array(),
            actuator_force,
            friction: friction_force,
        }
    }

    /// The slopes of the masses behind the ports, kg/s: of a chamber together with its pocket.
    #[cold]
    fn rates_with_pocket(&mut self, (end, pocket): (usize, usize), t: f64) -> [Option<f64>; 2] {
        let mut rates = slot::MASS.map(|mass| self.integrator.derivative_of(mass, t));
        let of_pocket = self.integrator.derivative_of(pocket, t);
        rates[end] = rates[end].zip(of_pocket).map(|(chamber, pocket)| chamber + pocket);
        rates
    }

    /// The air in the receiver at `t`, to which the plant has come, if there is one.
    #[inline]
    pub(crate) fn receiver_state(&mut self, t: f64) -> Option<ReceiverState> {
        self.assembly.parts.receiver.as_ref()?;
        let x = self.integrator.state(self.plant_time(t));
        self.assembly.receiver_state(x)
    }

    /// The air inside the valve at `t`, to which the plant has come.
    pub(crate) fn valve_state(&mut self, t: f64) -> ValveState {
        let t = self.plant_time(t);
        let x = self.integrator.state(t);
        self.assembly.follow(x);
        self.assembly.valve_state(t, x)
    }

    /// The mass flows of [`Plant::look`] by the network's equations, kg/s. For tests: a row has the slopes of the masses.
    #[doc(hidden)]
    pub fn solved_flows(&mut self, t: f64) -> [f64; 2] {
        let t = self.plant_time(t);
        let x = self.integrator.state(t);
        self.assembly.follow(x);
        self.assembly.port_flows(t, x).to_array()
    }

    /// One evaluation of the right-hand side in the state of the present sample, `later` seconds after it: the
    /// acceleration of the load, m/s^2. For benchmarks; the network keeps the flows that it finds.
    #[doc(hidden)]
    pub fn evaluate(&mut self, later: f64) -> f64 {
        let t = self.sample_time;
        let x = self.integrator.state(t);
        self.assembly.derivative(t + later, x)[slot::VELOCITY]
    }

    /// The plant about the state of the present sample as a linear system; a new plant has none before its first sample is
    /// taken.
    ///
    /// # Errors
    /// Where a command acts on nothing, or the equations have no slopes.
    pub fn linearise(&mut self) -> Result<LinearModel, NotLinear> {
        let (t, command) = (self.sample_time, f64::from(self.request.counts));
        let x = self.integrator.state(t);
        self.assembly.linearise(t, x, command)
    }

    fn output_time_of(&self, k: u64) -> f64 {
        self.time_of(k * self.period_us + self.delay_us)
    }

    /// The plant's time at this many microseconds of the controller's clock after sample 0, s.
    fn time_of(&self, after_start_us: u64) -> f64 {
        self.clock * seconds(self.start_us + after_start_us)
    }

    /// The plant's time `t` seconds after sample 0; rounded to a whole microsecond if the two clocks differ.
    fn plant_time(&self, t: f64) -> f64 {
        if self.start_us == 0 { self.clock * t } else { self.time_of((1e6 * t).round() as u64) }
    }

    /// The work of the run so far.
    #[must_use]
    pub fn work(&self) -> PlantWork {
        PlantWork { integrator: self.integrator.statistics(), network: self.assembly.parts.network.work }
    }
}

#[cfg(test)]
mod tests;
