//! The transient of a run: rows of trace.csv, exactly as DESIGN section 3 has them.

use std::fmt::Write;

use pneudrive_controller::Observation;

use crate::plant::Snapshot;

/// The columns of trace.csv.
pub const COLUMNS: [&str; 18] = [
    "time_s",
    "setpoint_counts",
    "position_counts",
    "error_counts",
    "command_counts",
    "position_m",
    "velocity_m_s",
    "acceleration_m_s2",
    "pressure_1_pa",
    "pressure_2_pa",
    "temperature_1_k",
    "temperature_2_k",
    "spool_mm",
    "spool_command_mm",
    "mass_flow_1_kg_s",
    "mass_flow_2_kg_s",
    "actuator_force_n",
    "friction_n",
];

/// One row: what the controller saw and decided last, and the plant at the row's time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// s.
    pub time: f64,
    /// Of the last sample.
    pub observation: Observation,
    /// At the row's time.
    pub plant: Snapshot,
}

impl Row {
    /// The numbers of the row, in the order of [`COLUMNS`].
    #[must_use]
    pub fn values(&self) -> [f64; COLUMNS.len()] {
        let (seen, plant) = (&self.observation, &self.plant);
        [
            self.time,
            f64::from(seen.setpoint),
            f64::from(seen.position),
            f64::from(seen.error),
            f64::from(seen.command),
            plant.position,
            plant.velocity,
            plant.acceleration,
            plant.pressures[0],
            plant.pressures[1],
            plant.temperatures[0],
            plant.temperatures[1],
            plant.spool * 1e3,
            plant.spool_command * 1e3,
            plant.mass_flows[0],
            plant.mass_flows[1],
            plant.actuator_force,
            plant.friction,
        ]
    }
}

/// trace.csv: header, then a line a row.
#[must_use]
pub fn to_csv(rows: &[Row]) -> String {
    let mut text = COLUMNS.join(",");
    text.push('\n');
    for row in rows {
        for (column, value) in row.values().into_iter().enumerate() {
            let comma = if column == 0 { "" } else { "," };
            write!(text, "{comma}{}", number(value)).expect("writing to a string");
        }
        text.push('\n');
    }
    text
}

/// Twelve significant digits, without zeros that say nothing: a tenth of a nanometre in a metre is
/// kept, and rounding of the last bits is not shown.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-4 => format!("{rounded:e}"),
        _ => rounded.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact_to_twelve_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (325_324.999_999_999_1, "325325"),
            (0.098_719_625, "0.098719625"),
            (5.628_959_333_572_113e-5, "5.62895933357e-5"),
            (-2048.0, "-2048"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
