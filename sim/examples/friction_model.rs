//! A friction model of one's own at the twin's interface: a load coasts on it to rest, beside the closed form.
//! Run it: cargo run -p pneudrive-sim --example friction_model (for rig files: docs/howto/adding-a-component.md).

use pneudrive_sim::component::friction::{Body, Contact, FrictionModel, States, coast};
use pneudrive_sim::{IntegrationError, Rig};

/// Stribeck's curve: from 70 N at rest down to 40 N, by exp(-v / 0.05 m/s).
struct Stribeck;

impl FrictionModel for Stribeck {
    fn of(_rig: &Rig) -> Stribeck {
        Stribeck
    }
    fn at_rest(&self, _applied: f64) -> (Contact, States) {
        (Contact::Free, States::default())
    }
    fn force(&self, body: &Body) -> f64 {
        body.velocity.signum() * (40.0 + 30.0 * (-body.velocity.abs() / 0.05).exp())
    }
}

fn main() -> Result<(), IntegrationError> {
    for velocity in [0.05, 0.2, 0.8_f64] {
        let stop = coast(&Stribeck, 1.6, velocity, 1.0)?.expect("friction stops it").time;
        let closed = 1.6 * 0.05 / 40.0 * ((40.0 * (velocity / 0.05).exp() + 30.0) / 70.0).ln();
        println!("from {velocity} m/s it stops after {stop:.9} s, closed form {closed:.9} s");
    }
    Ok(())
}
