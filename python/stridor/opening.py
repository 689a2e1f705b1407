"""Opens a result file as what it is."""

from __future__ import annotations

import os

import h5py

from . import errors
from .files import ResultFile
from .responses import FrequencyResponses
from .results import Locus, Spectrum, StabilityMap, Sweep
from .rubber import ContactLaw, SlidingContacts
from .runs import Cycle, Run
from .scene import Place
from .series import plain
from .tables import Comparison, PrecisionStudy

_KINDS = {"run": Run, "eigenvalues": Spectrum, "locus": Locus, "map": StabilityMap, "stability map": StabilityMap,
          "frequency responses": FrequencyResponses, "limit cycle": Cycle, "sweep of transients": Sweep,
          "sweep of limit cycles": Sweep, "sliding contacts": SlidingContacts, "contact law": ContactLaw,
          "comparison of assumptions": Comparison, "study of precision": PrecisionStudy}


def open(path: Place) -> ResultFile:  # noqa: A001, as in h5py and xarray
    """Opens a result file as what it is.

    Parameters
    ----------
    path : path
        Path of a file (HDF5) that a verb has written; a run may still be writing it.

    Returns
    -------
    ResultFile
        By its kind a `Run`, `Cycle`, `Sweep`, `Spectrum`, `Locus`, `StabilityMap`, `FrequencyResponses`,
        `SlidingContacts`, `ContactLaw`, `Comparison` or `PrecisionStudy`; of any other kind a plain `ResultFile`.

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
