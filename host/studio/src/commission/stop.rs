//! A stop of a drive that no page commands, on a thread of its own.

use std::sync::mpsc::{Receiver, Sender, channel};

use pneudrive_link::client::Client;
use tokio::sync::oneshot;

/// Where it is told that the drive was stopped, or why not.
type Waiting = oneshot::Sender<Result<(), String>>;

/// The thread that stops the drive, and does nothing else. It ends with this.
#[derive(Debug)]
pub struct Stopper {
    asked: Sender<Waiting>,
}

impl Stopper {
    /// For the drive at a port.
    #[must_use]
    pub fn at(port: String) -> Stopper {
        let (asked, waiting) = channel();
        std::thread::spawn(move || serve(&port, &waiting));
        Stopper { asked }
    }

    /// Stops the drive. Those who ask while it is tried wait for the next try, all for the same one.
    ///
    /// # Errors
    /// When it cannot be stopped: with the reason.
    pub async fn stop(&self) -> Result<(), String> {
        let (waiting, told) = oneshot::channel();
        let failed = || "the studio has failed; stop the drive by its hardware".to_owned();
        self.asked.send(waiting).map_err(|_| failed())?;
        told.await.unwrap_or_else(|_| Err(failed()))
    }
}

fn serve(port: &str, waiting: &Receiver<Waiting>) {
    for first in waiting {
        let others: Vec<Waiting> = waiting.try_iter().collect();
        let stopped = Client::connect(port).and_then(|mut client| client.stop());
        let told = stopped.map_err(|error| format!("{error:#}"));
        for one in std::iter::once(first).chain(others) {
            // Who has gone meanwhile hears nothing.
            let _ = one.send(told.clone());
        }
    }
}
