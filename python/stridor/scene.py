"""Scenes: a file, and what is set of it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal, Mapping, Union

from . import errors, invocation

Place = Union[str, "os.PathLike[str]"]
#: Keys of scenes and their values.
Settings = Mapping[str, Any]
#: A number in SI units, or a text with a unit, "70 mm".
Quantity = Union[float, str]
#: Geometry about which a system is linearised.
About = Literal["undeformed", "deformed"]
#: Values at equal distances or at equal ratios.
Spacing = Literal["linear", "log"]


class Scene:
    """A scene file with settings on top; the file itself is never changed.

    Parameters
    ----------
    path : path
        A scene, YAML.
    settings : mapping, optional
        Values of keys, as `set` takes them.

    Attributes
    ----------
    path : str
        Path of the scene file.
    settings : dict
        Keys that are set, with their values.

    Examples
    --------
    >>> scene = load(example("frozen_growth"))
    >>> scene.set("contact.friction.coefficient", 0.2).settings
    {'contact.friction.coefficient': 0.2}
    >>> scene.check()
    []
    >>> [problem.key for problem in scene.with_settings({"contct.start": 0.03}).check()]
    ['contct']
    """

    def __init__(self, path: Place, settings: Mapping[str, Any] | None = None):
        self.path = os.fspath(path)
        self.settings: dict[str, Any] = dict(settings or {})

    def set(self, key: str, value: Any) -> "Scene":
        """Sets a key for all that follows.

        Parameters
        ----------
        key : str
            Path of the key, "contact.friction.coefficient".
        value : number, str, bool, list, mapping or None
            Numbers are in SI units, texts may carry a unit.

        Returns
        -------
        Scene
            This scene, so that calls may follow one another.
        """
        self.settings[key] = value
        return self

    def with_settings(self, settings: Mapping[str, Any] | None) -> "Scene":
        """The same scene with more settings; this one stays as it is.

        Parameters
        ----------
        settings : mapping or None
            Keys and their values, as `set` takes them.

        Returns
        -------
        Scene
        """
        return Scene(self.path, {**self.settings, **(settings or {})})

    def check(self) -> list[errors.Problem]:
        """All that is wrong with the scene; `stridor.check` says also what is hardly meant.

        Returns
        -------
        list of Problem
            Empty where nothing is wrong.
        """
        try:
            invocation.call(["check", *self.words()])
        except errors.ConfigError as error:
            return error.problems
        return []

    def words(self) -> list[str]:
        """Arguments of the command line that say the scene.

        Returns
        -------
        list of str
            Its path, then ``--set`` and ``key=value`` for each setting.
        """
        words = [self.path]
        for key, value in self.settings.items():
            words += ["--set", invocation.setting(key, value)]
        return words

    def __repr__(self) -> str:
        return f"Scene({self.path!r}, {self.settings!r})"


def load(path: Place) -> Scene:
    """A scene file.

    Parameters
    ----------
    path : path
        Path of the file (YAML), which is read when a verb takes the scene.

    Returns
    -------
    Scene

    Raises
    ------
    FileError
        If there is none.

    Examples
    --------
    >>> scene = load(example("mass_on_belt"))
    >>> eig(scene, set={"parameters.mu_s": 0.3}).stable
    True
    """
    if not Path(path).is_file():
        raise errors.FileError([errors.Problem("is not there", file=os.fspath(path))])
    return Scene(path)


def example(name: str) -> str:
    """The path of a scene that comes with the program.

    Parameters
    ----------
    name : str
        Name of its file without the ending, "ruler" or "beam_on_beam".

    Returns
    -------
    str
        Path of the file (YAML).

    Raises
    ------
    FileError
        If there is none of that name.

    Examples
    --------
    >>> import os
    >>> os.path.basename(example("ruler"))
    'ruler.yaml'
    """
    for folder in _scene_folders():
        for path in (folder / f"{name}.yaml", folder / "examples" / f"{name}.yaml"):
            if path.is_file():
                return str(path)
    raise errors.FileError([errors.Problem("there is no such scene", file=f"{name}.yaml")])


def _scene_folders() -> list[Path]:
    executable = Path(invocation.program()).resolve()
    return [Path(__file__).resolve().parents[2] / "scenes",
            executable.parent / "../share/stridor/scenes", executable.parent / "../../scenes"]


def as_scene(scene: Scene | Place, settings: Mapping[str, Any] | None = None) -> Scene:
    """A scene, or the path of one, with more settings."""
    if not isinstance(scene, Scene):
        scene = load(scene)
    return scene.with_settings(settings)
