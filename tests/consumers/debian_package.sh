#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# debian_package.sh ROOT PREFIX: builds libfingerpad-dev and unpacks it; PREFIX is then its /usr.
set -euo pipefail
root=$1
prefix=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/fingerpad"
cp -r "$root"/{CMakeLists.txt,LICENSE,README.md,.cmake,include,docs} "$work/fingerpad"
cp -r "$root/.packaging/debian" "$work/fingerpad/debian"
(cd "$work/fingerpad" && dpkg-buildpackage --no-sign --build=binary >"$work/log" 2>&1) ||
  { tail -n 30 "$work/log"; exit 1; }
rm -rf "$prefix"
dpkg-deb --extract "$work"/libfingerpad-dev_*_all.deb "$work/unpacked"
mv "$work/unpacked/usr" "$prefix"
[[ -f $prefix/include/fingerpad/fingerpad.hpp ]]
