"""The examples of the documentation run as they are printed, and print what it says."""

import doctest
import re
import subprocess
import sys

import pytest
from conftest import ROOT

PAGE = ROOT / "src" / "python" / "README.md"
EXAMPLES = ROOT / "src" / "python" / "examples"


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)


def rounded(text):
    """Leave numbers with the digits that do not depend on the order of a sum, and widths of enclosures out."""
    text = re.sub(r"enclosed to [^;]*", "enclosed", text)
    return re.sub(r"\d+\.\d+(e[-+]\d+)?", lambda number: f"{float(number.group()):.5g}", text)


@pytest.mark.parametrize("name", ["fig3", "two_blocks"])
def test_scripts(name, tmp_path):
    source = (EXAMPLES / f"{name}.py").read_text()
    assert source in blocks("python"), "the page prints another script"
    run = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert any(rounded(run.stdout) == rounded(text) for text in blocks("text")), run.stdout
    if name == "fig3":
        assert len([line for line in source.splitlines() if line and not line.startswith(('"""', "import"))]) <= 10
        assert (tmp_path / "fig3.png").stat().st_size > 10_000


@pytest.mark.parametrize("path", [PAGE, ROOT / "README.md"], ids=["page", "README"])
def test_sessions(path):
    found = doctest.testfile(str(path), module_relative=False, optionflags=doctest.ELLIPSIS)
    assert found.attempted > 1
    assert found.failed == 0


def test_docstrings():
    import bipenalty

    assert doctest.testmod(bipenalty).failed == 0


def test_notebook():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(EXAMPLES / "small_step.ipynb", as_version=4)
    printed = [output_of(cell) for cell in notebook.cells]
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute(cwd=str(EXAMPLES))
    assert sum(text is not None for text in printed) > 5
    for before, cell in zip(printed, notebook.cells, strict=True):
        text = output_of(cell)
        assert (before is None) == (text is None)
        assert text is None or rounded(text) == rounded(before)


def output_of(cell):
    """Return the text that a cell answers."""
    texts = [o["data"].get("text/plain", "") for o in cell.get("outputs", []) if o.output_type == "execute_result"]
    return "".join(texts) or None
