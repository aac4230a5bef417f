#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Bar chart of the ego-velocity error per scene and estimator, from evaluate_ego_velocity --json."""
import argparse
import json
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

LABELS = {
    "B1": "B1: least squares, all returns",
    "A1": "A1: least squares, static returns",
    "B2": "B2: RANSAC, all returns",
    "A2": "A2: RANSAC, static returns",
    "robust": "RANSAC + reweighted refinement",
}
COLOURS = {"B1": "#c44e52", "A1": "#dd8452", "B2": "#4c72b0", "A2": "#55a868", "robust": "#8172b3"}


def load(path):
    """Rows (scene name, {variant: error}) with the overall result last."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    rows = [(scene["scene"], scene["mae"]) for scene in report["scenes"]]
    return rows + [("overall", report["overall"]["mae"])]


def draw(rows, output):
    width = 0.8 / len(LABELS)
    figure, axes = plt.subplots(figsize=(max(7.0, 1.6 * len(rows)), 4.2), constrained_layout=True)
    for i, (variant, label) in enumerate(LABELS.items()):
        values = [mae.get(variant) for _, mae in rows]
        heights = [math.nan if value is None else value for value in values]
        positions = np.arange(len(rows)) + (i - (len(LABELS) - 1) / 2) * width
        axes.bar(positions, heights, width, label=label, color=COLOURS[variant])
    axes.set_xticks(np.arange(len(rows)))
    axes.set_xticklabels([name for name, _ in rows])
    axes.axvline(len(rows) - 1.5, color="0.7", linewidth=1)
    axes.set_ylabel("mean |v - v_gt| (m/s)")
    axes.set_title("Ego velocity from radar, planar model")
    axes.grid(axis="y", color="0.9")
    axes.set_axisbelow(True)
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(output, dpi=130)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("json", help="file written by evaluate_ego_velocity --json")
    parser.add_argument("--output", default="ego_velocity.png", help="picture to write (default: %(default)s)")
    arguments = parser.parse_args()
    try:
        draw(load(arguments.json), arguments.output)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"plot_ego_velocity: {arguments.json}: {type(error).__name__}: {error}")


if __name__ == "__main__":
    main()
