"""A sweep over scenes, parameters and penalties, which goes on where it was.

``python -m bipenalty.study STUDY.toml`` runs the cases of a study on this machine; ``--mpi`` on the processes of
mpirun, ``--slurm-array I/N`` the I-th of N shares. What is done stands in a journal; the records are merged when all
cases are done.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import csv
import ctypes
import multiprocessing
import os
import signal
import sys
import time
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _cases
from ._journal import Journal, lines

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ._cases import Case


def parser() -> argparse.ArgumentParser:
    """Options of the command line."""
    options = argparse.ArgumentParser(prog="python -m bipenalty.study", description=__doc__.split("\n\n")[0])
    options.add_argument("study", type=Path, metavar="STUDY.toml")
    where = options.add_mutually_exclusive_group()
    where.add_argument("--mpi", action="store_true", help="on the processes that mpirun has started")
    where.add_argument("--slurm-array", metavar="I/N", help="share I of N, I from 0")
    where.add_argument("--workers", type=int, metavar="N", help="processes on this machine; default: one for each core")
    options.add_argument("--out", type=Path, metavar="DIR", help="default: a folder of the study's name beside it")
    options.add_argument("--retry", action="store_true", help="try cases that failed again")
    options.add_argument("--merge", action="store_true", help="compute nothing; write the records of what is done")
    options.add_argument("--quiet", action="store_true", help="no progress, no summary")
    return options


def share(text: str | None) -> tuple[int, int]:
    """I and N of ``I/N``."""
    if text is None:
        return 0, 1
    number, _, count = text.partition("/")
    if number.isdecimal() and count.isdecimal() and int(number) < int(count):
        return int(number), int(count)
    raise ValueError(f"--slurm-array: {text!r} is not allowed; allowed: I/N with I from 0 to N - 1")


_PR_SET_PDEATHSIG = 1
"""linux/prctl.h."""


def _work(case: Case) -> dict[str, Any]:
    return case.run()


def _alone() -> None:
    """In a worker: one thread, since there is one for each core; Ctrl-C is for the process that waits for it."""
    os.environ["RAYON_NUM_THREADS"] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "linux":
        # A worker whose parent was killed would wait for ever: it holds both ends of its own pipe.
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _in_processes(cases: list[Case], workers: int) -> Iterator[dict[str, Any]]:
    """Give results as they come. A worker that dies takes its pool along: its case is then found one by one."""
    context = multiprocessing.get_context("spawn")
    open_cases = {case.key: case for case in cases}

    def pool(size: int) -> concurrent.futures.ProcessPoolExecutor:
        return concurrent.futures.ProcessPoolExecutor(size, mp_context=context, initializer=_alone)

    with contextlib.suppress(BrokenProcessPool), pool(workers) as executor:
        for future in concurrent.futures.as_completed([executor.submit(_work, case) for case in cases]):
            result = future.result()
            del open_cases[result["key"]]
            yield result
    for case in open_cases.values():
        try:
            with pool(1) as executor:
                yield executor.submit(_work, case).result()
        except BrokenProcessPool:
            yield {"key": case.key, "error": "the process that computed it died: out of memory?"}


def _in_turn(cases: list[Case]) -> Iterator[dict[str, Any]]:
    for case in cases:
        yield _work(case)


def _everywhere(cases: list[Case], executor: Any) -> Iterator[dict[str, Any]]:
    """Results as they come from MPI's processes; a process that dies ends the job, and the journal stays."""
    for future in concurrent.futures.as_completed([executor.submit(_work, case) for case in cases]):
        yield future.result()


class Study:
    """A study with what is known of it."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.name, self.cases, self.parameters = _cases.read(options.study)
        self.out: Path = options.out or options.study.parent / self.name
        self.share, self.shares = share(options.slurm_array)
        self.failed = 0

    def done(self) -> dict[str, dict[str, Any]]:
        """Collect the results of all journals by the keys of their cases."""
        found: dict[str, dict[str, Any]] = {}
        for path in sorted(self.out.glob("journal*.jsonl")):
            for entry in lines(path):
                if entry["key"] not in found or "error" in found[entry["key"]]:
                    found[entry["key"]] = entry
        return found

    def run(self, results: Any) -> None:
        """Compute what is open, and write each result down as it comes. `results` maps cases to results."""
        self.out.mkdir(parents=True, exist_ok=True)
        number = f"-{self.share:05d}-of-{self.shares:05d}" if self.shares > 1 else ""
        with Journal(self.out / f"journal{number}.jsonl") as journal:
            done = self.done()
            mine = {case.key: case for case in self.cases[self.share :: self.shares]}
            waiting = [case for key, case in mine.items() if self._is_open(done.get(key))]
            progress = Progress(len(mine), len(mine) - len(waiting), quiet=self.options.quiet)
            for result in results(waiting):
                journal.add(result)
                progress.add(failed="error" in result)

    def _is_open(self, result: dict[str, Any] | None) -> bool:
        return result is None or (self.options.retry and "error" in result)

    def merge(self) -> int:
        """Write the records in order if all cases are done, or those that are if asked to; the exit status."""
        done = self.done()
        missing = [case for case in self.cases if case.key not in done]
        failed = sum("error" in done[case.key] for case in self.cases if case.key in done)
        if not missing or self.options.merge:
            self.out.mkdir(parents=True, exist_ok=True)
            unfinished = self.out / f".{self.name}.csv.{os.getpid()}"
            with unfinished.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(_cases.header(self.parameters))
                for number, case in enumerate(self.cases):
                    if case.key in done:
                        writer.writerows(_cases.rows(number, case, done[case.key]))
            unfinished.replace(self.out / f"{self.name}.csv")
        if not self.options.quiet:
            where = f": {self.out / (self.name + '.csv')}" if not missing or self.options.merge else ""
            print(
                f"{len(self.cases) - len(missing)} of {len(self.cases)} cases, {failed} failed{where}", file=sys.stderr
            )
        mine = {case.key for case in self.cases[self.share :: self.shares]}
        return 1 if failed or any(case.key in mine for case in missing) else 0


class Progress:
    """How far a study is, in one line on a terminal, or in a line now and then elsewhere."""

    def __init__(self, total: int, known: int, *, quiet: bool) -> None:
        self.total, self.done, self.failed, self.quiet = total, known, 0, quiet
        self.known, self.begin, self.said = known, time.monotonic(), 0.0

    def add(self, *, failed: bool) -> None:
        """Count one more."""
        self.done += 1
        self.failed += failed
        now, terminal = time.monotonic(), sys.stderr.isatty()
        # As often as one reads, or as a file of a batch job stands.
        if self.quiet or (now - self.said < (0.2 if terminal else 60.0) and self.done < self.total):
            return
        self.said = now
        left = (now - self.begin) / (self.done - self.known) * (self.total - self.done)
        text = f"{self.done} of {self.total} cases, {self.failed} failed, about {left:.0f} s left"
        ends = {"end": "\n" if self.done == self.total else ""} if terminal else {}
        print(f"\r{text}" if terminal else text, file=sys.stderr, flush=True, **ends)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; the exit status: 1 where a case failed, 2 where the study was refused."""
    options = parser().parse_args(arguments)
    try:
        if options.mpi:
            return _under_mpi(options)
        study = Study(options)
        workers = os.cpu_count() or 1 if options.workers is None else options.workers
        if options.workers is not None and workers < 1:
            raise ValueError(f"--workers: {workers} is not allowed; allowed: at least 1")
        if not options.merge:
            study.run(lambda cases: _in_processes(cases, workers) if workers > 1 else _in_turn(cases))
        return study.merge()
    except (ValueError, OSError) as error:
        print(error, file=sys.stderr)
        return 2


def _under_mpi(options: argparse.Namespace) -> int:
    try:
        from mpi4py import MPI
        from mpi4py.futures import MPICommExecutor
    except ImportError as error:
        print(f"{error}; needed by --mpi: mpi4py", file=sys.stderr)
        return 2
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    status = 0
    # Ranks but the first stay in `with` and work until the first has left it.
    with MPICommExecutor(MPI.COMM_WORLD, root=0) as executor:
        if executor is not None:
            try:
                study = Study(options)
                if not options.merge:
                    study.run(lambda cases: _everywhere(cases, executor))
                status = study.merge()
            except (ValueError, OSError) as error:
                print(error, file=sys.stderr)
                status = 2
    return int(MPI.COMM_WORLD.bcast(status))


if __name__ == "__main__":
    sys.exit(main())
