"""Result files: HDF5, read lazily with h5py."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

import h5py
import numpy as np

from . import errors
from .scene import Place


def _plain(value: Any) -> Any:
    """A text or a number of an attribute."""
    if isinstance(value, bytes):
        return value.decode("utf-8")
    return value.item() if isinstance(value, np.generic) else value


class Series:
    """Numbers of a file, read when they are asked for: ``series[:]``, ``numpy.asarray(series)``.

    Attributes
    ----------
    name : str
    units : str
    long_name : str
        What they are; "" where the file does not say.
    """

    def __init__(self, name: str, dataset: h5py.Dataset, length: int | None = None):
        self.name = name
        self._dataset = dataset
        self._length = dataset.shape[0] if length is None else length
        self.units: str = _plain(dataset.attrs.get("units", b""))
        self.long_name: str = _plain(dataset.attrs.get("long_name", b""))

    def __len__(self) -> int:
        return self._length

    @property
    def shape(self) -> tuple[int, ...]:
        return (self._length, *self._dataset.shape[1:])

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, tuple):
            first, *rest = index
        else:
            first, rest = index, []
        if isinstance(first, slice):
            first = slice(*first.indices(self._length))
        elif isinstance(first, int):
            if not -self._length <= first < self._length:
                raise IndexError(f"{self.name} has {self._length} rows")
            first %= self._length
        else:
            return self._dataset[: self._length][index]
        return self._dataset[(first, *rest)]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.asarray(self[:], dtype=dtype)

    def __repr__(self) -> str:
        return f"<{self.name}: {self._length} values, {self.units}>"


class _Group(Mapping):
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


class ResultFile:
    """A result file of any verb. Open it by `open`; it may be used in a ``with``.

    Attributes
    ----------
    path : str
    kind : str
        "run", "locus", "map", ...
    attributes : dict
        What was computed, of what and how.
    """

    def __init__(self, path: Place, file: h5py.File):
        self.path = os.fspath(path)
        self._file = file
        self.attributes = {name: _plain(value) for name, value in file.attrs.items()}

    @property
    def kind(self) -> str:
        return self.attributes.get("kind", "run" if "time" in self._file else "")

    @property
    def command(self) -> str:
        """The command line that made it."""
        return self.attributes.get("command", "")

    def __getitem__(self, name: str) -> Any:
        """A dataset by its path, "/eigenvalues/growth": a `Series`, or a text or number alone."""
        dataset = self._file[name]
        return Series(name, dataset) if dataset.shape else _plain(dataset[()])

    def datasets(self) -> list[str]:
        """Paths of all datasets."""
        names: list[str] = []
        self._file.visititems(
            lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        return names

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> "ResultFile":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.path}>"


class Run(ResultFile):
    """A transient, finished, running or killed: rows beyond ``len(run.time)`` are not whole.

    Attributes
    ----------
    results : dict
        What `run` said of it, where it has ended.

    Examples
    --------
    >>> import tempfile, os
    >>> folder = tempfile.mkdtemp()
    >>> result = run(example("mass_on_belt"), output=os.path.join(folder, "belt.h5"), set={"time.end": 1.0})
    >>> result.status
    'done'
    >>> sorted(result.channels)
    ['slider.mass.x.displacement', 'slider.mass.x.velocity']
    >>> displacement = result.channels["slider.mass.x.displacement"]
    >>> displacement.units, len(displacement) == len(result.time)
    ('m', True)
    >>> round(float(max(displacement[:])), 3)
    0.044
    >>> sorted(result.contacts["contact"])[:2]
    ['force', 'force_low_passed']
    """

    def __init__(self, path: Place, file: h5py.File):
        super().__init__(path, file)
        self._length = file["time"].shape[0]
        attributes = file["results"].attrs if "results" in file else {}
        self.results = {name: _plain(value) for name, value in attributes.items()}

    def _group(self, path: str) -> _Group:
        if path not in self._file:
            return _Group({})
        return _Group({name: Series(name, dataset, min(self._length, dataset.shape[0]))
                       for name, dataset in self._file[path].items()
                       if isinstance(dataset, h5py.Dataset)})

    @property
    def time(self) -> Series:
        """s."""
        return Series("time", self._file["time"], self._length)

    @property
    def channels(self) -> Mapping[str, Series]:
        """Motions of points, "<body>.<point>.<direction>.<displacement|velocity|acceleration>"."""
        return self._group("channels")

    @property
    def contacts(self) -> dict[str, Mapping[str, Series]]:
        """Forces, gaps, slip and states of every contact, by its name."""
        return {name: self._group(f"contact/{name}") for name in self._file.get("contact", {})}

    @property
    def energy(self) -> Mapping[str, Series]:
        """The ledger, J; empty where the scene does not record it."""
        return self._group("energy")

    @property
    def bursts(self) -> np.ndarray:
        """Bursts as a structured array with start, end, frequency, peak and gain, the frequencies at
        which each begins and ends (NaN in files of earlier versions), the index of its window in
        `windows`, -1 where none explains it or none were predicted, and the index of the burst of
        which it is a harmonic, `harmonic_of`, -1 where it is none, with its `order`."""
        return self._records("bursts", {"start": np.nan, "end": np.nan, "frequency": np.nan, "peak": np.nan,
                                        "gain": np.nan, "start_frequency": np.nan, "end_frequency": np.nan,
                                        "window": -1, "harmonic_of": -1, "order": 1})

    @property
    def burst_courses(self) -> np.ndarray:
        """Frequencies and levels (r.m.s. values) of the bursts over time as a structured array with
        burst (its index in `bursts`), time, frequency and level; empty in files of earlier versions."""
        return self._records("bursts/course", {"burst": -1, "time": np.nan, "frequency": np.nan,
                                               "level": np.nan})

    @property
    def windows(self) -> np.ndarray:
        """Unstable windows of ``run(..., predict=LOCUS)`` as a structured array with from, to, frequency,
        growth_max and gain, and the index of its burst in `bursts`, -1 where it was not heard."""
        return self._records("windows", {"from": np.nan, "to": np.nan, "frequency": np.nan,
                                         "growth_max": np.nan, "gain": np.nan, "burst": -1})

    def _records(self, name: str, missing: Mapping[str, float]) -> np.ndarray:
        """The datasets of a group side by side; of the types of what stands for missing ones."""
        group = self._file.get(name)
        found = {} if group is None else {key: group[key][:] for key in missing if key in group}
        length = len(next(iter(found.values()))) if found else 0
        columns = [found.get(key, np.full(length, value)).astype(type(value))
                   for key, value in missing.items()]
        return np.rec.fromarrays(columns, names=list(missing))

    @property
    def status(self) -> str:
        """"done", "stopped", or how it ended; "" while it runs or after a kill."""
        return self.results.get("status", "")

    @property
    def scene_text(self) -> str:
        """The scene with every key and default written out."""
        return _plain(self._file["scene/resolved"][()])


class Locus(ResultFile):
    """Eigenvalues along a key.

    Examples
    --------
    >>> found = locus(example("beam_on_beam"), from_="70 mm", to="90 mm", points=5)
    >>> found.parameter, found.values.shape, found.eigenvalues.shape
    ('contact.start', (5,), (5, 20))
    >>> bool((abs(found.eigenvalues.imag[:, 0]) > 0).all())
    True
    """

    @property
    def parameter(self) -> str:
        return self.attributes.get("parameter", "")

    @property
    def units(self) -> str:
        """Of the parameter."""
        return self.attributes.get("units", "")

    @property
    def values(self) -> np.ndarray:
        return self._file["values"][:]

    @property
    def eigenvalues(self) -> np.ndarray:
        """s, 1/s, [value][eigenvalue], ascending frequency; NaN where there are fewer."""
        group = self._file["eigenvalues"]
        return group["growth"][:] + 2j * np.pi * group["frequency"][:]

    @property
    def branches(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Values and s of every eigenvalue that was followed."""
        value, growth, frequency = (self._file["branches"][name][:] for name in ("value", "growth", "frequency"))
        return [(row[kept], s[kept]) for row, s in zip(value, growth + 2j * np.pi * frequency)
                for kept in [~np.isnan(row)]]


class StabilityMap(ResultFile):
    """The largest growth rate over two keys."""

    @property
    def x(self) -> np.ndarray:
        return self._file["x"][:]

    @property
    def y(self) -> np.ndarray:
        return self._file["y"][:]

    @property
    def growth(self) -> np.ndarray:
        """1/s, [y][x]; NaN where the point failed (`reasons`)."""
        return self._file["growth"][:]

    @property
    def reasons(self) -> np.ndarray:
        """Why a point has no growth rate, texts [y][x]; "" where it has one."""
        if "failure" not in self._file:
            return np.full(self._file["growth"].shape, "", dtype=object)
        texts = ["", *(text.decode("utf-8") for text in self._file["failures/reason"][:])]
        return np.array(texts, dtype=object)[self._file["failure"][:].astype(int)]

    @property
    def boundary(self) -> list[np.ndarray]:
        """Lines where stability changes, [point][x, y] each, the longest first."""
        x, y = (self._file["boundary"][name][:] for name in ("x", "y"))
        return [np.column_stack([of_x, of_y])[~np.isnan(of_x)] for of_x, of_y in zip(x, y)]


class FrequencyResponses(ResultFile):
    """Frequency responses, by output and input.

    Examples
    --------
    >>> found = frf(example("reed"), input="reed.middle.y", from_="100 Hz", to="3 kHz", points=30)
    >>> found.frequency.shape
    (30,)
    >>> [(output, input) for output, input in found]
    [('reed.middle.y.acceleration', 'reed.middle.y')]
    >>> found["reed.middle.y.acceleration", "reed.middle.y"].dtype
    dtype('complex128')
    """

    @property
    def frequency(self) -> np.ndarray:
        """Hz."""
        return self._file["frequency"][:]

    @property
    def truncation(self) -> dict[tuple[str, str], float]:
        """How far each response is off with the modes that a run keeps; empty where it keeps all."""
        return {(output, name): float(self._file["responses"][output][name]["truncation"][()])
                for output, name in self if "truncation" in self._file["responses"][output][name]}

    def __iter__(self) -> Iterator[tuple[str, str]]:
        for output, inputs in self._file["responses"].items():
            for name in inputs:
                yield output, name

    def __getitem__(self, names: Any) -> Any:
        if isinstance(names, str):
            return super().__getitem__(names)
        output, name = names
        group = self._file["responses"][output][name]
        return group["real"][:] + 1j * group["imaginary"][:]


_KINDS = {"run": Run, "locus": Locus, "map": StabilityMap, "stability map": StabilityMap,
          "frequency responses": FrequencyResponses}


def open(path: Place) -> ResultFile:  # noqa: A001, as in h5py and xarray
    """A result file: `Run`, `Locus`, `StabilityMap`, `FrequencyResponses`, or else `ResultFile`.

    Raises
    ------
    FileError
        If it is not there, or no HDF5 file.
    """
    try:
        file = h5py.File(path, "r", locking=False)
    except TypeError:  # h5py before 3.5 knows no locking
        file = h5py.File(path, "r")
    except OSError as error:
        raise errors.FileError([errors.Problem(str(error), file=os.fspath(path))]) from error
    kind = _plain(file.attrs.get("kind", b""))
    if not kind and "time" in file and "scene" in file:  # runs of earlier versions
        return Run(path, file)
    return _KINDS.get(kind, ResultFile)(path, file)
