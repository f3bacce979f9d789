//! documentation/index.html (FMI 3.0, 2.5.1.1; FMI 2.0, 2.3): what the variables of an FMU are.

use std::fmt::Write;

use pneudrive_sim::Rig;

use crate::description::{about, escaped};
use crate::part::Part;
use crate::variable::{Role, Variable, variables};

/// The head of the page, up to the name of the rig.
const HEAD: &str = "<!DOCTYPE html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<title>FMU of pneudrive</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 64rem; padding: 0 1rem }
table { border-collapse: collapse; width: 100% }
td, th { border-bottom: 1px solid #ccc; padding: .3rem .6rem; text-align: left; vertical-align: top }
</style>
</head>
<body>
";

/// How a part is used, in sentences.
fn use_of(part: Part) -> &'static str {
    match part {
        Part::Plant => {
            "In a loop, step the controller first, give its command to this FMU, and step this FMU then."
        }
        Part::Controller => {
            "In a loop, give the readings of the plant to this FMU, step it, and give its command to the plant, which steps next."
        }
        Part::Drive => {
            "Set run_test, and it runs the moves of the rig's test; otherwise it follows its setpoint."
        }
    }
}

/// The page of a part of a rig.
#[must_use]
pub fn documentation(part: Part, rig: &Rig) -> String {
    let mut page = HEAD.to_owned();
    let (name, what) = (escaped(rig.name()), about(part));
    let period = f64::from(rig.period_us().get()) / 1e3;
    let _ = writeln!(page, "<h1>{name}: {}</h1>\n<p>{what}.", part.word());
    let _ = writeln!(
        page,
        "The sample period is {period} ms; between two samples its outputs hold. {}</p>",
        use_of(part)
    );
    let all = variables(part, rig);
    let mut table = |heading: &str, is: fn(&Variable) -> bool| {
        let _ = writeln!(page, "<h2>{heading}</h2>\n<table>\n<tr><th>name<th>unit<th>start<th>meaning");
        all.iter().filter(|one| is(one)).for_each(|one| page += &row(one));
        page += "</table>\n";
    };
    table("Inputs", |one| matches!(one.role, Role::Input(_)));
    table("Outputs", |one| matches!(one.role, Role::Output(_)));
    table("Parameters", Variable::is_parameter);
    let _ = writeln!(
        page,
        "<p>Made by pneudrive {}, under the MIT licence or the Apache licence 2.0, as you choose.</p>\n</body>\n</html>",
        env!("CARGO_PKG_VERSION")
    );
    page
}

fn row(variable: &Variable) -> String {
    let start = variable.start.map_or_else(String::new, |start| start.to_string());
    let tunable = if variable.is_tunable() { " May change while it runs." } else { "" };
    format!(
        "<tr><td><code>{}</code><td>{}<td>{start}<td>{}{tunable}\n",
        variable.name,
        escaped(variable.unit()),
        escaped(variable.meaning)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_each_variable_with_its_unit_and_says_which_may_change() {
        let rig = Rig::builtin("servo-b-tuned").expect("built in");
        let page = documentation(Part::Drive, &rig);
        for variable in variables(Part::Drive, &rig).iter().skip(1) {
            let row = format!("<tr><td><code>{}</code><td>{}<td>", variable.name, escaped(variable.unit()));
            assert_eq!(page.matches(&row).count(), 1, "{row}");
        }
        let line =
            |name: &str| page.lines().find(|line| line.contains(&format!("<code>{name}<"))).expect("a row");
        assert!(line("load.mass_kg").ends_with("May change while it runs."));
        assert!(!line("actuator.bore_m").contains("May change"));
    }
}
