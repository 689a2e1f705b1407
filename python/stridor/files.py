"""Result files: HDF5, read lazily with h5py."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping

import h5py
import numpy as np

from . import labelled
from .scene import Place
from .series import Group, Series, plain


def listed(names: Iterable[str], most: int = 4) -> str:
    """Names in a line; of many the first.

    >>> listed(["a", "b"]), listed("abcdef", most=4)
    ('a, b', 'a, b, c, d and 2 more')
    """
    names = list(names)
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + rest


def counted(number: int, one: str, several: str | None = None) -> str:
    """A number of things.

    >>> counted(1, "burst"), counted(3, "burst"), counted(0, "branch", "branches")
    ('1 burst', '3 bursts', '0 branches')
    """
    return f"{number} {one if number == 1 else several or one + 's'}"


def span(values: np.ndarray, units: str) -> str:
    """From where to where values go.

    >>> span(np.array([0.07, 0.08, 0.09]), "m")
    '0.07 to 0.09 m'
    """
    if len(values) == 0:
        return "empty"
    return f"{values[0]:.6g} to {values[-1]:.6g}{' ' + units if units not in ('', '1') else ''}"


class ResultFile:
    """A result file of any verb. Open it by `open`; it may be used in a ``with``.

    Attributes
    ----------
    path : str
        Path of the file; "" where a result stands in memory alone.
    attributes : dict
        Attributes of the root of the file: what was computed, of what and how (docs/files.md).
    raw : dict
        The JSON object of the verb that wrote it; empty where the file was opened.
    """

    _group_of_arrays: str | None = None

    def __init__(self, path: Place, file: h5py.File):
        self.path = os.fspath(path)
        self._file = file
        self.attributes = {name: plain(value) for name, value in file.attrs.items()}
        self.raw: dict[str, Any] = {}

    @property
    def kind(self) -> str:
        """What it holds: "run", "locus", "stability map", ..."""
        return self.attributes.get("kind", "run" if "time" in self._file else "")

    @property
    def command(self) -> str:
        """The command line that made it; "" where the file does not say."""
        return self.attributes.get("command", "")

    def __getitem__(self, name: str) -> Any:
        """A dataset by its path, "/eigenvalues/growth".

        Parameters
        ----------
        name : str
            Its path in the file.

        Returns
        -------
        Series, str or number
            A `Series`, which is read when its numbers are asked for; of a dataset without a shape what it holds.
        """
        dataset = self._file[name]
        return self._series(name, dataset) if dataset.shape else plain(dataset[()])

    def datasets(self) -> list[str]:
        """Paths of all datasets.

        Returns
        -------
        list of str
            As ``found[path]`` takes them.
        """
        names: list[str] = []
        self._file.visititems(
            lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        return names

    def to_xarray(self, group: str | None = None) -> Any:
        """What a group holds as an `xarray.Dataset` with its coordinates, units and long names.

        Numbers are read where they are used, until when the file must be open (``.load()`` reads all);
        coordinates are read at once.

        Parameters
        ----------
        group : str, optional
            Path of the group, "bursts" or "contact/pad"; default: what the kind of file is about, else the root or the
            first group that holds series.

        Returns
        -------
        xarray.Dataset
            A variable for each series of the group, in the unit of its attribute ``units``.

        Raises
        ------
        KeyError
            If there is no such group.
        ImportError
            Where xarray is not installed.
        """
        path = self._group_of_arrays if group is None else group
        if path is None or (group is None and path not in self._file):
            path = "/" if self._group("/") else next(iter(self._groups()), "/")
        if not isinstance(self._file.get(path), h5py.Group):
            raise KeyError(f"{self.path} has no group {path!r}; it has {listed(self._groups(), 20)}")
        series = self._group(path)
        return labelled.dataset({name: labelled.of_series(one) for name, one in series.items()},
                                labelled.coordinates_of(series.values()), self._introduction())

    def close(self) -> None:
        """Closes the file: what was read stays, what was not can no longer be read."""
        self._file.close()

    def _series(self, name: str, dataset: h5py.Dataset) -> Series:
        return Series(name, dataset)

    def _group(self, path: str) -> Group:
        """The series of a group, without those of groups within it."""
        if path not in self._file:
            return Group({})
        return Group({name: self._series(name, dataset) for name, dataset in self._file[path].items()
                      if isinstance(dataset, h5py.Dataset) and dataset.shape})

    def _groups(self) -> list[str]:
        """Paths of the groups that hold series."""
        paths = (name.rpartition("/")[0] or "/" for name in self.datasets())
        return list(dict.fromkeys(path for path in paths if not path.startswith("checkpoint")))

    def _records(self, name: str, missing: Mapping[str, float]) -> np.ndarray:
        """The datasets of a group side by side; of the types of what stands for missing ones."""
        group = self._file.get(name)
        found = {} if group is None else {key: group[key][:] for key in missing if key in group}
        length = len(next(iter(found.values()))) if found else 0
        columns = [found.get(key, np.full(length, value)).astype(type(value))
                   for key, value in missing.items()]
        return np.rec.fromarrays(columns, names=list(missing))

    def _introduction(self) -> Mapping[str, Any]:
        """Attributes for labelled arrays: those that say what was computed, of what and how."""
        wanted = ("title", "history", "source", "scene_hash", "parameter", "about")
        return {name: self.attributes[name] for name in wanted if name in self.attributes}

    def _lines(self) -> list[str]:
        """What is in it, a line each."""
        return ["groups: " + listed(self._groups(), 6)]

    def __enter__(self) -> "ResultFile":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        name = f"{type(self).__name__} {self.path}" if self.path else type(self).__name__
        if not self._file:
            return f"<{name}: closed>"
        title = self.attributes.get("title") or self.kind
        return "\n ".join([f"<{name}: {title}", *self._lines()]) + ">"


def path_of(file: ResultFile | Place) -> str:
    """The path of a file that is open, or that is named.

    Raises
    ------
    ValueError
        If the result stands in no file.
    """
    path = os.fspath(file.path if isinstance(file, ResultFile) else file)
    if not path:
        raise ValueError(f"this {type(file).__name__} stands in no file; name a folder with output= where it is made")
    return path
