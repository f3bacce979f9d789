//! Studies for the page: long work on a thread of its own, with progress line by line.
//!
//! ```text
//! POST /api/study  ->  { "at": { "what", "done", "all" } } ...  ->  { "found": ... } or { "refused": ... }
//! ```
//!
//! There is one study at a time. It is cancelled when its page stops reading: cancelled, closed or gone. Its running
//! simulations still end, and the next study begins after them. So there is never more than one thread for studies.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use axum::body::Body;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use futures_util::stream::unfold;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_page::study::{Audience, Study, choices};
use serde_json::{Value, json};
use tokio::sync::Mutex;
use tokio::sync::mpsc::{UnboundedSender, unbounded_channel};

use crate::refusal_response::RefusalResponse;

/// The place for studies: one page at a time.
#[derive(Debug, Default)]
struct StudySlot {
    /// Whether a page waits.
    taken: AtomicBool,
    /// Held by the working thread. A cancelled study still ends its last run.
    work: Arc<Mutex<()>>,
}

/// The routes of studies.
pub(crate) fn routes() -> Router {
    Router::new()
        .route("/api/choices", get(|| async { Json(choices()) }))
        .route("/api/study", post(begin))
        .with_state(Arc::<StudySlot>::default())
}

/// A page that waits. When it goes, its study is cancelled.
struct Waiting {
    desk: Arc<StudySlot>,
    waits: Arc<AtomicBool>,
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.waits.store(false, Ordering::Relaxed);
        self.desk.taken.store(false, Ordering::Release);
    }
}

async fn begin(
    State(desk): State<Arc<StudySlot>>,
    Json(body): Json<Value>,
) -> Result<Response, RefusalResponse> {
    let study = Study::read(&body)?;
    let waiting = take(&desk)?;
    // A page that leaves while it waits here has started no study.
    let alone = desk.work.clone().lock_owned().await;
    let (sender, receiver) = unbounded_channel();
    let waits = waiting.waits.clone();
    std::thread::spawn(move || {
        work(&study, &waits, &sender);
        drop(alone);
    });
    let lines = unfold((waiting, receiver), |(waiting, mut receiver)| async move {
        let line: Value = receiver.recv().await?;
        Some((Ok::<_, Infallible>(format!("{line}\n")), (waiting, receiver)))
    });
    Ok(([(CONTENT_TYPE, "application/x-ndjson")], Body::from_stream(lines)).into_response())
}

fn take(desk: &Arc<StudySlot>) -> Result<Waiting, HttpRefusal> {
    if desk.taken.swap(true, Ordering::Acquire) {
        let message = "another study is at work; cancel it or wait for its end";
        return Err(HttpRefusal::new(StatusCode::CONFLICT, message));
    }
    Ok(Waiting { desk: desk.clone(), waits: Arc::new(AtomicBool::new(true)) })
}

/// Works while the page waits. Lines that are sent after that are lost.
fn work(study: &Study, waits: &AtomicBool, lines: &UnboundedSender<Value>) {
    let done = study.work(Audience {
        hears: &mut |at| drop(lines.send(json!({ "at": at }))),
        waits: &|| waits.load(Ordering::Relaxed),
    });
    let last = match done {
        Ok(found) => json!({ "found": found }),
        Err(refusal) => json!({ "refused": refusal.body(), "status": refusal.status.as_u16() }),
    };
    drop(lines.send(last));
}
