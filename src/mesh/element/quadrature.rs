//! Quadrature on reference elements: products of Gauss rules, and symmetric rules of simplices with positive weights.

use super::Coordinates;

/// A point of a rule and its weight; the weights sum to the measure of the reference element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraturePoint {
    /// Reference coordinates.
    pub at: Coordinates,
    /// Weight.
    pub weight: f64,
}

/// 1/sqrt(3): two points, exact to degree 3.
const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];
/// sqrt(3/5): three points, exact to degree 5.
const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
/// The rule of a direction that is not there.
const NONE: [(f64, f64); 1] = [(0.0, 1.0)];

const fn product<const N: usize>(rules: [&[(f64, f64)]; 3]) -> [QuadraturePoint; N] {
    let mut points = [QuadraturePoint { at: [0.0; 3], weight: 0.0 }; N];
    let mut at = 0;
    while at < N {
        let (nx, ny) = (rules[0].len(), rules[1].len());
        let (x, y, z) = (rules[0][at % nx], rules[1][at / nx % ny], rules[2][at / (nx * ny)]);
        points[at] = QuadraturePoint { at: [x.0, y.0, z.0], weight: x.1 * y.1 * z.1 };
        at += 1;
    }
    points
}

/// Two points.
pub const LINE_2: [QuadraturePoint; 2] = product([&GAUSS_2, &NONE, &NONE]);
/// Three points.
pub const LINE_3: [QuadraturePoint; 3] = product([&GAUSS_3, &NONE, &NONE]);
/// 2 x 2, exact to degree 3 in each direction.
pub const SQUARE_4: [QuadraturePoint; 4] = product([&GAUSS_2, &GAUSS_2, &NONE]);
/// 3 x 3, exact to degree 5 in each direction.
pub const SQUARE_9: [QuadraturePoint; 9] = product([&GAUSS_3, &GAUSS_3, &NONE]);
/// 2 x 2 x 2.
pub const CUBE_8: [QuadraturePoint; 8] = product([&GAUSS_2, &GAUSS_2, &GAUSS_2]);
/// 3 x 3 x 3.
pub const CUBE_27: [QuadraturePoint; 27] = product([&GAUSS_3, &GAUSS_3, &GAUSS_3]);

const fn point(x: f64, y: f64, z: f64, weight: f64) -> QuadraturePoint {
    QuadraturePoint { at: [x, y, z], weight }
}

/// The three points of a triangle with barycentric coordinates (1 - 2a, a, a).
const fn triangle_orbit(a: f64, weight: f64) -> [QuadraturePoint; 3] {
    let (b, w) = (1.0 - 2.0 * a, weight / 2.0);
    [point(a, a, 0.0, w), point(b, a, 0.0, w), point(a, b, 0.0, w)]
}

/// The four points of a tetrahedron with barycentric coordinates (1 - 3a, a, a, a).
const fn corner_orbit(a: f64, weight: f64) -> [QuadraturePoint; 4] {
    let (b, w) = (1.0 - 3.0 * a, weight / 6.0);
    [point(a, a, a, w), point(b, a, a, w), point(a, b, a, w), point(a, a, b, w)]
}

/// Degree 2 on the triangle.
pub const TRIANGLE_3: [QuadraturePoint; 3] = triangle_orbit(1.0 / 6.0, 1.0 / 3.0);
const TRIANGLE_A: [QuadraturePoint; 3] = triangle_orbit(0.445_948_490_915_964_9, 0.223_381_589_678_011_46);
const TRIANGLE_B: [QuadraturePoint; 3] = triangle_orbit(0.091_576_213_509_770_74, 0.109_951_743_655_321_87);
/// Degree 4 on the triangle (Strang and Fix; Dunavant, IJNME 21, 1985).
pub const TRIANGLE_6: [QuadraturePoint; 6] =
    [TRIANGLE_A[0], TRIANGLE_A[1], TRIANGLE_A[2], TRIANGLE_B[0], TRIANGLE_B[1], TRIANGLE_B[2]];

/// Degree 2 on the tetrahedron: (5 - sqrt(5))/20.
pub const TETRAHEDRON_4: [QuadraturePoint; 4] = corner_orbit(0.138_196_601_125_010_5, 0.25);
const TETRAHEDRON_A: [QuadraturePoint; 4] = corner_orbit(0.310_885_919_263_300_6, 0.112_687_925_718_015_85);
const TETRAHEDRON_B: [QuadraturePoint; 4] = corner_orbit(0.092_735_250_310_891_23, 0.073_493_043_116_361_95);
/// (c, c, d, d) with c + d = 1/2.
const C: f64 = 0.045_503_704_125_649_65;
const D: f64 = 0.5 - C;
const W: f64 = 0.042_546_020_777_081_466 / 6.0;
/// Degree 5 on the tetrahedron, with positive weights (Walkington, CMU 00-NA-023, 2000).
pub const TETRAHEDRON_14: [QuadraturePoint; 14] = [
    TETRAHEDRON_A[0],
    TETRAHEDRON_A[1],
    TETRAHEDRON_A[2],
    TETRAHEDRON_A[3],
    TETRAHEDRON_B[0],
    TETRAHEDRON_B[1],
    TETRAHEDRON_B[2],
    TETRAHEDRON_B[3],
    point(C, C, D, W),
    point(C, D, C, W),
    point(D, C, C, W),
    point(C, D, D, W),
    point(D, C, D, W),
    point(D, D, C, W),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: i32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    /// The integral of x^a y^b z^c over the unit simplex is a! b! c!/(a + b + c + d)!.
    #[test]
    fn simplex_rules_are_exact_to_their_degree() {
        let rules: [(&[QuadraturePoint], i32, i32); 4] =
            [(&TRIANGLE_3, 2, 2), (&TRIANGLE_6, 2, 4), (&TETRAHEDRON_4, 3, 2), (&TETRAHEDRON_14, 3, 5)];
        for (rule, dimension, degree) in rules {
            for (a, b, c) in (0..=degree)
                .flat_map(|a| (0..=degree).flat_map(move |b| (0..=degree).map(move |c| (a, b, c))))
            {
                if a + b + c > degree || (dimension == 2 && c > 0) {
                    continue;
                }
                let term =
                    |p: &QuadraturePoint| p.weight * p.at[0].powi(a) * p.at[1].powi(b) * p.at[2].powi(c);
                let sum: f64 = rule.iter().map(term).sum();
                let exact = factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + dimension);
                assert!((sum - exact).abs() < 4e-16, "{} points, {a} {b} {c}: {sum} {exact}", rule.len());
            }
        }
    }
}
