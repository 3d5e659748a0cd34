#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
"""recipes.py ROOT CMAKE VERSION: checks the recipes of vcpkg and Conan without these tools, with
stand-ins for their functions."""
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tempfile
import types
from pathlib import Path

STAND_INS = """
function(vcpkg_cmake_configure)
  cmake_parse_arguments(A "" "SOURCE_PATH" "OPTIONS" ${ARGN})
  set(build "${CURRENT_PACKAGES_DIR}-build")
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${A_SOURCE_PATH}" -B "${build}" ${A_OPTIONS}
                          -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR}
                  ERROR_VARIABLE errors OUTPUT_QUIET RESULT_VARIABLE status)
  if(NOT status EQUAL 0 OR errors MATCHES "not used by the project")
    message(FATAL_ERROR "${errors}")
  endif()
endfunction()
function(vcpkg_cmake_install)
  execute_process(COMMAND ${CMAKE_COMMAND} --install "${CURRENT_PACKAGES_DIR}-build"
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(MAKE_DIRECTORY "${CURRENT_PACKAGES_DIR}/debug")
endfunction()
function(expects_file file)
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "there is no ${file}")
  endif()
endfunction()
function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(A "" "CONFIG_PATH" "" ${ARGN})
  expects_file("${CURRENT_PACKAGES_DIR}/${A_CONFIG_PATH}/fingerpadConfig.cmake")
endfunction()
function(vcpkg_fixup_pkgconfig)
  expects_file("${CURRENT_PACKAGES_DIR}/share/pkgconfig/fingerpad.pc")
endfunction()
function(vcpkg_install_copyright)
  cmake_parse_arguments(A "" "" "FILE_LIST" ${ARGN})
  expects_file("${A_FILE_LIST}")
endfunction()
"""


def expects_all_headers(root, package):
    missing = [header for header in (root / "include").rglob("*.hpp")
               if not (package / header.relative_to(root)).is_file()]
    assert not missing, f"not in the package: {missing[0]}"


def vcpkg(root, cmake, version, work):
    port = root / ".packaging/vcpkg/fingerpad"
    manifest = json.loads((port / "vcpkg.json").read_text())
    assert manifest["name"] == "fingerpad" and manifest["version"] == version, manifest["version"]
    known = re.search(r"fingerpad_COMPONENTS ([^)]*)", (root / ".cmake/fingerpadComponents.cmake").read_text())
    assert set(manifest["features"]) <= set(known[1].split()), manifest["features"]
    script = work / "run.cmake"
    script.write_text(f'set(CURRENT_PORT_DIR "{port}")\nset(CURRENT_PACKAGES_DIR "{work}/packages")\n'
                      f'{STAND_INS}\ninclude("{port}/portfile.cmake")\n')
    run = subprocess.run([cmake, "-P", script], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert not (work / "packages/debug").exists(), "debug/ is left: vcpkg refuses that"
    expects_all_headers(root, work / "packages")


def conan(root, version, work):
    def copy(recipe, pattern, source, to):
        found = list(Path(source).glob(pattern))
        assert found, f"{pattern}: nothing in {source}"
        for path in found:
            place = Path(to) / path.relative_to(source)
            place.parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if path.is_dir() else shutil.copy)(path, place)

    class Recipe:
        pass

    said = []
    for name, content in {"conan": {"ConanFile": Recipe}, "conan.tools": {},
                          "conan.tools.build": {"check_min_cppstd": lambda r, std: said.append(std)},
                          "conan.tools.files": {"copy": copy}}.items():
        module = types.ModuleType(name)
        module.__dict__.update(content)
        sys.modules[name] = module
    spec = importlib.util.spec_from_file_location("recipe", root / ".packaging/conan/conanfile.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    recipe = module.Fingerpad()
    assert recipe.name == "fingerpad" and recipe.version == version, recipe.version
    recipe.recipe_folder = root / ".packaging/conan"
    recipe.export_sources_folder = recipe.source_folder = work / "sources"
    recipe.package_folder = work / "package"
    recipe.options = types.SimpleNamespace(with_eigen=True)
    recipe.requires = lambda what, **_: said.append(what)
    recipe.info = types.SimpleNamespace(clear=lambda: None)
    recipe.cpp_info = types.SimpleNamespace()
    for step in ("export_sources", "requirements", "validate", "package_id", "package", "package_info"):
        getattr(recipe, step)()
    assert said == ["eigen/[>=3.4 <4]", 20], said
    expects_all_headers(root, work / "package")
    assert (work / "package/LICENSE").is_file()


def main(root, cmake, version):
    with tempfile.TemporaryDirectory() as folder:
        vcpkg(root, cmake, version, Path(folder))
    with tempfile.TemporaryDirectory() as folder:
        conan(root, version, Path(folder))
    print("both recipes are as they should be")


main(Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3])
