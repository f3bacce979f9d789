//! What the help shows as an example works as it is printed.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::program::{exists, folder, ok};

/// The lines of a help that are set in, from one that begins so to the next that is neither set in nor empty.
fn example(help: &str, begins: &str) -> String {
    let lines = help.lines().skip_while(|line| !line.trim_start().starts_with(begins));
    let shown = lines.take_while(|line| line.is_empty() || line.starts_with("  "));
    shown.fold(String::new(), |text, line| text + line.trim_start() + "\n")
}

/// Has a shell carry out the lines of a help that are commands of the program, at home in an empty folder.
#[cfg(unix)]
fn type_commands(help: &str, home: &Path) {
    let program = Path::new(env!("CARGO_BIN_EXE_pneudrive")).parent().expect("a folder");
    let path = format!("{}:{}", program.display(), std::env::var("PATH").expect("a path"));
    for line in help.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| line.contains(" ~")) {
        let typed = line.split("  (").next().expect("a command");
        let mut shell = std::process::Command::new("sh");
        let status =
            shell.args(["-ec", typed]).env("HOME", home).env("PATH", &path).status().expect("a shell");
        assert!(status.success(), "{typed}");
    }
}

#[cfg(unix)]
#[test]
fn the_help_of_completions_puts_them_into_a_new_home() {
    let home = folder();
    type_commands(&ok(home.path(), "completions --help"), home.path());
    let places = [
        ".local/share/bash-completion/completions/pneudrive",
        ".zfunc/_pneudrive",
        ".config/fish/completions/pneudrive.fish",
    ];
    exists(home.path(), &places);
}

#[cfg(unix)]
#[test]
fn the_help_of_man_puts_the_pages_where_man_looks() {
    let home = folder();
    type_commands(&ok(home.path(), "man --help"), home.path());
    exists(home.path(), &[".local/share/man/man1/pneudrive-simulate.1"]);
}

#[test]
fn the_help_of_a_sweep_shows_a_file_that_runs() {
    let folder = folder();
    let file = example(&ok(folder.path(), "sweep --help"), "rig = ");
    fs::write(folder.path().join("mass.toml"), &file).expect("written");
    let printed = ok(folder.path(), "sweep mass.toml");
    assert!(printed.contains("3 points"), "{printed}");
    exists(folder.path(), &["mass/sweep.csv", "mass/sweep.html"]);
}

#[test]
fn the_help_of_an_import_shows_a_map_that_reads_a_log() {
    let folder = folder();
    let map = example(&ok(folder.path(), "import --help"), "[time]");
    fs::write(folder.path().join("map.toml"), &map).expect("written");
    let mut log = String::from("t,x,p1,u\n");
    for k in 0..200 {
        let _ = writeln!(log, "{k},{},4.5,{}", f64::from(k) / 10.0, 5.0 + f64::from(k) / 100.0);
    }
    fs::write(folder.path().join("log.csv"), log).expect("written");
    ok(folder.path(), "import log.csv press --columns map.toml");
    exists(folder.path(), &["TARGET01.DAT"]);
}
