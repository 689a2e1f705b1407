"""Files of motions in time: transients and limit cycles."""

from __future__ import annotations

from collections.abc import Mapping

import h5py
import numpy as np

from .files import ResultFile, counted, listed
from .scene import Place
from .series import Series, plain


class _Motion(ResultFile):
    """Series over time; rows beyond ``len(time)`` are not whole."""

    _group_of_arrays = "channels"

    def __init__(self, path: Place, file: h5py.File):
        super().__init__(path, file)
        self._length = file["time"].shape[0]

    def _series(self, name: str, dataset: h5py.Dataset) -> Series:
        scales = dataset.dims[0] if dataset.shape else ()
        has_rows = dataset.name == "/time" or (len(scales) > 0 and scales[0].name == "/time")
        return Series(name, dataset, min(self._length, dataset.shape[0]) if has_rows else None)

    @property
    def time(self) -> Series:
        """Times of the rows, s, ascending."""
        return self._series("time", self._file["time"])

    @property
    def channels(self) -> Mapping[str, Series]:
        """Motions of points by name, "<body>.<point>.<direction>.<displacement|velocity|acceleration>", m, m/s or
        m/s²."""
        return self._group("channels")

    @property
    def contacts(self) -> dict[str, Mapping[str, Series]]:
        """Of every contact, by its name, the series that the scene records: forces, N, gaps, m, slip and states."""
        return {name: self._group(f"contact/{name}") for name in self._file.get("contact", {})}

    def _lines(self) -> list[str]:
        end = f", t = {self.time[0]:.6g} to {self.time[-1]:.6g} s" if self._length else ""
        channels = [f"{name} ({one.units})" for name, one in self.channels.items()]
        contacts = [f"{name} ({len(series)} series)" for name, series in self.contacts.items()]
        lines = [f"{self._length} rows{end}", "channels: " + (listed(channels, 3) or "none")]
        return [*lines, "contacts: " + listed(contacts)] if contacts else lines


class Run(_Motion):
    """A transient, finished, running or killed: rows beyond ``len(run.time)`` are not whole.

    ``to_xarray()`` gives the channels over time; ``to_xarray("contact/NAME")``, ``to_xarray("energy")`` and
    ``to_xarray("bursts")`` the rest.

    Attributes
    ----------
    results : dict
        What `run` said of it, where it has ended: numbers and texts by name, "contact_force.max", in SI units.

    Examples
    --------
    >>> import tempfile, os
    >>> folder = tempfile.mkdtemp()
    >>> result = run(example("mass_on_belt"), output=os.path.join(folder, "belt.h5"),
    ...              set={"time.end": 1.0, "measure.from": 0.5})
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
    >>> result  # doctest: +ELLIPSIS
    <Run ...belt.h5: run of mass_on_belt.yaml
     1001 rows, t = 0 to 1 s
     channels: slider.mass.x.displacement (m), slider.mass.x.velocity (m/s)
     contacts: contact (8 series)
     done>
    """

    def __init__(self, path: Place, file: h5py.File):
        super().__init__(path, file)
        attributes = file["results"].attrs if "results" in file else {}
        self.results = {name: plain(value) for name, value in attributes.items()}

    @property
    def energy(self) -> Mapping[str, Series]:
        """The ledger of energy: its entries over time by name, J; empty where the scene does not record it."""
        return self._group("energy")

    @property
    def bursts(self) -> np.ndarray:
        """A structured array, a row for each burst: ``start`` and ``end``, s; ``frequency``, ``start_frequency`` and
        ``end_frequency``, Hz; ``peak``, in the unit of the channel in which bursts are sought; ``gain``; ``window``,
        its index in `windows`, -1 where none explains it or none were predicted; ``harmonic_of``, the index of the
        burst of which it is a harmonic, -1 where it is none, and its ``order``. Frequencies of both ends are NaN in
        files of earlier versions."""
        return self._records("bursts", {"start": np.nan, "end": np.nan, "frequency": np.nan, "peak": np.nan,
                                        "gain": np.nan, "start_frequency": np.nan, "end_frequency": np.nan,
                                        "window": -1, "harmonic_of": -1, "order": 1})

    @property
    def burst_courses(self) -> np.ndarray:
        """The bursts over time, a structured array: ``burst`` (its index in `bursts`), ``time``, s, ``frequency``, Hz,
        and ``level``, an r.m.s. value in the unit of the channel; empty in files of earlier versions."""
        return self._records("bursts/course", {"burst": -1, "time": np.nan, "frequency": np.nan,
                                               "level": np.nan})

    @property
    def windows(self) -> np.ndarray:
        """Unstable windows of ``run(..., predict=LOCUS)``, a structured array: ``from`` and ``to``, s, ``frequency``,
        Hz, ``growth_max``, 1/s, ``gain``, and ``burst``, its index in `bursts`, -1 where it was not heard."""
        return self._records("windows", {"from": np.nan, "to": np.nan, "frequency": np.nan,
                                         "growth_max": np.nan, "gain": np.nan, "burst": -1})

    @property
    def status(self) -> str:
        """"done", "stopped", or how it ended; "" while it runs or after a kill."""
        return self.results.get("status", "")

    @property
    def scene_text(self) -> str:
        """The scene with every key and default written out."""
        return plain(self._file["scene/resolved"][()])

    def _lines(self) -> list[str]:
        said = [self.status or "has not ended"]
        if len(self.energy) > 0:
            said.append(f"energy ({len(self.energy)} series)")
        for name in ("bursts", "windows"):
            if name in self._file:
                said.append(counted(len(getattr(self, name)), name[:-1]))
        return [*super()._lines(), ", ".join(said)]


class Cycle(_Motion):
    """One period of a limit cycle, of a file that `cycle` wrote.

    Examples
    --------
    >>> found = cycle(example("mass_on_belt"))
    >>> bool(found.period == found.raw["period"]), found.multipliers.shape
    (True, (3,))
    """

    @property
    def status(self) -> str:
        """"periodic", or what was found instead of a cycle."""
        return self.attributes.get("status", "")

    @property
    def period(self) -> float:
        """Time after which the motion repeats itself, s; NaN where no cycle was found."""
        return self.attributes.get("period", np.nan)

    @property
    def multipliers(self) -> np.ndarray:
        """What a disturbance is multiplied by in a period, complex, the largest first; beyond 1 the cycle is
        unstable."""
        group = self._group("multipliers")  # none in files of earlier versions
        return group["real"][:] + 1j * group["imaginary"][:] if group else np.zeros(0, dtype=complex)

    def _lines(self) -> list[str]:
        largest = f", largest multiplier {np.abs(self.multipliers).max():.4g}" if len(self.multipliers) else ""
        return [*super()._lines(), f"{self.status}, period {self.period:.6g} s{largest}"]
