# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""Conan 2 recipe of this very checkout: conan create .packaging/conan"""
from pathlib import Path

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.files import copy


class Fingerpad(ConanFile):
    name = "fingerpad"
    version = "0.1.0"
    license = "MIT"
    description = "Touch from camera frames: algorithms for soft, camera-based robot fingertips"
    package_type = "header-library"
    settings = "os", "compiler", "build_type", "arch"
    options = {"with_eigen": [True, False]}
    default_options = {"with_eigen": True}
    no_copy_source = True

    def export_sources(self):
        root = Path(self.recipe_folder).parents[1]
        copy(self, "include/*", root, self.export_sources_folder)
        copy(self, "LICENSE", root, self.export_sources_folder)

    def requirements(self):
        if self.options.with_eigen:
            self.requires("eigen/[>=3.4 <4]", transitive_headers=True)

    def validate(self):
        check_min_cppstd(self, 20)

    def package_id(self):
        self.info.clear()

    def package(self):
        copy(self, "include/*", self.source_folder, self.package_folder)
        copy(self, "LICENSE", self.source_folder, self.package_folder)

    def package_info(self):
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = []
