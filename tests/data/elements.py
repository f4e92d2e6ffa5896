"""Element matrices of distorted elements by scikit-fem 12, an assembler that knows nothing of ours: elements.json.

Each element is its reference element moved by a polynomial of its own shape functions, so that every isoparametric map
reproduces it. The quadrature points are given, since integrands on distorted elements are rational. The lower triangles
are written, degree of freedom `node * dimension + direction`, nodes in VTK's order. E = 2.5, nu = 0.3, rho = 1.7.

    pip install scikit-fem==12.0.2 && python tests/data/elements.py
"""
import itertools
import json
import pathlib

import numpy as np
import skfem as fem
from skfem.models.elasticity import linear_elasticity

E, NU, RHO, THICKNESS = 2.5, 0.3, 1.7, 0.6
MU, LAMBDA = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))


def product(points, dimension):
    x, w = np.polynomial.legendre.leggauss(points)
    grid = list(itertools.product(range(points), repeat=dimension))
    return (np.array([[(x[i] + 1) / 2 for i in g] for g in grid]).T, np.array([np.prod(w[list(g)] / 2) for g in grid]))


def simplex(dimension, orbits):
    """Symmetric rules: each orbit is barycentric coordinates and the weight of a point, weights summing to 1."""
    points, weights = [], []
    for barycentric, weight in orbits:
        for p in sorted(set(itertools.permutations(barycentric))):
            points.append(p[1:])
            weights.append(weight / (2 if dimension == 2 else 6))
    return np.array(points).T, np.array(weights)


def orbit(dimension, a, weight):
    return (1 - dimension * a, *[a] * dimension), weight


TRI2 = simplex(2, [orbit(2, 1 / 6, 1 / 3)])
TRI4 = simplex(2, [orbit(2, 0.44594849091596488632, 0.22338158967801146570), orbit(2, 0.09157621350977074346, 0.10995174365532186764)])
TET2 = simplex(3, [orbit(3, (5 - 5**0.5) / 20, 1 / 4)])
c = 0.045503704125649649492
TET5 = simplex(3, [orbit(3, 0.31088591926330060980, 0.11268792571801585080), orbit(3, 0.092735250310891226402, 0.073493043116361949544),
                   ((c, c, 0.5 - c, 0.5 - c), 0.042546020777081466438)])

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
CUBE = [(x, y, z) for z in (0, 1) for x, y in SQUARE]
RING = [(0, 1), (1, 2), (2, 3), (3, 0)]
EDGES = RING + [(a + 4, b + 4) for a, b in RING] + [(a, a + 4) for a in range(4)]
TRI, TET = [(0, 0), (1, 0), (0, 1)], [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


def middles(corners, edges):
    return corners + [tuple((np.array(corners[a]) + np.array(corners[b])) / 2) for a, b in edges]


TRI_EDGES, TET_EDGES = [(0, 1), (1, 2), (2, 0)], [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
CASES = {
    "tri3": (fem.MeshTri1, fem.ElementTriP1, TRI2, TRI),
    "tri6": (fem.MeshTri2, fem.ElementTriP2, TRI4, middles(TRI, TRI_EDGES)),
    "quad4": (fem.MeshQuad1, fem.ElementQuad1, product(2, 2), SQUARE),
    "quad8": (fem.MeshQuad2, fem.ElementQuadS2, product(3, 2), middles(SQUARE, RING)),
    "tet4": (fem.MeshTet1, fem.ElementTetP1, TET2, TET),
    "tet10": (fem.MeshTet2, fem.ElementTetP2, TET5, middles(TET, TET_EDGES)),
    "hex8": (fem.MeshHex1, fem.ElementHex1, product(2, 3), CUBE),
    "hex20": (fem.MeshHex2, fem.ElementHexS2, product(3, 3), middles(CUBE, EDGES)),
}


def moved(x, order):
    """A map in the span of the shape functions of every element of that order."""
    x = np.asarray(x, dtype=float)
    d = len(x)
    linear = np.array([[1.3, 0.2, -0.1], [0.15, 0.9, 0.25], [-0.2, 0.1, 1.1]])[:d, :d]
    y = np.einsum("ij,j...->i...", linear, x)
    if order == 2:
        bend = np.array([[0.05, -0.08, 0.04], [0.07, 0.03, -0.06], [-0.05, 0.06, 0.08]])[:d, :d]
        y = y + np.einsum("ij,j...->i...", bend, x**2) + 0.04 * x[0] * x[1]
    else:
        y = y + 0.12 * np.array([x[0] * x[1], -x[0] * x[-1], x[1] * x[-1]])[:d]
    return y


def element(name, plane):
    mesh_type, element_type, quadrature, nodes = CASES[name]
    order, d = (2 if len(nodes) > 8 or name in ("tri6", "quad8") else 1), len(nodes[0])
    flat = {"tri": fem.MeshTri1, "qua": fem.MeshQuad1, "tet": fem.MeshTet1, "hex": fem.MeshHex1}[name[:3]].init_refdom()
    mesh = mesh_type.from_mesh(flat) if order == 2 else flat
    mesh = mesh_type(moved(mesh.doflocs, order), mesh.t)
    basis = fem.Basis(mesh, fem.ElementVector(element_type()), quadrature=quadrature)
    thickness = THICKNESS if d == 2 else 1.0
    lame = 2 * LAMBDA * MU / (LAMBDA + 2 * MU) if plane == "stress" else LAMBDA
    k = linear_elasticity(lame * thickness, MU * thickness).assemble(basis).toarray()
    m = fem.BilinearForm(lambda u, v, w: RHO * thickness * sum(u[i] * v[i] for i in range(d))).assemble(basis).toarray()
    places = moved(np.array(nodes, dtype=float).T, order).T
    where = []
    for place in places:
        for direction in range(d):
            near = [dof for local, dof in enumerate(basis.element_dofs[:, 0])
                    if local % d == direction and np.allclose(basis.doflocs[:, dof], place)]
            assert len(near) == 1, (name, place, near)
            where += near
    lower = np.tril_indices(len(where))
    nodal = np.tril_indices(len(nodes))
    k, m = k[np.ix_(where, where)], m[np.ix_(where, where)]
    assert abs(m[::d, 1::d]).max() < 1e-16
    return {"element": name, "plane": plane, "nodes": places.tolist(), "stiffness": k[lower].tolist(), "mass": m[::d, ::d][nodal].tolist()}


table = [element(name, plane) for name in CASES for plane in (("strain", "stress") if len(CASES[name][3][0]) == 2 else (None,))]
head = {"youngs_modulus": E, "poissons_ratio": NU, "density": RHO, "thickness": THICKNESS}
with open(pathlib.Path(__file__).with_name("elements.json"), "w") as file:
    rows = ",\n".join(json.dumps(row, separators=(",", ":")) for row in table)
    file.write('{"material":' + json.dumps(head) + ',\n"elements":[\n' + rows + "\n]}\n")
