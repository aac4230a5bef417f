# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""The plots of a report, each as SVG in a data URI."""
import base64
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from .extraction import in_world

ESTIMATE, REFERENCE, STATIC, DYNAMIC, OBJECT, MUTED = "#1f5fa8", "#d9730d", "#7d8a97", "#c2185b", "#2e7d32", "#9aa4ae"
RADARS = ("#1f5fa8", "#d9730d", "#2e7d32", "#8e44ad", "#c2185b", "#00838f", "#6d4c41", "#546e7a")
WIDTH = 10.0  # inches, of all figures
MOST_POINTS = 40000  # drawn in one figure
AROUND = 60.0  # m, seen around the path and the vehicle
MOST_LABELS = 8  # of objects
MOST_ROWS = 6000  # of a line
STYLE = {"font.size": 9.5, "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#8c959f",
         "axes.labelcolor": "#24292f", "xtick.color": "#57606a", "ytick.color": "#57606a", "axes.grid": True,
         "grid.color": "#e7eaee", "grid.linewidth": 0.8, "axes.axisbelow": True, "legend.frameon": False,
         "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left", "lines.linewidth": 1.4,
         "svg.hashsalt": "radar_dot"}


def figure(rows, columns, height, **options):
    for key, value in STYLE.items():
        if key in matplotlib.rcParams:
            matplotlib.rcParams[key] = value
    return plt.subplots(rows, columns, figsize=(WIDTH, height), constrained_layout=True, squeeze=False, **options)


def data_uri(kind, content):
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def finished(drawn):
    stream = io.BytesIO()
    drawn.savefig(stream, format="svg", dpi=160)  # dpi: of the rasterised points
    plt.close(drawn)
    return data_uri("image/svg+xml", stream.getvalue())


def thinned(rows, most):
    return rows[::max(1, -(-len(rows) // most))]


def motion(content):
    """Each component over time, and its error where there is a reference."""
    data, names = content.motion, ("forward speed vx (m/s)", "sideslip vy (m/s)", "yaw rate (rad/s)")
    compared = len(data.reference_twists) > 1
    drawn, axes = figure(3, 1 + compared, 7.2, sharex=True,
                         gridspec_kw={"width_ratios": (3, 2)[:1 + compared]})
    start = data.start()
    rows = thinned(np.column_stack([data.twists.times - start, data.twists.rows]), MOST_ROWS)
    raw = thinned(np.column_stack([data.raw_twists.times - start, data.raw_twists.rows]), MOST_ROWS)
    truth, raw_truth = ((data.reference_twists.at(part[:, 0] + start) if compared else None) for part in (rows, raw))
    for i, name in enumerate(names):
        axis, times, value, sigma = axes[i, 0], rows[:, 0], rows[:, 1 + i], rows[:, 4 + i]
        value = np.where(np.isfinite(sigma), value, np.nan)
        raw_value = np.where(np.isfinite(raw[:, 4 + i]), raw[:, 1 + i], np.nan)
        estimates(axis, raw[:, 0], raw_value, times, value, sigma)
        if compared:
            axis.plot(times, truth[:, i], "--", color=REFERENCE, label=content.reference_name)
            error = value - truth[:, i]
            estimates(axes[i, 1], raw[:, 0], raw_value - raw_truth[:, i], times, error, sigma, centre=0 * times)
            axes[i, 1].axhline(0, color=REFERENCE, linestyle="--")
            seen = error[np.isfinite(error)]
            if len(seen):  # a jump of the reference must not flatten the rest
                error = np.clip(error, *np.percentile(seen, (1, 99)))
            limit_to_estimate(axes[i, 1], np.concatenate([error, 3.2 * sigma, -3.2 * sigma]), np.tile(sigma, 3))
        limit_to_estimate(axis, value, sigma)
        axis.set_ylabel(name)
    if compared:
        axes[0, 1].set_title(f"error against the {content.reference_name}")
    axes[0, 0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=4, borderaxespad=0.1)
    axes[0, 0].set_xlim(0, data.duration())
    for axis in axes[-1]:
        axis.set_xlabel("time (s)")
    drawn.align_ylabels()
    return finished(drawn)


def estimates(axis, raw_times, raw_values, times, values, sigma, centre=None):
    """One component, with its band of three standard deviations around the values, or around the centre."""
    seen = np.isfinite(sigma)
    band, centre = 3 * np.where(seen, sigma, np.nan), values if centre is None else centre
    if len(raw_times):
        axis.plot(raw_times, raw_values, ".", color=MUTED, markersize=4, label="one sweep alone")
    axis.fill_between(times, centre - band, centre + band, where=seen, color=ESTIMATE, alpha=0.18, linewidth=0,
                      label=r"3 $\sigma$")
    axis.plot(times, values, color=ESTIMATE, label="radar_dot")


def limit_to_estimate(axis, values, sigma):
    """A few wide bands or stray sweeps must not flatten the rest."""
    seen = np.isfinite(sigma) & np.isfinite(values)
    if not seen.any():
        return
    room = 4 * np.median(sigma[seen]) + 0.05
    room = max(room, 0.25 * (values[seen].max() - values[seen].min()))
    axis.set_ylim(values[seen].min() - room, values[seen].max() + room)


def path(content):
    drawn, axes = figure(1, 1, 5.2)
    axis, poses = axes[0, 0], content.motion.poses
    reference = content.motion.aligned_reference()
    axis.plot(*thinned(poses.rows[:, :2], MOST_ROWS).T, color=ESTIMATE, linewidth=2, label="odom")
    if reference:
        axis.plot(*thinned(reference[0], MOST_ROWS).T, "--", color=REFERENCE,
                  label=content.reference_name)
    axis.plot(*poses.rows[0, :2], "o", color="white", markeredgecolor=ESTIMATE, markersize=8, label="start")
    axis.plot(*poses.rows[-1, :2], "s", color=ESTIMATE, markersize=7, label="end")
    square(axis, poses.rows[:, :2], "x (m)", "y (m)")
    axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return finished(drawn)


def square(axis, points, x_label, y_label, least=10.0):
    """Equal scales, with room around the points, wide as the figure."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, reach = (low + high) / 2, np.maximum((high - low) / 2 * 1.12, least)
    axis.set_xlim(middle[0] - reach[0], middle[0] + reach[0])
    axis.set_ylim(middle[1] - reach[1], middle[1] + reach[1])
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel(x_label)
    axis.set_ylabel(y_label)


def points(axis, xy, dynamic, size):
    for wanted, colour, label, scale in ((False, STATIC, "static", 1.0), (True, DYNAMIC, "dynamic", 2.0)):
        chosen = thinned(xy[dynamic == wanted], MOST_POINTS)
        axis.plot(chosen[:, 0], chosen[:, 1], "o", color=colour, markersize=size * scale, markeredgewidth=0,
                  alpha=0.75, label=f"{label} returns", rasterized=True)


def surroundings(content):
    """All returns and tracks in the frame of the odometry; None without mounts and poses."""
    returns, poses = content.returns, content.motion.poses
    if len(poses) < 2:
        return None
    xy = in_world(returns.in_base(content.mounts), returns.rows[:, 0], poses)
    known = np.isfinite(xy[:, 0])
    if not known.any():
        return None
    drawn, axes = figure(1, 1, 6.4)
    axis = axes[0, 0]
    points(axis, xy[known], returns.rows[known, 6], 1.1)
    axis.plot(*thinned(poses.rows[:, :2], MOST_ROWS).T, color=ESTIMATE, linewidth=2, label="own path")
    tracks = object_tracks(content)
    for i, track in enumerate(tracks):
        axis.plot(track[:, 0], track[:, 1], color=OBJECT, linewidth=1.3, label=None if i else "tracked objects")
    square(axis, np.concatenate([poses.rows[:, :2] - AROUND, poses.rows[:, :2] + AROUND]), "x (m)", "y (m)")
    axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), markerscale=3)
    return finished(drawn)


def object_tracks(content):
    rows = content.objects.rows
    xy = rows[:, 2:4]
    if content.objects.frame == content.motion.base_frame:
        xy = in_world(xy, rows[:, 0], content.motion.poses)
    return [xy[rows[:, 1] == one] for one in np.unique(rows[:, 1])]


def busiest_moment(content):
    """(time, returns of the scans just before it), with the most objects, then dynamic returns."""
    times, counts = np.unique(content.objects.rows[:, 0], return_counts=True)
    if not len(times):
        times, counts = np.unique(content.returns.rows[content.returns.rows[:, 6] > 0, 0], return_counts=True)
    time = times[np.argmax(counts)] if len(times) else np.median(content.returns.rows[:, 0])
    return time, (content.returns.rows[:, 0] > time - 0.1) & (content.returns.rows[:, 0] <= time)


def snapshot(content):
    """One sweep and its objects in the frame of the vehicle; None without mounts."""
    xy = content.returns.in_base(content.mounts)
    if not np.isfinite(xy[:, 0]).any():
        return None
    time, now = busiest_moment(content)
    now = now & np.isfinite(xy[:, 0])
    if not now.any():
        return None
    drawn, axes = figure(1, 1, 5.0)
    axis = axes[0, 0]
    points(axis, xy[now], content.returns.rows[now, 6], 3.2)
    objects = content.objects.rows[content.objects.rows[:, 0] == time]
    if len(objects) and (content.objects.frame == content.motion.base_frame or len(content.motion.poses) > 1):
        at, speed = objects[:, 2:4], objects[:, 4:6]
        if content.objects.frame != content.motion.base_frame:
            x, y, yaw = content.motion.poses.at(time, angles=(2,))
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            at, speed = (at - [x, y]) @ turn, speed @ turn
        axis.quiver(*at.T, *speed.T, angles="xy", scale_units="xy", scale=1.0, color=OBJECT, width=0.0035)
        axis.plot(*at.T, "o", markersize=9, markerfacecolor="none", markeredgecolor=OBJECT, markeredgewidth=1.6,
                  label="tracked objects")
        nearest = np.argsort(np.hypot(*at.T))[:MOST_LABELS]
        for rank, i in enumerate(nearest[np.argsort(at[nearest, 0])]):  # in turn above and below
            axis.annotate(f"#{objects[i, 1]:.0f} {np.hypot(*speed[i]):.1f} m/s", at[i], xytext=(7, (9, -16)[rank % 2]),
                          textcoords="offset points", color=OBJECT, fontsize=8.5, clip_on=True)
    axis.plot([0], [0], marker=(3, 0, -90), color=ESTIMATE, markersize=13, linestyle="none", label="own vehicle")
    limit = np.array([0.8 * AROUND, 0.4 * AROUND])  # as the figure is wide and low
    seen = np.clip(np.percentile(xy[now], (5, 95), axis=0), -limit, limit)
    square(axis, np.concatenate([seen, [[0.0, 0.0]]]), "ahead (m)", "to the left (m)")
    axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return finished(drawn)


def residuals(content):
    """Residual over azimuth of each radar, with the median of the static returns."""
    returns = content.returns
    columns = min(3, len(returns.frames))
    rows = -(-len(returns.frames) // columns)
    drawn, axes = figure(rows, columns, 0.5 + 2.5 * rows, sharex=True, sharey=True)
    static = returns.rows[returns.rows[:, 6] == 0]
    limit = max(0.3, 1.5 * np.percentile(np.abs(static[:, 5]), 99)) if len(static) else 1.0
    for axis in axes.flat[len(returns.frames):]:
        axis.set_visible(False)
    order = sorted(range(len(returns.frames)), key=lambda i: content.radar_name(returns.frames[i]))
    for axis, i in zip(axes.flat, order):
        own = returns.rows[returns.rows[:, 1] == i]
        azimuth = np.degrees(np.arctan2(own[:, 3], own[:, 2]))
        points(axis, np.column_stack([azimuth, own[:, 5]]), own[:, 6], 1.3)
        axis.plot(*running_median(azimuth[own[:, 6] == 0], own[own[:, 6] == 0, 5]), color=ESTIMATE, linewidth=2,
                  label="median of the static returns")
        axis.set_title(content.radar_name(returns.frames[i]))
        axis.set_ylim(-limit, limit)
    for axis in axes[:, 0]:
        axis.set_ylabel("residual (m/s)")
    for axis in axes.flat[max(0, len(returns.frames) - columns):len(returns.frames)]:
        axis.set_xlabel("azimuth (degrees)")
        axis.tick_params(labelbottom=True)
    drawn.suptitle(" ")  # room for the legend
    drawn.legend(*axes.flat[0].get_legend_handles_labels(), loc="upper right", ncol=3, markerscale=3)
    return finished(drawn)


def running_median(x, y, least=15):
    edges = np.arange(-180, 181, 5)
    middles, medians = [], []
    for low, high in zip(edges, edges[1:]):
        inside = (x >= low) & (x < high)
        if np.count_nonzero(inside) >= least:
            middles.append((low + high) / 2)
            medians.append(np.median(y[inside]))
    return middles, medians


def radars(content):
    """Shares of inliers, and what the mounts seem to be turned by where radars are compared, over time."""
    compared = any(np.isfinite(radar["series"].rows[:, 6]).any() for radar in content.health.radars.values())
    drawn, axes = figure(1 + compared, 1, 2.6 + 2.2 * compared, sharex=True)
    for (name, radar), colour in zip(sorted(content.health.radars.items()), RADARS * 9):
        times, rows = radar["series"].times - content.motion.start(), radar["series"].rows
        axes[0, 0].plot(times, 100 * rows[:, 0], "o-", color=colour, markersize=3, label=name)
        if compared:
            yaw, sigma = 1e3 * rows[:, 5], 1e3 * rows[:, 6]
            axes[1, 0].plot(times, np.where(np.isfinite(sigma), yaw, np.nan), "o-", color=colour, markersize=3)
            axes[1, 0].fill_between(times, yaw - sigma, yaw + sigma, where=np.isfinite(sigma), color=colour, alpha=0.08,
                                    linewidth=0)
    axes[0, 0].set_ylim(0, 102)
    axes[0, 0].set_ylabel("inliers (%)")
    if compared:
        axes[1, 0].axhline(0, color="#57606a", linewidth=0.8)
        axes[1, 0].set_ylabel("yaw correction (mrad)")
    axes[-1, 0].set_xlabel("time (s)")
    axes[0, 0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    drawn.align_ylabels()
    return finished(drawn)


def sweeps(content):
    drawn, axes = figure(2, 1, 3.8, sharex=True)
    series = content.sweeps.series
    times = series.times - content.motion.start()
    refused = series.rows[:, 2] == 0
    axes[0, 0].plot(*thinned(np.column_stack([times, 100 * content.sweeps.shares()]), MOST_ROWS).T, color=ESTIMATE)
    axes[0, 0].set_ylim(0, 102)
    axes[0, 0].set_ylabel("inliers (%)")
    for column, colour, label in ((0, STATIC, "accepted"), (1, ESTIMATE, "inliers")):
        axes[1, 0].plot(*thinned(np.column_stack([times, series.rows[:, column]]), MOST_ROWS).T, color=colour,
                        label=label)
    if refused.any():
        axes[1, 0].plot(times[refused], np.zeros(np.count_nonzero(refused)), "|", color=DYNAMIC, markersize=14,
                        label="sweep refused")
    axes[1, 0].set_ylim(0, None)
    axes[1, 0].set_ylabel("returns")
    axes[1, 0].set_xlabel("time (s)")
    axes[1, 0].legend(loc="lower left", ncol=3)
    drawn.align_ylabels()
    return finished(drawn)


def ages(content):
    names = [name for name, values in content.ages.items() if len(values)]
    drawn, axes = figure(1, 1, 0.9 + 0.42 * len(names))
    axis = axes[0, 0]
    axis.boxplot([1e3 * content.ages[name] for name in names], vert=False, widths=0.55, whis=(5, 95), showfliers=False,
                 patch_artist=True, boxprops={"facecolor": "#dbe7f5", "edgecolor": ESTIMATE},
                 medianprops={"color": ESTIMATE, "linewidth": 2}, whiskerprops={"color": ESTIMATE},
                 capprops={"color": ESTIMATE})
    axis.set_yticklabels(names)
    axis.invert_yaxis()
    axis.grid(False, axis="y")
    axis.set_xlabel("age (ms)")
    return finished(drawn)
