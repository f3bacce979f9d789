//! The routes, and the address.

use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::middleware::from_fn_with_state;
use axum::routing::{get, post};
use pneudrive_page::answer::REQUESTS;
use pneudrive_page::rigs::Opened;

use crate::commission::{self, CommandedRig};
use crate::connections;
use crate::files::{self, Files};
use crate::guard::{Guard, MAX_BYTES, MAX_BYTES_OF_RECORD, watch};
use crate::served;
use crate::study;
use crate::token::Token;

/// Threads for simulations: one for a run, one for its perturbed runs, and two for those that nobody waits for any more.
const THREADS: usize = 4;

/// Threads that receive requests and send answers: while one reads a long body, an order to the drive still gets through.
const DOORS: usize = 2;

/// Requests that bring a record.
const WITH_RECORD: [&str; 2] = ["compare", "spectrum"];

/// The settings that a studio is started with.
#[derive(Debug)]
pub struct Options {
    /// Where it listens, `HOST:PORT`; port 0 for any free one.
    pub listen: String,
    /// The token that the user has chosen, if any. An address that a network can reach needs one.
    pub token: Option<Token>,
    /// The rig that the page begins with.
    pub opened: Opened,
    /// The port of a rig to commission, if there is one.
    pub port: Option<String>,
}

/// A studio that listens.
#[derive(Debug)]
pub struct Studio {
    listener: TcpListener,
    guard: Arc<Guard>,
    files: Arc<Files>,
    drive: Arc<CommandedRig>,
}

impl Studio {
    /// Listens at an address.
    ///
    /// # Errors
    /// When it cannot, or when a network can reach the address and there is no token.
    pub fn open(options: Options) -> Result<Studio> {
        let Options { listen, token, opened, port } = options;
        let listener = TcpListener::bind(&listen).with_context(|| {
            format!(
                "cannot listen at {listen}; write HOST:PORT, such as 127.0.0.1:8787, or port 0 for a free one"
            )
        })?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let token = match token {
            Some(token) => token,
            None if address.ip().is_loopback() => Token::draw()?,
            None => bail!(
                "{address} can be reached from the network: set PNEUDRIVE_TOKEN for those who may use the studio, or listen at 127.0.0.1:{}",
                address.port()
            ),
        };
        let guard = Arc::new(Guard { address, token });
        let (files, drive) = (Arc::new(Files::new(opened)), Arc::new(CommandedRig::new(port)));
        Ok(Studio { listener, guard, files, drive })
    }

    /// The address to open in a browser. The token stands behind the #, so the browser keeps it to itself.
    #[must_use]
    pub fn address(&self) -> String {
        format!("http://{}/#token={}", self.guard.address, self.guard.token.text())
    }

    /// Where it listens.
    #[must_use]
    pub fn local_address(&self) -> SocketAddr {
        self.guard.address
    }

    /// The router for the requests.
    pub fn router(&self) -> Router {
        Router::new()
            .route("/", get(served::index))
            .route("/{name}", get(served::file))
            .route("/api/keys", get(served::keys))
            .route("/api/rigs", get(files::list))
            .route("/api/rigs/{name}", get(files::open))
            .route("/api/save", post(files::save))
            .with_state(self.files.clone())
            .merge(requests())
            .merge(study::routes())
            .merge(commission::routes(self.drive.clone()))
            .layer(DefaultBodyLimit::max(MAX_BYTES))
            .layer(from_fn_with_state(self.guard.clone(), watch))
    }

    /// Serves until the program ends.
    ///
    /// # Errors
    /// When the system refuses threads or sockets.
    pub fn serve(self) -> Result<()> {
        let mut runtime = tokio::runtime::Builder::new_multi_thread();
        let runtime = runtime.worker_threads(DOORS).max_blocking_threads(THREADS).enable_all().build()?;
        let router = self.router();
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            connections::serve(listener, router).await;
            Ok(())
        })
    }
}

/// Requests that the page's own crate answers.
fn requests() -> Router {
    REQUESTS.into_iter().fold(Router::new(), |router, name| {
        let most = if WITH_RECORD.contains(&name) { MAX_BYTES_OF_RECORD } else { MAX_BYTES };
        let answered = post(move |headers, body| served::request(name, headers, body))
            .layer(DefaultBodyLimit::max(most));
        router.route(&format!("/api/{name}"), answered)
    })
}
