#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Checks that a figure quoted in a sentence of docs/ is that of the table which it names.

figures.py ROOT            prints every figure that differs; exit status 1 if there is one
figures.py ROOT --planted  plants one mistake of each kind in a copy and expects it to be found

A figure names its cell in a comment right behind it, or behind its unit:
  72 %<!-- papers.md: share of the true force: Published -->
with the page (relative to docs/, #heading for one part of it), words of the row, and the beginning
of the column's title. Words of several cells are joined by " & "; =words are a whole cell. The
figure, or each of 1 / 2 / 3, is a number of the cell, rounded at most to its own digits, with the
cell's unit % or without.

1. The page, one row and one column exist, and the cell has the figure.
2. A paragraph whose figures with a unit have no such comment names a test or a benchmark that
   exists, as code (`tests/...`, `bench/...`, `test_NAME "case*"`), or says <!-- of no table: why -->.
3. In the table of the 36 methods each row names a header, a row of a report, and a test.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

NUMBER = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?"
MARK = re.compile(rf"({NUMBER}(?: / {NUMBER})*)((?: ?%)?)[^\d\n<>]{{0,12}}<!-- ([\w/]+\.md)(#[\w-]+)?: ([^:]+): ([^:]+?) -->")
UNIT = re.compile(rf"(?<![\w.^-])({NUMBER}) ?(?:%|mm\b|px\b|N\b|N/mm|MPa|kPa|Hz|ms|us|degrees?\b|times\b)")
SOURCE = re.compile(r"(?:\bbuild/[\w-]+/tests/)?\btest_(\w+)(?:[^`]*?\"([^\"\[*]+)\*?\")?|\b((?:tests|bench)/[\w./-]*\w)")
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
METHODS = "## The 36 methods and parts"


def slug(heading):
    return re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", heading).lower()).replace(" ", "-")


def part_of(page, anchor):
    """The lines of a page, or those below one heading of it up to the next of its level."""
    lines = page.read_text().splitlines()
    if not anchor:
        return lines
    for k, line in enumerate(lines):
        head = re.match(r"(#+) +(.*)$", line)
        if head and slug(head[2]) == anchor:
            end = next((n for n in range(k + 1, len(lines))
                        if re.match(rf"#{{1,{len(head[1])}}} ", lines[n])), len(lines))
            return lines[k:end]
    return []


def cells(line):
    return [c.strip() for c in re.split(r"(?<!\\)\|", line.strip().strip("|"))]


def tables(lines):
    """(title cells, rows) of each table."""
    for k, line in enumerate(lines):
        if re.match(r"\|[\s:|-]+\|$", line) and k > 0:
            rows = []
            for row in lines[k + 1:]:
                if not row.startswith("|"):
                    break
                rows.append(cells(row))
            yield cells(lines[k - 1]), rows


def numbers_of(cell):
    return [float(n.replace(",", "")) for n in re.findall(NUMBER, COMMENT.sub("", cell))]


def quotes(figures, cell):
    """Whether each figure is a number of the cell, rounded to its own digits."""
    def has(text):
        after = len(text.split(".")[1]) if "." in text else 0
        return any(abs(abs(float(text)) - abs(x)) <= 0.5000001 * 10 ** -after for x in numbers_of(cell))
    return all(has(figure.replace(",", "")) for figure in figures.split(" / "))


def is_in(words, row):
    words = words.strip()
    return any(c.strip("*") == words[1:] if words.startswith("=") else words in c for c in row)


def fault_of(root, figure, percent, page, anchor, row, column):
    path = root / "docs" / page
    if not path.exists():
        return f"no such page: {page}"
    found = []
    for head, rows in tables(part_of(path, anchor and anchor[1:])):
        at = [k for k, title in enumerate(head) if title.strip("*").startswith(column)]
        for r in rows:
            if at and all(is_in(w, r) for w in row.split(" & ")):
                found.append(r[at[0]])
    if len(found) != 1:
        return f"{len(found)} rows with {row!r} and a column {column!r} in {page}"
    if not quotes(figure, found[0]) or (percent and "%" not in found[0]):
        return f"the table has {found[0]!r}"
    return None


def paragraphs(text):
    """Running text: no tables, headings, titles of tables, code, or lists of links."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for block in re.split(r"\n\s*\n|\n(?=[-*] |\d+\. )", text):
        if not block.lstrip().startswith(("|", "#", "<!--")) and not re.fullmatch(r"\*\*.*\*\*", block):
            yield block


def differences(root):
    for page in sorted(root.glob("docs/**/*.md")):
        name, text = page.relative_to(root), page.read_text()
        for m in MARK.finditer(text):
            fault = fault_of(root, m[1], m[2], m[3], m[4], m[5], m[6])
            if fault:
                yield f"{name}: {m[1]}{m[2]}: {fault}"
        marks = len(re.findall(r"<!-- [\w/]+\.md(?:#[\w-]+)?: ", text))
        if marks != len(MARK.findall(text)):
            yield f"{name}: {marks - len(MARK.findall(text))} comments have no figure before them"
        for block in paragraphs(text) if page.name != "CHANGELOG.md" else ():
            sources = list(SOURCE.finditer(" ".join(" ".join(re.findall(r"`[^`]+`", block)).split())))
            for source in sources:
                if not exists(root, source):
                    yield f"{name}: no such test or benchmark: {source[0]}"
            if "<!-- of no table:" not in block and not sources:
                for m in UNIT.finditer(COMMENT.sub("", MARK.sub("", block))):
                    yield f"{name}: no table is named for {m[0]}: {' '.join(block.split())[:60]}"
    yield from gaps(root)


def exists(root, source):
    """Whether there is a file, a program of bench/, or a test case of that name."""
    program, case, file = source.groups()
    if file:
        name, folder = Path(file).name, root / Path(file).parent
        return bool(list(root.glob(file + "*"))) or \
            any(name in f.read_text() for f in folder.glob("CMakeLists.txt")) or \
            any(f.stem in name for f in folder.rglob("*.cpp"))
    files = list((root / "tests" / program).glob("*.cpp"))
    return bool(files) and (not case or any(f'"{case}' in f.read_text() for f in files))


def gaps(root):
    """What a row of the 36 methods lacks."""
    page = root / "docs/papers.md"
    lines = part_of(page, slug(METHODS[3:]))
    rows = [r for _, found in tables(lines) for r in found]
    if len(rows) != 36:
        yield f"docs/papers.md: {len(rows)} methods, not 36"
    for r in rows:
        for header in re.findall(r"`([\w/]+\.hpp)`", r[2]):
            if not (root / "include/fingerpad" / header).exists():
                yield f"docs/papers.md: {r[0]}: no header {header}"
        for where, label in re.findall(r"\[\w[^\]]*\]\((\S+?)\) \"([^\"]+)\"", r[4]):
            path, _, anchor = where.partition("#")
            in_page = part_of(root / "docs" / path if path else page, anchor)
            if not any(label in c.strip("*") for _, found in tables(in_page) for row in found
                       for c in row[:2]):
                yield f"docs/papers.md: {r[0]}: no row {label!r} in {where}"
        if not (re.search(r"`[\w/]+\.hpp`", r[2]) and "](" in r[4] and "](" in r[5]):
            yield f"docs/papers.md: {r[0]}: a header, a row or a test is missing"


PLANTED = {
    "another figure": ("docs/papers.md", "\n73 %<!-- papers.md: share of the true force along the plate: Published -->\n"),
    "no such row": ("docs/faq.md", "\n1 %<!-- papers.md: no such row: Published -->\n"),
    "no such page": ("docs/faq.md", "\n1 %<!-- no_such_page.md: a: b -->\n"),
    "no table named": ("docs/papers.md", "\nIt is 12 % better.\n"),
    "no such test": ("docs/faq.md", "\nIt is 12 % better (`tests/no_such_test.cpp`).\n"),
    "no such case": ("docs/faq.md", "\nIt is 12 % better (`test_force \"no such case*\"`).\n"),
    "no figure": ("docs/faq.md", "\nnone<!-- papers.md: share of the true M_z: Published -->\n"),
}


def expect_planted(root):
    for kind, (name, plant) in PLANTED.items():
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder)
            for folder in ("include", "tests", "bench"):
                (copy / folder).symlink_to(root / folder)
            shutil.copytree(root / "docs", copy / "docs", ignore=shutil.ignore_patterns("*.png", "*.jpg"))
            file = copy / name
            file.write_text(file.read_text() + plant)
            if not any(name in found for found in differences(copy)):
                sys.exit(f"not found: {kind} in {name}")


if __name__ == "__main__":
    checkout = Path(sys.argv[1]).resolve()
    if "--planted" in sys.argv:
        expect_planted(checkout)
    else:
        found = list(differences(checkout))
        print("\n".join(found) or "no difference")
        sys.exit(1 if found else 0)
