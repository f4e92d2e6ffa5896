//! Which time step is stable in explicit contact dynamics, and what does the contact penalty do to it?
//!
//! Elastic bars of linear finite elements touch through a *bi-penalty* contact: a stiffness penalty s z z' and a
//! matching mass penalty m z z' on the gap z'u. The critical time step is 2/omega_max of
//!
//! ```text
//! [K + K_p - omega^2 (M + M_p)] x = 0      K_p = s z z'      M_p = m z z'
//! s = beta_s EA/h      m = s/(r omega_e^2)      omega_e^2 = 12/(1+2g) (c0/h)^2
//! ```
//! (Kolman, Kopacka, Gonzalez, Cho, Park, Math. Comput. Simulat. 189, 2021: "the paper").
//!
//! # Rooms
//! ```text
//! scene -> fem \
//! matrices      }-> pencil         bars, matrices of any mesh, bodies of elements: K, M and the gaps z
//! mesh ------- /
//! penalty -> pencil                (beta_s, r) as two numbers, s and m
//! pencil -> spectrum               engines that enclose the largest eigenvalue of a row of bars
//! pencil, sparse -> convex         the same for sparse matrices, where two bounds meet
//! spectrum, convex -> stability    time steps, maps, contours, optimal ratios
//! pencil -> schemes                state, step, energy and limit of a scheme, a folder each
//! damping                          what dampers leave of a step: another undamped problem
//! schemes -> impact, verify        runs beside exact solutions; limits found by stepping alone
//! mesh, convex -> parts            a mesh in parts, each with its share of the matrices, for several processes
//! sparse, symmetric                matrices by rows, and factors; double_double: twice the digits
//! error, memory, interrupt         what ends a run
//! ```
//!
//! A pencil may come from elsewhere: matrices of any mesh, gaps as sparse columns ([`pencil::Pencil::new`]), elements of
//! one's own ([`fem::assemble_elements`]). So may an engine ([`spectrum::Engine`]) and a scheme ([`schemes::Scheme`]);
//! `tests/extensions` has one of each, a page long, and the suites that they pass.
//!
//! One critical time step (linear limit, closed contact), with its enclosure:
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
//! use bipenalty::scene::load;
//! use bipenalty::spectrum::Engine;
//! use bipenalty::stability::Model;
//!
//! let scene = load("signorini")?.with_elements(200)?;
//! let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
//! let penalty = model.penalty(StiffnessPenalty::new(10.0)?, Ratio::new(2.0)?);
//! let l_max = model.auto().enclose(&penalty, None)?;
//! let step = model.critical_step(l_max);
//! assert!((step.critical_courant - 0.7891948863055671).abs() < 1e-14);
//! assert!(step.lower <= step.critical_courant && step.critical_courant <= step.upper);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A map for one's own bars
//! A steel striker on a fixed aluminium rod; every point is enclosed, in any order of threads:
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::penalty::PenaltyMass;
//! use bipenalty::scene::{Bar, End, Scene};
//! use bipenalty::spectrum::Spectrum;
//! use bipenalty::stability::{Sweep, Grid, Model, map};
//!
//! let steel = Bar { length: 0.2, elements: 80, youngs_modulus: 210e9, density: 7850.0, area: 4e-4, velocity: 5.0 };
//! let rod = Bar { length: 1.0, elements: 300, youngs_modulus: 70e9, density: 2700.0, area: 3e-4, velocity: 0.0 };
//! let scene = Scene::new("striker", End::Free, vec![steel, rod], End::Fixed, None)?;
//! let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
//! let grid = Grid::new(&Sweep::log(1e-3, 1e12, 61)?, &Sweep::list([1.0, f64::INFINITY]))?;
//! let curves = map(&model, &grid, &Spectrum(Box::new(model.auto())), &|_| ());
//! let limit = curves[0].points[60].step?;
//! assert!(model.time_step(limit.lower) > 4.8e-7); // r = 1 keeps the step, in s, even at beta_s = 1e12
//! assert!(curves[1].points[60].step?.critical_courant < 2e-6); // the pure penalty method does not
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # An impact, step by step
//! A bar of one's own on a wall; the exact contact force is rho c0 A v:
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::impact::{Recording, Run, Summary};
//! use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
//! use bipenalty::scene::{Bar, End, Impact, Scene};
//! use bipenalty::schemes::SchemeName;
//! use bipenalty::stability::Model;
//!
//! let bar = Bar { length: 0.2, elements: 80, youngs_modulus: 210e9, density: 7850.0, area: 4e-4, velocity: 5.0 };
//! let impact = Impact { duration: 1e-4, gaps: vec![0.0], gravity: 0.0 };
//! let scene = Scene::new("taylor-bar", End::Free, vec![bar], End::Wall, Some(impact))?;
//! let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
//! let run = Run::new(model, SchemeName::PredictorCorrector, StiffnessPenalty::new(1e4)?, Ratio::OPTIMAL)?;
//! let history = run.execute(&Recording::default(), None)?;
//! let middle = history.forces(0).nth(history.time.len() / 3).unwrap();
//! assert!((middle / (7850.0 * 5172.2 * 4e-4 * 5.0) - 1.0).abs() < 0.01);
//! assert!(Summary::of(&run, &history).force_error.is_some_and(|error| error < 0.06));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Meshes, and matrices of other codes
//! [`stability::AnyModel`] asks the same of any scene: `[[bar]]`, `[matrices]` or `[[body]]`. Meshes of any kind, with any number
//! of contacts, are one convex function ([`convex`]).
//!
//! # Features
//! None is on by default; `lapack` adds an independent engine that needs a system LAPACK. The command line tools, the
//! charts and the bench are packages beside this one, in `analyses/`.
//!
//! # Symbols
//! | symbol | name in code | unit | meaning |
//! |---|---|---|---|
//! | beta_s, beta_m | `stiffness_penalty`, `mass_penalty` | 1 | dimensionless penalty parameters (23) |
//! | r | `ratio` | 1 | penalty ratio (24) |
//! | s, m | `stiffness`, `mass` of a penalty | N/m, kg | what multiplies z z' |
//! | g | `gamma` of a mass matrix | 1 | 0 consistent .. 1 lumped |
//! | omega, l | `omega_max`, `l` | rad/s, rad^2/s^2 | a frequency and its square, never one named as the other |
//! | C, C_r | `relative_courant`, `critical_courant` | 1 | dt/dt_cr, c0 dt_cr/h |

pub mod convex;
pub mod damping;
pub mod double_double;
pub mod error;
pub mod fem;
pub mod impact;
pub mod interrupt;
pub mod matrices;
pub mod memory;
pub mod mesh;
pub mod parts;
pub mod penalty;
pub mod pencil;
pub mod scene;
pub mod schemes;
pub mod sparse;
pub mod spectrum;
pub mod stability;
mod symmetric;
pub mod verify;

/// The examples of the README, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
