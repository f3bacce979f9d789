use super::*;

fn table(text: &str) -> Table {
    Table::read(text.as_bytes()).unwrap_or_else(|problem| panic!("{text:?}: {problem}"))
}

fn refusal(text: &str) -> String {
    let of = |column: usize| Table::read(text.as_bytes()).and_then(|table| table.all_numbers(column));
    let found = [0, 1].map(of).into_iter().find_map(Result::err);
    found.unwrap_or_else(|| panic!("{text:?} is read")).to_string()
}

fn columns(text: &str) -> Vec<(String, Vec<f64>)> {
    let table = table(text);
    let numbers =
        |place: usize| table.all_numbers(place).unwrap_or_else(|problem| panic!("{text:?}: {problem}"));
    table.names().into_iter().enumerate().map(|(place, name)| (name, numbers(place))).collect()
}

#[test]
fn one_table_is_read_in_whatever_dialect_it_is_written() {
    let expected = [("t".to_owned(), vec![0.0, 0.5, 1.0]), ("x".to_owned(), vec![1.25, -2.0, 998.0])];
    for text in [
        "t,x\n0,1.25\n0.5,-2\n1,998\n",
        "\u{feff}t;x\r\n0;1,25\r\n0,5;-2\r\n1;998\r\n",
        "# made by a logger\nt\tx\ns\tmm\n0\t1.25\n\n0.5\t-2.0\n1\t998",
        " t , x \n 0 , 1.25\n0.5,-2e0\n1,998\n",
        "sep=;\nt;x\n0;1,25\n0,5;-2,0\n1;998\n\n",
        "\"t\",\"x\"\n\"0\",\"1,25\"\n\"0,5\",\"-2\"\n\"1\",\"998\"\n",
        "t,x,\n0,1.25,\n0.5,-2,\n1,998,\n,,\n",
        "t,x\n0,1.25,\n0.5,-2,\n1,998,\n",
        "t,x,\n0,1.25\n0.5,-2\n1,998\n",
        "Logger v2\nRate: 1000 Hz, once\n\nt|x\n0|1.25\n0.5|-2\n1|998\nend of data\n",
        "Rate,1000\nSerial,12\nt,x\n0,1.25\n0.5,-2\n1,998\n",
        "t,x\r0,1.25\r0.5,\u{2212}2\r1,998\r",
        "t;x\n0;1,25\n0,5;-2\n1;998\n1,5;99",
        "t;x\n0;1,25\n0,5;-2\n1;998\n1,",
    ] {
        let found = columns(text);
        assert_eq!(
            found[..2].iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["t", "x"],
            "{text:?}"
        );
        assert!(
            found[0].1.starts_with(&expected[0].1) && found[1].1.starts_with(&expected[1].1),
            "{text:?}: {found:?}"
        );
        assert_eq!(found.len(), 2, "{text:?}");
    }
}

#[test]
fn a_name_that_two_columns_have_is_refused_with_the_choices_and_a_number_is_none() {
    let table = table("Time,Value,Time,Value\n0,1,2,3\n");
    let refusal = table.place(&"Value".into()).expect_err("two").to_string();
    assert!(refusal.starts_with("line 1: 2 columns are called \"Value\": 2, 4;"), "{refusal}");
    assert!(refusal.ends_with("column = 2"), "{refusal}");
    assert_eq!(table.place(&Column::Numbered(4)), Ok(3));
    let refusal = table.place(&Column::Numbered(5)).expect_err("none").to_string();
    assert!(refusal.starts_with("there is no column 5; there are 1 \"Time\", 2 \"Value\""), "{refusal}");
    assert!(table.place(&Column::Numbered(0)).is_err());
}

#[test]
fn units_below_the_heads_and_columns_without_a_head_are_no_names_of_others() {
    let with_units = table("t,x,p\ns,mm,bar\n0,1,2\n0,1,3\n");
    assert_eq!(with_units.names(), ["t", "x", "p"]);
    assert_eq!((with_units.rows(), with_units.line(0), with_units.head_line()), (2, 3, 1));
    assert_eq!(table("t,x,n\ns,mm,\n0,1,2\n0,1,3\n").names(), ["t", "x", "n"]);
    let without = table("0,1\n1,off\n");
    assert_eq!(without.names(), ["1", "2"]);
    assert_eq!(without.place(&"2".into()), Ok(1));
    assert!(without.numbers(1, None).expect("numbers")[1].is_nan());
}

#[test]
fn the_decimal_sign_is_that_of_the_whole_column() {
    for (text, expected) in [
        ("t\tx\n0\t998,5\n1\t1,000\n", [998.5, 1.0]),
        ("t\tx\n0\t998.5\n1\t1,000\n", [998.5, 1000.0]),
        ("t\tx\n0,5\t998\n1,5\t1,125\n", [998.0, 1.125]),
        ("t,x\n0,100.000\n1,100.100\n", [100.0, 100.1]),
        ("t;x\n0,000;100,000\n0,001;100,100\n", [100.0, 100.1]),
        ("t;x\n700,000;100,000\n700,000;100,100\n", [100.0, 100.1]),
        ("t;x\n0;1.000.000\n1;1.000\n", [1e6, 1e3]),
        ("t;x\n0;1 000\n1;1 000,5\n", [1000.0, 1000.5]),
    ] {
        assert_eq!(columns(text)[1].1, expected, "{text:?}");
    }
}

#[test]
fn a_sign_that_may_stand_between_thousands_is_refused_until_it_is_said() {
    for text in [
        "t\tx\n0\t998\n1\t1,000\n",
        "t;x\n0;998\n1;1.000\n",
        "t;x\n0;998\n1;1,002\n",
        "t,x\n0,998\n1,1.002\n",
        "t,x\n0,998\n1,\"1,002\"\n",
        "t\tx\n0\t101,325\n1\t600,000\n",
        "t;x\n990,000;-366.235\n990,500;158.142\n",
        "t;x\n990.000;-366.235\n990.500;158.142\n",
        "t\tx\n0,5\t998\n1,5\t1,000\n",
    ] {
        let told = refusal(text);
        assert!(
            told.starts_with("line 3, column 2 (\"x\"): \"") || told.starts_with("line 2, column "),
            "{told}"
        );
        assert!(told.contains("may be") && told.contains("decimal ="), "{told}");
    }
    let table = table("t\tx\n0\t998\n1\t1,000\n");
    assert_eq!(table.numbers(1, Some(Sign::Dot)), Ok(vec![998.0, 1000.0]));
    assert_eq!(table.numbers(1, Some(Sign::Comma)), Ok(vec![998.0, 1.0]));
    let both = refusal("t;x\n0;1.5\n1;2,5\n");
    assert!(
        both.starts_with("column 2 (\"x\") has both decimal signs: \"1.5\" in line 2, \"2,5\" in line 3"),
        "{both}"
    );
}

#[test]
fn what_is_no_table_is_refused_with_line_column_cell_and_remedy() {
    for (text, told) in [
        ("", "it is empty"),
        ("\n# a\n\n", "it is empty"),
        ("abc\ndef\n", "it has no columns"),
        ("a,b\n", "line 1 has 2 cells, and no line of numbers comes after it"),
        ("a,b\n1,2\n3\n4,5\n", "line 3 has 1 cells, line 2 has 2"),
        ("a,b\n1,2\n3,4,5\n", "line 3 has 3 cells, line 2 has 2"),
        (
            "t,x\n0,000000,98,719625\n0,001300,98,719625\n",
            "line 1 has 2 names and line 2 below it 4 cells: is the comma both",
        ),
        ("t,x,\n0,1,15,\n0,1,23,\n", "line 1 has 2 names and line 2 below it 3 cells: is the comma both"),
        ("t,x,\n0,1,15\n0,1,23\n", "line 1 has 2 names and line 2 below it 3 cells: is the comma both"),
        ("a,b\n1,2\n3,off\n", "line 3, column 2 (\"b\"): \"off\" is not a number; write a number there"),
        ("t,x\n0,1\n#NV,2\n2,3\n", "line 3 begins with \"#NV\": write a number there"),
        ("a,b\n1,2\n3,\n", "line 3, column 2 (\"b\"): is empty"),
        ("a,b\n1,2\na,b\n3,4\n5,6\n", "line 3 interrupts the rows from line 2 on"),
        ("1,2\n3\n4,5\n6,7\n", "line 2 has 1 cells, line 1 has 2"),
        ("a,b\n1,2\n2,3\na,b\n3,4\n", "line 4 repeats the heads of line 1"),
        ("a,b\n1,2\n2,3\nsecond part\n3,4\n", "line 4 is no row, and rows come after it"),
        ("a,b\n1,\"2\n3,4\n5,6\n", "a quote opens at \"2\" and is not closed"),
    ] {
        let found = refusal(text);
        assert!(found.starts_with(told), "{text:?}: {found}");
    }
}

#[test]
fn times_with_a_date_count_from_the_first() {
    let of_day = table("t,x\n10:00:00.5,1\n10:00:01,2\n");
    assert_eq!(of_day.times(0), Ok(Some(vec![0.0, 0.5])));
    assert_eq!(of_day.times(1), Ok(None));
    let cut = table("t,x\n2026-01-01T10:00:00,1\nsoon,2\n");
    let told = cut.times(0).expect_err("no time").to_string();
    assert!(told.starts_with("line 3, column 1 (\"t\"): \"soon\" is no time"), "{told}");
}

#[test]
fn a_last_line_that_was_cut_is_left_out_and_told() {
    for (text, rows) in [
        ("t,x\n0,1.25\n1,2.25\n2,3.2", 2),
        ("t,x\n0,1.25\n1,2.25\n2,3.25", 3),
        ("t,x\n0,1.25\n1,2.25\n2", 2),
        ("t,x\n0,1.25\n1,2.25\n2,", 2),
        ("\"t\",\"x\"\n\"0\",\"1.25\"\n\"1\",\"2.25\"\n\"2\",\"3.", 2),
    ] {
        let table = table(text);
        assert_eq!((table.rows(), table.notes().len()), (rows, usize::from(rows == 2)), "{text:?}");
    }
}
