"""stridor from Python: runs the program and reads its files.

>>> import stridor
>>> scene = stridor.load(stridor.example("frozen_growth"))
>>> found = stridor.eig(scene, about="deformed", set={"contact.friction.coefficient": 0.0})
>>> found.stable
True

Errors are `ConfigError`, `NumericalError`, `FileError` and `Stopped`, with every problem and its place:

>>> try:
...     stridor.eig(scene, set={"contct.start": 0.03})
... except stridor.ConfigError as error:
...     print(error.problems[0].message)
unknown key 'contct', did you mean 'contact'?
"""

from .errors import ConfigError, Error, FileError, NumericalError, Problem, Stopped
from .files import ResultFile
from .invocation import program
from .opening import open
from .pictures import plot, report, sound, spectrogram
from .results import FrequencyResponses, Locus, StabilityMap, Sweep
from .runs import Cycle, Run
from .scene import Scene, example, load
from .series import Series
from .verbs import Eigenvalues, call, compare, cycle, eig, frf, locus, map, precision, run, sweep, threshold

__version__ = "0.1.0"
__all__ = [
    "ConfigError", "Cycle", "Eigenvalues", "Error", "FileError", "FrequencyResponses", "Locus",
    "NumericalError", "Problem", "ResultFile", "Run", "Scene", "Series", "StabilityMap", "Stopped", "Sweep",
    "call", "compare", "cycle", "eig", "example", "frf", "load", "locus", "map", "open",
    "plot", "precision", "program", "report", "run", "sound", "spectrogram", "sweep", "threshold"
]
