#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes all headers but the adapters into one file: single_header.py OUT/fingerpad_single.hpp"""
import re
import sys
from pathlib import Path

INCLUDE = Path(__file__).resolve().parents[1] / "include"
OWN = re.compile(r'#include "(fingerpad/[^"]+)"')
HEAD = "// SPDX-FileCopyrightText: 2026 The fingerpad authors\n// SPDX-License-Identifier: MIT\n"


def expanded(header, seen):
    """The text of a header, with each of our own headers in the place where it is first included."""
    if header in seen:
        return
    seen.add(header)
    for line in (INCLUDE / header).read_text().removeprefix(HEAD).splitlines(keepends=True):
        own = OWN.match(line)
        if own:
            yield from expanded(own[1], seen)
        elif line != "#pragma once\n":
            yield line


if __name__ == "__main__":
    text = "".join(expanded("fingerpad/fingerpad.hpp", set()))
    Path(sys.argv[1]).write_text(HEAD + "#pragma once\n" + text)
