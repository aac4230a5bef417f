# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Bar chart of the error of the ego velocity, from the JSON report of evaluate_ego_velocity."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ESTIMATORS = (  # (label, path in the report, colour): the package's best first, then the paper's four
    ("radar_dot: filtered", "causal/filter/velocity_mae", "#1f5fa8"),
    ("radar_dot: one sweep", "models/planar_yaw/velocity_mae", "#7fb0e6"),
    ("A2: static returns, RANSAC", "mae/A2", "#5f6b76"),
    ("A1: static returns", "mae/A1", "#8a949e"),
    ("B2: all returns, RANSAC", "mae/B2", "#b3bac1"),
    ("B1: all returns", "mae/B1", "#d5d9dd"),
)
MOST_LABELLED = 3  # groups with numbers on all bars; with more, on the first of each
MOST_LABELS_ABREAST = 4  # groups whose names need no turning


def value_of(figures, path):
    """NaN where the report has no such figure."""
    for key in path.split("/"):
        figures = figures.get(key) if isinstance(figures, dict) else None
    return float("nan") if figures is None else figures


def rows_of(report):
    """(name, error of each of ESTIMATORS in m/s) by scene, the overall result last where there are several.
    ValueError, KeyError: not of evaluate_ego_velocity."""
    scenes = [(scene["scene"], scene) for scene in report["scenes"]]
    if len(scenes) != 1:
        scenes.append(("overall", report["overall"]))
    rows = [(name, [value_of(figures, path) for _, path, _ in ESTIMATORS]) for name, figures in scenes]
    if not any(np.isfinite(values).any() for _, values in rows):
        raise ValueError("there is no error of the ego velocity in it")
    return rows


def draw(rows):
    """The figure, with its legend beside the bars."""
    width = 0.84 / len(ESTIMATORS)
    figure, axes = plt.subplots(figsize=(min(30.0, max(10.0, 4.0 + 1.2 * len(rows))), 3.4), constrained_layout=True)
    for i, (label, _, colour) in enumerate(ESTIMATORS):
        heights = [values[i] for _, values in rows]
        positions = np.arange(len(rows)) + (i - (len(ESTIMATORS) - 1) / 2) * width
        axes.bar(positions, heights, 0.92 * width, label=label, color=colour)
        for x, height in zip(positions, heights):
            if (len(rows) <= MOST_LABELLED or i == 0) and np.isfinite(height):
                text = f"{height:.3f}" if len(rows) < 3 else f"{height:.2f}"
                axes.annotate(text, (x, height), (0, 2), textcoords="offset points", ha="center", fontsize=7.5)
    axes.set_xticks(np.arange(len(rows)))
    turned = len(rows) > MOST_LABELS_ABREAST and len(rows) * max(len(name) for name, _ in rows) > 90
    axes.set_xticklabels([name for name, _ in rows], **({"rotation": 60, "ha": "right"} if turned else {}))
    if len(rows) > 1:
        axes.axvline(len(rows) - 1.5, color="0.7", linewidth=1)
    axes.margins(y=0.1)
    axes.set_ylim(0, None)
    axes.set_ylabel("mean |v - v_true| (m/s)")
    axes.set_title("Error of the ego velocity; gray: the paper's planar model, which knows no yaw rate", fontsize=10)
    axes.grid(axis="y", color="0.9")
    axes.grid(False, axis="x")
    axes.set_axisbelow(True)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=9)
    return figure
