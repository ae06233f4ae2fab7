"""Checks of what users pass: each error names the argument, the index and the remedy."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


def numbers(name: str, values: ArrayLike) -> Floats:
    """Return values as a C-contiguous array of doubles.

    Raises
    ------
    TypeError
        If they are not real numbers.
    """
    array = plain(name, values)
    if array.dtype.kind not in "fiu":
        raise TypeError(
            f"{name}: numbers are expected, and this has the dtype {array.dtype}: convert it, as by .to_numpy(float)"
        )
    return np.ascontiguousarray(array, dtype=np.float64)


def plain(name: str, values: ArrayLike) -> NDArray[Any]:
    """Return values as an array.

    Raises
    ------
    ValueError
        If rows have different lengths, or values are masked.
    """
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise ValueError(f"{name}: some values are masked: leave their rows out, as by .compressed() or a selection")
    try:
        return np.asarray(values)
    except ValueError as error:
        # Rows of different lengths.
        raise ValueError(f"{name}: {error}: give an array whose rows are equally long") from None


def length(name: str, value: object, *, least: float = 0.0) -> float:
    """Return a length as a float.

    Raises
    ------
    TypeError
        If it is no number.
    ValueError
        If it is not finite, or below the least one.
    """
    number = real(name, value)
    if not least <= number < float("inf"):
        raise ValueError(f"{name}: {number} is no length of {least:g} or more")
    return number


def real(name: str, value: object) -> float:
    """Return a number as a float, which may be infinite or NaN."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name}: a number is expected, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name}: the number is too large") from None


def text(name: str, value: object) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: a text is expected, not {type(value).__name__}")
    # Python keeps bytes that are no text as these.
    if not value.isprintable() and any("\ud800" <= letter <= "\udfff" for letter in value):
        raise ValueError(f"{name}: it has a character that is no Unicode")
    return value


def path(name: str, value: object) -> str:
    """Return the path of a file."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise TypeError(f"{name}: a path is expected, not {type(value).__name__}")
    return os.fsdecode(value)


def count(name: str, value: object, *, least: int = 1) -> int:
    """Return a count as an int.

    Raises
    ------
    TypeError
        If it is no whole number.
    ValueError
        If it is below the least one or beyond 10⁸.
    """
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise TypeError(f"{name}: a whole number is expected, not {type(value).__name__}")
    number = int(value)
    if not least <= number <= 100_000_000:
        raise ValueError(f"{name}: {number} is not between {least} and 100,000,000")
    return number


def vector(name: str, values: ArrayLike) -> tuple[float, float, float]:
    """Return three finite numbers."""
    array = numbers(name, values)
    if array.shape != (3,):
        raise ValueError(f"{name}: three numbers are expected, and this has the shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: {array} is not finite")
    x, y, z = array.tolist()
    return x, y, z


def poses(values: ArrayLike) -> Floats:
    """Return poses as rows of 6, 7 or 16 numbers.

    Raises
    ------
    TypeError
        If they are not real numbers.
    ValueError
        If they have another shape, or there are none.
    """
    array = numbers("poses", values)
    if array.shape[-2:] == (4, 4) and array.ndim in (2, 3):
        array = array.reshape(-1, 16)
    elif array.ndim == 1 and array.shape[0] in (6, 7):
        array = array.reshape(1, -1)
    if array.ndim != 2 or array.shape[1] not in (6, 7, 16):
        raise ValueError(
            f"poses: the shape {array.shape} is none of (n, 6) for tips and axes, (n, 7) for tips and quaternions "
            "x, y, z, w, and (n, 4, 4) for matrices"
        )
    if array.shape[0] == 0:
        raise ValueError("poses: the array is empty: give one pose or more")
    return array
