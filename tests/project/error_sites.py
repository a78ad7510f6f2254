"""Messages of errors, found where the source raises them."""

import ast
import re
from collections.abc import Iterable, Iterator

BASE = "FlightError"


def error_classes(modules: Iterable[ast.Module]) -> dict[str, bool]:
    """Returns all error names; True for those with own message."""
    found = {BASE: False}
    classes = [node for module in modules for node in ast.walk(module) if isinstance(node, ast.ClassDef)]
    for _ in range(3):
        for node in classes:
            if {ast.unparse(base) for base in node.bases} & found.keys():
                found[node.name] = any(
                    isinstance(part, ast.FunctionDef) and part.name == "__init__" for part in node.body
                )
    return found


def message_patterns(module: ast.Module, names: set[str]) -> Iterator[tuple[int, str]]:
    """Yields line and pattern of each message in a raise statement."""
    for node in ast.walk(module):
        if not (isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call)):
            continue
        if ast.unparse(node.exc.func) not in names:
            continue
        for argument in node.exc.args:
            pattern = text_pattern(argument)
            if pattern is not None and re.search(r"[a-z]{2} [a-z]", pattern.replace("\\", "")):
                yield node.lineno, pattern


def text_pattern(node: ast.expr) -> str | None:
    """Returns the pattern of a literal text; None for other expressions."""
    match node:
        case ast.Constant(value=str() as text):
            return re.escape(text)
        case ast.JoinedStr(values=parts):
            return "".join(text_pattern(part) or ".*" for part in parts)
        case _:
            return None
