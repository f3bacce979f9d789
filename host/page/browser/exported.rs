//! The functions that the worker calls, and the one that it lends.
#![allow(unsafe_code)] // For the names alone.

use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use super::reply::reply;

/// Nobody listens outside a browser.
#[cfg(not(target_family = "wasm"))]
fn hear(_: *const u8, _: usize) {}

#[cfg(target_family = "wasm")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// How far a study is, in JSON: where the bytes are, and their number. The worker copies them before it returns.
    safe fn hear(place: *const u8, length: usize);
}

static REQUEST: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static ANSWER: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static FAILURE: Mutex<String> = Mutex::new(String::new());

/// Stores a panic's message, for the page to read after the module has ended.
static PANICS: LazyLock<()> = LazyLock::new(|| {
    std::panic::set_hook(Box::new(|panic| panic.to_string().clone_into(&mut locked(&FAILURE))));
});

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for a request of `length` bytes, and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    LazyLock::force(&PANICS);
    let mut request = locked(&REQUEST);
    request.clear();
    request.resize(length, 0);
    request.as_mut_ptr()
}

/// Answers the request that was written, and returns the status.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> u32 {
    let request = std::mem::take(&mut *locked(&REQUEST));
    let reply = reply(&request, &mut |line| {
        let line = line.to_string();
        hear(line.as_ptr(), line.len());
    });
    *locked(&ANSWER) = reply.bytes;
    u32::from(reply.status)
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer_at() -> *const u8 {
    locked(&ANSWER).as_ptr()
}

/// The length of the answer, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    locked(&ANSWER).len()
}

/// Where the words of a panic are.
#[unsafe(no_mangle)]
pub extern "C" fn failure_at() -> *const u8 {
    locked(&FAILURE).as_ptr()
}

/// Their length, bytes: 0 as long as there was none.
#[unsafe(no_mangle)]
pub extern "C" fn failure_length() -> usize {
    locked(&FAILURE).len()
}
