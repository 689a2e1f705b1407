"""Files of frequency responses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from . import labelled
from .files import ResultFile, listed, span


class FrequencyResponses(ResultFile):
    """Frequency responses by output and input, what `frf` finds: ``found[output, input]``.

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
        """Frequencies of the responses, Hz, ascending."""
        return self._file["frequency"][:]

    @property
    def truncation(self) -> dict[tuple[str, str], float]:
        """How far each response (output, input) is off with the modes that a run keeps, relative, r.m.s. over the
        frequencies; empty where it keeps all."""
        return {(output, name): float(self._file["responses"][output][name]["truncation"][()])
                for output, name in self if "truncation" in self._file["responses"][output][name]}

    @property
    def truncation_error(self) -> dict[tuple[str, str], np.ndarray]:
        """The size of that difference at each frequency, in the unit of the response; empty where a run keeps all."""
        return {(output, name): self._file["responses"][output][name]["truncation_error"][:]
                for output, name in self if "truncation_error" in self._file["responses"][output][name]}

    def __iter__(self) -> Iterator[tuple[str, str]]:
        """Names of output and input of each response."""
        for output, inputs in self._file["responses"].items():
            for name in inputs:
                yield output, name

    def __getitem__(self, names: Any) -> Any:
        """The response of an output to an input, complex, in the unit of the motion per N; or a dataset by its path."""
        if isinstance(names, str):
            return super().__getitem__(names)
        output, name = names
        group = self._file["responses"][output][name]
        return group["real"][:] + 1j * group["imaginary"][:]

    def to_xarray(self, group: str | None = None) -> Any:
        """The responses as an `xarray.Dataset`: a complex variable for each output, over `input` and `frequency`.

        Parameters
        ----------
        group : str, optional
            A single group of the file instead, "compared".

        Returns
        -------
        xarray.Dataset

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
