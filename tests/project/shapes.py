"""Pytest plugin that checks array shapes in all shipped packages.

jaxtyping's own import hook decorates every method with beartype, which refuses `Self`, and checks what mypy
has checked. Here functions and dataclasses are decorated that take or return arrays, and of their annotations
only those of arrays are checked.
"""

import sys
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cached_property, wraps
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from inspect import isgeneratorfunction
from types import FunctionType, ModuleType
from typing import Any, get_args, get_type_hints

from beartype import BeartypeConf, beartype
from jaxtyping import AbstractArray, jaxtyped

from tests.support.packages import SHIPPED

# An int is a float where both a number and an array may be given.
_beartype = beartype(conf=BeartypeConf(is_pep484_tower=True))
_one_size = jaxtyped("context")
_calls: Counter[Callable[..., Any]] = Counter()
MOST_CALLS = 1000
"""Calls of a function that are checked in each test; small values are made by the ten thousand."""


def pytest_load_initial_conftests() -> None:
    """Checks shapes in packages imported from now on."""
    assert not set(SHIPPED) & sys.modules.keys(), "imported already"
    sys.meta_path.insert(0, _Finder())


def pytest_runtest_setup() -> None:
    """Counts calls anew in each test."""
    _calls.clear()


class _Finder(MetaPathFinder):
    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname.partition(".")[0] not in SHIPPED:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


class _Loader(SourceFileLoader):
    def exec_module(self, module: ModuleType) -> None:
        super().exec_module(module)
        for name, value in list(vars(module).items()):
            if getattr(value, "__module__", None) != module.__name__:
                continue
            if isinstance(value, type):
                for attribute, member in list(vars(value).items()):
                    _replace(value, attribute, member)
            else:
                _replace(module, name, value)


def _replace(owner: type | ModuleType, name: str, member: object) -> None:
    match member:
        case FunctionType():
            found: object = checked(member)
        case classmethod() | staticmethod():
            found = type(member)(checked(member.__func__))
        case property(fget=FunctionType() as getter, fset=None):
            found = property(checked(getter))
        case cached_property():
            member.func = checked(member.func)
            return
        case _:
            return
    setattr(owner, name, found)


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a function that checks the shapes of its arrays, or the function where there are none."""
    stated = function.__annotations__
    try:
        hints = get_type_hints(function, include_extras=True)
    except (NameError, TypeError):  # a name imported, or a parameter given, for mypy alone
        hints = stated
    arrays = {name: hint for name, hint in hints.items() if _holds_array(hint)}
    if not arrays:
        return function
    function.__annotations__ = arrays
    if isgeneratorfunction(function):
        checking: Callable[..., Any] = jaxtyped(function, typechecker=_beartype)
    else:
        checking = _with_one_size(function, _beartype(function))
    function.__annotations__ = checking.__annotations__ = stated
    return checking


def _with_one_size(function: Callable[..., Any], checking: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a function in each call of which a dimension has one size.

    `jaxtyped` with a checker does the same and checks arguments twice.
    """

    @wraps(function)
    def wrapped(*args: object, **kwargs: object) -> object:
        _calls[function] += 1
        if _calls[function] > MOST_CALLS:
            return function(*args, **kwargs)
        with _one_size:
            return checking(*args, **kwargs)

    return wrapped


def _holds_array(hint: object) -> bool:
    if isinstance(hint, type) and issubclass(hint, AbstractArray):
        return hint.dim_str != "..."  # an array of any shape, of which there is nothing to check
    return any(_holds_array(part) for part in get_args(hint))
