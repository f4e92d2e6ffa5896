//! A row of boxes that cannot move sideways is a row of bars: plane waves, with the exact solutions of bars.

use super::scene::{BodySource, MeshScene, MeshSource, Opponent};
use super::structured::{Cuboid, SIDES};
use crate::scene::{Bar, End, Impact, Scene};

/// The places of contacts from the low end, with their gaps, m.
type Gaps = Vec<(usize, f64)>;

/// One box with what it is made of.
struct Block<'a> {
    body: usize,
    source: &'a BodySource,
    cuboid: &'a Cuboid,
}

impl MeshScene {
    /// The row of bars in which this scene moves, from low to high coordinates; `None` where it may move otherwise.
    ///
    /// The bodies are boxes of one cross-section, one behind the other along one axis, each touching the next one, with a wall
    /// or a support at the ends or none. Every body has its sides held in their normal direction, or nu = 0, so that plane
    /// waves leave it plane: u(x, t) along the axis solves the equations of elasticity with the modulus lambda + 2 mu and
    /// no force on the sides but the normal one of the supports. With plane stress lambda is that of plane stress.
    pub fn as_bars(&self) -> Option<Scene> {
        let impact = self.impact.as_ref()?;
        let axis = self.axis()?;
        let blocks: Option<Vec<Block>> = self.bodies.iter().enumerate().map(Block::new).collect();
        let mut blocks = blocks?;
        blocks.sort_by(|a, b| a.cuboid.origin[axis].total_cmp(&b.cuboid.origin[axis]));
        let others = || (0..self.dimension).filter(move |b| *b != axis);
        let first = blocks[0].cuboid;
        let aligned = |block: &Block| {
            others()
                .all(|b| block.cuboid.size[b] == first.size[b] && block.cuboid.origin[b] == first.origin[b])
        };
        let straight = |v: &[f64; 3]| others().all(|b| v[b] == 0.0);
        let plane = |block: &Block| {
            aligned(block) && straight(&block.source.velocity) && self.stays_plane(block.body, axis)
        };
        if !straight(&impact.gravity) || !blocks.iter().all(plane) {
            return None;
        }
        let (mut gaps, ends) = self.meetings(&blocks, axis, &impact.gaps)?;
        let [left, right] = ends;
        let bars = blocks.iter().map(|block| {
            let material = &block.source.material;
            let (lambda, mu) = material.lame(self.plane);
            Bar {
                length: block.cuboid.size[axis],
                elements: block.cuboid.cells[axis],
                youngs_modulus: lambda + 2.0 * mu,
                density: material.density,
                area: material.thickness * others().map(|b| block.cuboid.size[b]).product::<f64>(),
                velocity: block.source.velocity[axis],
            }
        });
        gaps.sort_by_key(|(place, _)| *place);
        let gaps = gaps.into_iter().map(|(_, gap)| gap).collect();
        let impact = Impact { duration: impact.duration, gaps, gravity: impact.gravity[axis] };
        Scene::new(&self.name, left, bars.collect(), right, Some(impact)).ok()
    }

    /// The axis of all contacts.
    fn axis(&self) -> Option<usize> {
        let mut axes = self.contacts.iter().flat_map(|(own, other)| {
            let other = match other {
                Opponent::Surface(other) => Some(side(&other.surface)),
                Opponent::Wall => None,
            };
            std::iter::once(side(&own.surface)).chain(other)
        });
        let (axis, _) = axes.next()??;
        axes.all(|other| other.is_some_and(|(other, _)| other == axis)).then_some(axis)
    }

    /// Whether the sides of a body are held in their normal direction, or nu = 0, and nothing holds them along the axis.
    fn stays_plane(&self, body: usize, axis: usize) -> bool {
        let holds = || self.holds.iter().filter(|(surface, _)| surface.body == body);
        let lateral = |surface: &str| side(surface).is_some_and(|(normal, _)| normal != axis);
        let dragged =
            holds().any(|(surface, directions)| lateral(&surface.surface) && directions.contains(&axis));
        let held = |normal: usize, name: &str| {
            holds().any(|(surface, directions)| surface.surface == name && directions.contains(&normal))
        };
        let sides = (0..self.dimension).filter(|b| *b != axis);
        let all = sides.into_iter().all(|b| SIDES[b].iter().all(|name| held(b, name)));
        !dragged && (all || self.bodies[body].material.poissons_ratio == 0.0)
    }

    /// Where the bodies of a row meet: the places of its contacts from the low end with their gaps, m, and its ends.
    fn meetings(&self, blocks: &[Block], axis: usize, gaps: &[f64]) -> Option<(Gaps, [End; 2])> {
        let place = |body: usize| blocks.iter().position(|block| block.body == body);
        let last = blocks.len() - 1;
        let (mut found, mut ends) = (Vec::new(), [End::Free; 2]);
        for ((own, other), gap) in self.contacts.iter().zip(gaps) {
            let (at, high) = (place(own.body)?, side(&own.surface)?.1);
            match other {
                Opponent::Wall => {
                    let outer = if high == 1 { at == last } else { at == 0 };
                    if !outer {
                        return None;
                    }
                    ends[high] = End::Wall;
                    found = put(found, high * (last + 1), *gap)?;
                }
                Opponent::Surface(other) => {
                    let (other, other_high) = (place(other.body)?, side(&other.surface)?.1);
                    let low = at.min(other);
                    let faces = if at < other { [high, other_high] } else { [other_high, high] };
                    if at.abs_diff(other) != 1 || faces != [1, 0] {
                        return None;
                    }
                    let [below, above] = [low, low + 1].map(|at| blocks[at].cuboid);
                    let distance = above.origin[axis] - (below.origin[axis] + below.size[axis]);
                    // What is closer than the digits of the coordinates touches, as contacts have it.
                    let touches = distance.abs() <= super::contact::SAME * below.size[axis];
                    found = put(found, low + 1, gap + if touches { 0.0 } else { distance })?;
                }
            }
        }
        for (surface, directions) in self.holds.iter().filter(|(_, directions)| directions.contains(&axis)) {
            let end = match (place(surface.body)?, side(&surface.surface)?) {
                (0, (normal, 0)) if normal == axis => 0,
                (at, (normal, 1)) if normal == axis && at == last => 1,
                // Of a lateral side: refused before.
                _ => return None,
            };
            if ends[end] == End::Wall || directions.is_empty() {
                return None;
            }
            ends[end] = End::Fixed;
        }
        let inner = (1..=last).all(|at| found.iter().any(|(place, _)| *place == at));
        inner.then_some((found, ends))
    }
}

impl<'a> Block<'a> {
    fn new((body, source): (usize, &'a BodySource)) -> Option<Self> {
        match &source.mesh {
            MeshSource::Box(cuboid) => Some(Self { body, source, cuboid }),
            MeshSource::Gmsh(_) => None,
        }
    }
}

/// Adds a gap at a place that has none yet.
fn put(mut gaps: Vec<(usize, f64)>, place: usize, gap: f64) -> Option<Vec<(usize, f64)>> {
    if gaps.iter().any(|(known, _)| *known == place) {
        return None;
    }
    gaps.push((place, gap));
    Some(gaps)
}

/// The axis and the end, 0 or 1, of a side of a box.
fn side(name: &str) -> Option<(usize, usize)> {
    let of =
        |(axis, names): (usize, &[&str; 2])| Some((axis, names.iter().position(|known| *known == name)?));
    SIDES.iter().enumerate().find_map(of)
}
