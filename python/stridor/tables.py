"""Results that are tables: where stability changes, assumptions side by side, errors against run times."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np

from .files import ResultFile, counted
from .labelled import import_pandas
from .series import plain

_numbers_of_files = itertools.count(1)


class Table:
    """Rows of named columns.

    ``table[0]`` is a row as a dict, and so is each of a loop; ``table.rows`` has the columns."""

    rows: np.ndarray

    def to_pandas(self) -> Any:
        """The rows as a `pandas.DataFrame`.

        Returns
        -------
        pandas.DataFrame
            A line for each row, a column for each name of `rows`, in the units given there.

        Raises
        ------
        ImportError
            Where pandas is not installed.
        """
        return import_pandas().DataFrame(list(self), columns=list(self.rows.dtype.names))

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        names = self.rows.dtype.names
        return (dict(zip(names, row.tolist())) for row in self.rows)

    def __getitem__(self, index: Any) -> Any:
        """A row as a dict, or of a slice a list of them."""
        return list(self)[index]


class _TableFile(Table, ResultFile):
    """A table that stands in a file, or that a verb gave back without one."""

    def _shown(self, names: Sequence[str]) -> list[str]:
        """Lines of some columns, with their units."""
        series = self._group(self._group_of_arrays or "/")
        units = {name: series[name].units for name in names if name in series}
        heads = [f"{name}, {units[name]}" if units.get(name, "1") not in ("", "1") else name for name in names]
        return aligned(heads, [[row[name] for name in names] for row in self])

    def __getitem__(self, name: Any) -> Any:
        """A row by its number, or a dataset by its path."""
        return ResultFile.__getitem__(self, name) if isinstance(name, str) else super().__getitem__(name)

    def _columns(self, group: str, names: Sequence[str], texts: Sequence[str]) -> np.ndarray:
        """Datasets of a group side by side; NaN, or an empty text, where one is missing."""
        series = self._group(group)
        length = len(next(iter(series.values()))) if series else 0
        missing = {name: [""] * length if name in texts else np.full(length, np.nan) for name in names}
        columns = [series[name][:] if name in series else missing[name] for name in names]
        return np.rec.fromarrays([np.array([plain(text) for text in column], dtype=object) if name in texts else column
                                  for name, column in zip(names, columns)], names=list(names))


def aligned(names: Sequence[str], rows: Sequence[Sequence[Any]]) -> list[str]:
    """Lines of a table whose columns stand below one another; numbers have four digits, missing ones are dashes, long
    texts are cut.

    >>> aligned(["of", "error"], [["film", 0.123456], ["subs_a", float("nan")]])
    ['of       error', 'film    0.1235', 'subs_a       -']
    """
    cells = [list(names), *([_cell(value) for value in row] for row in rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(names))]
    is_text = [all(isinstance(row[column], str) for row in rows) for column in range(len(names))]
    return ["  ".join(cell.ljust(width) if text else cell.rjust(width)
                      for cell, width, text in zip(row, widths, is_text)).rstrip() for row in cells]


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value if len(value) <= 40 else value[:37] + "..."
    return "-" if np.isnan(value) else f"{value:.4g}"


@dataclass(frozen=True, repr=False)
class Thresholds(Table):
    """Where the sliding state becomes stable or unstable, what `threshold` finds.

    Attributes
    ----------
    parameter : str
        Key of the scene that was varied.
    rows : structured array
        ``value`` of the parameter (SI), ``frequency``, Hz, of what begins or ceases to grow there, and ``beyond``, what
        lies above the value: "stable" or "unstable"; ascending values.
    raw : dict
        The whole JSON object.

    Examples
    --------
    >>> found = threshold(example("two_springs_on_a_belt"), parameter="parameters.mu", from_=0, to=1.2)
    >>> found
    <Thresholds of parameters.mu:
     value  frequency, Hz  beyond
      0.75         0.2251  unstable>
    >>> found[0]["beyond"], found.values.round(6).tolist()
    ('unstable', [0.75])
    """

    parameter: str
    rows: np.ndarray
    raw: dict[str, Any]

    @property
    def values(self) -> np.ndarray:
        """Values of the parameter at which stability changes, SI, ascending."""
        return self.rows["value"]

    @property
    def frequencies(self) -> np.ndarray:
        """Frequency of what begins or ceases to grow at each value, Hz."""
        return self.rows["frequency"]

    def __repr__(self) -> str:
        if len(self) == 0:
            return f"<Thresholds of {self.parameter}: none>"
        lines = aligned(("value", "frequency, Hz", "beyond"), [row.tolist() for row in self.rows])
        return "\n ".join([f"<Thresholds of {self.parameter}:", *lines]) + ">"


def thresholds_of(answer: dict[str, Any]) -> Thresholds:
    """Of the JSON object of ``stridor threshold``."""
    roots = answer["roots"]
    columns = [_numbers(roots, "value"), _numbers(roots, "frequency"),
               np.array([root["beyond"] for root in roots], dtype=object)]
    return Thresholds(answer["parameter"], np.rec.fromarrays(columns, names=["value", "frequency", "beyond"]), answer)


class Comparison(_TableFile):
    """The contact assumptions on the same work, a row for each run: what `compare` finds, and its file
    ``comparison.h5``.

    Where no folder was named, nothing is kept, and the result stands in memory alone; its `path` is then empty.

    Examples
    --------
    >>> found = compare(example("beam_on_beam"), set={"time.end": 0.02, "measure.from": 0.01})
    >>> [row["assumption"] for row in found]
    ['subs_a', 'subs_b', 'subs_c', 'film']
    >>> float(found.rows["ratio"][3]), found[3]["status"]
    (1.0, 'done')
    >>> found  # doctest: +ELLIPSIS
    <Comparison: comparison of assumptions of beam_on_beam.yaml
     assumption  coordinates  step_time, s ...
     subs_a      modal ...  done
     subs_b      modal ...  done
     subs_c      modal ...  done
     film        modal ...  done>
    """

    _group_of_arrays = "runs"

    @property
    def rows(self) -> np.ndarray:
        """A structured array, a row for each run: ``assumption``, ``coordinates`` ("modal", or "craig_bampton" of the
        published form) and ``status`` ("done", or why it failed); ``wall_time`` and ``step_time``, s; ``ratio`` of the
        time per step to that of FiLM; ``steps``; ``acceleration_peak`` and ``acceleration_rms``, m/s²; ``difference``
        from FiLM, r.m.s., relative; ``force_min`` and ``force_max``, N; ``stick_fraction``, ``free_fraction``,
        ``num_bursts``. NaN stands for what a run does not have."""
        return self._columns("runs", _RUNS, ("assumption", "coordinates", "status"))

    def _lines(self) -> list[str]:
        return self._shown(("assumption", "coordinates", "step_time", "ratio", "acceleration_rms", "difference",
                            "status"))


class PrecisionStudy(_TableFile):
    """Errors against run times, a row for each setting: what `precision` finds, and its file ``precision.h5``.

    Where no folder was named, nothing is kept, and the result stands in memory alone; its `path` is then empty. Results
    of a call may be indexed by the names of their JSON object as well, ``found["reduction"]``.

    Examples
    --------
    >>> found = precision(example("mass_on_belt"), points=2, until=1, tune=0.05, set={"measure.from": 0.5})
    >>> found.norm, len(found), found.tuned["status"]
    ('envelope', 12, 'done')
    >>> bool(found.tuned["error"] + found.reference_error <= 0.05)
    True
    """

    _group_of_arrays = "settings"

    @property
    def rows(self) -> np.ndarray:
        """A structured array, a row for each setting: ``method`` and ``status`` ("done", or why it failed); ``step`` of
        time, s, or ``tolerance`` of the event-driven integrator; number of ``modes`` that move; ``run_time``, s;
        ``error`` in `norm`, ``error_of_force``, ``error_of_acceleration`` and ``error_of_envelope``, all relative;
        ``on_front``, 1 where no other setting has both less time and a smaller error. NaN stands for what a setting
        does not have."""
        return self._columns("settings", _SETTINGS, ("method", "status"))

    @property
    def reduction(self) -> np.ndarray:
        """How far the reduced bodies answer from the full ones, a structured array: ``body``, ``frequency``, Hz, and
        ``error`` of the displacements per force, relative; a row for each body and frequency, none where no body is
        reduced."""
        return self._columns("reduction", ("body", "frequency", "error"), ("body",))

    @property
    def norm(self) -> str:
        """The error that counts: "envelope", "acceleration" or "force", of event-driven scenes "displacement"."""
        return self.attributes.get("norm", "")

    @property
    def reference_error(self) -> float:
        """Error of the reference against which the others are measured, relative, in `norm`; NaN where nothing was
        run."""
        return float(self.attributes.get("reference_error", np.nan))

    @property
    def tuned(self) -> dict[str, Any] | None:
        """The row of the cheapest setting within the error asked for (``tune``); None where none was."""
        method = self.attributes.get("tuned", "").rpartition(", ")[0]
        wanted = self.attributes.get("wanted_error", np.nan)  # the reference's own error comes on top of each
        good = [row for row in self if row["method"] == method and row["error"] + self.reference_error <= wanted]
        return min(good, key=lambda row: row["run_time"], default=None)

    def __getitem__(self, name: Any) -> Any:
        return self.raw[name] if isinstance(name, str) and name in self.raw else super().__getitem__(name)

    def _lines(self) -> list[str]:
        lines = []
        if len(self) > 0:
            given = [name for name in ("step", "tolerance") if not np.isnan(self.rows[name]).all()]
            lines += self._shown(("method", *given, "run_time", "error", "status"))
            lines.append(f"error: {self.norm}; of the reference {self.reference_error:.4g}")
        reduction = self.reduction
        if len(reduction) > 0:
            bodies = len(set(reduction["body"]))
            worst = np.max(reduction["error"], where=~np.isnan(reduction["error"]), initial=0.0)
            lines.append(f"{counted(bodies, 'reduced body', 'reduced bodies')}, off by at most {worst:.4g}")
        return lines


#: Columns of ``/runs`` in the order in which they are told, with their units and places in the JSON object.
_RUNS = {"assumption": ("1", "assumption"), "coordinates": ("1", "coordinates"), "status": ("1", "status"),
         "wall_time": ("s", "wall_s"), "step_time": ("s", "step_ns"), "ratio": ("1", "ratio"), "steps": ("1", "steps"),
         "acceleration_peak": ("m/s^2", "peak"), "acceleration_rms": ("m/s^2", "rms"),
         "difference": ("1", "difference"), "force_min": ("N", "contact_force/min"),
         "force_max": ("N", "contact_force/max"), "stick_fraction": ("1", "stick_fraction"),
         "free_fraction": ("1", "free_fraction"), "num_bursts": ("1", "bursts")}

#: Those of ``/settings``.
_SETTINGS = {"method": ("1", "method"), "status": ("1", "status"), "step": ("s", "step"),
             "tolerance": ("1", "tolerance"), "modes": ("1", "modes"), "run_time": ("s", "least_wall_s"),
             "error": ("1", "error"), "error_of_force": ("1", "errors/force"),
             "error_of_acceleration": ("1", "errors/acceleration"), "error_of_envelope": ("1", "errors/envelope"),
             "on_front": ("1", "on_front")}


def _found(row: Any, path: str) -> Any:
    """What stands at a path in an object of JSON; None where nothing does."""
    for name in path.split("/"):
        row = row.get(name) if isinstance(row, Mapping) else None
    return row


def _numbers(rows: Sequence[Mapping[str, Any]], path: str) -> np.ndarray:
    """A column of numbers; NaN where there is none, of a list its length."""
    values = (_found(row, path) for row in rows)
    return np.array([np.nan if value is None else len(value) if isinstance(value, list) else value
                     for value in values], dtype=float)


def _columns_of(rows: Sequence[Mapping[str, Any]], places: Mapping[str, tuple[str, str]]) -> dict[str, tuple[Any, str]]:
    """Values and unit of each column of the rows of a JSON object."""
    columns = {}
    for name, (units, path) in places.items():
        values = [_found(row, path) for row in rows]
        if all(isinstance(value, str) for value in values):
            columns[name] = (np.array([value.encode("utf-8") for value in values]), units)
        else:
            columns[name] = (_numbers(rows, path) * (1e-9 if path == "step_ns" else 1.0), units)
    return columns


#: Values and unit of each column.
_Columns = Mapping[str, "tuple[Any, str]"]


def _in_memory(attributes: Mapping[str, Any], groups: Mapping[str, tuple[str, _Columns]]) -> h5py.File:
    """A file that is never written: of each group the name of the column that labels its rows, and its columns."""
    file = h5py.File(f"stridor in memory {next(_numbers_of_files)}", "w", driver="core", backing_store=False)
    for name, value in attributes.items():
        file.attrs[name] = np.bytes_(value.encode("utf-8")) if isinstance(value, str) else value
    for group, (scale, columns) in groups.items():
        for name, (values, units) in columns.items():
            file[f"{group}/{name}"] = values
            file[f"{group}/{name}"].attrs["units"] = np.bytes_(units)
        file[f"{group}/{scale}"].make_scale(scale)
        for name in columns:
            if name != scale:
                file[f"{group}/{name}"].dims[0].attach_scale(file[f"{group}/{scale}"])
    return file


def _numbered(length: int) -> tuple[Any, str]:
    return np.arange(1.0, length + 1.0), "1"


def comparison_of(answer: dict[str, Any]) -> Comparison:
    """Of the JSON object of ``stridor compare``, as its file would have it."""
    rows = answer["rows"]
    attributes = {"kind": "comparison of assumptions", "scene": answer["scene"],
                  "title": f"comparison of assumptions of {os.path.basename(answer['scene'])}"}
    columns = {"number": _numbered(len(rows)), **_columns_of(rows, _RUNS)}
    found = Comparison("", _in_memory(attributes, {"runs": ("number", columns)}))
    found.raw = answer
    return found


def precision_of(answer: dict[str, Any], scene: str) -> PrecisionStudy:
    """Of the JSON object of ``stridor precision``, as its file would have it."""
    tune = answer.get("tune") or {}
    spread = f"step {tune['step']:g} s" if tune.get("step") else f"tolerance {tune.get('tolerance')}"
    attributes: dict[str, Any] = {"kind": "study of precision", "scene": scene,
                                  "title": f"study of precision of {os.path.basename(scene)}"}
    groups: dict[str, tuple[str, _Columns]] = {}
    if answer.get("rows"):
        attributes.update({"norm": answer.get("norm", "displacement"), "channel": answer.get("channel", ""),
                           "reference_error": float(_numbers([answer], "reference/error")[0]),
                           "wanted_error": float(_numbers([answer], "tune/wanted")[0]),
                           "tuned": f"{tune['method']}, {spread}" if tune else ""})
        groups["settings"] = ("run_time", _columns_of(answer["rows"], _SETTINGS))
    pairs = [{"body": one["body"], "frequency": frequency, "error": error} for one in answer.get("reduction", [])
             for frequency, error in zip(one["frequencies"], one["errors"])]
    if pairs:
        places = {"body": ("1", "body"), "frequency": ("Hz", "frequency"), "error": ("1", "error")}
        groups["reduction"] = ("number", {"number": _numbered(len(pairs)), **_columns_of(pairs, places)})
    found = PrecisionStudy("", _in_memory(attributes, groups))
    found.raw = answer
    return found
