#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Compares the matrix of docs/mistakes.md with the tests, by mistakes.txt beside it.

mistakes.py ROOT            prints every breach; exit status 1 if there is one
mistakes.py ROOT --planted  plants one breach of each rule in a copy and expects it to be found

1. Each cell except a dash has a line in mistakes.txt, and each line has such a cell.
2. Each name in that line is a row or a test case of the test file named there.
3. Each status in the cell is the expected status of one of these rows.
4. Each number of a reason exists below the matrix.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

PAGE, CELLS = "docs/mistakes.md", "tests/architecture/mistakes.txt"
STATUS = re.compile(r"`(\w+)`")
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
CAUSE = re.compile(r'constexpr char (\w+)\[\] =\s*((?:"[^"]*"\s*)+);')
NAME_OF = re.compile(r'case \w+::(\w+):\s*return "([^"]*)"|::(\w+)\s*\? "([^"]*)"')


def matrix(text):
    """{(method, first word of the column): cell}"""
    table = re.search(r"\| Method \| unit.*?\n\n", text, re.S)[0].strip()
    rows = [line.strip("|").split("|") for line in table.splitlines()]
    heads = [head.strip().split()[0].strip(",") for head in rows[0]]
    return {
        (row[0].strip(), head): cell.strip()
        for row in rows[2:]
        for head, cell in list(zip(heads, row))[1:-1]
        if cell.strip() != "-"
    }


def lines_of(text):
    """{(method, column): (file, names)}"""
    found = {}
    for line in text.splitlines():
        if line and not line.startswith("#"):
            method, column, file, names = (part.strip() for part in line.split("|"))
            found[method, column] = (file, [name.strip() for name in names.split(";")])
    return found


def bodies(source, name):
    """The text of each row or test case of this name, up to its closing brace."""
    for match in re.finditer(re.escape(f'"{name}"'), source):
        before = source[: match.start()].rstrip()
        if before.endswith("TEST_CASE("):
            yield source[match.start() : (source + "\nTEST_CASE").index("\nTEST_CASE", match.end())]
        elif before.endswith("{"):
            depth, end = 1, match.end()
            while depth > 0 and end < len(source):
                depth += {"{": 1, "}": -1}.get(source[end], 0)
                end += 1
            yield source[match.start() : end]


def says(body, status, texts):
    literals = [literal for literal in LITERAL.findall(body) if len(literal) > 5]
    return (
        re.search(rf"\b{status}\b", body)
        or status.replace("_", " ") in body
        or any(literal in text for text in texts.get(status, []) for literal in literals)
    )


def breaches(root):
    page = (root / PAGE).read_text()
    cells, lines = matrix(page), lines_of((root / CELLS).read_text())
    texts = {}
    for header in (root / "include").rglob("*.hpp"):
        for a, text_a, b, text_b in NAME_OF.findall(header.read_text()):
            texts.setdefault(a or b, []).append(text_a or text_b)
        for name, text in CAUSE.findall(header.read_text()):
            texts.setdefault(name, []).append("".join(LITERAL.findall(text)))
    for key in sorted(set(cells) ^ set(lines)):
        yield f"{' | '.join(key)}: no {'line in ' + CELLS if key in cells else 'cell in ' + PAGE}"
    for key in sorted(set(cells) & set(lines)):
        file, names = lines[key]
        source = (root / f"tests/{file}.cpp").read_text()
        found = {name: list(bodies(source, name)) for name in names}
        for name in names:
            if not found[name]:
                yield f"{' | '.join(key)}: {file} has no row {name}"
        for status in STATUS.findall(cells[key]):
            if not any(says(body, status, texts) for body in sum(found.values(), [])):
                yield f"{' | '.join(key)}: no row says {status}"
        for number in re.findall(r"\((\d+)\)", cells[key]):
            if not re.search(rf"^{number}\. ", page, re.M):
                yield f"{' | '.join(key)}: no reason {number}"


PLANTED = {
    "a cell without a line": (PAGE, "| six-axis force: pressure | `no_pressure` | - |", "| six-axis force: pressure | `no_pressure` | refused |"),
    "a method without lines": (PAGE, "| rim | refused or", "| brim | refused or"),
    "a row that is not there": (CELLS, "pressure in kPa", "pressure in tons"),
    "a row that was renamed": ("tests/force/mistakes.cpp", '{"absolute pressure"', '{"pressure of all"'),
    "a status that no row says": (PAGE, "`no_pressure` (none)", "`no_load` (none)"),
    "a reason that is not there": (PAGE, "not noticeable (15)", "not noticeable (99)"),
}


def planted_are_found(root):
    good = True
    for what, (file, old, new) in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            for name in ("include", "tests", "docs"):
                shutil.copytree(root / name, copy / name, ignore=shutil.ignore_patterns("data", "*.png"))
            before = set(breaches(copy))
            path = copy / file
            text = path.read_text()
            path.write_text(text.replace(old, new))
            found = set(breaches(copy)) - before
            print(("found: " if found and old in text else "NOT FOUND: ") + what)
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
