//! The page's requests as they arrive.

use std::time::Duration;

use axum::http::StatusCode;
use pneudrive_page::page_rig::PageRig;
use pneudrive_page::refusal::HttpRefusal;
use pneudrive_session::bring_up::{MAX_PERCENT, Options, PUSH_WAIT_S};
use pneudrive_session::slow_move::{GO_MM_PER_S, JOG_MM_PER_S};
use pneudrive_sim::Rig;
use serde::Deserialize;

use super::order::{Direction, Order, Stopped, Task};

/// Slowest jog, mm/s.
const MIN_JOG_MM_PER_S: f64 = 0.5;

/// A request with the number of its page. Only a stop needs none.
#[derive(Debug, Deserialize)]
pub struct Numbered<T> {
    pub number: Option<u32>,
    #[serde(flatten)]
    pub of_page: T,
}

/// Orders without an answer.
#[derive(Debug, Deserialize)]
#[serde(tag = "order", rename_all = "kebab-case")]
pub enum Orders {
    Alive,
    Arm,
    Disarm,
    Stop,
    Home,
    Release,
    Abort,
    Answer { question: u32, yes: bool },
    Run { rig: PageRig, from_mm: Option<f64> },
    Go { mm: f64, rig: PageRig },
    Extend { rig: PageRig, mm_per_s: Option<f64> },
    Retract { rig: PageRig, mm_per_s: Option<f64> },
}

impl Orders {
    /// The order for the thread of the page. `stopped` is told when a stop is done.
    ///
    /// # Errors
    /// When the request's rig is invalid, a place is not a number, or a jog is too fast.
    pub fn order(self, stopped: Stopped) -> Result<Order, HttpRefusal> {
        Ok(match self {
            Orders::Alive => Order::Alive,
            Orders::Arm => Order::Arm,
            Orders::Disarm => Order::Disarm,
            Orders::Stop => Order::Stop(stopped),
            Orders::Home => Order::Home,
            Orders::Release => Order::Release,
            Orders::Abort => Order::Abort,
            Orders::Answer { question, yes } => Order::Answer(question, yes),
            Orders::Run { rig, from_mm } => Order::Run(read(&rig)?, from_mm),
            Orders::Go { mm, .. } if !mm.is_finite() => return Err(wrong("give the place in mm")),
            Orders::Go { mm, rig } => Order::Go(mm, read(&rig)?),
            Orders::Extend { rig, mm_per_s } => Order::Jog(Direction::Extend, rate(mm_per_s)?, read(&rig)?),
            Orders::Retract { rig, mm_per_s } => Order::Jog(Direction::Retract, rate(mm_per_s)?, read(&rig)?),
        })
    }
}

/// The rate of a jog, mm/s.
fn rate(asked: Option<f64>) -> Result<f64, HttpRefusal> {
    let rate = asked.unwrap_or(JOG_MM_PER_S);
    let is_slow = (MIN_JOG_MM_PER_S..=GO_MM_PER_S).contains(&rate);
    is_slow.then_some(rate).ok_or_else(|| wrong(format!("jog at {MIN_JOG_MM_PER_S} to {GO_MM_PER_S} mm/s")))
}

/// Tasks with an answer.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "kebab-case")]
pub enum Questions {
    Approach { rig: PageRig },
    Parameters { rig: PageRig },
    Change { values: Vec<(String, String)> },
    Save,
    Record,
    BringUp { push_wait_s: u16, most_percent: u8 },
}

impl Questions {
    /// The task for the thread of the page.
    ///
    /// # Errors
    /// When the request's rig is invalid, or the bring-up would go too far.
    pub fn task(self) -> Result<Task, HttpRefusal> {
        Ok(match self {
            Questions::Approach { rig } => Task::Approach(read(&rig)?),
            Questions::Parameters { rig } => Task::Parameters(read(&rig)?),
            Questions::Change { values } => Task::Change(values),
            Questions::Save => Task::Save,
            Questions::Record => Task::Record,
            Questions::BringUp { push_wait_s, most_percent } => {
                Task::BringUp(options(push_wait_s, most_percent)?)
            }
        })
    }
}

fn options(push_wait_s: u16, most_percent: u8) -> Result<Options, HttpRefusal> {
    let within = |value: u16, [least, most]: [u16; 2]| (least..=most).contains(&value);
    if !within(push_wait_s, PUSH_WAIT_S) || !within(most_percent.into(), MAX_PERCENT.map(u16::from)) {
        let ([from, to], [least, most]) = (PUSH_WAIT_S, MAX_PERCENT);
        return Err(wrong(format!(
            "wait {from} to {to} s for the hand, with {least} to {most} % of the valve"
        )));
    }
    let push_wait = Duration::from_secs(push_wait_s.into());
    Ok(Options { push_wait, most_percent, ..Options::default() })
}

fn read(asked: &PageRig) -> Result<Box<Rig>, HttpRefusal> {
    Ok(Box::new(asked.rig()?))
}

fn wrong(message: impl Into<String>) -> HttpRefusal {
    HttpRefusal::new(StatusCode::UNPROCESSABLE_ENTITY, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jog_is_never_faster_than_a_move_to_a_place() {
        assert_eq!([rate(None).ok(), rate(Some(2.0)).ok()], [Some(10.0), Some(2.0)]);
        for asked in [0.0, -1.0, 50.1, f64::NAN, f64::INFINITY] {
            assert!(rate(Some(asked)).expect_err("refused").message.contains("0.5 to 50 mm/s"), "{asked}");
        }
    }

    #[test]
    fn a_bring_up_goes_no_further_than_the_command_lets_it() {
        assert!(options(0, 3).is_ok() && options(600, 50).is_ok());
        for (wait, most) in [(601, 30), (20, 2), (20, 51)] {
            let refusal = options(wait, most).expect_err("too far");
            assert!(refusal.message.contains("3 to 50 %"), "{}", refusal.message);
        }
    }
}
