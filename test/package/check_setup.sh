#!/usr/bin/env bash
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# check_setup.sh SETUP SCRATCH: where no package is installed, scripts/setup takes ROS from the distribution; where
# Noetic is, only the toolchain, and leaves the rest to rosdep.
set -euo pipefail
setup=$1 scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch/noetic"
echo 'export CMAKE_PREFIX_PATH=/of/noetic; [ $# -eq 0 ]; : $unset' >"$scratch/noetic/setup.bash"

# Functions come before programs: what would install notes how it was called.
cat >"$scratch/functions" <<TEXT
note() { echo "\$* [\${CMAKE_PREFIX_PATH:-}]" >>"$scratch/calls"; }
apt-get() { note apt-get "\$@"; }
rosdep() { note rosdep "\$@"; }
env() { shift; "\$@"; }
id() { echo 0; }
dpkg-query() { return 1; }
TEXT

run() {
  rm -f "$scratch/calls"
  RADAR_DOT_NOETIC=$1 BASH_ENV=$scratch/functions bash "$setup" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
}
expect() {  # number of calls, pattern
  [ "$(grep -c -- "$2" "$scratch/calls")" -eq "$1" ] || { echo "expected $1 x '$2' in:"; cat "$scratch/calls"; exit 1; }
}
unset CMAKE_PREFIX_PATH ROS_DISTRO
run ""
expect 1 '^apt-get install .* libroscpp-dev .*\[\]$'
expect 0 '^rosdep'
run "$scratch/noetic"
expect 1 '^apt-get install .* ninja-build'
expect 0 '^apt-get .*\(ros\|catkin\|tf2\|torch\)'
expect 1 '^rosdep install .* --rosdistro noetic .*\[/of/noetic\]$'
export ROS_DISTRO=noetic CMAKE_PREFIX_PATH=/of/my_workspace:/of/noetic
run "$scratch/noetic"
expect 1 '^rosdep install .*\[/of/my_workspace:/of/noetic\]$'
if RADAR_DOT_NOETIC=$scratch/misspelled BASH_ENV=$scratch/functions bash "$setup" 2>"$scratch/log"; then
  echo "a folder without Noetic is taken for Noetic"
  exit 1
fi
grep -q misspelled "$scratch/log"
