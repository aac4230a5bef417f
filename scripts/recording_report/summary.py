# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a report says in a few lines: the same in the terminal and at the top of the page."""
import numpy as np

from . import scores


def lines(content, masks, reports, about=""):
    """(label, text) of each line."""
    motion, mean = content.motion, np.hypot(content.motion.twists.rows[:, 0], content.motion.twists.rows[:, 1]).mean()
    driven = f"{motion.distance():.0f} m in {motion.duration():.1f} s"
    kind, _, what = about.partition(" ")
    if kind not in ("simulated", "recorded"):
        kind, what = "recorded", about
    result = [(kind, f"{what}; {driven}" if what else f"{content.recording.title()}: {driven}"),
              ("estimated", estimated(content, masks))]
    errors = {name: absolute for name, _, absolute, _, _ in motion.errors()}
    if "vx" in errors:
        result.append(("forward speed", f"wrong by {errors['vx']:.3f} m/s on average, at a mean speed of {mean:.1f} m/s"))
    drift = motion.drift()
    if drift:
        result.append(("drift", f"{100 * drift[0] / drift[1]:.2f} % of the way: {drift[0]:.2f} m off after {drift[1]:.0f} m"))
    if masks.compared:
        result.append(("masks", f"IoU {masks.iou():.2f} with the true masks of {masks.compared} images (precision "
                                f"{masks.precision():.2f}, recall {masks.recall():.2f})"))
    least = scores.least_errors(reports)
    if least:
        result.append(("comparison", f"velocity off by {least[0]:.3f} m/s, by the paper's planar estimators {least[1]:.3f} m/s at "
                                     "best"))
    return result


def estimated(content, masks):
    sweeps = len(content.sweeps.series)
    parts = [f"{len(content.motion.twists)} velocities" + (f" out of {sweeps} radar sweeps" if sweeps else "")]
    if masks.count:
        parts.append(f"{masks.count} masks of moving pixels")
    if len(content.objects.rows):
        parts.append(f"{len(np.unique(content.objects.rows[:, 1]))} tracked objects")
    return ", ".join(parts)
