#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes what editors and type checkers read: stubs.py MODULE prints fingerpad.pyi.

Types are those of the docstrings that pybind11 makes; settings have their keywords.
"""
import importlib.util
import re
import sys


def types(text):
    text = re.sub(r"fingerpad\.|<|>", "", text)
    text = re.sub(r"numpy\.ndarray(\[[^\]]*\])?|numpy\.ndarray", "numpy.ndarray", text)
    text = re.sub(r"(Annotated\[)?list\[([\w.]+)\](, FixedSize\(\d+\)\])?", r"List[\2]", text)
    return re.sub(r"= (?![\d(.-]|None|True|False|nan)[\w.]+(\([^()]*\))?|= nan|= \S*:\s*\S+", "= ...", text)


def signature(function, name):
    first = (function.__doc__ or "").strip().split("\n")[0]
    found = re.fullmatch(rf"{name}\((.*)\) -> (.*)", first)
    return (types(found[1]), types(found[2])) if found else ("*args, **kwargs", "object")


def value_type(prop):
    found = re.search(r"-> (.*)", (prop.fget.__doc__ or "").split("\n")[0])
    return types(found[1]) if found else "object"


def stub(module):
    yield "import numpy\nfrom typing import *\n"
    for name, item in vars(module).items():
        if name.startswith("_"):
            continue
        if not isinstance(item, type):
            given, returned = signature(item, name)
            yield f"def {name}({given}) -> {returned}: ..."
            continue
        base = f"({item.__base__.__name__})" if issubclass(item, Exception) else ""
        yield f"class {name}{base}:"
        if "__members__" in vars(item):
            yield from (f"    {member}: {name}" for member in item.__members__)
        elif "__signature__" in vars(item):
            keywords = ", ".join(f"{p}=..." for p in item.__signature__.parameters)
            yield f"    def __init__(self, *, {keywords}) -> None: ..."
        elif not base:
            given, _ = signature(vars(item).get("__init__"), "__init__")
            yield f"    def __init__({re.sub(r'^self: [^,]*', 'self', given)}) -> None: ..."
        for member, value in vars(item).items():
            if isinstance(value, property) and "__members__" not in vars(item):
                yield f"    {member}: {value_type(value)}"
            elif member == "__call__" or (not member.startswith("_") and callable(value)
                                          and "__members__" not in vars(item)):
                given, returned = signature(value, member)
                yield f"    def {member}({re.sub(r'^self: [^,]*', 'self', given)}) -> {returned}: ..."
        yield "    ..."


def text_of(path):
    spec = importlib.util.spec_from_file_location("fingerpad", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return "\n".join(stub(module)) + "\n"


if __name__ == "__main__":
    print(text_of(sys.argv[1]), end="")
