//! Arrays of numpy as matrices of the library, without copying their entries.
#![allow(unsafe_code)]

use std::sync::Arc;

use bipenalty::sparse::Entries;
use numpy::{Element, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The entries of an array, which is kept alive for as long as they are.
struct Foreign<T> {
    _array: Py<PyArray1<T>>,
    first: *const T,
    length: usize,
}

// SAFETY: the entries are read only, plain numbers, and the array that holds them lives as long as this.
unsafe impl<T: Sync> Send for Foreign<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Sync for Foreign<T> {}

impl<T> AsRef<[T]> for Foreign<T> {
    fn as_ref(&self) -> &[T] {
        // SAFETY: `shared` took both from a contiguous, aligned slice of the array; numpy moves no entries of an array that
        // somebody refers to. That nobody writes to them is what `bipenalty` asks of its callers and checks.
        unsafe { std::slice::from_raw_parts(self.first, self.length) }
    }
}

/// The entries of a contiguous array, shared with it.
pub fn shared<T: Element + Sync + 'static>(array: PyReadonlyArray1<'_, T>) -> PyResult<Entries<T>> {
    let slice = array.as_slice().map_err(|_| PyValueError::new_err("an array is not contiguous"))?;
    let (first, length) = (slice.as_ptr(), slice.len());
    let array = (*array).clone().unbind();
    Ok(Entries::Shared(Arc::new(Foreign { _array: array, first, length })))
}
