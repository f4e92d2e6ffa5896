"""Matrices of any form give the right answer or a ValueError: never a crash, never a change of what was given."""

import bipenalty as bp
import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp

CASES = 200


def network(rng):
    """K of random springs between n masses, some of them to the ground, M, Z and w."""
    n, k = int(rng.integers(2, 30)), int(rng.integers(1, 4))
    K = np.zeros((n, n))
    for _ in range(4 * n):
        i, j = rng.integers(0, n, 2)
        stiffness = 2.0 ** rng.integers(-3, 4)
        z = np.zeros(n)
        z[i] += 1.0
        if i != j:
            z[j] -= 1.0
        K += stiffness * np.outer(z, z)
    M = np.diag(rng.uniform(0.5, 2.0, n))
    if rng.random() < 0.5:
        off = rng.uniform(0.0, 0.2, n - 1)
        M += np.diag(off, 1) + np.diag(off, -1)
    Z = np.zeros((n, k))
    for column in Z.T:
        i, j = rng.choice(n, 2, replace=False)
        column[i] = 1.0
        if rng.random() < 0.5:
            column[j] = -rng.uniform(0.1, 1.0)
    return K, M, Z, rng.uniform(0.5, 2.0, k)


def exact(K, M, Z, w, beta_s, ratio, reference):
    P = (Z * w) @ Z.T
    top = scipy.linalg.eigh(K + beta_s * P, M + beta_s / (ratio * reference) * P, eigvals_only=True)[-1]
    return 2.0 / np.sqrt(top)


def unsorted(rng, matrix):
    matrix = sp.csr_matrix(matrix)
    for row in range(matrix.shape[0]):
        part = slice(matrix.indptr[row], matrix.indptr[row + 1])
        order = rng.permutation(part.stop - part.start)
        matrix.indices[part], matrix.data[part] = matrix.indices[part][order], matrix.data[part][order]
    return sp.csr_matrix((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)


def duplicated(_, matrix):
    coo = sp.coo_matrix(matrix)
    halves = np.concatenate([0.5 * coo.data, 0.5 * coo.data])
    return sp.coo_matrix((halves, (np.tile(coo.row, 2), np.tile(coo.col, 2))), shape=coo.shape)


def unsorted_duplicates(rng, matrix):
    coo = duplicated(rng, matrix)
    order = np.lexsort((rng.random(coo.nnz), coo.row))
    starts = np.concatenate([[0], np.cumsum(np.bincount(coo.row, minlength=coo.shape[0]))])
    return sp.csr_matrix((coo.data[order], coo.col[order], starts), shape=coo.shape)


def strided(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.data = np.repeat(matrix.data, 3)[::3]
    matrix.indices = np.repeat(matrix.indices, 2)[::2]
    return matrix


def readonly(_, matrix):
    matrix = sp.csr_matrix(matrix)
    for array in (matrix.data, matrix.indices, matrix.indptr):
        array.flags.writeable = False
    return matrix


def wide(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int64), matrix.indptr.astype(np.int64)
    return matrix


def swapped(_, matrix):
    matrix = np.asarray(matrix)
    return matrix.astype(matrix.dtype.newbyteorder())


def unaligned(_, matrix):
    buffer = np.zeros(matrix.size * 8 + 1, np.uint8)
    array = buffer[1:].view(np.float64).reshape(matrix.shape)
    array[...] = matrix
    return array


def longer(_, matrix):
    """Arrays with room behind what is in use."""
    matrix = sp.csr_matrix(matrix)
    matrix.data, matrix.indices = np.append(matrix.data, 7.0), np.append(matrix.indices, 0)
    return matrix


FORMS = [
    lambda _, a: a,
    lambda _, a: np.asfortranarray(a),
    lambda _, a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
    lambda _, a: np.asmatrix(a),
    lambda _, a: a.tolist(),
    lambda _, a: a.astype(np.longdouble),
    swapped,
    unaligned,
    lambda _, a: sp.csr_matrix(a),
    lambda _, a: sp.csr_array(a),
    lambda _, a: sp.csc_matrix(a),
    lambda _, a: sp.csc_array(a),
    lambda _, a: sp.coo_matrix(a),
    lambda _, a: sp.coo_array(a),
    lambda _, a: sp.bsr_matrix(a),
    lambda _, a: sp.dia_matrix(a),
    lambda _, a: sp.dok_matrix(a),
    lambda _, a: sp.lil_matrix(a),
    unsorted,
    duplicated,
    unsorted_duplicates,
    strided,
    readonly,
    wide,
    longer,
]


def broken_pointer(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.indptr[1], matrix.indptr[-2] = matrix.indptr[-1], 0
    return matrix


def beyond(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.indices[0] = matrix.shape[1] + 5
    return matrix


def negative(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.indices[0] = -1
    return matrix


def short(_, matrix):
    matrix = sp.csr_matrix(matrix)
    matrix.data = matrix.data[:-1]
    return matrix


def lying(rng, matrix):
    matrix = unsorted(rng, matrix)
    matrix.indices[:2] = matrix.indices[0]
    matrix.has_sorted_indices = matrix.has_canonical_format = True
    return matrix


def entry(value):
    def put(rng, matrix):
        matrix = np.array(matrix)
        matrix[tuple(rng.integers(0, size) for size in matrix.shape)] = value
        return matrix

    return put


BROKEN = [
    lambda _, a: a[:-1],
    lambda _, a: a[:, :-1],
    lambda _, a: np.zeros((0, 0)),
    lambda _, a: np.zeros((0, 0, 0)),
    lambda _, a: a[np.newaxis],
    lambda _, a: sp.csr_matrix((0, 0)),
    lambda _, a: a.astype(complex),
    lambda _, a: sp.csr_matrix(a.astype(complex)),
    lambda _, a: a.astype(object),
    lambda _, a: a.astype(str),
    lambda _, a: np.ma.masked_array(a, mask=np.ones_like(a)),
    lambda _, a: [[1.0, 2.0], [3.0]],
    lambda _, a: None,
    lambda _, a: "K",
    lambda _, a: {"a": 1},
    broken_pointer,
    beyond,
    negative,
    short,
    lying,
    entry(np.nan),
    entry(np.inf),
    entry(1e300),
    lambda _, a: a * 0.0,
    lambda _, a: -a,
]


def answer(matrices, w, beta_s, ratio):
    """Return the step, or the text of the refusal."""
    try:
        model = bp.Model.from_matrices(*matrices, scales=w, reference=3.0)
        return model.critical_step(beta_s, ratio), None
    except ValueError as error:
        return None, str(error)


@pytest.mark.parametrize("case", range(CASES))
def test_right_or_refused(case):
    rng = np.random.default_rng(case)
    K, M, Z, w = network(rng)
    beta_s, ratio = 10.0 ** rng.uniform(-1, 4), float(rng.choice([0.5, 1.0, 7.0, np.inf]))
    given = [K, M, Z]
    forms = [int(rng.integers(len(FORMS))) for _ in given]
    forms[case % 3] = case % len(FORMS)
    shaped = [FORMS[form](rng, matrix) for form, matrix in zip(forms, given, strict=True)]
    if forms[1] == 0 and (np.diag(M.diagonal()) == M).all():
        shaped[1] = M.diagonal()
    if case % 2 == 1:
        at = int(rng.integers(3))
        shaped[at] = BROKEN[case // 2 % len(BROKEN)](rng, given[at])
        found, refusal = answer(shaped, w, beta_s, ratio)
        if refusal is not None:
            assert "allowed" in refusal
            return
        # What was not refused is a matrix after all; it is read as numpy reads it.
        arrays = [a.toarray() if sp.issparse(a) else np.asarray(a, float) for a in shaped]
        want = exact(*arrays, w, beta_s, ratio, 3.0)
    else:
        before = [a.copy() if hasattr(a, "copy") else a for a in shaped]
        model = bp.Model.from_matrices(*shaped, scales=w, reference=3.0)
        found = model.critical_step(beta_s, ratio)
        want = exact(K, M, Z, w, beta_s, ratio, 3.0)
        for left, right in zip(shaped, before, strict=True):
            same = (left != right).nnz == 0 if sp.issparse(left) else np.array_equal(left, right)
            assert same, "what was given was changed"
    assert found.lower * (1 - 1e-10) <= want <= found.upper * (1 + 1e-10), (found, want)
    assert found.upper <= found.lower * (1 + 2e-9)


def test_every_form_is_met():
    assert max(len(FORMS), len(BROKEN)) <= CASES // 2


@pytest.mark.parametrize("scales", [None, 2.0, [1.0, 2.0]])
def test_scales(scales):
    K, M, Z = np.array([[1.0, -1.0, 0], [-1, 2, -1], [0, -1, 1]]), np.ones(3), np.eye(3)[:, [0, 2]]
    model = bp.Model.from_matrices(K, M, Z, scales=scales)
    *_, w = model.matrices()
    want = [1.0, 1.0] if scales is None else np.broadcast_to(scales, 2)
    assert w.tolist() == list(want)
    for bad in ([1.0], [1.0, -1.0], [1.0, np.nan], [1.0, 2.0, 3.0], 0.0):
        with pytest.raises(ValueError, match="allowed"):
            bp.Model.from_matrices(K, M, Z, scales=bad)


def test_reference():
    K, M, z = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.ones(2), np.array([0.0, 1.0])
    assert bp.Model.from_matrices(K, M, z).reference == pytest.approx(2.0, rel=1e-6)
    assert bp.Model.from_matrices(K, M, z, reference=5.0).reference == 5.0
    for bad in ("bar", -1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="reference"):
            bp.Model.from_matrices(K, M, z, reference=bad)


def test_rounding_is_no_asymmetry():
    rng = np.random.default_rng(5)
    K, M, Z, w = network(rng)
    K = K / 3.0
    noisy = K * (1 + 1e-15 * rng.uniform(-1, 1, K.shape))
    found = bp.Model.from_matrices(noisy, M, Z, scales=w, reference=3.0).critical_step(5.0, 2.0)
    assert found.value == pytest.approx(exact(K, M, Z, w, 5.0, 2.0, 3.0), rel=1e-12)
    with pytest.raises(ValueError, match=r"stiffness, row .* a symmetric matrix"):
        bp.Model.from_matrices(K + np.triu(1e-9 * abs(K), 1), M, Z, scales=w)


def test_matrices_come_back():
    rng = np.random.default_rng(6)
    K, M, Z, w = network(rng)
    back = bp.Model.from_matrices(sp.csr_matrix(K), sp.csc_matrix(M), Z, scales=w).matrices()
    for given, found in zip((K, M, Z), back, strict=False):
        assert sp.issparse(found)
        assert found.format == "csr"
        assert (found.toarray() == given).all()
    assert (back[3] == w).all()


def test_shared_arrays_are_read_in_place_and_watched():
    rng = np.random.default_rng(7)
    K, M, Z, w = network(rng)
    K = sp.csr_matrix(K)
    model = bp.Model.from_matrices(K, M, Z, scales=w)
    before = model.critical_step(10.0, 2.0)
    again = bp.Model.from_matrices(K, M, Z, scales=w).critical_step(10.0, 2.0)
    assert (before.lower, before.upper) == (again.lower, again.upper)
    K.data[0] += 1.0
    for ask in (lambda: model.critical_step(1.0, 1.0), model.matrices, lambda: model.optimal_ratio(1.0)):
        with pytest.raises(ValueError, match="an array that was changed"):
            ask()
    K.data[0] -= 1.0
    assert model.critical_step(10.0, 2.0).lower == before.lower


def test_arrays_outlive_what_they_came_from():
    rng = np.random.default_rng(8)
    K, M, Z, w = network(rng)
    want = exact(K, M, Z, w, 4.0, 1.0, 3.0)
    model = bp.Model.from_matrices(sp.csr_matrix(K), sp.csr_matrix(M), sp.csr_matrix(Z), scales=w, reference=3.0)
    del K, M, Z
    _ = [np.full(1000, np.nan) for _ in range(1000)]
    assert model.critical_step(4.0, 1.0).value == pytest.approx(want, rel=1e-9)


def test_without_contact():
    K, M = np.array([[1.0, -1.0], [-1.0, 1.0]]), np.ones(2)
    model = bp.Model.from_matrices(K, M, np.zeros((2, 0)))
    assert model.contacts == 0
    assert model.critical_step(0.0).value == pytest.approx(np.sqrt(2.0), rel=1e-9)
