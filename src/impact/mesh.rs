//! Where the nodes and elements of a scene are, and what acts on them.

use std::ops::Range;

use crate::fem::{MassMatrix, touching_bars};
use crate::scene::{Bar, ContactSite, End, Scene};

/// One bar in the vector of all nodes; a fixed end has no node.
#[derive(Debug, Clone, PartialEq)]
struct Span {
    nodes: Range<usize>,
    left_fixed: bool,
    right_fixed: bool,
    /// Of the left end, with the bars laid end to end, m.
    start: f64,
}

/// The nodes of a scene from left to right, numbered as in its pencil.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    scene: Scene,
    spans: Vec<Span>,
}

impl Mesh {
    /// The mesh of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let last = scene.bars().len() - 1;
        let (mut first, mut start) = (0, 0.0);
        let mut spans = Vec::with_capacity(last + 1);
        for (i, bar) in scene.bars().iter().enumerate() {
            let left_fixed = i == 0 && scene.left() == End::Fixed;
            let right_fixed = i == last && scene.right() == End::Fixed;
            let end = first + bar.elements + 1 - usize::from(left_fixed) - usize::from(right_fixed);
            spans.push(Span { nodes: first..end, left_fixed, right_fixed, start });
            first = end;
            start += bar.length;
        }
        Self { scene: scene.clone(), spans }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.spans.last().map_or(0, |span| span.nodes.end)
    }

    fn bars(&self) -> impl Iterator<Item = (&Bar, &Span)> {
        self.scene.bars().iter().zip(&self.spans)
    }

    /// The initial velocity of every node, m/s.
    pub fn velocity(&self) -> Vec<f64> {
        self.bars().flat_map(|(bar, span)| std::iter::repeat_n(bar.velocity, span.nodes.len())).collect()
    }

    /// The nodal forces of the body force, N; empty without one. Each element gives rho A h b/2 to either node.
    pub fn load(&self) -> Vec<f64> {
        let gravity = self.scene.impact().map_or(0.0, |impact| impact.gravity);
        if gravity == 0.0 {
            return Vec::new();
        }
        let mut load = vec![0.0; self.nodes()];
        for (bar, span) in self.bars() {
            let share = 0.5 * bar.element_mass() * gravity;
            for element in 0..bar.elements {
                span.ends(bar, element).into_iter().flatten().for_each(|node| load[node] += share);
            }
        }
        load
    }

    /// h of every contact, m: of the touching element of higher frequency, the left one on a tie.
    pub fn contact_lengths(&self, mass: MassMatrix) -> Vec<f64> {
        let length = |site: ContactSite| {
            let touching = touching_bars(&self.scene, site);
            let higher = |a: &Bar, b: &Bar| mass.element_eigenvalue(b) > mass.element_eigenvalue(a);
            let reference = touching.iter().reduce(|a, b| if higher(a, b) { b } else { a });
            reference.map_or(f64::NAN, Bar::element_length)
        };
        self.scene.contact_sites().into_iter().map(length).collect()
    }

    /// The centres of all elements as (bar, distance from its left end, m).
    pub fn centres(&self) -> Vec<(usize, f64)> {
        let bar = |(i, bar): (usize, &Bar)| {
            let h = bar.element_length();
            (0..bar.elements).map(move |e| (i, (e as f64 + 0.5) * h)).collect::<Vec<_>>()
        };
        self.scene.bars().iter().enumerate().flat_map(bar).collect()
    }

    /// The position of the left end of bar `bar` with the bars laid end to end, m.
    pub fn start(&self, bar: usize) -> f64 {
        self.spans[bar].start
    }

    /// The stress E du/dx of every element, Pa, positive in tension.
    pub fn stress(&self, u: &[f64]) -> Vec<f64> {
        let mut stress = Vec::with_capacity(self.scene.elements());
        for (bar, span) in self.bars() {
            let stiffness = bar.youngs_modulus / bar.element_length();
            for element in 0..bar.elements {
                let [left, right] = span.ends(bar, element).map(|node| node.map_or(0.0, |i| u[i]));
                stress.push(stiffness * (right - left));
            }
        }
        stress
    }
}

impl Span {
    /// The nodes of an element; `None` at a fixed end.
    fn ends(&self, bar: &Bar, element: usize) -> [Option<usize>; 2] {
        let node = |k: usize| {
            let fixed = (k == 0 && self.left_fixed) || (k == bar.elements && self.right_fixed);
            (!fixed).then(|| self.nodes.start + k - usize::from(self.left_fixed))
        };
        [node(element), node(element + 1)]
    }
}
