//! The three drives (7.2.1 to 7.2.3).

use anyhow::Result;
use pneudrive_sim::keys;
use pneudrive_sim::trace::Row;
use pneudrive_sim::{Rig, Run};

use crate::drives::{column, rig, rms, run, step_charts};
use crate::study::{Variant, at_start};
use crate::{Chart, Entry, Exhibit, Experiment, Found, Line, Measured, Reading};

pub(super) const EXHIBITS: [Exhibit; 4] = [
    Exhibit {
        section: "7.2.1",
        place: "Fig. 7.14",
        about: "Open loop responses of servo-drive A",
        lost: "both responses, and what was commanded",
        commands: &[
            "pneudrive simulate servo-a --set controller.loop=open --set 'test.moves=[[0.0, 0], [0.3, 40], [2.0, -40]]' --set test.duration_s=3.7 --out DIR",
        ],
        entries: &[
            Entry::sentence("stops", "The curves stop exactly at the two ends of the cylinder."),
            Entry::sentence("command", "Timing and value of the open loop commands are simulated exactly."),
        ],
        why: "",
        experiment: Experiment::Own(open_loop),
        takes_s: 0.1,
    },
    Exhibit {
        section: "7.2.1",
        place: "Fig. 7.15",
        about: "The pressure at the valve, and a lag of the tubing",
        lost: "the oscillating pressure",
        commands: &[
            "pneudrive simulate servo-a --set controller.loop=open --set 'test.moves=[[0.0, 0], [0.3, 40], [2.0, -40]]' --set test.duration_s=3.7 --set tubing.lag_s=0.001 --columns port_pressure_1_pa --out DIR",
        ],
        entries: &[
            Entry::sentence("0 ms", "The instantaneous P_1v is far too oscillatory."),
            Entry::sentence("1 ms", "With a time constant of 1 ms the oscillations are notably reduced."),
            Entry::sentence("10 ms", "With 10 ms they are totally removed."),
        ],
        why: "The thesis calls its oscillation a numerical instability of its flow solution, and the model bears that out: solved together, tube and valve do not oscillate at any lag. So there is nothing for the lag to reduce.",
        experiment: Experiment::Own(lags),
        takes_s: 0.3,
    },
    Exhibit {
        section: "7.2.1",
        place: "Fig. 7.16, 7.17",
        about: "Closed loop step responses of servo-drive A",
        lost: "both responses",
        commands: &["pneudrive simulate servo-a --out DIR"],
        entries: &[
            Entry::sentence("stable", "The servo-drive performs stably."),
            Entry::sentence(
                "spool",
                "Controller and stepper are discrete: the spool goes in steps (Fig. 7.17).",
            ),
        ],
        why: "",
        experiment: Experiment::Own(closed_loop),
        takes_s: 0.1,
    },
    Exhibit {
        section: "7.2.2",
        place: "Fig. 7.18, 7.19",
        about: "Step responses of servo-drives B and C",
        lost: "the responses of both rigs and of the thesis's simulation",
        commands: &["pneudrive simulate servo-b-thesis --out DIR", "pneudrive simulate servo-c --out DIR"],
        entries: &[
            Entry::sentence(
                "B",
                "The positions agree closely, with slight deviations in stability, frequency and amplitude of vibration.",
            ),
            Entry::sentence(
                "C",
                "The reverse motion agrees well; the forward moves do not, as the friction of Tab. 7.2 was used.",
            ),
        ],
        why: "",
        experiment: Experiment::Own(steps),
        takes_s: 0.2,
    },
];

/// Full openings of the stepper, to both ends.
const OPEN: [&str; 3] =
    ["controller.loop=open", "test.moves=[[0.0, 0], [0.3, 40], [2.0, -40]]", "test.duration_s=3.7"];

fn open_loop() -> Result<Measured> {
    let rig = rig("servo-a", &OPEN)?;
    let run = run(&rig)?;
    let ends = crate::reading::ends(&column(&run, |row| row.plant.position));
    let beyond = [-ends[0], ends[1] - rig.get(&keys::actuator::STROKE_M)];
    let holds = beyond.iter().all(|m| (-1e-4..=rig.get(&keys::stop::STOP_REGION_M)).contains(m));
    let text = format!(
        "it is pressed {:.2} and {:.2} mm into its ends, of {} mm of C(89)",
        1e3 * beyond[1],
        1e3 * beyond[0],
        1e3 * rig.get(&keys::stop::STOP_REGION_M)
    );
    let held = run.rows.iter().filter(|row| holds_command(row)).count();
    let share = format!("{held} of {} rows have the command of their move", run.rows.len());
    let readings = vec![
        Reading::shows("stops", holds, text, "one run, as nothing of it is drawn"),
        Reading::shows("command", held == run.rows.len(), share, "every row of one run"),
    ];
    Ok(Measured { readings, charts: step_charts("A, open loop", &rig, &run).into() })
}

/// Whether the command is that of the move which the last sample has taken.
fn holds_command(row: &Row) -> bool {
    // Samples come every 1.3 ms: the first behind 0.3 s at 0.3003 s, that behind 2 s at 2.0007 s.
    let expected = match row.time {
        time if time < 0.300_29 => 0,
        time if time < 2.000_69 => 40,
        _ => -40,
    };
    i32::from(row.observation.command) == expected
}

/// A pressure turns back if it goes by more than this, Pa.
const SEEN_PA: f64 = 5e3;

/// How often values turn back by more than so much.
fn turns(values: &[f64], seen: f64) -> usize {
    let (mut turns, mut from, mut direction) = (0, values[0], 0.0);
    for value in values {
        let gone = value - from;
        if gone * direction > 0.0 {
            from = *value;
        } else if gone.abs() > seen {
            turns += usize::from(direction != 0.0);
            (direction, from) = (gone.signum(), *value);
        }
    }
    turns
}

fn at_port(run: &Run) -> Vec<f64> {
    column(run, |row| row.valve.as_ref().map_or(f64::NAN, |valve| valve.port_pressures[0]))
}

fn lags() -> Result<Measured> {
    let (mut measured, mut without) = (Measured::default(), 0);
    for (key, lag) in
        [("0 ms", "tubing.lag_s=0"), ("1 ms", "tubing.lag_s=0.001"), ("10 ms", "tubing.lag_s=0.01")]
    {
        let rig = rig("servo-a", &[OPEN[0], OPEN[1], OPEN[2], lag])?;
        let run = run(&rig)?;
        let (port, chamber) = (at_port(&run), column(&run, |row| row.plant.pressures[0]));
        let [turned, of_chamber] = [&port, &chamber].map(|values| turns(values, SEEN_PA));
        let apart = 1e-3 * rms(port.iter().zip(&chamber).map(|(a, b)| a - b));
        let text = format!(
            "P_1v turns back by more than 5 kPa {turned} times, P_1 {of_chamber} times; they are {apart:.0} kPa apart (rms)"
        );
        measured.readings.push(match key {
            "0 ms" => {
                without = turned;
                Reading::shows(key, turned > 2 * of_chamber, text, "a row each 1.3 ms")
            }
            // Where nothing oscillates without a lag, no lag can reduce it.
            _ if without <= 2 * of_chamber => Reading {
                key: key.to_owned(),
                found: Found::Shows { text, agreement: crate::Agreement::Open },
                rests_on: "there is no oscillation to reduce".to_owned(),
            },
            _ => Reading::shows(key, turned < without, text, "a row each 1.3 ms"),
        });
        measured.charts.push(lag_chart(key, &column(&run, |row| row.time), [&port, &chamber]));
    }
    Ok(measured)
}

/// The pressures at the valve and in the chamber, Pa, over time.
fn lag_chart(lag: &str, time: &[f64], [port, chamber]: [&[f64]; 2]) -> Chart {
    let kpa = |values: &[f64]| values.iter().map(|pa| 1e-3 * pa).collect::<Vec<f64>>();
    Chart {
        title: format!("a lag of {lag}"),
        across: "time, s",
        up: "pressure, kPa",
        lines: vec![
            Line::new("P_1v, at the valve", time, &kpa(port)),
            Line::new("P_1, in the chamber", time, &kpa(chamber)),
        ],
        ..Chart::default()
    }
}

/// Servo-drive A as its file has it.
const SERVO_A: Variant = Variant { name: "A", rig: "servo-a", settings: &[] };

const STARTS: usize = 16;

fn closed_loop() -> Result<Measured> {
    let rig = rig("servo-a", &[])?;
    let run = run(&rig)?;
    let mut charts: Vec<Chart> = step_charts("A, closed loop", &rig, &run).into();
    let time = column(&run, |row| row.time);
    let spool = column(&run, |row| 1e3 * row.plant.spool);
    let step_mm = rig.get(&keys::stepper::MM_PER_STEP);
    let off = spool.iter().map(|mm| (mm / step_mm - (mm / step_mm).round()).abs()).fold(0.0, f64::max);
    charts.push(Chart {
        title: "A, closed loop: spool".to_owned(),
        across: "time, s",
        up: "spool, mm",
        lines: vec![Line::new("", &time, &spool)],
        ..Chart::default()
    });
    let turned: Vec<usize> = (0..STARTS)
        .map(|start| Ok(turns_of_last_move(&crate::drives::run(&at_start(&SERVO_A, start)?)?)))
        .collect::<Result<_>>()?;
    let most = turned.iter().copied().max().unwrap_or(0);
    let readings = vec![
        Reading::shows(
            "stable",
            most <= 1,
            format!("from its last move on it turns back by more than 1 mm {most} times at most"),
            format!("{STARTS} starts elsewhere on the stroke; once is an overshoot"),
        ),
        Reading::shows(
            "spool",
            off < 1e-6,
            format!("it stands on whole steps of {step_mm} mm to within {:.0e} of a step", off.max(1e-12)),
            "every row of the run",
        ),
    ];
    Ok(Measured { readings, charts })
}

/// How often the drive turns back by more than 1 mm from its last move on.
fn turns_of_last_move(run: &Run) -> usize {
    let begins_s =
        run.rows.windows(2).filter(|pair| pair[0].observation.setpoint != pair[1].observation.setpoint);
    let begins_s = begins_s.map(|pair| pair[1].time).next_back().unwrap_or(0.0);
    let after = run.rows.iter().filter(|row| row.time >= begins_s);
    turns(&after.map(|row| row.plant.position).collect::<Vec<f64>>(), 1e-3)
}

fn steps() -> Result<Measured> {
    let of = |title: &str, rig: &Rig| -> Result<[Chart; 2]> { Ok(step_charts(title, rig, &run(rig)?)) };
    let charts =
        of("B", &rig("servo-b-thesis", &[])?)?.into_iter().chain(of("C", &rig("servo-c", &[])?)?).collect();
    let lost = "what to compare with is lost";
    Ok(Measured { readings: vec![Reading::nothing("B", lost), Reading::nothing("C", lost)], charts })
}

#[cfg(test)]
mod tests {
    use super::turns;

    #[test]
    fn a_pressure_turns_back_where_it_goes_the_other_way_by_more_than_is_seen() {
        assert_eq!(turns(&[0.0, 1e5, 0.0, 1e5], 5e3), 2);
        assert_eq!(turns(&[0.0, 1e5, 0.97e5, 1.2e5], 5e3), 0, "3 kPa are not seen");
        assert_eq!(turns(&[0.0, 0.0, 0.0], 5e3), 0);
    }
}
