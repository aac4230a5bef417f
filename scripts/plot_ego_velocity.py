#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Bar chart of the ego-velocity error per scene, from evaluate_ego_velocity --json: the package's filter and single
sweeps, then the paper's four estimators."""
import argparse
import json
import os
import sys

from recording_report import velocity_chart


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("json", help="file written by evaluate_ego_velocity --json")
    parser.add_argument("--output", default="ego_velocity.png", help="picture to write (default: %(default)s)")
    arguments = parser.parse_args()
    try:
        with open(arguments.json, encoding="utf-8") as file:
            rows = velocity_chart.rows_of(json.load(file))
    except (OSError, AttributeError, KeyError, TypeError, ValueError) as error:
        sys.exit(f"plot_ego_velocity: {arguments.json}: not written by evaluate_ego_velocity --json: "
                 f"{type(error).__name__}: {error}")
    ending = os.path.splitext(arguments.output)[1]
    temporary = arguments.output + ".part" + ending
    try:
        velocity_chart.draw(rows).savefig(temporary, dpi=130)
        os.replace(temporary, arguments.output)
    except (OSError, ValueError) as error:
        sys.exit(f"plot_ego_velocity: --output: {error}")


if __name__ == "__main__":
    main()
