//! `pneudrive virtual`.

use std::sync::atomic::AtomicBool;

use anyhow::{Context, Result};
use pneudrive_link::client::token;
use pneudrive_rigs::virtual_rig::{Listener, Pace, Token, VirtualRig};
use pneudrive_sim::keys;

use super::rig_source::load_choice;
use crate::cli::Virtual;
use crate::output::{self, Stream};

pub(super) fn execute(arguments: &Virtual) -> Result<()> {
    let nominal = load_choice(&arguments.rig)?;
    let rig = match arguments.spread {
        Some(fraction) => nominal.spread(fraction, arguments.seed)?,
        None => nominal,
    };
    let token = token()?.as_deref().map(Token::new).transpose().context("PNEUDRIVE_TOKEN")?;
    let mut listener = Listener::open_with(&arguments.listen, token)?;
    let port = listener.port_name().to_owned();
    let (name, noise) = (rig.name().to_owned(), rig.get(&keys::sensors::NOISE_COUNTS));
    let pace = Pace { fast: arguments.fast, live: arguments.live };
    let mut virtual_rig = VirtualRig::wired(rig, arguments.seed, pace, &arguments.wiring)?;
    if arguments.hand {
        virtual_rig.wiring().push_again_and_again();
    }
    say!("{name} is on {port}");
    // Without this line nobody can find the rig. Its reader may leave afterwards: the rig stays.
    if let Some(error) = Stream::Output.failure() {
        return Err(output::verdict().error(format!("the port of the rig cannot be printed: {error}")));
    }
    if listener.asks_for_a_token() {
        say!("it obeys programs that have the same PNEUDRIVE_TOKEN; the token is sent unencrypted");
    }
    if noise > 0.0 && arguments.live {
        say!("the sensor noise of {noise} counts never pauses, so no run of a live rig can be repeated");
    } else if noise > 0.0 {
        let seed = arguments.seed;
        say!("every run has its own sensor noise of {noise} counts; --seed {seed} repeats the sequence");
        virtual_rig.on_run(move |run| say!("run {run} begins, with noise {run} of seed {seed}"));
    }
    say!("try: pneudrive device --port {port} info    (end with Ctrl-C)");
    virtual_rig.serve(&mut listener, &AtomicBool::new(false))
}
