//! A day of a PLC: twenty thousand starts and stops through the digital inputs, without the pauses between them. Nothing
//! moves unasked, whatever the contacts do, and the flash is not worn out.

use crate::plc::oracle::Oracle;
use crate::plc::{CYCLE, Event, Machine, PERIOD_US, Random, cycle};
use pneudrive_app::inputs::attend;
use pneudrive_controller::{Command, Fault, Mode};
use pneudrive_protocol::ProfiledMove;
use pneudrive_protocol::change::{Entry, PART_BYTES};
use pneudrive_protocol::io::input::{ENABLE, RUN};
use pneudrive_protocol::io::output::FAULT;

/// Starts of a day.
const STARTS: u32 = 20_000;

/// Targets of records 1 to 3, counts.
const TARGETS: [i32; 3] = [200, 320, 500];

/// Events that a slot of the fault log holds before it is erased.
const MARKS: u32 = 432;

/// How far a drive that holds may be from its target, counts.
const NEAR: i32 = 16;

#[derive(Debug, Default)]
struct Figures {
    samples: u64,
    begun: u32,
    arrived: u32,
    stops_by_run: u32,
    stops_by_host: u32,
    late_samples: u32,
}

struct Day {
    machine: Machine,
    oracle: Oracle,
    random: Random,
    figures: Figures,
    /// The last readings of the inputs, and what has happened between them.
    recent: Vec<String>,
}

/// A drive with three records, which are stored, and its contacts on.
fn morning() -> Day {
    let mut machine = Machine::new();
    for (number, target) in (1..).zip(TARGETS) {
        let told = ProfiledMove { target, ..ProfiledMove::default() };
        let entry = Entry::MoveRecord { number, bytes: &told.to_bytes() };
        let mut room = [0; PART_BYTES];
        machine.control.take_change(entry.write(&mut room).expect("room")).expect("disarmed");
    }
    machine.control.save_parameters(&mut machine.board).expect("stored");
    machine.board.inputs = RUN | ENABLE;
    Day {
        machine,
        oracle: Oracle::default(),
        random: Random(20_000),
        figures: Figures::default(),
        recent: Vec::new(),
    }
}

impl Day {
    fn happens(&mut self, event: Event) {
        if matches!(event, Event::HostStops | Event::Late) {
            self.recent.push(format!("{event:?}"));
        }
        let board = &mut self.machine.board;
        match event {
            Event::Sets(inputs, true) => board.inputs |= inputs,
            Event::Sets(inputs, false) => board.inputs &= !inputs,
            Event::Becomes(inputs, to) => board.inputs = board.inputs & !inputs | to,
            Event::HostStops => {
                self.machine.stop();
                self.oracle.stop();
                self.figures.stops_by_host += 1;
            }
            Event::Late => {
                board.now_us += 5000;
                if self.oracle.in_force.is_some() && !self.oracle.begins {
                    self.oracle.trip();
                    self.figures.late_samples += 1;
                }
            }
        }
    }

    /// A sample, its output, and the idle task behind it.
    fn lives(&mut self) {
        let Machine { control, board, .. } = &mut self.machine;
        board.now_us += PERIOD_US;
        control.on_sample(board);
        board.now_us += 500;
        control.on_output(board);
        board.now_us -= 500;
        self.judge_output();
        let moved = self.moves();
        let had_tripped = self.oracle.tripped;
        let Machine { control, board, .. } = &mut self.machine;
        self.recent.push(format!("{:02x}{}", board.inputs, if moved { "m" } else { "" }));
        let due = self.oracle.reads(board.inputs, moved);
        attend(&mut (&mut **control, &mut *board));
        control.tidy_up(board).expect("stored");
        self.figures.stops_by_run += u32::from(self.oracle.tripped && !had_tripped);
        self.judge(moved, due);
        self.figures.samples += 1;
    }

    fn moves(&self) -> bool {
        self.machine.control.state().supervisor.moves()
    }

    /// A drive that nothing is asked of is off; one that holds is at its target.
    fn judge_output(&mut self) {
        let board = &self.machine.board;
        match self.oracle.in_force {
            None => assert_eq!(board.driven, Command::OFF, "{:?}", self.oracle),
            Some(number) if self.machine.mode() == Mode::Done => {
                let target = TARGETS[usize::from(number) - 1];
                let off = (board.position - target).abs();
                assert!(off <= NEAR, "it holds {off} counts beside {target}");
            }
            Some(_) => {}
        }
    }

    /// What is due begins, and nothing else does.
    fn judge(&mut self, moved: bool, due: Option<u8>) {
        let begun = self.moves() && !moved;
        let number = begun.then(|| self.machine.control.selector().number());
        let last = self.recent.len().saturating_sub(80);
        self.recent.drain(..last);
        assert_eq!(number, due, "sample {}: {:?}, {:?}", self.figures.samples, self.oracle, self.recent);
        let name = self.machine.control.test().name();
        assert!(number.is_none_or(|number| name == format!("record {number:02}")), "{name}");
        let tripped = matches!(self.machine.mode(), Mode::Fault(Fault::Stop | Fault::LateSample));
        assert_eq!(
            tripped,
            self.oracle.tripped,
            "sample {}: {:?}",
            self.figures.samples,
            self.machine.mode()
        );
        let shown = self.machine.board.shown & FAULT != 0;
        assert_eq!(shown, self.oracle.to_acknowledge, "sample {}: {:?}", self.figures.samples, self.oracle);
        self.figures.begun += u32::from(begun);
        self.figures.arrived += u32::from(moved && self.machine.mode() == Mode::Done);
    }

    /// A start, and what goes wrong around it.
    fn goes_on(&mut self, nth: u32) {
        // The null goes to and fro by some counts in the course of the day.
        let phase = (nth / 50 % 40) as i32;
        self.machine.board.null = (phase - 20).abs() - 10;
        let events = cycle(&mut self.random, self.oracle.to_acknowledge);
        let mut events = events.into_iter().peekable();
        for at in 0..CYCLE {
            while let Some((_, event)) = events.next_if(|&(when, _)| when <= at) {
                self.happens(event);
            }
            self.lives();
        }
        assert!(events.peek().is_none(), "all of it has happened");
    }
}

#[test]
fn a_day_of_starts_and_stops_moves_nothing_unasked_and_does_not_wear_the_flash() {
    let mut day = morning();
    let before = day.machine.erases();
    (0..STARTS).for_each(|nth| day.goes_on(nth));
    let erases: Vec<u32> =
        day.machine.erases().iter().zip(before).map(|(after, before)| after - before).collect();
    let figures = &day.figures;
    let trips = figures.stops_by_run + figures.stops_by_host + figures.late_samples;
    println!("{figures:?}, erases {erases:?}");
    assert!(figures.begun > STARTS / 2 && figures.arrived > STARTS / 3, "{figures:?}");
    assert!(
        figures.stops_by_host > 1500 && figures.stops_by_run > 500 && figures.late_samples > 300,
        "{figures:?}"
    );
    let [config, other_config, faults, other_faults] = erases[..] else { panic!("{erases:?}") };
    assert_eq!((config, other_config), (0, 0), "nothing was changed or learned");
    assert!(faults + other_faults <= trips / MARKS + 2, "{trips} trips, erases {erases:?}");
}
