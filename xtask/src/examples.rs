//! The examples for readers of the libraries: what each is known to print. Other examples measure something, or make tables
//! of the documents.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

/// An example.
pub struct Example {
    /// Its crate.
    pub package: &'static str,
    /// Its name.
    pub name: &'static str,
    /// How lines of its output begin, in their order.
    prints: &'static [&'static str],
}

/// All of them.
pub const ALL: [Example; 5] = [
    Example {
        package: "pneudrive-evaluate",
        name: "simulate",
        prints: &["62.51 to 187.5", "press: settles within 0.05 mm after 0.", "converged: true"],
    },
    // (256 * error - 1000 * velocity - acceleration) / 256
    Example {
        package: "pneudrive-controller",
        name: "step_controller",
        prints: &[
            "error 1000 counts, velocity   0: demand  1000 counts",
            "error  996 counts, velocity   4: demand   980 counts",
            "error  550 counts, velocity 446: demand -1193 counts",
        ],
    },
    Example {
        package: "pneudrive-sim",
        name: "friction_model",
        prints: &[
            "from 0.05 m/s it stops after 0.001368087 s, closed form 0.001368087 s",
            "from 0.8 m/s it stops after 0.030880769 s, closed form 0.030880769 s",
        ],
    },
    Example {
        package: "pneudrive-session",
        name: "drive_a_rig",
        prints: &["the run ends Done", "2385 samples are recorded, 2385 of them as simulated"],
    },
    Example {
        package: "pneudrive-solver",
        name: "bouncing_ball",
        prints: &[
            "bounce 0: 0.451523640986 s, closed form 0.451523640986 s",
            "bounce 5: 2.880070635446 s, closed form 2.880070635446 s",
        ],
    },
];

impl Example {
    /// Runs it.
    ///
    /// # Errors
    /// When it fails, or prints something else.
    pub fn check(&self, executable: &Path) -> Result<()> {
        let output = Command::new(executable).output().context("it can't be started")?;
        let (printed, errors) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        ensure!(output.status.success(), "it ends with {}: {errors}", output.status);
        let missing = self.missing_in(&printed);
        ensure!(missing.is_none(), "no line {:?} in:\n{printed}", missing.unwrap_or_default());
        Ok(())
    }

    /// The first line that an output does not have in its place.
    fn missing_in(&self, printed: &str) -> Option<&str> {
        let mut lines = printed.lines();
        self.prints.iter().copied().find(|start| !lines.any(|line| line.starts_with(start)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_build::cargo::root;
    use std::collections::BTreeSet;
    use std::fs;

    /// What the second line of its file begins with.
    const HOW: &str = "//! Run it: cargo run -p ";

    /// The most lines of such an example.
    const LINES: usize = 30;

    #[test]
    fn an_output_has_the_lines_of_an_example_in_their_order() {
        let example = Example { package: "", name: "", prints: &["a", "b"] };
        assert_eq!(example.missing_in("a 1\nc\nb 2\n"), None);
        assert_eq!(example.missing_in("b 2\na 1\n"), Some("b"));
        assert_eq!(example.missing_in(""), Some("a"));
    }

    #[test]
    fn every_example_that_says_how_to_run_it_is_short_and_run() {
        let map = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("a map");
        let folders = map.lines().filter_map(|line| line.split_once(' ').map(|(folder, _)| folder));
        let folders: BTreeSet<&str> = folders.collect();
        let examples =
            folders.iter().filter_map(|folder| fs::read_dir(root().join(folder).join("examples")).ok());
        let mut found = 0;
        for file in examples.flatten().filter_map(|entry| Some(entry.ok()?.path())) {
            let Ok(text) = fs::read_to_string(&file) else { continue };
            let Some(call) = text.lines().nth(1).and_then(|line| line.strip_prefix(HOW)) else { continue };
            let is = |one: &&Example| call.starts_with(&format!("{} --example {}", one.package, one.name));
            assert!(ALL.iter().any(|one| is(&one)), "{} is not run", file.display());
            assert!(text.lines().count() <= LINES, "{} has more than {LINES} lines", file.display());
            found += 1;
        }
        assert_eq!(found, ALL.len());
    }

    #[test]
    fn the_table_of_the_documents_has_every_example() {
        let map = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("a document");
        for Example { package, name, .. } in &ALL {
            let call = format!("| `cargo run -p {package} --example {name}` |");
            assert!(map.contains(&call), "{call} is not in it");
        }
    }
}
