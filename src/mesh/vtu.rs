//! Meshes with fields as `.vtu`, the XML form of VTK that ParaView reads (VTK file formats, "UnstructuredGrid").
//!
//! Written here, as text: the crate at hand (vtkio 0.6) brings thirty others, two of them with code that coming compilers
//! refuse, for these few lines.

use std::fmt::Display;
use std::io::{self, Write};

use super::assembly::{Elements, HELD};

/// Numbers in a line.
const LINE: usize = 12;

/// A named field over nodes or elements.
#[derive(Debug, Clone, Copy)]
pub enum Field<'a> {
    /// A vector on the free degrees of freedom, such as a mode; held ones are 0.
    Displacement(&'a [f64]),
    /// A number for each node.
    Nodes(&'a [f64]),
    /// A number for each element.
    Cells(&'a [f64]),
    /// A symmetric tensor for each element: xx, yy, zz, xy, yz, xz, as ParaView has them.
    Tensors(&'a [[f64; 6]]),
}

impl Elements {
    /// Writes the mesh with fields, names of letters, digits, '-' and '_'; the body of each element is among them.
    ///
    /// # Errors
    /// What the writer reports.
    pub fn write_vtu(&self, out: &mut dyn Write, fields: &[(&str, Field)]) -> io::Result<()> {
        let nodes = self.first[self.bodies.len()].0;
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(out, "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">")?;
        writeln!(out, "<UnstructuredGrid>")?;
        writeln!(out, "<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{}\">", self.len())?;
        self.write_mesh(out)?;
        writeln!(out, "<PointData>")?;
        for (name, field) in fields {
            match field {
                Field::Displacement(u) => {
                    let what = format!("Float64\" Name=\"{name}\" NumberOfComponents=\"3");
                    array(out, &what, self.on_nodes(u))?;
                }
                Field::Nodes(values) => array(out, &format!("Float64\" Name=\"{name}"), values.iter())?,
                Field::Cells(_) | Field::Tensors(_) => (),
            }
        }
        writeln!(out, "</PointData>\n<CellData>")?;
        array(out, "Int32\" Name=\"body", (0..self.len()).map(|e| self.body(e)))?;
        for (name, field) in fields {
            match field {
                Field::Cells(values) => array(out, &format!("Float64\" Name=\"{name}"), values.iter())?,
                Field::Tensors(values) => {
                    let what = format!("Float64\" Name=\"{name}\" NumberOfComponents=\"6");
                    array(out, &what, values.as_flattened().iter())?;
                }
                Field::Displacement(_) | Field::Nodes(_) => (),
            }
        }
        writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
    }

    fn write_mesh(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "<Points>")?;
        let places = self.bodies.iter().flat_map(|body| body.mesh.nodes.iter().flatten());
        array(out, "Float64\" NumberOfComponents=\"3", places)?;
        writeln!(out, "</Points>\n<Cells>")?;
        array(out, "Int64\" Name=\"connectivity", (0..self.len()).flat_map(|e| self.nodes(e)))?;
        let offsets = (0..self.len()).scan(0, |end, e| {
            *end += self.nodes(e).len();
            Some(*end)
        });
        array(out, "Int64\" Name=\"offsets", offsets)?;
        let kinds = self
            .bodies
            .iter()
            .flat_map(|body| (0..body.mesh.elements()).map(|e| body.mesh.kind(e).element().vtk_cell));
        array(out, "UInt8\" Name=\"types", kinds)?;
        writeln!(out, "</Cells>")
    }

    /// A vector on the free degrees of freedom as three numbers a node.
    fn on_nodes<'a>(&'a self, u: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let d = self.dimension;
        let entry = move |node: usize, i: usize| match self.dofs.get(node * d + i) {
            Some(dof) if i < d && *dof != HELD => u[*dof as usize],
            _ => 0.0,
        };
        (0..self.first[self.bodies.len()].0).flat_map(move |node| (0..3).map(move |i| entry(node, i)))
    }
}

/// Writes the collection `.pvd` that ParaView plays: the files of a run with their times, s.
///
/// # Errors
/// What the writer reports.
pub fn write_pvd(out: &mut dyn Write, frames: &[(f64, String)]) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>")?;
    for (time, file) in frames {
        writeln!(out, "<DataSet timestep=\"{time}\" file=\"{file}\"/>")?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

fn array<T: Display>(out: &mut dyn Write, what: &str, values: impl Iterator<Item = T>) -> io::Result<()> {
    writeln!(out, "<DataArray type=\"{what}\" format=\"ascii\">")?;
    for (at, value) in values.enumerate() {
        write!(out, "{value}{}", if (at + 1) % LINE == 0 { '\n' } else { ' ' })?;
    }
    writeln!(out, "\n</DataArray>")
}
