//! How slowly bars can swing on closed contacts.

use std::f64::consts::TAU;

use crate::pencil::Penalty;
use crate::stability::Model;

/// An upper bound of the period of every motion of `model` that is not rigid, s, with the contacts held closed:
///
/// ```text
/// T <= 2 pi sqrt(m f)      m = sum rho A L, kg      f = sum L/(E A) + sum_j 1/s_j + a (sum_j sqrt(mu_j))^2, m/N
/// ```
/// with a = m_j/s_j and mu_j = z_j'M^-1 z_j. *Why:* 1/l_min is the largest u'M u/(u'K u + g'C g), g = Z'u, over motions from
/// which the rigid ones are taken out, which only makes u'M u smaller. So u may be taken to vanish at a support or at one
/// node; from there it grows by the elongations of the elements and the gaps that lie between, and by Cauchy and Schwarz
/// max|u|^2 <= f (u'K u + g'C g), while u'M u <= m max|u|^2. The predictor-corrector and the Park scheme see the contact
/// through C^-1 = S^-1 + a Z'M^-1 Z, whose entries are at most a sqrt(mu_i mu_j) beside S^-1; central differences through S
/// and M_p = a K_p, which adds a to 1/l_min, and a <= a m mu_j. Contacts with s_j = 0 are not there. A uniform bar held at
/// one end has 4 L/c, the bound is 2 pi L/c. The bound is for small steps; steps of some percent of a swing follow it.
pub(super) fn slowest_period(model: &Model, penalty: &Penalty) -> f64 {
    let bars = model.scene().bars();
    let mass: f64 = bars.iter().map(|bar| bar.density * bar.area * bar.length).sum();
    let elastic: f64 = bars.iter().map(|bar| bar.length / (bar.youngs_modulus * bar.area)).sum();
    let pencil = model.pencil();
    let gaps = pencil.gaps().iter().map(|gap| penalty.of(gap.scale).0).filter(|stiffness| *stiffness > 0.0);
    let (springs, closed) = gaps.fold((0.0, 0.0), |(sum, count), s| (sum + 1.0 / s, count + 1.0));
    // M >= diag(M)/2 for bars (an element's mass, diagonal 2 + gamma, off it 1 - gamma), so mu_j <= 2 z'diag(M)^-1 z.
    let compliance = pencil.gaps().iter().map(|gap| {
        let terms = gap.column.0.iter().map(|(i, z)| z * z / pencil.mass().diagonal(*i as usize));
        2.0 * terms.sum::<f64>()
    });
    let roots: f64 = if closed > 0.0 { compliance.map(f64::sqrt).sum() } else { 0.0 };
    let own = if penalty.rate.is_finite() { roots * roots / penalty.rate } else { 0.0 };
    TAU * (mass * (elastic + springs + own)).sqrt()
}
