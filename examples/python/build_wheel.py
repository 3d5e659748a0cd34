# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Builds the wheel for pip (PEP 517): the module by CMake, then wheel.py packs it with its stubs."""
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with tempfile.TemporaryDirectory() as build:
        subprocess.run(["cmake", "-S", HERE, "-B", build, "-DCMAKE_BUILD_TYPE=Release",
                        f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "fingerpad_wheel",
                        "-j", str(os.cpu_count() or 1)], check=True)
        wheel, = pathlib.Path(build).glob("fingerpad-*.whl")
        to = pathlib.Path(wheel_directory) / wheel.name
        to.write_bytes(wheel.read_bytes())
        return to.name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the module is built from the whole repository")
