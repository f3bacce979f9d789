//! A small system of linear equations.

/// s - J in triangular factors, rows exchanged for the largest pivot.
pub(crate) struct Factors<const N: usize> {
    rows: [[f64; N]; N],
    /// Which row each step of the elimination took.
    taken: [usize; N],
    s: f64,
    /// The unknowns that have an equation of their own: where a load is stuck its velocity has no rounding.
    alone: [bool; N],
}

impl<const N: usize> Factors<N> {
    /// A matrix without an inverse leaves no numbers in the solutions.
    pub fn of(jacobian: [[f64; N]; N], s: f64) -> Factors<N> {
        let alone = jacobian.map(|row| row.iter().all(|value| *value == 0.0));
        let mut rows = jacobian.map(|row| row.map(|value| -value));
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] += s;
        }
        let mut factors = Factors { rows, taken: std::array::from_fn(|i| i), s, alone };
        for k in 0..N {
            factors.eliminate(k);
        }
        factors
    }

    fn eliminate(&mut self, k: usize) {
        let pivot = (k..N).max_by(|&a, &b| self.rows[a][k].abs().total_cmp(&self.rows[b][k].abs()));
        let pivot = pivot.unwrap_or(k);
        self.rows.swap(k, pivot);
        self.taken[k] = pivot;
        let row = self.rows[k];
        for lower in &mut self.rows[k + 1..] {
            lower[k] /= row[k];
            for j in k + 1..N {
                lower[j] -= lower[k] * row[j];
            }
        }
    }

    pub fn solve(&self, given: [f64; N]) -> [f64; N] {
        let mut right = given;
        for k in 0..N {
            right.swap(k, self.taken[k]);
        }
        for i in 0..N {
            let known: f64 = (0..i).map(|j| self.rows[i][j] * right[j]).sum();
            right[i] -= known;
        }
        for i in (0..N).rev() {
            let known: f64 = (i + 1..N).map(|j| self.rows[i][j] * right[j]).sum();
            right[i] = (right[i] - known) / self.rows[i][i];
        }
        for i in (0..N).filter(|i| self.alone[*i]) {
            right[i] = given[i] / self.s;
        }
        right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_needs_its_rows_exchanged_is_solved() {
        let jacobian = [[0.0, -2.0, 1.0], [-1.0, 0.0, -3.0], [-4.0, -1.0, 0.0]];
        let x = [3.0, -2.0, 5.0];
        let right = std::array::from_fn(|i| (0..3).map(|j| -jacobian[i][j] * x[j]).sum());
        let found = Factors::of(jacobian, 0.0).solve(right);
        assert!(found.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }

    #[test]
    fn a_state_that_rests_does_so_exactly_whatever_depends_on_it() {
        for k in 1..100 {
            let of = |part: f64| part * f64::from(k);
            let jacobian = [[0.0, of(1e3), 0.0], [0.0; 3], [1e7, of(-3e5), -7.1]];
            let found = Factors::of(jacobian, 13.7).solve([1.3, 0.0, of(1e5)]);
            assert_eq!(found[1], 0.0, "{k}");
        }
    }
}
