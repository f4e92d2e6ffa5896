//! A scene of `[matrices]`.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::{check, reader};
use crate::error::{Refusal, Result};
use crate::pencil::Matrix;
use crate::scene::{in_file, line_of};
use crate::sparse::{Csr, SparseVector, gap_scale};

/// What r = 1 refers to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    /// The largest eigenvalue of the contact-free matrices.
    Mesh,
    /// omega_ref^2, rad^2/s^2.
    OmegaSquared(f64),
}

/// A scene of `[matrices]`: where its files are.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixScene {
    /// Its name.
    pub name: String,
    /// K.
    pub stiffness: PathBuf,
    /// M.
    pub mass: PathBuf,
    /// Z.
    pub gaps: PathBuf,
    /// w; by default from K and Z.
    pub scales: Option<PathBuf>,
    /// omega_ref^2.
    pub reference: Reference,
}

/// The matrices of a scene, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices {
    /// K, N/m, n x n, whole and symmetric.
    pub stiffness: Csr,
    /// M, kg. Its diagonal is positive; whether it is definite is for its factorisation to say.
    pub mass: Matrix,
    /// z_j.
    pub gaps: Vec<SparseVector>,
    /// w_j, N/m.
    pub scales: Vec<f64>,
    /// What r = 1 refers to.
    pub reference: Reference,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    name: Spanned<String>,
    matrices: MatricesText,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MatricesText {
    stiffness: String,
    mass: String,
    gaps: String,
    scales: Option<String>,
    reference: Option<Spanned<ReferenceText>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum ReferenceText {
    Number(f64),
    Word(String),
}

impl MatrixScene {
    /// Reads a scene from TOML; `path` is what messages call it, and its folder is where the matrices are looked for.
    ///
    /// # Errors
    /// TOML that cannot be read, keys that are not known, a reference that is neither "mesh" nor positive.
    pub fn parse(text: &str, path: &str) -> Result<Self> {
        let raw: SceneText = toml::from_str(text).map_err(|error| in_file(&error, text, path))?;
        let place = |key: &str, at: usize| format!("{path}, line {}, {key}", line_of(text, at));
        let name = raw.name.get_ref();
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')) {
            let place = place("name", raw.name.span().start);
            return Err(Refusal::new(place, format!("{name:?}"), "letters, digits, '-' and '_'").into());
        }
        let reference = match raw.matrices.reference.as_ref().map(|r| (r.get_ref(), r.span().start)) {
            None => Reference::Mesh,
            Some((ReferenceText::Word(word), _)) if word == "mesh" => Reference::Mesh,
            Some((ReferenceText::Number(number), _)) if *number > 0.0 && number.is_finite() => {
                Reference::OmegaSquared(*number)
            }
            Some((other, at)) => {
                let value = match other {
                    ReferenceText::Number(number) => number.to_string(),
                    ReferenceText::Word(word) => format!("{word:?}"),
                };
                let allowed = "\"mesh\", or omega_ref^2 above 0 in rad^2/s^2";
                return Err(Refusal::new(place("matrices.reference", at), value, allowed).into());
            }
        };
        let folder = Path::new(path).parent().unwrap_or(Path::new(""));
        Ok(Self {
            name: name.clone(),
            stiffness: folder.join(raw.matrices.stiffness),
            mass: folder.join(raw.matrices.mass),
            gaps: folder.join(raw.matrices.gaps),
            scales: raw.matrices.scales.map(|path| folder.join(path)),
            reference,
        })
    }

    /// Reads and checks the matrices.
    ///
    /// # Errors
    /// Files that cannot be read or are cut off; matrices that are not square, not symmetric beyond rounding or do not fit
    /// together; a mass that is not positive; a gap without entries; scales that are not positive, or cannot be had from K.
    pub fn read(&self) -> Result<Matrices> {
        let (k, m) = (reader::read(&self.stiffness)?, reader::read(&self.mass)?);
        let z = reader::read(&self.gaps)?;
        let stiffness = check::stiffness(&k)?;
        let mass = check::mass(&m, &k)?;
        let gaps = check::gaps(&z, k.rows)?;
        let scales = match &self.scales {
            Some(path) => check::scales(&reader::read(path)?, gaps.len())?,
            None => default_scales(&stiffness, &gaps, &z)?,
        };
        Ok(Matrices { stiffness, mass, gaps, scales, reference: self.reference })
    }
}

/// The scale of each gap over the bodies, which are what K connects.
fn default_scales(stiffness: &Csr, gaps: &[SparseVector], z: &reader::Entries) -> Result<Vec<f64>, Refusal> {
    let bodies = connected(stiffness);
    let scale = |(at, gap): (usize, &SparseVector)| match gap_scale(stiffness, gap, |i| {
        bodies[i as usize] as usize
    }) {
        Some(scale) if scale > 0.0 => Ok(scale),
        found => {
            let line = gap.0.first().map_or(1, |(row, _)| z.line_of(*row, at as u32));
            let value = format!("scale {} of contact {}", found.unwrap_or(0.0), at + 1);
            let allowed = "a gap that K resists on each body, z_b'K z_b > 0; or scales = a file";
            Err(Refusal::new(z.place(line), value, allowed))
        }
    };
    gaps.iter().enumerate().map(scale).collect()
}

/// For each unknown the smallest one that K connects it with.
fn connected(matrix: &Csr) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..matrix.rows() as u32).collect();
    for row in 0..matrix.rows() {
        for column in matrix.row(row).0.iter().filter(|column| (**column as usize) < row) {
            let (a, b) = (root(&mut parent, row as u32), root(&mut parent, *column));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    (0..matrix.rows() as u32).map(|i| root(&mut parent, i)).collect()
}

/// The root of `i`, halving the path to it.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}
