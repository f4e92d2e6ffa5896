"""A map of a mesh that lies on many processes.

``mpirun -n N python -m bipenalty.distributed SCENE --beta-s SPEC --ratio SPEC`` prints or writes the records of
``stability-map``. SCENE is the file of a scene of ``[[body]]``, which the first process cuts into N parts, or a folder
that ``--split N`` has written, or another code: see `bipenalty._parts`. Needs mpi4py, petsc4py and slepc4py.
"""

from __future__ import annotations

import argparse
import csv
import io
import math
import os
import sys
import time
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

# One thread a process: there is a process for each core.
os.environ.setdefault("RAYON_NUM_THREADS", "1")

from . import _parts
from ._bipenalty import Part, Session, axis
from ._model import _gamma
from ._results import _COLUMNS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mpi4py import MPI

ENGINE = "convex-parts"
"""The engine in records."""

_EPS = sys.float_info.epsilon


class Refused(Exception):
    """An input that no process goes on with."""


class _Parser(argparse.ArgumentParser):
    """Raises what argparse would print and end with, so that every process hears of it."""

    def error(self, message: str) -> NoReturn:
        raise Refused(message)


def parser() -> argparse.ArgumentParser:
    """Options of the command line."""
    options = _Parser(prog="python -m bipenalty.distributed", description=__doc__.split("\n\n")[0])
    options.add_argument("scene", metavar="SCENE", help="a scene of [[body]], or a folder of parts")
    options.add_argument("--mass", default="lumped", help="lumped, averaged, consistent or gamma in [0, 1]")
    options.add_argument("--beta-s", metavar="SPEC", help="0,0.5,10, lin:0:10:401 or log:1e-3:1e12:301")
    options.add_argument("--ratio", metavar="SPEC", help="the same; inf is the pure penalty method")
    options.add_argument("--tolerance", type=float, default=1e-3, metavar="E", help="relative width of a step")
    options.add_argument("--patch", type=int, metavar="N", help="elements along an edge of a patch of the proof")
    options.add_argument(
        "--memory", type=float, default=2.0, metavar="GB", help="of a patch's factor, for each process"
    )
    options.add_argument("--stdout", choices=["csv"], help="print the records instead of writing them")
    options.add_argument("--out", type=Path, default=Path("figures/distributed"), metavar="DIR", help="where files go")
    options.add_argument("--split", type=int, metavar="N", help="write N parts to --out, and compute nothing")
    options.add_argument("--quiet", action="store_true", help="no summary")
    return options


def checked(options: argparse.Namespace) -> argparse.Namespace:
    """Read the specifications; refuse what means nothing."""
    try:
        return _checked(options)
    except ValueError as error:
        raise Refused(str(error)) from error


def _checked(options: argparse.Namespace) -> argparse.Namespace:
    options.gamma = _gamma(options.mass)
    if not 1e-13 <= options.tolerance <= 1.0:
        raise Refused(f"--tolerance: {options.tolerance} is not allowed; allowed: a number from 1e-13 to 1")
    for name, least in (("patch", 1), ("split", 1)):
        value = getattr(options, name)
        if value is not None and value < least:
            raise Refused(f"--{name}: {value} is not allowed; allowed: at least {least}")
    if options.split is not None:
        return options
    for name, allowed in (("beta_s", "at least 0, finite"), ("ratio", "above 0")):
        option, text = f"--{name.replace('_', '-')}", getattr(options, name)
        if text is None:
            raise Refused(f"{option}: nothing is not allowed; allowed: a list, lin:0:10:401 or log:1e-3:1e12:301")
        values = axis(text)
        wrong = [v for v in values if not (0.0 <= v < math.inf if name == "beta_s" else v > 0.0)]
        if wrong:
            raise Refused(f"{option}: {wrong[0]} is not allowed; allowed: {allowed}")
        setattr(options, name, values)
    return options


def enclose(
    comm: MPI.Intracomm,
    part: Part,
    points: Sequence[tuple[float, float]],
    tolerance: float = 1e-3,
    reference: float | None = None,
    told: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Enclose l_max at points (beta_s, r) of the mesh whose parts the processes of `comm` hold.

    Every process calls it; all get the same answer: ``mesh`` (l_max without contact, from below: the reference of r
    unless one is given), ``slope`` (mu), ``points`` (pairs of bounds of l, rad^2/s^2), ``effort``.
    """
    from ._slepc import Pencil

    begin = time.perf_counter()
    pencil = Pencil(comm, part)
    told(f"{pencil.total} unknowns on {comm.size} processes, {time.perf_counter() - begin:.1f} s")
    sizes, scales = comm.gather(part.sizes()) or [], comm.gather(part.scales()) or []
    session = None
    if comm.rank == 0:
        gathered = [scale for of_part in scales for scale in of_part.tolist()]
        session = Session(pencil.total, gathered, sizes, list(points), reference, tolerance)
    spent = {"seek": 0.0, "residual": 0.0, "prove": 0.0}
    while True:
        # One process decides, and says what: nobody can be led astray by a last bit.
        question = comm.bcast(session.question() if session else None)
        if question is None:
            break
        kind, *asked = question
        begin = time.perf_counter()
        answer = getattr(pencil, kind)(*asked)
        spent[kind] += time.perf_counter() - begin
        if kind == "seek":
            value, residual, row = answer
            forms = comm.gather(row)
            told(f"a K + t P, a = {asked[0]:g}, t = {asked[1]:.6e}: {value:.10e}, {time.perf_counter() - begin:.2f} s")
            if session:
                session.found(value, residual, _together(forms or []))
        elif session:
            session.residual(answer) if kind == "residual" else session.verdict(answer.kind, answer.needed)
    told(", ".join(f"{kind} {seconds:.1f} s" for kind, seconds in spent.items()))
    return _everywhere(comm, session)


def _together(forms: list[Any]) -> Any:
    """Join the gaps of all parts; the sums in them are those of all parts already."""
    if forms[0] is None:
        return None
    stiffness, mass, _, _, square = forms[0]
    gaps, sizes = ([value for form in forms for value in form[at].tolist()] for at in (2, 3))
    return stiffness.tolist(), mass.tolist(), gaps, sizes, square


def _everywhere(comm: MPI.Intracomm, session: Session | None) -> dict[str, Any]:
    """Give every process what the session found, or raise what it raised."""
    found: Any = None
    if session:
        try:
            mesh, slope, points, effort = session.finish()
            found = {"mesh": mesh, "slope": slope, "points": points, "effort": effort}
        except ValueError as error:
            found = Refused(str(error))
    found = comm.bcast(found)
    if isinstance(found, Refused):
        raise found
    return dict(found)


def rows(facts: _parts.Facts, options: argparse.Namespace, found: dict[str, Any]) -> tuple[list[list[Any]], bool]:
    """List the records of the map, and whether every point is as narrow as asked."""
    reference, points = found["mesh"], iter(found["points"])
    head = [facts.name, facts.mass, facts.gamma, facts.elements, "spectrum"]
    table, narrow = [], True
    for ratio in options.ratio:
        for beta_s in options.beta_s:
            lower, upper = next(points)
            if not lower > 0.0:
                narrow = False
                table.append([*head, beta_s, ratio, *[None] * 4, f"{ENGINE}, not certified", *[None] * 3, ""])
                continue
            omega = math.sqrt(lower)
            # A root and a quotient each.
            step = [2.0 / omega, 2.0 / math.sqrt(upper) * (1.0 - 4.0 * _EPS), 2.0 / omega * (1.0 + 4.0 * _EPS)]
            # In units of the reference, omega_ref dt/2, with a product more.
            c, low, high = (0.5 * math.sqrt(reference) * s for s in step)
            bounds = [low * (1.0 - 2.0 * _EPS), high * (1.0 + 2.0 * _EPS)]
            if math.sqrt(upper / lower) - 1.0 <= options.tolerance:
                table.append([*head, beta_s, ratio, omega, c, *bounds, ENGINE, *step, "proven"])
            else:
                narrow = False
                table.append(
                    [*head, beta_s, ratio, omega, None, *bounds, f"{ENGINE}, not certified", None, *step[1:], ""]
                )
    return table, narrow


def _part(comm: MPI.Intracomm, options: argparse.Namespace) -> tuple[_parts.Facts, Part]:
    """Get the part of this process; what one process refuses, all do."""
    folder, lists, facts, wrong = Path(options.scene), None, None, None
    if comm.rank == 0:
        try:
            if folder.is_dir():
                facts = _parts.facts_of(folder)
                if facts.parts != comm.size:
                    wrong = f"{folder}: {facts.parts} parts for {comm.size} processes is not allowed; allowed: as many"
            else:
                facts, lists = _parts.cut(options, comm.size)
        except (ValueError, OSError) as error:
            wrong = str(error)
    facts, wrong = comm.bcast((facts, wrong))
    if wrong:
        raise Refused(wrong)
    part = None
    try:
        own = _parts.read(folder, comm.rank) if folder.is_dir() else _scattered(comm, lists)
        part = Part(own, int(options.memory * 1e9))
    except ValueError as error:
        wrong = f"process {comm.rank}: {error}"
    wrong = next(filter(None, comm.allgather(wrong)), None)
    if wrong or part is None:
        raise Refused(wrong)
    return facts, part


def _scattered(comm: MPI.Intracomm, lists: list[_parts.Lists] | None) -> _parts.Lists:
    """One part to each process, one after the other, so that the first needs to pack one at a time."""
    if lists is None:
        return dict(comm.recv(source=0))
    for rank in range(1, comm.size):
        comm.send(lists[rank], dest=rank)
        lists[rank] = {}
    return lists[0]


def _write(options: argparse.Namespace, table: list[list[Any]]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    writer.writerows([[repr(v) if isinstance(v, float) else v for v in row] for row in table])
    if options.stdout:
        sys.stdout.write(text.getvalue())
        sys.stdout.flush()
        return
    options.out.mkdir(parents=True, exist_ok=True)
    unfinished = options.out / ".stability-map.csv.part"
    unfinished.write_text(text.getvalue(), encoding="utf-8")
    unfinished.replace(options.out / "stability-map.csv")


def run(comm: MPI.Intracomm, arguments: Sequence[str]) -> int:
    """Do what the command line says; the exit status."""

    def told(line: str) -> None:
        if comm.rank == 0 and not options.quiet:
            print(line, file=sys.stderr, flush=True)

    options = checked(parser().parse_args(arguments))
    if options.split is not None:
        wrong = None
        if comm.rank == 0:
            try:
                facts, lists = _parts.cut(options, options.split)
                _parts.write(options.out, facts, lists)
                told(f"{facts.parts} parts of {facts.elements} elements: {options.out}")
            except (ValueError, OSError) as error:
                wrong = str(error)
        if wrong := comm.bcast(wrong):
            raise Refused(wrong)
        return 0
    facts, part = _part(comm, options)
    patches = comm.gather(part.patches())
    if patches:
        total, distinct, largest = zip(*patches, strict=True)
        told(f"{sum(total)} patches, {sum(distinct)} to prove, of at most {max(largest)} unknowns")
    points = [(beta_s, ratio) for ratio in options.ratio for beta_s in options.beta_s]
    found = enclose(comm, part, points, options.tolerance, told=told)
    status = 0
    if comm.rank == 0:
        table, narrow = rows(facts, options, found)
        _write(options, table)
        status = 0 if narrow else 1
        solves, proofs = found["effort"]
        told(
            f"{len(table)} points, {solves} eigenproblems, {proofs} proofs"
            + ("" if narrow else ", NOT all as narrow as asked")
        )
    return int(comm.bcast(status))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run on all processes: what one cannot go on with ends them all, with a message."""
    try:
        from mpi4py import MPI

        from . import _slepc  # noqa: F401
    except (ImportError, ValueError) as error:
        # A binding that was built for another numpy says so by a ValueError.
        print(
            f"{error}; needed: mpi4py, petsc4py and slepc4py, as in python3-mpi4py and python3-slepc4py",
            file=sys.stderr,
        )
        return 2
    comm = MPI.COMM_WORLD
    try:
        return run(comm, sys.argv[1:] if arguments is None else arguments)
    except Refused as error:
        # Every process has come here with it.
        if comm.rank == 0:
            print(error, file=sys.stderr, flush=True)
        return 2
    except BaseException as error:
        if isinstance(error, SystemExit) and not error.code:
            raise
        _abort(comm, error, 1)


def _abort(comm: MPI.Intracomm, error: BaseException, status: int) -> NoReturn:
    """End the other processes too: they wait for this one, and would for ever."""
    traceback.print_exception(error)
    print(f"process {comm.rank} of {comm.size} ended: {error!r}", file=sys.stderr, flush=True)
    comm.Abort(status)
    raise SystemExit(status)


if __name__ == "__main__":
    sys.exit(main())
