use super::*;

const GOOD: &str = "rig = \"servo-b-tuned\"\n[vary]\nload.mass_kg = [1, 2]\n[metrics]\nair = \"air_l\"\n";

fn read(text: &str) -> Result<Sweep, Problems> {
    let source = |name: &str, text: &str| Source { name: name.to_owned(), text: text.to_owned() };
    Sweep::read(source("s.toml", text), |name| {
        let rig =
            pneudrive_sim::rigfile::builtin(name).ok_or_else(|| anyhow::anyhow!("there is no rig {name}"))?;
        Ok(source(name, rig))
    })
}

/// What is said of the good file with a line in place of another.
fn formatted(of: &str, with: &str) -> String {
    assert!(GOOD.contains(of));
    read(&GOOD.replacen(of, with, 1)).expect_err(with).to_string()
}

#[test]
fn a_good_file_has_no_problems() {
    assert_eq!(read(GOOD).map(|sweep| sweep.points()), Ok(2));
}

#[test]
fn what_is_wrong_with_the_whole_is_named_by_line_and_key() {
    for (of, with, says) in [
        ("rig = \"servo-b-tuned\"\n", "", "s.toml: rig: name the rig"),
        ("\"servo-b-tuned\"", "\"servo-x\"", "s.toml:1: rig: there is no rig servo-x"),
        ("\"servo-b-tuned\"", "4", "s.toml:1: rig: must be a text in quotes, not a integer"),
        ("[vary]", "[varys]", "s.toml:2: varys: unknown key; did you mean vary?"),
        ("[vary]", "tolerance = 5\n[vary]", "s.toml:2: tolerance: must be between 1e-13 and 1e-2"),
        ("[vary]", "settled_mm = 0\n[vary]", "s.toml:2: settled_mm: must be more than 0"),
        ("[vary]", "vary = 3\n[x]", "s.toml:2: vary: must be a table: [vary]"),
        ("[1, 2]", "[1, 2", "s.toml:3: vary.load.mass_kg: a bracket is opened here and not closed"),
        ("load.mass_kg = [1, 2]\n", "", "s.toml: vary: nothing varies"),
        ("air = \"air_l\"\n", "", "s.toml: metrics: nothing is collected"),
    ] {
        assert!(formatted(of, with).contains(says), "{with}: {}", formatted(of, with));
    }
}

#[test]
fn what_is_wrong_with_a_setting_is_named_by_line_and_key() {
    for (with, says) in [
        (
            "[set]\nload.mass = 2\n[vary]",
            "s.toml:3: set.load.mass: there is no such key; with its unit it is mass_kg",
        ),
        ("[set.load]\nmass_kg = -2\n[vary]", "s.toml:3: set.load.mass_kg: must be between"),
        (
            "[set]\nload.static_extend_n = 1\n[vary]",
            "s.toml:2: load.coulomb_extend_n: must not be above load.static_extend_n = 1",
        ),
        (
            "[[set.faults.event]]\nkind = \"leak\"\n[vary]",
            "s.toml:2: set.faults.event: write its value after a =",
        ),
        ("[set]\nload.mass_kg = 2\n[vary]", "s.toml:5: vary.load.mass_kg: is also in [set]"),
    ] {
        assert!(formatted("[vary]", with).contains(says), "{with}: {}", formatted("[vary]", with));
    }
}

#[test]
fn what_is_wrong_with_a_key_that_varies_is_named_by_line_and_key() {
    let line = "load.mass_kg = [1, 2]";
    for (with, says) in [
        ("load.mas_kg = [1]", "load.mas_kg: the rig has no such key; did you mean load.mass_kg?"),
        ("load.mass_kg = 3", "load.mass_kg: must be a list of values, {"),
        ("load.mass_kg = []", "load.mass_kg: the list is empty"),
        ("load.mass_kg = [1, -2]", "load.mass_kg: must be between 0.001 kg and 100000 kg, is -2"),
        ("load.mass_kg = [[1]]", "load.mass_kg: [1] is not a number, word or switch"),
        (
            "load.mass_kg = { from = 1, to = 2 }",
            "load.mass_kg: a range has from, to and steps; steps is missing",
        ),
        (
            "load.mass_kg = { from = 1, to = 2, steps = 1 }",
            "load.mass_kg: steps must be a whole number from 2",
        ),
        (
            "load.mass_kg = { from = 0, to = 2, steps = 3, spacing = \"log\" }",
            "load.mass_kg: a logarithmic range needs",
        ),
        ("load.mass_kg = { from = 1, to = 2, steps = 3, spacing = \"lok\" }", "spacing must be"),
        (
            "load.mass_kg = { form = 1, to = 2, steps = 3 }",
            "load.mass_kg: unknown key form; did you mean from?",
        ),
        ("load.mass_kg = { uniform = [1, 2], steps = 3 }", "load.mass_kg: steps does not go with uniform"),
        ("load.mass_kg = { uniform = [1, 2] }", "load.mass_kg: a distribution needs a table [draw]"),
        ("load.mass_kg = { uniform = [2, 1] }", "load.mass_kg: uniform must be [low, high]"),
        ("load.mass_kg = { normal = [2, 0] }", "load.mass_kg: the standard deviation must be more than 0"),
        ("load.mass_kg = { normal = [2] }", "load.mass_kg: normal must be [mean, standard deviation]"),
        ("load.mass_kg = { from = nan, to = 2, steps = 3 }", "load.mass_kg: must be a number, not nan"),
        ("valve.model = [\"flow\"]", "valve.model: must be one of"),
        ("controller.velocity_gain = [1.5]", "controller.velocity_gain: must be a whole number"),
        ("test.moves = [1]", "test.moves: cannot be varied"),
    ] {
        let formatted = formatted(line, with);
        assert!(formatted.contains(says), "{with}: {formatted}");
        assert!(formatted.starts_with("s.toml:3: vary."), "{with}: {formatted}");
    }
}

#[test]
fn what_is_wrong_with_a_factor_or_with_two_keys_is_named_by_line_and_key() {
    let line = "load.mass_kg = [1, 2]";
    for (with, says) in [
        ("f = { values = [1], scale = [\"load.mass\"] }", "f: load.mass: the rig has no such key"),
        ("f = { values = [1], scale = [] }", "f: scale must be a list of keys of the rig"),
        (
            "f = { values = [1], scale = [\"controller.velocity_gain\"] }",
            "f: controller.velocity_gain is not a real number",
        ),
        ("f = { values = [-1], scale = [\"load.mass_kg\"] }", "f: load.mass_kg times -1: must be between"),
        ("f = { values = [\"a\"], scale = [\"load.mass_kg\"] }", "f: a factor must be a number, is a"),
        (
            "load.mass_kg = [1]\nf = { values = [1], scale = [\"load.mass_kg\"] }",
            "f: load.mass_kg is varied twice",
        ),
        (
            "load.mass_kg = { from = 1, to = 2, steps = 90000 }\nsupply.pressure_pa = { from = 4e5, to = 5e5, steps = 90000 }",
            "more than 1000000 points",
        ),
    ] {
        let formatted = formatted(line, with);
        assert!(formatted.contains(says), "{with}: {formatted}");
        assert!(formatted.starts_with("s.toml:3: vary.") || with.contains('\n'), "{with}: {formatted}");
    }
}

#[test]
fn what_is_wrong_with_metrics_and_goals_is_named_by_line_and_key() {
    let end = "air = \"air_l\"\n";
    for (with, says) in [
        ("air = \"air_m\"\n", "s.toml:5: metrics.air: there is no figure \"air_m\"; did you mean air_l?"),
        ("air = { move = 2 }\n", "s.toml:5: metrics.air: say which figure"),
        ("air = { figure = \"air_l\", move = 0 }\n", "s.toml:5: metrics.air: move must be"),
        (
            "air = { figure = \"air_l\", of = 1 }\n",
            "s.toml:5: metrics.air: unknown key of; there are figure, move",
        ),
        ("\"a,b\" = \"air_l\"\n", "s.toml:5: metrics.a,b: a name may contain only letters"),
        ("fault = \"air_l\"\n", "s.toml:5: metrics.fault: is the name of another column"),
        (
            "air = \"air_l\"\n[objective]\nminimise = \"ear\"\n",
            "s.toml:7: objective.minimise: there is no metric \"ear\"",
        ),
        ("air = \"air_l\"\n[objective]\nleast = \"air\"\n", "s.toml:7: objective.least: unknown key"),
        (
            "air = \"air_l\"\n[objective]\nminimise = \"air\"\nmaximise = \"air\"\n",
            "s.toml:8: objective.maximise: there can be only one objective",
        ),
        ("air = \"air_l\"\n[constraints]\nair = 3\n", "s.toml:7: constraints.air: must be { max"),
        ("air = \"air_l\"\n[constraints]\nair = {}\n", "s.toml:7: constraints.air: must be { max"),
        (
            "air = \"air_l\"\n[constraints]\nair = { min = 2, max = 1 }\n",
            "s.toml:7: constraints.air: min is more than max",
        ),
        (
            "air = \"air_l\"\n[constraints]\near = { min = 2 }\n",
            "s.toml:7: constraints.ear: there is no metric",
        ),
    ] {
        assert!(formatted(end, with).contains(says), "{with}: {}", formatted(end, with));
    }
}

#[test]
fn what_is_wrong_with_draws_is_named_by_line_and_key() {
    let end = "air = \"air_l\"\n";
    for (with, says) in [
        ("air = \"air_l\"\n[draw]\ncount = 3\n", "s.toml:6: draw: no key has a distribution"),
        ("air = \"air_l\"\n[draw]\nseed = 3\n", "s.toml:6: draw.count: say how many draws"),
        ("air = \"air_l\"\n[draw]\ncount = 0\n", "s.toml:7: draw.count: must be a whole number from 1"),
        (
            "air = \"air_l\"\n[draw]\nmethod = \"sobol\"\n",
            "s.toml:7: draw.method: must be \"latin-hypercube\"",
        ),
    ] {
        assert!(formatted(end, with).contains(says), "{with}: {}", formatted(end, with));
    }
}
