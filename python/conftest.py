"""The examples of docstrings begin after ``from stridor import *``: ``pytest --doctest-modules python/stridor``."""

import pytest

import stridor


@pytest.fixture(autouse=True)
def public_names(doctest_namespace):
    doctest_namespace.update({name: getattr(stridor, name) for name in dir(stridor) if not name.startswith("_")})
