"""A mesh of scikit-fem: two blocks with contact pairs, the limit of the time step and the best ratio."""

import bipenalty as bp
import numpy as np
import scipy.sparse as sp
from skfem import Basis, BilinearForm, ElementQuad1, ElementVector, MeshQuad
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity


def block(
    width: int, height: int, bottom: float, E: float, nu: float, rho: float
) -> tuple[sp.csr_matrix, np.ndarray, dict[tuple[float, float], int]]:
    """Return K and the lumped M of a block of unit cells, and its degrees of freedom in y by place."""
    mesh = MeshQuad.init_tensor(np.arange(width + 1.0), bottom + np.arange(height + 1.0))
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    K = linear_elasticity(*lame_parameters(E, nu)).assemble(basis)
    M = BilinearForm(lambda u, v, w: rho * dot(u, v)).assemble(basis)
    places = {(x, y): dof for x, y, dof in zip(*mesh.p, basis.nodal_dofs[1], strict=True)}
    return K, np.asarray(M.sum(axis=1)).ravel(), places


lower, upper = block(12, 6, 0.0, 210e9, 0.3, 7850.0), block(8, 4, 6.0, 70e9, 0.3, 2700.0)
K = sp.block_diag([lower[0], upper[0]], format="csr")
M = np.concatenate([lower[1], upper[1]])

# The top of the lower block against the bottom of the upper one, node by node: gap = u_lower - u_upper.
pairs = [(lower[2][x, 6.0], len(lower[1]) + upper[2][x, 6.0]) for x in np.arange(9.0)]
Z = sp.lil_matrix((len(M), len(pairs)))
for column, (below, above) in enumerate(pairs):
    Z[below, column], Z[above, column] = 1.0, -1.0

model = bp.Model.from_matrices(K, M, Z)
print(model)
print("without contact: ", model.critical_step(beta_s=0.0))
print("pure penalty:    ", model.critical_step(beta_s=100.0))
best = model.optimal_ratio(beta_s=100.0)
print("best ratio:      ", best)
print("with that ratio: ", model.critical_step(beta_s=100.0, ratio=best.lower))
