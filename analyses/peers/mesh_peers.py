"""Largest eigenvalues of meshes in contact: scipy's eigsh and LOBPCG, SLEPc, and stability-map, on the same matrices.

usage: mesh_peers.py STABILITY_MAP [CASE...] [--runs N] [--slepc PYTHON]

Cases: small (2,604 unknowns, a map of 100 x 100), plane (160,000 unknowns, the same map), solid (hex8, 143,856 unknowns, one point
to 1e-9), large (hex8, 1e6 unknowns, one point by patches). Two blocks of lumped elements, one on the other, the lower one held
below. The matrices of `small` and `plane` are written as Matrix Market files, and reading them is part of stability-map's
time; those of `solid` and `large` are assembled by each side, and assembly is part of stability-map's time alone. The peers
are timed on matrices in memory, at t = 1: l_max(K + P, M). Medians of N runs, here and there with all cores.
SLEPc needs a PYTHON that can import slepc4py; without one it is left out, and said so.
"""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

E, NU, RHO = 210e9, 0.3, 7850.0


def element(size):
    """K_e of a box element in the plane (strain) or in space, nodes in lattice order, and the mass of a node."""
    d = len(size)
    g = np.array([-1, 1]) / np.sqrt(3)
    corners = np.array(np.meshgrid(*[[-1, 1]] * d, indexing="ij")).reshape(d, -1, order="F").T
    lam, mu = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    k = np.zeros((len(corners) * d,) * 2)
    jac = np.prod(size) / 2**d
    for x in np.array(np.meshgrid(*[g] * d, indexing="ij")).reshape(d, -1).T:
        factors = 1 + corners * x
        grad = np.array([corners[:, i] * np.prod(np.delete(factors, i, 1), 1) / 2**d * 2 / size[i] for i in range(d)])
        for a in range(len(corners)):
            for b in range(len(corners)):
                ga, gb = grad[:, a], grad[:, b]
                block = lam * np.outer(ga, gb) + mu * np.outer(gb, ga) + mu * (ga @ gb) * np.eye(d)
                k[a * d : a * d + d, b * d : b * d + d] += block * jac
    return k, RHO * np.prod(size) / len(corners)


def box(size, cells, held):
    """K, the diagonal of M, the unknowns along y of the bottom and of the top; those below are held if `held`."""
    from scipy.sparse import coo_matrix

    d, nodes = len(cells), [c + 1 for c in cells]
    number = np.arange(np.prod(nodes)).reshape(nodes, order="F")
    ke, me = element([s / c for s, c in zip(size, cells)])
    corners = [number[tuple(slice(o, o + c) for o, c in zip(offset, cells))].ravel(order="F") for offset in
               np.array(np.meshgrid(*[[0, 1]] * d, indexing="ij")).reshape(d, -1, order="F").T]
    conn = np.array(corners).T
    dofs = (conn[:, :, None] * d + np.arange(d)).reshape(len(conn), -1)
    n = number.size * d
    m = np.bincount(dofs.ravel(), minlength=n) * me
    k, width = None, dofs.shape[1]
    for part in np.array_split(dofs, max(1, len(dofs) // 40000)):
        i, j = np.repeat(part, width, 1).ravel(), np.tile(part, (1, width)).ravel()
        piece = coo_matrix((np.tile(ke.ravel(), len(part)), (i.astype(np.int32), j.astype(np.int32))), shape=(n, n)).tocsr()
        k = piece if k is None else k + piece
    bottom, top = number[:, 0].ravel(order="F"), number[:, -1].ravel(order="F")
    free = np.ones(n, bool)
    if held:
        for i in range(d):
            free[bottom * d + i] = False
    new = np.cumsum(free) - 1
    return k[free][:, free], m[free], new[bottom * d + 1], new[top * d + 1]


def blocks(size, cells):
    """K, M, Z and w of two such blocks with matching nodes."""
    from scipy.sparse import block_diag, csr_matrix

    k1, m1, _, top = box(size, cells, True)
    k2, m2, bottom, _ = box(size, cells, False)
    n1, c = len(m1), len(top)
    z = csr_matrix((np.r_[np.ones(c), -np.ones(c)], (np.r_[top, bottom + n1], np.tile(np.arange(c), 2))),
                   shape=(n1 + len(m2), c))
    w = np.minimum(k1.diagonal()[top], k2.diagonal()[bottom])
    return block_diag([k1, k2], format="csr"), np.r_[m1, m2], z, w


def write(folder, k, m, z, w):
    """The scene of these matrices; its path."""
    from scipy.io import mmwrite
    from scipy.sparse import tril

    mmwrite(f"{folder}/K.mtx", tril(k), symmetry="symmetric", precision=17)
    text = open(f"{folder}/K.mtx").read(60)
    assert "symmetric" in text, text
    for name, value in (("M", m), ("w", w)):
        mmwrite(f"{folder}/{name}.mtx", value[:, None], precision=17)
    mmwrite(f"{folder}/Z.mtx", z)
    path = f"{folder}/scene.toml"
    with open(path, "w") as file:
        file.write('name = "matrices"\n[matrices]\nstiffness = "K.mtx"\nmass = "M.mtx"\ngaps = "Z.mtx"\nscales = "w.mtx"\n')
    return path


def scene(folder, size, cells):
    """The scene of the bodies; its path."""
    names = "xyz"[: len(cells)]
    body = lambda name, y: (
        f'[[body]]\nname = "{name}"\nbox = {size}\ncells = {cells}\norigin = {[0.0, y, 0.0][:len(cells)]}\n'
        f'element = "{"quad4" if len(cells) == 2 else "hex8"}"\nyoungs_modulus = {E}\npoissons_ratio = {NU}\ndensity = {RHO}\n'
    )
    path = f"{folder}/scene.toml"
    with open(path, "w") as file:
        file.write(
            f'name = "bodies"\ndimension = {len(cells)}\n' + ('plane = "strain"\n' if len(cells) == 2 else "")
            + body("lower", 0.0) + body("upper", size[1])
            + '[[contact]]\nsurfaces = ["upper.bottom", "lower.top"]\n[[hold]]\nsurface = "lower.bottom"\ndirections = '
            + str(list(names)).replace("'", '"') + "\n"
        )
    return path


def timed(run, runs):
    """The median of the times, and the last answer."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        answer = run()
        times.append(time.perf_counter() - start)
    return statistics.median(times), answer


def line(case, method, seconds, what):
    print(f"{case:<7} {method:<44} {seconds:>10.3f} s   {what}   (load {os.getloadavg()[0]:.1f})", flush=True)


def peers(case, k, m, z, w, runs, slepc):
    """Seconds of one solve by eigsh, and its l_max."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import eigsh, lobpcg

    root = diags(1 / np.sqrt(m))
    a = (root @ (k + z @ diags(w) @ z.T) @ root).tocsr()
    start = np.random.default_rng(1).standard_normal(len(m))
    arpack, found = timed(lambda: eigsh(a, 1, which="LA", tol=1e-10, ncv=40, v0=start, return_eigenvectors=False)[0], runs)
    line(case, "scipy eigsh (ARPACK), tol 1e-10, ncv 40", arpack, f"l = {found:.12e}")
    block = np.random.default_rng(1).standard_normal((len(m), 4))
    seconds, values = timed(lambda: lobpcg(a, block.copy(), largest=True, tol=1e-5 * found, maxiter=400)[0], 1)
    line(case, "scipy LOBPCG, block of 4, residual 1e-5", seconds, f"l = {max(values):.12e}")
    if slepc:
        with tempfile.NamedTemporaryFile(suffix=".npz") as file:
            np.savez(file, data=a.data, indices=a.indices.astype(np.int32), indptr=a.indptr.astype(np.int32))
            file.flush()
            out = subprocess.run([slepc, __file__, "--solve", file.name, str(runs)], capture_output=True, text=True)
        if out.returncode == 0:
            seconds, value = map(float, out.stdout.split())
            line(case, "SLEPc Krylov-Schur, tol 1e-10, one process", seconds, f"l = {value:.12e}")
        else:
            print(f"{case:<7} SLEPc: left out: {(out.stderr.strip().splitlines() or ['it failed'])[-1]}")
    else:
        print(f"{case:<7} SLEPc: left out: no --slepc PYTHON that can import slepc4py")
    return arpack, found


def solve_by_slepc(path, runs):
    """Prints seconds and l_max."""
    from petsc4py import PETSc
    from slepc4py import SLEPc

    a = np.load(path)
    n = len(a["indptr"]) - 1
    matrix = PETSc.Mat().createAIJ((n, n), csr=(a["indptr"], a["indices"], a["data"]))

    def solve():
        eps = SLEPc.EPS().create()
        eps.setOperators(matrix)
        eps.setProblemType(SLEPc.EPS.ProblemType.HEP)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
        eps.setDimensions(1, 40)
        eps.setTolerances(1e-10, 10000)
        eps.solve()
        return eps.getEigenvalue(0).real

    print(*timed(solve, runs))


def ours(case, program, path, arguments, runs):
    """Seconds of stability-map from the start of the process to its end, and what it printed."""
    command = [program, path, *arguments, "--stdout", "csv", "--quiet"]

    def run():
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in (0, 1):
            sys.exit(done.stderr)
        return done.stdout

    seconds, text = timed(run, runs)
    rows = [dict(zip(text.splitlines()[0].split(","), row.split(","))) for row in text.splitlines()[1:]]
    steps = [(float(row["step_lower"]), float(row["step_upper"])) for row in rows if row["step_lower"]]
    widest = max((upper / lower - 1 for lower, upper in steps), default=float("nan"))
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    what = f"{len(steps)} of {len(rows)} points enclosed, widest {widest:.1e}, at most {peak:.2f} GB in any child"
    line(case, "stability-map " + " ".join(arguments)[:29], seconds, what)
    return seconds, rows


MAP = ["--beta-s", "log:1e-3:1e9:100", "--ratio", ",".join([*(f"{r:.17g}" for r in np.geomspace(0.1, 1e3, 99)), "inf"])]
CASES = {
    "small": ([0.3, 0.2], [30, 20]),
    "plane": ([0.3, 0.2], [240, 165]),
    "solid": ([0.2, 0.1, 0.2], [35, 18, 35]),
    "large": ([0.2, 0.05, 0.2], [80, 25, 80]),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(CASES))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--slepc", metavar="PYTHON")
    options = parser.parse_args()
    for case in options.cases or CASES:
        size, cells = CASES[case]
        with tempfile.TemporaryDirectory() as folder:
            parts = blocks(size, cells)
            print(f"{case}: {len(parts[1])} unknowns, {len(parts[3])} contacts, {os.cpu_count()} cores", flush=True)
            if case in ("small", "plane"):
                path = write(folder, *parts)
                seconds, _ = ours(case, options.program, path, MAP, options.runs)
            else:
                path = scene(folder, size, cells)
                width = ["--tolerance", "1e-9"] if case == "solid" else ["--patch", "6"]
                # r = inf, beta_s = 1 is t = 1.
                point = ["--beta-s", "1", "--ratio", "inf", *width]
                seconds, rows = ours(case, options.program, path, point, options.runs if case == "solid" else 1)
            solve, found = peers(case, *parts, options.runs if case != "large" else 1, options.slepc)
            print(f"{case}: stability-map takes the time of {seconds / solve:.2f} solves by eigsh", flush=True)
            if case in ("solid", "large"):
                upper, lower = (4 / float(rows[0][key]) ** 2 for key in ("step_lower", "step_upper"))
                print(f"{case}: l_max proven within {upper / lower - 1:.1e}, its value off eigsh by {lower / found - 1:+.1e}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--solve"]:
        solve_by_slepc(sys.argv[2], int(sys.argv[3]))
    else:
        main()
