//! What is modelled: elastic bars in a row, what holds their outer ends, and the contacts between them.
//!
//! Neighbouring bars touch through a penalty contact; an outer end is free, fixed, or pressed on a rigid wall.
//! A scene is data: it knows nothing of mass matrices or penalties.
//!
//! ```
//! use bipenalty::scene::{Bar, End, Scene, load};
//! let bar = Bar { length: 1.0, elements: 10, youngs_modulus: 70e9, density: 2700.0, area: 1e-4, velocity: 0.0 };
//! let scene = Scene::new("rod", End::Fixed, vec![bar.clone()], End::Wall, None)?;
//! assert_eq!((scene.elements(), scene.contact_sites().len()), (10, 1));
//! // What has no meaning is refused with its place, its value and what is allowed.
//! let wrong = Scene::new("rod", End::Free, vec![Bar { density: -1.0, ..bar }], End::Free, None).unwrap_err();
//! assert_eq!(wrong.place, "scene rod, bar 1, density");
//! assert_eq!(load("hunek")?.bars().len(), 2); // built in; a path reads a TOML file
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

mod builtin;
mod file;

pub use builtin::{BUILT_IN, built_in};
pub(crate) use file::{in_file, line_of, name_of, read};
pub use file::{load, parse};

use crate::error::Refusal;

/// What holds an outer end of the row of bars.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// Nothing.
    #[default]
    Free,
    /// The node does not move.
    Fixed,
    /// Penalty contact with a rigid wall ("Signorini").
    Wall,
}

/// A uniform elastic bar, meshed with linear two-node elements of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Length, m.
    pub length: f64,
    /// Number of elements, at least 1.
    pub elements: usize,
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Density rho, kg/m^3.
    pub density: f64,
    /// Cross-section A, m^2.
    pub area: f64,
    /// Initial velocity, m/s, positive to the right.
    pub velocity: f64,
}

impl Bar {
    /// A bar at rest with E = rho = A = h = 1.
    pub const fn unit(elements: usize) -> Self {
        let length = elements as f64;
        Self { length, elements, youngs_modulus: 1.0, density: 1.0, area: 1.0, velocity: 0.0 }
    }

    /// Element length h, m.
    pub fn element_length(&self) -> f64 {
        self.length / self.elements as f64
    }

    /// Stiffness of one element, EA/h, N/m.
    pub fn element_stiffness(&self) -> f64 {
        self.youngs_modulus * self.area / self.element_length()
    }

    /// Mass of one element, rho A h, kg.
    pub fn element_mass(&self) -> f64 {
        self.density * self.area * self.element_length()
    }

    /// Wave speed c0 = sqrt(E/rho), m/s.
    pub fn wave_speed(&self) -> f64 {
        (self.youngs_modulus / self.density).sqrt()
    }
}

/// What only time stepping needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Impact {
    /// Simulated time T, s.
    pub duration: f64,
    /// Initial distances, m, one a contact from left to right; the gap function starts at minus this.
    pub gaps: Vec<f64>,
    /// Body force per mass, m/s^2, positive to the right.
    pub gravity: f64,
}

/// Which contact of the row is meant, from left to right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSite {
    /// The left end of the first bar against a wall.
    LeftWall,
    /// The right end of bar `.0` against the left end of the next.
    Between(usize),
    /// The right end of the last bar against a wall.
    RightWall,
}

/// Bars from left to right with their outer ends. Made by [`Scene::new`], so that every scene is a valid one.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    name: String,
    left: End,
    right: End,
    bars: Vec<Bar>,
    impact: Option<Impact>,
}

impl Scene {
    /// A scene of `bars` from left to right.
    ///
    /// # Errors
    /// Refuses a name that is not made of letters, digits, '-' and '_', a bar whose data are not positive and finite, a
    /// combination whose element stiffness, mass or frequency leaves the range of f64, and a row without a node
    /// that can move.
    pub fn new(
        name: &str,
        left: End,
        bars: Vec<Bar>,
        right: End,
        impact: Option<Impact>,
    ) -> Result<Self, Refusal> {
        let scene = Self { name: name.to_owned(), left, right, bars, impact };
        scene.check(&|key| format!("scene {name}, {key}"))?;
        Ok(scene)
    }

    /// The checks of [`Scene::new`]; `place` turns a key such as `bar 2, length` into what the user knows it by.
    fn check(&self, place: &dyn Fn(&str) -> String) -> Result<(), Refusal> {
        let legal = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
        if self.name.is_empty() || !self.name.chars().all(legal) {
            return Err(Refusal::new(
                place("name"),
                format!("{:?}", self.name),
                "letters, digits, '-' and '_', at least one",
            ));
        }
        if self.bars.is_empty() {
            return Err(Refusal::new(place("bar"), "no bar", "at least one [[bar]]"));
        }
        for (i, bar) in self.bars.iter().enumerate() {
            check_bar(bar, &|key| place(&format!("bar {}, {key}", i + 1)))?;
        }
        if self.bars.len() == 1
            && self.bars[0].elements == 1
            && self.left == End::Fixed
            && self.right == End::Fixed
        {
            return Err(Refusal::new(
                place("bar 1, elements"),
                "1 between two fixed ends",
                "at least 2, so that a node can move",
            ));
        }
        self.check_impact(place)
    }

    fn check_impact(&self, place: &dyn Fn(&str) -> String) -> Result<(), Refusal> {
        let Some(impact) = &self.impact else { return Ok(()) };
        positive(impact.duration, &place("impact.duration"), "s")?;
        if !impact.gravity.is_finite() {
            return Err(Refusal::new(place("impact.gravity"), impact.gravity, "a finite number (m/s^2)"));
        }
        let contacts = self.contact_sites().len();
        if !impact.gaps.is_empty() && impact.gaps.len() != contacts {
            return Err(Refusal::new(
                place("impact.gaps"),
                format!("{} values", impact.gaps.len()),
                format!("none or one a contact, here {contacts}"),
            ));
        }
        match impact.gaps.iter().find(|gap| !gap.is_finite()) {
            Some(gap) => Err(Refusal::new(place("impact.gaps"), gap, "finite numbers (m)")),
            None => Ok(()),
        }
    }

    /// The name, used in records and file names.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What holds the left end of the first bar.
    pub fn left(&self) -> End {
        self.left
    }

    /// What holds the right end of the last bar.
    pub fn right(&self) -> End {
        self.right
    }

    /// The bars from left to right; never empty.
    pub fn bars(&self) -> &[Bar] {
        &self.bars
    }

    /// What time stepping needs, if the scene has it.
    pub fn impact(&self) -> Option<&Impact> {
        self.impact.as_ref()
    }

    /// Elements of all bars together.
    pub fn elements(&self) -> usize {
        self.bars.iter().map(|bar| bar.elements).sum()
    }

    /// The contacts from left to right.
    pub fn contact_sites(&self) -> Vec<ContactSite> {
        let mut sites = Vec::new();
        if self.left == End::Wall {
            sites.push(ContactSite::LeftWall);
        }
        sites.extend((0..self.bars.len() - 1).map(ContactSite::Between));
        if self.right == End::Wall {
            sites.push(ContactSite::RightWall);
        }
        sites
    }

    /// The same scene with `elements` in the first bar and the other bars in proportion (rounded, at least 1).
    ///
    /// # Errors
    /// As [`Scene::new`]; 0 elements and more than [`MAX_ELEMENTS`] in a bar are refused.
    pub fn with_elements(&self, elements: usize) -> Result<Self, Refusal> {
        let mut scene = self.clone();
        let factor = elements as f64 / self.bars[0].elements as f64;
        for bar in &mut scene.bars {
            bar.elements = (bar.elements as f64 * factor).round().max(1.0) as usize;
        }
        scene.bars[0].elements = elements;
        scene.check(&|key| format!("elements {elements}, scene {}, {key}", self.name))?;
        Ok(scene)
    }

    /// The scene seen in a mirror: bars, ends, gaps and velocities reversed. Its spectrum is the same.
    pub fn mirrored(&self) -> Self {
        let mut scene = self.clone();
        scene.bars.reverse();
        scene.bars.iter_mut().for_each(|bar| bar.velocity = -bar.velocity);
        (scene.left, scene.right) = (self.right, self.left);
        if let Some(impact) = &mut scene.impact {
            impact.gaps.reverse();
            impact.gravity = -impact.gravity;
        }
        scene
    }
}

/// More elements than this in one bar are refused: the pencil alone would need over 6 GB.
pub const MAX_ELEMENTS: usize = 100_000_000;

fn positive(value: f64, place: &str, unit: &str) -> Result<(), Refusal> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Refusal::new(place, value, format!("a positive finite number ({unit})")))
    }
}

fn check_bar(bar: &Bar, place: &dyn Fn(&str) -> String) -> Result<(), Refusal> {
    if bar.elements == 0 || bar.elements > MAX_ELEMENTS {
        return Err(Refusal::new(
            place("elements"),
            bar.elements,
            format!("an integer from 1 to {MAX_ELEMENTS}"),
        ));
    }
    positive(bar.length, &place("length"), "m")?;
    positive(bar.youngs_modulus, &place("youngs_modulus"), "Pa")?;
    positive(bar.density, &place("density"), "kg/m^3")?;
    positive(bar.area, &place("area"), "m^2")?;
    if !bar.velocity.is_finite() {
        return Err(Refusal::new(place("velocity"), bar.velocity, "a finite number (m/s)"));
    }
    // A subnormal product has lost digits that its quotient by h would not show.
    let products = [
        ("length", "element length h", bar.element_length()),
        ("youngs_modulus", "section stiffness E A", bar.youngs_modulus * bar.area),
        ("density", "section mass rho A", bar.density * bar.area),
        ("density", "squared wave speed E/rho", bar.youngs_modulus / bar.density),
    ];
    for (key, quantity, value) in products {
        if !value.is_normal() {
            let (low, high) = (f64::MIN_POSITIVE, f64::MAX);
            return Err(Refusal::new(
                place(key),
                format!("{quantity} = {value:e}"),
                format!("combinations with {low:e} <= {quantity} <= {high:e}"),
            ));
        }
    }
    let derived = [
        ("youngs_modulus", "element stiffness E A/h", bar.element_stiffness()),
        ("density", "element mass rho A h", bar.element_mass()),
        ("density", "squared frequency (c0/h)^2", bar.element_stiffness() / bar.element_mass()),
    ];
    for (key, quantity, value) in derived {
        if !(SMALLEST_DERIVED..=LARGEST_DERIVED).contains(&value) {
            return Err(Refusal::new(
                place(key),
                format!("{quantity} = {value:e}"),
                format!("combinations with {SMALLEST_DERIVED:e} <= {quantity} <= {LARGEST_DERIVED:e}"),
            ));
        }
    }
    Ok(())
}

/// Element stiffness, mass and squared frequency must lie in this range (SI), so that their products with the
/// penalties stay numbers; 1e-290 to 1e290 leaves 18 decades on either side.
const SMALLEST_DERIVED: f64 = 1e-290;
const LARGEST_DERIVED: f64 = 1e290;
