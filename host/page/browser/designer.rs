//! The designer in the reader's browser: the page's answers behind functions that a worker calls.
//!
//! ```text
//! worker:  room(n) -> write the request there -> answer() -> read answer_length() bytes at answer_at()
//! request: JSON { "request": "run", "body": { … } }
//! answer:  a status as HTTP has it; JSON, or columns of numbers; of a study, `hear` is called before with how far it is
//! ```
//!
//! The functions take and return only numbers: addresses in the module's own memory. So no tool has to generate code
//! around them, and none of them needs an unsafe block. A panic ends the module; its message is at `failure_at()`.
//!
//! | module | holds |
//! |---|---|
//! | `reply` | a request answered |
//! | `exported` | the functions that the worker calls |

mod exported;
mod reply;
