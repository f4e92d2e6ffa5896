//! Meshes of Gmsh: MSH 4.1, text or binary, physical groups as names of surfaces.
//!
//! One grammar reads both forms: they hold the same numbers in the same order. (The crate mshio, 0.4, leaves out the
//! names of physical groups, stops the program on some inputs and gives no line.)

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use super::element::{Coordinates, Kind};
use super::topology::{Face, Mesh};
use crate::error::{Error, Refusal, Result};

/// The element type behind Gmsh's number, with the place in Gmsh's order of each node in VTK's.
fn kind(number: i64) -> Option<(Kind, &'static [usize])> {
    Some(match number {
        2 => (Kind::Tri3, &[0, 1, 2]),
        9 => (Kind::Tri6, &[0, 1, 2, 3, 4, 5]),
        3 => (Kind::Quad4, &[0, 1, 2, 3]),
        16 => (Kind::Quad8, &[0, 1, 2, 3, 4, 5, 6, 7]),
        4 => (Kind::Tet4, &[0, 1, 2, 3]),
        11 => (Kind::Tet10, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        5 => (Kind::Hex8, &[0, 1, 2, 3, 4, 5, 6, 7]),
        17 => (Kind::Hex20, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]),
        _ => return None,
    })
}

/// Number of nodes of Gmsh's element types that may occur in a file: points, lines and what [`kind`] and its refusals name.
fn node_count(number: i64) -> Option<usize> {
    const COUNTS: [(i64, usize); 19] = [
        (1, 2),
        (2, 3),
        (3, 4),
        (4, 4),
        (5, 8),
        (6, 6),
        (7, 5),
        (8, 3),
        (9, 6),
        (10, 9),
        (11, 10),
        (12, 27),
        (13, 18),
        (14, 14),
        (15, 1),
        (16, 8),
        (17, 20),
        (18, 15),
        (19, 13),
    ];
    COUNTS.iter().find(|(known, _)| *known == number).map(|(_, count)| *count)
}

/// The file and how far it is read.
struct Source<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
    binary: bool,
    swapped: bool,
}

impl<'a> Source<'a> {
    fn place(&self) -> String {
        if self.binary {
            return format!("{}, byte {}", self.path.display(), self.at);
        }
        let line = self.bytes[..self.at.min(self.bytes.len())].iter().filter(|b| **b == b'\n').count() + 1;
        format!("{}, line {line}", self.path.display())
    }

    fn refuse(&self, value: impl ToString, allowed: &str) -> Error {
        Refusal::new(self.place(), value, allowed).into()
    }

    fn skip_blanks(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    fn word(&mut self) -> Result<&'a str> {
        self.skip_blanks();
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.refuse("the end of the file", "a whole MSH 4.1 file: this one is cut off"));
        }
        let word = std::str::from_utf8(&rest[..length]).map_err(|_| self.refuse("binary data", "a word"))?;
        self.at += length;
        Ok(word)
    }

    fn text<T: std::str::FromStr>(&mut self, allowed: &str) -> Result<T> {
        let word = self.word()?;
        word.parse().map_err(|_| self.refuse(format!("{word:?}"), allowed))
    }

    fn raw<const N: usize>(&mut self) -> Result<[u8; N]> {
        let taken = self.bytes.get(self.at..self.at + N).and_then(|bytes| <[u8; N]>::try_from(bytes).ok());
        let mut taken = taken
            .ok_or_else(|| self.refuse("the end of the file", "a whole MSH 4.1 file: this one is cut off"))?;
        self.at += N;
        if self.swapped {
            taken.reverse();
        }
        Ok(taken)
    }

    fn int(&mut self) -> Result<i64> {
        if self.binary { Ok(i64::from(i32::from_le_bytes(self.raw()?))) } else { self.text("an integer") }
    }

    fn size(&mut self) -> Result<u64> {
        if self.binary {
            Ok(u64::from_le_bytes(self.raw()?))
        } else {
            self.text("a count or tag, an integer >= 0")
        }
    }

    fn real(&mut self) -> Result<f64> {
        let value: f64 = if self.binary { f64::from_le_bytes(self.raw()?) } else { self.text("a number")? };
        if value.is_finite() { Ok(value) } else { Err(self.refuse(value, "a finite number")) }
    }

    /// A count; more than the file could hold is refused before anything is reserved.
    fn count(&mut self) -> Result<usize> {
        let count = self.size()?;
        let most = self.bytes.len() as u64;
        if count > most {
            return Err(self.refuse(count, &format!("a count of at most {most}, the bytes of the file")));
        }
        Ok(count as usize)
    }
}

/// The elements of one block, as the file has them.
struct Block {
    dimension: i64,
    entity: i64,
    number: i64,
    /// (tag, node tags).
    elements: Vec<(u64, Vec<u64>)>,
}

#[derive(Default)]
struct Contents {
    /// (dimension, tag) of a physical group to its name.
    names: HashMap<(i64, i64), String>,
    /// (dimension, tag) of an entity to its physical groups.
    groups: HashMap<(i64, i64), Vec<i64>>,
    nodes: HashMap<u64, Coordinates>,
    blocks: Vec<Block>,
}

/// Reads the mesh of a body of `dimension` 2 or 3.
///
/// # Errors
/// A file that cannot be read, is cut off or is not MSH 4.1; element types that are not known here; a surface that lies
/// inside the body; a plane mesh that is not flat.
pub fn read(path: &Path, dimension: usize) -> Result<Mesh> {
    let bytes = std::fs::read(path).map_err(|source| Error::File {
        path: path.to_owned(),
        wanted: "read",
        source,
    })?;
    let mut source = Source { path, bytes: &bytes, at: 0, binary: false, swapped: false };
    let contents = contents(&mut source)?;
    mesh(&contents, dimension, path)
}

fn contents(source: &mut Source) -> Result<Contents> {
    header(source)?;
    let mut contents = Contents::default();
    loop {
        source.skip_blanks();
        if source.at >= source.bytes.len() {
            return Ok(contents);
        }
        let section = source.word()?.to_owned();
        // The line break after the name of a section is one byte.
        source.at += 1;
        match section.as_str() {
            "$PhysicalNames" => names(source, &mut contents)?,
            "$Entities" => entities(source, &mut contents)?,
            "$Nodes" => nodes(source, &mut contents)?,
            "$Elements" => elements(source, &mut contents)?,
            _ if section.starts_with('$') => skip(source, &section)?,
            _ => return Err(source.refuse(format!("{section:?}"), "a section such as $Nodes")),
        }
        let end = source.word()?;
        if end != format!("$End{}", &section[1..]) {
            return Err(source.refuse(format!("{end:?}"), &format!("$End{}", &section[1..])));
        }
    }
}

fn header(source: &mut Source) -> Result<()> {
    const ALLOWED: &str = "$MeshFormat with version 4.1 (Gmsh: Mesh.MshFileVersion = 4.1), 8-byte sizes";
    let (first, version) = (source.word()?.to_owned(), source.word()?.to_owned());
    let (form, size): (i64, i64) = (source.text(ALLOWED)?, source.text(ALLOWED)?);
    if first != "$MeshFormat" || version != "4.1" || !(0..=1).contains(&form) || size != 8 {
        return Err(source.refuse(format!("{first} {version} {form} {size}"), ALLOWED));
    }
    if form == 1 {
        source.at += 1;
        let one: [u8; 4] = source.raw()?;
        source.swapped = one == 1_i32.to_be_bytes();
        source.binary = true;
        if !source.swapped && one != 1_i32.to_le_bytes() {
            return Err(source.refuse(format!("{one:?}"), "the integer 1 in either byte order"));
        }
    }
    let end = source.word()?;
    if end == "$EndMeshFormat" { Ok(()) } else { Err(source.refuse(format!("{end:?}"), "$EndMeshFormat")) }
}

fn skip(source: &mut Source, section: &str) -> Result<()> {
    let end = format!("$End{}", &section[1..]);
    let rest = &source.bytes[source.at.min(source.bytes.len())..];
    match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
        Some(length) => source.at += length,
        None => return Err(source.refuse(section, &format!("a section that ends with {end}"))),
    }
    Ok(())
}

/// Text in both forms.
fn names(source: &mut Source, contents: &mut Contents) -> Result<()> {
    let count: usize = source.text("the number of physical names")?;
    for _ in 0..count {
        let key = (source.text("a dimension")?, source.text("a tag")?);
        source.skip_blanks();
        let rest = &source.bytes[source.at.min(source.bytes.len())..];
        let line = &rest[..rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len())];
        source.at += line.len();
        let name = String::from_utf8_lossy(line).trim().trim_matches('"').to_owned();
        contents.names.insert(key, name);
    }
    Ok(())
}

fn entities(source: &mut Source, contents: &mut Contents) -> Result<()> {
    let counts = [source.count()?, source.count()?, source.count()?, source.count()?];
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = source.int()?;
            // A point has its place, the others their bounding box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                source.real()?;
            }
            let groups =
                (0..source.count()?).map(|_| source.int().map(i64::abs)).collect::<Result<Vec<_>>>()?;
            contents.groups.insert((dimension as i64, tag), groups);
            if dimension > 0 {
                for _ in 0..source.count()? {
                    source.int()?;
                }
            }
        }
    }
    Ok(())
}

fn nodes(source: &mut Source, contents: &mut Contents) -> Result<()> {
    let blocks = source.count()?;
    (0..3).try_for_each(|_| source.size().map(drop))?;
    for _ in 0..blocks {
        let (dimension, _, parametric) = (source.int()?, source.int()?, source.int()?);
        let count = source.count()?;
        let tags = (0..count).map(|_| source.size()).collect::<Result<Vec<_>>>()?;
        for tag in tags {
            let place = [source.real()?, source.real()?, source.real()?];
            for _ in 0..if parametric == 1 { dimension } else { 0 } {
                source.real()?;
            }
            contents.nodes.insert(tag, place);
        }
    }
    Ok(())
}

fn elements(source: &mut Source, contents: &mut Contents) -> Result<()> {
    let blocks = source.count()?;
    (0..3).try_for_each(|_| source.size().map(drop))?;
    for _ in 0..blocks {
        let (dimension, entity, number) = (source.int()?, source.int()?, source.int()?);
        let Some(nodes) = node_count(number) else {
            let allowed = "tri3 tri6 quad4 quad8 tet4 tet10 hex8 hex20 with their lines and points (Gmsh: Mesh.ElementOrder at most 2, Mesh.SecondOrderIncomplete = 1)";
            return Err(source.refuse(format!("Gmsh's element type {number}"), allowed));
        };
        let count = source.count()?;
        let mut block = Block { dimension, entity, number, elements: Vec::with_capacity(count) };
        for _ in 0..count {
            let tag = source.size()?;
            let nodes = (0..nodes).map(|_| source.size()).collect::<Result<Vec<_>>>()?;
            if let Some(unknown) = nodes.iter().find(|node| !contents.nodes.contains_key(node)) {
                let value = format!("node {unknown} of element {tag}");
                return Err(source.refuse(value, "a node that the section $Nodes has"));
            }
            block.elements.push((tag, nodes));
        }
        contents.blocks.push(block);
    }
    Ok(())
}

fn mesh(contents: &Contents, dimension: usize, path: &Path) -> Result<Mesh> {
    let place = path.display().to_string();
    let mut mesh = Mesh::default();
    let mut number = HashMap::new();
    for block in contents.blocks.iter().filter(|block| block.dimension == dimension as i64) {
        let Some((kind, order)) = kind(block.number) else {
            let value = format!("Gmsh's element type {}", block.number);
            let allowed =
                "tri3 tri6 quad4 quad8 tet4 tet10 hex8 hex20 (Gmsh: Mesh.SecondOrderIncomplete = 1)";
            return Err(Refusal::new(place, value, allowed).into());
        };
        for (_, nodes) in &block.elements {
            let mut known = |tag: u64| {
                *number.entry(tag).or_insert_with(|| {
                    mesh.nodes.push(contents.nodes[&tag]);
                    mesh.nodes.len() as u32 - 1
                })
            };
            let nodes: Vec<u32> = order.iter().map(|at| known(nodes[*at])).collect();
            mesh.push(kind, nodes);
        }
    }
    if mesh.elements() == 0 {
        let allowed = "at least one (Gmsh saves only physical groups once there are any: Mesh.SaveAll = 1, or a group for the body)";
        return Err(Refusal::new(place, format!("no element of dimension {dimension}"), allowed).into());
    }
    if dimension == 2 && mesh.nodes.iter().any(|node| node[2] != mesh.nodes[0][2]) {
        return Err(Refusal::new(
            place,
            "a surface that is not flat",
            "a plane mesh in x and y, z the same everywhere",
        )
        .into());
    }
    surfaces(contents, dimension, &number, &mut mesh, &place)?;
    Ok(mesh)
}

/// Finds the faces of the body that the elements of the groups one dimension lower lie on.
fn surfaces(
    contents: &Contents,
    dimension: usize,
    number: &HashMap<u64, u32>,
    mesh: &mut Mesh,
    place: &str,
) -> Result<()> {
    let key = |mut nodes: Vec<u32>| {
        nodes.sort_unstable();
        nodes
    };
    let mut wanted: HashMap<Vec<u32>, (Vec<&str>, Vec<Face>)> = HashMap::new();
    let lower = dimension as i64 - 1;
    let names: BTreeMap<(i64, i64), String> = contents
        .groups
        .iter()
        .filter(|((dimension, _), _)| *dimension == lower)
        .flat_map(|(_, groups)| groups)
        .map(|tag| {
            ((lower, *tag), contents.names.get(&(lower, *tag)).cloned().unwrap_or_else(|| tag.to_string()))
        })
        .collect();
    for block in contents.blocks.iter().filter(|block| block.dimension == lower) {
        let groups = contents.groups.get(&(lower, block.entity)).map_or(&[][..], Vec::as_slice);
        for (_, nodes) in &block.elements {
            let nodes: Option<Vec<u32>> = nodes.iter().map(|tag| number.get(tag).copied()).collect();
            let Some(nodes) = nodes else { continue };
            let entry = wanted.entry(key(nodes)).or_default();
            entry.0.extend(groups.iter().filter_map(|tag| names.get(&(lower, *tag))).map(String::as_str));
        }
    }
    for e in 0..mesh.elements() {
        for side in 0..mesh.kind(e).element().faces.len() {
            let face = Face { element: e as u32, side: side as u8 };
            if let Some((_, faces)) = wanted.get_mut(&key(mesh.face(face).0)) {
                faces.push(face);
            }
        }
    }
    for name in names.values() {
        let mut faces: Vec<Face> = Vec::new();
        for (_, found) in wanted.values().filter(|(groups, _)| groups.contains(&name.as_str())) {
            if found.len() > 1 {
                let allowed = "a group on the boundary of the body";
                return Err(
                    Refusal::new(place, format!("physical group {name:?} inside the body"), allowed).into()
                );
            }
            faces.extend(found);
        }
        faces.sort_by_key(|face| (face.element, face.side));
        mesh.surfaces.insert(name.clone(), faces);
    }
    Ok(())
}
