//! A ball that loses a fifth of its speed in each bounce: the instants that are located, and their closed form.
//! Run it: cargo run -p pneudrive-solver --example bouncing_ball

use pneudrive_solver::{Derivative, Event, IntegrationError, Integrator, Method, System};

/// When it has bounced, s; its states are height (m) and velocity (m/s).
struct Ball(Vec<f64>);

impl System<2, 1, 0> for Ball {
    fn derivative(&mut self, _t: f64, x: &[f64; 2]) -> [f64; 2] {
        [x[1], -9.81]
    }
    fn guards(&mut self, _t: f64, x: &[f64; 2]) -> [f64; 1] {
        [x[0]]
    }
    fn handle_event(&mut self, _event: Event, t: f64, x: &mut [f64; 2]) -> Derivative {
        self.0.push(t);
        *x = [0.0, -0.8 * x[1]];
        Derivative::Discontinuous
    }
}

fn main() -> Result<(), IntegrationError> {
    let (mut ball, fall) = (Ball(Vec::new()), f64::sqrt(2.0 / 9.81));
    Integrator::new(Method::DormandPrince, 1e-10, [1.0; 2], [1.0, 0.0]).integrate_to(&mut ball, 3.0, 3.0)?;
    for (n, located) in (0..).zip(ball.0) {
        println!("bounce {n}: {located:.12} s, closed form {:.12} s", fall * (9.0 - 8.0 * 0.8_f64.powi(n)));
    }
    Ok(())
}
