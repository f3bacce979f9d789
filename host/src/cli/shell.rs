//! Arguments of the commands that fit the program into a shell.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

/// Arguments of `completions`.
#[derive(Debug, Args)]
#[command(after_help = "\
Where a shell looks for it:

  mkdir -p ~/.local/share/bash-completion/completions ~/.zfunc ~/.config/fish/completions
  pneudrive completions bash > ~/.local/share/bash-completion/completions/pneudrive
  pneudrive completions zsh > ~/.zfunc/_pneudrive      (with fpath+=~/.zfunc before compinit)
  pneudrive completions fish > ~/.config/fish/completions/pneudrive.fish")]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
#[command(after_help = "\
A folder that man looks at, if ~/.local/bin is on the path:

  pneudrive man --out ~/.local/share/man/man1
  man pneudrive-simulate")]
pub struct Man {
    /// Folder for pneudrive.1, pneudrive-simulate.1 and so on
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Write the reference of the book instead: commands, fields of `--json`, keys of a rig file and names of the thesis, as Markdown
    #[arg(long)]
    pub markdown: bool,
}
