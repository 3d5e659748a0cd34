#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Packs the built module and its stubs as a wheel (PEP 427): wheel.py MODULE VERSION FOLDER prints
its path.

A wheel is a zip archive that names its files and their hashes; nothing but Python is needed.
"""
import base64
import hashlib
import pathlib
import sys
import sysconfig
import zipfile

import stubs

module, version, folder = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
python = f"cp{sys.version_info.major}{sys.version_info.minor}"
platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
tag = f"{python}-{python}-{platform}"
info = f"fingerpad-{version}.dist-info"

files = {
    module.name: module.read_bytes(),
    "fingerpad.pyi": stubs.text_of(module).encode(),
    f"{info}/METADATA": f"""Metadata-Version: 2.1
Name: fingerpad
Version: {version}
Summary: Algorithms behind camera-based robot fingertips
License: MIT
Requires-Python: >={sys.version_info.major}.{sys.version_info.minor}
Requires-Dist: numpy
""".encode(),
    f"{info}/WHEEL": f"""Wheel-Version: 1.0
Generator: fingerpad
Root-Is-Purelib: false
Tag: {tag}
""".encode(),
}


def record_line(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


record = "".join(record_line(*file) for file in files.items()) + f"{info}/RECORD,,\n"
files[f"{info}/RECORD"] = record.encode()

folder.mkdir(parents=True, exist_ok=True)
wheel = folder / f"fingerpad-{version}-{tag}.whl"
with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
    for name, content in files.items():
        archive.writestr(name, content)
print(wheel)
