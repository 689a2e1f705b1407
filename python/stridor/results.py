"""Files of eigenvalues, loci, maps and sweeps."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import labelled
from .files import ResultFile, counted, listed, span

_TURN = 2.0 * np.pi


def _complex(group: Any) -> np.ndarray:
    """s, 1/s, of the growth rates and frequencies of a group."""
    return group["growth"][:] + 1j * _TURN * group["frequency"][:]


class Spectrum(ResultFile):
    """Eigenvalues of one scene, of a file that ``stridor eig -o`` wrote; what `eig` gives is named alike.

    Examples
    --------
    >>> import os, tempfile
    >>> file = os.path.join(tempfile.mkdtemp(), "eig.h5")
    >>> told = eig(example("beam_on_beam"), output=file)
    >>> with open(file) as found:
    ...     found.stable, bool(abs(found.values - told.values).max() < 1e-6 * abs(told.values).max())
    (True, True)
    """

    _group_of_arrays = "eigenvalues"

    @property
    def values(self) -> np.ndarray:
        """Eigenvalues s, 1/s, complex, ascending frequency."""
        return _complex(self._file["eigenvalues"])

    @property
    def frequencies(self) -> np.ndarray:
        """Frequency of each eigenvalue, Hz."""
        return self._file["eigenvalues/frequency"][:]

    @property
    def growth(self) -> np.ndarray:
        """Growth rate of each eigenvalue, 1/s; negative where it decays."""
        return self._file["eigenvalues/growth"][:]

    @property
    def stable(self) -> bool:
        """Whether none grows within `window`."""
        return bool(self.attributes.get("stable", np.nan) == 1.0)

    @property
    def window(self) -> tuple[float, float]:
        """Lowest and highest frequency for which that holds, Hz."""
        return 0.0, float(self.attributes.get("highest_frequency", np.inf))

    def _lines(self) -> list[str]:
        growth = self.growth
        if len(growth) == 0:
            return [*super()._lines(), "no eigenvalues"]
        worst = int(growth.argmax())
        return [*super()._lines(), f"{counted(len(growth), 'eigenvalue')}, {'stable' if self.stable else 'unstable'}",
                f"largest growth {growth[worst]:.4g} 1/s at {self.frequencies[worst]:.6g} Hz"]


class Locus(ResultFile):
    """Eigenvalues along a key, what `locus` finds.

    Examples
    --------
    >>> found = locus(example("beam_on_beam"), from_="70 mm", to="90 mm", points=5)
    >>> found.parameter, found.values.shape, found.eigenvalues.shape
    ('contact.start', (5,), (5, 20))
    >>> bool((abs(found.eigenvalues.imag[:, 0]) > 0).all())
    True
    >>> found  # doctest: +ELLIPSIS
    <Locus ...locus.h5: locus of beam_on_beam.yaml
     contact.start: 5 values, 0.07 to 0.09 m
     20 eigenvalues, 26.2948 to 17112.5 Hz; growth at most -5.097 1/s
     25 branches
     no unstable windows>
    """

    @property
    def parameter(self) -> str:
        """Key of the scene that was varied."""
        return self.attributes.get("parameter", "")

    @property
    def units(self) -> str:
        """Unit of the parameter, "m"; "1" where it has none."""
        return self.attributes.get("units", "")

    @property
    def values(self) -> np.ndarray:
        """Values of the parameter, in `units`."""
        return self._file["values"][:]

    @property
    def eigenvalues(self) -> np.ndarray:
        """Eigenvalues s, 1/s, complex, [value][number], ascending frequency; NaN where there are fewer."""
        return _complex(self._file["eigenvalues"])

    @property
    def branches(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Every eigenvalue that was followed: values of the parameter and s, 1/s, of each, in arrays of equal
        length."""
        value, growth, frequency = (self._file["branches"][name][:] for name in ("value", "growth", "frequency"))
        return [(row[kept], s[kept]) for row, s in zip(value, growth + 1j * _TURN * frequency)
                for kept in [~np.isnan(row)]]

    @property
    def windows(self) -> np.ndarray:
        """Where something grows, a structured array: ``from``, ``to`` and ``value_max``, in `units`; ``growth_max``,
        1/s, and ``frequency``, Hz, there; where a run passes them ``from_time`` and ``to_time``, s, and ``gain`` (else
        NaN)."""
        names = ("from", "to", "value_max", "growth_max", "frequency", "from_time", "to_time", "gain")
        return self._records("unstable", dict.fromkeys(names, np.nan))

    def to_xarray(self, group: str | None = None) -> Any:
        """The locus as an `xarray.Dataset`, read where it is used.

        `eigenvalues` (s, complex), `growth` and `frequency` lie over the parameter, a coordinate of its name,
        and `number`. `branch_growth` and `branch_frequency` lie over `branch` and `point`, with the value of the
        parameter as the coordinate `branch_value`; behind the end of a branch all three are NaN.

        Parameters
        ----------
        group : str, optional
            A single group of the file instead, "unstable".

        Returns
        -------
        xarray.Dataset

        Examples
        --------
        >>> found = locus(example("beam_on_beam"), from_="70 mm", to="90 mm", points=5).to_xarray()
        >>> found.growth.dims, found.growth.attrs["units"]
        (('contact.start', 'number'), '1/s')
        >>> lowest = found.frequency.sel({"contact.start": 0.081}, method="nearest")[0]
        >>> float(lowest["contact.start"]), float(lowest.round())
        (0.08, 29.0)
        """
        if group is not None:
            return super().to_xarray(group)
        names = {"values": self.parameter or "value"}
        parts = {name: labelled.of_series(self[f"/eigenvalues/{name}"]).renamed(names)
                 for name in ("growth", "frequency")}
        s = labelled.of_parts(parts["growth"], parts["frequency"], _TURN, long_name="eigenvalue")
        of_values = labelled.of_series(self["/values"]).renamed(names, long_name=names["values"])
        variables = {"eigenvalues": s, **parts}
        coordinates = {names["values"]: of_values, "number": labelled.of_series(self["/eigenvalues/number"])}
        if "branches" in self._file:
            branch = {"number": "branch"}
            for name in ("growth", "frequency"):
                variables["branch_" + name] = labelled.of_series(self[f"/branches/{name}"]).renamed(branch)
            coordinates["branch"] = labelled.of_series(self["/branches/number"]).renamed(branch)
            coordinates["point"] = labelled.of_series(self["/branches/point"])
            coordinates["branch_value"] = labelled.of_series(self["/branches/value"]).renamed(
                branch, long_name=names["values"])
        return labelled.dataset(variables, coordinates, self._introduction())

    def _lines(self) -> list[str]:
        growth, frequency = (self._file["eigenvalues"][name][:] for name in ("growth", "frequency"))
        lines = [f"{self.parameter}: {len(growth)} values, {span(self.values, self.units)}"]
        if np.isfinite(growth).any():
            largest = np.nanmax([np.nanmax(growth), *self.windows["growth_max"]])
            lines.append(f"{growth.shape[1]} eigenvalues, {np.nanmin(frequency):.6g} to {np.nanmax(frequency):.6g} Hz; "
                         f"growth at most {largest:.4g} 1/s")
        if "branches" in self._file and len(self._file["branches/growth"]) > 0:
            lines.append(counted(len(self._file["branches/growth"]), "branch", "branches"))
        if "unstable" in self._file:
            spans = [span(np.array(ends), "") for ends in zip(self.windows["from"], self.windows["to"])]
            lines.append(f"unstable: {listed(spans)} {self.units}" if spans else "no unstable windows")
        return lines


class StabilityMap(ResultFile):
    """The largest growth rate over two keys, what `map` finds.

    Examples
    --------
    >>> found = map(example("disc_and_pads"), x=("parameters.mu", 0.2, 0.5, 4),
    ...             y=("substructures.disc.spin", 5, 10, 2))
    >>> found.parameters, found.growth.shape, found.boundary[0].shape[1]
    (('parameters.mu', 'substructures.disc.spin'), (2, 4), 2)
    """

    @property
    def x(self) -> np.ndarray:
        """Values of the key along x, SI."""
        return self._file["x"][:]

    @property
    def y(self) -> np.ndarray:
        """Values of the key along y, SI."""
        return self._file["y"][:]

    @property
    def growth(self) -> np.ndarray:
        """The largest growth rate, 1/s, [y][x]; NaN where the point failed (`reasons`)."""
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

    @property
    def parameters(self) -> tuple[str, str]:
        """The keys along x and y."""
        return self.attributes.get("x", "x"), self.attributes.get("y", "y")

    def to_xarray(self, group: str | None = None) -> Any:
        """The map as an `xarray.Dataset`: `growth` and, where points failed, `reason` over the two keys,
        coordinates of their names.

        Parameters
        ----------
        group : str, optional
            A single group of the file instead, "boundary".

        Returns
        -------
        xarray.Dataset

        Examples
        --------
        >>> found = map(example("disc_and_pads"), x=("parameters.mu", 0.2, 0.5, 4),
        ...             y=("substructures.disc.spin", 5, 10, 2)).to_xarray()
        >>> found.growth.dims, found["substructures.disc.spin"].attrs["units"]
        (('substructures.disc.spin', 'parameters.mu'), 'rad/s')
        >>> float(found.growth.sel({"parameters.mu": 0.5}).max().round(1))
        436.8
        """
        if group is not None:
            return super().to_xarray(group)
        names = dict(zip(("x", "y"), self.parameters))
        coordinates = {key: labelled.of_series(self["/" + axis]).renamed(names, long_name=key)
                       for axis, key in names.items()}
        variables = {"growth": labelled.of_series(self["/growth"]).renamed(names)}
        if "failure" in self._file:
            variables["reason"] = labelled.of_array(variables["growth"].dims, self.reasons,
                                                    long_name="why the point has no growth rate")
        return labelled.dataset(variables, coordinates, self._introduction())

    def _lines(self) -> list[str]:
        growth = self.growth
        lines = [f"{axis}: {key}, {len(self._file[axis])} values, {span(self._file[axis][:], self[axis].units)}"
                 for axis, key in zip("xy", self.parameters)]
        failed = int(np.isnan(growth).sum())
        lines.append(f"growth [y][x], 1/s: {growth.shape[0]} x {growth.shape[1]} points, "
                     f"{(growth > 0.0).sum()} unstable" + (f", {failed} failed" if failed else ""))
        if np.isfinite(growth).any():
            lines[-1] += f", at most {np.nanmax(growth):.4g} 1/s"
        return lines


class Sweep(ResultFile):
    """Results of transients or of limit cycles along a key, what `sweep` finds; ``found["/force_max"]`` is a column.

    Examples
    --------
    >>> found = sweep(example("mass_on_belt"), parameter="parameters.mu_d", from_=0.1, to=0.3, points=3,
    ...               set={"time.end": 1.0, "measure.from": 0.5})
    >>> found  # doctest: +ELLIPSIS
    <Sweep ...sweep.h5: sweep of transients of mass_on_belt.yaml
     parameters.mu_d: 3 values, 0.1 to 0.3
     acceleration_peak, acceleration_rms, failed, force_max, force_min, free_fraction and 5 more>
    >>> found.to_xarray().stick_fraction.dims
    ('parameters.mu_d',)
    """

    @property
    def parameter(self) -> str:
        """Key of the scene that was varied."""
        return self.attributes.get("parameter", "")

    @property
    def ways(self) -> list[str]:
        """Groups of a sweep of limit cycles, "up" and "down" or "rows"; of transients "/" alone."""
        return [way for way in ("up", "down", "rows") if way in self._file] or ["/"]

    @property
    def values(self) -> np.ndarray:
        """Values of the parameter, SI; of a sweep up and down those upwards."""
        return self._group(self.ways[0])["value"][:]

    def to_xarray(self, group: str | None = None) -> Any:
        """The results as an `xarray.Dataset` over the parameter, a coordinate of its name; of a sweep up and
        down over `way` besides, and then read at once.

        Parameters
        ----------
        group : str, optional
            A single group of the file instead, "bursts".

        Returns
        -------
        xarray.Dataset
        """
        if group is not None:
            return super().to_xarray(group)
        key = self.parameter or "value"
        made = []
        for way in self.ways:
            series = self._group(way)
            of = {name: labelled.of_series(one).renamed({"value": key}) for name, one in series.items()}
            value = of.pop("value").renamed({}, long_name=key)
            made.append(labelled.dataset(of, {key: value}, self._introduction()))
        if len(made) == 1:
            return made[0]
        xarray = labelled.import_xarray()
        return xarray.concat([one.sortby(key) for one in made], xarray.DataArray(self.ways, dims="way", name="way"))

    def _lines(self) -> list[str]:
        series = self._group(self.ways[0])
        lines = [f"{self.parameter}: {len(self.values)} values, {span(self.values, series['value'].units)}",
                 listed((name for name in series if name != "value"), 6)]
        if self.ways != ["/"]:
            lines.insert(1, "ways: " + listed(self.ways))
        failed = int(np.sum(series["failed"][:])) if "failed" in series else 0
        return [*lines, counted(failed, "value") + " failed"] if failed else lines
