//! A stop of a drive that no page commands, on a thread of its own.

use std::sync::mpsc::{Receiver, Sender, channel};

use pneudrive_link::client::Client;
use tokio::sync::oneshot;

/// Receives that the drive was stopped, or why not.
type Waiting = oneshot::Sender<Result<(), String>>;

/// The thread that only stops the drive. It ends when this is dropped.
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

    /// Stops the drive. Requests that arrive during a try wait for the next try, which answers all of them.
    ///
    /// # Errors
    /// The reason why it cannot be stopped.
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
            // A request whose sender has gone gets no answer.
            let _ = one.send(told.clone());
        }
    }
}
