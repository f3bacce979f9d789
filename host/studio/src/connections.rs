//! Which connections may stay. Connections without the token never crowd out one with it: a page, and a stop, get
//! through however many there are.
//!
//! | connection | may stay | at most |
//! |---|---|---|
//! | without the token | [`TOKEN_WAIT`]; the oldest leaves for a new one after [`HURRY`] | [`MAX_WITHOUT_TOKEN`] |
//! | with the token | as long as it likes; beyond the limit the one that was silent longest leaves for a new one, but never one on which a page follows the drive or a study | [`MAX_WITH_TOKEN`] |

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
pub const TOKEN_WAIT: Duration = Duration::from_secs(10);

/// Time that a connection has to show the token while others wait for its place.
pub const HURRY: Duration = Duration::from_millis(100);

/// Most connections without the token.
pub const MAX_WITHOUT_TOKEN: usize = 64;

/// Most connections with the token; a page has six.
pub const MAX_WITH_TOKEN: usize = 96;

/// Time between two looks for a free place.
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// Requests whose answer a page keeps reading.
const STAYS: [&str; 2] = ["/api/drive", "/api/study"];

/// One connection.
#[derive(Debug)]
pub struct Connection {
    came: Instant,
    heard: Mutex<Instant>,
    is_known: AtomicBool,
    stays: AtomicBool,
    leave: Notify,
}

impl Connection {
    fn new() -> Connection {
        let now = Instant::now();
        let (is_known, stays) = (AtomicBool::new(false), AtomicBool::new(false));
        Connection { came: now, heard: Mutex::new(now), is_known, stays, leave: Notify::new() }
    }

    /// It has shown the token with a request for this path.
    pub(crate) fn shows_token(&self, path: &str) {
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
        let told = timeout(TOKEN_WAIT, self.leave.notified()).await;
        if told.is_err() && self.is_known() {
            self.leave.notified().await;
        }
    }
}

/// The open connections.
#[derive(Debug, Default)]
struct Connections(Mutex<Vec<Arc<Connection>>>);

impl Connections {
    fn all(&self) -> MutexGuard<'_, Vec<Arc<Connection>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Admits a new connection, if necessary in the place of another one. None if there is no place.
    fn take_in(&self) -> Option<Arc<Connection>> {
        let mut all = self.all();
        let without_token = all.iter().filter(|connection| !connection.is_known()).count();
        if without_token >= MAX_WITHOUT_TOKEN {
            let waits =
                |connection: &&Arc<Connection>| !connection.is_known() && connection.came.elapsed() >= HURRY;
            let oldest = all.iter().filter(waits).min_by_key(|connection| connection.came).cloned();
            send_away(&mut all, &oldest?);
        }
        while all.iter().filter(|connection| connection.is_known()).count() > MAX_WITH_TOKEN {
            let idle = all
                .iter()
                .filter(|connection| connection.is_known() && !connection.stays.load(Ordering::Relaxed));
            let Some(longest) = idle.min_by_key(|connection| connection.heard()).cloned() else { break };
            send_away(&mut all, &longest);
        }
        let connection = Arc::new(Connection::new());
        all.push(connection.clone());
        Some(connection)
    }

    fn leaves(&self, connection: &Arc<Connection>) {
        self.all().retain(|other| !Arc::ptr_eq(other, connection));
    }
}

fn send_away(all: &mut Vec<Arc<Connection>>, connection: &Arc<Connection>) {
    // notify_one also reaches a connection that does not wait yet.
    connection.leave.notify_one();
    all.retain(|other| !Arc::ptr_eq(other, connection));
}

/// Serves all connections, forever.
pub async fn serve(listener: TcpListener, router: Router) {
    let connections = Arc::new(Connections::default());
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // No file descriptor is free: a connection will end in a moment.
            sleep(HURRY).await;
            continue;
        };
        let connection = loop {
            match connections.take_in() {
                Some(connection) => break connection,
                None => sleep(LOOK_AGAIN).await,
            }
        };
        let (connections, router) =
            (connections.clone(), router.clone().layer(Extension(connection.clone())));
        tokio::spawn(async move {
            serve_one(stream, router, &connection).await;
            connections.leaves(&connection);
        });
    }
}

async fn serve_one(stream: TcpStream, router: Router, connection: &Connection) {
    // The rest of an answer would wait for the browser to acknowledge it.
    drop(stream.set_nodelay(true));
    let service = TowerToHyperService::new(router);
    let served = http1::Builder::new().serve_connection(TokioIo::new(stream), service);
    // How a connection ends is the browser's business.
    drop(select(pin!(served), pin!(connection.has_to_leave())).await);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_shows_the_token_keeps_its_place_however_many_strangers_come() {
        let connections = Connections::default();
        let known = connections.take_in().expect("a place");
        known.shows_token("/api/drive");
        for _ in 0..MAX_WITHOUT_TOKEN {
            connections.take_in().expect("a place");
        }
        assert!(connections.take_in().is_none(), "all of them have just come");
        std::thread::sleep(HURRY);
        for _ in 0..2 {
            connections.take_in().expect("that of one without the token");
        }
        let all = connections.all();
        assert!(all.iter().any(|connection| Arc::ptr_eq(connection, &known)));
        assert_eq!(all.len(), MAX_WITHOUT_TOKEN + 1);
    }

    #[test]
    fn of_those_that_have_shown_it_a_page_that_follows_the_drive_stays() {
        let connections = Connections::default();
        let follows = connections.take_in().expect("a place");
        follows.shows_token("/api/drive");
        let idle = connections.take_in().expect("a place");
        idle.shows_token("/api/check");
        for _ in 0..MAX_WITH_TOKEN {
            connections.take_in().expect("a place").shows_token("/api/order");
        }
        let all = connections.all();
        let holds = |connection: &Arc<Connection>| all.iter().any(|other| Arc::ptr_eq(other, connection));
        assert_eq!((holds(&follows), holds(&idle)), (true, false));
    }
}
