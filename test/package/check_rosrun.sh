#!/usr/bin/env bash
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# check_rosrun.sh DEVEL PROGRAM help|found: rosrun finds the program, and its --help exits with 0 and says something.
set -euo pipefail
devel=$1 program=$2 what=$3
export PATH=/usr/bin:$PATH
set --  # else the next line reads them
set +u  # the generated script reads variables that may be unset
. "$devel/setup.bash"
set -u

package=$(rospack find radar_dot)
# rosrun searches the package folder, too, except build/ in it. It prefers a devel space elsewhere to one program in
# there; else it asks which one to start where other builds lie in the package folder.
others=$(find "$package" -path "$package/build" -prune -o -path "*/lib/radar_dot/$program" ! -path "$devel/*" -print)
case $devel in
  "$package"/*) allowed=0 ;;
  *) allowed=1 ;;
esac
if [ "$(grep -c . <<<"$others")" -gt "$allowed" ]; then
  echo "skipped: rosrun finds these as well; keep other builds outside the package folder:"
  echo "$others"
  exit 77
fi

case $what in
  help) output=$(rosrun radar_dot "$program" --help </dev/null) ;;
  found) output=$(rosrun --prefix ls radar_dot "$program" </dev/null) ;;
esac || { echo "rosrun radar_dot $program: $output" >&2; exit 1; }
echo "$output"
# It says so on its standard output, and may exit with 0, where it finds none or several.
[ -n "$output" ] && [[ $output != *'[rosrun]'* ]]
