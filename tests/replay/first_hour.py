#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Follows the pages of docs/first_hour as they are written.

first_hour.py ROOT PROGRAMS...  runs the ```sh blocks of each page in a folder of its own; exit status
                                1 if one fails, or if a number or a word is not as expected
first_hour.py --planted         expects a failing command and a false number to be detected

PROGRAMS are added to the path, and FINGERPAD is the library's folder. A comment below a block
states what it must print:

    <!-- prints: good -->                     these words
    <!-- prints: pitch_mm 0.153 +- 0.001 -->  a line of this name with a number in this range

Blocks without a language are skipped: they build the programs, or need more than tests have.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

STEP = re.compile(r"^```sh\n(.*?)^```$|^<!-- prints: (.*?) -->$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(\S+) (\S+) \+- (\S+)")
PRACTICE = "calibrate practice practice\n"  # for every page: made once, then copied


def is_printed(wanted, printed):
    number = NUMBER.fullmatch(wanted)
    if not number:
        return wanted in printed
    name, value, tolerance = number.groups()
    found = re.findall(rf"^ *{re.escape(name)} +(\S+)", printed, re.MULTILINE)
    return any(abs(float(text) - float(value)) <= float(tolerance) for text in found)


def complaints(page, folder, environment, practice):
    """Deviations from the page, up to the first failing command."""
    printed = ""
    for block, wanted in STEP.findall(page):
        if wanted:
            if not is_printed(wanted, printed):
                yield f"not printed: {wanted}\n{printed}"
        elif block == PRACTICE and practice.exists():
            shutil.copytree(practice, folder / "practice")
        else:
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, text=True,
                                  env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            printed = done.stdout
            if done.returncode != 0:
                yield f"exit status {done.returncode}:\n{block}{printed}"
                return
            if block == PRACTICE:
                shutil.copytree(folder / "practice", practice)


def run_pages(root, programs):
    path = ":".join([*(str(Path(program).parent) for program in programs), os.environ["PATH"]])
    environment = dict(os.environ, PATH=path, FINGERPAD=str(root))
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for page in sorted((root / "docs/first_hour").glob("*.md")):
            folder = Path(scratch) / page.stem
            folder.mkdir()
            for complaint in complaints(page.read_text(), folder, environment, Path(scratch) / "practice"):
                print(f"{page.name}: {complaint}")
                failed = True
    return failed


def planted_are_found():
    plants = ["```sh\nfalse\n```", "```sh\nfalse | true\n```", "```sh\necho good\n```\n<!-- prints: doubtful -->",
              "```sh\necho '  pitch_mm  0.16'\n```\n<!-- prints: pitch_mm 0.153 +- 0.001 -->"]
    right = "```sh\necho '  pitch_mm  0.1532'\n```\n<!-- prints: pitch_mm 0.153 +- 0.001 -->"
    with tempfile.TemporaryDirectory() as folder:
        found = [bool(list(complaints(p, Path(folder), None, Path("/none")))) for p in [*plants, right]]
    return found == [True] * len(plants) + [False]


if __name__ == "__main__":
    if sys.argv[1:] == ["--planted"]:
        sys.exit(0 if planted_are_found() else 1)
    sys.exit(1 if run_pages(Path(sys.argv[1]).resolve(), sys.argv[2:]) else 0)
