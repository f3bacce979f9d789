//! The swings of a position: from one turning point to the next.
//!
//! A turning point counts when the position has come back from it by more than a band. The first position and the end of
//! the move are not turning points.

/// From one turning point to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Swing {
    /// Time of its beginning, s.
    pub from_s: f64,
    /// Time of its end, s.
    pub to_s: f64,
    /// Time at half its height, s: sharper than its ends, where the position is flat.
    pub middle_s: f64,
    /// Its size, mm.
    pub size_mm: f64,
}

/// The whole swings of a position (mm) over time (s) that come back by more than `band_mm`.
pub(super) fn swings(time: &[f64], position: &[f64], band_mm: f64) -> Vec<Swing> {
    let turns = turning_points(position, band_mm);
    turns.windows(2).map(|ends| swing(time, position, ends[0], ends[1])).collect()
}

fn swing(time: &[f64], position: &[f64], from: usize, to: usize) -> Swing {
    let middle = (position[from] + position[to]) / 2.0;
    let direction = (position[to] - position[from]).signum();
    let beyond = |k: &usize| (position[*k] - middle) * direction >= 0.0;
    let after = (from + 1..=to).find(beyond).unwrap_or(to);
    let (before, here) = (position[after - 1], position[after]);
    let part = if here == before { 0.0 } else { (middle - before) / (here - before) };
    Swing {
        from_s: time[from],
        to_s: time[to],
        middle_s: time[after - 1] + part * (time[after] - time[after - 1]),
        size_mm: (position[to] - position[from]).abs(),
    }
}

/// Indices of the turning points, without the first value.
fn turning_points(position: &[f64], band_mm: f64) -> Vec<usize> {
    let mut turns = Vec::new();
    let (mut low, mut high) = (0, 0);
    // 1 while the position rises, -1 while it falls, 0 until it has left its first value.
    let mut direction = 0;
    for (k, &here) in position.iter().enumerate() {
        if here > position[high] {
            high = k;
        }
        if here < position[low] {
            low = k;
        }
        if direction >= 0 && position[high] - here > band_mm {
            turns.extend((direction > 0).then_some(high));
            (direction, low) = (-1, k);
        } else if direction <= 0 && here - position[low] > band_mm {
            turns.extend((direction < 0).then_some(low));
            (direction, high) = (1, k);
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swings_go_from_turning_point_to_turning_point_and_begin_after_the_first() {
        let position = [0.0, 5.0, 10.0, 9.5, 10.5, 2.0, 4.0, 8.0, 7.0];
        let time: Vec<f64> = (0..9).map(f64::from).collect();
        let found = swings(&time, &position, 1.0);
        let seen: Vec<(f64, f64, f64)> =
            found.iter().map(|one| (one.from_s, one.to_s, one.size_mm)).collect();
        assert_eq!(seen, [(4.0, 5.0, 8.5)], "from 10.5 to 2; 8 may still be passed");
        assert_eq!(found[0].middle_s, 4.5);
        assert_eq!(swings(&time, &position, 0.4).len(), 4, "9.5 and 8 are turning points, too");
        assert_eq!(swings(&time, &position, 20.0), []);
        assert_eq!(swings(&[], &[], 1.0), []);
    }
}
