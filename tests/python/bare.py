"""What works where nothing but numpy is installed: run by itself, without pytest."""

import importlib.util
import pickle

import bipenalty as bp
import numpy as np


def main():
    """Ask a few questions and check the answers."""
    missing = [name for name in ("scipy", "matplotlib", "pytest") if importlib.util.find_spec(name)]
    assert not missing, f"not a bare environment: it has {missing}"
    model = bp.Model.from_scene("signorini", mass="lumped", elements=200)
    assert model.critical_step(10.0, 2.0).courant == 0.7891948863055671
    found = model.stability_map(np.logspace(-3, 12, 61), [1.0, np.inf])
    assert found.lower.shape == (2, 61)
    assert np.allclose(found.critical_step[0], 5e-4)
    dense = bp.Model.from_matrices([[1.0, -1.0], [-1.0, 1.0]], [1.0, 1.0], [0.0, 1.0])
    assert abs(dense.critical_step(1.0).value - 2.0 / np.sqrt(1.5 + np.sqrt(1.25))) < 1e-9
    assert pickle.loads(pickle.dumps(model.largest_penalty(4e-4, 2.0))) == model.largest_penalty(4e-4, 2.0)
    for ask, extra in ((model.matrices, "sparse"), (found.plot, "plot")):
        try:
            ask()
        except ImportError as error:
            assert f"pip install bipenalty[{extra}]" in str(error)
        else:
            raise AssertionError("an extra was there")
    print(model.critical_step(10.0, 2.0))


if __name__ == "__main__":
    main()
