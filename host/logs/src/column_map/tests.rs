use super::*;

const AMBIENT_PA: f64 = 101_325.0;

/// A map that is right.
const MAP: &str = r#"
[time]
column = "t"
unit = "ms"
[position]
column = "x"
unit = "mm"
sign = -1
offset = "125 mm"
[pressure_1]
column = "p1"
unit = "bar(g)"
[pressure_2]
column = "p2"
unit = "kPa"
[command]
column = "u"
null = 5.0
full = 10
"#;

fn map(text: &str) -> Result<ColumnMap> {
    ColumnMap::from_text(text, AMBIENT_PA)
}

/// What a column's value is in the channel's unit.
fn value(channel: usize, of: f64) -> f64 {
    let map = map(MAP).expect("a map");
    let column = map.channels[channel].as_ref().expect("a column");
    column.scale * of + column.offset
}

#[test]
fn values_become_those_of_the_channels_by_unit_sign_offset_and_range() {
    let about = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found}")
    };
    about(value(POSITION, 25.0), 0.1);
    about(value(PRESSURES[0], 6.0), 701_325.0);
    about(value(PRESSURES[1], 250.0), 250e3);
    about(value(COMMAND, 5.0), 0.0);
    about(value(COMMAND, 0.0), -2048.0);
    about(value(COMMAND, 7.5), 1024.0);
    let t = Source { column: "t".into(), decimal: None };
    assert_eq!(map(MAP).expect("a map").time, Time::Column(t, Some(1e-3)));
    assert_eq!(map(MAP).expect("a map").channels[SPOOL], None);
}

#[test]
fn a_sensor_in_volts_is_a_straight_line_through_two_points_in_any_unit() {
    let text = MAP
        .replace(
            "unit = \"mm\"\nsign = -1\noffset = \"125 mm\"",
            "points = [[9.5, \"0 mm\"], [0.5, \"0.25 m\"]]",
        )
        .replace("unit = \"bar(g)\"", "points = [[1, \"0 bar(g)\"], [5, \"10 bar(g)\"]]");
    let map = map(&text).expect("a map");
    for (channel, of, expected) in [
        (POSITION, 9.5, 0.0),
        (POSITION, 5.0, 0.125),
        (PRESSURES[0], 1.0, AMBIENT_PA),
        (PRESSURES[0], 3.4, 701_325.0),
    ] {
        let column = map.channels[channel].as_ref().expect("a column");
        let found = column.scale * of + column.offset;
        assert!((found - expected).abs() < 1e-9 * expected.max(1.0), "{found} {expected}");
    }
}

#[test]
fn points_that_give_no_line_are_refused_by_their_table() {
    for (points, why) in [
        ("[[0.5, \"0 mm\"]]", "must be two"),
        ("[[0.5, 0], [4.5, 250]]", "the column's value and the quantity there: [0.5, \"0 mm\"]"),
        ("[[0.5, \"0 bar\"], [4.5, \"1 bar\"]]", "points: "),
        ("[[0.5, \"0 mm\"], [0.5, \"1 mm\"]]", "must differ"),
        ("[[0.5, \"1 mm\"], [4.5, \"1 mm\"]]", "must differ"),
        ("[[0.5, \"0 mm\"], [4.5, \"1 mm\"]]\nunit = \"mm\"", "leave out unit"),
    ] {
        let text =
            MAP.replace("unit = \"mm\"\nsign = -1\noffset = \"125 mm\"", &format!("points = {points}"));
        let problem = format!("{:#}", map(&text).expect_err("no line"));
        assert!(problem.starts_with("[position]: ") && problem.contains(why), "{problem}");
    }
}

#[test]
fn a_column_is_named_or_numbered_with_its_decimal_sign_and_a_gap_has_a_limit() {
    let map = map(&MAP
        .replace("column = \"x\"", "column = 3\ndecimal = \",\"")
        .replace("unit = \"ms\"", "gap = \"5 ms\""))
    .expect("a map");
    let of = map.channels[POSITION].clone().expect("a column").of;
    assert_eq!(of, Source { column: Place::Numbered(3), decimal: Some(Sign::Comma) });
    assert_eq!(map.gap_s, Some(5e-3));
    assert!(matches!(map.time, Time::Column(_, None)), "times with a date have no unit");
}

#[test]
fn a_percentage_and_a_count_are_commands_as_they_are() {
    let with = |unit: &str| {
        let text = format!(
            "[position]\ncolumn = \"x\"\nunit = \"m\"\n[command]\ncolumn = \"u\"\nunit = \"{unit}\"\n"
        );
        map(&text).expect("a map").channels[COMMAND].clone().expect("a column").scale
    };
    assert_eq!([with("counts"), 100.0 * with("%")], [1.0, 2048.0]);
}

#[test]
fn what_is_wrong_is_named_with_its_table() {
    for (from, to, told) in [
        ("[time]", "[tyme]", "[tyme] is not known; there are time, position, pressure_1"),
        ("unit = \"mm\"", "", "[position]: needs a unit, such as \"mm\""),
        ("unit = \"mm\"", "unit = \"kg\"", "[position]: unit: kg is not a unit of the same quantity as m"),
        ("sign = -1", "sign = 2", "[position]: sign must be 1 or -1, is 2"),
        (
            "sign = -1",
            "sing = -1",
            "[position]: sing is not known; there are column, unit, decimal, sign, offset",
        ),
        ("\"125 mm\"", "125", "[position]: offset must be a text in quotes"),
        (
            "unit = \"bar(g)\"",
            "unit = \"bar(g)\"\noffset = \"1 bar(g)\"",
            "[pressure_1]: offset: a difference is neither gauge",
        ),
        ("column = \"x\"", "column = 1.5", "[position]: column must be a name in quotes, or a number from 1"),
        ("column = \"x\"", "column = -1", "[position]: column must be a name in quotes, or a number from 1"),
        ("sign = -1", "decimal = \";\"", "[position]: decimal must be \".\" or \",\", is \";\""),
        ("unit = \"ms\"", "unit = \"ms\"\ngap = \"0 ms\"", "[time]: gap must be more than 0"),
        ("full = 10", "", "[command]: needs either unit = \"counts\" or \"%\", or null and full"),
        ("full = 10", "full = 5", "[command]: needs either"),
        ("column = \"u\"", "", "[command]: needs a column"),
        ("column = \"t\"", "", "[time]: needs either a column with its unit, or a period"),
        ("column = \"t\"", "period = \"-1 ms\"", "[time]: period must be more than 0"),
    ] {
        assert!(MAP.contains(from), "{from}");
        let problem = map(&MAP.replacen(from, to, 1)).expect_err(told).to_string();
        assert!(problem.starts_with(told), "{problem}");
    }
    let problem = map("[position]\ncolumn = \"x\"\nunit = \"m\"\n").expect_err("no command").to_string();
    assert_eq!(problem, "needs a table [command]: without it there is nothing to compare");
    assert!(map("position = \"x\"\n").expect_err("no table").to_string().contains("write [position]"));
}
