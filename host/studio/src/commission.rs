//! Commissions a rig at a port from the page.
//!
//! The page opens `/api/drive` and reads one line of JSON for each look at the rig. While it reads, it commands the
//! drive, and no other page can. When it stops reading, the drive is disarmed. Any page with the token may stop the
//! drive.
//!
//! A stop never waits for other requests. The thread of the page in command takes it; without such a page, a thread
//! of its own does.
//!
//! ```text
//! page -> /api/order -> Order -> pilot -> rig      at once, without an answer; a stop is answered when it is done
//!      -> /api/ask   -> Order -> pilot -> rig      parameters, record, bring-up: answered when it is done
//!      <- /api/drive <- DriveView <- pilot <- rig  looks, samples, what a bring-up shows
//! ```

mod approach;
mod asked;
mod bring_up;
mod drive_view;
mod ended;
mod live;
mod order;
mod parameters;
mod pilot;
mod record;
mod samples;
mod stop;

use std::convert::Infallible;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::body::Body;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::stream::unfold;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_session::slow_move::{GO_MM_PER_S, JOG_MM_PER_S};
use serde_json::{Value, json};
use tokio::sync::oneshot;

use crate::refusal_response::RefusalResponse;
use asked::{Numbered, Orders, Questions};
use drive_view::DriveView;
use order::{Arrived, Order};
use pilot::steer;
use stop::Stopper;

/// Time between two lines to the page.
const LINE: Duration = Duration::from_millis(50);

/// The rig at a port, and the page in command.
#[derive(Debug)]
pub struct CommandedRig {
    /// None if the studio was started without a port.
    port: Option<String>,
    stopper: Option<Stopper>,
    in_command: Mutex<PageInCommand>,
}

/// Which page is in command.
#[derive(Debug, Default)]
struct PageInCommand {
    /// The number of the last page that was let in.
    last: u32,
    /// The page in command, and its thread.
    page: Option<(u32, Sender<Arrived>)>,
}

impl CommandedRig {
    /// The rig at a port, if there is one.
    #[must_use]
    pub fn new(port: Option<String>) -> CommandedRig {
        let stopper = port.clone().map(Stopper::at);
        CommandedRig { port, stopper, in_command: Mutex::default() }
    }

    /// The port.
    fn port(&self) -> Result<String, HttpRefusal> {
        self.port.clone().ok_or_else(no_port)
    }

    /// Hands an order to the thread of the page in command, if the number may give it.
    fn send(&self, order: Order, allowed: impl Fn(u32) -> bool) -> bool {
        let in_command = self.in_command();
        let page = in_command.page.as_ref().filter(|(number, _)| allowed(*number));
        page.is_some_and(|(_, orders)| orders.send(Arrived::now(order)).is_ok())
    }

    fn in_command(&self) -> MutexGuard<'_, PageInCommand> {
        self.in_command.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The routes of a drive.
pub(crate) fn routes(drive: Arc<CommandedRig>) -> Router {
    Router::new()
        .route("/api/port", get(port))
        .route("/api/drive", post(open))
        .route("/api/order", post(order))
        .route("/api/ask", post(ask))
        .with_state(drive)
}

async fn port(State(drive): State<Arc<CommandedRig>>) -> Json<Value> {
    Json(json!({ "port": drive.port, "jog_mm_per_s": JOG_MM_PER_S, "go_mm_per_s": GO_MM_PER_S }))
}

/// A page's command of the drive. It is dropped when the connection ends; then the thread disarms and leaves.
struct Lease {
    drive: Arc<CommandedRig>,
    number: u32,
}

impl Drop for Lease {
    fn drop(&mut self) {
        self.drive.in_command().page.take_if(|(number, _)| *number == self.number);
    }
}

/// Lets a page in and sends it the state of the drive from then on.
async fn open(State(drive): State<Arc<CommandedRig>>) -> Result<Response, RefusalResponse> {
    let port = drive.port()?;
    let (sender, orders) = channel();
    let lease = take_helm(&drive, sender)?;
    let seen = Arc::new(Mutex::new(DriveView { mode: "connecting", ..DriveView::default() }));
    let shared = seen.clone();
    std::thread::spawn(move || steer(&port, &orders, &shared));
    let lines = unfold((lease, Next::Number), move |(lease, next)| {
        let seen = seen.clone();
        async move {
            let (line, next) = next.line(&lease, &seen).await?;
            Some((Ok::<_, Infallible>(format!("{line}\n")), (lease, next)))
        }
    });
    Ok(([(CONTENT_TYPE, "application/x-ndjson")], Body::from_stream(lines)).into_response())
}

/// The next line for the page.
enum Next {
    /// Its number.
    Number,
    /// The drive as it is.
    Look,
    /// None: the link to the rig has ended.
    End,
}

impl Next {
    async fn line(self, lease: &Lease, seen: &Mutex<DriveView>) -> Option<(Value, Next)> {
        match self {
            Next::Number => Some((json!({ "number": lease.number }), Next::Look)),
            Next::Look => {
                tokio::time::sleep(LINE).await;
                let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
                Some((seen.line(), if seen.is_over { Next::End } else { Next::Look }))
            }
            Next::End => None,
        }
    }
}

fn take_helm(drive: &Arc<CommandedRig>, orders: Sender<Arrived>) -> Result<Lease, HttpRefusal> {
    let mut in_command = drive.in_command();
    if in_command.page.is_some() {
        let message = "another page commands the drive; close it first";
        return Err(HttpRefusal::new(StatusCode::CONFLICT, message));
    }
    in_command.last += 1;
    in_command.page = Some((in_command.last, orders));
    Ok(Lease { drive: drive.clone(), number: in_command.last })
}

/// Hands an order to the thread of the page in command.
async fn order(
    State(drive): State<Arc<CommandedRig>>,
    Json(ordered): Json<Numbered<Orders>>,
) -> Result<StatusCode, RefusalResponse> {
    let is_stop = matches!(ordered.of_page, Orders::Stop);
    let (stopped, told) = oneshot::channel();
    let order = ordered.of_page.order(stopped)?;
    let allowed = |number: u32| is_stop || Some(number) == ordered.number;
    let is_sent = drive.send(order, allowed);
    if !is_stop {
        return if is_sent { Ok(StatusCode::ACCEPTED) } else { Err(not_commanding().into()) };
    }
    // The thread of the page may end before it reaches the stop.
    if is_sent && told.await.is_ok() { Ok(StatusCode::ACCEPTED) } else { stop_without_page(&drive).await }
}

/// Stops a drive that no page commands: another program may have started it.
async fn stop_without_page(drive: &CommandedRig) -> Result<StatusCode, RefusalResponse> {
    let stopper = drive.stopper.as_ref().ok_or_else(no_port)?;
    stopper.stop().await.map_err(|why| HttpRefusal::new(StatusCode::INTERNAL_SERVER_ERROR, why))?;
    Ok(StatusCode::ACCEPTED)
}

/// Forwards a request, and waits for its answer.
async fn ask(
    State(drive): State<Arc<CommandedRig>>,
    Json(asked): Json<Numbered<Questions>>,
) -> Result<Json<Value>, RefusalResponse> {
    let (reply, answer) = oneshot::channel();
    let order = Order::Ask(asked.of_page.task()?, reply);
    if !drive.send(order, |number| Some(number) == asked.number) {
        return Err(not_commanding().into());
    }
    let busy = || HttpRefusal::new(StatusCode::CONFLICT, "not now: the drive is busy, or its link has ended");
    Ok(Json(answer.await.unwrap_or_else(|_| Err(busy()))?))
}

fn no_port() -> HttpRefusal {
    HttpRefusal::new(StatusCode::NOT_FOUND, "start the studio with --port to commission a rig")
}

fn not_commanding() -> HttpRefusal {
    HttpRefusal::new(StatusCode::CONFLICT, "this page does not command the drive")
}
