//! Measured points beside a computed curve: how far they are from it, and whether their own spread explains that.

use anyhow::{Context, Result, bail};
use pneudrive_tables::Table;

/// Name of the column with the standard deviation of a point.
const SPREAD: &str = "spread";

/// Points of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Positions along the axis of the curve.
    pub x: Vec<f64>,
    /// The measured values.
    pub y: Vec<f64>,
    /// Standard deviation of each, where the measurement has one.
    pub spread: Option<Vec<f64>>,
}

/// How far points are from a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Points that the curve has a place for.
    pub count: usize,
    /// The largest distance, and where it is.
    pub largest: (f64, f64),
    /// Root of the mean squared distance.
    pub root_mean_square: f64,
    /// The largest value of the curve, in size.
    pub scale: f64,
    /// How many points lie within two of their standard deviations.
    pub within: Option<usize>,
}

impl Points {
    /// Of a table with a head that has the names of both columns, and perhaps `spread`.
    ///
    /// # Errors
    /// When it is no such table, with the line.
    pub fn of_table(bytes: impl AsRef<[u8]>, names: [&str; 2]) -> Result<Points> {
        let table = Table::read_whole(bytes)?;
        let [Some(across), Some(value)] = [table.find(&names[..1])?, table.find(&names[1..])?] else {
            bail!(
                "line {}: expected a header with {}, {} and perhaps {SPREAD}; found {}",
                table.head_line(),
                names[0],
                names[1],
                table.names().join(", ")
            );
        };
        let spread = table.find(&[SPREAD])?.map(|place| table.all_numbers(place)).transpose()?;
        let below = spread.as_ref().and_then(|spread| spread.iter().position(|spread| *spread < 0.0));
        if let (Some(row), Some(spread)) = (below, &spread) {
            bail!("line {}: a spread of {} is none", table.line(row), spread[row]);
        }
        Ok(Points { x: table.all_numbers(across)?, y: table.all_numbers(value)?, spread })
    }

    /// How far they are from a curve in rising order of x, straight between its points. Points beyond its ends are left out.
    ///
    /// # Errors
    /// When the curve has a place for none of them.
    pub fn beside(&self, x: &[f64], y: &[f64]) -> Result<Deviation> {
        let distances: Vec<(usize, f64)> =
            (0..self.x.len()).filter_map(|i| Some((i, self.y[i] - between(x, y, self.x[i])?))).collect();
        let largest = distances.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let &(at, distance) = largest.context("no point lies where the curve is")?;
        let squares: f64 = distances.iter().map(|(_, distance)| distance * distance).sum();
        let within = self.spread.as_ref().map(|spread| {
            distances.iter().filter(|(i, distance)| distance.abs() <= 2.0 * spread[*i]).count()
        });
        Ok(Deviation {
            count: distances.len(),
            largest: (distance, self.x[at]),
            root_mean_square: (squares / distances.len() as f64).sqrt(),
            scale: y.iter().fold(0.0, |largest, value| value.abs().max(largest)),
            within,
        })
    }
}

/// The curve at a place; None beyond its ends and where it has no number.
fn between(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let after = x.partition_point(|place| *place < at);
    if after == 0 {
        return (x.first() == Some(&at)).then(|| y[0]);
    }
    let ([a, b], [from, to]) = ([after - 1, after].map(|i| x.get(i)), [after - 1, after].map(|i| y.get(i)));
    let part = (at - a?) / (b? - a?);
    Some(from? + part * (to? - from?)).filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 2] = ["command_percent", "flow_l_min"];

    #[test]
    fn distances_are_those_from_the_straight_lines_between_the_curves_points() {
        let csv =
            "# bench of May\ncommand_percent,flow_l_min,spread\n0,1,0.1\n50,102,2\n75,151,0.4\n120,9,9\n";
        let points = Points::of_table(csv, NAMES).expect("a table");
        let found = points.beside(&[0.0, 100.0], &[0.0, 200.0]).expect("points on it");
        assert_eq!((found.count, found.largest, found.within), (3, (2.0, 50.0), Some(1)), "{found:?}");
        assert!((found.root_mean_square - 2.0_f64.sqrt()).abs() < 1e-12 && found.scale == 200.0);
    }

    #[test]
    fn what_is_no_table_of_points_is_refused_with_its_line() {
        for (csv, says) in [
            ("", "empty"),
            ("command,flow\n1,2\n", "command_percent, flow_l_min"),
            ("command_percent,flow_l_min\n1,x\n", "line 2"),
            ("command_percent,flow_l_min,spread\n1,2,-1\n", "spread of -1"),
            ("command_percent,flow_l_min\n", "no line of numbers"),
        ] {
            let message = format!("{:#}", Points::of_table(csv, NAMES).expect_err("refused"));
            assert!(message.contains(says), "{csv:?}: {message}");
        }
        let far = Points { x: vec![3.0], y: vec![1.0], spread: None };
        assert!(far.beside(&[0.0, 1.0], &[0.0, 1.0]).is_err());
    }
}
