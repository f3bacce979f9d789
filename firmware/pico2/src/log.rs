//! What the program tells a debug probe, with the feature `log`; nothing of it is in an image without. The control's
//! interrupts tell nothing.

/// Tells, as `defmt` does: `tell!(error, "reset by fault {=u8}", code)`.
macro_rules! tell {
    ($level:ident, $text:literal $(, $value:expr)* $(,)?) => {{
        #[cfg(feature = "log")]
        defmt::$level!($text $(, $value)*);
        #[cfg(not(feature = "log"))]
        {
            $(let _ = $value;)*
        }
    }};
}

pub(crate) use tell;
