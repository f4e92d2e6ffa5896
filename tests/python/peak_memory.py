"""Matrices of 1e6 unknowns are not copied: the peak memory that a model of them adds."""

import gc
import resource

import bipenalty as bp
import numpy as np
import scipy.sparse as sp

SIDE = 1000


def lattice():
    """Return K of springs on a lattice, as csr_matrix with int32 indices."""
    here = np.arange(SIDE * SIDE, dtype=np.int32).reshape(SIDE, SIDE)
    ends = [(here[:, :-1], here[:, 1:]), (here[:-1], here[1:]), (here[:-1, :-1], here[1:, 1:])]
    left, right = (np.concatenate([pair[i].ravel() for pair in ends]) for i in (0, 1))
    rows, columns = np.concatenate([left, right]), np.concatenate([right, left])
    off = sp.csr_matrix((np.full(len(rows), -1.0), (rows, columns)), shape=(SIDE * SIDE, SIDE * SIDE))
    K = sp.csr_matrix(off - sp.diags(np.asarray(off.sum(axis=1)).ravel()))
    K.sort_indices()
    return K


def peak():
    """Return the largest memory that this process has had so far, bytes."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def grow(to):
    """Fill the memory up to the peak, so that whatever is taken beyond shows."""
    held = []
    while peak() <= to:
        held.append(np.ones(1 << 17))
    return held


def main():
    """Print and check what a model takes."""
    K = lattice()
    M = sp.csr_matrix(0.1 * abs(K) + sp.eye(K.shape[0]))
    Z = sp.eye(K.shape[0], SIDE, format="csc")
    gc.collect()
    given = sum(array.nbytes for A in (K, M) for array in (A.data, A.indices, A.indptr))
    held = grow(peak())
    before = peak()
    model = bp.Model.from_matrices(K, M, Z)
    added = peak() - before
    entries = sum(array.nbytes for A in (K, M) for array in (A.data, A.indices))
    print(f"{model}: K and M take {given / 1e6:.0f} MB, the model of them {added / 1e6:.0f} MB more")
    # Starts of rows (8 bytes each, twice for a moment), a diagonal, the bodies that rows belong to.
    assert added < entries / 2, "the entries were copied"
    del held


if __name__ == "__main__":
    main()
