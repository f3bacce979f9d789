use super::*;

/// A sweep of servo-b-tuned.
pub(super) fn sweep(text: &str) -> Sweep {
    let rig = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let text = format!("rig = \"servo-b-tuned\"\n{text}\n[metrics]\nair = \"air_l\"\n");
    let source = |name: &str, text: &str| Source { name: name.to_owned(), text: text.to_owned() };
    Sweep::read(source("s.toml", &text), |name| Ok(source(name, rig)))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

#[test]
fn points_are_every_combination_and_every_draw_the_last_key_fastest_and_draws_faster_still() {
    let grid =
        sweep("[vary]\nload.mass_kg = [1, 2]\ncontroller.velocity_gain = { from = 10, to = 30, steps = 3 }");
    let levels: Vec<Vec<&str>> = (0..grid.points()).map(|point| grid.levels(point)).collect();
    assert_eq!(levels, [["1", "10"], ["1", "20"], ["1", "30"], ["2", "10"], ["2", "20"], ["2", "30"]]);
    let drawn = sweep(
        "[draw]\ncount = 3\n[vary]\nload.mass_kg = { uniform = [1, 2] }\nsupply.pressure_pa = [4e5, 5e5]",
    );
    assert_eq!(drawn.points(), 6);
    assert_eq!(drawn.levels(0)[0], drawn.levels(3)[0], "the same draws at each combination");
    assert_eq!((drawn.levels(2)[1], drawn.levels(3)[1]), ("400000.0", "500000.0"));
}

#[test]
fn a_factor_scales_what_the_rig_has_with_its_settings() {
    let text = "[set]\nload.coulomb_extend_n = 20\n[vary]\n\
        friction = { values = [0.5], scale = [\"load.static_extend_n\", \"load.coulomb_extend_n\"] }";
    let settings = sweep(text).settings_of(0).concat();
    assert_eq!(
        settings,
        ["load.coulomb_extend_n=20", "load.static_extend_n=35.0", "load.coulomb_extend_n=10.0"]
    );
}

#[test]
fn another_goal_or_comment_is_the_same_sweep_and_another_value_is_not() {
    let one = sweep("[vary]\nload.mass_kg = [1, 2]");
    let goal = sweep("[objective]\nminimise = \"air\"\n[vary]\nload.mass_kg = [1, 2] # kg");
    let value = sweep("[vary]\nload.mass_kg = [1, 3]");
    let finer = sweep("tolerance = 1e-12\n[vary]\nload.mass_kg = [1, 2]");
    assert_eq!(one.identity(), goal.identity());
    assert!(one.identity() != value.identity() && one.identity() != finer.identity());
}

#[test]
fn draws_are_as_exact_as_perturbed_runs_single_rigs_as_a_run_and_all_as_the_file_says() {
    let tolerance = |text: &str| {
        let sweep = sweep(text);
        sweep.accuracy_for(&sweep.rig).tolerance
    };
    let drawn = "[draw]\ncount = 3\n[vary]\nload.mass_kg = { uniform = [1, 2] }";
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    assert_eq!(tolerance(drawn), Accuracy::of_member(&rig, 1e-5).tolerance);
    assert_eq!(tolerance("[vary]\nload.mass_kg = [1, 2]"), Accuracy::of(&rig).tolerance);
    assert_eq!(tolerance(&format!("tolerance = 1e-10\n{drawn}")), 1e-10);
}

#[test]
fn a_row_reads_back_as_it_was_in_every_bit() {
    let sweep = sweep("[vary]\nload.mass_kg = [1, 2]");
    let row = Row {
        point: 1,
        levels: vec!["2".to_owned()],
        metrics: vec![Some(0.1 + 0.2)],
        ends: Vec::new(),
        converged: Some(true),
        fault: String::new(),
        failure: "no, \"never\"".to_owned(),
    };
    assert_eq!(row.to_csv(&sweep), "1,2,0.30000000000000004,yes,,\"no, \"\"never\"\"\"");
    assert_eq!(Row::of_csv(&sweep, &row.to_csv(&sweep)), Some(row.clone()));
    let empty = Row {
        metrics: vec![None],
        converged: None,
        failure: String::new(),
        fault: "no-motion".to_owned(),
        ..row
    };
    assert_eq!(Row::of_csv(&sweep, &empty.to_csv(&sweep)), Some(empty));
    assert_eq!(Row::of_csv(&sweep, "7,2,0.3,yes,,"), None, "there is no point 7");
}

#[test]
fn the_best_point_is_the_least_of_the_allowed_ones() {
    let text = "[objective]\nminimise = \"air\"\n[constraints]\nair = { min = 0.5 }\n[vary]\nload.mass_kg = [1, 2, 3, 4, 5]";
    let sweep = sweep(text);
    let row = |point: usize, air: Option<f64>, fault: &str| Row {
        point,
        levels: vec!["1".to_owned()],
        metrics: vec![air],
        ends: Vec::new(),
        converged: None,
        fault: fault.to_owned(),
        failure: String::new(),
    };
    let mut rows =
        vec![row(0, Some(0.4), ""), row(1, None, ""), row(2, Some(0.6), "stop"), row(3, Some(0.9), "")];
    assert_eq!(sweep.best(&rows).map(|row| row.point), Some(3));
    rows.truncate(3);
    assert_eq!(sweep.best(&rows), None);
    assert_eq!(report::best(&sweep, &rows).rows[0][0], "no allowed point has a value");
}

#[test]
fn the_combination_with_the_most_allowed_draws_comes_first_whatever_its_best_draw() {
    let text = "[objective]\nminimise = \"air\"\n[constraints]\nair = { max = 1.0 }\n[draw]\ncount = 2\n\
        [vary]\ncontroller.velocity_gain = [10, 20, 30]\nload.mass_kg = { uniform = [1, 2] }";
    let sweep = sweep(text);
    let row = |(point, air): (usize, Option<f64>)| Row {
        point,
        levels: sweep.levels(point).into_iter().map(str::to_owned).collect(),
        metrics: vec![air],
        ends: Vec::new(),
        converged: None,
        fault: String::new(),
        failure: String::new(),
    };
    let air = [Some(0.1), Some(1.5), Some(0.8), Some(0.9), Some(0.2), None];
    let rows: Vec<Row> = air.into_iter().enumerate().map(row).collect();
    let table = report::combinations(&sweep, &rows);
    let expected = [["20", "2 of 2", "0.9000"], ["10", "1 of 2", "1.5000"], ["30", "1 of 2", "-"]];
    assert_eq!(table.rows, expected.map(|row| row.map(str::to_owned).to_vec()));
}

#[test]
fn a_constraint_is_kept_over_the_whole_range_or_not_at_all() {
    let text = "ensemble = 8\n[objective]\nminimise = \"air\"\n[constraints]\nair = { min = 0.1, max = 1.0 }\n\
        [vary]\nload.mass_kg = [1, 2, 3, 4, 5]";
    let sweep = sweep(text);
    assert_eq!(sweep.header(), "point,load.mass_kg,air,air_least,air_most,converged,fault,failure");
    let row = |(point, ends): (usize, Option<[f64; 2]>)| Row {
        point,
        levels: vec!["1".to_owned()],
        metrics: vec![Some(0.5)],
        ends: vec![ends],
        converged: Some(true),
        fault: String::new(),
        failure: String::new(),
    };
    let ends = [Some([0.4, 1.1]), None, Some([-0.5, 0.5]), Some([0.5, 0.9]), Some([-0.7, -0.5])];
    let rows: Vec<Row> = ends.into_iter().enumerate().map(row).collect();
    let allowed: Vec<usize> = rows.iter().filter(|row| sweep.allows(row)).map(|row| row.point).collect();
    assert_eq!(allowed, [3, 4], "a range with 0 in it has a size of 0");
    assert_eq!(sweep.best(&rows).map(|row| row.point), Some(4), "its worst end is the least");
    assert_eq!(Row::of_csv(&sweep, &rows[0].to_csv(&sweep)), Some(rows[0].clone()));
    assert_eq!(Row::of_csv(&sweep, &rows[1].to_csv(&sweep)), Some(rows[1].clone()));
}

#[test]
fn a_metric_that_no_point_shows_has_no_graph_and_the_page_says_so() {
    let sweep = sweep("[vary]\nload.mass_kg = [1, 2]");
    let row = |point: usize, air: Option<f64>| Row {
        point,
        levels: vec!["1".to_owned()],
        metrics: vec![air],
        ends: Vec::new(),
        converged: Some(true),
        fault: String::new(),
        failure: String::new(),
    };
    let page = report::page(&sweep, &[row(0, None), row(1, Some(0.4))]);
    assert_eq!((page.figures.len(), page.notes.len()), (1, 1), "{:?}", page.notes);
    let page = report::page(&sweep, &[row(0, None), row(1, None)]);
    assert!(page.figures.is_empty());
    assert_eq!(page.notes[1], "No point has a value of air, so there is no graph of it.");
}
