"""Numbers of result files, read when they are asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import h5py
import numpy as np

from . import errors, labelled


def plain(value: Any) -> Any:
    """A text or a number of an attribute."""
    if isinstance(value, bytes):
        return value.decode("utf-8")
    return value.item() if isinstance(value, np.generic) else value


def leaf(path: str) -> str:
    """The last name of a path.

    >>> leaf("/eigenvalues/growth")
    'growth'
    """
    return path.rpartition("/")[2]


class Series:
    """Numbers of a file, read when they are asked for: ``series[:]``, ``numpy.asarray(series)``.

    Attributes
    ----------
    name : str
        Name of the channel or path of the dataset.
    units : str
        "m/s^2"; "1" of numbers without dimension, "" where the file does not say.
    long_name : str
        What they are; "" where the file does not say.
    """

    def __init__(self, name: str, dataset: h5py.Dataset, length: int | None = None):
        self.name = name
        self._dataset = dataset
        self._length = dataset.shape[0] if length is None else length
        self.units: str = plain(dataset.attrs.get("units", b""))
        self.long_name: str = plain(dataset.attrs.get("long_name", b""))

    def __len__(self) -> int:
        return self._length

    @property
    def shape(self) -> tuple[int, ...]:
        """How many numbers along each axis, of rows those that are whole."""
        return (self._length, *self._opened().shape[1:])

    @property
    def dtype(self) -> np.dtype:
        """Type of the numbers in the file."""
        return self._opened().dtype

    @property
    def scales(self) -> list[h5py.Dataset | None]:
        """The dataset of the file that labels each axis; None where there is none."""
        dataset = self._opened()
        if h5py.h5ds.is_scale(dataset.id):
            return [dataset]
        return [axis[0] if len(axis) else None for axis in dataset.dims]

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the axes: of their coordinates, "time", or else of the series with a number."""
        return tuple(leaf(scale.name) if scale is not None else f"{leaf(self.name)}_{axis}"
                     for axis, scale in enumerate(self.scales))

    def to_xarray(self) -> Any:
        """A labelled array, read where it is used.

        Returns
        -------
        xarray.DataArray
            With coordinates, and ``units`` and ``long_name`` as attributes.

        Raises
        ------
        ImportError
            Where xarray is not installed.

        Examples
        --------
        >>> with run(example("mass_on_belt"), set={"time.end": 1.0, "measure.from": 0.5}) as result:
        ...     labelled = result.channels["slider.mass.x.velocity"].to_xarray().load()
        >>> labelled.dims, labelled.attrs["units"], float(labelled.time[-1].round(6))
        (('time',), 'm/s', 1.0)
        """
        name = leaf(self.name)
        made = labelled.dataset({name: labelled.of_series(self)}, labelled.coordinates_of([self]))
        return made[name]

    def _opened(self) -> h5py.Dataset:
        if not self._dataset:
            raise errors.FileError([errors.Problem(f"{self.name}: its file has been closed")])
        return self._dataset

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, tuple):
            first, *rest = index
        else:
            first, rest = index, []
        dataset = self._opened()
        if isinstance(first, slice):
            first = slice(*first.indices(self._length))
        elif isinstance(first, int):
            if not -self._length <= first < self._length:
                raise IndexError(f"{self.name} has {self._length} rows")
            first %= self._length
        else:
            return dataset[: self._length][index]
        return dataset[(first, *rest)]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.asarray(self[:], dtype=dtype)

    def __repr__(self) -> str:
        if not self._dataset:
            return f"<{self.name}: file closed>"
        extent = " x ".join(str(length) for length in self.shape)
        units = f", {self.units}" if self.units else ""
        return f"<{self.name}: {extent} values{units}{'; ' + self.long_name if self.long_name else ''}>"


class Group(Mapping):
    """Series by name."""

    def __init__(self, series: dict[str, Series]):
        self._series = series

    def __getitem__(self, name: str) -> Series:
        return self._series[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._series)

    def __len__(self) -> int:
        return len(self._series)

    def __repr__(self) -> str:
        return "{" + ", ".join(self._series) + "}"
