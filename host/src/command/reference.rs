//! `pneudrive man --markdown`: the reference of the book, from the code itself. The book puts each page behind the page of
//! docs/reference with its name.

use clap::Command;
use pneudrive_sim::key::{Kind, Tables};
use pneudrive_sim::rig::{Key, all_keys, preset_in_words, range_in_words, thesis};

use crate::json::fields;

/// The pages: name of the file, and its text.
pub(super) fn pages(whole: &Command) -> [(&'static str, String); 4] {
    [
        ("commands.md", commands(whole, "pneudrive", 2)),
        ("keys.md", keys()),
        ("json.md", fields::page()),
        ("thesis-names.md", format!("## By number\n\n{}", thesis::table())),
    ]
}

/// The commands below one, each with its help as the program prints it.
fn commands(above: &Command, typed: &str, level: usize) -> String {
    let of = |command: &Command| {
        let typed = format!("{typed} {}", command.get_name());
        let help = command.clone().render_long_help().to_string();
        let heading = "#".repeat(level);
        let below = commands(command, &typed, level + 1);
        format!("{heading} {typed}\n\n```text\n{}\n```\n\n{below}", help.trim_end())
    };
    above.get_subcommands().filter(|command| !command.is_hide_set()).map(of).collect()
}

/// The keys of a rig file, a section for each table, and for each list of tables.
fn keys() -> String {
    let mut tables: Vec<&str> = Vec::new();
    for key in all_keys() {
        if !tables.contains(&key.table()) {
            tables.push(key.table());
        }
    }
    let section = |table: &str| {
        let heading = if table.is_empty() { "Without a table".to_owned() } else { format!("`[{table}]`") };
        let rows: String =
            all_keys().filter(|key| key.table() == table).map(|key| row(key.name(), key)).collect();
        format!("## {heading}\n\n{HEAD}{rows}\n")
    };
    let of_entries = |list: &Tables| {
        let inside =
            |key: &Key| key.path.strip_prefix(list.path).map(|name| row(name.trim_start_matches('.'), key));
        let rows: String = list.fields.iter().filter_map(inside).collect();
        format!("## `[[{}]]`\n\n{HEAD}{rows}\n", list.path)
    };
    let lists =
        all_keys().filter_map(|key| if let Kind::Tables(list) = key.kind { Some(list) } else { None });
    tables.into_iter().map(section).chain(lists.map(of_entries)).collect()
}

const HEAD: &str = "| key | range | default | in the thesis | meaning |\n|---|---|---|---|---|\n";

fn row(name: &str, key: &Key) -> String {
    let range = [range_in_words(&key.kind).as_str(), key.unit()].join(" ");
    let cells = [range.trim(), &preset_in_words(&key.preset), key.thesis, key.meaning];
    let cells = cells.map(|cell| cell.replace('|', "\\|"));
    format!("| `{name}` | {} |\n", cells.join(" | "))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::command::whole_command;

    fn built() -> Command {
        let mut whole = whole_command().disable_help_subcommand(true);
        whole.build();
        whole
    }

    #[test]
    fn every_command_has_a_section_with_its_help() {
        let [(_, page), ..] = pages(&built());
        for command in built().get_subcommands() {
            let section = page.split(&format!("## pneudrive {}\n", command.get_name())).nth(1);
            assert!(section.is_some_and(|text| text.contains("Usage: ")), "{}", command.get_name());
        }
        assert!(page.contains("\n#### pneudrive device valve seek-null\n"), "those below, too");
    }

    #[test]
    fn every_key_has_a_row_in_the_section_of_its_table() {
        let [_, (_, page), ..] = pages(&built());
        for key in all_keys() {
            let table = if key.table().is_empty() {
                "Without a table".to_owned()
            } else {
                format!("`[{}]`", key.table())
            };
            let mut sections = page.split("## ").filter(|section| section.starts_with(&table));
            let (section, again) = (sections.next().expect("a section"), sections.next());
            assert!(again.is_none() && section.contains(&format!("| `{}` |", key.name())), "{}", key.path);
        }
        let entries = page.split("## `[[faults.event]]`").nth(1).expect("a section");
        assert!(entries.contains("| `kind` |") && entries.contains("| `at_s` |"), "{entries:.300}");
        let columns: BTreeSet<usize> = page
            .lines()
            .filter(|line| line.starts_with('|'))
            .map(|line| line.replace("\\|", "").matches('|').count())
            .collect();
        assert_eq!(columns, BTreeSet::from([6]), "each row has five cells");
    }
}
