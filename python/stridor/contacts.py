"""Verbs of viscoelastic normal laws: sliding contacts, tables of a law, the refit of the published laws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from . import invocation
from .calls import call, opened, output_of, written
from .invocation import Progress
from .rubber import ContactLaw, SlidingContacts
from .scene import Place, Scene, Settings


def contact(scene: Scene | Place, *, speed: float | Sequence[float] | None = None,
            indentation: float | Sequence[float] | None = None, load: float | Sequence[float] | None = None,
            contact: str | None = None, output: Place | None = None, set: Settings | None = None,  # noqa: A002
            verify: bool = False, threads: int | None = None, force: bool = False, progress: Progress | None = None,
            **options: Any) -> SlidingContacts:
    """Viscoelastic normal laws of a scene in steady sliding: force, area, friction, pressures.

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    speed : number or list of numbers, optional
        Sliding speeds v tau/R, dimensionless; default: those of the scene.
    indentation : number or list of numbers, optional
        Indentations y/R, dimensionless; default: those of the scene.
    load : number or list of numbers, optional
        Normal forces F/(E_0* R^2), dimensionless, instead of indentations.
    contact : str, optional
        Name of the contact, where the scene has several; default: all with such a law.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    verify : bool, default: False
        Whether the results are compared with what the scene expects (``expect``).
    threads : int, optional
        Threads to use; default: one.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.
    **options
        ``pressure`` and ``edges`` (paths): pictures of the pressure of the last contact and of the edges of all.

    Returns
    -------
    SlidingContacts
        The file, open, with a row for each contact; remarks on each stand in ``raw["rows"]``.

    Raises
    ------
    ConfigError
        If the scene has no such law, or several and `contact` names none.
    NumericalError
        If a contact did not converge; its `answer` has all rows.

    Examples
    --------
    >>> found = contact(example("viscoelastic_contact"), speed=[0.1, 1], indentation=0.01,
    ...                 set={"contacts.tip.normal.solver.grid": 32})
    >>> len(found.rows)
    2
    """
    asked = {"speed": speed, "indentation": indentation, "load": load, "contact": contact, "verify": verify,
             "threads": threads, "force": force, **options}
    return written("contact", scene, output, set, progress, asked)


def contact_table(scene: Scene | Place, *, speeds: tuple[float, float, int] | None = None,
                  indentations: tuple[float, float, int] | None = None, contact: str | None = None,
                  output: Place | None = None, set: Settings | None = None,  # noqa: A002
                  threads: int | None = None, force: bool = False, progress: Progress | None = None) -> ContactLaw:
    """The law of a contact as a table, which the key ``normal.form`` of a contact takes (``stridor contact --table``).

    Parameters
    ----------
    scene : Scene or path
        A scene, or the path of its file.
    speeds : tuple, optional
        First and last speed v tau/R, dimensionless, and their number; default: (1e-3, 1e3, 49).
    indentations : tuple, optional
        First and last indentation y/R, dimensionless, and their number; default: (1e-4, 0.3, 15).
    contact : str, optional
        Name of the contact, where the scene has several.
    output : path, optional
        HDF5 file to write; default: one in a new folder of its own.
    set : mapping, optional
        Keys of the scene that are set anew for this call: numbers in SI units, or texts with a unit.
    threads : int, optional
        Threads to use; default: one.
    force : bool, default: False
        Whether a file that exists is written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    ContactLaw
        The file, open; its ``path`` is what ``normal.form`` takes.

    Examples
    --------
    >>> law = contact_table(example("viscoelastic_contact"), speeds=(0.1, 1, 4), indentations=(0.005, 0.01, 4),
    ...                     set={"contacts.tip.normal.solver.grid": 32})
    >>> type(law).__name__
    'ContactLaw'
    """
    file = output_of(output, "law.h5")
    asked = {"speeds": speeds, "indentations": indentations, "contact": contact, "threads": threads, "force": force}
    return opened(file, call("contact", scene, set=set, progress=progress, table=file, **asked))


def fit(*, speeds: tuple[float, float, int] | None = None, indentations: tuple[float, float, int] | None = None,
        figures: Place | None = None, force: bool = False, progress: Progress | None = None) -> dict[str, Any]:
    """Refit of the published contact laws to the boundary elements. It takes no scene.

    Parameters
    ----------
    speeds : tuple, optional
        First and last speed v tau/R, dimensionless, and their number; default: (1e-3, 1e3, 49).
    indentations : tuple, optional
        First and last indentation y/R, dimensionless, and their number; default: (1e-4, 0.3, 15).
    figures : path, optional
        Folder for the pictures modulus, cuts and scatter; default: none.
    force : bool, default: False
        Whether files that exist are written over.
    progress : callable, optional
        Is called a few times a second with the fraction done (0 to 1), the time left in s or None, and a text;
        what it raises ends the program in order and is raised again.

    Returns
    -------
    dict
        Coefficients ``published`` and ``refit``, the ``shift`` of the speed, and what each explains, ``r2``.

    Examples
    --------
    >>> found = fit(speeds=(0.1, 1.0, 4), indentations=(1e-3, 1e-2, 4))
    >>> found["samples"], found["r2"]["refit"]["force"] > 0.9999
    (16, True)
    """
    asked = {"speeds": speeds, "indentations": indentations, "figures": figures, "force": force}
    return invocation.call(["fit", *invocation.arguments_of(asked)], progress)
