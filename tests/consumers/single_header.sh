#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# single_header.sh ROOT COMPILER...: the single header is, after preprocessing, what fingerpad.hpp is.
set -euo pipefail
root=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$root/.packaging/single_header.py" "$work/fingerpad_single.hpp"
words_of() { "$@" -E -P -x c++ -include "$header" /dev/null | tr -s '[:space:]' '\n'; }
header=fingerpad/fingerpad.hpp words_of "$@" >"$work/many"
header=$work/fingerpad_single.hpp words_of "$@" >"$work/one"
[[ -s $work/many ]] && diff -q "$work/many" "$work/one"
