//! The peripherals that the image uses, one file each with the section of the manual on which its model is based.
//!
//! RM0390 is the reference manual of the STM32F446, DS10693 its data sheet, PM0214 the programming manual of the
//! Cortex-M4. A model implements only what the image uses.

pub mod adc;
pub mod control_timer;
pub mod dac;
pub mod dma;
pub mod encoder_timer;
pub mod flash;
pub mod gpio;
pub mod pulse_timer;
pub mod pwr;
pub mod rcc;
pub mod system;
pub mod usart;
pub mod watchdog;
