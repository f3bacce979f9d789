//! Arguments of `rig new`: an option for each question.

use std::path::PathBuf;

use clap::error::{Error, ErrorKind};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use pneudrive_design::question::{Answers, QUESTIONS};

/// Arguments of `rig new`.
#[derive(Debug, Args)]
pub struct NewRig {
    /// The rig file to write; the rig is named after it
    #[arg(default_value = "own.toml")]
    pub file: PathBuf,
    /// Questions that are answered here are not asked
    #[command(flatten)]
    pub answers: AnswerOptions,
    /// Ask nothing; values that are not given become typical or unknown, and are marked as such
    #[arg(long)]
    pub no_questions: bool,
    /// Overwrite an existing file
    #[arg(long)]
    pub overwrite: bool,
    /// Then find the gains of the gain profile over stroke, load and friction, and write tuned.toml and tune.html to this
    /// folder; `pneudrive tune` has more options
    #[arg(long, value_name = "DIR")]
    pub tune: Option<PathBuf>,
    /// Number of generations of that search; 0: only judge the gains to begin with
    #[arg(long, value_name = "N", default_value_t = 10, requires = "tune")]
    pub generations: u16,
}

/// Answers from the command line.
#[derive(Clone, Debug, Default)]
pub struct AnswerOptions(pub Answers);

impl FromArgMatches for AnswerOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut options = AnswerOptions::default();
        options.update_from_arg_matches(matches)?;
        Ok(options)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        for question in QUESTIONS {
            if let Some(text) = matches.get_one::<String>(question.name) {
                if text.trim().is_empty() {
                    let message = format!("--{} is empty\n", question.name);
                    return Err(Error::raw(ErrorKind::InvalidValue, message));
                }
                self.0.answer(question, text);
            }
        }
        Ok(())
    }
}

impl Args for AnswerOptions {
    fn augment_args(command: Command) -> Command {
        QUESTIONS.iter().fold(command, |command, question| {
            let without = match question.without {
                "" => "needed".to_owned(),
                without => format!("without it: {without}"),
            };
            let help = format!("{}, such as \"{}\" [{without}]", question.prompt, question.example);
            let option = Arg::new(question.name).long(question.name).value_name("VALUE").help(help);
            command.arg(option.allow_hyphen_values(true).help_heading("Answers"))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}
