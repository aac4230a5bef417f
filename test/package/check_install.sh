#!/usr/bin/env bash
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# check_install.sh BUILD SOURCE SCRATCH TOOL...: installs the package and uses it from there as its users do: launch
# files, tools, Python messages, nodelets, and a package that builds on it.
set -euo pipefail
build=$1 source=$2 scratch=$3
shift 3
tools=("$@")
export PATH=/usr/bin:$PATH
unset ROS_PACKAGE_PATH CMAKE_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH
rm -rf "$scratch"
mkdir -p "$scratch"
prefix=$scratch/root$(sed -n 's/^CMAKE_INSTALL_PREFIX:[^=]*=//p' "$build/CMakeCache.txt")
DESTDIR=$scratch/root cmake --install "$build" >"$scratch/install.log"

set --  # else the next line reads them
set +u  # the generated script reads variables that may be unset
. "$prefix/setup.bash"
set -u
fail() {
  echo "check_install: $*" >&2
  exit 1
}
share=$prefix/share/radar_dot
[ "$(rospack find radar_dot)" = "$share" ] || fail "rospack finds $(rospack find radar_dot)"

# Nothing that is installed leads back to where it was built. CMake notes the places of libraries in its own files.
back=$(grep -rIl -e "$source" -e "$build" "$prefix" --exclude='*.cmake' --exclude='*.pc' --exclude-dir=__pycache__ \
  --exclude=_setup_util.py --exclude=setup.sh --exclude=local_setup.sh --exclude=.rosinstall || true)
[ -z "$back" ] || fail "these name the source or build folder: $back"

for file in radar radar_dot; do
  roslaunch --files radar_dot $file.launch >/dev/null
  [[ $(roslaunch --dump-params radar_dot $file.launch) == */ego_velocity/radars/* ]] || fail "$file.launch: no parameters"
done
for tool in "${tools[@]}"; do
  rosrun radar_dot "$tool" --help >"$scratch/help" </dev/null || fail "rosrun radar_dot $tool --help: $?"
  [ -s "$scratch/help" ] || fail "rosrun radar_dot $tool --help says nothing"
done
# The presets that are installed, not those of the source.
touch "$share/config/radars/installed.yaml"
echo 'ego_velocity: {radars: {front: {topic: points, preset: none}}}' >"$scratch/vehicle.yaml"
[[ $("$prefix/lib/radar_dot/evaluate_ego_velocity" --config "$scratch/vehicle.yaml" --dataroot "$scratch" 2>&1) == *\ installed,* ]] ||
  fail "presets are not looked for in $share/config/radars"
/usr/bin/python3 -c 'from radar_dot.msg import EgoStatus, Flow, MovingObjects'

sed -n '/^```cpp$/,/^```$/{/^```/!p;}' "$source/docs/nodes.md" >"$scratch/example.h"
cmake -S "$source/test/package/downstream" -B "$scratch/build" -DCATKIN_ENABLE_TESTING=OFF \
  -DEXAMPLE="$scratch/example.h" >"$scratch/configure.log" 2>&1 ||
  { cat "$scratch/configure.log"; fail "the package downstream does not configure"; }
cmake --build "$scratch/build" >"$scratch/build.log" 2>&1 ||
  { cat "$scratch/build.log"; fail "the package downstream does not build"; }
for program in cluster_returns drive_straight load_nodelets; do
  "$scratch/build/devel/lib/downstream/$program" || fail "$program failed"
done
rm -rf "$scratch"
