//! From any motion to rest at a target: a polynomial of the seventh order.

#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    pub x: f64,
    pub v: f64,
    pub a: f64,
    pub j: f64,
}

#[derive(Default)]
pub struct Trajectory {
    pub c: [f64; 8],
    pub k: f64,
    pub length: f64,
}

impl Trajectory {
    pub fn to(target: f64, from: Point, length: f64) -> Trajectory {
        let t = length;
        let (c1, c2) = (from.v * t, from.a * t * t / 2.0);
        let r = [target - from.x - c1 - c2, -c1 - 2.0 * c2, -2.0 * c2];
        let sum = |k: [f64; 3]| (0..3).map(|i| k[i] * r[i]).sum::<f64>();
        let c = [
            sum([35.0, -15.0, 2.5]),
            sum([-84.0, 39.0, -7.0]),
            sum([70.0, -34.0, 6.5]),
            sum([-20.0, 10.0, -2.0]),
        ];
        Trajectory { c: [from.x, c1, c2, 0.0, c[0], c[1], c[2], c[3]], k: 0.0, length }
    }

    pub fn at(&self, k: f64) -> Point {
        let (s, t) = ((k / self.length).min(1.0), self.length);
        let mut p = [0.0; 4];
        for c in self.c.iter().rev() {
            p = [p[0] * s + c, p[1] * s + p[0], p[2] * s + p[1], p[3] * s + p[2]];
        }
        let moving = f64::from(u8::from(s < 1.0));
        Point {
            x: p[0],
            v: moving * p[1] / t,
            a: moving * 2.0 * p[2] / (t * t),
            j: moving * 6.0 * p[3] / (t * t * t),
        }
    }
}
