//! The orders of a page to the thread that talks to the rig, and the queue between the two.

use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::{Duration, Instant};

use pneudrive_page::refusal::HttpRefusal;
use pneudrive_session::bring_up::Options;
use pneudrive_sim::Rig;
use serde_json::Value;
use tokio::sync::oneshot;

use super::ended::Ended;

/// How long a page may be silent after it has armed the drive, or during a bring-up.
pub const PAGE_SILENCE: Duration = Duration::from_millis(1500);

/// How long a page may be silent while the drive moves: in a test, a move to a place, homing or a bring-up.
pub const MOTION_SILENCE: Duration = Duration::from_millis(300);

/// How long a held button may stay unconfirmed.
pub const JOG_SILENCE: Duration = MOTION_SILENCE;

/// An order of the page.
#[derive(Debug)]
pub enum Order {
    /// A sign of life of the page.
    Alive,
    /// Enable the drive.
    Arm,
    /// Disable it.
    Disarm,
    /// Stop at once, with a fault.
    Stop(Stopped),
    /// Home the axis.
    Home,
    /// Run the test of a rig. The number is where the drive stood, mm, when the page agreed to move it from there to
    /// the start.
    Run(Box<Rig>, Option<f64>),
    /// Move slowly to a place, mm.
    Go(f64, Box<Rig>),
    /// A jog button is held: which way, and the rate, mm/s.
    Jog(Direction, f64, Box<Rig>),
    /// The jog button was released.
    Release,
    /// The answer to a question of the bring-up, by the question's number.
    Answer(u32, bool),
    /// End the bring-up.
    Abort,
    /// A task with an answer.
    Ask(Task, Reply),
}

/// An order and the time when it arrived. It may wait until something else is done.
#[derive(Debug)]
pub struct Arrived {
    /// What is asked.
    pub order: Order,
    /// When it arrived.
    pub at: Instant,
}

impl Arrived {
    /// An order that arrives now.
    pub fn now(order: Order) -> Arrived {
        Arrived { order, at: Instant::now() }
    }
}

/// Which way to jog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To larger positions.
    Extend,
    /// To smaller ones.
    Retract,
}

/// A task with an answer.
#[derive(Debug)]
pub enum Task {
    /// The approach to the start of a rig's test.
    Approach(Box<Rig>),
    /// The parameters of the drive, beside those of a rig.
    Parameters(Box<Rig>),
    /// New values by parameter name: all of them or none.
    Change(Vec<(String, String)>),
    /// Stores the parameters, so that they survive a reset.
    Save,
    /// The record of the last run.
    Record,
    /// The checks of a new board.
    BringUp(Options),
}

/// Where the answer goes.
pub type Reply = oneshot::Sender<Result<Value, HttpRefusal>>;

/// Who waits until the drive is stopped; dropped if it is not stopped.
pub type Stopped = oneshot::Sender<()>;

/// The orders of the page in command.
#[derive(Debug)]
pub struct Orders<'a> {
    from: &'a Receiver<Arrived>,
    /// Orders that have arrived and wait.
    waiting: VecDeque<Arrived>,
    /// When the last one came.
    heard: Instant,
    /// How long the page may be silent in the present state of the drive.
    patience: Duration,
    /// Whether the page has gone.
    is_gone: bool,
    /// Whether an order that would have moved the drive was refused meanwhile.
    has_refused: bool,
    /// Who waits for a stop that was received but not done yet.
    stops: Vec<Stopped>,
}

/// The page has gone.
#[derive(Debug)]
pub struct Gone;

impl<'a> Orders<'a> {
    /// The orders that arrive through a channel.
    pub fn of(from: &'a Receiver<Arrived>) -> Orders<'a> {
        let (waiting, heard) = (VecDeque::new(), Instant::now());
        let patience = PAGE_SILENCE;
        Orders { from, waiting, heard, patience, is_gone: false, has_refused: false, stops: Vec::new() }
    }

    /// Adapts to the state of the drive: while it moves, the page must be heard more often.
    pub fn mind(&mut self, moves: bool) {
        self.patience = if moves { MOTION_SILENCE } else { PAGE_SILENCE };
    }

    /// Receives what has arrived. From a page that has gone, only the end of a motion counts.
    fn hear(&mut self) {
        loop {
            match self.from.try_recv() {
                Ok(arrived) => {
                    self.heard = arrived.at;
                    self.waiting.push_back(arrived);
                }
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.is_gone = true;
                    self.waiting.retain(|arrived| ends(&arrived.order).is_err());
                    return;
                }
            }
        }
    }

    /// The next order, if one arrives in time.
    pub fn next(&mut self, within: Duration) -> Result<Option<Arrived>, Gone> {
        self.hear();
        while let Some(arrived) = self.waiting.pop_front() {
            if !self.is_late(&arrived) {
                return Ok(Some(arrived));
            }
        }
        if self.is_gone {
            return Err(Gone);
        }
        match self.from.recv_timeout(within) {
            Ok(arrived) => {
                self.heard = arrived.at;
                Ok(Some(arrived))
            }
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Gone),
        }
    }

    /// Whether an order belongs to a button that may no longer be held.
    fn is_late(&self, arrived: &Arrived) -> bool {
        let is_over = || self.waiting.iter().any(|later| lets_go(&later.order));
        matches!(arrived.order, Order::Jog(..)) && (arrived.at.elapsed() > JOG_SILENCE || is_over())
    }

    /// When a waiting order last confirmed a held button.
    pub fn confirmed(&mut self, direction: Direction) -> Option<Instant> {
        self.hear();
        let again = |later: &&Arrived| matches!(later.order, Order::Jog(other, ..) if other == direction);
        self.waiting.iter().rev().find(again).map(|later| later.at)
    }

    /// Whether the page still wants what is about to begin. `is_held`: only as long as it holds a button.
    pub fn still_wants(&mut self, is_held: bool) -> Result<(), Ended> {
        self.hear();
        for Arrived { order, .. } in &self.waiting {
            if is_held && lets_go(order) {
                ends(order)?;
                return Err(Ended::Aborted);
            }
            ends(order)?;
        }
        self.is_there()
    }

    fn is_there(&mut self) -> Result<(), Ended> {
        if self.is_gone {
            Err(Ended::Gone)
        } else if self.is_silent() {
            Err(Ended::Silent)
        } else {
            Ok(())
        }
    }

    /// Whether the page has been silent for too long. Orders that arrived during another order count as signs of life.
    pub fn is_silent(&mut self) -> bool {
        self.hear();
        self.heard.elapsed() > self.patience
    }

    /// Listens to the page during a long task. Orders that would move the drive are refused.
    pub fn goes_on(&mut self) -> Result<(), Ended> {
        self.hear();
        while let Some(Arrived { order, .. }) = self.waiting.pop_front() {
            self.goes_on_with(order)?;
        }
        self.is_there()
    }

    /// Waits for the answer to a question.
    pub fn answer(&mut self, question: u32) -> Result<bool, Ended> {
        loop {
            match self.next(Duration::from_millis(100)) {
                Ok(Some(Arrived { order: Order::Answer(number, answer), .. })) if number == question => {
                    return Ok(answer);
                }
                Ok(Some(Arrived { order, .. })) => self.goes_on_with(order)?,
                Ok(None) => self.is_there()?,
                Err(Gone) => return Err(Ended::Gone),
            }
        }
    }

    /// Whether an order was refused since the last call.
    pub fn has_refused(&mut self) -> bool {
        std::mem::take(&mut self.has_refused)
    }

    /// Who waits for a stop that has ended a long task and is not done yet.
    pub fn stops(&mut self) -> Vec<Stopped> {
        std::mem::take(&mut self.stops)
    }

    fn goes_on_with(&mut self, order: Order) -> Result<(), Ended> {
        let goes_on = ends(&order);
        self.has_refused |= moves(&order);
        if let Order::Stop(stopped) = order {
            self.stops.push(stopped);
        }
        goes_on
    }
}

/// Whether an order ends a long task.
fn ends(order: &Order) -> Result<(), Ended> {
    match order {
        Order::Stop(_) => Err(Ended::Stopped),
        Order::Disarm | Order::Abort => Err(Ended::Aborted),
        _ => Ok(()),
    }
}

/// Whether an order releases the button.
fn lets_go(order: &Order) -> bool {
    matches!(order, Order::Release | Order::Disarm | Order::Stop(_))
}

/// Whether an order enables or moves the drive.
fn moves(order: &Order) -> bool {
    matches!(order, Order::Arm | Order::Home | Order::Run(..) | Order::Go(..) | Order::Jog(..))
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use tokio::sync::oneshot::error::TryRecvError;

    use super::*;

    #[test]
    fn stop_abort_and_a_page_that_has_gone_end_what_takes_longer_and_nothing_else_does() {
        let (sender, receiver) = channel();
        let mut orders = Orders::of(&receiver);
        for order in [Order::Alive, Order::Arm, Order::Answer(1, true), Order::Release] {
            sender.send(Arrived::now(order)).expect("it listens");
        }
        assert_eq!(orders.goes_on(), Ok(()));
        assert_eq!(
            [orders.has_refused(), orders.has_refused()],
            [true, false],
            "it was not armed, and that is told"
        );
        for (order, ended) in
            [(stop(), Ended::Stopped), (Order::Abort, Ended::Aborted), (Order::Disarm, Ended::Aborted)]
        {
            sender.send(Arrived::now(order)).expect("it listens");
            assert_eq!(orders.goes_on(), Err(ended));
        }
        drop(sender);
        assert_eq!(orders.goes_on(), Err(Ended::Gone));
    }

    /// A stop that nobody waits for.
    fn stop() -> Order {
        Order::Stop(oneshot::channel().0)
    }

    #[test]
    fn who_waits_for_a_stop_hears_of_it_when_it_is_done_or_that_it_is_not() {
        let (sender, receiver) = channel();
        let mut orders = Orders::of(&receiver);
        let (stopped, mut told) = oneshot::channel();
        sender.send(Arrived::now(Order::Stop(stopped))).expect("it listens");
        assert_eq!(orders.goes_on(), Err(Ended::Stopped));
        assert_eq!(told.try_recv(), Err(TryRecvError::Empty), "it is not done yet");
        let mut stops = orders.stops();
        stops.pop().expect("one waits").send(()).expect("it listens");
        assert_eq!(told.try_recv(), Ok(()));
        assert!(stops.is_empty() && orders.stops().is_empty());
        let (stopped, mut told) = oneshot::channel();
        sender.send(Arrived::now(Order::Stop(stopped))).expect("it listens");
        drop((sender, receiver));
        assert_eq!(told.try_recv(), Err(TryRecvError::Closed), "the thread has ended before");
    }

    /// A button that is clicked twice answers its own question once, and never the next one.
    #[test]
    fn an_answer_counts_for_its_own_question_alone() {
        let (sender, receiver) = channel();
        let mut orders = Orders::of(&receiver);
        for (question, answer) in [(1, true), (1, true), (2, false)] {
            sender.send(Arrived::now(Order::Answer(question, answer))).expect("it listens");
        }
        assert_eq!(orders.answer(1), Ok(true));
        assert_eq!(orders.answer(2), Ok(false));
    }

    fn jog() -> Order {
        Order::Jog(Direction::Extend, 10.0, Box::new(Rig::builtin("servo-b-tuned").expect("a built-in rig")))
    }

    /// While another order is carried out, confirmations of a button may queue up before the order that ends the motion.
    #[test]
    fn a_jog_is_passed_over_when_it_is_old_or_the_button_was_let_go_behind_it() {
        let (sender, receiver) = channel();
        let mut orders = Orders::of(&receiver);
        let old = Instant::now().checked_sub(2 * JOG_SILENCE).expect("a time");
        sender.send(Arrived { order: jog(), at: old }).expect("it listens");
        for order in [jog(), jog(), Order::Release, jog()] {
            sender.send(Arrived::now(order)).expect("it listens");
        }
        assert!(orders.confirmed(Direction::Extend).is_some_and(|at| at > old));
        assert_eq!(orders.confirmed(Direction::Retract), None);
        let mut next = || orders.next(Duration::ZERO).expect("a page").map(|arrived| arrived.order);
        assert!(matches!(next(), Some(Order::Release)));
        assert!(matches!(next(), Some(Order::Jog(..))), "it is held again");
        assert!(next().is_none());
    }

    #[test]
    fn what_is_about_to_begin_is_not_wanted_once_it_is_ended_or_the_page_has_gone() {
        for (order, of_a_test, of_a_jog) in [
            (Order::Alive, Ok(()), Ok(())),
            (Order::Release, Ok(()), Err(Ended::Aborted)),
            (Order::Disarm, Err(Ended::Aborted), Err(Ended::Aborted)),
            (stop(), Err(Ended::Stopped), Err(Ended::Stopped)),
        ] {
            let (sender, receiver) = channel();
            let mut orders = Orders::of(&receiver);
            sender.send(Arrived::now(order)).expect("it listens");
            assert_eq!([orders.still_wants(false), orders.still_wants(true)], [of_a_test, of_a_jog]);
            assert!(matches!(orders.next(Duration::ZERO), Ok(Some(_))), "it is carried out later");
            sender.send(Arrived::now(Order::Home)).expect("it listens");
            drop(sender);
            assert_eq!(orders.still_wants(false), Err(Ended::Gone));
            assert!(matches!(orders.next(Duration::ZERO), Err(Gone)), "who has gone moves nothing");
        }
    }

    /// Its orders may have waited for longer than that.
    #[test]
    fn a_page_is_silent_since_its_last_order_came() {
        let (sender, receiver) = channel();
        let mut orders = Orders::of(&receiver);
        let old = Instant::now().checked_sub(2 * PAGE_SILENCE).expect("a time");
        sender.send(Arrived { order: Order::Alive, at: old }).expect("it listens");
        assert_eq!(orders.still_wants(false), Err(Ended::Silent));
        sender.send(Arrived::now(Order::Alive)).expect("it listens");
        assert!(!orders.is_silent(), "a newer one waits");
    }
}
