//! The air: stiffness, and what the open valve does to the force.

use super::constants::Constants;

#[derive(Clone, Copy, Default)]
pub struct Air {
    pub stiffness: f64,
    pub extend: f64,
    pub retract: f64,
}

impl Constants {
    fn path(&self, up: f64, drop: f64, which: usize) -> f64 {
        let y = (self.steep[which] * drop / up).clamp(0.0, 1.0);
        self.flow[which] * up * (y * (2.0 - y)).sqrt()
    }

    pub fn air(&self, x: f64, p: [f64; 2]) -> Air {
        let x = x.clamp(0.0, self.stroke);
        let l = [self.dead[0] + x, self.dead[1] + self.stroke - x];
        let fill = |i: usize| self.path(1.0, 1.0 - p[i], 0) / l[i];
        let vent = |i: usize| self.path(p[i], p[i] - self.exhaust, 1) / l[i];
        Air {
            stiffness: self.n * (p[0] / l[0] + self.ratio * p[1] / l[1]),
            extend: fill(0) + vent(1),
            retract: vent(0) + fill(1),
        }
    }

    pub fn conductance(&self, spool: f64) -> f64 {
        self.leak + (1.0 - self.leak) * ((spool - self.lap) / self.span).clamp(0.0, 1.0)
    }
}
