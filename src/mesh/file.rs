//! Scenes of meshes from TOML. Every refusal names the file, the line and the key.
//!
//! The sides of a box are named as in a right-handed view with z towards the eye: `left` and `right` are the ends of x, `bottom`
//! and `top` those of y, in space too, `back` and `front` those of z.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::elasticity::{Material, Plane};
use super::element::{Coordinates, Kind};
use super::scene::{BodySource, MeshImpact, MeshScene, MeshSource, Opponent, SurfaceName};
use super::structured::{Cuboid, SIDES};
use crate::error::{Refusal, Result};
use crate::scene::{in_file, line_of, name_of};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    name: Option<Spanned<String>>,
    dimension: Spanned<usize>,
    plane: Option<Spanned<Plane>>,
    body: Vec<Spanned<BodyText>>,
    #[serde(default)]
    contact: Vec<ContactText>,
    #[serde(default)]
    hold: Vec<HoldText>,
    impact: Option<Spanned<ImpactText>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImpactText {
    duration: Spanned<f64>,
    gaps: Option<Spanned<Vec<f64>>>,
    gravity: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyText {
    name: Spanned<String>,
    r#box: Option<Spanned<Vec<f64>>>,
    mesh: Option<Spanned<String>>,
    cells: Option<Spanned<Vec<i64>>>,
    origin: Option<Spanned<Vec<f64>>>,
    element: Option<Spanned<Kind>>,
    youngs_modulus: Spanned<f64>,
    poissons_ratio: Spanned<f64>,
    density: Spanned<f64>,
    thickness: Option<Spanned<f64>>,
    velocity: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactText {
    surfaces: Spanned<[String; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HoldText {
    surface: Spanned<String>,
    directions: Spanned<Vec<String>>,
}

/// The text of a scene, for the lines of its refusals.
struct Source<'a> {
    text: &'a str,
    path: &'a str,
    dimension: usize,
}

impl Source<'_> {
    fn place<T>(&self, key: &str, at: &Spanned<T>) -> String {
        format!("{}, line {}, {key}", self.path, line_of(self.text, at.span().start))
    }

    fn refuse<T>(&self, key: &str, at: &Spanned<T>, value: impl ToString, allowed: &str) -> Refusal {
        Refusal::new(self.place(key, at), value, allowed)
    }

    /// A number for which `holds`.
    fn number(
        &self,
        key: &str,
        value: &Spanned<f64>,
        allowed: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Result<f64, Refusal> {
        let number = *value.get_ref();
        if number.is_finite() && holds(number) {
            Ok(number)
        } else {
            Err(self.refuse(key, value, number, allowed))
        }
    }

    /// One entry for each direction.
    fn vector(
        &self,
        key: &str,
        value: Option<&Spanned<Vec<f64>>>,
        allowed: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Result<Coordinates, Refusal> {
        let Some(value) = value else { return Ok([0.0; 3]) };
        let entries = value.get_ref();
        if entries.len() != self.dimension || entries.iter().any(|x| !x.is_finite() || !holds(*x)) {
            let allowed = format!("{} {allowed}", self.dimension);
            return Err(self.refuse(key, value, format!("{entries:?}"), &allowed));
        }
        Ok(std::array::from_fn(|i| entries.get(i).copied().unwrap_or(0.0)))
    }
}

pub(super) fn parse(text: &str, path: &str) -> Result<MeshScene> {
    let raw: SceneText = toml::from_str(text).map_err(|error| in_file(&error, text, path))?;
    let source = Source { text, path, dimension: *raw.dimension.get_ref() };
    if !(2..=3).contains(&source.dimension) {
        return Err(source.refuse("dimension", &raw.dimension, source.dimension, "2 or 3").into());
    }
    let name = name_of(raw.name.as_ref(), text, path)?;
    let plane = match (&raw.plane, source.dimension) {
        (Some(plane), 3) => {
            return Err(source
                .refuse("plane", plane, "a plane in space", "dimension = 2, or no plane")
                .into());
        }
        (None, 2) => {
            let allowed = "plane = \"strain\" or \"stress\" with dimension = 2";
            return Err(source.refuse("plane", &raw.dimension, "none", allowed).into());
        }
        (plane, _) => plane.as_ref().map(|plane| *plane.get_ref()),
    };
    let bodies = raw
        .body
        .iter()
        .enumerate()
        .map(|(i, text)| body(&source, i, text))
        .collect::<Result<Vec<_>, Refusal>>()?;
    if bodies.is_empty() {
        return Err(Refusal::new(path, "no [[body]]", "at least one").into());
    }
    for (i, text) in raw.body.iter().enumerate() {
        if bodies[..i].iter().any(|other| other.name == bodies[i].name) {
            let key = format!("body {}, name", i + 1);
            let value = format!("{:?}, again", bodies[i].name);
            return Err(source.refuse(&key, &text.get_ref().name, value, "a name of its own").into());
        }
    }
    let contacts = raw.contact.iter().enumerate().map(|(i, text)| contact(&source, i, text, &bodies));
    let holds = raw.hold.iter().enumerate().map(|(i, text)| hold(&source, i, text, &bodies));
    Ok(MeshScene {
        name: name.clone(),
        dimension: source.dimension,
        plane,
        impact: raw.impact.as_ref().map(|text| impact(&source, text, raw.contact.len())).transpose()?,
        contacts: contacts.collect::<Result<_, Refusal>>()?,
        holds: holds.collect::<Result<_, Refusal>>()?,
        bodies,
    })
}

fn body(source: &Source, i: usize, text: &Spanned<BodyText>) -> Result<BodySource, Refusal> {
    let values = text.get_ref();
    let key = |name: &str| format!("body {}, {name}", i + 1);
    let name = values.name.get_ref();
    if name.is_empty() || name == "wall" || name.contains(['.', '\n']) {
        let allowed = "a name without '.', not \"wall\"";
        return Err(source.refuse(&key("name"), &values.name, format!("{name:?}"), allowed));
    }
    let positive = |x: f64| x > 0.0;
    let number = |name: &str, value: &Spanned<f64>| {
        source.number(&key(name), value, "a finite number above 0", positive)
    };
    if let (Some(thickness), 3) = (&values.thickness, source.dimension) {
        let allowed = "no thickness in space";
        return Err(source.refuse(&key("thickness"), thickness, thickness.get_ref(), allowed));
    }
    let material = Material {
        youngs_modulus: number("youngs_modulus", &values.youngs_modulus)?,
        poissons_ratio: source.number(
            &key("poissons_ratio"),
            &values.poissons_ratio,
            "a number above -1 and below 0.5",
            |nu| nu > -1.0 && nu < 0.5,
        )?,
        density: number("density", &values.density)?,
        thickness: values.thickness.as_ref().map_or(Ok(1.0), |t| number("thickness", t))?,
    };
    let velocity = source.vector(&key("velocity"), values.velocity.as_ref(), "finite numbers", |_| true)?;
    let mesh = match (&values.r#box, &values.mesh) {
        (Some(_), None) => MeshSource::Box(cuboid(source, i, text)?),
        (None, Some(file)) => {
            let unread = |name: &str, at: std::ops::Range<usize>| {
                let allowed = "not beside a mesh file, which has its own";
                source.refuse(&key(name), &Spanned::new(at, ()), name, allowed)
            };
            if let Some(cells) = &values.cells {
                return Err(unread("cells", cells.span()));
            }
            if let Some(origin) = &values.origin {
                return Err(unread("origin", origin.span()));
            }
            if let Some(element) = &values.element {
                return Err(unread("element", element.span()));
            }
            let folder = Path::new(source.path).parent().unwrap_or(Path::new(""));
            MeshSource::Gmsh(folder.join(file.get_ref()))
        }
        (first, _) => {
            let value = if first.is_some() { "box and mesh" } else { "neither box nor mesh" };
            return Err(source.refuse(&format!("body {}", i + 1), text, value, "one of box and mesh"));
        }
    };
    let place = match (&values.mesh, &values.cells) {
        (Some(file), _) => source.place(&key("mesh"), file),
        (None, Some(cells)) => source.place(&key("cells"), cells),
        (None, None) => source.place(&format!("body {}", i + 1), text),
    };
    Ok(BodySource { name: name.clone(), mesh, material, velocity, place })
}

fn cuboid(source: &Source, i: usize, text: &Spanned<BodyText>) -> Result<Cuboid, Refusal> {
    let values = text.get_ref();
    let key = |name: &str| format!("body {}, {name}", i + 1);
    let size = source.vector(&key("box"), values.r#box.as_ref(), "finite numbers above 0", |x| x > 0.0)?;
    let origin = source.vector(&key("origin"), values.origin.as_ref(), "finite numbers", |_| true)?;
    let missing = |name: &str| source.refuse(&key(name), text, "nothing", "a value, beside box");
    let (element, cells) = (
        values.element.as_ref().ok_or_else(|| missing("element"))?,
        values.cells.as_ref().ok_or_else(|| missing("cells"))?,
    );
    let kind = *element.get_ref();
    if kind.element().dimension != source.dimension {
        let names: Vec<_> = Kind::ALL.iter().map(|kind| kind.element()).collect();
        let names = names.iter().filter(|element| element.dimension == source.dimension);
        let allowed = names.map(|element| element.name).collect::<Vec<_>>().join(" ");
        return Err(source.refuse(&key("element"), element, kind.element().name, &allowed));
    }
    let counts = cells.get_ref();
    if counts.len() != source.dimension || counts.iter().any(|n| *n < 1) {
        let allowed = format!("{} integers of at least 1", source.dimension);
        return Err(source.refuse(&key("cells"), cells, format!("{counts:?}"), &allowed));
    }
    let cells = std::array::from_fn(|k| counts.get(k).map_or(1, |n| *n as usize));
    Ok(Cuboid { size, cells, origin, kind })
}

/// Finds `body.surface`; the sides of a box are checked here, those of a mesh file once it is read.
fn surface(
    source: &Source,
    place: &str,
    written: &str,
    bodies: &[BodySource],
) -> Result<SurfaceName, Refusal> {
    let known = || bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", ");
    let found = written.split_once('.').and_then(|(body, surface)| {
        bodies.iter().position(|known| known.name == body).map(|body| (body, surface.to_owned()))
    });
    let Some((body, surface)) = found else {
        let allowed = format!("BODY.SURFACE with a body of this scene: {}", known());
        return Err(Refusal::new(place, format!("{written:?}"), allowed));
    };
    let sides = &SIDES[..source.dimension];
    if matches!(bodies[body].mesh, MeshSource::Box(_)) && !sides.as_flattened().contains(&surface.as_str()) {
        let allowed = format!("a side of a box: {}", sides.as_flattened().join(" "));
        return Err(Refusal::new(place, format!("{written:?}"), allowed));
    }
    Ok(SurfaceName { body, surface, written: written.to_owned(), place: place.to_owned() })
}

fn contact(
    source: &Source,
    i: usize,
    text: &ContactText,
    bodies: &[BodySource],
) -> Result<(SurfaceName, Opponent), Refusal> {
    let place = source.place(&format!("contact {}, surfaces", i + 1), &text.surfaces);
    let [first, second] = text.surfaces.get_ref();
    let own = surface(source, &place, first, bodies)?;
    if second == "wall" {
        return Ok((own, Opponent::Wall));
    }
    let other = surface(source, &place, second, bodies)?;
    if first == second {
        return Err(Refusal::new(
            place,
            format!("{first:?} twice"),
            "two surfaces, or a surface and \"wall\"",
        ));
    }
    Ok((own, Opponent::Surface(other)))
}

fn impact(source: &Source, text: &Spanned<ImpactText>, contacts: usize) -> Result<MeshImpact, Refusal> {
    let values = text.get_ref();
    let duration =
        source.number("impact.duration", &values.duration, "a finite number above 0 (s)", |t| t > 0.0)?;
    let gravity =
        source.vector("impact.gravity", values.gravity.as_ref(), "finite numbers (m/s^2)", |_| true)?;
    let gaps = values.gaps.as_ref().map_or_else(|| vec![0.0; contacts], |gaps| gaps.get_ref().clone());
    if let Some(given) = &values.gaps
        && (gaps.len() != contacts || gaps.iter().any(|gap| !gap.is_finite()))
    {
        let allowed = format!("{contacts} finite numbers (m), one for each [[contact]]");
        return Err(source.refuse("impact.gaps", given, format!("{gaps:?}"), &allowed));
    }
    Ok(MeshImpact { duration, gaps, gravity })
}

fn hold(
    source: &Source,
    i: usize,
    text: &HoldText,
    bodies: &[BodySource],
) -> Result<(SurfaceName, Vec<usize>), Refusal> {
    let place = source.place(&format!("hold {}, surface", i + 1), &text.surface);
    let surface = surface(source, &place, text.surface.get_ref(), bodies)?;
    let axes = &["x", "y", "z"][..source.dimension];
    let axis = |name: &String| axes.iter().position(|axis| axis == name);
    let directions: Option<Vec<usize>> = text.directions.get_ref().iter().map(axis).collect();
    match directions {
        Some(directions) if !directions.is_empty() => Ok((surface, directions)),
        _ => {
            let key = format!("hold {}, directions", i + 1);
            let allowed = format!("some of {axes:?}");
            Err(source.refuse(&key, &text.directions, format!("{:?}", text.directions.get_ref()), &allowed))
        }
    }
}
