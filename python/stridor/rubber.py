"""Files of viscoelastic normal laws: sliding contacts, and the tables that scenes take."""

from __future__ import annotations

import numpy as np

from .files import ResultFile, counted, listed, span
from .series import Series


_FIRST = ("speed", "indentation", "force", "area", "friction", "converged")


class SlidingContacts(ResultFile):
    """Forces, areas and friction in steady sliding, with pressures and gaps: what `contact` finds.

    ``to_xarray()`` gives the rows; ``to_xarray("contacts/000")`` pressure and gap of the first contact.

    Examples
    --------
    >>> found = contact(example("viscoelastic_contact"), speed=[0.1, 1.0], indentation=0.01)
    >>> found.rows["speed"].tolist(), [round(float(force), 4) for force in found.rows["force"]]
    ([0.1, 1.0], [0.0016, 0.0047])
    >>> pressure = found.fields[0]["pressure"]
    >>> pressure.units, pressure.dims, pressure.shape
    ('Pa', ('y', 'x'), (64, 128))
    >>> found.to_xarray().friction.dims
    ('speed',)
    """

    _group_of_arrays = "rows"

    @property
    def rows(self) -> np.ndarray:
        """A structured array, a row for each contact: ``speed`` v tau/R, ``indentation`` y/R, ``force`` F/(E_0* R^2),
        ``area`` A/R^2 and ``friction``, all dimensionless, ``converged`` (1 or 0) and what else tells of the
        solution."""
        series = self._group("rows")
        names = sorted(series, key=lambda name: _FIRST.index(name) if name in _FIRST else len(_FIRST))
        return np.rec.fromarrays([series[name][:] for name in names], names=names)

    @property
    def fields(self) -> list[dict[str, Series]]:
        """Of every contact ``x`` and ``y``, m, ``pressure``, Pa, and ``gap``, m, both [y][x], and, where it was
        resolved, the edge of the area of contact, ``edge_x`` and ``edge_y``, m."""
        return [dict(self._group(f"contacts/{number}")) for number in sorted(self._file.get("contacts", {}))]

    def _lines(self) -> list[str]:
        rows = self.rows
        lines = [counted(len(rows), "contact") + ", rows: " + listed(rows.dtype.names or (), 6)]
        failed = int((rows["converged"] == 0.0).sum())
        return [*lines, f"{failed} did not converge"] if failed else lines


class ContactLaw(ResultFile):
    """A table of force, area and friction over speed and indentation, which the key ``normal.form`` of a contact takes.

    Examples
    --------
    >>> law = contact_table(example("viscoelastic_contact"), speeds=(0.1, 1.0, 4), indentations=(1e-3, 1e-2, 4))
    >>> law  # doctest: +ELLIPSIS
    <ContactLaw ...law.h5: contact law of viscoelastic_contact.yaml
     4 speeds, 0.1 to 1
     4 indentations, 0.001 to 0.01
     area, force, friction, memory_in_cells>
    >>> law.to_xarray().force.dims
    ('indentation', 'speed')
    """

    def _lines(self) -> list[str]:
        extents = [f"{len(self._file[name])} {name}s, {span(self._file[name][:], '')}"
                   for name in ("speed", "indentation")]
        return [*extents, listed(name for name in self._group("/") if name not in ("speed", "indentation"))]
