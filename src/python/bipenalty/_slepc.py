"""A mesh on many processes: eigenvectors by SLEPc, proofs by each process alone.

Every process holds one `Part`. Vectors are PETSc's, each process owning the unknowns that no process before it holds;
what it holds besides are ghosts. All matrices are scaled to D^-1/2 A D^-1/2 with D = diag(M): a lumped M is the unit
matrix then; with another one SLEPc solves by conjugate gradients.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._bipenalty import Part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]


def _find_petsc() -> None:
    """Debian keeps the bindings beside each build of PETSc; its packages name one of them, and may name none."""
    try:
        import slepc4py  # noqa: F401
    except ModuleNotFoundError:
        for kind in ("petsc", "slepc"):
            found = sorted(Path(f"/usr/lib/{kind}dir").glob("*/*-real/lib/python3/dist-packages"))
            sys.path.extend(map(str, found[-1:]))


_find_petsc()
from mpi4py import MPI  # noqa: E402
from petsc4py import PETSc  # noqa: E402
from slepc4py import SLEPc  # noqa: E402


@dataclass(frozen=True)
class Numbering:
    """The unknowns of this process in the numbers of PETSc, where those that a process owns follow each other."""

    number: Numbers
    """[n] the new number of each unknown of the part."""
    owned: Numbers
    """The places in the part of the unknowns that this process owns, in the order of their numbers."""
    total: int
    """Unknowns of all parts."""

    @classmethod
    def of(cls, comm: MPI.Intracomm, unknowns: Numbers) -> Numbering:
        """Agree with the other processes on who owns what: the first that holds it.

        Process i is asked about the unknowns that are i modulo the number of processes: nobody needs to know all.
        """
        owner = _at_home(comm, unknowns, np.full(len(unknowns), comm.rank, dtype=np.int64), np.minimum)
        owned = np.flatnonzero(owner == comm.rank)
        first = comm.exscan(len(owned)) or 0
        number = np.full(len(unknowns), -1, dtype=np.int64)
        number[owned] = first + np.arange(len(owned))
        return cls(_at_home(comm, unknowns, number, np.maximum), owned, comm.allreduce(len(owned)))


def _at_home(comm: MPI.Intracomm, keys: Numbers, values: Numbers, better: np.ufunc) -> Numbers:
    """For each key the best of the values that the processes have for it."""
    home = keys % comm.size
    order = np.argsort(home, kind="stable")
    counts = np.bincount(home, minlength=comm.size)
    came = np.empty(comm.size, dtype=np.int64)
    comm.Alltoall(counts.astype(np.int64), came)

    def there(sent: Numbers) -> Numbers:
        got = np.empty(came.sum(), dtype=np.int64)
        comm.Alltoallv([sent, (counts, _starts(counts)), MPI.INT64_T], [got, (came, _starts(came)), MPI.INT64_T])
        return got

    known, place = np.unique(there(keys[order]), return_inverse=True)
    given = there(values[order])
    best = np.empty(len(known), dtype=np.int64)
    best[place] = given
    better.at(best, place, given)
    back = np.empty(len(keys), dtype=np.int64)
    comm.Alltoallv([best[place], (came, _starts(came)), MPI.INT64_T], [back, (counts, _starts(counts)), MPI.INT64_T])
    answer = np.empty_like(back)
    answer[order] = back
    return answer


def _starts(counts: Numbers) -> Numbers:
    return np.concatenate(([0], np.cumsum(counts)[:-1]))


class _Sum:
    """y = (a K + t P) x of scaled vectors, K and B assembled, P = B'B; `close` projects onto Bx = 0 on both sides."""

    def __init__(self, k: PETSc.Mat, b: PETSc.Mat | None) -> None:
        self.k, self.b, self.a, self.t = k, b, 1.0, 0.0
        self.close: _Closed | None = None
        self._gap = b.createVecLeft() if b is not None else None
        self._spread = k.createVecLeft()

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Y = A x."""
        if self.close is not None:
            x = x.copy()
            self.close.project(x)
        if self.a != 0.0:
            self.k.mult(x, y)
            if self.a != 1.0:
                y.scale(self.a)
        else:
            y.set(0.0)
        if self.t != 0.0 and self.b is not None:
            self.b.mult(x, self._gap)
            self.b.multTranspose(self._gap, self._spread)
            y.axpy(self.t, self._spread)
        if self.close is not None:
            self.close.project(y)


class _Closed:
    """The projector onto the vectors with closed gaps, Bx = 0: conjugate gradients of the size of the contacts."""

    def __init__(self, b: PETSc.Mat) -> None:
        self.b = b
        gram = b.matMult(b.transpose(PETSc.Mat()))
        self.solver = PETSc.KSP().create(b.comm)
        self.solver.setOperators(gram)
        self.solver.setType("cg")
        self.solver.getPC().setType("jacobi")
        # Down to rounding; contacts that depend on each other make it singular, and consistent all the same.
        self.solver.setTolerances(rtol=4 * np.finfo(float).eps, max_it=500)
        self.gap, self.force = b.createVecLeft(), b.createVecLeft()
        self.spread = b.createVecRight()

    def project(self, x: PETSc.Vec) -> None:
        """X -= B'(BB')^-1 B x, twice: the second time takes what rounding left of the first."""
        for _ in range(2):
            self.b.mult(x, self.gap)
            if self.gap.norm() == 0.0:
                return
            self.solver.solve(self.gap, self.force)
            self.b.multTranspose(self.force, self.spread)
            x.axpy(-1.0, self.spread)


class _ClosedMass:
    """M among the vectors with closed gaps, Q M Q, and the unit matrix among the others, where A is 0."""

    def __init__(self, mass: PETSc.Mat, close: _Closed) -> None:
        self.whole, self.close = mass, close

    def mult(self, _: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y = M x."""
        closed = x.copy()
        self.close.project(closed)
        self.whole.mult(closed, y)
        self.close.project(y)
        y.axpy(1.0, x)
        y.axpy(-1.0, closed)


MOST_RESTARTS = 400
"""Restarts of SLEPc's basis of 16 vectors, eight new ones each: some thousand products."""


@dataclass(frozen=True)
class Verdict:
    """What `Part.prove` says."""

    kind: int
    needed: float


class Pencil:
    """K, M and P on all processes of a communicator, answering the questions of a `Session`."""

    def __init__(self, comm: MPI.Intracomm, part: Part) -> None:
        self.comm, self.part = comm, part
        self.numbering = Numbering.of(comm, part.unknowns())
        self.total = self.numbering.total
        self.solves = self.products = 0
        local, own = len(self.numbering.number), len(self.numbering.owned)
        self._vector = PETSc.Vec().createMPI((own, self.total), comm=comm)
        self._ghosted = PETSc.Vec().createSeq(local)
        numbers = PETSc.IS().createGeneral(self.numbering.number.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(self._vector, numbers, self._ghosted, None)
        self._map = PETSc.LGMap().create(self.numbering.number.astype(PETSc.IntType), comm=comm)
        self.root = self._global(part.diagonal())
        self.root.sqrtabs()
        self._scale = self.root.copy()
        self._scale.reciprocal()
        mass = part.mass()
        self.mass = None if mass is None else self._assembled(mass)
        self._sum = _Sum(self._assembled(part.stiffness()), self._gaps())
        self._shape = ((own, self.total), (own, self.total))
        self._operator = self._shell(self._sum)
        self._random = np.random.default_rng(comm.rank)

    def _shell(self, context: object) -> PETSc.Mat:
        matrix = PETSc.Mat().createPython(self._shape, context, comm=self.comm)
        matrix.setUp()
        return matrix

    def _global(self, values: Floats) -> PETSc.Vec:
        """Sum over the parts, one number for each unknown."""
        found = self._vector.duplicate()
        found.set(0.0)
        self._ghosted.setArray(values)
        self._scatter.scatter(self._ghosted, found, addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        return found

    def _local(self, vector: PETSc.Vec) -> Floats:
        """Give the numbers of a vector at the unknowns of this part: the same bits wherever one is held."""
        self._scatter.scatter(vector, self._ghosted, addv=PETSc.InsertMode.INSERT, mode=PETSc.ScatterMode.FORWARD)
        return np.array(self._ghosted.getArray())

    def _assembled(self, rows: tuple[Numbers, Numbers, Floats]) -> PETSc.Mat:
        """Sum the matrices of the parts up, by rows, and scale them."""
        local, own = len(self.numbering.number), len(self.numbering.owned)
        starts, columns = (array.astype(PETSc.IntType) for array in rows[:2])
        block = PETSc.Mat().createAIJ((local, local), csr=(starts, columns, rows[2]), comm=PETSc.COMM_SELF)
        matrix = PETSc.Mat().createIS(((own, self.total), (own, self.total)), self._map, self._map, comm=self.comm)
        matrix.setISLocalMat(block)
        matrix.assemble()
        whole = matrix.convert("aij", PETSc.Mat())
        matrix.destroy()
        block.destroy()
        whole.diagonalScale(self._scale, self._scale)
        return whole

    def _gaps(self) -> PETSc.Mat | None:
        """B = W^1/2 Z'D^-1/2, a row for each contact of the part that holds it."""
        starts, columns, entries = self.part.gaps()
        scales = self.part.scales()
        count, own = len(scales), len(self.numbering.owned)
        total = self.comm.allreduce(count)
        if total == 0:
            return None
        row = np.repeat(np.arange(count), np.diff(starts))
        entries, columns = entries * np.sqrt(scales)[row], self.numbering.number[columns]
        order = np.lexsort((columns, row))
        csr = (starts.astype(PETSc.IntType), columns[order].astype(PETSc.IntType), entries[order])
        matrix = PETSc.Mat().createAIJ(((count, total), (own, self.total)), csr=csr, comm=self.comm)
        matrix.diagonalScale(R=self._scale)
        return matrix

    def sum(self, values: Floats) -> None:
        """Add up over all processes, in place; in one of them, since sums in all may differ in the last bit."""
        total = np.empty_like(values)
        self.comm.Reduce(values, total)
        values[:] = total
        self.comm.Bcast(values)

    def seek(
        self, a: float, t: float, start: list[float] | None, tolerance: float, closed: bool
    ) -> tuple[float, float, Any]:
        """Find the top vector of (a K + t P, M) and add it to the span: its value, residual and forms."""
        self.solves += 1
        self._choose(a, t, closed)
        mass = self.mass
        if mass is not None and self._sum.close is not None:
            mass = self._shell(_ClosedMass(mass, self._sum.close))
        solver = SLEPc.EPS().create(self.comm)
        solver.setOperators(self._operator, mass)
        solver.setProblemType(SLEPc.EPS.ProblemType.HEP if self.mass is None else SLEPc.EPS.ProblemType.GHEP)
        solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
        solver.setDimensions(1)
        solver.setTolerances(max(tolerance, 1e-13), MOST_RESTARTS)
        if mass is not None:
            solver.getST().setKSP(self._mass_solver(mass, 1e-2 * tolerance))
        first = self._noise()
        if start is not None:
            first.scale(1e-3)
            first.axpy(1.0, self._ritz(start))
        if self._sum.close is not None:
            self._sum.close.project(first)
        solver.setInitialSpace(first)
        solver.solve()
        x = self._vector.duplicate()
        if solver.getConverged() > 0:
            value, residual = solver.getEigenpair(0, x).real, solver.getErrorEstimate(0)
        else:
            # The best that the search ended with: it is judged by its own forms.
            best = solver.getBV().getColumn(0)
            best.copy(x)
            solver.getBV().restoreColumn(0, best)
            value, residual = self._rayleigh(x), 1.0
        if self._sum.close is not None:
            self._sum.close.project(x)
        self._choose(1.0, 0.0, False)
        solver.destroy()
        x.pointwiseMult(x, self._scale)
        row = self.part.add(self._local(x), self.total, self.sum)
        return value, residual * abs(value), row

    def _choose(self, a: float, t: float, closed: bool) -> None:
        self._sum.a, self._sum.t, self._sum.close = a, t, None
        if closed and self._sum.b is not None:
            self._sum.close = _Closed(self._sum.b)

    def _noise(self) -> PETSc.Vec:
        """M-sized noise of x'Mx = 1 or so: as many units of each unknown as its mass makes a unit of energy."""
        noise = self._vector.duplicate()
        noise.setArray(self._random.uniform(-1.0, 1.0, len(self.numbering.owned)))
        noise.normalize()
        return noise

    def _ritz(self, y: list[float]) -> PETSc.Vec:
        """V y, scaled."""
        vector = self._vector.duplicate()
        vector.setArray(self.part.combine(y)[self.numbering.owned])
        vector.pointwiseMult(vector, self.root)
        return vector

    def _rayleigh(self, x: PETSc.Vec) -> float:
        image = x.duplicate()
        self._operator.mult(x, image)
        return float(image.dot(x)) / self._square(x)

    def _square(self, x: PETSc.Vec) -> float:
        if self.mass is None:
            return float(x.dot(x))
        image = x.duplicate()
        self.mass.mult(x, image)
        return float(image.dot(x))

    def _mass_solver(self, mass: PETSc.Mat, tolerance: float) -> PETSc.KSP:
        """Conjugate gradients for M, well conditioned as it is scaled; SLEPc keeps those that it is given."""
        solver = PETSc.KSP().create(self.comm)
        solver.setOperators(mass)
        solver.setType("cg")
        solver.getPC().setType("none")
        solver.setTolerances(rtol=max(tolerance, 1e-14), max_it=1000)
        return solver

    def residual(self, t: float, y: list[float]) -> float:
        """Return |A x - theta M x| in the norm of M^-1 over theta, for x = V y and A = K + t P."""
        x = self._ritz(y)
        self._choose(1.0, t, False)
        image, mass = x.duplicate(), x.copy()
        self._operator.mult(x, image)
        self._choose(1.0, 0.0, False)
        if self.mass is not None:
            self.mass.mult(x, mass)
        theta = x.dot(image) / x.dot(mass)
        image.axpy(-theta, mass)
        solved = image.copy()
        if self.mass is not None:
            self._mass_solver(self.mass, 1e-8).solve(image, solved)
        return float(np.sqrt(max(image.dot(solved), 0.0)) / abs(theta))

    def prove(self, u: float, a: float, t: float, margin: float) -> Verdict:
        """Whether u M - a K - t P is semidefinite on every part; each proves its own, and only the verdicts travel."""
        kinds = self.comm.allgather(self.part.prove(u, a, t, margin))
        kind = max(kind for kind, _ in kinds)
        return Verdict(kind, max(needed for _, needed in kinds) if kind == 1 else 0.0)
