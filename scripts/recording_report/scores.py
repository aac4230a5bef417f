# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reports of the evaluators as tables of the page."""
import json
import math
import os

from . import velocity_chart
from .recording import ReportError
from .velocity_chart import value_of


def load(paths):
    """(name of the file, report, its kind) of each JSON file."""
    reports = []
    for path in paths:
        try:
            with open(path, encoding="utf-8") as file:
                report = json.load(file)
            reports.append((os.path.basename(path), report, kind_of(report["overall"])))
        except OSError as error:
            raise ReportError(f"--scores: {path}: {error.strerror}")
        except (KeyError, TypeError, ValueError) as error:
            raise ReportError(f"--scores: {path}: not a JSON report of evaluate_ego_velocity, evaluate_segmentation or "
                              f"evaluate_bag ({type(error).__name__}: {error})")
    return reports


def kind_of(overall):
    for kind, key in (("velocity", "models"), ("masks", "iou"), ("recording", "compared")):
        if key in overall:
            return kind
    raise ValueError("neither models, iou nor compared in overall")


def velocity_rows(report):
    """(estimator, |v - v_true|, vx, vy, yaw rate); NaN where there is none."""
    overall = report["overall"]
    rows = []
    for label, path, _ in velocity_chart.ESTIMATORS:
        folder = path[:-len("velocity_mae")] if path.endswith("velocity_mae") else ""
        components = [value_of(overall, folder + key) if folder else math.nan
                      for key in ("vx_mae", "vy_mae", "yaw_rate_mae")]
        rows.append((label, value_of(overall, path), *components))
    return [row for row in rows if math.isfinite(row[1])]


def least_errors(reports):
    """Of the package's estimators and of the paper's four, m/s; None without a report of both."""
    overall = next((report["overall"] for _, report, kind in reports if kind == "velocity"), {})
    own, paper = [], []
    for _, path, _ in velocity_chart.ESTIMATORS:
        error = value_of(overall, path)
        if math.isfinite(error):
            (paper if path.startswith("mae/") else own).append(error)
    return (min(own), min(paper)) if own and paper else None


def mask_label(report):
    options, segmentation = (report.get("parameters", {}).get(key, {}) for key in ("options", "dynamic_segmentation"))
    pairs = {"keyframes": "pairs of keyframes", "next": "consecutive images"}.get(options.get("pairs"), "pairs of images")
    score = segmentation.get("score", "")
    return pairs + (", the paper's score" if score == "paper" else f", score {score}" if score else "")


def mask_row(report):
    overall = report["overall"]
    return [value_of(overall, key) for key in ("iou", "precision", "recall", "frames")]


def object_rows(report):
    """(kind, movers, recall, of those with returns, position in m, velocity in m/s)"""
    objects = report["overall"].get("objects") or {}
    rows = []
    for kind in ("vehicle", "cycle", "pedestrian"):
        if objects.get(f"movers_{kind}"):
            rows.append((kind, *(value_of(objects, f"{key}_{kind}") for key in (
                "movers", "recall", "recall_of_seen", "position_mae", "velocity_mae"))))
    return rows
