#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Checks the rules of the folders of include/ on the sources.

rooms.py ROOT            prints every breach; exit status 1 if there is one
rooms.py ROOT --planted  plants one breach of each rule in a copy and expects it to be found

1. A folder includes only folders below it, and no subject includes another subject. What is printed
   and what simulates stand alone: they include core/ and math/ only.
2. A file in a detail/ folder declares nothing outside of a detail namespace.
3. No file outside of include/ includes a file of a detail/ folder.
4. No file includes itself through others.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

VOCABULARY = ["core", "math", "optics", "image", "membrane"]  # each may include those before it
SUBJECTS = ["depth", "contact", "dots", "motion", "slip", "gel", "force", "foam"]
ABOVE = ["calibrate", "pipeline"]  # the subjects
ALONE = ["published", "sim"]
ALLOWED = {room: set(VOCABULARY[: k + 1]) for k, room in enumerate(VOCABULARY)}
ALLOWED |= {room: {*VOCABULARY, room} for room in SUBJECTS}
ALLOWED |= {room: {*VOCABULARY, *SUBJECTS, room} for room in ABOVE}
ALLOWED |= {room: {"core", "math", room} for room in ALONE}
ALLOWED["adapt"] = {*VOCABULARY, "adapt"}

INCLUDE = re.compile(r'^\s*#\s*include\s*["<]fingerpad/([^">]+)[">]', re.MULTILINE)
COMMENT_OR_STRING = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)
DIRECTIVE = re.compile(r"^\s*#(?:[^\n]*\\\n)*[^\n]*$", re.MULTILINE)
NAMESPACE = re.compile(r"\bnamespace\s+([\w:]+)\s*$|\bnamespace\s*$")


def includes(text):
    return INCLUDE.findall(text)


def declared_outside_detail(text):
    """The beginnings of declarations outside of a detail namespace."""
    text = DIRECTIVE.sub("", COMMENT_OR_STRING.sub(" ", text))
    open_braces, head, found = [], "", []

    def in_namespaces():
        return all(name is not None for name in open_braces)

    def note():
        names = "::".join(name for name in open_braces if name)
        if head.strip() and in_namespaces() and "detail" not in names.split("::"):
            found.append(" ".join(head.split())[:60])

    for character in text:
        if character == "{":
            namespace = NAMESPACE.search(head)
            if not namespace:
                note()
            open_braces.append((namespace[1] or "") if namespace else None)
        elif character == "}":
            open_braces.pop()
        elif character == ";":
            note()
        else:
            head += character
            continue
        head = ""
    return found


def cycles(graph):
    """Each include cycle once, as its list of files."""
    state, found = {}, []

    def visit(file, path):
        state[file] = "open"
        for other in graph.get(file, []):
            if state.get(other) == "open":
                found.append(path[path.index(other) :] + [other])
            elif other not in state:
                visit(other, path + [other])
        state[file] = "done"

    for file in graph:
        if file not in state:
            visit(file, [file])
    return found


def breaches(root):
    base = root / "include" / "fingerpad"
    texts = {str(p.relative_to(base)): p.read_text() for p in sorted(base.rglob("*.hpp"))}
    for file, text in texts.items():
        room = Path(file).parts[0]
        if "/" in file:
            if room not in ALLOWED:
                yield f"include/fingerpad/{file}: no such room as {room}/"
                continue
            for other in includes(text):
                if Path(other).parts[0] not in ALLOWED[room]:
                    yield f"include/fingerpad/{file} includes {other}"
        if "/detail/" in file:
            for declaration in declared_outside_detail(text):
                yield f"include/fingerpad/{file} declares outside of detail: {declaration}"
    for cycle in cycles({file: includes(text) for file, text in texts.items()}):
        yield "include cycle: " + " -> ".join(cycle)
    for folder in ("tests", "bench", "examples", "docs"):
        for path in sorted((root / folder).rglob("*.[hc]pp")):
            for other in includes(path.read_text()):
                if "/detail/" in other:
                    yield f"{path.relative_to(root)} includes {other}"


PLANTED = {
    "a subject that includes another": (
        "include/fingerpad/depth/depth.hpp",
        '#include "fingerpad/contact/contact_region.hpp"\n',
    ),
    "vocabulary that includes a subject": (
        "include/fingerpad/core/grid.hpp",
        '#include "fingerpad/depth/depth.hpp"\n',
    ),
    "a subject that includes a published form": (
        "include/fingerpad/slip/stick_ratio.hpp",
        '#include "fingerpad/published/stick_ratio.hpp"\n',
    ),
    "a printed form that includes a default one": (
        "include/fingerpad/published/stick_ratio.hpp",
        '#include "fingerpad/slip/stick_ratio.hpp"\n',
    ),
    "a public type in a detail file": (
        "include/fingerpad/depth/detail/planted.hpp",
        "namespace fingerpad { inline namespace v1 { struct Planted { int x = 0; }; } }\n",
    ),
    "a public function in a detail file": (
        "include/fingerpad/depth/detail/planted.hpp",
        "namespace fingerpad { inline namespace v1 { inline int planted() { return 0; } } }\n",
    ),
    "a test that includes a detail file": (
        "tests/planted.cpp",
        '#include "fingerpad/image/detail/lanes.hpp"\n',
    ),
    "an include cycle": (
        "include/fingerpad/core/scalar.hpp",
        '#include "fingerpad/core/grid.hpp"\n#include "fingerpad/core/check.hpp"\n',
    ),
}


def planted_are_found(root):
    good = True
    for what, (file, text) in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            for name in ("include", "tests", "bench", "examples"):
                shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("data"))
            before = set(breaches(copy))
            path = copy / file
            path.write_text(text + (path.read_text() if path.exists() else ""))
            found = set(breaches(copy)) - before
            print(("found: " if found else "NOT FOUND: ") + what)
            good = good and bool(found)
    return good


def main():
    root = Path(sys.argv[1])
    if sys.argv[2:] == ["--planted"]:
        return 0 if planted_are_found(root) else 1
    found = list(breaches(root))
    print("\n".join(found) or "no breach")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
