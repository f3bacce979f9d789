//! The air: stiffness, and what the open valve does to the force, behind tubes or without them.

use super::constants::Constants;

#[derive(Clone, Copy)]
pub struct Air {
    pub stiffness: f64,
    pub extend: f64,
    pub retract: f64,
    /// What both would be without tubes, over what they are.
    pub narrow: [f64; 2],
}

impl Default for Air {
    fn default() -> Air {
        Air { stiffness: 0.0, extend: 0.0, retract: 0.0, narrow: [1.0; 2] }
    }
}

/// Without tubes and with them.
type Flows = [f64; 2];

impl Constants {
    /// From a pressure to a lower one.
    fn path(&self, up: f64, down: f64, which: usize) -> Flows {
        let drop = up - down;
        let y = (self.steep[which] * drop / up).clamp(0.0, 1.0);
        let phi = up * (y * (2.0 - y)).sqrt();
        let [choked, slight] = self.tubes[which];
        let near = if drop > 0.0 { (down / drop).min(256.0) } else { 256.0 };
        let u = 0.5 * phi * (choked + slight * near);
        let flow = self.flow[which] * phi;
        [flow, flow / (u.hypot(1.0) + u)]
    }

    pub fn air(&self, x: f64, p: [f64; 2]) -> Air {
        let x = x.clamp(0.0, self.stroke);
        let l = [self.dead[0] + x, self.dead[1] + self.stroke - x];
        let fill = |i: usize| self.path(1.0, p[i], 0).map(|flow| flow / l[i]);
        let vent = |i: usize| self.path(p[i], self.exhaust, 1).map(|flow| flow / l[i]);
        let both = |one: Flows, other: Flows| [one[0] + other[0], one[1] + other[1]];
        let (extend, retract) = (both(fill(0), vent(1)), both(vent(0), fill(1)));
        let narrow =
            |[without, with]: Flows| if with > 0.0 { (without / with).clamp(1.0, 16.0) } else { 1.0 };
        Air {
            stiffness: self.n * (p[0] / l[0] + self.ratio * p[1] / l[1]),
            extend: extend[1],
            retract: retract[1],
            narrow: [narrow(extend), narrow(retract)],
        }
    }

    pub fn conductance(&self, spool: f64) -> f64 {
        match &self.land {
            None => self.leak + (1.0 - self.leak) * ((spool - self.lap) / self.span).clamp(0.0, 1.0),
            Some(land) => {
                let t = (spool - self.lap).max(0.0).hypot(land.clearance) / land.port;
                (t / t.hypot(1.0) / land.end).min(1.0)
            }
        }
    }

    /// How far the spool has to be for a conductance.
    pub fn place(&self, conductance: f64) -> f64 {
        match &self.land {
            None => self.lap + self.span * (conductance - self.leak).max(0.0) / (1.0 - self.leak),
            Some(land) => {
                let r = conductance * land.end;
                let h = land.port * r / (1.0 - r * r).max(1e-9).sqrt();
                self.lap + (h * h - land.clearance * land.clearance).max(0.0).sqrt()
            }
        }
    }

    /// The rate of the force through a conductance to one side.
    pub fn rate(&self, open: f64, narrow: f64, conductance: f64) -> f64 {
        let k = 0.5 * (narrow - 1.0 / narrow) * conductance;
        open * narrow * conductance / (k.hypot(1.0) + k)
    }

    /// The conductance for a part of the rate of the open valve.
    pub fn part(&self, narrow: f64, of_rate: f64) -> f64 {
        (of_rate / (narrow * narrow - of_rate * (narrow * narrow - 1.0)).sqrt()).min(1.0)
    }

    /// E C(z) - R C(-z).
    pub fn rate_at(&self, air: &Air, spool: f64) -> f64 {
        self.rate(air.extend, air.narrow[0], self.conductance(spool))
            - self.rate(air.retract, air.narrow[1], self.conductance(-spool))
    }
}
