//! The program in a shell: completions, manual pages, `--version`, and the commands that the documents show.

use std::fs;
#[cfg(unix)]
use std::process::Command;

use clap::CommandFactory;
use pneudrive::cli::Cli;
use pneudrive::command::whole_command;
use pneudrive_protocol::VERSION;
use pneudrive_sim::rigfile::BUILTIN;

use crate::program::{folder, ok, transcript};

/// All subcommands as they are typed, such as "device config get".
fn all_commands() -> Vec<String> {
    fn below(command: &clap::Command, before: &str, all: &mut Vec<String>) {
        for subcommand in command.get_subcommands() {
            let typed = format!("{before}{}", subcommand.get_name());
            all.push(typed.clone());
            below(subcommand, &format!("{typed} "), all);
        }
    }
    let mut all = Vec::new();
    below(&Cli::command(), "", &mut all);
    all
}

/// What bash offers behind these words.
#[cfg(unix)]
fn bash_offers(words: &[&str]) -> Vec<String> {
    let folder = folder();
    let script = ok(folder.path(), "completions bash");
    fs::write(folder.path().join("completions"), script).expect("written");
    let typed = format!(
        "source ./completions; COMP_WORDS=({}); COMP_CWORD={}; _pneudrive pneudrive '{}' '{}'; \
         printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        words.join(" "),
        words.len() - 1,
        words[words.len() - 1],
        words[words.len() - 2]
    );
    let output = Command::new("bash").args(["-c", &typed]).current_dir(folder.path()).output().expect("bash");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8").lines().map(str::to_owned).collect()
}

#[cfg(unix)]
#[test]
fn bash_completes_commands_options_and_values() {
    assert_eq!(bash_offers(&["pneudrive", "simu"]), ["simulate"]);
    assert_eq!(bash_offers(&["pneudrive", "device", "config", "ex"]), ["export"]);
    assert_eq!(bash_offers(&["pneudrive", "simulate", "--no-r"]), ["--no-report"]);
    assert_eq!(bash_offers(&["pneudrive", "simulate", "--method", "m"]), ["merson"]);
    assert_eq!(bash_offers(&["pneudrive", "spectrum", "run", "pressure"]), ["pressure-1", "pressure-2"]);
}

#[test]
fn no_help_shows_the_backslash_of_its_source() {
    for command in all_commands() {
        let printed = transcript(folder().path(), &format!("{command} --help"));
        assert!(!printed.contains('\\'), "{command}: {printed}");
    }
}

#[test]
fn every_shell_has_completions_with_every_command() {
    let folder = folder();
    for (shell, begins) in [
        ("bash", "_pneudrive()"),
        ("zsh", "#compdef pneudrive"),
        ("fish", "# Print"),
        ("elvish", ""),
        ("powershell", ""),
    ] {
        let script = ok(folder.path(), &format!("completions {shell}"));
        assert!(script.starts_with(begins), "{shell}: {script:.80}");
        for command in all_commands() {
            let last = command.rsplit(' ').next().expect("a word");
            assert!(script.contains(last), "{shell}: {command}");
        }
    }
    assert!(transcript(folder.path(), "completions tcsh").ends_with("= 2"));
}

#[test]
fn every_command_has_a_manual_page_with_its_options() {
    let folder = folder();
    let printed = ok(folder.path(), "man --out man1");
    let all = all_commands();
    assert_eq!(printed, format!("man1: {} pages, from pneudrive.1 on\n", all.len() + 1));
    for command in &all {
        let name = format!("pneudrive-{}", command.replace(' ', "-"));
        let page = fs::read_to_string(folder.path().join(format!("man1/{name}.1"))).expect("a page");
        assert!(page.contains(&format!(".TH {name} 1")), "{page:.300}");
        assert!(page.contains(".SH SYNOPSIS"), "{name}");
    }
    let simulate = fs::read_to_string(folder.path().join("man1/pneudrive-simulate.1")).expect("a page");
    assert!(simulate.contains("\\-\\-ensemble") && simulate.contains("Total number of runs"), "{simulate}");
    ok(folder.path(), "man --out man1");
    fs::write(folder.path().join("man1/pneudrive-run.1"), "mine").expect("written");
    let refused = transcript(folder.path(), "man --out man1");
    assert!(refused.contains("was not written by this program") && refused.ends_with("= 1"), "{refused}");
}

#[test]
fn the_version_tells_what_the_program_understands() {
    let folder = folder();
    let printed = ok(folder.path(), "--version");
    let line = |name: &str| {
        let line = printed.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("{name}: {printed}")).trim()
    };
    assert_eq!(printed.lines().next(), Some(concat!("pneudrive ", env!("CARGO_PKG_VERSION"))));
    assert_eq!(line("protocol"), VERSION.to_string());
    assert!(
        line("files")
            .starts_with("pneudrive-target 1, pneudrive-stream 1, pneudrive-run 1, pneudrive-sweep 1")
    );
    let rigs: Vec<&str> = line("rigs").split(", ").collect();
    assert_eq!(rigs, BUILTIN.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    assert_eq!(line("parquet").starts_with("yes"), cfg!(feature = "parquet"));
    assert!(line("processor").starts_with(std::env::consts::ARCH));
    assert_eq!(ok(folder.path(), "-V"), concat!("pneudrive ", env!("CARGO_PKG_VERSION"), "\n"));
}

/// The documents that show commands.
const PAGES: [&str; 15] = [
    include_str!("../../README.md"),
    include_str!("../../docs/howto/bring-up.md"),
    include_str!("../../docs/reference/commands.md"),
    include_str!("../../docs/tutorial/first-drive.md"),
    include_str!("../../docs/tutorial/first-hour.md"),
    include_str!("../../docs/howto/troubleshooting.md"),
    include_str!("../../docs/howto/fmu.md"),
    include_str!("../../docs/howto/identification.md"),
    include_str!("../../docs/reference/json.md"),
    include_str!("../../docs/howto/logs.md"),
    include_str!("../../docs/howto/own-drive.md"),
    include_str!("../../docs/howto/profiles.md"),
    include_str!("../../docs/howto/studio.md"),
    include_str!("../../docs/explanation/thesis.md"),
    include_str!("../../docs/howto/without-a-pc.md"),
];

/// The words of a command line as a shell takes them, up to a comment or a pipe.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None);
    for one in line.chars().chain([' ']) {
        match (quote, one) {
            (Some(open), _) if open == one => quote = None,
            (None, '"' | '\'') => quote = Some(one),
            (None, ' ') if !word.is_empty() => words.push(std::mem::take(&mut word)),
            (None, ' ') => {}
            _ => word.push(one),
        }
    }
    words.into_iter().take_while(|word| word != "#" && word != "|").collect()
}

#[test]
fn every_command_that_a_document_shows_is_accepted() {
    let mut count = 0;
    for page in PAGES {
        let page = page.replace("\\\n", " ");
        let fenced = page.split("```").skip(1).step_by(2).flat_map(str::lines);
        let typed = fenced.filter_map(|line| {
            line.strip_prefix("pneudrive ").or_else(|| line.strip_prefix("cargo run --release -- "))
        });
        for line in typed {
            let arguments = ["pneudrive".to_owned()].into_iter().chain(words(line));
            let parsed = whole_command().try_get_matches_from(arguments);
            assert!(parsed.is_ok(), "{line}: {}", parsed.expect_err("refused"));
            count += 1;
        }
    }
    assert!(count > 50, "{count} commands were looked at");
}

/// docs/DESIGN.md, section 5: the words that choose a model, beside the flags of the thesis.
#[test]
fn the_design_has_the_words_of_every_model() {
    let folder = folder();
    let page = include_str!("../../docs/DESIGN.md");
    let table = page.split("| key | words").nth(1).expect("the table of models");
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let rows: Vec<Vec<&str>> = rows.map(|row| row.split('`').skip(1).step_by(2).collect()).collect();
    assert!(rows.len() >= 9, "{rows:?}");
    for row in rows {
        let explained = ok(folder.path(), &format!("rig explain {}", row[0]));
        let range = explained.lines().find_map(|line| line.trim().strip_prefix("range ")).expect("words");
        let words: Vec<&str> = range.split(',').filter_map(|word| word.split_whitespace().next()).collect();
        assert_eq!(row[1..], words, "{}", row[0]);
    }
}
