//! `cargo xtask`: the commands of developers and CI.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use xtask::deny;
use xtask::dist;
use xtask::link;
use xtask::steps::{self, Group};
use xtask::tally::Tally;

/// The commands of developers and CI. At the end, they report every failure, then how many checks passed and failed.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Everything that CI runs: formatting, lint, every group of tests, the images of the boards, licences, documentation
    Ci,
    /// The tests on the PC and in the emulator; or one group of tests that needs more tools, which it installs, or more time
    Test {
        /// This group alone
        group: Option<Group>,
    },
    /// Format all workspaces
    Fmt {
        /// Only list the files that are not formatted
        #[arg(long)]
        check: bool,
    },
    /// Clippy on the root workspace and the images, warnings as errors
    Lint,
    /// Build the documentation, warnings as errors
    Docs,
    /// Check licences and sources of other people's code against deny.toml; advisories by cargo-deny, where it is
    /// installed and reaches their database
    Deny,
    /// Build the image that links the controller; no panic, no float, no division routine may be in it
    Probe,
    /// Make the folder of the studio's page that needs no server: the designer as WebAssembly, in the reader's browser
    Web {
        /// The folder [default: target/web]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Make the book: the documents and the reference, as a folder of pages. Builds mdBook
    Book {
        /// The folder [default: target/book]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Make a release of the last commit: crates, wheel, images of the boards, bills of materials, notices and sums. Builds
    /// cargo-about and cargo-cyclonedx, and installs maturin and zig
    Dist {
        /// The folder [default: target/dist]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Make all of it twice, and compare the bytes
        #[arg(long)]
        twice: bool,
        /// Before: date the changelog, and commit that. After: tag the commit as vVERSION
        #[arg(long)]
        tag: bool,
    },
    /// Serve the emulated board at a port, with the plant of a rig beside it, for `pneudrive ... --port tcp://HOST:PORT`:
    /// the firmware's image on a Cortex-M4 in QEMU, in real time, until Ctrl-C
    Board {
        /// A built-in rig or a rig file: its plant, its parameters
        rig: String,
        /// The address
        #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:4000")]
        listen: String,
    },
    /// Run the test bodies on the board that PNEUDRIVE_BOARD names (hil-tests/src/board.rs)
    Hil {
        /// Only bodies with one of these words in their name
        bodies: Vec<String>,
    },
    /// Every test body, deadlines and hazards on the image that is flashed, executed with models of its peripherals
    Flashed {
        /// Write the table of docs/explanation/hazards.md anew
        #[arg(long)]
        write: bool,
    },
    /// Ten minutes of drive time in the emulator, compared with the simulation sample by sample
    Soak {
        /// Seconds of drive time
        #[arg(default_value_t = 600)]
        seconds: u32,
    },
    /// Change one rounding in a copy of the sources: the test that the execution levels are equal must fail
    ProveRounding,
    /// Measure the instructions of the control in the emulator, read flash, memory and stack from the images, and
    /// write the tables of docs/reference/firmware-figures.md anew
    Figures,
    /// Count what the simulator's runs cost, in evaluations and in instructions, and write the tables of docs/reference/counts.md
    /// anew
    Cost,
    /// Run the simulator on emulated processors without AVX, where the results must be the same bits: installs qemu-user
    Processors,
    /// Replace the golden hashes of results that have changed (hil-tests/golden.toml)
    Bless {
        /// Words of the line of CHANGELOG.md that says why
        #[arg(long)]
        cause: String,
    },
    /// Reproduce the whole thesis and compare its numbers with host/tests/thesis.toml; CI does so with chapter 7
    Thesis {
        /// Write the file anew
        #[arg(long)]
        write: bool,
    },
    /// 100,000 downloads over a faulty line, and 1,000 kills of either side of a record
    SoakLink,
    /// All states of two hosts, a rig and their lines, within wider bounds than the tests have
    LinkStates,
}

fn main() -> ExitCode {
    let mut tally = Tally::default();
    match Arguments::parse().command {
        Command::Ci => steps::ci(&mut tally),
        Command::Test { group: None } => steps::test(&mut tally),
        Command::Test { group: Some(group) } => steps::test_group(&mut tally, group),
        Command::Fmt { check } => steps::fmt(&mut tally, check),
        Command::Lint => steps::lint(&mut tally),
        Command::Docs => steps::docs(&mut tally),
        Command::Deny => deny::check(&mut tally),
        Command::Probe => steps::probe(&mut tally),
        Command::Web { out } => steps::web(&mut tally, out),
        Command::Book { out } => steps::book(&mut tally, out),
        Command::Dist { out, twice, tag } => dist::make(&mut tally, out, dist::Extras { twice, tag }),
        Command::Board { rig, listen } => steps::board(&mut tally, &rig, &listen),
        Command::Hil { bodies } => steps::hil(&mut tally, &bodies),
        Command::Flashed { write } => steps::flashed(&mut tally, write),
        Command::Soak { seconds } => steps::soak(&mut tally, seconds),
        Command::ProveRounding => steps::prove_rounding(&mut tally),
        Command::Figures => steps::figures(&mut tally),
        Command::Cost => steps::cost(&mut tally),
        Command::Processors => steps::processors(&mut tally),
        Command::Bless { cause } => steps::bless(&mut tally, &cause),
        Command::LinkStates => link::states(&mut tally),
        Command::Thesis { write } => steps::thesis(&mut tally, write),
        Command::SoakLink => link::soak(&mut tally),
    }
    tally.report()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::Arguments;

    #[test]
    fn the_guide_names_only_commands_that_there_are() {
        let known = Arguments::command();
        for page in [
            "README.md",
            "ARCHITECTURE.md",
            "CONTRIBUTING.md",
            "docs/explanation/trust.md",
            "docs/reference/link.md",
        ] {
            let text = std::fs::read_to_string(pneudrive_build::cargo::root().join(page)).expect(page);
            let words = text.split("cargo xtask").skip(1).filter_map(|rest| rest.split_whitespace().next());
            for word in words.map(|word| word.trim_end_matches(|one: char| !one.is_alphanumeric())) {
                let name = word.split('`').next().unwrap_or_default();
                assert!(
                    name == "help" || known.find_subcommand(name).is_some(),
                    "{page}: cargo xtask {name}"
                );
            }
        }
    }
}
