//! A scene of `[matrices]`.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::{check, reader};
use crate::error::{Refusal, Result};
use crate::pencil::Matrix;
use crate::scene::{in_file, line_of, name_of};
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
    /// What time stepping needs beside them.
    pub impact: Option<MatrixImpact>,
}

/// `[impact]` of a scene of matrices: where its files are.
#[derive(Debug, Clone, PartialEq)]
pub struct MatrixImpact {
    /// Simulated time T, s.
    pub duration: f64,
    /// v at the start, n x 1, m/s.
    velocity: Option<PathBuf>,
    /// Constant nodal forces f, n x 1, N.
    load: Option<PathBuf>,
    /// g0 of every contact, k x 1, m, negative where open.
    gaps: Option<PathBuf>,
}

/// How matrices move at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Throw {
    /// v, m/s; n numbers.
    pub velocity: Vec<f64>,
    /// f, N; empty for none.
    pub load: Vec<f64>,
    /// g0, m, negative where open; k numbers.
    pub gaps: Vec<f64>,
}

impl MatrixImpact {
    /// Reads how n unknowns with k contacts move at the start; what has no file is 0.
    ///
    /// # Errors
    /// Files that cannot be read, or that are not n x 1 or k x 1 in Matrix Market form.
    pub fn read(&self, n: usize, k: usize) -> Result<Throw> {
        let vector = |path: &Option<PathBuf>, count: usize| {
            path.as_ref().map(|path| Ok(check::vector(&reader::read(path)?, count)?)).transpose()
        };
        let load: Result<_> = vector(&self.load, n);
        Ok(Throw {
            velocity: vector(&self.velocity, n)?.unwrap_or_else(|| vec![0.0; n]),
            load: load?.unwrap_or_default(),
            gaps: vector(&self.gaps, k)?.unwrap_or_else(|| vec![0.0; k]),
        })
    }
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

impl Matrices {
    /// The matrices of an assembly that is in memory: K (N/m), M (kg), gaps, and their scales (N/m), by default from K
    /// and the gaps. What is symmetric to the last bit is taken as it is, what is so to rounding is made so.
    ///
    /// # Errors
    /// Matrices that are not square or not symmetric beyond rounding, a gap that has an entry out of range, scales that
    /// cannot be had from K. The rest is for the pencil to refuse.
    pub fn new(
        stiffness: Csr,
        mass: Matrix,
        gaps: Vec<SparseVector>,
        scales: Option<Vec<f64>>,
        reference: Reference,
    ) -> Result<Self, Refusal> {
        let size = stiffness.rows();
        let stiffness = symmetric("stiffness", stiffness, size)?;
        let mass = match mass {
            Matrix::Sparse(mass) => Matrix::Sparse(symmetric("mass", mass, size)?),
            other => other,
        };
        for (at, gap) in gaps.iter().enumerate() {
            if let Some((row, _)) = gap.0.iter().find(|(row, _)| *row as usize >= size) {
                let place = format!("gaps, column {at}");
                return Err(Refusal::new(place, format!("row {row}"), format!("rows below {size}")));
            }
        }
        let scales = match scales {
            Some(scales) => scales,
            None => default_scales(&stiffness, &gaps, "an array of scales", |at, row| {
                format!("gaps, column {at}, row {row}")
            })?,
        };
        Ok(Self { stiffness, mass, gaps, scales, reference })
    }
}

/// A matrix of `size` rows and columns that is symmetric to the last bit.
fn symmetric(name: &str, matrix: Csr, size: usize) -> Result<Csr, Refusal> {
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if (rows, columns) != (size, size) {
        return Err(Refusal::new(name, format!("{rows} x {columns}"), format!("{size} x {size}")));
    }
    let place = |row, column| format!("{name}, row {row}, column {column}");
    Ok(check::symmetrised(&matrix, place)?.unwrap_or(matrix))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    name: Option<Spanned<String>>,
    matrices: MatricesText,
    impact: Option<ImpactText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImpactText {
    duration: Spanned<f64>,
    velocity: Option<String>,
    load: Option<String>,
    gaps: Option<String>,
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
        let name = name_of(raw.name.as_ref(), text, path)?;
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
        let impact = raw.impact.map(|impact| {
            let (duration, at) = (*impact.duration.get_ref(), impact.duration.span().start);
            if !(duration > 0.0 && duration.is_finite()) {
                let allowed = "a finite number above 0 (s)";
                return Err(Refusal::new(place("impact.duration", at), duration, allowed));
            }
            let [velocity, load, gaps] =
                [impact.velocity, impact.load, impact.gaps].map(|file| file.map(|file| folder.join(file)));
            Ok(MatrixImpact { duration, velocity, load, gaps })
        });
        Ok(Self {
            impact: impact.transpose()?,
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
            None => default_scales(&stiffness, &gaps, "scales = a file", |at, row| {
                z.place(z.line_of(row, at as u32))
            })?,
        };
        Ok(Matrices { stiffness, mass, gaps, scales, reference: self.reference })
    }
}

/// The scale of each gap over the bodies, which are what K connects. `place` names the entry of a contact in a row; `own` is
/// how other scales may be given.
fn default_scales(
    stiffness: &Csr,
    gaps: &[SparseVector],
    own: &str,
    place: impl Fn(usize, u32) -> String,
) -> Result<Vec<f64>, Refusal> {
    let bodies = connected(stiffness);
    let scale = |(at, gap): (usize, &SparseVector)| match gap_scale(stiffness, gap, |i| {
        bodies[i as usize] as usize
    }) {
        Some(scale) if scale > 0.0 => Ok(scale),
        found => {
            let value = format!("scale {} of contact {}", found.unwrap_or(0.0), at + 1);
            let allowed = format!("a gap that K resists on each body, z_b'K z_b > 0; or {own}");
            Err(Refusal::new(place(at, gap.0.first().map_or(0, |(row, _)| *row)), value, allowed))
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
