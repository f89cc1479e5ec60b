"""Entry points of the installed packages, without importlib.metadata.

That takes 20 ms to import and 5 ms more for each group among 180 packages, as long as
all else that `ros2` does when the shell asks for the names of its verbs. What it reads
is simple: lines of `name = module:attribute` below a line with the group in brackets.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from glob import escape, glob
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple


class EntryPoint(NamedTuple):
    """A name under which a package offers an object to others."""

    name: str
    module: str
    attribute: str
    """Dotted; empty where the module itself is offered."""
    package: str

    def docstring(self) -> str:
        """Return the module's docstring from its source, without running the module."""
        import ast  # here, for only a list of verbs needs it

        spec = find_spec(self.module)
        if spec is None:
            raise ModuleNotFoundError(f"No module named '{self.module}'")
        loader: Any = spec.loader
        source = loader.get_source(self.module)
        tree = ast.parse(source or "")
        return ast.get_docstring(tree, clean=False) or ""

    def load(self) -> Any:
        """Import the module; return the object."""
        loaded: Any = import_module(self.module)
        for name in filter(None, self.attribute.split(".")):
            loaded = getattr(loaded, name)
        return loaded


def entry_points(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by name; as with modules, the first counts."""
    found: dict[str, EntryPoint] = {}
    for folder in sys.path:
        # A wheel's *.dist-info or, from setuptools, *.egg-info.
        pattern = os.path.join(escape(folder), "*-info", "entry_points.txt")
        for file in sorted(glob(pattern)):
            for point in _points_of(Path(file), group):
                found.setdefault(point.name, point)
    return found


def _points_of(file: Path, group: str) -> Iterator[EntryPoint]:
    text = file.read_text(encoding="utf-8", errors="replace")
    heading = f"[{group}]"
    if heading not in text:
        return
    package = file.parent.stem.partition("-")[0]
    inside = False
    for line in text.splitlines():
        name, separator, value = (part.strip() for part in line.partition("="))
        if name.startswith("["):
            inside = name == heading
        elif inside and separator:
            target = value.partition("[")[0]  # behind it stand extras
            module, _, attribute = (part.strip() for part in target.partition(":"))
            yield EntryPoint(name, module, attribute, package)
