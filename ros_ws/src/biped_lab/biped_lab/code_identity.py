"""What code a run is made by: a hash that changes when a walk could.

It covers the modules that are imported from given ones on, as far as they are the
project's own or of the given ones' packages, such as a user's learner: their syntax
trees, without comments, docstrings and layout. The packages of others that these import
count with their versions.
"""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterator
from functools import cache
from importlib.metadata import packages_distributions, version
from importlib.util import find_spec
from typing import NamedTuple

_OWN = (
    "biped_common", "biped_description", "msgs_json", "trajectory_node", "sim_node",
    "learner_node", "biped_bringup", "biped_lab",
)  # fmt: skip


class CodeIdentity(NamedTuple):
    """What decides, besides settings and seed, how a run goes."""

    code: str
    """Hash of the project's modules, 16 hexadecimal digits."""
    packages: dict[str, str]
    """Versions of others' packages, Python's among them."""


class _Module(NamedTuple):
    """What counts of a module."""

    text: str
    """Its syntax tree."""
    imports: tuple[str, ...]
    """What may be modules among the names that it imports."""


@cache
def code_identity(*modules: str) -> CodeIdentity:
    """Return the identity of some modules and all that they import."""
    own = frozenset((*_OWN, *(name.partition(".")[0] for name in modules)))
    found: dict[str, str] = {}
    others: set[str] = set()
    pending = list(modules)
    while pending:
        name = pending.pop()
        if name in found:
            continue
        top = name.partition(".")[0]
        if top not in own:
            others.add(top)
            continue
        module = _module(name, own)
        if module is not None:
            found[name] = module.text
            pending += module.imports
            pending += _packages_above(name)
    digest = hashlib.sha256()
    for name in sorted(found):
        digest.update(f"{name}\n{found[name]}\n".encode())
    return CodeIdentity(digest.hexdigest()[:16], _versions(others))


@cache
def _module(name: str, own: frozenset[str]) -> _Module | None:
    """Return what counts of a module; None where the name is no module's."""
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        return None
    with open(spec.origin, "rb") as file:
        tree = ast.parse(file.read())
    imports = tuple(_imported(tree, own))
    return _Module(ast.dump(_bare(tree)), imports)


def _imported(tree: ast.Module, own: frozenset[str]) -> Iterator[str]:
    """Yield what may be modules among the names that are imported."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield node.module
            if node.module.partition(".")[0] in own:
                for alias in node.names:
                    name = f"{node.module}.{alias.name}"
                    if _is_module(name):
                        yield name


def _is_module(name: str) -> bool:
    try:
        return find_spec(name) is not None
    except ModuleNotFoundError:  # its parent is no package
        return False


def _packages_above(name: str) -> list[str]:
    parts = name.split(".")[:-1]
    return [".".join(parts[: n + 1]) for n in range(len(parts))]


def _bare(tree: ast.Module) -> ast.Module:
    """Take the docstrings out of a syntax tree; it holds no comments."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [  # type: ignore[attr-defined]
                statement
                for statement in body
                if not (
                    isinstance(statement, ast.Expr)
                    and isinstance(statement.value, ast.Constant)
                    and isinstance(statement.value.value, str)
                )
            ]
    return tree


_packages_of_modules = cache(packages_distributions)


def _versions(modules: set[str]) -> dict[str, str]:
    of_module = _packages_of_modules()
    names = {
        package
        for module in modules - sys.stdlib_module_names
        for package in of_module.get(module, ())
    }
    found = {name: version(name) for name in sorted(names)}
    return {"python": ".".join(map(str, sys.version_info[:3])), **found}
