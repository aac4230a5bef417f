#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Kills tools (SIGKILL) at random times: killed_tools_test.py TOOLS DATAROOT [KILLS [SEED]].

Of every kind of output, what lies under its own name after each kill must be what an undisturbed run writes; a run
to the end must complete it and leave nothing else. DATAROOT is a simulated one (v1.0-sim); KILLS (3) for each tool.
"""
import os
import random
import subprocess
import sys
import tempfile
import time

TOOLS, DATAROOT = map(os.path.abspath, sys.argv[1:3])
KILLS = int(sys.argv[3]) if len(sys.argv) > 3 else 3
RANDOM = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
INPUT = ["--dataroot", DATAROOT, "--version", "v1.0-sim"]


def without_times(content):
    """A report, but for its measured times."""
    return b"\n".join(line for line in content.split(b"\n")
                      if b"seconds" not in line and b'"ms_' not in line and b'"sums"' not in line)


def contents(folder):
    """Content by path of all files that do not tell by their name that they are incomplete."""
    found = {}
    for path, _, names in os.walk(folder):
        for name in names:
            file = os.path.relpath(os.path.join(path, name), folder)
            if ".partial-" in file or ".replaced-" in file:
                continue
            with open(os.path.join(folder, file), "rb") as stream:
                content = stream.read()
            found[file] = without_times(content) if name.endswith(".json") else content
    return found


def leftovers(folder):
    return [name for path, folders, files in os.walk(folder) for name in folders + files
            if ".partial-" in name or ".replaced-" in name]


def run(command, folder, seconds=None):
    """In a folder, killed after so many seconds, or to the end. Its exit code, or None where it was killed."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        _, errors = process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None
    if process.returncode != 0:
        sys.exit("{}: exit code {}: {}".format(" ".join(command), process.returncode, errors.decode()))
    return process.returncode


def check(name, *arguments):
    """A tool that writes into the folder that it is started in."""
    command = [os.path.join(TOOLS, name)] + list(arguments)
    with tempfile.TemporaryDirectory() as scratch:
        whole, folder = os.path.join(scratch, "whole"), os.path.join(scratch, "killed")
        os.mkdir(whole)
        os.mkdir(folder)
        start = time.monotonic()
        run(command, whole)
        duration = time.monotonic() - start
        expected = contents(whole)
        assert expected, name + " wrote nothing"
        killed = left = 0
        for _ in range(KILLS):
            killed += run(command, folder, RANDOM.uniform(0.0, duration)) is None
            for file, content in contents(folder).items():
                if content != expected.get(file):
                    sys.exit("{}: {} looks complete and is not".format(name, file))
            left += bool(leftovers(folder))
        run(command, folder)
        found = contents(folder)
        if found != expected:
            sys.exit("{}: after the kills a run did not complete {}".format(
                name, [file for file in {**expected, **found} if expected.get(file) != found.get(file)]))
        if leftovers(folder):
            sys.exit("{}: the run after the kills left {}".format(name, leftovers(folder)))
        print("{}: {} of {} runs killed within {:.1f} s, after {} of them something lay about; complete and clean after "
              "one more".format(" ".join([name] + list(arguments[4:5])), killed, KILLS, duration, left))


check("nuscenes_to_bag", *INPUT, "--quiet")
check("nuscenes_to_bag", *INPUT, "--force")
check("evaluate_segmentation", *INPUT, "--json", "a.json", "--save-masks", ".", "--velocity", "ground_truth")
check("evaluate_ego_velocity", *INPUT, "--json", "a.json", "--csv", "a.csv")
check("simulate_drive", "--output", "drive", "--scenarios", "crossing", "--force", "--duration", "0.5", "--width", "128",
      "--height", "72", "--lidar-rate", "0", "--frames", "keyframes")
