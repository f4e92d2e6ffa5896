//! Rules of thumb for the step of a mesh with lumped mass and penalty contact: none of them is a bound.

use bipenalty::stability::MeshModel;

/// What other codes take for the step.
#[derive(Debug, Clone)]
pub struct Rules {
    /// K_ii, M_ii and P_ii: N/m, kg, N/m.
    nodes: Vec<[f64; 3]>,
    /// 1/(z_j'M^-1 z_j) and w_j: kg, N/m.
    contacts: Vec<[f64; 2]>,
    reference: f64,
}

impl Rules {
    /// Of a mesh with lumped mass whose reference is omega_ref^2.
    pub fn new(model: &MeshModel, reference: f64) -> Self {
        let (stiffness, mass, gaps) = model.matrices();
        let diagonal = |i: usize| stiffness.row(i).find(|(j, _)| *j == i).map_or(0.0, |(_, k)| k);
        let lumped = |i: usize| mass.row(i).map(|(_, m)| m).sum();
        let mut nodes: Vec<[f64; 3]> = (0..stiffness.size()).map(|i| [diagonal(i), lumped(i), 0.0]).collect();
        let mut contacts = Vec::new();
        for gap in gaps {
            let mut mobility = 0.0;
            for (i, z) in &gap.column.0 {
                let node = &mut nodes[*i as usize];
                node[2] += gap.scale * z * z;
                mobility += z * z / node[1];
            }
            contacts.push([1.0 / mobility, gap.scale]);
        }
        Self { nodes, contacts, reference }
    }

    /// m/w, s^2: what the mass penalty is per scale.
    fn mass(&self, beta_s: f64, ratio: f64) -> f64 {
        beta_s / (ratio * self.reference)
    }

    /// min_i (2 M_i/K_i)^(1/2), s, with the stiffness and the mass of the contacts summed into the nodes, as nodal time steps
    /// have it; K_i the diagonal.
    pub fn nodal(&self, beta_s: f64, ratio: f64) -> f64 {
        let m = self.mass(beta_s, ratio);
        let step = |[stiffness, mass, p]: &[f64; 3]| (2.0 * (mass + m * p) / (stiffness + beta_s * p)).sqrt();
        self.nodes.iter().map(step).fold(f64::INFINITY, f64::min)
    }

    /// min(`element`, min_j 2 (mu_j/k_j)^(1/2)), s: each contact as an oscillator for itself, of the mass that its gap feels
    /// and the mass penalty.
    pub fn oscillators(&self, element: f64, beta_s: f64, ratio: f64) -> f64 {
        let m = self.mass(beta_s, ratio);
        let step = |[mass, w]: &[f64; 2]| 2.0 * ((mass + m * w) / (beta_s * w)).sqrt();
        self.contacts.iter().map(step).fold(element, f64::min)
    }
}
