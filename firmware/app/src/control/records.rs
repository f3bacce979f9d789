//! The orders of the digital inputs to the drive ([`crate::selector`]).

use core::borrow::BorrowMut;

use pneudrive_controller::law::Loop;
use pneudrive_controller::sequencer::Arrival;
use pneudrive_controller::{Fault, Mode, Refusal};
use pneudrive_protocol::io::{input, output, refused};
use pneudrive_protocol::{code, session};

use super::Control;
use crate::board::Board;
use crate::configuration::Prepared;
use crate::lamp;
use crate::move_records::MoveRecord;
use crate::ownership::Requester;
use crate::recorder::Recorder;
use crate::selector::{InputEvents, Phase};

/// The inputs' name as an owner.
const NAME: &str = "digital inputs";

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Reads the inputs and drives the outputs. Returns whether a record is to be started.
    pub(crate) fn heed_inputs(&mut self, board: &mut impl Board) -> bool {
        self.selector.notice(self.is_tripped());
        let taken = self.selector.take(board.inputs(), &self.configuration.config().timing);
        if self.selector.stops() && self.state.supervisor.drives() {
            self.trip(Fault::Stop);
        }
        if self.inputs_own() {
            match self.selector.enables() {
                true => self.ownership.refresh(board.host_clock_ms()),
                false => self.disarm(),
            }
        }
        let may_acknowledge = !self.configuration.is_lost();
        self.selector
            .acknowledge(self.is_tripped() && may_acknowledge, taken.acknowledges && may_acknowledge);
        self.follow_phase();
        let begins = self.heed_start(&taken);
        self.tell(board);
        begins || self.selector.phase == Phase::Waiting
    }

    /// Whether a start has settled that is to begin something.
    fn heed_start(&mut self, taken: &InputEvents) -> bool {
        if self.state.supervisor.moves() {
            return false;
        }
        if taken.unsettled {
            self.selector.refused = refused::UNSETTLED;
        }
        if let Some(number) = taken.starts {
            (self.selector.number, self.selector.refused) = (number, 0);
        }
        taken.starts.is_some()
    }

    fn is_tripped(&self) -> bool {
        matches!(self.state.supervisor.mode(), Mode::Fault(_))
    }

    fn inputs_own(&self) -> bool {
        self.state.supervisor.drives() && self.ownership.is_of_inputs()
    }

    /// The state of the inputs' last order.
    fn follow_phase(&mut self) {
        let mode = self.state.supervisor.mode();
        let arrived = self.state.sequencer().arrival() == Arrival::Arrived;
        let index = self.state.observation().index;
        self.selector.phase = match (self.selector.phase, mode) {
            _ if !self.inputs_own() => Phase::Idle,
            (Phase::Homing, Mode::Armed) => Phase::InPosition,
            (Phase::Moving { dwell, arrived_at: None }, Mode::Running) if arrived => {
                Phase::Moving { dwell, arrived_at: Some(index) }
            }
            (phase, _) => phase,
        };
        if let Phase::Moving { dwell, arrived_at } = self.selector.phase {
            let rested = arrived_at.is_some_and(|at| index.wrapping_sub(at) >= dwell);
            if rested && mode == Mode::Running {
                self.state.finish();
            }
            if rested || mode == Mode::Done {
                // A run that ends by itself waits for the end of its move (`on_arrival`).
                self.selector.phase = if arrived { Phase::InPosition } else { Phase::Idle };
            }
        }
    }

    /// The outputs, and the lamp.
    #[inline(never)] // One copy of it.
    fn tell(&mut self, board: &mut impl Board) {
        let (mode, config) = (self.state.supervisor.mode(), self.configuration.config());
        let faulty = self.selector.awaits_acknowledgement(self.is_tripped());
        let taken = self.state.supervisor.drives() && !self.ownership.is_of_inputs();
        let ready = self.selector.permits()
            && !(faulty || taken || self.state.supervisor.moves() || self.configuration.is_lost())
            && config.law.control_loop == Loop::Closed;
        let inside = self.state.observation().error.unsigned_abs() <= config.motion.tolerance;
        let there = self.selector.phase == Phase::InPosition && (inside || mode == Mode::Armed);
        let pattern = lamp::pattern(mode, self.configuration.is_lost());
        let lit = lamp::is_lit(pattern, board.now_us() as u32);
        self.selector.tell(output::READY, ready);
        self.selector.tell(output::IN_POSITION, there);
        self.selector.tell(output::FAULT, faulty);
        self.selector.tell(output::LAMP, lit);
        board.show(self.selector.outputs);
    }

    /// Starts the selected record, with the learned null offset of the last run; notes why not.
    pub(crate) fn begin_selected(&mut self, learned: Option<&Prepared>, board: &mut impl Board) {
        let was_enabled = self.state.supervisor.drives();
        let begun = self.try_selected(learned, board);
        self.selector.refused = begun.err().unwrap_or(0);
        if begun == Err(Refusal::ValveNotAtNull.code()) && self.inputs_own() {
            self.selector.phase = Phase::Waiting;
        } else if begun.is_err() && !was_enabled {
            // The drive was enabled for this record alone.
            self.disarm();
        }
        self.tell(board);
    }

    fn try_selected(&mut self, learned: Option<&Prepared>, board: &mut impl Board) -> Result<(), u8> {
        let number = self.selector.number;
        let record = self.may_begin(number)?;
        let code = |refusal: Refusal| refusal.code();
        if let Some(record) = record {
            self.test.become_record(number, record.next);
        }
        let by = Requester { session: session::INPUTS, host: NAME, sequence: None };
        self.arm_with(learned, &by, board).map_err(code)?;
        self.selector.phase = match record {
            None => {
                self.home(board).map_err(code)?;
                Phase::Homing
            }
            Some(MoveRecord { dwell, .. }) => {
                self.set_off(board).map_err(code)?;
                Phase::Moving { dwell, arrived_at: None }
            }
        };
        Ok(())
    }

    /// The record of a number, None for homing, if the drive may begin it.
    fn may_begin(&self, number: u8) -> Result<Option<MoveRecord>, u8> {
        let (config, supervisor) = (self.configuration.config(), &self.state.supervisor);
        if supervisor.drives() && !self.ownership.is_of_inputs() {
            return Err(code::OWNED);
        }
        if self.selector.awaits_acknowledgement(self.is_tripped()) {
            return Err(refused::FAULT);
        }
        if config.law.control_loop == Loop::Open {
            return Err(refused::OPEN_LOOP);
        }
        if number == input::HOMING {
            return Ok(None);
        }
        let record = self.configuration.records().get(number).ok_or(refused::NO_RECORD)?;
        if !supervisor.is_referenced() && self.absolute_zero().is_none() {
            return Err(Refusal::NotReferenced.code());
        }
        match record.next.extremes().iter().all(|&end| config.limits.allows(end)) {
            true => Ok(Some(record)),
            false => Err(Refusal::BeyondSoftLimit.code()),
        }
    }
}
