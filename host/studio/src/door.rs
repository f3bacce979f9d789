//! Which connections may stay. Connections without the token never crowd out one with it: a page, and a stop, get
//! through however many there are.
//!
//! | connection | may stay | at most |
//! |---|---|---|
//! | without the token | [`STRANGER_WAIT`]; the oldest leaves for a new one after [`HURRY`] | [`MAX_STRANGERS`] |
//! | with the token | as long as it likes; beyond the limit the one that was silent longest leaves for a new one, but never one on which a page follows the drive or a study | [`MAX_KNOWN`] |

use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::{Extension, Router};
use futures_util::future::select;
use hyper::server::conn::http1;
use hyper_util::rt::TokioIo;
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Notify;
use tokio::time::{sleep, timeout};

/// Time within which a connection must show the token. The files of the page need none.
pub const STRANGER_WAIT: Duration = Duration::from_secs(10);

/// Time that a connection has to show the token while others wait for its place.
pub const HURRY: Duration = Duration::from_millis(100);

/// Most connections without the token.
pub const MAX_STRANGERS: usize = 64;

/// Most connections with the token; a page has six.
pub const MAX_KNOWN: usize = 96;

/// Time between two looks for a free place.
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// Requests whose answer a page keeps reading.
const STAYS: [&str; 2] = ["/api/drive", "/api/study"];

/// One connection.
#[derive(Debug)]
pub struct Guest {
    came: Instant,
    heard: Mutex<Instant>,
    is_known: AtomicBool,
    stays: AtomicBool,
    leave: Notify,
}

impl Guest {
    fn new() -> Guest {
        let now = Instant::now();
        let (is_known, stays) = (AtomicBool::new(false), AtomicBool::new(false));
        Guest { came: now, heard: Mutex::new(now), is_known, stays, leave: Notify::new() }
    }

    /// It has shown the token with a request for this path.
    pub fn shows_token(&self, path: &str) {
        *self.heard.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
        self.stays.store(STAYS.contains(&path), Ordering::Relaxed);
        self.is_known.store(true, Ordering::Relaxed);
    }

    fn is_known(&self) -> bool {
        self.is_known.load(Ordering::Relaxed)
    }

    fn heard(&self) -> Instant {
        *self.heard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until it has to leave.
    async fn has_to_leave(&self) {
        let told = timeout(STRANGER_WAIT, self.leave.notified()).await;
        if told.is_err() && self.is_known() {
            self.leave.notified().await;
        }
    }
}

/// The open connections.
#[derive(Debug, Default)]
struct Guests(Mutex<Vec<Arc<Guest>>>);

impl Guests {
    fn all(&self) -> MutexGuard<'_, Vec<Arc<Guest>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Admits a new connection, if necessary in the place of another one. None if there is no place.
    fn take_in(&self) -> Option<Arc<Guest>> {
        let mut all = self.all();
        let strangers = all.iter().filter(|guest| !guest.is_known()).count();
        if strangers >= MAX_STRANGERS {
            let waits = |guest: &&Arc<Guest>| !guest.is_known() && guest.came.elapsed() >= HURRY;
            let oldest = all.iter().filter(waits).min_by_key(|guest| guest.came).cloned();
            send_away(&mut all, &oldest?);
        }
        while all.iter().filter(|guest| guest.is_known()).count() > MAX_KNOWN {
            let idle = all.iter().filter(|guest| guest.is_known() && !guest.stays.load(Ordering::Relaxed));
            let Some(longest) = idle.min_by_key(|guest| guest.heard()).cloned() else { break };
            send_away(&mut all, &longest);
        }
        let guest = Arc::new(Guest::new());
        all.push(guest.clone());
        Some(guest)
    }

    fn leaves(&self, guest: &Arc<Guest>) {
        self.all().retain(|other| !Arc::ptr_eq(other, guest));
    }
}

fn send_away(all: &mut Vec<Arc<Guest>>, guest: &Arc<Guest>) {
    // notify_one also reaches a connection that does not wait yet.
    guest.leave.notify_one();
    all.retain(|other| !Arc::ptr_eq(other, guest));
}

/// Serves all connections, forever.
pub async fn serve(listener: TcpListener, router: Router) {
    let guests = Arc::new(Guests::default());
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No file descriptor is free: a connection will end in a moment.
            sleep(HURRY).await;
            continue;
        };
        let guest = loop {
            match guests.take_in() {
                Some(guest) => break guest,
                None => sleep(LOOK_AGAIN).await,
            }
        };
        let (guests, router) = (guests.clone(), router.clone().layer(Extension(guest.clone())));
        tokio::spawn(async move {
            serve_guest(stream, router, &guest).await;
            guests.leaves(&guest);
        });
    }
}

async fn serve_guest(stream: TcpStream, router: Router, guest: &Guest) {
    // The rest of an answer would wait for the browser to acknowledge it.
    drop(stream.set_nodelay(true));
    let service = TowerToHyperService::new(router);
    let connection = http1::Builder::new().serve_connection(TokioIo::new(stream), service);
    // How a connection ends is the browser's business.
    drop(select(pin!(connection), pin!(guest.has_to_leave())).await);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_shows_the_token_keeps_its_place_however_many_strangers_come() {
        let guests = Guests::default();
        let known = guests.take_in().expect("a place");
        known.shows_token("/api/drive");
        for _ in 0..MAX_STRANGERS {
            guests.take_in().expect("a place");
        }
        assert!(guests.take_in().is_none(), "all of them have just come");
        std::thread::sleep(HURRY);
        for _ in 0..2 {
            guests.take_in().expect("that of a stranger");
        }
        let all = guests.all();
        assert!(all.iter().any(|guest| Arc::ptr_eq(guest, &known)));
        assert_eq!(all.len(), MAX_STRANGERS + 1);
    }

    #[test]
    fn of_those_that_have_shown_it_a_page_that_follows_the_drive_stays() {
        let guests = Guests::default();
        let follows = guests.take_in().expect("a place");
        follows.shows_token("/api/drive");
        let idle = guests.take_in().expect("a place");
        idle.shows_token("/api/check");
        for _ in 0..MAX_KNOWN {
            guests.take_in().expect("a place").shows_token("/api/order");
        }
        let all = guests.all();
        let holds = |guest: &Arc<Guest>| all.iter().any(|other| Arc::ptr_eq(other, guest));
        assert_eq!((holds(&follows), holds(&idle)), (true, false));
    }
}
