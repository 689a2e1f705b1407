"""Labelled arrays of xarray, made of datasets of result files and read where they are used.

xarray and pandas are optional packages: what needs them imports them when it is called.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .series import Series


@dataclass
class Labelled:
    """Numbers that are read by their indices, with what is known of them.

    Attributes
    ----------
    dims : tuple of str
    shape : tuple of int
    dtype : numpy.dtype
    read : callable
        Of a tuple of integers and of slices that end within `shape`, to an array.
    attributes : dict
        "units" and "long_name".
    """

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: Any
    read: Callable[[tuple[Any, ...]], Any]
    attributes: dict[str, Any] = field(default_factory=dict)

    def renamed(self, names: Mapping[str, str], **attributes: str) -> "Labelled":
        """The same with other names of dimensions and other attributes."""
        dims = tuple(names.get(name, name) for name in self.dims)
        return Labelled(dims, self.shape, self.dtype, self.read, {**self.attributes, **attributes})


def of_series(series: "Series") -> Labelled:
    """A series with the names of its axes; texts are read at once."""
    attributes = {"units": series.units, "long_name": series.long_name}
    attributes = {name: value for name, value in attributes.items() if value}
    if series.dtype.kind in "SO":
        return of_array(series.dims, np.array([one.decode("utf-8") for one in series[:]], dtype=object), **attributes)
    return Labelled(series.dims, series.shape, series.dtype, series.__getitem__, attributes)


def of_array(dims: tuple[str, ...], array: np.ndarray, **attributes: str) -> Labelled:
    """Numbers that have been read."""
    return Labelled(dims, array.shape, array.dtype, array.__getitem__, dict(attributes))


def of_parts(real: Labelled, imaginary: Labelled, factor: float = 1.0, **attributes: str) -> Labelled:
    """real + i factor imaginary."""
    return Labelled(real.dims, real.shape, np.dtype(complex),
                    lambda key: real.read(key) + 1j * factor * imaginary.read(key), {**real.attributes, **attributes})


def coordinates_of(series: Iterable["Series"]) -> dict[str, Labelled]:
    """The coordinates of series by name."""
    from .series import Series, leaf

    scales = {leaf(scale.name): scale for one in series for scale in one.scales if scale is not None}
    return {name: of_series(Series(name, scale)) for name, scale in scales.items()}


def import_xarray() -> Any:
    """The package xarray.

    Raises
    ------
    ImportError
        Where it is not installed; the message says how it is.
    """
    try:
        import xarray
    except ImportError as error:
        raise ImportError("to_xarray() needs the package xarray "
                          "(Debian: apt install python3-xarray; else: pip install xarray)") from error
    return xarray


def import_pandas() -> Any:
    """The package pandas.

    Raises
    ------
    ImportError
        Where it is not installed; the message says how it is.
    """
    try:
        import pandas
    except ImportError as error:
        raise ImportError("to_pandas() needs the package pandas "
                          "(Debian: apt install python3-pandas; else: pip install pandas)") from error
    return pandas


def _read(of: Labelled, shape: tuple[int, ...], key: tuple[Any, ...]) -> np.ndarray:
    """Numbers at the indices of every axis: an integer, a slice or an array of integers each.

    Read is one block, of steps upwards, from which the rest is chosen.
    """
    block: list[Any] = []
    choice: list[Any] = []
    for index, length in zip(key, shape):
        if isinstance(index, slice):
            rows = range(length)[index]
            upwards = rows if rows.step > 0 else rows[::-1]
            block.append(slice(upwards.start, upwards.stop, upwards.step))
            choice.append(slice(None, None, 1 if rows.step > 0 else -1))
        elif np.ndim(index) > 0:
            rows = np.arange(length)[index]
            first, last = (rows.min(), rows.max() + 1) if rows.size else (0, 0)
            block.append(slice(int(first), int(last), 1))
            choice.append(rows - first)
        else:
            block.append(range(length)[int(index)])
    found = np.asarray(of.read(tuple(block)), dtype=of.dtype)
    for axis, one in enumerate(choice):
        found = found[(slice(None),) * axis + (one,)]
    return found


@functools.lru_cache(maxsize=None)
def _backend_array() -> Any:
    """The class of arrays that xarray indexes before it reads them."""
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class FileArray(BackendArray):
        def __init__(self, of: Labelled, shape: tuple[int, ...]):
            self.shape = shape
            self.dtype = np.dtype(of.dtype)
            self._of = of

        def __getitem__(self, key: Any) -> Any:
            if isinstance(key, indexing.VectorizedIndexer):
                return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._at)
            return self._at(key.tuple)

        def _at(self, key: tuple[Any, ...]) -> np.ndarray:
            return _read(self._of, self.shape, key)

    return FileArray


def _variable(of: Labelled, sizes: Mapping[str, int]) -> Any:
    """A variable of xarray that is read where it is used, up to the sizes of its dimensions, and then kept."""
    from xarray.core import indexing

    array = _backend_array()(of, tuple(sizes[name] for name in of.dims))
    lazy = indexing.MemoryCachedArray(indexing.CopyOnWriteArray(indexing.LazilyIndexedArray(array)))
    return import_xarray().Variable(of.dims, lazy, of.attributes)


def dataset(variables: Mapping[str, Labelled], coordinates: Mapping[str, Labelled],
            attributes: Mapping[str, Any] | None = None) -> Any:
    """An `xarray.Dataset`. What is longer than another along the same dimension is cut to its length.

    Coordinates along one dimension that bears their name are read at once: xarray makes indices of them.

    Raises
    ------
    ImportError
        Where xarray is not installed.
    """
    xarray = import_xarray()
    sizes: dict[str, int] = {}
    for one in (*variables.values(), *coordinates.values()):
        for name, length in zip(one.dims, one.shape):
            sizes[name] = min(length, sizes.get(name, length))
    return xarray.Dataset({name: _variable(one, sizes) for name, one in variables.items() if name not in coordinates},
                          {name: _variable(one, sizes) for name, one in coordinates.items()},
                          dict(attributes or {}))
