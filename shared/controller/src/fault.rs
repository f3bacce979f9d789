//! Why a drive trips.

/// Why the supervisor tripped. The codes are stored and sent: they never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// A stop was requested.
    Stop = 1,
    /// The position left the stroke by more than the margin.
    PositionOutside = 2,
    /// The encoder moved further in one sample than the drive can move.
    EncoderStep = 3,
    /// A sample came later than allowed, or not at all.
    LateSample = 4,
    /// The host was silent for too long during a move or a homing run.
    HostSilent = 5,
    /// A run was requested while the drive was disarmed.
    CommandWhileDisarmed = 6,
    /// A pressure sensor reads an impossible pressure: it is open or shorted.
    SensorRange = 7,
    /// The valve is open, but nothing moves.
    NoMotion = 8,
    /// The homing run found neither stop nor switch.
    HomingFailed = 9,
    /// The stored configuration is damaged.
    BadConfiguration = 10,
    /// The watchdog reset the board.
    Watchdog = 11,
    /// The firmware broke down and reset the board.
    Panic = 12,
    /// The valve is at its null, but the cylinder moves.
    MotionAtNull = 13,
    /// An output came later than allowed.
    LateOutput = 14,
    /// The clock of the processor failed.
    ClockFailed = 15,
    /// A trial of the watchdog: the board does not feed it until it has reset the board.
    WatchdogTried = 16,
    /// What a law has learned of its drive stays at a bound: its model is not that of the drive.
    ModelAtBound = 17,
    /// The pressures contradict valve and motion: a sensor that fails within its range.
    PressureDoubtful = 18,
}

impl Fault {
    /// Every fault, in the order of the codes.
    pub const ALL: [Fault; 18] = [
        Fault::Stop,
        Fault::PositionOutside,
        Fault::EncoderStep,
        Fault::LateSample,
        Fault::HostSilent,
        Fault::CommandWhileDisarmed,
        Fault::SensorRange,
        Fault::NoMotion,
        Fault::HomingFailed,
        Fault::BadConfiguration,
        Fault::Watchdog,
        Fault::Panic,
        Fault::MotionAtNull,
        Fault::LateOutput,
        Fault::ClockFailed,
        Fault::WatchdogTried,
        Fault::ModelAtBound,
        Fault::PressureDoubtful,
    ];

    /// The stored and sent code.
    #[must_use]
    pub fn code(self) -> u8 {
        self as u8
    }

    /// The fault with this code.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Fault> {
        Fault::ALL.into_iter().find(|fault| fault.code() == code)
    }
}
