//! Frames on a mocked bus, with the waits in front, in and behind them.

use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::spi::Transaction;
use pneudrive_interfaces::chip::frame::Times;

/// Who waits, for tests that look at the bytes alone.
pub const NO_WAIT: NoopDelay = NoopDelay;

/// A frame as a driver has to make it.
pub type Frame = [Transaction<u8>; 5];

/// These bytes go out, those come in, with the times of the chip in the frame.
pub fn exchange(times: Times, sent: &[u8], received: &[u8]) -> Frame {
    [
        Transaction::transaction_start(),
        Transaction::delay(times.lead_ns),
        Transaction::transfer_in_place(sent.to_vec(), received.to_vec()),
        Transaction::delay(times.trail_ns),
        Transaction::transaction_end(),
    ]
}
