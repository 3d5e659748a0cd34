#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Checks that targets named in pages and comments exist.

links.py ROOT            prints every dead end; exit status 1 if there is one
links.py ROOT --planted  plants one dead end of each kind in a copy and expects it to be found

1. A link of a page leads to a file, and its #anchor to a heading.
2. A path named in a page or in a header's comment exists, except for those of a recording and for
   those with a part in capitals, which are placeholders.
3. A block of code below <!-- PATH --> is in that file, line by line.
4. A test file whose link is followed by a "name" has a test of this name.
5. A test program of a command exists, and has a test or a tag that its filter selects; so has
   bench/report/run its benchmark.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*)$", re.MULTILINE)
BLOCK = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r"^<!-- (\S+) -->\n```\w*\n(.*?)^```", re.MULTILINE | re.DOTALL)
PATH = re.compile(r"(?<![\w/.<>{}*-])((?:[\w.-]+/)+[\w.-]+\.(?:hpp|cpp|py|md|png|csv|cmake))\b")
OF_A_RECORDING = ("frames", "pictures", "membrane")
TEST = re.compile(r"\]\(([^)\s]*tests/[^)\s]*\.cpp)\)\s+\"([^\"]+)\"")
COMMAND = re.compile(r'\btest_(\w+) "([^"]+)"')
BENCHMARKS = re.compile(r"bench/report/run((?: +[a-z_]+)+)")
NO_PROGRAMS = ("instructions",)  # of bench/report/run
COMMENT = re.compile(r"//[^\n]*")


def anchors(page):
    """Anchors of GitHub for the headings of a page."""
    text = re.sub(r"[`*]|\[|\]\([^)]*\)", "", "\n".join(HEADING.findall(BLOCK.sub("", page))))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in text.split("\n")}


def dead_links(root, file, page):
    for link in LINK.findall(BLOCK.sub("", page)):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (file.parent / path).resolve() if path else file
        if not target.exists():
            yield f"no such file: {link}"
        elif anchor and anchor not in anchors(target.read_text()):
            yield f"no such heading: {link}"


def dead_paths(root, file, text):
    for path in PATH.findall(text):
        if path.split("/")[0] in OF_A_RECORDING or re.search(r"\b[A-Z]{3,}\b", path):
            continue
        places = [root, root / "include", root / "include/fingerpad", root / "examples", root / "tests",
                  root / "docs", file.parent, *(root / "examples").iterdir(), *(root / "examples/programs").iterdir()]
        if not any((place / path).exists() for place in places):
            yield f"no such file: {path}"


def false_quotes(root, page):
    for path, block in QUOTED.findall(page):
        source = [line.strip() for line in (root / path).read_text().splitlines()]
        wanted = [line.strip() for line in block.splitlines() if line.strip() not in ("", "...")]
        rest = iter(source)
        missing = next((line for line in wanted if line not in rest), None)
        if missing:
            yield f"not in {path}, or not in this order: {missing}"


def missing_tests(file, page):
    for path, name in TEST.findall(page):
        test = file.parent / path
        tests = re.sub(r'"\s*\n\s*"', "", test.read_text()) if test.exists() else ""
        if not re.search(rf'TEST_CASE\(\s*"{re.escape(name)}"', tests):
            yield f"no such test in {path}: {name}"


def dead_commands(root, text):
    for program, words in COMMAND.findall(re.sub(r"\s+", " ", text)):
        sources = "".join(file.read_text() for file in root.glob(f"tests/{program}/*.cpp"))
        sources = re.sub(r'"\s*\n\s*"', "", sources)
        if not all(part in sources for part in ("TEST_CASE", *words.split("*"))):
            yield f"no such test: test_{program} \"{words}\""
    for names in BENCHMARKS.findall(text):
        for name in names.split():
            if name not in NO_PROGRAMS and not any(root.glob(f"bench/*/{name}.cpp")):
                yield f"no such benchmark: {name}"


def dead_ends(root):
    for file in sorted([root / "README.md", *root.glob("docs/**/*.md"), *root.glob("examples/**/*.md"),
                        *root.glob("tests/**/*.md")]):
        page = file.read_text()
        for found in [*dead_links(root, file, page), *dead_paths(root, file, LINK.sub("", page)),
                      *false_quotes(root, page), *missing_tests(file, page),
                      *dead_commands(root, page)]:
            yield f"{file.relative_to(root)}: {found}"
    for file in sorted(root.glob("include/**/*.hpp")):
        comments = "\n".join(COMMENT.findall(file.read_text()))
        for found in [*dead_paths(root, file, comments), *dead_commands(root, comments)]:
            yield f"{file.relative_to(root)}: {found}"


PLANTED = {
    "docs/design.md": ["[a page](no_such_page.md)", "[a heading](design.md#no-such-heading)",
                       "`slip/no_such_header.hpp`",
                       '[tests](../tests/core/grid.cpp) "no such test"',
                       '`test_core "no such test"`', '`test_no_folder "[grid]"`',
                       "`bench/report/run no_such_benchmark`",
                       "<!-- README.md -->\n```cpp\nno_such_line();\n```"],
    "include/fingerpad/core/grid.hpp": ["// See core/no_such_header.hpp."],
}


def expect_planted(root):
    for name, plants in PLANTED.items():
        for plant in plants:
            with tempfile.TemporaryDirectory() as folder:
                copy = Path(folder) / "copy"
                shutil.copytree(root, copy, ignore=shutil.ignore_patterns("build", "out", ".git"))
                file = copy / name
                file.write_text(file.read_text() + f"\n{plant}\n")
                if not any(name in found for found in dead_ends(copy)):
                    sys.exit(f"not found: {plant} in {name}")


if __name__ == "__main__":
    checkout = Path(sys.argv[1]).resolve()
    if "--planted" in sys.argv:
        expect_planted(checkout)
    else:
        found = list(dead_ends(checkout))
        print("\n".join(found) or "no dead end")
        sys.exit(1 if found else 0)
