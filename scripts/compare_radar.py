#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Prints what the radar returns of nuScenes dataroots look like, real and simulated side by side with their ratio.

Metres, degrees, m/s, dBsm. Residual: Doppler of a return minus that of a static one at its bearing, from the vehicle's
true motion. Its sigma is 1.4826 MAD over valid returns with |residual| < 1 m/s while the vehicle moves.
"""
import argparse
import json
import os
import re
import sys

import numpy as np

RECORD = np.dtype([
    ("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("dyn_prop", "i1"), ("id", "<i2"), ("rcs", "<f4"), ("vx", "<f4"),
    ("vy", "<f4"), ("vx_comp", "<f4"), ("vy_comp", "<f4"), ("is_quality_valid", "i1"), ("ambig_state", "i1"),
    ("x_rms", "i1"), ("y_rms", "i1"), ("invalid_state", "i1"), ("pdh0", "i1"), ("vx_rms", "i1"), ("vy_rms", "i1")])
CHANNELS = ("RADAR_FRONT", "RADAR_FRONT_LEFT", "RADAR_FRONT_RIGHT", "RADAR_BACK_LEFT", "RADAR_BACK_RIGHT")
GROUPS = (("all", CHANNELS), ("front", CHANNELS[:1]), ("corner", CHANNELS[1:3]), ("back", CHANNELS[3:]))
POSE_WINDOW_S = 0.15
STATIC_RESIDUAL = 1.0  # m/s
STANDING_SPEED = 0.5  # m/s; slower, residuals are exactly zero and say nothing about noise
AZIMUTH_BANDS = ((0, 15), (15, 30), (30, 45), (45, 61))
STATE_FIELDS = ("invalid_state", "ambig_state", "pdh0", "dyn_prop", "is_quality_valid", "x_rms", "y_rms", "vx_rms",
                "vy_rms")
BAR = ("returns per scan", "valid share", "static residual sigma")


class DataError(Exception):
    """What is wrong with the input, in one line."""


def load_table(root, version, name):
    path = os.path.join(root, version, name + ".json")
    try:
        with open(path) as file:
            return json.load(file)
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}; is this a nuScenes dataroot of version {version}?")
    except ValueError as error:
        raise DataError(f"{path}: not JSON ({error})")


def read_scan(path):
    """Returns of a radar file, structured, without the all-NaN point that stands for none."""
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}")
    header_end = content.find(b"DATA binary\n")
    points = re.search(rb"\nPOINTS (\d+)", content[:max(header_end, 0)])
    fields = re.search(rb"\nFIELDS ([^\n]*)", content[:max(header_end, 0)])
    if header_end < 0 or not points or not fields:
        raise DataError(f"{path}: not a binary PCD file")
    if fields.group(1).decode(errors="replace").split() != list(RECORD.names):
        raise DataError(f"{path}: its fields are not those of a nuScenes radar file")
    start, count = header_end + len(b"DATA binary\n"), int(points.group(1))
    if len(content) < start + count * RECORD.itemsize:
        raise DataError(f"{path}: ends before the {count} points of its header")
    scan = np.frombuffer(content, RECORD, count, start)
    return scan[np.isfinite(scan["x"]) & np.isfinite(scan["y"])]


def yaw_of(rotation):
    w, x, y, z = np.moveaxis(np.asarray(rotation, float), -1, 0)
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def vehicle_motion(times, positions, yaws, at):
    """Velocity in the base frame and yaw rate: a parabola through the poses around."""
    near = np.flatnonzero(np.abs(times - at) <= POSE_WINDOW_S)
    offsets = times[near] - at
    distinct = len(np.unique(offsets))
    if distinct < 2:
        return None
    degree = min(2, distinct - 1)
    fit = np.polyfit(offsets, np.column_stack([positions[near], yaws[near]]), degree)
    (east, north, yaw_rate), heading = fit[-2], fit[-1][2]
    cos, sin = np.cos(heading), np.sin(heading)
    return np.array([cos * east + sin * north, cos * north - sin * east]), yaw_rate


def scene_readings(root, version, wanted):
    """Name of each scene -> its sample_data with channel, pose and calibration, in time order."""
    sensors = {row["token"]: row["channel"] for row in load_table(root, version, "sensor")}
    calibrations = {row["token"]: row for row in load_table(root, version, "calibrated_sensor")}
    poses = {row["token"]: row for row in load_table(root, version, "ego_pose")}
    names = {row["token"]: row["name"] for row in load_table(root, version, "scene")}
    unknown = sorted(set(wanted or ()) - set(names.values()))
    if unknown:
        raise DataError(f"{root}: no scene {unknown[0]}; there are {', '.join(sorted(names.values()))}")
    scenes_of_samples = {row["token"]: names[row["scene_token"]] for row in load_table(root, version, "sample")}
    scenes = {}
    for row in load_table(root, version, "sample_data"):
        scene = scenes_of_samples[row["sample_token"]]
        if wanted and scene not in wanted:
            continue
        calibration = calibrations[row["calibrated_sensor_token"]]
        scenes.setdefault(scene, []).append(
            (row["timestamp"] * 1e-6, sensors[calibration["sensor_token"]], poses[row["ego_pose_token"]], calibration,
             row["filename"]))
    for readings in scenes.values():
        readings.sort(key=lambda reading: reading[0])
    return scenes


def add_columns(scan, motion, calibration):
    """Range, azimuth, residual and more, as a dictionary of columns."""
    x, y = scan["x"].astype(float), scan["y"].astype(float)
    columns = {name: scan[name] for name in RECORD.names}
    columns["range"] = np.hypot(x, y)
    bearing = np.stack([x, y]) / np.maximum(columns["range"], 1e-6)
    columns["azimuth"] = np.degrees(np.arctan2(y, x))
    doppler = bearing[0] * scan["vx"] + bearing[1] * scan["vy"]
    ones = np.ones(len(scan))
    if motion is None:
        columns.update({name: np.nan * ones for name in ("residual", "speed", "turned_vy")})
        return columns
    velocity, yaw_rate = motion
    mount_x, mount_y = calibration["translation"][:2]
    mount_yaw = yaw_of(calibration["rotation"])
    at_mount = velocity + yaw_rate * np.array([-mount_y, mount_x])
    cos, sin = np.cos(mount_yaw), np.sin(mount_yaw)
    own = np.array([cos * at_mount[0] + sin * at_mount[1], cos * at_mount[1] - sin * at_mount[0]])
    columns["residual"] = doppler + own @ bearing
    columns["speed"] = np.hypot(*velocity) * ones
    columns["turned_vy"] = -yaw_rate * x
    columns["yaw_rate"] = yaw_rate * ones
    return columns


def read_dataroot(root, version, wanted=None):
    """Channel -> {"counts": returns per scan, "columns": columns of all its returns}."""
    collected = {channel: ([], []) for channel in CHANNELS}
    for readings in scene_readings(root, version, wanted).values():
        times = np.array([reading[0] for reading in readings])
        positions = np.array([reading[2]["translation"][:2] for reading in readings])
        yaws = np.unwrap(yaw_of([reading[2]["rotation"] for reading in readings]))
        for time, channel, _, calibration, filename in readings:
            if channel not in collected:
                continue
            motion = vehicle_motion(times - times[0], positions, yaws, time - times[0])
            scan = read_scan(os.path.join(root, filename))
            collected[channel][0].append(len(scan))
            collected[channel][1].append(add_columns(scan, motion, calibration))
    if not any(counts for counts, _ in collected.values()):
        raise DataError(f"{root}: no radar reading in version {version}")
    return {channel: {"counts": np.array(counts), "columns": concatenate(parts)}
            for channel, (counts, parts) in collected.items() if counts}


def concatenate(parts):
    names = set.intersection(*(set(part) for part in parts))
    return {name: np.concatenate([part[name] for part in parts]) for name in names}


def robust_sigma(values):
    return 1.4826 * float(np.median(np.abs(values - np.median(values)))) if len(values) else float("nan")


def share(mask):
    return float(np.mean(mask)) if len(mask) else float("nan")


def static_mask(columns):
    return (columns["invalid_state"] == 0) & (np.abs(columns["residual"]) < STATIC_RESIDUAL)


def sigma_mask(columns):
    return static_mask(columns) & (columns["speed"] > STANDING_SPEED) & (columns["dyn_prop"] != 4)


def bar_figures(channels):
    """The figures that a simulation is held to: {name: value} of some channels of read_dataroot()."""
    counts = np.concatenate([channel["counts"] for channel in channels])
    columns = concatenate([channel["columns"] for channel in channels])
    return {"returns per scan": float(counts.mean()), "valid share": share(columns["invalid_state"] == 0),
            "static residual sigma": robust_sigma(columns["residual"][sigma_mask(columns)])}


def bar_ratios(simulated, real):
    """{"all" or channel: {figure: simulated / real}}."""
    def ratios(names):
        ours, theirs = bar_figures([simulated[n] for n in names]), bar_figures([real[n] for n in names])
        return {name: ours[name] / theirs[name] if theirs[name] else float("nan") for name in BAR}
    shared = [channel for channel in CHANNELS if channel in simulated and channel in real]
    if not shared:
        raise DataError("the dataroots share no radar channel")
    return {"all": ratios(shared), **{channel: ratios([channel]) for channel in shared}}


def quantisation_step(values):
    """The most frequent distance between neighbouring values."""
    steps = np.diff(np.unique(np.round(values.astype(float), 3)))
    if len(steps) == 0:
        return float("nan")
    distinct, counts = np.unique(np.round(steps, 3), return_counts=True)
    return float(distinct[np.argmax(counts)])


def velocity_figures(columns):
    """What (vx, vy) hold."""
    taken = static_mask(columns) & (columns["ambig_state"] == 3) & np.isin(columns["dyn_prop"], (1, 3))
    vy, turned = columns["vy"][taken].astype(float), columns["turned_vy"][taken]
    slope = np.polyfit(turned, vy, 1)[0] if len(vy) > 10 and np.ptp(turned) > 0.1 else float("nan")
    across = np.abs(columns["vx"] * np.sin(np.radians(columns["azimuth"])) -
                    columns["vy"] * np.cos(np.radians(columns["azimuth"])))
    over_ground = np.hypot(columns["vx_comp"], columns["vy_comp"])
    comp_across = np.abs(columns["vx_comp"] * np.sin(np.radians(columns["azimuth"])) -
                         columns["vy_comp"] * np.cos(np.radians(columns["azimuth"])))
    moving = (columns["invalid_state"] == 0) & (np.abs(columns["residual"]) >= STATIC_RESIDUAL)
    known = columns["dyn_prop"] != 4
    return {
        "vx step": quantisation_step(columns["vx"]), "vy step": quantisation_step(columns["vy"]),
        "vy = 0, static class": share(vy == 0), "vy = 0, dyn_prop 0 or 2":
            share(columns["vy"][np.isin(columns["dyn_prop"], (0, 2))] == 0),
        "slope of vy over -yaw_rate x": float(slope),
        "|(vx,vy)| across the bearing, 90 %": percentile(across[taken & known], 90),
        "share of (vx,vy) not radial (> 0.5 m/s across)": share(across[taken & known] > 0.5),
        "|comp| across the bearing, 99 %": percentile(comp_across, 99),
        "|comp| of static, 50 %": percentile(over_ground[taken], 50),
        "dynamic share of valid": share(moving[columns["invalid_state"] == 0]),
        "ghosts (doubtful velocity, not static, invalid)":
            share((columns["invalid_state"] != 0) & (np.abs(columns["residual"]) >= STATIC_RESIDUAL) & known),
    }


def percentile(values, at):
    return float(np.percentile(values, at)) if len(values) else float("nan")


def figures(channels):
    """All figures of some channels: {name: value}."""
    columns = concatenate([channel["columns"] for channel in channels])
    counts = np.concatenate([channel["counts"] for channel in channels])
    valid = columns["invalid_state"] == 0
    result = {"scans": len(counts), **bar_figures(channels)}
    result["returns per scan, 10 / 50 / 90 %"] = [percentile(counts, p) for p in (10, 50, 90)]
    result["share of full scans (125)"] = share(counts >= 125)
    result["default filter share"] = share(valid & (columns["ambig_state"] == 3) & (columns["pdh0"] == 1))
    for name in ("range", "azimuth", "rcs"):
        for label, mask in (("", np.ones(len(valid), bool)), (", valid", valid)):
            result[f"{name}{label}, 1 / 10 / 25 / 50 / 75 / 90 / 99 %"] = [
                percentile(columns[name][mask], p) for p in (1, 10, 25, 50, 75, 90, 99)]
    result["z, smallest / largest"] = [percentile(columns["z"], 0), percentile(columns["z"], 100)]
    result["id, smallest / largest"] = [percentile(columns["id"], 0), percentile(columns["id"], 100)]
    result["x step / y step / rcs step"] = [quantisation_step(columns[name]) for name in ("x", "y", "rcs")]
    static = sigma_mask(columns)
    for low, high in AZIMUTH_BANDS:
        band = static & (np.abs(columns["azimuth"]) >= low) & (np.abs(columns["azimuth"]) < high)
        result[f"static residual sigma, {low} to {high} deg"] = robust_sigma(columns["residual"][band])
    standing = static_mask(columns) & (columns["speed"] < 0.05)
    result["static residual, standing, 5 / 95 %"] = [percentile(columns["residual"][standing], p) for p in (5, 95)]
    result.update(velocity_figures(columns))
    for name in STATE_FIELDS:
        values, occurrences = np.unique(columns[name], return_counts=True)
        for value, occurrence in zip(values, occurrences):
            result[f"{name} = {value}"] = occurrence / len(valid) if len(valid) else float("nan")
    return result


def grouped_figures(dataroot):
    return {name: figures([dataroot[channel] for channel in channels if channel in dataroot])
            for name, channels in GROUPS if any(channel in dataroot for channel in channels)}


def show(value):
    if value is None:
        return "-"
    if isinstance(value, list):
        return " ".join(show(element) for element in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def show_ratio(real, simulated):
    if real is None or simulated is None:
        return ""
    if isinstance(real, list):
        return " ".join(show_ratio(a, b) for a, b in zip(real, simulated))
    return f"{simulated / real:.2f}" if real and np.isfinite(simulated / real) else "-"


def print_table(real, simulated):
    for group, rows in real.items():
        other = (simulated or {}).get(group, {})
        names = list(rows) + [name for name in other if name not in rows]
        names.sort(key=lambda name: next((i for i, f in enumerate(STATE_FIELDS) if name.startswith(f + " =")), -1))
        print(f"\n{group}: " + ("real | simulated | simulated / real" if simulated else "real"))
        for name in names:
            # A value that occurs on one side only has share 0 on the other.
            missing = 0.0 if " = " in name and name.split(" = ")[0] in STATE_FIELDS else None
            a, b = rows.get(name, missing), other.get(name, missing)
            cells = [show(a)] + ([show(b), show_ratio(a, b)] if simulated else [])
            print(f"  {name:<52} " + " | ".join(f"{cell:<10}" for cell in cells).rstrip())


def print_ratios(ratios):
    print("\nsimulated / real (bar: 0.8 to 1.2)")
    print(f"  {'':<18} " + " ".join(f"{name:>22}" for name in BAR))
    for name, row in ratios.items():
        print(f"  {name:<18} " + " ".join(f"{row[figure]:>22.3f}" for figure in BAR))


def plot(path, real, simulated):
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        raise DataError("--plot needs matplotlib (Debian: python3-matplotlib)")
    bins = {"range": np.arange(0, 150, 3), "azimuth": np.arange(-75, 76, 3), "rcs": np.arange(-5, 35, 1),
            "residual": np.arange(-1, 1.01, 0.05), "counts": np.arange(0, 131, 5)}
    figure, axes = plt.subplots(len(GROUPS), len(bins), figsize=(18, 12), squeeze=False)
    for row, (group, channels) in zip(axes, GROUPS):
        for axis, (name, edges) in zip(row, bins.items()):
            for label, dataroot in (("real", real), ("simulated", simulated)):
                parts = [dataroot[c] for c in channels if c in dataroot] if dataroot else []
                values = [part["counts"] if name == "counts" else part["columns"][name] for part in parts]
                if values:
                    axis.hist(np.concatenate(values), edges, density=True, histtype="step", label=label)
            axis.set_title(f"{group}: {name}", fontsize=9)
    axes[0][0].legend()
    figure.tight_layout()
    try:
        figure.savefig(path)
    except (OSError, ValueError) as error:
        raise DataError(f"{path}: cannot write the plot ({error})")


def without_nan(content):
    """JSON knows no NaN: null."""
    if isinstance(content, dict):
        return {key: without_nan(value) for key, value in content.items()}
    if isinstance(content, list):
        return [without_nan(value) for value in content]
    return None if isinstance(content, float) and not np.isfinite(content) else content


def write_json(path, content):
    temporary = path + ".part"
    try:
        with open(temporary, "w") as file:
            json.dump(without_nan(content), file, indent=1)
        os.replace(temporary, path)
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--real", required=True, metavar="DATAROOT")
    parser.add_argument("--simulated", metavar="DATAROOT")
    parser.add_argument("--real-version", default="v1.0-mini")
    parser.add_argument("--simulated-version", default="v1.0-sim")
    parser.add_argument("--scenes", nargs="+", metavar="SCENE",
                        help="only these scenes, of the simulated dataroot if there is one, else of the real one")
    parser.add_argument("--json", metavar="FILE", help="also write the figures there")
    parser.add_argument("--plot", metavar="FILE", help="also draw histograms there")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    real_scenes = None if arguments.simulated else arguments.scenes
    real = read_dataroot(arguments.real, arguments.real_version, real_scenes)
    simulated = None
    if arguments.simulated:
        simulated = read_dataroot(arguments.simulated, arguments.simulated_version, arguments.scenes)
    tables = {"real": grouped_figures(real)}
    if simulated:
        tables["simulated"] = grouped_figures(simulated)
        tables["ratios"] = bar_ratios(simulated, real)
    print_table(tables["real"], tables.get("simulated"))
    if simulated:
        print_ratios(tables["ratios"])
    if arguments.json:
        write_json(arguments.json, tables)
    if arguments.plot:
        plot(arguments.plot, real, simulated)


if __name__ == "__main__":
    try:
        main()
    except DataError as error:
        sys.exit(f"compare_radar: {error}")
    except KeyError as error:
        sys.exit(f"compare_radar: the tables have no {error}, which other rows refer to")
    except BrokenPipeError:
        sys.exit(1)
