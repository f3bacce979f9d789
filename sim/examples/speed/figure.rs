//! docs/pictures/speed.svg: simulated seconds a second over the largest deviation of the position, both in decades.

use std::fmt::Write;

use crate::curve::Point;

/// Decades of the axes: metres, and simulated seconds a second.
const DEVIATIONS: [i32; 2] = [-10, -5];
const SPEEDS: [i32; 2] = [0, 5];

/// The frame, in pixels.
const LEFT: f64 = 60.0;
const TOP: f64 = 20.0;
const WIDTH: f64 = 440.0;
const HEIGHT: f64 = 320.0;

/// A case: its curve, and others at the deviation that they are known for.
pub struct Case<'a> {
    pub name: &'a str,
    pub colour: &'a str,
    pub curve: &'a [Point],
    pub others: &'a [(&'a str, f64, f64)],
}

fn x(deviation_m: f64) -> f64 {
    let [low, high] = DEVIATIONS.map(f64::from);
    LEFT + WIDTH * (deviation_m.log10() - low) / (high - low)
}

fn y(speed: f64) -> f64 {
    let [low, high] = SPEEDS.map(f64::from);
    TOP + HEIGHT * (high - speed.log10()) / (high - low)
}

/// The figure.
pub fn of(cases: &[Case<'_>]) -> String {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"660\" height=\"400\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"660\" height=\"400\" fill=\"white\"/>\n",
    );
    axes(&mut svg);
    for (i, case) in cases.iter().enumerate() {
        let colour = case.colour;
        let points: Vec<String> =
            case.curve.iter().map(|at| format!("{:.1},{:.1}", x(at.deviation_m), y(at.speed))).collect();
        let line = points.join(" ");
        push(
            &mut svg,
            format_args!(
                "<polyline points=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>"
            ),
        );
        let (at, name) = (TOP + HEIGHT - 26.0 + 16.0 * i as f64, case.name);
        let beside = LEFT + 12.0;
        push(&mut svg, format_args!("<text x=\"{beside}\" y=\"{at}\" fill=\"{colour}\">{name}</text>"));
        for (other, deviation_m, speed) in case.others {
            let (x, y) = (x(*deviation_m), y(*speed));
            push(&mut svg, format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>"));
            let (x, y) = (x + 7.0, y + 4.0);
            push(&mut svg, format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"{colour}\">{other}</text>"));
        }
    }
    svg + "</svg>\n"
}

fn push(svg: &mut String, element: std::fmt::Arguments<'_>) {
    writeln!(svg, "{element}").expect("writing to a string");
}

fn axes(svg: &mut String) {
    let [bottom, right] = [TOP + HEIGHT, LEFT + WIDTH];
    for decade in DEVIATIONS[0]..=DEVIATIONS[1] {
        let (x, below) = (x(10_f64.powi(decade)), bottom + 18.0);
        push(svg, format_args!("<path d=\"M{x:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/>"));
        push(svg, format_args!("<text x=\"{x:.1}\" y=\"{below}\" text-anchor=\"middle\">1e{decade}</text>"));
    }
    for decade in SPEEDS[0]..=SPEEDS[1] {
        let (y, beside) = (y(10_f64.powi(decade)), LEFT - 6.0);
        push(svg, format_args!("<path d=\"M{LEFT} {y:.1}H{right}\" stroke=\"#ddd\"/>"));
        let number = 10_i32.pow(decade.unsigned_abs());
        push(
            svg,
            format_args!("<text x=\"{beside}\" y=\"{y:.1}\" dy=\"4\" text-anchor=\"end\">{number}</text>"),
        );
    }
    let (middle, below) = (LEFT + 0.5 * WIDTH, bottom + 40.0);
    push(
        svg,
        format_args!(
            "<text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">largest deviation of the position, m</text>"
        ),
    );
    let aside = TOP + 0.5 * HEIGHT;
    push(
        svg,
        format_args!(
            "<text transform=\"translate(16 {aside}) rotate(-90)\" text-anchor=\"middle\">simulated seconds a second</text>"
        ),
    );
}
