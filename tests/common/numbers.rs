//! Random bars and scenes with one contact, the same in every run.

// Each test file uses its own part of this module.
#![allow(dead_code)]

use bipenalty::fem::MassMatrix;
use bipenalty::scene::{Bar, End, Scene};

/// Reproducible numbers in [0, 1): a 64-bit linear congruence (Knuth's MMIX constants).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }

    /// Uniform in the logarithm.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    pub fn bar(&mut self, spread: f64) -> Bar {
        let elements = 1 + (7.0 * self.next()) as usize;
        Bar {
            length: elements as f64 * 10f64.powf(self.between(-spread, spread)),
            elements,
            youngs_modulus: 10f64.powf(self.between(-spread, spread)),
            density: 10f64.powf(self.between(-spread, spread)),
            area: 10f64.powf(self.between(-spread, spread)),
            velocity: 0.0,
        }
    }

    /// One bar on a wall or two unequal bars, free, fixed at the far end or not.
    pub fn scene(&mut self) -> Scene {
        let far = self.one_of(&[End::Free, End::Free, End::Fixed]);
        if self.next() < 0.4 {
            let mut bar = self.bar(0.5);
            bar.elements = bar.elements.max(2);
            return Scene::new("random", far, vec![bar], End::Wall, None).unwrap();
        }
        let spread = self.one_of(&[0.0, 1.0]);
        let bars = vec![self.bar(spread), self.bar(spread)];
        Scene::new("random", End::Free, bars, far, None).unwrap()
    }

    pub fn mass(&mut self) -> MassMatrix {
        MassMatrix::new(self.one_of(&[0.0, 0.3, 0.5, 1.0])).unwrap()
    }
}
