"""The tables of a rig file as classes. Written by tests/stubs.py from the list of keys."""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict, type_check_only

from numpy.typing import NDArray

from ._pneudrive import Rig

class Table:
    """A table of a rig. Its attributes are the keys; they are read-only: `rig.with_(...)` makes another rig."""

    def __init__(self, rig: Rig) -> None: ...

CLASSES: dict[str, type[Table]]

def class_name(table: str) -> str: ...

class Gas(Table):
    @property
    def heat_capacity_ratio(self) -> float:
        """Ratio of the heat capacities at constant pressure and volume."""
    @property
    def gas_constant_j_per_kg_k(self) -> float:
        """Specific gas constant, J/(kg K)."""

class Supply(Table):
    @property
    def model(self) -> str:
        """Where the valve's air comes from: a reservoir of constant pressure, a receiver of a volume, which the valve empties and a line fills, or the volume behind a pressure regulator."""
    @property
    def pressure_pa(self) -> float:
        """Absolute supply pressure; with a receiver that of the line in front of it, with a regulator what it is set to at no flow, Pa."""
    @property
    def temperature_k(self) -> float:
        """Supply temperature; with a receiver that of the line, and of the receiver at the start, K."""
    @property
    def receiver_volume_m3(self) -> float:
        """Volume of the receiver, or behind the regulator (filter bowl, line), with the tube to the valve; 2 l is a round number, m3."""
    @property
    def feed_conductance_m3_per_s_pa(self) -> float:
        """Sonic conductance between line and receiver (ISO 6358), with all that is there, a regulator wide open. The default is that of a smooth tube of 4 mm bore and 3 m, for a line of 6 mm, m3/(s Pa)."""
    @property
    def feed_critical_ratio(self) -> float:
        """Critical pressure ratio between line and receiver (ISO 6358); long tubes have 0.2 to 0.3."""
    @property
    def check_valve(self) -> bool:
        """Whether a check valve keeps the air of the receiver from flowing back into the line. A receiver is bought without one."""
    @property
    def receiver_heat_transfer_w_per_m2_k(self) -> float:
        """Heat transfer of the receiver's walls, which have the temperature of the surroundings; 0: adiabatic, W/(m2 K)."""
    @property
    def primary_pressure_pa(self) -> float:
        """Absolute pressure of the line in front of the regulator, Pa."""
    @property
    def droop_pa(self) -> float:
        """Fall of the outlet pressure below supply.pressure_pa at which the regulator is wide open: by its sheet (ISO 6953), the fall at a flow times the flow wide open over that flow. 1 bar is a round number, Pa."""
    @property
    def relief_conductance_m3_per_s_pa(self) -> float:
        """Sonic conductance of the relief into the surroundings (ISO 6358), wide open supply.droop_pa above supply.pressure_pa; 0: it does not relieve. The default is a round number, m3/(s Pa)."""

class Exhaust(Table):
    @property
    def pressure_pa(self) -> float:
        """Absolute pressure of the surroundings, into which the valve exhausts, Pa."""
    @property
    def temperature_k(self) -> float:
        """Temperature of the surroundings, K."""

class Controller(Table):
    @property
    def model(self) -> str:
        """Sampled: the controller that is flashed. Continuous: the simulator's own, in floats."""
    @property
    def clock_error_percent(self) -> float:
        """How much longer a second of the controller's clock really is; the controller does not know it. Times of test, trace and records are those of its clock, %."""
    @property
    def clock_tolerance_percent(self) -> float:
        """How far that clock may be off, for identify. 0.5 is an assumption: that of a ceramic resonator. A crystal has 0.005, an RC oscillator 1 and more; 0: exact, %."""
    @property
    def start_s(self) -> float:
        """Time for which the drive runs with its valve at the null before the first sample, from the initial state of the test; whole microseconds. Times of test, trace and faults count from the first sample, s."""
    @property
    def gain_profile(self) -> list[int]:
        """Gain on the error, an entry for each span of error; the last one repeats to 256 entries."""
    @property
    def learn_null_offset(self) -> bool:
        """Whether the controller learns the command at which the valve is at its null."""
    @property
    def learning_gain(self) -> int:
        """Part of the error at rest that is added to the null offset, divided by the scale; 1 in the thesis, which has no effect within a day."""
    @property
    def cascade_dead_time_factor(self) -> float:
        """How much longer than by the rig file the law cascade takes the dead time of its force loop to be. All its poles are parts of its inverse."""
    @property
    def cascade_flow_share(self) -> float:
        """What the trajectories of the law cascade ask of the drive: this part of the force and of the rate of the force that there are, and 1.25 times as large a part of the speed."""
    @property
    def cascade_observer_factor(self) -> float:
        """How much faster than usual the observers of the law cascade are; less than 1 smooths more."""
    @property
    def pressure_feedback_gain(self) -> float:
        """Counts of error that a kPa of quasi-transient pressure difference subtracts: it damps (9.1.2). 12.4 is Burrows' k5 and the default of the on-off law (the thesis does not give its unit); 0 is that of the other laws."""
    @property
    def law(self) -> str:
        """How the position error becomes a demand. The variable dead band gain of 6.3.3 has no equation there; dead_band_counts, or zeros at the head of gain_profile, give a fixed one."""
    @property
    def loop(self) -> str:
        """Open: moves are valve commands, nothing is fed back."""
    @property
    def period_s(self) -> float:
        """Sample period; whole microseconds, s."""
    @property
    def delay_s(self) -> float:
        """From a sample to its output; whole microseconds, less than the period, s."""
    @property
    def profile_span_counts(self) -> int:
        """Range of error that one entry of the gain profile covers, counts."""
    @property
    def proportional_gain(self) -> int:
        """Gain of the laws without a profile."""
    @property
    def integral_gain(self) -> int:
        """Gain on the sum of the errors at the samples, in 256ths; 0: off."""
    @property
    def integral_band_counts(self) -> int:
        """Errors beyond it are not summed; 0: all are, counts."""
    @property
    def dead_zone_counts(self) -> int:
        """Moore's law adds it in the direction of the error: what takes the spool across its dead zone. 102 for the DAC, 4 steps for the stepper: 0.05 mm, half of the hysteresis C(29), counts."""
    @property
    def velocity_gain(self) -> int:
        """Gain on counts per velocity window; the thesis's 1 gives no damping, about 1000 does."""
    @property
    def acceleration_gain(self) -> int:
        """Gain on counts per velocity and acceleration window."""
    @property
    def velocity_feed_forward(self) -> int:
        """Gain on the setpoint's own counts per velocity window while a profile moves it; as much as velocity_gain takes the damping off that motion."""
    @property
    def acceleration_feed_forward(self) -> int:
        """Gain on the setpoint's own counts per velocity and acceleration window while a profile moves it."""
    @property
    def velocity_window_samples(self) -> int:
        """Samples over which the velocity is a difference of counts, samples."""
    @property
    def acceleration_window_samples(self) -> int:
        """Samples over which the acceleration is a difference of velocities, samples."""
    @property
    def velocity_dead_band(self) -> int:
        """Velocities below it, in counts per velocity window, count as standstill; 0: off."""
    @property
    def scale(self) -> int:
        """The law's sum is divided by it: 256 for the DAC, 65536 for the stepper."""
    @property
    def dead_band_counts(self) -> int:
        """Errors below it ask for nothing; 0: off. For the on-off law the dead zone of its relay, counts."""
    @property
    def relay_hysteresis_counts(self) -> int:
        """The relay of the on-off law drops out this much below dead_band_counts, at which it picks up, counts."""
    @property
    def null_offset_counts(self) -> int:
        """Command at which the valve is at its null; added to the demand, counts."""
    @property
    def forced_exit_s(self) -> float:
        """Time for each of test.targets, s."""
    @property
    def exit_on_dead_band(self) -> bool:
        """Whether a target also ends when it has arrived: tolerance_counts, monitoring_s, dwell_s; with test.targets."""
    @property
    def adapt(self) -> str:
        """What the law begins with at each arming: what the rig file says, or what the runs before have learned of load and valve."""
    @property
    def tolerance_counts(self) -> int:
        """A move has arrived inside this error; without it that of dead_band_counts, if there is one, counts."""
    @property
    def monitoring_s(self) -> float:
        """Exact stop: time inside the tolerance after which a move has arrived. 0: fast stop, at the first sample inside, s."""
    @property
    def dwell_s(self) -> float:
        """From the arrival at a target to the next one, s."""
    @property
    def homing(self) -> str:
        """Where a homing run ends: against a stop, or at the edge of a switch."""
    @property
    def homing_command_counts(self) -> int:
        """Valve command of the homing run, not 0; its sign is the direction. -200 for the DAC, -4 for the stepper, counts."""
    @property
    def homing_position_counts(self) -> int:
        """The position where the homing run ends, counts."""
    @property
    def homing_back_off_counts(self) -> int:
        """A homing run goes so far back from where it has found its stop or switch, and must find it again at the same place, counts."""
    @property
    def homing_still_s(self) -> float:
        """Standing still for so long is being at the stop, s."""
    @property
    def homing_timeout_s(self) -> float:
        """A longer homing run trips, s."""

class Encoder(Table):
    @property
    def model(self) -> str:
        """quadrature counts edges, and the axis must be homed. potentiometer, on a converter, and ssi, an encoder with a synchronous serial interface, are absolute: the axis is homed when the drive starts."""
    @property
    def mm_per_count(self) -> float:
        """Stroke per encoder count, mm/count."""
    @property
    def polarity(self) -> int:
        """-1: the encoder counts down when the rod extends (a matter of wiring; the twin always counts up)."""
    @property
    def bits(self) -> int | None:
        """Width of the potentiometer's converter, or of the encoder's word."""
    @property
    def zero_mm(self) -> float:
        """Position at which an absolute encoder reads 0: a little below 0, with a range a little longer than the stroke, keeps both ends of the stroke within the range, mm."""
    @property
    def range_mm(self) -> float | None:
        """Length that an absolute encoder measures; a potentiometer divides it into 2^bits - 1 counts, mm."""
    @property
    def linearity_percent(self) -> float:
        """Largest deviation from the straight line through both ends, part of the range; the controller does not know it, %."""
    @property
    def noise_counts(self) -> float:
        """Standard deviation of the reading's noise, counts."""
    @property
    def scale_error_percent(self) -> float:
        """How much longer a count really is than the file says; the controller does not know it, %."""
    @property
    def scale_tolerance_percent(self) -> float:
        """How far the true length of a count may be from the file's, for identify. 0.3 is an assumption: that of a belt or a measuring wheel. A glass scale or a magnetic tape has 0.01, a scale that was compared with a gauge what that comparison leaves; 0: exact, %."""
    @property
    def offset_error_mm(self) -> float:
        """What the encoder reads at the retracted end of the stroke; the controller does not know it, mm."""
    @property
    def offset_tolerance_mm(self) -> float:
        """How far that reading may be from the file's, for identify. 0.1 is an assumption: what a homing run against a stop repeats, and how well the end of the stroke is known; 0: exact, mm."""

class Sensors(Table):
    @property
    def pressure(self) -> bool:
        """Whether the pressures of both chambers are measured. Without, nothing trips by them, records have none, and the on-off law must not feed them back."""
    @property
    def pressure_min_pa(self) -> float:
        """Absolute pressure at raw 0, Pa."""
    @property
    def pressure_max_pa(self) -> float:
        """Absolute pressure at full scale, Pa."""
    @property
    def spool_min_mm(self) -> float:
        """Spool displacement at raw 0, mm."""
    @property
    def spool_max_mm(self) -> float:
        """Spool displacement at full scale, mm."""
    @property
    def bits(self) -> int:
        """Width of the converter."""
    @property
    def home_switch_mm(self) -> float | None:
        """The homing switch is closed below this position, mm."""
    @property
    def pressure_lag_s(self) -> float:
        """First-order lag of the pressure sensors; 0: none, s."""
    @property
    def channel_skew_s(self) -> float:
        """Delay between the channels of the converter: it reads pressure 1 with the encoder, pressure 2 this much later, and the spool this much after that; whole microseconds, less than half of controller.delay_s. 0: all at once. About 1e-4 on the thesis's test rig, s."""
    @property
    def noise_counts(self) -> float:
        """Standard deviation of the converter's noise, counts."""
    @property
    def pressure_1_gain_error_percent(self) -> float:
        """What the first sensor reads too much, part of the absolute pressure; the controller does not know it, %."""
    @property
    def pressure_1_offset_error_pa(self) -> float:
        """The same at every pressure, Pa."""
    @property
    def pressure_2_gain_error_percent(self) -> float:
        """What the second sensor reads too much, part of the absolute pressure; the controller does not know it, %."""
    @property
    def pressure_2_offset_error_pa(self) -> float:
        """The same at every pressure, Pa."""
    @property
    def pressure_gain_tolerance_percent(self) -> float:
        """How far the scale of a pressure reading may be from the file's, for identify: transmitter and converter together. 2 is an assumption: transmitters are sold with 0.25 to 1 % of their span, plus drift by temperature, and the reference of a converter has as much again; 0: exact, %."""
    @property
    def pressure_offset_tolerance_pa(self) -> float:
        """How far the zero of a pressure reading may be off, for identify. 5000 is an assumption: 0.5 % of a span of 1 MPa. A zero that was compared with a barometer has some 200; 0: exact, Pa."""
    @property
    def spool_gain_error_percent(self) -> float:
        """What the spool's sensor reads too much, part of the displacement; the controller does not know it, %."""
    @property
    def spool_offset_error_mm(self) -> float:
        """What the spool's sensor reads at mid-travel; the controller does not know it, mm."""
    @property
    def spool_gain_tolerance_percent(self) -> float:
        """How far the scale of the spool's sensor may be from the file's, for identify; 1 is an assumption; 0: exact, %."""
    @property
    def spool_offset_tolerance_mm(self) -> float:
        """How far the zero of the spool's sensor may be off, for identify; 0.01 is an assumption; 0: exact, mm."""

class Operator(Table):
    @property
    def model(self) -> str:
        """What moves the spool."""
    @property
    def max_command_counts(self) -> int:
        """Largest command of a converter to either side. A board arms only if its converter of 12 bits has a code for it: with null_code 2048 up to 2047, counts."""
    @property
    def force_gain_n_per_mm(self) -> float:
        """Force of the coil per mm of command, N/mm."""
    @property
    def spring_n_per_mm(self) -> float:
        """Stiffness of the spool's spring, N/mm."""
    @property
    def spring_preload_n(self) -> float:
        """Compression of the spring at mid-travel, which the mid-range of the coil balances, N."""
    @property
    def static_friction_n(self) -> float:
        """Stiction of the spool, N."""
    @property
    def coulomb_friction_n(self) -> float:
        """Coulomb friction of the spool, N."""
    @property
    def spool_mass_kg(self) -> float:
        """Mass of the spool with the core, kg."""
    @property
    def damping_n_s_per_m(self) -> float:
        """Viscous damping of the spool; not in the thesis, C(51) times C(86), N s/m."""
    @property
    def stop_stiffness_n_per_m(self) -> float:
        """Stiffness of the spool's stops, N/m."""
    @property
    def stop_region_m(self) -> float:
        """Penetration at which the stops' damping is full, m."""
    @property
    def stop_damping_ratio(self) -> float:
        """Damping ratio of the stops."""
    @property
    def hysteresis_percent(self) -> float:
        """Width of the hysteresis loop, of the spool's range from end to end (2 mm in servo-drive B), %."""
    @property
    def hysteresis_side(self) -> float:
        """Where the spool stands in its hysteresis as a test begins: 1 as after a command that fell, -1 as after one that rose, 0 in the middle."""
    @property
    def dither_hz(self) -> float:
        """Frequency of the amplifier's dither, Hz."""
    @property
    def dither_mm(self) -> float:
        """Amplitude of the dither, mm."""
    @property
    def dither_phase_deg(self) -> float:
        """Phase of the dither at t = 0, deg."""
    @property
    def dither_adjustable(self) -> bool:
        """Whether the user can set amplitude and frequency of the dither. Else no search changes them: a valve with an amplifier of its own has the dither that its maker gave it."""
    @property
    def amplifier_gain(self) -> float:
        """Gain of the amplifier on the command."""
    @property
    def saturation_mm(self) -> float:
        """Largest command that the amplifier passes on, mm."""
    @property
    def stiffness_per_mass_per_s2(self) -> float:
        """Squared natural frequency of the empirical operator, 1/s2."""
    @property
    def damping_per_s(self) -> float:
        """Damping of the empirical operator, 1/s."""
    @property
    def mm_per_step(self) -> float:
        """Spool travel of a step, mm/step."""
    @property
    def max_steps(self) -> int:
        """Furthest step from mid-travel."""
    @property
    def pulse_width_us(self) -> int:
        """Length of a stepper's pulse, kept by the board, us."""
    @property
    def direction_setup_us(self) -> int:
        """Time from a change of a stepper's direction to the pulse, kept by the board, us."""
    @property
    def switch_time_s(self) -> float:
        """Time in which an on-off valve opens, from closed to fully open, s."""
    @property
    def switch_off_time_s(self) -> float | None:
        """Time in which it closes again, s."""

class Valve(Table):
    @property
    def model(self) -> str:
        """How the flows through the valve are formed."""
    @property
    def spool_travel_mm(self) -> float:
        """Travel of the spool to either side; also what a command of 2048 asks for, mm."""
    @property
    def underlap_mm(self) -> float:
        """Lap of the lands: negative is underlap, positive overlap, mm."""
    @property
    def sleeve_diameter_mm(self) -> float:
        """Bore of the sleeve, mm."""
    @property
    def spool_diameter_mm(self) -> float:
        """Diameter of the spool's lands, mm."""
    @property
    def spool_rod_diameter_mm(self) -> float:
        """Diameter of the spool between its lands, mm."""
    @property
    def port_diameter_mm(self) -> float:
        """Bore of the ports, mm."""
    @property
    def discharge_supply(self) -> float:
        """Coefficient of discharge of the supply lands and the ports."""
    @property
    def discharge_exhaust(self) -> float:
        """Coefficient of discharge of the exhaust lands."""
    @property
    def discharge_reverse(self) -> float:
        """Multiplier of the coefficient of discharge for reverse flow."""
    @property
    def upstream_mach(self) -> bool:
        """Whether the speed counts at which a tube brings air to the ports of flow nodes; false sets every upstream Mach number to zero."""
    @property
    def turbulence(self) -> float:
        """Every upstream Mach number is multiplied by it; 0 is upstream_mach = false."""
    @property
    def null_offset_mm(self) -> float:
        """Spool position at which the valve is at its null, mm."""
    @property
    def null_drift_mm_per_h(self) -> float:
        """How fast the valve's null moves, from null_offset_mm at the start of the test, mm/h."""
    @property
    def flow_force(self) -> str:
        """Force of the flow on the spool."""
    @property
    def flow_force_inlet(self) -> list[float] | None:
        """C_Fin: coefficients of the powers 0 to 11 of the opening, for the experimental flow force of air that goes in."""
    @property
    def flow_force_outlet(self) -> list[float] | None:
        """C_Fout: the same for air that comes out."""
    @property
    def land_length_m(self) -> float:
        """Length of the lands: it weighs the rates of change of the mass flows, which the flow forces leave out, m."""
    @property
    def discharge_model(self) -> str:
        """How the coefficient of discharge depends on the pressure ratio."""
    @property
    def connector_diameter_mm(self) -> float | None:
        """Bore of the connectors: the restrictions at the cylinder, mm."""
    @property
    def sonic_conductance_m3_per_s_pa(self) -> float | None:
        """Sonic conductance of the path from the supply to a port, fully open, m3/(s Pa)."""
    @property
    def critical_ratio(self) -> float | None:
        """Critical pressure ratio of that path."""
    @property
    def exhaust_sonic_conductance_m3_per_s_pa(self) -> float | None:
        """Sonic conductance of the path from a port to the exhaust, fully open, m3/(s Pa)."""
    @property
    def exhaust_critical_ratio(self) -> float | None:
        """Critical pressure ratio of that path."""
    @property
    def subsonic_index(self) -> float:
        """Exponent of the flow above the critical ratio, of all paths; 0.5 is the ellipse."""
    @property
    def flow_map(self) -> list[list[float]] | None:
        """Measured flows of the path to port 1 at 20 C: each place of the spool, in percent of its travel, with each ratio of absolute pressures."""
    @property
    def flow_map_shift(self) -> float:
        """By how many of its standard deviations each flow of the map is taken higher."""
    @property
    def seat_conductance_m3_per_s_pa(self) -> float | None:
        """Sonic conductance C of the seat between the supply and a port, fully open, m3/(s Pa)."""
    @property
    def seat_critical_ratio(self) -> float | None:
        """Critical pressure ratio b of that seat."""
    @property
    def exhaust_seat_conductance_m3_per_s_pa(self) -> float | None:
        """Sonic conductance C of the seat between a port and the exhaust, fully open, m3/(s Pa)."""
    @property
    def exhaust_seat_critical_ratio(self) -> float | None:
        """Critical pressure ratio b of that seat."""
    @property
    def characteristic(self) -> str:
        """How the conductance of a path follows the spool: as the area of a land, in proportion to the opening, or by a table; a valve by its areas has lands."""
    @property
    def leakage_percent(self) -> float:
        """Conductance of a shut path, of that of the open one, %."""
    @property
    def characteristic_table(self) -> list[list[float]] | None:
        """Conductance of path 1 over the spool, both in percent of their largest; -100 to 100 % of the spool, or as far as anything changes."""

class Tubing(Table):
    @property
    def model(self) -> str:
        """Pressure drop between supply, valve and cylinder."""
    @property
    def drop_slope(self) -> float:
        """Part of the pressure that is lost at the reference flow."""
    @property
    def reference_flow_kg_s(self) -> float:
        """Flow at which drop_slope holds, kg/s."""
    @property
    def diameter_mm(self) -> float:
        """Bore of the tubes; with the multiple flow node that of the restriction at the cylinder, mm."""
    @property
    def length_m(self) -> float:
        """Length of each tube, m."""
    @property
    def friction_factor(self) -> float:
        """Fanning friction factor."""
    @property
    def flow_control(self) -> str:
        """One-way flow controls at the ports of the cylinder: the way that they throttle; the other is free."""
    @property
    def flow_control_1_conductance_m3_per_s_pa(self) -> float:
        """Sonic conductance of the throttle of chamber 1 (ISO 6358); a round number, as the needle may stand anywhere, m3/(s Pa)."""
    @property
    def flow_control_2_conductance_m3_per_s_pa(self) -> float:
        """The same of chamber 2, m3/(s Pa)."""
    @property
    def flow_control_critical_ratio(self) -> float:
        """Critical pressure ratio of both throttles (ISO 6358)."""
    @property
    def lag_s(self) -> float:
        """First-order lag of the pressure ratio, behind an ideal supply; 0: solved together with the valve, s."""

class Actuator(Table):
    @property
    def model(self) -> str:
        """Kind of cylinder; a symmetric one is rodless, or has a rod on both sides."""
    @property
    def stroke_m(self) -> float:
        """Length of the stroke, m."""
    @property
    def bore_m(self) -> float:
        """Bore of the cylinder, m."""
    @property
    def rod_diameter_m(self) -> float:
        """Diameter of the rod: on one side (asymmetric) or on both (symmetric), m."""
    @property
    def residual_volume_1_m3(self) -> float:
        """Dead volume of chamber 1 with its tube, m3."""
    @property
    def residual_volume_2_m3(self) -> float:
        """Dead volume of chamber 2 with its tube, m3."""
    @property
    def leakage(self) -> str:
        """Leakage past the piston."""
    @property
    def leakage_coefficient(self) -> float:
        """Laminar leakage, kg/(s Pa)."""
    @property
    def passage_resistance(self) -> float:
        """Egli's resistance of the leakage passage."""
    @property
    def passage_clearance_m(self) -> float:
        """Clearance of the leakage passage; the thesis's table has 1e-4, a slip, m."""
    @property
    def heat_transfer_w_per_m2_k(self) -> float:
        """Heat transfer of the chambers' walls; 0: adiabatic, as in the thesis, W/(m2 K)."""
    @property
    def wall_temperature_k(self) -> float:
        """Temperature of the chambers' walls, K."""
    @property
    def vented(self) -> str:
        """The chamber that is open to the surroundings, in a single-acting cylinder; the valve's port of it is plugged."""
    @property
    def return_spring(self) -> str:
        """The end to which a spring in the cylinder pushes the piston."""
    @property
    def return_spring_preload_n(self) -> float:
        """Force of the return spring at the end that it pushes to; a round number, not of a real cylinder, N."""
    @property
    def return_spring_stiffness_n_per_m(self) -> float:
        """Stiffness of the return spring; a round number, not of a real cylinder, N/m."""
    @property
    def cushion(self) -> str:
        """End cushions: a spear shuts the bore to the port near the end of the stroke, so that the air there leaves by a throttle."""
    @property
    def cushion_1_length_m(self) -> float:
        """Length of the cushion at the retracted end, 0 for none; the default is that of a rodless cylinder of 32 mm bore, m."""
    @property
    def cushion_2_length_m(self) -> float:
        """The same at the extended end, m."""
    @property
    def cushion_1_conductance_m3_per_s_pa(self) -> float:
        """Sonic conductance of the throttle at the retracted end (ISO 6358), 0 where it is shut; a round number, as the needle may stand anywhere, m3/(s Pa)."""
    @property
    def cushion_2_conductance_m3_per_s_pa(self) -> float:
        """The same at the extended end, m3/(s Pa)."""
    @property
    def cushion_check_conductance_m3_per_s_pa(self) -> float:
        """Sonic conductance of the check valves, through which air comes back into a chamber whose spear is in; a round number, as sheets have none, m3/(s Pa)."""
    @property
    def cushion_critical_ratio(self) -> float:
        """Critical pressure ratio of throttles and check valves (ISO 6358)."""
    @property
    def cushion_spear_diameter_m(self) -> float:
        """Outer diameter of the spears, also of one that is a sleeve on the rod; 0 leaves their area out, m."""
    @property
    def cushion_dead_volume_percent(self) -> float:
        """Part of the dead volume that is behind the spear; the rest is that of its bore, port and tube, %."""

class Load(Table):
    @property
    def model(self) -> str:
        """Kind of load."""
    @property
    def mass_kg(self) -> float:
        """Moving mass, kg."""
    @property
    def viscous_n_s_per_m(self) -> float:
        """Viscous friction, N s/m."""
    @property
    def constant_force_n(self) -> float:
        """Constant force in the direction of extension, N."""
    @property
    def spring_n_per_m(self) -> float:
        """Spring to the retracted end, N/m."""
    @property
    def incline_deg(self) -> float:
        """Angle at which extension goes uphill, deg."""
    @property
    def friction(self) -> str:
        """Model of the friction."""
    @property
    def static_extend_n(self) -> float:
        """Stiction, extending, N."""
    @property
    def coulomb_extend_n(self) -> float:
        """Coulomb friction, extending, N."""
    @property
    def static_retract_n(self) -> float:
        """Stiction, retracting, N."""
    @property
    def coulomb_retract_n(self) -> float:
        """Coulomb friction, retracting, N."""
    @property
    def velocity_threshold_m_s(self) -> float:
        """Velocity below which the thesis's model sticks; here sticking is an event at exactly zero, m/s."""
    @property
    def bristle_stiffness_n_per_m(self) -> float:
        """Stiffness of the bristles, s_0: that of a load before it slides, N/m."""
    @property
    def bristle_damping_n_s_per_m(self) -> float:
        """Damping of the bristles, s_1, N s/m."""
    @property
    def stribeck_velocity_m_s(self) -> float:
        """Velocity at which friction has dropped towards Coulomb friction, v_s, m/s."""
    @property
    def stribeck_exponent(self) -> float:
        """How sharply it drops there, n."""
    @property
    def film_velocity_m_s(self) -> float:
        """Velocity from which on the film is as thick as it gets, v_b, m/s."""
    @property
    def film_growth_s(self) -> float:
        """Time constant of a film that grows, t_g, s."""
    @property
    def film_decay_s(self) -> float:
        """Time constant of a film that gets thinner, t_d, s."""
    @property
    def fluid_lag_s(self) -> float:
        """T: viscous friction is that of the velocity and T times the acceleration, s."""
    @property
    def stop_stiffness_n_per_m(self) -> float:
        """Stiffness of the end stops, N/m."""
    @property
    def stop_region_m(self) -> float:
        """Penetration at which the stops' damping is full, m."""
    @property
    def stop_damping_ratio(self) -> float:
        """Damping ratio of the end stops."""

class Faults(Table):
    @property
    def event(self) -> list[dict[str, Any]] | None:
        """Faults and their times, one table [[faults.event]] each."""
    @property
    def gain_bug(self) -> str:
        """The bug of the thesis's gain routine, which "could only give positive gains" (8.2.5), in one of three readings: no negative gain, the error counts as positive, negative errors have the last gain of the profile; in the simulator only."""

class Safety(Table):
    @property
    def position_margin_mm(self) -> float:
        """How far outside the stroke the position may be before the supervisor trips, mm."""
    @property
    def max_speed_m_s(self) -> float:
        """A faster step of the encoder trips the supervisor, m/s."""
    @property
    def sensor_watch(self) -> bool:
        """Whether a pressure within a 64th of the range of an end of its converter trips, if no pressure of the drive can be there."""
    @property
    def end_min_mm(self) -> float | None:
        """Lower soft limit: a closed loop refuses lower setpoints, an open loop pushes no further, mm."""
    @property
    def end_max_mm(self) -> float | None:
        """The upper soft limit, mm."""
    @property
    def host_silence_s(self) -> float:
        """Silence of the host that trips a running move or homing run; 0: off, s."""
    @property
    def hold_s(self) -> float:
        """Time after the loss of its host at which an enabled drive that is armed or holds its last setpoint is disarmed, s."""
    @property
    def input_debounce_s(self) -> float:
        """Digital inputs count once all of them have been the same for so long, s."""
    @property
    def input_settling_s(self) -> float:
        """A start begins its record once start and number have stayed for so long behind it, s."""
    @property
    def no_motion_s(self) -> float:
        """A closed loop that opens half of the valve or more and moves nothing for so long trips; with less of the valve it takes longer; 0: off, s."""
    @property
    def model_bound_s(self) -> float:
        """Mass, standing force or lag of the valve at the bound of what the law can learn for so long, in motion, trips: the drive is not what its rig file says. By default 2.7 times the longest of sound drives; 0: off, s."""
    @property
    def pressure_doubt_s(self) -> float:
        """Pressures that contradict the flow of the valve for so long trip, as do one that jumps and one that stands still while the other does not; 0: none of the three does, s."""
    @property
    def late_output_us(self) -> int:
        """An output that is later than this is not driven and trips the supervisor; less than the time from it to the next sample, by default at most half of it, us."""
    @property
    def late_sample_us(self) -> int:
        """A sample later than this trips the supervisor; less than the period, by default at most half of it, us."""

class Test(Table):
    @property
    def moves(self) -> list[tuple[float, int]]:
        """[time in s, counts], in order of time: setpoints, or commands in open loop."""
    @property
    def targets(self) -> list[int] | None:
        """Setpoints in counts, each for controller.forced_exit_s: the thesis's way, instead of moves."""
    @property
    def move(self) -> list[dict[str, Any]] | None:
        """Moves with a profile, in mm and s, one table [[test.move]] each, in order of time; instead of moves."""
    @property
    def moves_mm(self) -> list[list[float]] | None:
        """[time in s, mm], in order of time: setpoints in closed loop, to the nearest count, whatever the encoder's resolution; instead of moves, mm."""
    @property
    def targets_mm(self) -> list[float] | None:
        """The same as targets, in mm and in closed loop, mm."""
    @property
    def profile(self) -> str:
        """How the setpoint goes to each of moves and targets: at once, or within the limits below."""
    @property
    def velocity_mm_s(self) -> float:
        """Limit of the setpoint's velocity in a profile; in open loop counts/s, mm/s."""
    @property
    def acceleration_mm_s2(self) -> float:
        """Limit of the setpoint's acceleration in a profile; in open loop counts/s^2, mm/s2."""
    @property
    def jerk_mm_s3(self) -> float:
        """Limit of the setpoint's jerk in an S-curve; in open loop counts/s^3, mm/s3."""
    @property
    def duration_s(self) -> float:
        """Length of the test, s."""
    @property
    def repeat_every_s(self) -> float | None:
        """Period at which the moves repeat, rounded up to whole samples, until the end of the test, s."""
    @property
    def impulse(self) -> list[float] | None:
        """[time in s, duration in s, counts]: raises the setpoint, or the command in open loop, by the counts for the duration."""
    @property
    def tolerance_mm(self) -> float:
        """A move has settled within this distance of its setpoint: for the figures of moves, tune and sweep. The controller does not know it, mm."""
    @property
    def trace_period_s(self) -> float | None:
        """Period of the rows of trace.csv; whole microseconds, s."""
    @property
    def decimation(self) -> int:
        """The recorder stores every Nth sample."""
    @property
    def pre_trigger(self) -> int:
        """Stored samples from before the start."""
    @property
    def position_m(self) -> float:
        """Position at the start; 8192.5 counts, for a start on the edge of a count is ill-defined, m."""
    @property
    def pressure_1_pa(self) -> float | None:
        """Chamber 1 at the start, absolute, Pa."""
    @property
    def pressure_2_pa(self) -> float:
        """Chamber 2 at the start, absolute, Pa."""
    @property
    def temperature_1_k(self) -> float:
        """Chamber 1 at the start, K."""
    @property
    def temperature_2_k(self) -> float:
        """Chamber 2 at the start, K."""
    @property
    def receiver_pressure_pa(self) -> float | None:
        """Receiver of the supply, or volume behind its regulator, at the start, absolute, Pa."""

@type_check_only
class RigKeys(TypedDict, total=False):
    """Keys of a rig file, as keywords."""

    name: str
    gas__heat_capacity_ratio: float
    gas__gas_constant_j_per_kg_k: float
    supply__model: str
    supply__pressure_pa: float
    supply__temperature_k: float
    supply__receiver_volume_m3: float
    supply__feed_conductance_m3_per_s_pa: float
    supply__feed_critical_ratio: float
    supply__check_valve: bool
    supply__receiver_heat_transfer_w_per_m2_k: float
    supply__primary_pressure_pa: float
    supply__droop_pa: float
    supply__relief_conductance_m3_per_s_pa: float
    exhaust__pressure_pa: float
    exhaust__temperature_k: float
    controller__model: str
    controller__clock_error_percent: float
    controller__clock_tolerance_percent: float
    controller__start_s: float
    controller__gain_profile: Sequence[int] | NDArray[Any]
    controller__learn_null_offset: bool
    controller__learning_gain: int
    controller__cascade_dead_time_factor: float
    controller__cascade_flow_share: float
    controller__cascade_observer_factor: float
    controller__pressure_feedback_gain: float
    controller__law: str
    controller__loop: str
    controller__period_s: float
    controller__delay_s: float
    controller__profile_span_counts: int
    controller__proportional_gain: int
    controller__integral_gain: int
    controller__integral_band_counts: int
    controller__dead_zone_counts: int
    controller__velocity_gain: int
    controller__acceleration_gain: int
    controller__velocity_feed_forward: int
    controller__acceleration_feed_forward: int
    controller__velocity_window_samples: int
    controller__acceleration_window_samples: int
    controller__velocity_dead_band: int
    controller__scale: int
    controller__dead_band_counts: int
    controller__relay_hysteresis_counts: int
    controller__null_offset_counts: int
    controller__forced_exit_s: float
    controller__exit_on_dead_band: bool
    controller__adapt: str
    controller__tolerance_counts: int
    controller__monitoring_s: float
    controller__dwell_s: float
    controller__homing: str
    controller__homing_command_counts: int
    controller__homing_position_counts: int
    controller__homing_back_off_counts: int
    controller__homing_still_s: float
    controller__homing_timeout_s: float
    encoder__model: str
    encoder__mm_per_count: float
    encoder__polarity: int
    encoder__bits: int
    encoder__zero_mm: float
    encoder__range_mm: float
    encoder__linearity_percent: float
    encoder__noise_counts: float
    encoder__scale_error_percent: float
    encoder__scale_tolerance_percent: float
    encoder__offset_error_mm: float
    encoder__offset_tolerance_mm: float
    sensors__pressure: bool
    sensors__pressure_min_pa: float
    sensors__pressure_max_pa: float
    sensors__spool_min_mm: float
    sensors__spool_max_mm: float
    sensors__bits: int
    sensors__home_switch_mm: float
    sensors__pressure_lag_s: float
    sensors__channel_skew_s: float
    sensors__noise_counts: float
    sensors__pressure_1_gain_error_percent: float
    sensors__pressure_1_offset_error_pa: float
    sensors__pressure_2_gain_error_percent: float
    sensors__pressure_2_offset_error_pa: float
    sensors__pressure_gain_tolerance_percent: float
    sensors__pressure_offset_tolerance_pa: float
    sensors__spool_gain_error_percent: float
    sensors__spool_offset_error_mm: float
    sensors__spool_gain_tolerance_percent: float
    sensors__spool_offset_tolerance_mm: float
    operator__model: str
    operator__max_command_counts: int
    operator__force_gain_n_per_mm: float
    operator__spring_n_per_mm: float
    operator__spring_preload_n: float
    operator__static_friction_n: float
    operator__coulomb_friction_n: float
    operator__spool_mass_kg: float
    operator__damping_n_s_per_m: float
    operator__stop_stiffness_n_per_m: float
    operator__stop_region_m: float
    operator__stop_damping_ratio: float
    operator__hysteresis_percent: float
    operator__hysteresis_side: float
    operator__dither_hz: float
    operator__dither_mm: float
    operator__dither_phase_deg: float
    operator__dither_adjustable: bool
    operator__amplifier_gain: float
    operator__saturation_mm: float
    operator__stiffness_per_mass_per_s2: float
    operator__damping_per_s: float
    operator__mm_per_step: float
    operator__max_steps: int
    operator__pulse_width_us: int
    operator__direction_setup_us: int
    operator__switch_time_s: float
    operator__switch_off_time_s: float
    valve__model: str
    valve__spool_travel_mm: float
    valve__underlap_mm: float
    valve__sleeve_diameter_mm: float
    valve__spool_diameter_mm: float
    valve__spool_rod_diameter_mm: float
    valve__port_diameter_mm: float
    valve__discharge_supply: float
    valve__discharge_exhaust: float
    valve__discharge_reverse: float
    valve__upstream_mach: bool
    valve__turbulence: float
    valve__null_offset_mm: float
    valve__null_drift_mm_per_h: float
    valve__flow_force: str
    valve__flow_force_inlet: Sequence[float] | NDArray[Any]
    valve__flow_force_outlet: Sequence[float] | NDArray[Any]
    valve__land_length_m: float
    valve__discharge_model: str
    valve__connector_diameter_mm: float
    valve__sonic_conductance_m3_per_s_pa: float
    valve__critical_ratio: float
    valve__exhaust_sonic_conductance_m3_per_s_pa: float
    valve__exhaust_critical_ratio: float
    valve__subsonic_index: float
    valve__flow_map: Sequence[Sequence[float]] | NDArray[Any]
    valve__flow_map_shift: float
    valve__seat_conductance_m3_per_s_pa: float
    valve__seat_critical_ratio: float
    valve__exhaust_seat_conductance_m3_per_s_pa: float
    valve__exhaust_seat_critical_ratio: float
    valve__characteristic: str
    valve__leakage_percent: float
    valve__characteristic_table: Sequence[Sequence[float]] | NDArray[Any]
    tubing__model: str
    tubing__drop_slope: float
    tubing__reference_flow_kg_s: float
    tubing__diameter_mm: float
    tubing__length_m: float
    tubing__friction_factor: float
    tubing__flow_control: str
    tubing__flow_control_1_conductance_m3_per_s_pa: float
    tubing__flow_control_2_conductance_m3_per_s_pa: float
    tubing__flow_control_critical_ratio: float
    tubing__lag_s: float
    actuator__model: str
    actuator__stroke_m: float
    actuator__bore_m: float
    actuator__rod_diameter_m: float
    actuator__residual_volume_1_m3: float
    actuator__residual_volume_2_m3: float
    actuator__leakage: str
    actuator__leakage_coefficient: float
    actuator__passage_resistance: float
    actuator__passage_clearance_m: float
    actuator__heat_transfer_w_per_m2_k: float
    actuator__wall_temperature_k: float
    actuator__vented: str
    actuator__return_spring: str
    actuator__return_spring_preload_n: float
    actuator__return_spring_stiffness_n_per_m: float
    actuator__cushion: str
    actuator__cushion_1_length_m: float
    actuator__cushion_2_length_m: float
    actuator__cushion_1_conductance_m3_per_s_pa: float
    actuator__cushion_2_conductance_m3_per_s_pa: float
    actuator__cushion_check_conductance_m3_per_s_pa: float
    actuator__cushion_critical_ratio: float
    actuator__cushion_spear_diameter_m: float
    actuator__cushion_dead_volume_percent: float
    load__model: str
    load__mass_kg: float
    load__viscous_n_s_per_m: float
    load__constant_force_n: float
    load__spring_n_per_m: float
    load__incline_deg: float
    load__friction: str
    load__static_extend_n: float
    load__coulomb_extend_n: float
    load__static_retract_n: float
    load__coulomb_retract_n: float
    load__velocity_threshold_m_s: float
    load__bristle_stiffness_n_per_m: float
    load__bristle_damping_n_s_per_m: float
    load__stribeck_velocity_m_s: float
    load__stribeck_exponent: float
    load__film_velocity_m_s: float
    load__film_growth_s: float
    load__film_decay_s: float
    load__fluid_lag_s: float
    load__stop_stiffness_n_per_m: float
    load__stop_region_m: float
    load__stop_damping_ratio: float
    faults__event: Sequence[Mapping[str, Any]]
    faults__gain_bug: str
    safety__position_margin_mm: float
    safety__max_speed_m_s: float
    safety__sensor_watch: bool
    safety__end_min_mm: float
    safety__end_max_mm: float
    safety__host_silence_s: float
    safety__hold_s: float
    safety__input_debounce_s: float
    safety__input_settling_s: float
    safety__no_motion_s: float
    safety__model_bound_s: float
    safety__pressure_doubt_s: float
    safety__late_output_us: int
    safety__late_sample_us: int
    test__moves: Sequence[Sequence[float]] | NDArray[Any]
    test__targets: Sequence[int] | NDArray[Any]
    test__move: Sequence[Mapping[str, Any]]
    test__moves_mm: Sequence[Sequence[float]] | NDArray[Any]
    test__targets_mm: Sequence[float] | NDArray[Any]
    test__profile: str
    test__velocity_mm_s: float
    test__acceleration_mm_s2: float
    test__jerk_mm_s3: float
    test__duration_s: float
    test__repeat_every_s: float
    test__impulse: Sequence[float] | NDArray[Any]
    test__tolerance_mm: float
    test__trace_period_s: float
    test__decimation: int
    test__pre_trigger: int
    test__position_m: float
    test__pressure_1_pa: float
    test__pressure_2_pa: float
    test__temperature_1_k: float
    test__temperature_2_k: float
    test__receiver_pressure_pa: float
    supply__pressure: str
    supply__temperature: str
    supply__receiver_volume: str
    supply__primary_pressure: str
    supply__droop: str
    exhaust__pressure: str
    exhaust__temperature: str
    controller__start: str
    controller__period: str
    controller__delay: str
    controller__forced_exit: str
    controller__monitoring: str
    controller__dwell: str
    controller__homing_still: str
    controller__homing_timeout: str
    encoder__zero: str
    encoder__range: str
    encoder__noise: str
    encoder__offset_error: str
    encoder__offset_tolerance: str
    sensors__pressure_min: str
    sensors__pressure_max: str
    sensors__spool_min: str
    sensors__spool_max: str
    sensors__home_switch: str
    sensors__pressure_lag: str
    sensors__channel_skew: str
    sensors__noise: str
    sensors__pressure_1_offset_error: str
    sensors__pressure_2_offset_error: str
    sensors__pressure_offset_tolerance: str
    sensors__spool_offset_error: str
    sensors__spool_offset_tolerance: str
    operator__force_gain: str
    operator__spring: str
    operator__spring_preload: str
    operator__static_friction: str
    operator__coulomb_friction: str
    operator__spool_mass: str
    operator__damping: str
    operator__stop_stiffness: str
    operator__stop_region: str
    operator__dither: str
    operator__dither_phase: str
    operator__saturation: str
    operator__switch_time: str
    operator__switch_off_time: str
    valve__spool_travel: str
    valve__underlap: str
    valve__sleeve_diameter: str
    valve__spool_diameter: str
    valve__spool_rod_diameter: str
    valve__port_diameter: str
    valve__null_offset: str
    valve__null_drift: str
    valve__land_length: str
    valve__connector_diameter: str
    tubing__diameter: str
    tubing__length: str
    tubing__lag: str
    actuator__stroke: str
    actuator__bore: str
    actuator__rod_diameter: str
    actuator__residual_volume_1: str
    actuator__residual_volume_2: str
    actuator__passage_clearance: str
    actuator__wall_temperature: str
    actuator__return_spring_preload: str
    actuator__return_spring_stiffness: str
    actuator__cushion_1_length: str
    actuator__cushion_2_length: str
    actuator__cushion_spear_diameter: str
    load__mass: str
    load__viscous: str
    load__constant_force: str
    load__spring: str
    load__incline: str
    load__static_extend: str
    load__coulomb_extend: str
    load__static_retract: str
    load__coulomb_retract: str
    load__bristle_stiffness: str
    load__bristle_damping: str
    load__film_growth: str
    load__film_decay: str
    load__fluid_lag: str
    load__stop_stiffness: str
    load__stop_region: str
    safety__position_margin: str
    safety__end_min: str
    safety__end_max: str
    safety__host_silence: str
    safety__hold: str
    safety__input_debounce: str
    safety__input_settling: str
    safety__no_motion: str
    safety__model_bound: str
    safety__pressure_doubt: str
    test__duration: str
    test__repeat_every: str
    test__tolerance: str
    test__trace_period: str
    test__position: str
    test__pressure_1: str
    test__pressure_2: str
    test__temperature_1: str
    test__temperature_2: str
    test__receiver_pressure: str

@type_check_only
class Answers(TypedDict, total=False):
    """Figures of data sheets."""

    cylinder: str | float
    bore: str | float
    rod: str | float
    stroke: str | float
    mass: str | float
    incline: str | float
    force: str | float
    friction: str | float
    breakaway: str | float
    valve: str | float
    flow_map: str | float
    conductance: str | float
    critical_ratio: str | float
    flow: str | float
    kv: str | float
    cv: str | float
    bandwidth: str | float
    hysteresis: str | float
    overlap: str | float
    tube: str | float
    tube_bore: str | float
    tube_length: str | float
    supply: str | float
    encoder: str | float
    resolution: str | float
    pressure_sensors: str | float
    tolerance_mm: str | float
    period: str | float
    law: str | float
