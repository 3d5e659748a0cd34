#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Counts what the headers of a tree have: of each room and of each header.

count.py [ROOT] [--rooms | --headers | --types | --pulled HEADER...]

  --rooms    (default) a table: lines, lines of code, headers and public types of each room
  --headers  the same of each header as CSV, with the fingerpad lines and headers that it pulls in
  --types    the public types, one a line
  --pulled   lines and headers of fingerpad that these headers pull in, themselves included

Lines of code have something other than a comment. Public types are struct, class and enum that are
defined in a namespace without `detail` in a header outside of detail/; specialisations are not
counted, and types within types (Name::State) are counted on their own. A room is a folder of
include/fingerpad; its detail/ belongs to it. "pixels to contact" is core, math, optics, image, depth
and contact with what calibrates them and with their published forms.
"""
import argparse
import collections
import pathlib
import re
import sys

TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-zA-Z_])\'(?:\\.|[^\'\\\n])+\'',
                   re.DOTALL)


FIRST_ROOMS = ("core", "math", "optics", "image", "depth", "contact")
FIRST_STEMS = re.compile(r"(calibrate|published)/(detail/)?(absorption|camera|contact(?!_shift)|depth|fit|inflated_cap|"
                         r"intensity|model_fit|neighbour_light|slides_contact)")

KIND = re.compile(r"(struct|class|enum(?: class| struct)?)\s+(?:\[\[\w+\]\]\s*|alignas\(.*?\)\s*)?(\w+)(\s*<)?"
                  r"(?![^:]*\()")


def without_comments(text):
    """The same lines; comments are blank."""
    def blank(match):
        return match[0] if match[0][0] in "\"'R" else re.sub(r"[^\n]", " ", match[0])
    return TOKEN.sub(blank, text)


def lines_of_code(text):
    return sum(bool(line.strip()) for line in without_comments(text).splitlines())


def without_template_heads(code):
    """No `template <...>`: a class in there is a parameter."""
    out, at = [], 0
    for found in re.finditer(r"\btemplate\s*<", code):
        if found.start() < at:
            continue
        out.append(code[at:found.start()])
        depth, k = 1, found.end()
        while depth:
            depth += (code[k] in "<(") - (code[k] in ">)")
            k += 1
        at = k
    return "".join(out) + code[at:]


def types_of(text):
    """Public types that a header defines: Name, and Name::Member of those within them."""
    code = re.sub(r'"(?:\\.|[^"\\\n])*"', '""', without_comments(text))
    code = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", "", code, flags=re.MULTILINE)
    code = without_template_heads(code)
    scopes = []  # of each open brace: [kind, name, whether what follows is public]
    last, types = 0, []
    for found in re.finditer(r"[{};]|\b(?:public|private|protected)\s*:(?!:)", code):
        token, head = found[0], code[last:found.start()].strip()
        last = found.end()
        if token[0] == "p":
            if scopes:
                scopes[-1][2] = token.startswith("public")
        elif token == "}":
            if scopes:
                scopes.pop()
        elif token == "{":
            space = re.search(r"\bnamespace\s*([\w:]*)$", head)
            kind = KIND.match(head)
            if space:
                scopes.append(["detail" if not space[1] or "detail" in space[1] else "namespace", "", True])
            elif kind:
                if all(s[2] and s[0] in ("namespace", "type") for s in scopes) and not kind[3]:
                    types.append("::".join([s[1] for s in scopes if s[1]] + [kind[2]]))
                scopes.append(["values" if kind[1].startswith("enum") else "type", kind[2], kind[1] != "class"])
            else:
                scopes.append(["block", "", False])
    return types


class Tree:
    def __init__(self, root):
        self.include = root / "include"
        self.headers = {str(p.relative_to(self.include)): p.read_text()
                        for p in sorted((self.include / "fingerpad").rglob("*.hpp"))}
        self.direct = {name: [n for n in re.findall(r'^#include ["<](fingerpad/.+?)[">]', text, re.MULTILINE)
                              if n in self.headers] for name, text in self.headers.items()}

    def pulled(self, name):
        seen, left = {name}, [name]
        while left:
            for other in self.direct[left.pop()]:
                if other not in seen:
                    seen.add(other)
                    left.append(other)
        return sum(self.lines(n) for n in seen), len(seen)

    def lines(self, name):
        return self.headers[name].count("\n")

    def types(self, name):
        return [] if "/detail/" in name else types_of(self.headers[name])

    def counts(self, name):
        """Lines, lines of code, headers, public types, and types within these."""
        types = self.types(name)
        inner = sum("::" in t for t in types)
        return self.lines(name), lines_of_code(self.headers[name]), 1, len(types) - inner, inner

    def room(self, name):
        parts = name.split("/")
        return parts[1] if len(parts) > 2 else "."


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2])
    parser.add_argument("--rooms", action="store_true")
    parser.add_argument("--headers", action="store_true")
    parser.add_argument("--types", action="store_true")
    parser.add_argument("--pulled", nargs="+", default=[], metavar="HEADER")
    args = parser.parse_args()
    tree = Tree(args.root)
    if args.types:
        for name in tree.headers:
            for type_ in tree.types(name):
                print(f"{name}: {type_}")
    elif args.pulled:
        for name in args.pulled:
            name = name if name.startswith("fingerpad/") else "fingerpad/" + name
            if name not in tree.headers:
                sys.exit(f"no such header: {name}")
            print(name, "{}\t{}".format(*tree.pulled(name)), sep="\t")
    elif args.headers:
        print("header,room,lines,code,types,inner_types,pulled_lines,pulled_headers")
        for name in tree.headers:
            lines, code, _, types, inner = tree.counts(name)
            print(name.removeprefix("fingerpad/"), tree.room(name), lines, code, types, inner, *tree.pulled(name),
                  sep=",")
    else:
        print("room,lines,code,headers,types,inner_types")
        sums = collections.defaultdict(lambda: [0] * 5)
        for name in tree.headers:
            room = tree.room(name)
            first = room in FIRST_ROOMS or FIRST_STEMS.match(name.removeprefix("fingerpad/"))
            for key in [room, "all"] + ["pixels to contact"] * bool(first):
                sums[key] = [a + b for a, b in zip(sums[key], tree.counts(name))]
        for room in sorted(sums, key=lambda r: (r == "all", " " in r, r)):
            print(room, *sums[room], sep=",")


if __name__ == "__main__":
    main()
