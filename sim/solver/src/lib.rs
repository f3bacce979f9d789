//! Integrates hybrid systems: ordinary differential equations that are smooth between events.
//!
//! ```text
//! dx/dt = f(t, x) in the present modes;  guard_i(t, x) < 0: a mode ends, and with it f or x changes
//! ```
//!
//! A [`System`] gives its derivative, its guards and its changes at an event; an [`Integrator`] steps it, locates
//! the events on the dense output of each step to the last digits, and gives the state at any time, so that a
//! sample costs no step.
//!
//! Methods: Dormand-Prince 5(4) and Merson 4(3), both explicit, and the Rosenbrock method RODAS 4(3) for stiff
//! stretches, to which it changes by itself and back.
//!
//! A ball that loses a fifth of its speed in each bounce:
//!
//! ```
//! use pneudrive_solver::{Derivative, Event, Integrator, Method, System};
//!
//! /// States: height (m) and velocity (m/s).
//! struct Ball;
//!
//! impl System<2, 1, 0> for Ball {
//!     fn derivative(&mut self, _t: f64, x: &[f64; 2]) -> [f64; 2] {
//!         [x[1], -9.81]
//!     }
//!     fn guards(&mut self, _t: f64, x: &[f64; 2]) -> [f64; 1] {
//!         [x[0]]
//!     }
//!     fn handle_event(&mut self, _event: Event, _t: f64, x: &mut [f64; 2]) -> Derivative {
//!         *x = [0.0, -0.8 * x[1]];
//!         Derivative::Discontinuous
//!     }
//! }
//!
//! // What counts as large: 1 m and 1 m/s; a step's error may be 1e-9 of it.
//! let mut integrator = Integrator::new(Method::DormandPrince, 1e-9, [1.0, 1.0], [1.0, 0.0]);
//!
//! // It falls for 0.4515 s, and is 0.8^2 of its height up at the top of its first bounce.
//! let fall = (2.0_f64 / 9.81).sqrt();
//! let [height, velocity] = *integrator.state_at(&mut Ball, 1.8 * fall)?;
//! assert!((height - 0.64).abs() < 1e-9 && velocity.abs() < 1e-9);
//! # Ok::<(), pneudrive_solver::IntegrationError>(())
//! ```
//!
//! `examples/bouncing_ball.rs` prints its bounces beside their closed form.

pub mod crossing;
mod dense_output;
mod error;
mod event_search;
mod explicit;
mod integrator;
mod linear;
mod progress;
mod root;
mod rosenbrock;
mod statistics;
mod step_size;
mod stiffness;
mod system;
mod tableau;

pub use error::IntegrationError;
pub use integrator::Integrator;
pub use root::bracketed_root;
pub use statistics::Statistics;
pub use system::{Derivative, Event, StepLimit, System};
pub use tableau::Method;
