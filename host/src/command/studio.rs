//! `pneudrive studio`.

use anyhow::Result;
use pneudrive_link::client::token;
use pneudrive_studio::token::Token;
use pneudrive_studio::{Opened, Options, Studio as Server};

use super::rig_source::rig_text;
use crate::cli::Studio;
use crate::output::{self, Stream};

pub(super) fn execute(arguments: &Studio) -> Result<()> {
    let (name, text) = rig_text(&arguments.rig)?;
    let token = token()?.as_deref().map(Token::new).transpose()?;
    let is_given = token.is_some();
    let studio = Server::open(Options {
        listen: arguments.listen.clone(),
        token,
        opened: Opened { name, text },
        port: arguments.port.clone(),
    })?;
    say!("{}", studio.address());
    // Without this line nobody can find the page.
    if let Some(error) = Stream::Output.failure() {
        return Err(output::verdict().error(format!("nobody learns the address of the studio: {error}")));
    }
    if is_given {
        say!("whoever has this address may use the studio; it travels in the clear");
    }
    say!("open it in a browser    (end with Ctrl-C)");
    studio.serve()
}
