#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Checks that every public class is in docs/classes.md, and that its page is complete.

classes.py ROOT            prints what is missing; exit status 1 if anything is
classes.py ROOT --planted  plants one gap of each kind in a copy and expects it to be found

1. A class of a room that computes is a row of the table, or one of the parts below it.
2. A row has no empty cell, and its class and the types that it names exist.
3. Each field of a parameter and each value of a status has a comment.
4. The class's page, as the site writes it, has text under each heading.
5. The same holds for each printed form in docs/papers.md, which includes each class of published/.
"""
import importlib.util
import re
import shutil
import sys
import tempfile
from pathlib import Path

ROOMS = ["depth", "contact", "dots", "motion", "slip", "gel", "force", "foam", "calibrate", "pipeline", "sim", "adapt"]
CLASS = re.compile(r"^class (\w+)\b[^;]*\{", re.MULTILINE)
FIELD = re.compile(r"^  (?!using |static |friend )(\w[\w:<>, ]*) \w+(?: = [^;]*)?;(.*)$")
VALUE = re.compile(r"^  ()(?!ok,|none,)\w+(?: = \w+)?,(.*)$")  # these need no comment


def site_of(root):
    spec = importlib.util.spec_from_file_location("reference", root / "docs/site/reference.py")
    site = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(site)
    return site


def body_of(name, header):
    """The lines between the braces of a struct or enumeration."""
    text = re.search(rf"^(?:struct|enum class)[^;{{]*? {name}\b[^;{{]*\{{\n(.*?)^\}};", header.read_text(),
                     re.MULTILINE | re.DOTALL)
    return text[1].splitlines() if text else []


def bare(name, wanted, site, root):
    """Fields or values without a comment behind, above or below. The previous one may have the
    comment if its type is the same; a field of the library's type has the comments of that type."""
    before = None
    lines = body_of(name, site.header_of(name, root))
    for k, line in enumerate(lines):
        found = wanted.match(line)
        if not found:
            continue
        near = [found[2], *(lines[j].strip()[:4] for j in (k - 1, k + 1) if 0 <= j < len(lines))]
        ours = site.header_of(re.match(r"\w*", found[1])[0], root) if found[1] else None
        if "//" in near[0] or near[1].startswith("//") or "///<" in near[1:]:
            before = found[1]
        elif not ours and (not before or before != found[1]):
            yield line.strip()


def gaps(root):
    site = site_of(root)
    rows = dict(site.classes(root))
    page = (root / "docs/classes.md").read_text()
    parts = re.findall(r"^\| `(\w+)` \| [^|]+ \|$", page, re.MULTILINE)
    for room in ROOMS:
        for header in sorted((root / "include/fingerpad" / room).glob("*.hpp")):
            text = header.read_text()
            for name in CLASS.findall(text):
                if name not in rows and name not in parts and not in_detail(text, name):
                    yield f"no row for {name} of {header.relative_to(root)}"
    for name in parts:
        if not site.header_of(name, root):
            yield f"no such class: {name}"
    for name, row in rows.items():
        missing = [n for n in [name, *re.findall(r"`(\w+)`", row["Parameters"] + row["Result and statuses"])]
                   if not site.header_of(n, root)]
        if missing or not all(row.values()):
            yield f"{name}: " + (f"no such type: {missing[0]}" if missing else "an empty cell")
            continue
        for parameter in re.findall(r"`(\w+)`", row["Parameters"]):
            for line in bare(parameter, FIELD, site, root):
                yield f"{parameter}: no unit, range or meaning of: {line}"
        for result in re.findall(r"`(\w+Status|\w+Reason|\w+Phase|\w+Evidence|DotState)`", row["Result and statuses"]):
            for line in bare(result, VALUE, site, root):
                yield f"{result}: no meaning of: {line}"
        yield from empty_headings(site.class_page(name, row, root), name, site)
    forms = site.printed_forms(root)
    for header in sorted((root / "include/fingerpad/published").glob("*.hpp")):
        for name in CLASS.findall(header.read_text()):
            if name not in forms:
                yield f"no printed form in docs/papers.md: {name} of {header.relative_to(root)}"
    for name, rows in forms.items():
        if site.declaration_of(name, root):
            yield from empty_headings(site.printed_page(name, rows, root), f"published::{name}", site)
        else:
            yield f"docs/papers.md: no such printed form: {name}"


def empty_headings(page, name, site):
    for heading in site.HEADINGS:
        under = re.search(rf"^## {heading}\n\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL)
        if not under or not under[1].strip():
            yield f"the page of {name} has nothing under: {heading}"


def in_detail(text, name):
    """Whether a class of a public header is in a detail namespace."""
    before = text[: re.search(rf"^class {name}\b[^;]*\{{", text, re.MULTILINE).start()]
    return len(re.findall(r"\nnamespace detail\b", before)) > before.count("\n}  // namespace detail")


PLANTED = {
    "a class without a row": ("include/fingerpad/slip/stick_ratio.hpp", "\nclass Planted {\n};\n"),
    "a row of a class that is not there": ("docs/classes.md",
        "\n| `Planted` | it | [a](depth/depth.md) | `Camera` | `DepthResult` | [a](a.md) | [a](a.md) | [a](a.md) |\n"),
    "a row with an empty cell": ("docs/classes.md",
        "\n| `Wrench` |  | [a](depth/depth.md) | `Camera` | `DepthResult` | [a](a.md) | [a](a.md) | [a](a.md) |\n"),
    "a printed form that is not there": ("docs/papers.md",
        '\n| Z9 | it | `published::Planted` | that | row | [a](../tests/published/segment_equilibrium.cpp) "a" |\n'),
    "a printed class without a row": ("include/fingerpad/published/segment_equilibrium.hpp", "\nclass Planted {\n};\n"),
    "a field without a comment": ("docs/classes.md", None),
}


def planted_are_found(root):
    good = True
    before = set(gaps(root))
    for what, (file, text) in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            (copy / "tests").symlink_to(root / "tests")
            for name in ("include", "docs/site"):
                shutil.copytree(root / name, copy / name)
            for name in ("classes.md", "papers.md"):
                shutil.copy(root / "docs" / name, copy / "docs")
            if text is None:
                header = copy / "include/fingerpad/slip/grip_control.hpp"
                header.write_text(header.read_text().replace("struct GripOptions {\n", "struct GripOptions {\n  S planted = S(1);\n\n"))
            else:
                (copy / file).write_text((copy / file).read_text() + text)
            found = set(gaps(copy)) - before
            print(("found: " if found else "NOT FOUND: ") + what)
            good = good and bool(found)
    return good


if __name__ == "__main__":
    checkout = Path(sys.argv[1]).resolve()
    if "--planted" in sys.argv:
        sys.exit(0 if planted_are_found(checkout) else 1)
    found = list(gaps(checkout))
    print("\n".join(found) or "no gap")
    sys.exit(1 if found else 0)
