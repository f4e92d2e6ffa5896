//! The pressure of Hertz between bodies that first touch at a point, or along a line (K. L. Johnson, Contact Mechanics, 1985,
//! Secs. 4.1 and 4.2):
//! ```text
//! 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2       0 for a body that is held; 1/E for plane stress
//! space  a = (3 F R/(4 E*))^(1/3)      p0 = 3 F/(2 pi a^2)       p = p0 (1 - r^2/a^2)^(1/2)
//! plane  a = (4 F R/(pi E* t))^(1/2)   p0 = 2 F/(pi a t)
//! ```

use std::f64::consts::{PI, TAU};

use super::surface::{apex, minus, norm, surface_of};
use bipenalty::mesh::elasticity::{Material, Plane};
use bipenalty::mesh::element::Coordinates;
use bipenalty::mesh::{Elements, Place};
use bipenalty::pencil::Gap;

/// A contact that Hertz' theory describes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// R of the relative curvature, m.
    pub radius: f64,
    /// E*, Pa.
    pub modulus: f64,
    /// The part of the surface that is meshed: 1/4 of a sphere with two planes of symmetry.
    pub share: f64,
    /// Thickness, m; `None` in space.
    pub thickness: Option<f64>,
}

impl Hertz {
    /// The contact of a scene whose only two surfaces part like a sphere or a cylinder: -g0 = d^2/(2R) with the chord d
    /// from the node that touches first. `None` where R differs from node to node by more than a hundredth.
    pub fn of(elements: &Elements, places: &[Place], gaps: &[Gap]) -> Option<Self> {
        const ALIKE: f64 = 0.01;
        let first = places.first()?;
        if places.iter().any(|place| place.surfaces != first.surfaces) {
            return None;
        }
        let apex = apex(places, gaps, &first.surfaces)?;
        let touch = gaps.iter().map(|gap| gap.initial).fold(f64::NEG_INFINITY, f64::max);
        let others = places.iter().zip(gaps).filter(|(place, _)| place.node != apex.node);
        let chord = |place: &Place| norm(&minus(&place.coordinates, &apex.coordinates));
        let radii = others.map(|(place, gap)| chord(place).powi(2) / (2.0 * (touch - gap.initial)));
        let (low, high) = radii.fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
        // Also refuses what is flat, infinite or not a number.
        if !(low > 0.0 && high - low <= ALIKE * high && high.is_finite()) {
            return None;
        }
        let (body, ..) = surface_of(elements, apex)?;
        let compliance = |material: &Material| match elements.plane {
            Some(Plane::Stress) => 1.0 / material.youngs_modulus,
            _ => (1.0 - material.poissons_ratio.powi(2)) / material.youngs_modulus,
        };
        let other = elements.bodies.iter().find(|body| body.name == apex.bodies[1]);
        // A gap that feels its own node alone faces something rigid.
        let d = elements.dimension;
        let own = &elements.dofs[apex.node * d..(apex.node + 1) * d];
        let gap = &gaps[places.iter().position(|place| place == apex)?];
        let moves = gap.column.0.iter().any(|(dof, _)| !own.contains(dof));
        let second = other.filter(|_| moves).map_or(0.0, |body| compliance(&body.material));
        Some(Self {
            radius: 0.5 * (low + high),
            modulus: 1.0 / (compliance(&body.material) + second),
            share: share(elements, apex)?,
            thickness: elements.plane.map(|_| body.material.thickness),
        })
    }

    /// (a, p0) in m and Pa under the force (N) on what is meshed.
    pub fn under(&self, force: f64) -> (f64, f64) {
        let force = force / self.share;
        match self.thickness {
            None => {
                let a = (0.75 * force * self.radius / self.modulus).cbrt();
                (a, 1.5 * force / (PI * a * a))
            }
            Some(thickness) => {
                let force = force / thickness;
                let a = (4.0 * force * self.radius / (PI * self.modulus)).sqrt();
                (a, 2.0 * force / (PI * a))
            }
        }
    }
}

/// The angle of the faces at the apex over that of a plane; half of the sides at it in the plane.
fn share(elements: &Elements, apex: &Place) -> Option<f64> {
    let (body, faces, first) = surface_of(elements, apex)?;
    let node = (apex.node - first) as u32;
    let place = |node: u32| body.mesh.nodes[node as usize];
    let mut share = 0.0;
    for face in faces {
        let (nodes, element) = body.mesh.face(*face);
        let Some(at) = nodes.iter().position(|own| *own == node) else { continue };
        let n = element.corners;
        share += match (element.dimension, at < n) {
            (1, true) => 0.5,
            (1, false) => 1.0,
            // The middle of an edge.
            (_, false) => 0.5,
            (_, true) => {
                angle(&place(nodes[(at + 1) % n]), &place(node), &place(nodes[(at + n - 1) % n])) / TAU
            }
        };
    }
    (share > 0.0).then_some(share)
}

fn angle(a: &Coordinates, at: &Coordinates, b: &Coordinates) -> f64 {
    let (a, b) = (minus(a, at), minus(b, at));
    let cosine = a.iter().zip(&b).map(|(x, y)| x * y).sum::<f64>() / (norm(&a) * norm(&b));
    cosine.clamp(-1.0, 1.0).acos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bipenalty::fem::MassMatrix;
    use bipenalty::stability::AnyScene;

    fn of(scene: &str) -> Hertz {
        let path = format!("{}/scenes/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = AnyScene::load(&path).expect("a scene");
        let AnyScene::Mesh(scene) = scene else { panic!("a mesh") };
        let assembled = scene.assemble(MassMatrix::LUMPED).expect("matrices");
        let places: Vec<Place> = assembled.contacts.iter().map(|contact| contact.place.clone()).collect();
        Hertz::of(&assembled.elements, &places, &assembled.gaps()).expect("a contact of Hertz")
    }

    /// A quarter of a steel sphere of 10 mm on something rigid; p0 by Johnson's (4.24), which has no a.
    #[test]
    fn a_sphere_has_the_pressure_of_johnson() {
        let hertz = of("sphere-on-plane");
        let modulus = 210e9 / (1.0 - 0.09);
        // The mesh has the digits of its file; its facets at the apex are flat: h/R = 0.014.
        assert!((hertz.radius / 0.01 - 1.0).abs() < 1e-6, "{}", hertz.radius);
        assert!((hertz.share / 0.25 - 1.0).abs() < 0.014, "{}", hertz.share);
        assert!((hertz.modulus / modulus - 1.0).abs() < 1e-14, "{}", hertz.modulus);
        assert_eq!(hertz.thickness, None);
        let force: f64 = 9630.0;
        let (a, p0) = hertz.under(force);
        let whole = force / hertz.share;
        let johnson = (6.0 * whole * hertz.modulus.powi(2) / (PI.powi(3) * hertz.radius.powi(2))).cbrt();
        assert!((p0 / johnson - 1.0).abs() < 1e-14, "{p0} {johnson}");
        // 2 pi p0 a^2/3 is the force.
        assert!((TAU * p0 * a * a / 3.0 / whole - 1.0).abs() < 1e-14);
    }

    /// A steel disc of 50 mm on aluminium; p0 by Johnson's (4.45), and the force pi p0 a/2.
    #[test]
    fn a_disc_has_the_pressure_of_johnson() {
        let hertz = of("disc-on-plane");
        let modulus = 1.0 / ((1.0 - 0.09) / 210e9 + (1.0 - 0.33 * 0.33) / 70e9);
        assert!((hertz.radius / 0.05 - 1.0).abs() < 1e-6, "{}", hertz.radius);
        assert!((hertz.modulus / modulus - 1.0).abs() < 1e-14, "{}", hertz.modulus);
        assert_eq!((hertz.share, hertz.thickness), (1.0, Some(1.0)));
        let (a, p0) = hertz.under(1e6);
        assert!((p0 / (1e6 * modulus / (PI * hertz.radius)).sqrt() - 1.0).abs() < 1e-14);
        assert!((0.5 * PI * p0 * a / 1e6 - 1.0).abs() < 1e-14);
    }
}
