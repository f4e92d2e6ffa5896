//! What does contact cost a mesh, what proves its step, and what do rules of thumb make of it?
//!
//! Two blocks, one on the other, in the plane and in space, with meshes that match and that do not, and a disc on a plane; every
//! element; cells unlike in the two bodies; the bounds that single elements, patches of them and the whole matrix prove; rules
//! of thumb of other codes with the sign of their error; the five penalty scales of a manual.

use std::process::ExitCode;

use analyses::charts;
use analyses::cli::{
    Analysis, Frame, Intent, Output, OutputOptions, Progress, Units, Verdict, narrate, print_table,
};
use analyses::error::{Refusal, Result};
use analyses::meshes::{self, Fineness};
use analyses::record::{MeshRow, StabilityRow, Subject};
use bipenalty::stability::{AnyModel, Asking, Grid, Sweep};
use clap::{Parser, ValueEnum};
use figure::{Figure, Scale};
use rayon::prelude::*;

/// Limits of meshes: elements, unlike cells, proofs, and rules of thumb; exit status 1 if a proven step is beyond the limit.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Studies: contact, elements, sizes, bounds, rules, scales [default: all]
    #[arg(value_name = "STUDY")]
    studies: Vec<Study>,
    /// Units of the axes of study contact, whose records hold both; the other studies compare steps with one another
    #[arg(long, value_name = "UNITS", default_value = "dimensionless")]
    units: Units,
    /// Refused with the reason.
    #[arg(long, hide = true, value_name = "SPEC", allow_negative_numbers = true)]
    stiffness: Option<String>,
    /// Refused with the reason.
    #[arg(long, hide = true, value_name = "SPEC", allow_negative_numbers = true)]
    beta_s: Option<String>,
    /// Coarse meshes and few points
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  mesh-limits                              all studies, into figures/mesh-limits/
  mesh-limits rules --stdout csv --quiet   what rules of thumb say, on standard output
  mesh-limits --quick                      coarse meshes, in seconds";

/// One figure with its records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Study {
    /// C_r over beta_s for matching and unlike meshes
    Contact,
    /// Elements of first and second order
    Elements,
    /// Cells unlike in the two bodies
    Sizes,
    /// What elements, patches and the whole matrix prove
    Bounds,
    /// Rules of thumb beside the exact step
    Rules,
    /// Five penalty scales of a manual
    Scales,
}

/// What draws rows.
type Chart = fn(&[MeshRow]) -> Figure;

impl Study {
    fn name(self) -> &'static str {
        match self {
            Self::Contact => "contact",
            Self::Elements => "elements",
            Self::Sizes => "sizes",
            Self::Bounds => "bounds",
            Self::Rules => "rules",
            Self::Scales => "scales",
        }
    }

    /// The vertical axis; with several panels that of one of them.
    fn upright(self) -> Scale {
        match self {
            Self::Contact => Scale::Linear,
            _ => Scale::Log,
        }
    }

    /// The rows, and how they are drawn; `None` for the curves of contact.
    fn rows(self, fine: &Fineness) -> Option<(Result<Vec<MeshRow>>, Chart)> {
        Some(match self {
            Self::Contact => return None,
            Self::Elements => (meshes::elements(fine), charts::meshes::elements),
            Self::Sizes => (meshes::sizes(fine), charts::meshes::sizes),
            Self::Bounds => (meshes::bounds(fine), charts::meshes::bounds),
            Self::Rules => (meshes::rules(fine), charts::meshes::rules),
            Self::Scales => (meshes::scales(fine), charts::meshes::scales),
        })
    }
}

/// What was found.
#[derive(Default)]
struct Found {
    contact: Vec<StabilityRow>,
    rows: Vec<MeshRow>,
}

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "mesh-limits";
    type Plan = (Vec<Study>, Fineness);
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Self::Plan> {
        let all = Study::value_variants().iter().copied();
        let asked = all.filter(|study| self.studies.is_empty() || self.studies.contains(study));
        let asked: Vec<Study> = asked.collect();
        self.check(&asked)?;
        Ok((asked, if self.quick { Fineness::QUICK } else { Fineness::FIGURES }))
    }

    fn explain(&self, (studies, fine): &Self::Plan) -> Result<Vec<Intent>> {
        let names: Vec<&str> = studies.iter().map(|study| study.name()).collect();
        let disc =
            if meshes::disc().is_some() { "" } else { ", without the disc, whose mesh is not at hand" };
        let Fineness { plane, space, points } = fine;
        let method = format!(
            "blocks of {plane} cells along an edge in the plane and {space} in space, {points} penalties{disc}; enclosed by \
             the convex curve; left out: schemes other than central differences"
        );
        Ok(vec![Intent::of(names.join(", "), method)])
    }

    fn folder(&self) -> String {
        if self.quick { "quick".to_owned() } else { String::new() }
    }

    fn frames(&self, (studies, _): &Self::Plan) -> Vec<Frame> {
        studies.iter().map(|study| Frame::new(study.name(), Scale::Log, study.upright())).collect()
    }

    fn compute(&self, (studies, fine): Self::Plan, output: &Output) -> Result<(Found, usize)> {
        let progress = Progress::new(studies.len(), "studies", self.output.quiet);
        let (mut found, mut files) = (Found::default(), 0);
        for study in studies {
            progress.doing(study.name());
            files += match study.rows(&fine) {
                None => contact(&fine, self.units, output, &mut found.contact)?,
                Some((rows, draw)) => {
                    let rows = rows?;
                    let mut files = output.write_rows(study.name(), &rows)?.len();
                    if output.wants_figures() {
                        files += output.write_figure(study.name(), &draw(&rows))?.len();
                    }
                    found.rows.extend(rows);
                    files
                }
            };
            progress.add(1);
        }
        Ok((found, files))
    }

    fn print(&self, found: &Found, output: &Output) -> Result<()> {
        // Rows of two kinds do not fit under one header: the curves of contact are printed where they are all there is.
        if found.rows.is_empty() { output.print(&found.contact) } else { output.print(&found.rows) }
    }

    fn summarise(&self, found: &Found) {
        summarise(&found.rows);
    }

    fn verdict(&self, found: &Found) -> Verdict {
        if found.rows.iter().all(MeshRow::holds) { Verdict::Holds } else { Verdict::Fails }
    }
}

impl Options {
    /// Refuses what does not go with these studies, and says why.
    fn check(&self, studies: &[Study]) -> Result<(), Refusal> {
        for (option, typed) in [("--stiffness", &self.stiffness), ("--beta-s", &self.beta_s)] {
            if let Some(typed) = typed {
                let allowed = format!(
                    "none here, where unlike meshes are compared at penalties of their own; for a mesh of yours: \
                     stability-map MESH.toml {option} {typed}"
                );
                return Err(Refusal::new(option, typed, allowed));
            }
        }
        match studies.iter().find(|study| self.units == Units::Si && **study != Study::Contact) {
            None => Ok(()),
            Some(study) => {
                let value =
                    format!("si with study {}, whose steps are relative to one another", study.name());
                Err(Refusal::new(
                    "--units",
                    value,
                    "si with study contact alone: mesh-limits contact --units si",
                ))
            }
        }
    }
}

/// C_r over beta_s of matching and unlike meshes.
fn contact(fine: &Fineness, units: Units, output: &Output, all: &mut Vec<StabilityRow>) -> Result<usize> {
    let (beta_s, ratios) =
        (Sweep::log(1e-2, 1e5, fine.points)?, Sweep::list([0.25, 1.0, 4.0, f64::INFINITY]));
    let grid = Grid::new(&beta_s, &ratios)?;
    let rows = |model: &AnyModel| -> Result<Vec<StabilityRow>> {
        let curves = model.map(&grid, &Asking { tolerance: Some(1e-4), ..Asking::default() }, &|_| ())?;
        Ok(StabilityRow::of(&Subject::of(model)?, "spectrum", &curves))
    };
    let panels = meshes::contact_models(fine)?.par_iter().map(rows).collect::<Result<Vec<_>>>()?;
    *all = panels.concat();
    let mut files = output.write_rows("contact", all)?.len();
    if output.wants_figures() {
        let figure = charts::curves("contact.csv", &panels, true);
        let si = units == Units::Si;
        let figure = if si { charts::in_si(figure, &panels, &[]) } else { figure };
        files += output.write_figure("contact", &figure)?.len();
    }
    Ok(files)
}

/// One line a study, mesh and estimate: between what its error lies.
fn summarise(rows: &[MeshRow]) {
    let mut kinds: Vec<(&str, &str, &str)> = Vec::new();
    for row in rows.iter().filter(|row| row.estimate != "exact") {
        let kind = (row.study, row.scene.as_str(), row.estimate);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let line = |kind: &(&str, &str, &str)| {
        let of = || rows.iter().filter(|row| (row.study, row.scene.as_str(), row.estimate) == *kind);
        let (low, high) = of().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), row| {
            (low.min(row.error.0), high.max(row.error.0))
        });
        let percent = |error: f64| format!("{:+.2} %", 100.0 * error);
        let (study, scene, estimate) = *kind;
        let bold = of().filter(|row| row.step.0 > row.step_upper.0).count();
        vec![
            study.to_owned(),
            scene.to_owned(),
            estimate.to_owned(),
            percent(low),
            percent(high),
            format!("{bold} of {}", of().count()),
        ]
    };
    if !kinds.is_empty() {
        let header = ["study", "mesh", "estimate", "least error", "largest error", "beyond the limit"];
        print_table(&header, kinds.iter().map(line));
    }
}
