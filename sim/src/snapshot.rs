//! What can be measured of a plant at one instant. Traces, FMUs, Python and linear models name it alike.

/// The measurable quantities at one instant, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Position, m.
    pub position: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Acceleration, m/s^2.
    pub acceleration: f64,
    /// Absolute chamber pressures, Pa.
    pub pressures: [f64; 2],
    /// Chamber temperatures, K.
    pub temperatures: [f64; 2],
    /// Spool position, m.
    pub spool: f64,
    /// Spool position demanded by the command in force, m.
    pub spool_command: f64,
    /// Mass flows into the chambers through their ports, kg/s: the slopes of the masses of the air inside, less the
    /// leakage.
    pub mass_flows: [f64; 2],
    /// Force of the cylinder, N.
    pub actuator_force: f64,
    /// Dry friction, N, positive against extension.
    pub friction: f64,
}

/// A quantity of a snapshot.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// Its name, with its unit at the end.
    pub name: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    /// Its value.
    pub of: fn(&Snapshot) -> f64,
}

const fn quantity(name: &'static str, meaning: &'static str, of: fn(&Snapshot) -> f64) -> Quantity {
    Quantity { name, meaning, of }
}

/// All of them.
#[rustfmt::skip]
pub const QUANTITIES: [Quantity; 13] = [
    quantity("position_m", "Position of the load from the retracted end.", |seen| seen.position),
    quantity("velocity_m_s", "Velocity of the load.", |seen| seen.velocity),
    quantity("acceleration_m_s2", "Acceleration of the load.", |seen| seen.acceleration),
    quantity("pressure_1_pa", "Absolute pressure in chamber 1, the blind side.", |seen| seen.pressures[0]),
    quantity("pressure_2_pa", "Absolute pressure in chamber 2, the rod side.", |seen| seen.pressures[1]),
    quantity("temperature_1_k", "Temperature in chamber 1.", |seen| seen.temperatures[0]),
    quantity("temperature_2_k", "Temperature in chamber 2.", |seen| seen.temperatures[1]),
    quantity("spool_mm", "Spool displacement.", |seen| 1e3 * seen.spool),
    quantity("spool_command_mm", "Spool displacement that the command in force asks for.", |seen| 1e3 * seen.spool_command),
    quantity("mass_flow_1_kg_s", "Mass flow into chamber 1.", |seen| seen.mass_flows[0]),
    quantity("mass_flow_2_kg_s", "Mass flow into chamber 2.", |seen| seen.mass_flows[1]),
    quantity("actuator_force_n", "Force of the cylinder.", |seen| seen.actuator_force),
    quantity("friction_n", "Dry friction, positive against extension.", |seen| seen.friction),
];
