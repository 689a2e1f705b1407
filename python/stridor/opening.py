"""Opens a result file as what it is."""

from __future__ import annotations

import os

import h5py

from . import errors
from .files import ResultFile
from .results import FrequencyResponses, Locus, Spectrum, StabilityMap, Sweep
from .rubber import ContactLaw, SlidingContacts
from .runs import Cycle, Run
from .scene import Place
from .series import plain

_KINDS = {"run": Run, "eigenvalues": Spectrum, "locus": Locus, "map": StabilityMap, "stability map": StabilityMap,
          "frequency responses": FrequencyResponses, "limit cycle": Cycle, "sweep of transients": Sweep,
          "sweep of limit cycles": Sweep, "sliding contacts": SlidingContacts, "contact law": ContactLaw}


def open(path: Place) -> ResultFile:  # noqa: A001, as in h5py and xarray
    """A result file: `Run`, `Spectrum`, `Locus`, `StabilityMap`, `FrequencyResponses`, `Sweep`, `Cycle`, `SlidingContacts`,
    `ContactLaw`, or else `ResultFile`.

    Parameters
    ----------
    path : path
        Of a file that a verb has written.

    Raises
    ------
    FileError
        If it is not there, or no HDF5 file.

    Examples
    --------
    >>> written = cycle(example("mass_on_belt")).path
    >>> type(open(written)).__name__
    'Cycle'
    """
    try:
        file = h5py.File(path, "r", locking=False)
    except TypeError:  # h5py before 3.5 knows no locking
        file = h5py.File(path, "r")
    except OSError as error:
        raise errors.FileError([errors.Problem(str(error), file=os.fspath(path))]) from error
    kind = plain(file.attrs.get("kind", b""))
    if not kind and "time" in file and "scene" in file:  # runs of earlier versions
        return Run(path, file)
    return _KINDS.get(kind, ResultFile)(path, file)
