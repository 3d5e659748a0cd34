#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Writes the site's first page, a page for each public class (a row of docs/classes.md), for each printed
form (a name in docs/papers.md) and for each public header: reference.py ROOT SOURCE XML"""
import functools
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOMS = {  # in the order in which a frame goes through them
    "pipeline": "Whole sensors", "depth": "Depth", "contact": "Contact", "dots": "Dots",
    "motion": "Motion", "slip": "Slip", "gel": "Gels", "force": "Force", "membrane": "Membrane",
    "foam": "Foam",
    "calibrate": "Calibration", "published": "As published", "optics": "Optics", "sim": "Test signals", "adapt": "Adapters",
    "image": "Pixel kernels", "math": "Mathematics", "core": "Vocabulary",
}

HEADINGS = ["What", "When to take it", "Equation and source", "Parameters", "Result and statuses",
            "Cost", "Error", "Example"]  # of each class; all but the first are columns of the table


def comment_of(header):
    """The comment that a header begins with."""
    comment = re.search(r"#pragma once\n((?://[^\n]*\n)*)", header.read_text())[1]
    return "\n".join(line.removeprefix("//").removeprefix(" ") for line in comment.splitlines())


def first_sentence(header):
    return re.split(r"(?<=[.:]) ", " ".join(comment_of(header).split()))[0]


def classes(root):
    """Of each row of docs/classes.md: the class, and what stands under its headings."""
    for line in (root / "docs/classes.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == len(HEADINGS) and cells[0].startswith("`"):
            yield cells[0].strip("`"), dict(zip(HEADINGS[1:], cells[1:]))


@functools.cache
def headers_by_name(root):
    """Where each class, struct and enumeration is defined."""
    defined = re.compile(r"^(?:class|struct|enum class)(?: \[\[nodiscard\]\])? (\w+)\b[^;]*?{", re.MULTILINE)
    headers = [h for h in sorted((root / "include/fingerpad").rglob("*.hpp")) if "detail" not in h.parts]
    return {name: header for header in headers for name in defined.findall(header.read_text())}


def header_of(name, root):
    """None: there is no such type."""
    return headers_by_name(root).get(name)


def definitions_of(names, root):
    """The types that a cell names, as the headers have them: their comments say units and ranges."""
    for name in re.findall(r"`(\w+)`", names):
        text = re.search(rf"^(?:template <[^\n]*>\n)?(?:class|struct|enum class)[^;{{]*? {name}\b[^;{{]*{{.*?^}};",
                         header_of(name, root).read_text(), re.MULTILINE | re.DOTALL)[0]
        yield f"```cpp\n{text}\n```\n"


def class_page(name, row, root):
    header = header_of(name, root)
    under = {heading: re.sub(r"\]\((?:\.\./)?(?=\w)", lambda link: "](../../" + ("" if "../" in link[0] else "docs/"), text)
             for heading, text in row.items()}
    under["What"] = f"```text\n{comment_of(header)}\n```\n\n`#include \"{header.relative_to(root / 'include')}\"`"
    for heading in ("Parameters", "Result and statuses"):
        under[heading] += "\n\n" + "\n".join(definitions_of(row[heading], root))
    under["When to take it"] = f"When {row['When to take it']}."
    example = re.search(r"\]\(\.\./(examples/\d\d_\w+\.cpp)\)", row["Example"])
    if example:
        under["Example"] += f"\n\n```{{literalinclude}} ../../{example[1]}\n:language: cpp\n```"
    return f"# {name}\n" + "".join(f"\n## {heading}\n\n{under[heading]}\n" for heading in HEADINGS)


def printed_forms(root):
    """Of each name of the column "As printed" in docs/papers.md: its rows' cells."""
    forms = {}
    for line in (root / "docs/papers.md").read_text().splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 6 and re.fullmatch(r"[A-Z]\d", cells[0]):
            for name in re.findall(r"`(?:published::)?(\w+)[\w:]*`", cells[2]):
                forms.setdefault(name, []).append(cells)
    return forms


@functools.cache
def declaration_of(name, root):
    """Header, comment and declaration of a type, an alias or a function, those as printed first."""
    comment = r"(?P<comment>(?:^///[^\n]*\n)*)"
    start = r"(?P<code>(?:^template <[^\n]*>\n)?(?:^  requires[^\n]*\n)?"
    kinds = [rf"^(?:class|struct|enum class)[^;{{()]*? {name}\b[^;{{]*{{.*?^}};)", rf"^using {name} =[^;]*;)",
             rf"^(?![ /])[^\n;={{}}]*?\b{name}\([^;{{]*(?=[;{{]))", rf"^(?![ /])[^\n;(){{}}]*\b{name} ?[={{][^;]*;)"]
    folders = [root / "include/fingerpad/published", root / "include/fingerpad/sim"]
    for header in (h for folder in folders for h in sorted(folder.glob("*.hpp"))):
        for kind in kinds:
            found = re.search(comment + start + kind, header.read_text(), re.MULTILINE | re.DOTALL)
            if found:
                words = re.sub("^/// ?", "", found["comment"], flags=re.MULTILINE)
                return header, words, found["code"].strip()
    return None


def test_named(cell, root):
    """A test that guards a printed form, as it is written: how it is called."""
    file, title = re.search(r'\]\(\.\./(tests/[^)]*)\) "([^"]*)"', cell).groups()
    return re.search(rf'^TEST_CASE\(\s*"{re.escape(title)}".*?^}}\n', (root / file).read_text(),
                     re.MULTILINE | re.DOTALL)[0]


def printed_page(name, rows, root):
    header, comment, code = declaration_of(name, root)
    errors = ", ".join(dict.fromkeys(re.findall(r"E\d{3}(?:-E\d{3})?", " ".join(c[3] for c in rows) + comment_of(header))))
    under = {
        "What": f"{comment or rows[0][1]}\n\n`#include \"{header.relative_to(root / 'include')}\"`",
        "When to take it": "To compare with the method as printed. For use take: "
                           + "; ".join(dict.fromkeys(c[3] for c in rows)) + ".",
        "Equation and source": "\n\n".join(dict.fromkeys(c[1] for c in rows))
                               + f"\n\n```text\n{comment_of(header)}\n```",
        "Parameters": "\n".join(f"```cpp\n{text}\n```\n" for text in (interface_of(code), *settings_of(header, name))),
        "Result and statuses": "What the declaration above says; a part gives the result of the method that takes it.\n\n"
                               + "\n".join(f"```cpp\n{text}\n```\n" for text in results_of(header)),
        "Cost": "Its rows in [speed against error](../../docs/speed_and_error.md), where it is timed; it is no "
                "part of a default frame.",
        "Error": f"What is wrong with it: [errata](../../docs/errata.md){', ' + errors if errors else ''}. What it does to the "
                 "papers' figures: [papers](../../docs/papers.md).",
        "Example": f"A test holds it to what is printed:\n\n```cpp\n{test_named(rows[0][5], root)}```",
    }
    return f"# {name}, as printed\n" + "".join(f"\n## {h}\n\n{under[h]}\n" for h in HEADINGS)


def interface_of(code):
    """A declaration; of a long class the head alone."""
    return code if len(code) < 1000 else code[:code.index("{")].strip() + ";"


def settings_of(header, name):
    """The settings that a header defines beside the type `name`."""
    return re.findall(rf"^struct (?!{name}\b)\w+(?:Options|Test) {{.*?^}};", header.read_text(), re.MULTILINE | re.DOTALL)


def results_of(header):
    """The results that a header defines."""
    return re.findall(r"^(?:enum class \w+Status|struct \[\[nodiscard\]\] )[^;{]*{.*?^};", header.read_text(),
                      re.MULTILINE | re.DOTALL)


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
    pages = source / "reference/classes"
    pages.mkdir(parents=True)
    for name, row in classes(root):
        (pages / f"{name}.md").write_text(class_page(name, row, root))
    for name, rows in printed_forms(root).items():
        (pages / f"published_{name}.md").write_text(printed_page(name, rows, root))
    trees.insert(0, toctree("As printed, by name", sorted(f"reference/classes/published_{n}" for n in printed_forms(root))))
    trees.insert(0, toctree("Classes", sorted(f"reference/classes/{name}" for name, _ in classes(root))))
    trees.insert(0, toctree("First hour", sorted(f"docs/first_hour/{p.stem}"
                                                 for p in (root / "docs/first_hour").glob("*.md"))))
    general = sorted(f"docs/{p.stem}" for p in (root / "docs").glob("*.md"))
    project = ["docs/CONTRIBUTING", "docs/CHANGELOG", "docs/SECURITY", "tests/data/README"]
    first = ["docs/install", "docs/your_sensor", "examples/README", "examples/data/README",
             "docs/playground/playground", "docs/results", "docs/faq"]
    trees.insert(0, toctree("Start", first + [g for g in general if g not in first + project]))
    trees.append(toctree("Project", project))
    # README is the first page; its links and pictures are those of the folder that it is in.
    (source / "index.md").write_text((root / "README.md").read_text() + "\n" + "\n".join(trees))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
