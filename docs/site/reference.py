#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes the site's first page and a page for each public header: reference.py ROOT SOURCE XML"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOMS = {  # in the order in which a frame goes through them
    "pipeline": "Whole sensors", "depth": "Depth", "contact": "Contact", "motion": "Motion",
    "slip": "Slip", "force": "Force", "foam": "Foam", "calibrate": "Calibration",
    "published": "As published", "optics": "Optics", "sim": "Test signals", "adapt": "Adapters",
    "image": "Pixel kernels", "math": "Mathematics", "core": "Vocabulary",
}


def first_sentence(header):
    """Of the comment that a header begins with."""
    comment = re.search(r"#pragma once\n((?://[^\n]*\n)*)", header.read_text())[1]
    text = " ".join(line.removeprefix("//").strip() for line in comment.splitlines())
    return re.split(r"(?<=[.:]) ", text)[0]


def declared(xml, path):
    """Sphinx's directive and the name of each type, enumeration and function of a header."""
    for index in ElementTree.parse(xml / "index.xml").iterfind("compound[@kind='file']"):
        file = ElementTree.parse(xml / f"{index.get('refid')}.xml").find("compounddef")
        if not file.find("location").get("file").endswith(path):
            continue
        inner = {i.text: i.get("refid") for i in file.iterfind("innerclass")}
        for name, id in inner.items():
            is_nested = name.rpartition("::")[0] in inner
            if not is_nested and "<" not in name and "detail::" not in name:  # no specialisations
                yield "class" if id.startswith("class") else "struct", name
        for member in file.iterfind("sectiondef/memberdef"):
            if member.get("kind") == "enum":
                yield "enum", member.findtext("qualifiedname") or "fingerpad::" + member.findtext("name")
        functions = {m.findtext("name") for m in file.iterfind("sectiondef/memberdef[@kind='function']")}
        for name in sorted(functions):
            yield "function", f"fingerpad::{name}"


def page_of(header, root, xml):
    path = header.relative_to(root / "include").as_posix()
    page = f"# {header.stem.replace('_', ' ')}\n\n`#include \"{path}\"`\n\n{first_sentence(header)}\n"
    for kind, name in declared(xml, path):
        members = "   :members:\n" if kind in ("class", "struct") else ""
        page += f"\n```{{eval-rst}}\n.. doxygen{kind}:: {name}\n{members}```\n"
    return page


def toctree(caption, entries):
    return f"```{{toctree}}\n:caption: {caption}\n:hidden:\n\n" + "\n".join(entries) + "\n```\n"


def main(root, source, xml):
    trees = []
    for room, title in ROOMS.items():
        pages = sorted(f"docs/{room}/{p.stem}" for p in (root / "docs" / room).glob("*.md"))
        headers = []
        for header in sorted((root / "include/fingerpad" / room).glob("*.hpp")):
            page = source / "reference" / room / f"{header.stem}.md"
            page.parent.mkdir(parents=True, exist_ok=True)
            page.write_text(page_of(header, root, xml))
            headers.append(f"reference/{room}/{header.stem}")
        trees.append(toctree(title, pages + headers))
    general = sorted(f"docs/{p.stem}" for p in (root / "docs").glob("*.md"))
    trees.insert(0, toctree("Start", ["docs/install", *(g for g in general if g != "docs/install"),
                                      "examples/data/README", "tests/data/README"]))
    # README is the first page; its links and pictures are those of the folder that it is in.
    (source / "index.md").write_text((root / "README.md").read_text() + "\n" + "\n".join(trees))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
