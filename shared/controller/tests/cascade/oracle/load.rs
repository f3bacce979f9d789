//! Mass, friction, standing force and viscous friction, learned in motion.

use super::constants::Constants;
use super::squares::Squares;

/// Three equal poles on speed, force and friction, and on what they began with.
struct Filter {
    v: [f64; 3],
    force: [f64; 3],
    slide: [f64; 3],
    left: [f64; 3],
}

#[derive(Default)]
pub struct Load {
    squares: Squares<4>,
    filter: Option<Filter>,
}

impl Load {
    pub fn mass(&self) -> f64 {
        (1.0 + 0.3 * self.squares.unknown[0]).clamp(0.25, 2.5)
    }

    pub fn friction(&self) -> f64 {
        (1.0 + 0.3 * self.squares.unknown[1]).clamp(0.3, 2.0)
    }

    pub fn viscous(&self, c: &Constants) -> f64 {
        c.viscous * (1.0 + self.squares.unknown[3]).clamp(0.0, 5.0)
    }

    pub fn standing(&self, c: &Constants) -> f64 {
        self.mass() * c.weight + c.constant + c.stiction * self.squares.unknown[2]
    }

    pub fn slide(&self, c: &Constants, sign: f64) -> f64 {
        self.friction() * c.coulomb(sign)
    }

    /// Half the prior deviation of the mass.
    pub fn may_be_exchanged(&mut self) {
        self.squares.doubt(0, 0.25);
    }

    pub fn forget(&mut self) {
        self.filter = None;
    }

    pub fn learn(&mut self, c: &Constants, step: f64, v: f64, force: f64, fits: bool) {
        if c.noise == 0.0 {
            return;
        }
        let slide = c.coulomb(if v > 0.0 { 1.0 } else { -1.0 });
        let rest = self.standing(c) + self.friction() * slide;
        let rest = rest.max(force - c.stiction).min(force + c.stiction);
        let filter = self.filter.get_or_insert(Filter {
            v: [0.0; 3],
            force: [rest; 3],
            slide: [slide; 3],
            left: [1.0; 3],
        });
        let w = 300.0 * c.period;
        let k = w / (1.0 + w);
        let pass = |y: &mut [f64; 3], u: f64| {
            let before = y[2];
            y[0] += k * (u - y[0]);
            y[1] += k * (y[0] - y[1]);
            y[2] += k * (y[1] - y[2]);
            before
        };
        let before = pass(&mut filter.v, step);
        let (speed, a) = (0.5 * (filter.v[2] + before), filter.v[2] - before);
        let force_then = pass(&mut filter.force, force);
        let slide_then = pass(&mut filter.slide, slide);
        let left = pass(&mut filter.left, 0.0);
        if !fits || speed.abs() <= c.speed(0.03) || speed * v <= 0.0 {
            return;
        }
        let inertia = a / c.acceleration + c.weight;
        let h = [0.3 * inertia, 0.3 * slide_then, c.stiction, c.viscous * speed].map(|h| h / c.noise);
        let known = inertia + slide_then + c.viscous * speed;
        let y = (force_then - c.constant - known) / c.noise;
        self.squares.fit(h, y, left * c.stiction / c.noise);
    }
}
