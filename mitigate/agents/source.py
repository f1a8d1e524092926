"""Inspect the user's code: its classes and functions, its source files, and the names it uses."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import sys
import sysconfig
import types
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from mitigate.core.contracts import read


def is_users(code: Any) -> bool:
    """Return whether a class or function belongs to the user.

    The code of this project, torch, Python and installed packages is identified by version numbers.
    """
    function = isinstance(code, types.FunctionType)
    name = code.__module__ or ""
    return _is_users(name, code.__code__.co_filename if function else _file(name))


@cache
def _is_users(module: str, file: str) -> bool:
    path = Path(file)
    package = module.partition(".")[0]
    shipped = package in ({"mitigate", "torch"} | sys.stdlib_module_names) - {"__main__"}
    installed = {"site-packages", "dist-packages"} & {*path.parts}
    return not (shipped or installed or path.is_relative_to(sysconfig.get_path("stdlib")))


def named_values(function: types.FunctionType) -> dict[str, Any]:
    """Return the values of the global variables and closure variables that ``function`` uses.

    If ``function`` uses attributes of the user's modules, their values are included.
    """
    codes = [function.__code__]
    for code in codes:
        codes += [part for part in code.co_consts if isinstance(part, types.CodeType)]
    names = sorted({name for code in codes for name in code.co_names})
    values: dict[str, Any] = {}
    scopes = [function.__globals__]
    for scope in scopes:
        in_scope = {name: scope[name] for name in names if name in scope}
        modules = [part for part in in_scope.values() if isinstance(part, types.ModuleType)]
        scopes += [vars(m) for m in modules if _is_users(m.__name__, _file(m.__name__))]
        values = in_scope | values
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        with suppress(ValueError):  # the cell is empty
            values[name] = cell.cell_contents
    return values


def source_files(modules: list[str]) -> dict[str, str | None]:
    """Return the source code of the user's modules among ``modules`` and their imports.

    Comments and layout are left out. The source is None for a module without Python source, such as
    a notebook.
    """
    sources: dict[str, str | None] = {}
    waiting = [*modules]
    for name in waiting:
        file = _file(name)
        if name not in sources and _is_users(name, file):
            sources[name], imports = _read(file, name, sys.modules.get(name))
            for imported in imports:
                package = imported.partition(".")[0]  # search only the user's packages
                if _is_users(package, _file(package)) and _file(imported):
                    waiting.append(imported)
    return sources


def _file(module: str) -> str:
    """Return the path of a module's file, or "" if there is no such module or file."""
    if module in sys.modules:
        return read(sys.modules[module], "__file__") or ""
    with suppress(Exception):  # find_spec runs the user's code, which may raise any error
        spec = importlib.util.find_spec(module)
        return (spec.origin or "") if spec else ""
    return ""


@cache
def _read(file: str, name: str, module: Any) -> tuple[str | None, list[str]]:
    """Return the source of a module without comments and layout, and the names that it imports."""
    # cached, because a later edit of the file does not change the loaded ``module``
    try:
        tree = ast.parse(Path(file).read_bytes(), file)
    except (OSError, SyntaxError, ValueError):  # there is no file, or it is not Python
        return None, []
    package = name if Path(file).stem == "__init__" else name.rpartition(".")[0]
    imports: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imports += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            imports += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return ast.unparse(tree), imports


def methods(kind: type) -> dict[str, types.FunctionType]:
    """Return the functions that a class defines, by name and without their decorators."""
    output = {}
    for name, member in vars(kind).items():
        function = read(member, "__func__", "fget", "__wrapped__", default=member)
        function = inspect.unwrap(function) if callable(function) else function
        if isinstance(function, types.FunctionType):
            output[name] = function
    return output
