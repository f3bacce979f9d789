//! The checks of `device bring-up`, with the page as the operator.

use anyhow::Result;
use pneudrive_link::client::Client;
use pneudrive_protocol::Status;
use pneudrive_session::bring_up::{self, Check, Operator, Options, Report};
use serde_json::{Value, json};

use super::drive_view::Reporter;
use super::ended::Ended;
use super::order::Orders;

/// Runs the checks. The page follows them; its answer is the report.
///
/// # Errors
/// As [`bring_up::bring_up`]; [`Ended`] when the page has ended it. The drive is disarmed in every case.
pub fn bring_up(
    client: &mut Client,
    orders: &mut Orders<'_>,
    reporter: &Reporter<'_>,
    options: Options,
) -> Result<Value> {
    let told = Told { is_on: true, ..Told::default() };
    let mut hand = Hand { orders, reporter, ended: None, asked: 0, told };
    hand.show();
    let made = bring_up::bring_up(client, &mut hand, options);
    let ended = hand.ended;
    hand.told = Told { checks: std::mem::take(&mut hand.told.checks), ..Told::default() };
    hand.show();
    match ended {
        // An unanswered question does not count as "no".
        Some(ended) => Err(ended.into()),
        None => Ok(answer(&made?)),
    }
}

fn answer(report: &Report) -> Value {
    let wrong: Vec<&str> = report.wrong().map(|check| check.name).collect();
    json!({ "summary": report.summary(), "wrong": wrong, "text": report.markdown() })
}

/// The page as the operator.
struct Hand<'a, 'b> {
    orders: &'a mut Orders<'b>,
    reporter: &'a Reporter<'a>,
    /// Why the page has ended the bring-up, if it has.
    ended: Option<Ended>,
    /// The number of the last question.
    asked: u32,
    told: Told,
}

/// What the page shows.
#[derive(Default)]
struct Told {
    is_on: bool,
    /// What the operator has to do now, or the next step.
    now: String,
    question: Option<(u32, String)>,
    checks: Vec<Value>,
}

impl Hand<'_, '_> {
    fn show(&mut self) {
        let Told { is_on, now, question, checks } = &self.told;
        let question = question.as_ref().map(|(number, text)| json!({ "number": number, "text": text }));
        let shown = json!({ "is_on": is_on, "now": now, "question": question, "checks": checks });
        self.reporter.seen().bring_up = Some(shown);
    }

    /// Tells the page that its orders during the bring-up are refused.
    fn tell_refused(&mut self) {
        if self.orders.has_refused() {
            self.reporter.tell("not now: the bring-up is on");
        }
    }

    /// The answer of the page; "no" once it has ended the bring-up.
    fn ask(&mut self, question: &str) -> bool {
        if self.ended.is_some() {
            return false;
        }
        self.asked += 1;
        self.told.question = Some((self.asked, question.to_owned()));
        self.show();
        let answer = self.orders.answer(self.asked);
        self.tell_refused();
        self.told.question = None;
        self.show();
        answer.unwrap_or_else(|ended| {
            self.ended = Some(ended);
            false
        })
    }
}

impl Operator for Hand<'_, '_> {
    fn tell(&mut self, text: &str) {
        text.clone_into(&mut self.told.now);
        self.show();
    }

    fn done(&mut self, check: &Check) {
        self.told.now.clear();
        self.told.checks.push(check.to_json());
        self.show();
    }

    fn lets_it_move(&mut self, question: &str) -> bool {
        self.ask(question)
    }

    fn answers(&mut self, question: &str) -> Option<bool> {
        Some(self.ask(question))
    }

    fn goes_on(&mut self) -> Result<()> {
        if self.ended.is_none() {
            self.ended = self.orders.goes_on().err();
        }
        self.tell_refused();
        self.ended.map_or(Ok(()), |ended| Err(ended.into()))
    }

    fn sees(&mut self, status: &Status) {
        self.orders.mind(status.mode.moves());
        self.reporter.look(status, true);
    }
}
