"""Files of loci, maps, responses, sweeps and sliding contacts."""

from __future__ import annotations

from collections.abc import Iterator
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
        """s, 1/s, ascending frequency."""
        return _complex(self._file["eigenvalues"])

    @property
    def frequencies(self) -> np.ndarray:
        """Hz."""
        return self._file["eigenvalues/frequency"][:]

    @property
    def growth(self) -> np.ndarray:
        """1/s."""
        return self._file["eigenvalues/growth"][:]

    @property
    def stable(self) -> bool:
        """Whether none grows within `window`."""
        return bool(self.attributes.get("stable", np.nan) == 1.0)

    @property
    def window(self) -> tuple[float, float]:
        """Frequencies for which that holds, Hz."""
        return 0.0, float(self.attributes.get("highest_frequency", np.inf))

    def _lines(self) -> list[str]:
        growth = self.growth
        if len(growth) == 0:
            return [*super()._lines(), "no eigenvalues"]
        worst = int(growth.argmax())
        return [*super()._lines(), f"{counted(len(growth), 'eigenvalue')}, {'stable' if self.stable else 'unstable'}",
                f"largest growth {growth[worst]:.4g} 1/s at {self.frequencies[worst]:.6g} Hz"]


class Locus(ResultFile):
    """Eigenvalues along a key.

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
        return _complex(self._file["eigenvalues"])

    @property
    def branches(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Values and s of every eigenvalue that was followed."""
        value, growth, frequency = (self._file["branches"][name][:] for name in ("value", "growth", "frequency"))
        return [(row[kept], s[kept]) for row, s in zip(value, growth + 1j * _TURN * frequency)
                for kept in [~np.isnan(row)]]

    @property
    def windows(self) -> np.ndarray:
        """Where something grows, as a structured array with from, to and value_max (of the parameter), growth_max, 1/s,
        and frequency, Hz, there, and, where a run passes them, from_time, to_time, s, and gain (else NaN)."""
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

    @property
    def truncation_error(self) -> dict[tuple[str, str], np.ndarray]:
        """The size of that difference at each frequency, in the unit of the response; empty where a run keeps all."""
        return {(output, name): self._file["responses"][output][name]["truncation_error"][:]
                for output, name in self if "truncation_error" in self._file["responses"][output][name]}

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

    def to_xarray(self, group: str | None = None) -> Any:
        """The responses as an `xarray.Dataset`: a complex variable for each output, over `input` and `frequency`.

        Examples
        --------
        >>> found = frf(example("reed"), input="reed.middle.y", from_="100 Hz", to="3 kHz", points=30).to_xarray()
        >>> response = found["reed.middle.y.acceleration"].sel(input="reed.middle.y")
        >>> response.dims, response.attrs["units"], float(found.frequency[-1])
        (('frequency',), 'm/s^2/N', 3000.0)
        """
        if group is not None:
            return super().to_xarray(group)
        inputs = list(dict.fromkeys(name for _, name in self))
        variables = {output: self._response_of(output, inputs) for output in self._file["responses"]}
        coordinates = {"frequency": labelled.of_series(self["/frequency"]),
                       "input": labelled.of_array(("input",), np.array(inputs, dtype=object))}
        return labelled.dataset(variables, coordinates, self._introduction())

    def _response_of(self, output: str, inputs: list[str]) -> labelled.Labelled:
        """The responses of an output to all inputs."""
        parts = [labelled.of_parts(*(labelled.of_series(self[f"/responses/{output}/{name}/{part}"])
                                     for part in ("real", "imaginary"))) for name in inputs]

        def read(key: tuple[Any, ...]) -> np.ndarray:
            which, frequencies = key
            if isinstance(which, int):
                return parts[which].read((frequencies,))
            return np.array([one.read((frequencies,)) for one in parts[which]])

        return labelled.Labelled(("input", "frequency"), (len(parts), *parts[0].shape), np.dtype(complex), read,
                                 {**parts[0].attributes, "long_name": f"{output} per force"})

    def _lines(self) -> list[str]:
        return [f"{len(self._file['frequency'])} frequencies, {span(self.frequency, 'Hz')}",
                "responses: " + listed((f"{output} / {name}" for output, name in self), 3)]


class Sweep(ResultFile):
    """Results of transients or of limit cycles along a key.

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
        return self.attributes.get("parameter", "")

    @property
    def ways(self) -> list[str]:
        """Groups of a sweep of limit cycles, "up" and "down" or "rows"; of transients "/" alone."""
        return [way for way in ("up", "down", "rows") if way in self._file] or ["/"]

    @property
    def values(self) -> np.ndarray:
        """Of the parameter; of a sweep up and down those upwards."""
        return self._group(self.ways[0])["value"][:]

    def to_xarray(self, group: str | None = None) -> Any:
        """The results as an `xarray.Dataset` over the parameter, a coordinate of its name; of a sweep up and
        down over `way` besides, and then read at once.

        Parameters
        ----------
        group : str, optional
            A single group of the file instead, "bursts".
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
