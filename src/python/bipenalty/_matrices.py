"""Matrices of any package as compressed rows, without copying what fits as it is.

What is given stays as it is: nothing here changes a matrix of the caller.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = "NDArray[np.float64]"
Rows: TypeAlias = "tuple[tuple[int, int], NDArray[np.int64], NDArray[np.uint32], Floats]"
"""Shape; where rows start; columns; values."""


class Sparse(Protocol):
    """A matrix of scipy.sparse, in any format."""

    def tocsr(self, copy: bool = ...) -> Any:
        """Return the same by rows."""
        ...


# Indices are 32 bits wide.
_MOST = 2**32 - 1


def _refusal(name: str, value: str, allowed: str) -> ValueError:
    return ValueError(f"{name}: {value} is not allowed; allowed: {allowed}")


def floats(values: Any, name: str) -> Floats:
    """Return real numbers as contiguous float64; the same memory if they are that already."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise _refusal(name, f"what numpy cannot read ({error})", "an array of numbers") from None
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        raise _refusal(name, "a masked entry", "an array without masked entries")
    if array.dtype.kind not in "biuf":
        raise _refusal(name, f"dtype {array.dtype}", "real numbers")
    return np.require(array, np.float64, ["C", "A"])


def _indices(values: Any, name: str, most: int) -> NDArray[Any]:
    """Return integers from 0 to `most` in one dimension."""
    array = np.asarray(values)
    if array.dtype.kind not in "iu" or array.ndim != 1:
        raise _refusal(name, f"dtype {array.dtype} in {array.ndim} dimensions", "integers in one dimension")
    if array.size and not (array.min() >= 0 and array.max() <= most):
        raise _refusal(name, f"{array.min()} to {array.max()}", f"0 to {most}")
    return array


def _starts(values: Any, name: str, rows: int, stored: int) -> NDArray[np.int64]:
    """Return where each of the rows starts among the stored entries, and where the last one ends."""
    array = np.require(_indices(values, name, stored), np.int64, ["C", "A"])
    if array.size != rows + 1 or array[0] != 0 or (array[1:] < array[:-1]).any():
        raise _refusal(name, f"{array.size} starts", f"{rows + 1} ascending ones that begin with 0")
    return array


def _check(matrix: Any, name: str) -> None:
    """Refuse what the routines of scipy would read or write beyond its arrays."""
    if len(matrix.shape) != 2 or max(matrix.shape) > _MOST:
        raise _refusal(name, f"shape {matrix.shape}", f"two dimensions of up to {_MOST}")
    if np.dtype(matrix.dtype).kind not in "biuf":
        raise _refusal(name, f"dtype {matrix.dtype}", "real numbers")
    rows, columns = map(int, matrix.shape)
    if matrix.format in ("csr", "csc", "bsr"):
        if matrix.format == "csc":
            rows, columns = columns, rows
        elif matrix.format == "bsr":
            rows, columns = rows // matrix.blocksize[0], columns // matrix.blocksize[1]
        stored = min(len(matrix.indices), len(matrix.data))
        used = int(_starts(matrix.indptr, f"{name}, indptr", rows, stored)[-1])
        _indices(matrix.indices[:used], f"{name}, indices", columns - 1)
    elif matrix.format == "coo":
        sizes = {len(matrix.data), len(matrix.row), len(matrix.col)}
        if len(sizes) > 1:
            raise _refusal(name, f"arrays of {sorted(sizes)} entries", "arrays of one length")
        _indices(matrix.row, f"{name}, row", rows - 1)
        _indices(matrix.col, f"{name}, col", columns - 1)


def _compressed(matrix: Any, name: str) -> Rows:
    """Return the arrays of what was checked."""
    starts = np.require(matrix.indptr, np.int64, ["C", "A"])
    used = int(starts[-1])
    columns = np.require(np.asarray(matrix.indices)[:used], requirements=["C", "A"])
    # None is negative, so that the same bits do.
    columns = columns.view(np.uint32) if columns.dtype == np.int32 else columns.astype(np.uint32)
    return (int(matrix.shape[0]), int(matrix.shape[1])), starts, columns, floats(matrix.data[:used], name)


def _dense(array: Floats) -> Rows:
    row, column = np.nonzero(array)
    starts = np.zeros(array.shape[0] + 1, np.int64)
    np.cumsum(np.bincount(row, minlength=array.shape[0]), out=starts[1:])
    return (
        (array.shape[0], array.shape[1]),
        starts,
        column.astype(np.uint32),
        np.ascontiguousarray(array[row, column]),
    )


def _sparse(matrix: Any, name: str, *, transposed: bool) -> Rows:
    """Compress by rows, or by columns, which are the rows of the transposed matrix."""
    _check(matrix, name)
    matrix = matrix.tocsc() if transposed else matrix.tocsr()
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    (rows, columns), starts, indices, values = _compressed(matrix, name)
    return ((columns, rows) if transposed else (rows, columns)), starts, indices, values


def symmetric(matrix: Any, name: str) -> Rows:
    """Return a symmetric matrix by rows; whether it is symmetric is for the library to say."""
    if hasattr(matrix, "tocsr"):
        # The columns of a symmetric matrix are its rows.
        return _sparse(matrix, name, transposed=getattr(matrix, "format", "") == "csc")
    array = floats(matrix, name)
    if array.ndim != 2:
        raise _refusal(name, f"an array of {array.ndim} dimensions", "n x n, dense or scipy.sparse")
    return _dense(array)


def mass(matrix: Any) -> Rows | Floats:
    """Return a mass matrix by rows, or the diagonal of a lumped one, given as [n], [n, 1] or n x 1."""
    if hasattr(matrix, "tocsr"):
        _check(matrix, "mass")
        return floats(matrix.toarray(), "mass").reshape(-1) if matrix.shape[1] == 1 else symmetric(matrix, "mass")
    array = floats(matrix, "mass")
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1):
        return array.reshape(-1)
    return symmetric(array, "mass")


def gaps(matrix: Any) -> Rows:
    """Return the columns of Z, [n, k], as rows; [n] is one column."""
    if hasattr(matrix, "tocsr"):
        return _sparse(matrix, "gaps", transposed=True)
    array = floats(matrix, "gaps")
    if array.ndim == 1:
        array = array[:, np.newaxis]
    if array.ndim != 2:
        raise _refusal("gaps", f"an array of {array.ndim} dimensions", "n x k, dense or scipy.sparse, or n")
    return _dense(np.ascontiguousarray(array.T))


def scales(values: ArrayLike | None, contacts: int) -> Floats | None:
    """Return one scale a contact; a number is that of all."""
    if values is None:
        return None
    array = floats(values, "scales")
    return np.full(contacts, float(array)) if array.ndim == 0 else array.reshape(-1)


def vector(values: ArrayLike | None, name: str, size: int) -> Floats | None:
    """Return one number for each of `size` places; a number is that of all."""
    if values is None:
        return None
    array = floats(values, name)
    if array.ndim == 0:
        return np.full(size, float(array))
    if array.shape != (size,):
        raise _refusal(name, f"shape {array.shape}", f"[{size}], or a number")
    return array


OwnRows: TypeAlias = "tuple[NDArray[np.int64], NDArray[np.int64], Floats, tuple[int, int]]"
"""Where rows start; columns; values; shape: as the library hands them out."""


def rows_given(parts: OwnRows) -> Rows:
    """Return the rows that the library hands out as it takes them."""
    starts, columns, values, shape = parts
    return shape, starts, columns.astype(np.uint32), values


def transposed(parts: OwnRows) -> OwnRows:
    """Return the columns of a matrix as rows."""
    starts, columns, values, (rows, width) = parts
    row = np.repeat(np.arange(rows), np.diff(starts))
    order = np.lexsort((row, columns))
    ends = np.cumsum(np.bincount(columns, minlength=width), dtype=np.int64)
    return np.concatenate([np.zeros(1, np.int64), ends]), row[order], values[order], (width, rows)


def rows_of(parts: OwnRows) -> Any:
    """Return the scipy.sparse matrix of the rows that the library hands out."""
    try:
        from scipy.sparse import csr_matrix
    except ImportError:
        raise ImportError("matrices() needs scipy: pip install bipenalty[sparse]") from None
    starts, columns, values, shape = parts
    return csr_matrix((values, columns, starts), shape=shape)
