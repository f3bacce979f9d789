//! The transient of a run: rows of trace.csv, exactly as in DESIGN section 3.

use std::fmt::Write;

use pneudrive_controller::Observation;

use crate::assembly::ValveState;
use crate::component::supply::receiver::ReceiverState;
use crate::component::supply::{self, SupplyKind};
use crate::known::Known;
use crate::snapshot::{QUANTITIES, Snapshot};
use crate::values::Rig;

/// The columns of the controller.
const OF_CONTROLLER: [&str; 5] =
    ["time_s", "setpoint_counts", "position_counts", "error_counts", "command_counts"];

/// The columns of trace.csv: those of the controller, then the quantities of the plant.
pub const COLUMNS: [&str; OF_CONTROLLER.len() + QUANTITIES.len()] = {
    let mut columns = [""; OF_CONTROLLER.len() + QUANTITIES.len()];
    let mut place = 0;
    while place < columns.len() {
        columns[place] = match place.checked_sub(OF_CONTROLLER.len()) {
            None => OF_CONTROLLER[place],
            Some(quantity) => QUANTITIES[quantity].name,
        };
        place += 1;
    }
    columns
};

/// One row: the controller's last observation, and the plant at the row's time.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// s.
    pub time: f64,
    /// Of the last sample.
    pub observation: Observation,
    /// At the row's time.
    pub plant: Snapshot,
    /// The air inside the valve, where it was recorded.
    pub valve: Option<ValveState>,
    /// The air in the receiver, if there is one.
    pub receiver: Option<ReceiverState>,
    /// What the law knows, if it has a model of its drive.
    pub known: Option<Known>,
}

/// A row with only the motion of the load and the pressures: a third of the work of a [`Row`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRow {
    /// s.
    pub time: f64,
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
    /// Absolute chamber pressures, Pa.
    pub pressures: [f64; 2],
}

/// A column that may follow [`COLUMNS`] in a trace.
#[derive(Clone, Copy, Debug)]
pub struct Extra {
    /// Its name, with its unit at the end.
    pub name: &'static str,
    /// Its meaning.
    pub help: &'static str,
    of: Source,
}

/// Where the numbers of a column come from.
#[derive(Clone, Copy, Debug)]
enum Source {
    Valve(fn(&ValveState) -> f64),
    Receiver(fn(&ReceiverState) -> f64),
    Law(fn(&Known) -> f64),
}

impl Extra {
    /// Its number in a row; not a number where the valve was not recorded, without a receiver, and where the law knows nothing.
    #[must_use]
    pub fn value(&self, row: &Row) -> f64 {
        match self.of {
            Source::Valve(of) => row.valve.as_ref().map_or(f64::NAN, of),
            Source::Receiver(of) => row.receiver.as_ref().map_or(f64::NAN, of),
            Source::Law(of) => row.known.as_ref().map_or(f64::NAN, of),
        }
    }

    /// What the law knew at a sample; None of a column of the air.
    #[must_use]
    pub fn of_known(&self, known: &Known) -> Option<f64> {
        match self.of {
            Source::Law(of) => Some(of(known)),
            _ => None,
        }
    }

    /// Whether it is of the air inside the valve, which is recorded on request.
    #[must_use]
    pub fn is_of_valve(&self) -> bool {
        matches!(self.of, Source::Valve(_))
    }

    /// Whether it is of what the law knows.
    #[must_use]
    pub fn is_of_law(&self) -> bool {
        matches!(self.of, Source::Law(_))
    }

    /// The columns that a run of this rig has anyway: the air in its receiver, and what its law knows.
    #[must_use]
    pub fn of_rig(rig: &Rig) -> Vec<&'static Extra> {
        let has = |extra: &&Extra| match extra.of {
            Source::Valve(_) => false,
            Source::Receiver(_) => rig.get(&supply::keys::MODEL) != SupplyKind::Ideal,
            Source::Law(_) => rig.knows_its_drive(),
        };
        EXTRAS.iter().filter(has).collect()
    }

    /// Those of what its law knows.
    #[must_use]
    pub fn of_law(rig: &Rig) -> Vec<&'static Extra> {
        Extra::of_rig(rig).into_iter().filter(|extra| extra.is_of_law()).collect()
    }

    /// The column of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Extra> {
        EXTRAS.iter().find(|extra| extra.name == name)
    }
}

/// The columns of the air inside the valve and in the receiver, and of what the law knows.
pub static EXTRAS: [Extra; 27] = [
    extra("port_pressure_1_pa", "P_1v, at port 1 on the valve's side of its tube", |v| v.port_pressures[0]),
    extra("port_pressure_2_pa", "P_2v, at port 2", |v| v.port_pressures[1]),
    extra("node_pressure_1_pa", "P_n of the flow node of port 1 (6.47)", |v| v.node_pressures[0]),
    extra("node_pressure_2_pa", "P_n of the flow node of port 2", |v| v.node_pressures[1]),
    extra("node_temperature_1_k", "T_n of the flow node of port 1 (6.53)", |v| v.node_temperatures[0]),
    extra("node_temperature_2_k", "T_n of the flow node of port 2", |v| v.node_temperatures[1]),
    extra("supply_port_pressure_pa", "in front of the supply's lands, behind its tube", |v| {
        v.supply_pressure
    }),
    extra("supply_flow_1_kg_s", "from the supply into the node of port 1", |v| v.supply_flows[0]),
    extra("supply_flow_2_kg_s", "from the supply into the node of port 2", |v| v.supply_flows[1]),
    extra("exhaust_flow_1_kg_s", "from the exhaust into the node of port 1; negative when air leaves", |v| {
        v.exhaust_flows[0]
    }),
    extra("exhaust_flow_2_kg_s", "from the exhaust into the node of port 2", |v| v.exhaust_flows[1]),
    received("receiver_pressure_pa", "P of the receiver, absolute", |r| r.pressure),
    received("receiver_temperature_k", "T of the receiver", |r| r.temperature),
    received(
        "receiver_flow_kg_s",
        "from the line into the receiver; negative when air flows back or a regulator relieves",
        |r| r.feed_flow,
    ),
    known("law_phase", "what the law does: 0 rest, 1 a trajectory of its own, 2 a profile", |k| k.stage),
    known("law_reference_mm", "where the law wants the load", |k| k.reference * 1e3),
    known("law_reference_velocity_m_s", "how fast the law wants the load", |k| k.reference_velocity),
    known("law_position_mm", "where the law takes the load to be", |k| k.position * 1e3),
    known("law_velocity_m_s", "how fast the law takes the load to be", |k| k.velocity),
    known("law_force_n", "F, by the measured pressures", |k| k.force),
    known("law_wanted_force_n", "F that the law wants", |k| k.wanted_force),
    known(
        "law_opposing_force_n",
        "d of the motion observer: what stands against the load now, beside friction",
        |k| k.opposing_force,
    ),
    known("law_standing_force_n", "the same as the law has learned it", |k| k.standing_force),
    known("law_mass_kg", "the mass that the law has learned", |k| k.mass),
    known("law_friction_share", "the friction that the law has learned, over that of the rig file", |k| {
        k.friction
    }),
    known("law_lag_ms", "the lag of the valve that the law has learned", |k| k.lag * 1e3),
    known(
        "law_looseness",
        "how often the law has doubled the distance from a target at which it rests",
        |k| k.looseness,
    ),
];

const fn extra(name: &'static str, help: &'static str, of: fn(&ValveState) -> f64) -> Extra {
    Extra { name, help, of: Source::Valve(of) }
}

const fn received(name: &'static str, help: &'static str, of: fn(&ReceiverState) -> f64) -> Extra {
    Extra { name, help, of: Source::Receiver(of) }
}

const fn known(name: &'static str, help: &'static str, of: fn(&Known) -> f64) -> Extra {
    Extra { name, help, of: Source::Law(of) }
}

impl Row {
    /// The numbers of the row, in the order of [`COLUMNS`].
    #[must_use]
    pub fn values(&self) -> [f64; COLUMNS.len()] {
        let seen = &self.observation;
        let of_controller =
            [self.time, seen.setpoint.into(), seen.position.into(), seen.error.into(), seen.command.into()];
        let mut values = [0.0; COLUMNS.len()];
        let (first, others) = values.split_at_mut(OF_CONTROLLER.len());
        first.copy_from_slice(&of_controller);
        others.iter_mut().zip(&QUANTITIES).for_each(|(value, quantity)| *value = (quantity.of)(&self.plant));
        values
    }
}

/// trace.csv: a header, then one line per row.
#[must_use]
pub fn to_csv(rows: &[Row]) -> String {
    to_csv_with(rows, &[])
}

/// The same with more columns.
#[must_use]
pub fn to_csv_with(rows: &[Row], extras: &[&Extra]) -> String {
    let names = COLUMNS.into_iter().chain(extras.iter().map(|extra| extra.name));
    let mut text = names.collect::<Vec<_>>().join(",");
    text.push('\n');
    for row in rows {
        let more = extras.iter().map(|extra| extra.value(row));
        for (column, value) in row.values().into_iter().chain(more).enumerate() {
            if column > 0 {
                text.push(',');
            }
            push_number(&mut text, value);
        }
        text.push('\n');
    }
    text
}

/// Significant digits of a number: a tenth of a nanometre in a metre is kept, and rounding of the last bits is
/// not shown.
const DIGITS: usize = 12;

/// Below this the exponent is written, not the zeros.
const SMALLEST_EXPONENT: i32 = -4;

/// Appends a number with twelve significant digits, without redundant zeros.
pub fn push_number(text: &mut String, value: f64) {
    const WHOLE: f64 = 1e9;
    if value.abs() < WHOLE && value == value.trunc() {
        write!(text, "{}", value as i64).expect("writing to a string");
        return;
    }
    let begin = text.len();
    write!(text, "{value:.*e}", DIGITS - 1).expect("writing to a string");
    let Some(e) = text[begin..].find('e') else { return };
    let exponent: i32 = text[begin + e + 1..].parse().expect("the exponent of a number");
    text.truncate(begin + e);
    text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    if exponent < SMALLEST_EXPONENT {
        write!(text, "e{exponent}").expect("writing to a string");
    } else {
        place_point(text, begin, exponent);
    }
}

/// Moves the decimal point of the number that begins at `begin` from behind its first digit by `exponent` places.
fn place_point(text: &mut String, begin: usize, exponent: i32) {
    let first = begin + usize::from(text[begin..].starts_with('-'));
    if text[first..].len() > 1 {
        text.remove(first + 1);
    }
    let digits = text[first..].len();
    let places = exponent.unsigned_abs() as usize;
    if exponent < 0 {
        text.insert_str(first, &"0.0000"[..1 + places]);
    } else if places + 1 < digits {
        text.insert(first + 1 + places, '.');
    } else {
        text.extend(std::iter::repeat_n('0', places + 1 - digits));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(value: f64) -> String {
        let mut text = String::from("1,-");
        push_number(&mut text, value);
        text.split_off(3)
    }

    #[test]
    fn numbers_are_short_and_exact_to_twelve_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (325_324.999_999_999_1, "325325"),
            (0.098_719_625, "0.098719625"),
            (5.628_959_333_572_113e-5, "5.62895933357e-5"),
            (1e-4, "0.0001"),
            (-0.25, "-0.25"),
            (-2048.0, "-2048"),
            (-20.5, "-20.5"),
            (1.5e13, "15000000000000"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn a_number_reads_back_as_the_nearest_one_of_twelve_digits() {
        let mut value = 1.234_567_890_123_456e-9;
        while value < 1e16 {
            for value in [value, -value] {
                let rounded: f64 = format!("{value:.11e}").parse().expect("a number");
                let text = number(value);
                assert_eq!(text.parse(), Ok(rounded), "{value:e}");
                let shortest =
                    if rounded.abs() < 1e-4 { format!("{rounded:e}") } else { rounded.to_string() };
                assert_eq!(text, shortest, "{value:e}");
            }
            value *= 1.377;
        }
    }
}
