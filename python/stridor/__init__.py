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

from .calls import call
from .contacts import contact, contact_table, fit
from .errors import ConfigError, Error, FileError, NumericalError, Problem, SceneWarning, Stopped
from .files import ResultFile
from .inspection import Findings, check, import_, info, schema
from .invocation import program
from .motions import cycle, run, sweep
from .opening import open
from .pictures import draw, plot, report, sound, spectrogram
from .responses import FrequencyResponses
from .results import Locus, Spectrum, StabilityMap, Sweep
from .rubber import ContactLaw, SlidingContacts
from .runs import Cycle, Run
from .scene import Scene, example, load
from .series import Series
from .stability import Eigenvalues, eig, frf, locus, map, threshold
from .studies import compare, precision
from .tables import Comparison, PrecisionStudy, Thresholds

__version__ = "0.1.0"
__all__ = [
    "Comparison", "ConfigError", "ContactLaw", "Cycle", "Eigenvalues", "Error", "FileError", "Findings",
    "FrequencyResponses", "Locus", "NumericalError", "PrecisionStudy", "Problem", "ResultFile", "Run", "Scene",
    "SceneWarning", "Series", "SlidingContacts", "Spectrum", "StabilityMap", "Stopped", "Sweep", "Thresholds",
    "call", "check", "compare", "contact", "contact_table", "cycle", "draw", "eig", "example", "fit", "frf",
    "import_", "info", "load", "locus", "map", "open", "plot", "precision", "program", "report", "run", "schema",
    "sound", "spectrogram", "sweep", "threshold"
]
