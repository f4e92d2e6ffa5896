//! Definiteness in double-double arithmetic.

use crate::double_double::Dd;

/// Whether a symmetric matrix, by rows, is positive definite: the pivots of an elimination.
pub fn is_definite(mut a: Vec<Vec<Dd>>) -> bool {
    for p in 0..a.len() {
        let pivot = a[p].clone();
        if pivot[p].hi <= 0.0 {
            return false;
        }
        for row in &mut a[p + 1..] {
            let share = row[p] / pivot[p];
            row.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry = *entry - share * *above);
        }
    }
    true
}
