//! How good are the schemes in an impact of a mesh, and what do they cost?
//!
//! A block that is held at its sides hits a rigid wall with its whole foot: plane waves, with the exact force of a bar. Every
//! scheme steps it, on meshes that get finer, over stiffness penalties, at several penalty ratios, each at 0.95 of its own
//! linear limit (at half the contact-free step where beta_s is varied, as in the paper); the last study also takes the time.

use std::process::ExitCode;

use analyses::charts::studies;
use analyses::cli::{
    Analysis, Frame, Intent, Output, OutputOptions, Progress, Verdict, narrate, print_table,
};
use analyses::error::Result;
use analyses::meshes::impacts::{self, ImpactFineness};
use analyses::record::{Number, StudyRow};
use clap::{Parser, ValueEnum};
use figure::{Figure, Scale};

/// Errors, oscillations and cost of the schemes in the plane impact of a block; exit status 1 if a scheme that is proven to gain
/// nothing ends with more energy.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Studies: cells, penalty, oscillation, cost [default: all]
    #[arg(value_name = "STUDY")]
    studies: Vec<Study>,
    /// Coarse meshes and few points
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  impact-studies                             all studies, into figures/impact-studies/
  impact-studies penalty --stdout csv -q     errors over beta_s, on standard output
  impact-studies --quick                     coarse meshes, in seconds";

/// One figure with its records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Study {
    /// Errors over the size of the cells
    Cells,
    /// Errors and gap over beta_s
    Penalty,
    /// Overshoot and total variation at three ratios
    Oscillation,
    /// Errors against run time
    Cost,
}

/// What draws rows.
type Chart = fn(&[StudyRow]) -> Figure;

impl Study {
    fn name(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Penalty => "penalty",
            Self::Oscillation => "oscillation",
            Self::Cost => "cost",
        }
    }

    /// The rows, and how they are drawn.
    fn rows(self, fine: &ImpactFineness) -> (Result<Vec<StudyRow>>, Chart) {
        match self {
            Self::Cells => (impacts::cells(fine), studies::cells),
            Self::Penalty => (impacts::penalty(fine), studies::penalty),
            Self::Oscillation => (impacts::oscillation(fine), studies::oscillation),
            Self::Cost => (impacts::cost(fine), studies::cost),
        }
    }
}

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "impact-studies";
    type Plan = (Vec<Study>, ImpactFineness);
    type Found = Vec<StudyRow>;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Self::Plan> {
        let all = Study::value_variants().iter().copied();
        let asked = all.filter(|study| self.studies.is_empty() || self.studies.contains(study));
        let fine = if self.quick { ImpactFineness::quick() } else { ImpactFineness::figures() };
        Ok((asked.collect(), fine))
    }

    fn explain(&self, (studies, fine): &Self::Plan) -> Result<Vec<Intent>> {
        let names: Vec<&str> = studies.iter().map(|study| study.name()).collect();
        let method = format!(
            "a block of {:?} cells, {} penalties; each scheme at {} of its own linear limit; left out: loads, and meshes \
             without an exact solution",
            fine.cells,
            fine.penalties.len(),
            impacts::SHARE,
        );
        Ok(vec![Intent::of(names.join(", "), method)])
    }

    fn folder(&self) -> String {
        if self.quick { "quick".to_owned() } else { String::new() }
    }

    fn frames(&self, (studies, _): &Self::Plan) -> Vec<Frame> {
        studies.iter().map(|study| Frame::new(study.name(), Scale::Log, Scale::Log)).collect()
    }

    fn compute(&self, (studies, fine): Self::Plan, output: &Output) -> Result<(Self::Found, usize)> {
        let progress = Progress::new(studies.len(), "studies", self.output.quiet);
        let (mut found, mut files) = (Vec::new(), 0);
        for study in studies {
            progress.doing(study.name());
            let (rows, draw) = study.rows(&fine);
            let rows = rows?;
            files += output.write_rows(study.name(), &rows)?.len();
            if output.wants_figures() {
                files += output.write_figure(study.name(), &draw(&rows))?.len();
            }
            found.extend(rows);
            progress.add(1);
        }
        Ok((found, files))
    }

    fn print(&self, found: &Self::Found, output: &Output) -> Result<()> {
        output.print(found)
    }

    fn summarise(&self, found: &Self::Found) {
        summarise(found);
    }

    fn verdict(&self, found: &Self::Found) -> Verdict {
        if found.iter().all(impacts::holds) { Verdict::Holds } else { Verdict::Fails }
    }
}

/// A table for each study, one line a row of its finest mesh.
fn summarise(rows: &[StudyRow]) {
    let number = |x: Option<Number>| x.map_or("-".to_owned(), |x| format!("{:.2e}", x.0));
    let line = |row: &StudyRow| {
        vec![
            row.scheme.to_owned(),
            format!("{:e}", row.stiffness_penalty.0),
            format!("{}", row.ratio.0),
            format!("{:.4}", row.relative_courant.0),
            number(row.force_error),
            number(row.impulse_error),
            number(row.overshoot),
            number(row.variation),
            number(row.energy_ratio),
            number(row.seconds),
        ]
    };
    let header = ["scheme", "beta_s", "r", "C", "force", "impulse", "overshoot", "variation", "energy", "s"];
    for study in rows.chunk_by(|a, b| a.study == b.study) {
        let finest = study.iter().map(|row| row.cells).max().unwrap_or(0);
        analyses::tell!(
            "{}, {finest} cells: errors of force and impulse, energy at the end over that at the start",
            study[0].study
        );
        print_table(&header, study.iter().filter(|row| row.cells == finest).map(line));
    }
}
