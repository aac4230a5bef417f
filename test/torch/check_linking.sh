#!/usr/bin/env bash
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# In the folder with the libraries: none but the backend torch needs libtorch.
set -euo pipefail

needs_torch() { readelf -d "$1" | grep -qE "NEEDED.*lib(torch|c10)"; }

needs_torch libradar_dot_backend_torch.so || { echo "libradar_dot_backend_torch.so does not need libtorch" >&2; exit 1; }
checked=0
for library in libradar_dot_*.so; do
  case $library in *torch*) continue ;; esac
  if needs_torch "$library"; then
    echo "$library needs libtorch" >&2
    exit 1
  fi
  checked=$((checked + 1))
done
[ "$checked" -ge 5 ] || { echo "only $checked libraries in $PWD" >&2; exit 1; }
