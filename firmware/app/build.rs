//! The build id: which sources an image was made of, for `device info` and TARGET files.

use std::process::Command;

fn main() {
    let commit = output_of("git", &["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]);
    let version = std::env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let id = commit.map_or(version.clone(), |commit| format!("{version}+{commit}"));
    println!("cargo:rustc-env=PNEUDRIVE_BUILD={id}");
    if let Some(commits) = output_of("git", &["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo:rerun-if-changed={commits}");
    }
    println!("cargo:rerun-if-changed=build.rs");
}

/// The first line that a program prints; None without the program, or outside of a repository.
fn output_of(program: &str, arguments: &[&str]) -> Option<String> {
    let output =
        Command::new(program).args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.lines().next().map(str::to_owned).filter(|line| !line.is_empty())
}
