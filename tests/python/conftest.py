"""What the tests share: the command line tools, which `cargo build --release` leaves in target/release."""

import csv
import io
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


class Tools:
    """Runs the tools and reads their records."""

    def __call__(self, *arguments):
        """Return the rows that a tool prints, as dictionaries of text."""
        tool, *options = map(str, arguments)
        path = ROOT / "target" / "release" / tool
        if not path.exists():
            pytest.fail(f"{path} is missing: run cargo build --release first")
        command = [path, *options, "--stdout", "csv", "--quiet"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode in (0, 1), run.stderr
        return list(csv.DictReader(io.StringIO(run.stdout)))


@pytest.fixture(scope="session")
def tools():
    return Tools()
