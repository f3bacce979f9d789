use super::*;

fn rig() -> Rig {
    Rig::builtin("servo-b-tuned").expect("a built-in rig")
}

fn message(csv: &str) -> String {
    through(&rig(), csv, &[]).map_or_else(|error| format!("{error:#}"), |through| through.notes.join("; "))
}

#[test]
fn a_test_goes_through_the_points_and_begins_at_the_first_one() {
    let csv = "# a path\ntime_s, position_mm\n0, 100\n0.2, 100\n\n0.7, 160\n1.0, 160\n";
    let Through { rig, notes } = through(&rig(), csv, &[]).expect("a path");
    let counts: Vec<f64> = rig.planned().iter().map(|one| one.target as f64 * 0.01205).collect();
    assert!(
        counts.iter().zip([100.0, 100.0, 160.0, 160.0]).all(|(is, asked)| (is - asked).abs() < 0.01),
        "{counts:?}"
    );
    assert_eq!(rig.get(&keys::test::DURATION_S), 1.5);
    assert!((rig.get(&keys::test::POSITION_M) - 0.1).abs() < 1e-5);
    assert!(notes[0].contains("4 of 4 points") && notes[1].contains("120.0 mm/s"), "{notes:?}");
}

#[test]
fn what_is_typed_of_the_test_holds_and_so_does_what_the_file_says_of_its_record() {
    let rig = rig().with_settings(&["test.decimation=2".to_owned()]).expect("valid");
    let settings = ["test.duration_s=2", "load.mass_kg=3"].map(str::to_owned);
    let through = through(&rig, "time_s,position_mm\n0,100\n0.5,120\n", &settings).expect("a path").rig;
    assert_eq!((through.get(&keys::test::DURATION_S), through.get(&keys::test::DECIMATION)), (2.0, 2));
}

#[test]
fn a_fine_table_becomes_lines_that_are_within_a_count_of_each_of_its_points() {
    let at = |time: f64| 150.0 + 20.0 * (std::f64::consts::PI * time).cos();
    let rows: String =
        (0..=1000).map(|k| f64::from(k) / 1e3).map(|time| format!("{time},{}\n", at(time))).collect();
    let csv = format!("time_s,position_mm\n{rows}");
    let all = points_of(&csv).expect("points");
    let kept = straightened(&all, 0.01205);
    assert!((10..=MAX_MOVES).contains(&kept.len()), "{}", kept.len());
    for point in &all {
        let after = kept.partition_point(|one| one.time_s < point.time_s).max(1);
        let [a, b] = [kept[after - 1], kept[after]];
        let on_line = a.mm + (b.mm - a.mm) * (point.time_s - a.time_s) / (b.time_s - a.time_s);
        assert!((on_line - point.mm).abs() <= 0.01205 + 1e-9, "{point:?}");
    }
    assert!(through(&rig(), &csv, &[]).is_ok());
}

#[test]
fn what_is_no_path_is_refused_with_its_line_and_what_to_do() {
    let with = |rows: &str| message(&format!("time_s,position_mm\n{rows}"));
    for (told, expected) in [
        (message(""), "time_s,position_mm"),
        (message("t,x\n0,1\n"), "line 1: expected a header with the columns time_s, position_mm"),
        (with("0,100\n0.1,x\n"), "line 3, column 2 (\"position_mm\"): \"x\" is not a number"),
        (with("0,100\n0.1,inf\n"), "line 3, column 2 (\"position_mm\"): \"inf\" is not a number"),
        (with("0,100\n0.1\n"), "line 3 has 1 cells, line 2 has 2"),
        (with("0,100\n0.1"), "its last line ends in the middle"),
        (with("0,100\n"), "it has 1 points"),
        (with("0.5,100\n1,120\n"), "line 2: the first point is at 0.5 s"),
        (with("0,100\n0.5,120\n0.4,130\n"), "line 4: 0.4 s is not after line 3"),
        (with("0,100\n1,301\n"), "line 3: 301 mm is not between the soft limits of 0 and 300 mm"),
        (with("0,100\n0.1,200\n"), "line 3: 1000.0 mm/s from line 2 on are above test.velocity_mm_s = 500"),
        (with("0,100\n0.1,200\n"), "--set test.velocity_mm_s=1000"),
        (
            with("0,100\n0.5,100\n0.51,104\n1,104\n"),
            "3: the speed changes from 0.0 to 400.0 mm/s there, 40000 mm/s^2 and above test.acceleration_mm_s2 = 5000;",
        ),
        (with("0,100\n0.0001,100.02\n0.0002,100.06\n1,100\n"), "less than a sample of 0.0013 s"),
    ] {
        assert!(told.contains(expected), "{expected}: {told}");
    }
    let zigzag: String = (0..200).map(|k| format!("{},{}\n", 0.1 * f64::from(k), 100 + k % 2)).collect();
    assert!(
        with(&zigzag).contains("200 straight lines") || with(&zigzag).contains("64 at most"),
        "{}",
        with(&zigzag)
    );
    let open = rig().with_settings(&["controller.loop=open".to_owned(), "test.moves=[[0.0, 1]]".to_owned()]);
    let told = through(&open.expect("valid"), "time_s,position_mm\n0,1\n1,2\n", &[]).expect_err("refused");
    assert!(told.to_string().contains("controller.loop is open"), "{told}");
}
