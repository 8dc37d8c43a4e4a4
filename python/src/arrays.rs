//! Columns of numbers from and to numpy.

use numpy::{PyArray1, PyArrayMethods as _, PyReadonlyArray1};
use pyo3::prelude::*;

/// Copies the numbers of whatever numpy takes as one dimension of real numbers. A copy is needed: the work runs without
/// Python's lock, and its array may be written to meanwhile.
///
/// # Errors
/// `breakaway.ArrayError`, with the name of the argument.
pub fn column(name: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = values.py().import("breakaway._input")?.call_method1("column", (name, values))?;
    let array: PyReadonlyArray1<'_, f64> = array.extract()?;
    Ok(array.as_array().to_vec())
}

/// A read-only array that takes the numbers over, without a copy.
///
/// # Errors
/// Those of numpy.
pub fn array(py: Python<'_>, numbers: Vec<f64>) -> PyResult<Py<PyArray1<f64>>> {
    let array = PyArray1::from_vec(py, numbers);
    array.try_readwrite()?.make_nonwriteable();
    Ok(array.unbind())
}

/// The numbers of an array that [`array`] has made.
///
/// # Errors
/// Those of numpy.
pub fn numbers(py: Python<'_>, array: &Py<PyArray1<f64>>) -> PyResult<Vec<f64>> {
    Ok(array.bind(py).try_readonly()?.as_array().to_vec())
}
