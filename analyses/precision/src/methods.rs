//! The methods that find or bound l_max, each as a call that can be timed.

use super::Eigenproblem;
use super::estimates::{element_bound, gershgorin, lanczos, power, summed};
#[cfg(feature = "lapack")]
use bipenalty::pencil::ChainPencil;
use bipenalty::spectrum::{Dense, Engine, Secular, Sturm, Uncertified, WIDEST_ENCLOSURE};

/// A way to l_max.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The closed form, proven, from the scene on.
    ClosedForm,
    /// The closed form without its proof.
    ClosedFormUnproven,
    /// The secular function, proven, from the matrices on; made anew for this one value.
    Secular,
    /// Bisection on the signs of pivots, proven.
    Sturm,
    /// The dense reduction with faer, proven.
    Dense,
    /// The largest element eigenvalue, contacts included: what codes use.
    ElementBound,
    /// Gershgorin's discs.
    Gershgorin,
    /// Power iteration with so many steps.
    Power(usize),
    /// Lanczos' method with so many steps.
    Lanczos(usize),
    /// The dense reduction with LAPACK, proven.
    #[cfg(feature = "lapack")]
    Lapack,
    /// LAPACK's `dsygvx` for the largest eigenvalue alone.
    #[cfg(feature = "lapack")]
    Dsygvx,
    /// LAPACK's `dsbgvx` for the largest eigenvalue alone.
    #[cfg(feature = "lapack")]
    Dsbgvx,
}

/// A call that returns l_max, rad^2/s^2, or says why there is none.
pub type Call<'a> = Box<dyn Fn() -> Result<f64, String> + 'a>;

impl Method {
    /// Every method.
    pub const ALL: &'static [Self] = &[
        Self::ClosedForm,
        Self::ClosedFormUnproven,
        Self::Secular,
        Self::Sturm,
        Self::Dense,
        #[cfg(feature = "lapack")]
        Self::Lapack,
        #[cfg(feature = "lapack")]
        Self::Dsygvx,
        #[cfg(feature = "lapack")]
        Self::Dsbgvx,
        Self::ElementBound,
        Self::Gershgorin,
        Self::Power(30),
        Self::Power(300),
        Self::Lanczos(20),
        Self::Lanczos(80),
    ];

    /// The name in records.
    pub fn name(self) -> String {
        match self {
            Self::ClosedForm => "closed-form".to_owned(),
            Self::ClosedFormUnproven => "closed-form unproven".to_owned(),
            Self::Secular => "secular".to_owned(),
            Self::Sturm => "sturm".to_owned(),
            Self::Dense => "dense".to_owned(),
            Self::ElementBound => "element bound".to_owned(),
            Self::Gershgorin => "Gershgorin".to_owned(),
            Self::Power(steps) => format!("power iteration {steps} steps"),
            Self::Lanczos(steps) => format!("Lanczos {steps} steps"),
            #[cfg(feature = "lapack")]
            Self::Lapack => "lapack".to_owned(),
            #[cfg(feature = "lapack")]
            Self::Dsygvx => "LAPACK dsygvx".to_owned(),
            #[cfg(feature = "lapack")]
            Self::Dsbgvx => "LAPACK dsbgvx".to_owned(),
        }
    }

    /// The order in which its cost grows with the number of elements.
    pub fn order(self) -> i32 {
        match self {
            Self::ClosedForm | Self::ClosedFormUnproven => 0,
            Self::Dense => 3,
            #[cfg(feature = "lapack")]
            Self::Lapack | Self::Dsygvx => 3,
            #[cfg(feature = "lapack")]
            Self::Dsbgvx => 2,
            _ => 1,
        }
    }

    /// The relative error of the critical step that the method says it does not exceed: half the widest enclosure of l
    /// for the engines, nothing for bounds and iterations.
    pub fn claim(self) -> Option<f64> {
        let engine = match self {
            Self::ClosedForm | Self::ClosedFormUnproven | Self::Secular | Self::Sturm | Self::Dense => true,
            #[cfg(feature = "lapack")]
            Self::Lapack => true,
            _ => false,
        };
        engine.then_some(0.5 * WIDEST_ENCLOSURE)
    }

    /// Products with K or eliminations of the pencil that a call takes, where they are counted.
    pub fn evaluations(self, problem: &Eigenproblem) -> Option<u64> {
        match self {
            Self::Sturm => Some(Sturm::new(problem.pencil.chain()?).eliminations(&problem.penalty)),
            Self::Power(steps) => Some(steps as u64 + 1),
            Self::Lanczos(steps) => Some(steps.min(problem.pencil.size()) as u64),
            Self::ElementBound | Self::Gershgorin => Some(1),
            _ => None,
        }
    }

    /// The call for `problem`. What a call works on (the scene or the assembled matrices, in the form that the routine
    /// wants them) is ready; everything that depends on the penalties is done anew.
    ///
    /// # Errors
    /// Says why the method cannot treat the problem.
    pub fn call(self, problem: &Eigenproblem) -> Result<Call<'_>, String> {
        let Eigenproblem { pencil, penalty, .. } = problem;
        let chain = pencil.chain().ok_or("the matrices are no row of bars")?;
        let uniform = || problem.model.as_ref().ok_or("the elements of the bar differ");
        Ok(match self {
            Self::ClosedForm => {
                let model = uniform()?;
                Box::new(move || proven(&model.closed_form(), problem))
            }
            Self::ClosedFormUnproven => {
                let model = uniform()?;
                Box::new(move || Ok(model.closed_form().unproven(penalty)))
            }
            Self::Secular => Box::new(move || proven(&Secular::new(chain), problem)),
            Self::Sturm => Box::new(move || proven(&Sturm::new(chain), problem)),
            Self::Dense => {
                let dense = Dense::new(pencil).map_err(|refusal| refusal.to_string())?;
                Box::new(move || proven(&dense, problem))
            }
            Self::ElementBound => Box::new(move || finite(element_bound(chain, penalty))),
            Self::Gershgorin => {
                let (k, m) = summed(chain, penalty);
                Box::new(move || finite(gershgorin(&k, &m)))
            }
            Self::Power(steps) => {
                let (k, m) = summed(chain, penalty);
                Box::new(move || finite(power(&k, &m, steps)))
            }
            Self::Lanczos(steps) => {
                let (k, m) = summed(chain, penalty);
                Box::new(move || finite(lanczos(&k, &m, steps)))
            }
            #[cfg(feature = "lapack")]
            Self::Lapack | Self::Dsygvx | Self::Dsbgvx => self.lapack_call(problem, chain),
        })
    }

    #[cfg(feature = "lapack")]
    fn lapack_call<'a>(self, problem: &'a Eigenproblem, chain: ChainPencil<'a>) -> Call<'a> {
        use bipenalty::spectrum::lapack::{BandMatrix, Lapack, dsbgvx_largest, dsygvx_largest, full};
        let no_convergence = || "no convergence".to_owned();
        let (k, m) = summed(chain, &problem.penalty);
        match self {
            Self::Lapack => Box::new(move || proven(&Lapack::new(chain), problem)),
            Self::Dsygvx => {
                let (k, m) = (full(&k), full(&m));
                Box::new(move || dsygvx_largest(k.clone(), m.clone()).ok_or_else(no_convergence))
            }
            _ => {
                let (k, m) = (BandMatrix::tridiagonal(&k), BandMatrix::tridiagonal(&m));
                Box::new(move || dsbgvx_largest(k.clone(), m.clone()).ok_or_else(no_convergence))
            }
        }
    }
}

fn proven(engine: &dyn Engine, problem: &Eigenproblem) -> Result<f64, String> {
    let enclosed = engine.enclose(&problem.penalty, None);
    enclosed.map(|l| l.value).map_err(|error: Uncertified| error.to_string())
}

fn finite(l: f64) -> Result<f64, String> {
    if l.is_finite() { Ok(l) } else { Err("no bound".to_owned()) }
}
