//! Parts of a mesh and the questions about them, for processes that share a mesh.

use std::sync::{Mutex, PoisonError};

use bipenalty::convex::Options;
use bipenalty::convex::factor::Verdict;
use bipenalty::convex::patches::{ElementMatrices, Elements};
use bipenalty::convex::session::{self, Answer, Facts, Question};
use bipenalty::convex::source::Found;
use bipenalty::convex::span::{Row, Sizes};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;
use bipenalty::parts::{self, Share};
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::sparse::SparseVector;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::{failed, refused};

/// Compressed rows: starts, columns, entries.
type Rows<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>);

/// The numbers of an axis: `0,0.5,10`, `lin:0:10:401` or `log:1e-3:1e12:301`.
#[pyfunction]
pub fn axis(text: &str) -> PyResult<Vec<f64>> {
    text.parse::<bipenalty::stability::Sweep>().map(|axis| axis.values).map_err(refused)
}

/// Cuts a scene of meshes into parts: the lists of each, and the number of elements.
#[pyfunction]
pub fn split<'py>(
    py: Python<'py>,
    text: &str,
    path: &str,
    gamma: f64,
    parts: usize,
    edge: usize,
) -> PyResult<(Vec<Bound<'py, PyDict>>, usize)> {
    let mass = MassMatrix::new(gamma).map_err(refused)?;
    let scene = MeshScene::parse(text, path).map_err(failed)?;
    let (shares, elements) = py.detach(|| parts::split(&scene, mass, parts, edge)).map_err(failed)?;
    Ok((shares.iter().map(|share| listed(py, share)).collect::<PyResult<_>>()?, elements))
}

/// A share as arrays; `Part` reads them again.
fn listed<'py>(py: Python<'py>, share: &Share) -> PyResult<Bound<'py, PyDict>> {
    let lists = PyDict::new(py);
    let whole = |name: &str, values: Vec<i64>| lists.set_item(name, values.to_pyarray(py));
    let real = |name: &str, values: Vec<f64>| lists.set_item(name, values.to_pyarray(py));
    let Elements { shapes, elements } = &share.elements;
    whole("unknowns", share.unknowns.iter().map(|u| *u as i64).collect())?;
    whole("shape_size", shapes.iter().map(|s| s.mass.len().isqrt() as i64).collect())?;
    real("shape_stiffness", shapes.iter().flat_map(|s| &s.stiffness).copied().collect())?;
    real("shape_mass", shapes.iter().flat_map(|s| &s.mass).copied().collect())?;
    whole("element_shape", elements.iter().map(|(shape, _)| *shape as i64).collect())?;
    let unknowns = elements.iter().flat_map(|(_, u)| u.iter().map(|u| u.map_or(-1, i64::from)));
    whole("element_unknowns", unknowns.collect())?;
    whole("element_patch", share.patch.iter().map(|p| *p as i64).collect())?;
    let entries = || share.contacts.iter().flat_map(|c| c.column.0.iter());
    whole("gap_size", share.contacts.iter().map(|c| c.column.0.len() as i64).collect())?;
    whole("gap_unknowns", entries().map(|(u, _)| i64::from(*u)).collect())?;
    real("gap_entries", entries().map(|(_, z)| *z).collect())?;
    real("gap_scale", share.contacts.iter().map(|c| c.scale).collect())?;
    if let Some(carrier) = &share.carrier {
        whole("gap_patch", carrier.iter().map(|p| *p as i64).collect())?;
    }
    Ok(lists)
}

/// Reads the arrays of a part from a dict.
struct Lists<'a, 'py>(&'a Bound<'py, PyDict>);

impl Lists<'_, '_> {
    fn array<T: numpy::Element + Copy>(&self, name: &str) -> PyResult<Vec<T>> {
        let found = self.0.get_item(name)?;
        let found = found.ok_or_else(|| PyValueError::new_err(format!("part: there is no {name}")))?;
        let array: PyReadonlyArray1<'_, T> = found.extract().map_err(|_| {
            PyValueError::new_err(format!(
                "part, {name}: allowed: one dimension of int64, or of float64 for numbers"
            ))
        })?;
        Ok(array.as_array().to_vec())
    }

    /// Numbers that may not be negative.
    fn counts(&self, name: &str) -> PyResult<Vec<usize>> {
        let number = |v: i64| {
            usize::try_from(v).map_err(|_| PyValueError::new_err(format!("part, {name}: {v} is negative")))
        };
        self.array::<i64>(name)?.into_iter().map(number).collect()
    }

    /// Numbers cut into pieces; all of them must be used.
    fn pieces<T: numpy::Element + Copy>(&self, name: &str, lengths: &[usize]) -> PyResult<Vec<Vec<T>>> {
        let all = self.array::<T>(name)?;
        let mut rest = &all[..];
        let wrong =
            || PyValueError::new_err(format!("part, {name}: {} entries do not fit the sizes", all.len()));
        let mut pieces = Vec::with_capacity(lengths.len());
        for length in lengths {
            let (piece, after) = rest.split_at_checked(*length).ok_or_else(wrong)?;
            pieces.push(piece.to_vec());
            rest = after;
        }
        if rest.is_empty() { Ok(pieces) } else { Err(wrong()) }
    }

    fn share(&self) -> PyResult<Share> {
        let sizes = self.counts("shape_size")?;
        let squares: Vec<usize> = sizes.iter().map(|n| n.saturating_mul(*n)).collect();
        let matrices =
            self.pieces("shape_stiffness", &squares)?.into_iter().zip(self.pieces("shape_mass", &squares)?);
        let shapes = matrices.map(|(stiffness, mass)| ElementMatrices { stiffness, mass }).collect();
        let of = self.counts("element_shape")?;
        let size = |shape: &usize| sizes.get(*shape).copied().unwrap_or(0);
        let unknowns = self.pieces::<i64>("element_unknowns", &of.iter().map(size).collect::<Vec<_>>())?;
        let known = |u: i64| (u >= 0).then(|| u32::try_from(u).unwrap_or(u32::MAX));
        let listed = unknowns.into_iter().map(|element| element.into_iter().map(known).collect());
        let gaps = self.counts("gap_size")?;
        let columns =
            self.pieces::<i64>("gap_unknowns", &gaps)?.into_iter().zip(self.pieces("gap_entries", &gaps)?);
        let scales = self.array::<f64>("gap_scale")?;
        if scales.len() != gaps.len() {
            return Err(PyValueError::new_err("part, gap_scale: allowed: one scale for each gap"));
        }
        let column = |(unknowns, entries): (Vec<i64>, Vec<f64>)| {
            let unknowns = unknowns.into_iter().map(|u| u32::try_from(u).unwrap_or(u32::MAX));
            SparseVector(unknowns.zip(entries).collect())
        };
        let contact = |(pair, scale)| Gap { column: column(pair), scale, initial: 0.0 };
        Ok(Share {
            unknowns: self.counts("unknowns")?.into_iter().map(|u| u as u64).collect(),
            elements: Elements { shapes, elements: of.into_iter().zip(listed).collect() },
            patch: self.counts("element_patch")?,
            contacts: columns.zip(scales).map(contact).collect(),
            carrier: if self.0.contains("gap_patch")? { Some(self.counts("gap_patch")?) } else { None },
        })
    }
}

/// One part of a mesh: its matrices, its patches, and its piece of each sampled vector.
#[pyclass(module = "bipenalty._bipenalty")]
pub struct Part(parts::Part);

fn rows<'py>(py: Python<'py>, of: impl Iterator<Item = Vec<(usize, f64)>>) -> Rows<'py> {
    let (mut starts, mut columns, mut entries) = (vec![0_i64], Vec::new(), Vec::new());
    for row in of {
        columns.extend(row.iter().map(|(column, _)| *column as i64));
        entries.extend(row.iter().map(|(_, entry)| *entry));
        starts.push(columns.len() as i64);
    }
    (starts.to_pyarray(py), columns.to_pyarray(py), entries.to_pyarray(py))
}

fn matrix_rows<'py>(py: Python<'py>, matrix: &Matrix) -> Rows<'py> {
    rows(py, (0..matrix.size()).map(|i| matrix.row(i).collect()))
}

fn row_tuple<'py>(py: Python<'py>, row: &Row) -> RowTuple<'py> {
    let array = |values: &[f64]| values.to_pyarray(py);
    (array(&row.stiffness), array(&row.mass), array(&row.gaps), array(&row.gap_sizes), row.square)
}

/// The forms of a vector: v_i'K v, v_i'M v, z_j'v, |z_j|'|v|, v'Dv.
type RowTuple<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    f64,
);

#[pymethods]
impl Part {
    /// A part of the lists that `split` gives; a patch may take `memory` bytes.
    #[new]
    fn new(py: Python<'_>, lists: &Bound<'_, PyDict>, memory: usize) -> PyResult<Self> {
        let share = Lists(lists).share()?;
        py.detach(|| parts::Part::new(share, memory)).map(Self).map_err(refused)
    }

    /// The unknowns by their numbers in the whole mesh, ascending.
    fn unknowns<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.0.unknowns().iter().map(|u| *u as i64).collect::<Vec<_>>().to_pyarray(py)
    }

    /// K by rows.
    fn stiffness<'py>(&self, py: Python<'py>) -> Rows<'py> {
        matrix_rows(py, self.0.pencil().stiffness())
    }

    /// M by rows; None where it is diagonal.
    fn mass<'py>(&self, py: Python<'py>) -> Option<Rows<'py>> {
        let mass = self.0.pencil().mass();
        (!mass.is_diagonal()).then(|| matrix_rows(py, mass))
    }

    /// diag(M).
    fn diagonal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.0.pencil().mass_diagonal().to_pyarray(py)
    }

    /// The gaps by contacts.
    fn gaps<'py>(&self, py: Python<'py>) -> Rows<'py> {
        let column = |gap: &Gap| gap.column.0.iter().map(|(u, z)| (*u as usize, *z)).collect();
        rows(py, self.0.pencil().contacts().iter().map(column))
    }

    /// The scales of the gaps.
    fn scales<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.0.pencil().contacts().iter().map(|gap| gap.scale).collect::<Vec<_>>().to_pyarray(py)
    }

    /// rho_K, rho_M, roundings of an entry, unknowns, entries of the longest gap, parts.
    fn sizes(&self) -> SizesTuple {
        let Sizes { rho, row, unknowns, gap, parts } = self.0.sizes();
        (rho.0, rho.1, row, unknowns, gap, parts)
    }

    /// Patches, those among them that differ, unknowns of the largest.
    fn patches(&self) -> (usize, usize, usize) {
        self.0.patches()
    }

    /// Adds its piece of a vector; its forms, or None if the vector was known. `sum` adds an array up over all parts, in
    /// place, and gives every part the same bits.
    fn add<'py>(
        &mut self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        unknowns: usize,
        sum: &Bound<'py, PyAny>,
    ) -> PyResult<Option<RowTuple<'py>>> {
        let x = x.as_array().to_vec();
        if x.len() != self.0.unknowns().len() {
            return Err(PyValueError::new_err("a vector of another size than the part"));
        }
        let mut raised = None;
        let mut over_all = |values: &mut [f64]| {
            let array = values.to_pyarray(py);
            match sum.call1((&array,)) {
                Ok(_) if array.len() == values.len() => {
                    values.copy_from_slice(&array.readonly().as_array().to_vec())
                }
                Ok(_) => values.fill(f64::NAN),
                Err(error) => {
                    values.fill(f64::NAN);
                    raised.get_or_insert(error);
                }
            }
        };
        let row = self.0.add(&x, unknowns, &mut over_all);
        match raised {
            Some(error) => Err(error),
            None => Ok(row.map(|row| row_tuple(py, &row))),
        }
    }

    /// Its piece of V y.
    fn combine<'py>(&self, py: Python<'py>, y: Vec<f64>) -> Bound<'py, PyArray1<f64>> {
        self.0.combine(&y).to_pyarray(py)
    }

    /// 0 and 0: u M - a K - t P is semidefinite; 1 and how much larger u would have to be, relative; 2: it is not.
    fn prove(&self, py: Python<'_>, u: f64, a: f64, t: f64, margin: f64) -> (u8, f64) {
        match py.detach(|| self.0.prove(u, (a, t), margin)) {
            Verdict::Proven => (0, 0.0),
            Verdict::TooClose(needed) => (1, needed),
            Verdict::Refuted => (2, 0.0),
        }
    }
}

type SizesTuple = (f64, f64, usize, usize, usize, usize);

/// The driver that encloses a map by question and answer.
#[pyclass(frozen, module = "bipenalty._bipenalty")]
pub struct Session(Mutex<Option<session::Session>>);

impl Session {
    fn with<R>(&self, py: Python<'_>, use_it: impl FnOnce(&mut session::Session) -> R + Send) -> PyResult<R>
    where
        R: Send,
    {
        py.detach(|| {
            let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            held.as_mut().map(use_it).ok_or_else(|| PyValueError::new_err("this session is finished"))
        })
    }

    fn tell(&self, py: Python<'_>, answer: Answer) -> PyResult<()> {
        self.with(py, |session| session.tell(answer))?.map_err(refused)
    }
}

#[pymethods]
impl Session {
    /// Begins; `sizes` are those of all parts, `scales` those of their gaps one part after the other.
    #[new]
    fn new(
        unknowns: usize,
        scales: Vec<f64>,
        sizes: Vec<SizesTuple>,
        points: Vec<(f64, f64)>,
        reference: Option<f64>,
        tolerance: f64,
    ) -> PyResult<Self> {
        let of = |(rho_k, rho_m, row, unknowns, gap, parts): SizesTuple| Sizes {
            rho: (rho_k, rho_m),
            row,
            unknowns,
            gap,
            parts,
        };
        let sizes = sizes.into_iter().map(of).reduce(Sizes::and);
        let sizes = sizes.ok_or_else(|| PyValueError::new_err("sizes: there is no part"))?;
        let facts = Facts { unknowns, scales, sizes, sharp: false };
        let options = Options { tolerance, ..Options::default() };
        let session = session::Session::new(facts, points, reference, options)?;
        Ok(Self(Mutex::new(Some(session))))
    }

    /// The next question as a tuple, ("seek", a, t, y or None, tolerance, closed), ("residual", t, y) or
    /// ("prove", u, a, t, margin); None at the end.
    fn question<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let question = self.with(py, |session| session.question().cloned())?;
        question
            .map(|question| match question {
                Question::Seek { combination: (a, t), start, tolerance, closed } => {
                    ("seek", a, t, start, tolerance, closed).into_pyobject(py).map(Bound::into_any)
                }
                Question::Residual { t, y } => ("residual", t, y).into_pyobject(py).map(Bound::into_any),
                Question::Prove { u, combination: (a, t), margin } => {
                    ("prove", u, a, t, margin).into_pyobject(py).map(Bound::into_any)
                }
            })
            .transpose()
    }

    /// Answers "seek".
    #[expect(clippy::type_complexity, reason = "the tuple that `Part.add` gives")]
    fn found(
        &self,
        py: Python<'_>,
        value: f64,
        residual: f64,
        row: Option<(Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>, f64)>,
    ) -> PyResult<()> {
        let row = row.map(|(stiffness, mass, gaps, gap_sizes, square)| Row {
            stiffness,
            mass,
            gaps,
            gap_sizes,
            square,
        });
        self.tell(py, Answer::Found { found: Found { value, residual }, row })
    }

    /// Answers "residual".
    fn residual(&self, py: Python<'_>, value: f64) -> PyResult<()> {
        self.tell(py, Answer::Residual(value))
    }

    /// Answers "prove", with what `Part.prove` said of all parts.
    fn verdict(&self, py: Python<'_>, kind: u8, needed: f64) -> PyResult<()> {
        let verdict = match kind {
            0 => Verdict::Proven,
            1 => Verdict::TooClose(needed),
            _ => Verdict::Refuted,
        };
        self.tell(py, Answer::Verdict(verdict))
    }

    /// f(0), mu, and the enclosure of l at each point; eigenproblems and proofs.
    #[expect(clippy::type_complexity, reason = "named in Python")]
    fn finish(&self, py: Python<'_>) -> PyResult<(f64, f64, Vec<(f64, f64)>, (usize, usize))> {
        let session = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        let session = session.ok_or_else(|| PyValueError::new_err("this session is finished"))?;
        let found = py.detach(|| session.finish()).map_err(refused)?;
        let points = found.points.iter().map(|point| (point.lower, point.upper)).collect();
        Ok((found.mesh, found.slope, points, found.effort))
    }
}
