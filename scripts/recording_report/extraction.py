# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Figures and series out of a recording. Times are stamps in s; units as in the messages: m, s, rad."""
import math
import re

import numpy as np

from .recording import ReportError, seconds

UNOBSERVED = 1e5  # variances from here on mean "not observed"
COMPONENTS = ("vx", "vy", "yaw rate")
COVARIANCE_INDICES = (0, 7, 35)  # of the components in the covariance of a twist
AGED = ("ego/twist", "odom", "radar/static", "dynamic/objects", "dynamic/mask")
REFERENCE = "/ground_truth/odom"
FIELD_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
EXACT_AGE = 1e-6  # s


def yaw_of(q):
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def transform_of(transform):
    """4x4, parent from child."""
    q, p = transform.rotation, transform.translation
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
                     [0, 0, 0, 1]])


class Series:
    """Rows by stamp, as columns of one array once finished. Repeated and earlier stamps are left out."""

    def __init__(self, width):
        self.times, self.rows, self.width = [], [], width

    def add(self, time, row):
        if not self.times or time > self.times[-1]:
            self.times.append(time)
            self.rows.append(row)

    def finish(self):
        self.times = np.array(self.times, float)
        self.rows = np.array(self.rows, float).reshape(-1, self.width)
        return self

    def __len__(self):
        return len(self.times)

    def at(self, times, angles=()):
        """Linear between the rows, NaN outside; angles: columns in rad."""
        columns = [np.unwrap(self.rows[:, i]) if i in angles else self.rows[:, i] for i in range(self.width)]
        return np.stack([np.interp(times, self.times, column, np.nan, np.nan) for column in columns], axis=-1)


class Motion:
    """Twists and poses. Rows of twists: vx vy yaw rate and their standard deviations (inf: not observed), of poses:
    x y yaw."""

    def __init__(self):
        self.twists, self.raw_twists, self.poses = Series(6), Series(6), Series(3)
        self.reference_twists, self.reference_poses = Series(3), Series(3)
        self.base_frame = ""

    @staticmethod
    def row_of(message):
        twist = message.twist.twist
        variances = [message.twist.covariance[i] for i in COVARIANCE_INDICES]
        return [twist.linear.x, twist.linear.y, twist.angular.z] + [
            math.inf if variance >= UNOBSERVED else math.sqrt(max(variance, 0.0)) for variance in variances]

    def on_twist(self, message, _):
        self.base_frame = message.header.frame_id
        self.twists.add(seconds(message.header.stamp), self.row_of(message))

    def on_raw_twist(self, message, _):
        self.raw_twists.add(seconds(message.header.stamp), self.row_of(message))

    @staticmethod
    def add_pose(series, message):
        pose = message.pose.pose
        series.add(seconds(message.header.stamp), [pose.position.x, pose.position.y, yaw_of(pose.orientation)])

    def on_odometry(self, message, _):
        self.add_pose(self.poses, message)

    def on_reference(self, message, _):
        """Odometry, TwistStamped or TwistWithCovarianceStamped."""
        twist = getattr(message.twist, "twist", message.twist)
        self.reference_twists.add(seconds(message.header.stamp), [twist.linear.x, twist.linear.y, twist.angular.z])
        if hasattr(message, "pose"):
            self.add_pose(self.reference_poses, message)

    def finish(self):
        for series in (self.twists, self.raw_twists, self.poses, self.reference_twists, self.reference_poses):
            series.finish()
        if len(self.reference_poses) and not self.reference_twists.rows.any() and np.ptp(self.reference_poses.rows) > 0:
            self.reference_twists = Series(3).finish()  # poses whose publisher leaves the twist empty

    def start(self):
        return self.twists.times[0]

    def duration(self):
        return self.twists.times[-1] - self.twists.times[0]

    def distance(self):
        """m along the path; where there is no odometry, the speed integrated."""
        if len(self.poses) > 1:
            return float(np.sum(np.hypot(*np.diff(self.poses.rows[:, :2], axis=0).T)))
        speeds = np.hypot(self.twists.rows[:, 0], self.twists.rows[:, 1])
        return float(np.sum(np.diff(self.twists.times) * (speeds[1:] + speeds[:-1]) / 2))

    def errors(self):
        """(name, mean, mean absolute, root mean square, share within 3 sigma) of each component, at the twists that the
        reference reaches over."""
        result = []
        if len(self.reference_twists) < 2:
            return result
        truth = self.reference_twists.at(self.twists.times)
        for i, name in enumerate(COMPONENTS):
            sigma = self.twists.rows[:, 3 + i]
            error = self.twists.rows[:, i] - truth[:, i]
            good = np.isfinite(error) & np.isfinite(sigma)
            error, sigma = error[good], sigma[good]
            if len(error):
                result.append((name, error.mean(), np.abs(error).mean(), math.sqrt((error ** 2).mean()),
                               np.mean(np.abs(error) <= 3 * sigma)))
        return result

    def drift(self):
        """(m apart at the end, m of the way); None without odometry and reference poses, or without a way."""
        aligned = self.aligned_reference()
        return (aligned[1], self.distance()) if aligned and self.distance() > 1.0 else None

    def aligned_reference(self):
        """x, y of the reference, laid on the first pose of the odometry that it has, and the distance of both at the
        last; None without both."""
        if len(self.poses) < 2 or len(self.reference_poses) < 2:
            return None
        truth = self.reference_poses.at(self.poses.times, angles=(2,))
        common = np.flatnonzero(np.isfinite(truth[:, 0]))
        if not len(common):
            return None
        first, last = common[0], common[-1]
        turn = self.poses.rows[first, 2] - truth[first, 2]
        rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        path = (truth[common, :2] - truth[first, :2]) @ rotation.T + self.poses.rows[first, :2]
        return path, float(np.hypot(*(path[-1] - self.poses.rows[last, :2])))


class Sweeps:
    """ego/status: rows of accepted returns, inliers, valid; refusals by reason."""

    def __init__(self):
        self.series, self.reasons = Series(3), {}

    def on_status(self, message, _):
        self.series.add(seconds(message.header.stamp),
                        [message.return_count, message.inlier_count, message.status == 0])
        if message.status != 0:
            self.reasons[message.reason] = self.reasons.get(message.reason, 0) + 1

    def shares(self):
        """Inliers among the accepted returns of each sweep; NaN without any."""
        counts, inliers = self.series.rows[:, 0], self.series.rows[:, 1]
        return np.where(counts > 0, inliers / np.maximum(counts, 1), np.nan)


class Returns:
    """Labelled returns as columns: time, frame (index into frames), x, y, z in the frame of the radar, residual,
    dynamic."""

    def __init__(self):
        self.frames, self.parts, self.left_out = [], [], ""

    def add(self, cloud, dynamic):
        names = {field.name: field for field in cloud.fields}
        residual = "ego_residual" if "ego_residual" in names else "residual"
        wanted = [name for name in ("x", "y", "z", residual) if name in names]
        if "x" not in names or "y" not in names or residual not in names:
            self.left_out = f"a cloud of frame '{cloud.header.frame_id}' lacks x, y or residual"
            return
        kinds = np.dtype({"names": wanted,
                          "formats": [(">" if cloud.is_bigendian else "<") + FIELD_TYPES[names[name].datatype]
                                      for name in wanted],
                          "offsets": [names[name].offset for name in wanted], "itemsize": cloud.point_step})
        rows = [np.frombuffer(cloud.data, kinds, cloud.width, i * cloud.row_step) for i in range(cloud.height)]
        points = np.concatenate(rows) if rows else np.empty(0, kinds)
        if cloud.header.frame_id not in self.frames:
            self.frames.append(cloud.header.frame_id)
        part = np.empty((len(points), 7))
        part[:, 0], part[:, 1] = seconds(cloud.header.stamp), self.frames.index(cloud.header.frame_id)
        for i, name in enumerate(("x", "y", "z", residual)):
            part[:, 2 + i] = points[name] if name in wanted else 0.0
        part[:, 6] = dynamic
        self.parts.append(part[np.isfinite(part).all(axis=1)])

    def finish(self):
        self.rows = np.concatenate(self.parts) if self.parts else np.empty((0, 7))
        self.parts = []

    def in_base(self, mounts):
        """x, y in the base frame; NaN for radars without a mount."""
        points = np.full((len(self.rows), 2), np.nan)
        for i, frame in enumerate(self.frames):
            mount = mounts.get(frame)
            if mount is not None:
                own = self.rows[:, 1] == i
                points[own] = self.rows[own, 2:5] @ mount[:2, :3].T + mount[:2, 3]
        return points


def in_world(points, times, poses):
    """Points of the base frame at these times into the frame of the odometry; NaN where it has no pose."""
    x, y, yaw = poses.at(times, angles=(2,)).T
    return np.stack([x + np.cos(yaw) * points[:, 0] - np.sin(yaw) * points[:, 1],
                     y + np.sin(yaw) * points[:, 0] + np.cos(yaw) * points[:, 1]], axis=-1)


class Objects:
    """dynamic/objects as columns: time, id, x, y, vx, vy, in frame."""

    def __init__(self):
        self.rows, self.frame = [], ""

    def on_objects(self, message, _):
        self.frame = message.header.frame_id
        time = seconds(message.header.stamp)
        for one in message.objects:
            self.rows.append([time, one.id, one.position.x, one.position.y, one.velocity.x, one.velocity.y])

    def finish(self):
        self.rows = np.array(self.rows, float).reshape(-1, 6)


class Frames:
    """Transforms of TF, the latest of each child."""

    def __init__(self):
        self.parents = {}

    def on_transforms(self, message, _):
        for one in message.transforms:
            self.parents[one.child_frame_id.lstrip("/")] = (one.header.frame_id.lstrip("/"), transform_of(one.transform))

    def mount(self, base, frame):
        """4x4, base from frame; None where TF does not lead from one to the other."""
        base, frame, chain = base.lstrip("/"), frame.lstrip("/"), np.eye(4)
        for _ in range(len(self.parents) + 1):
            if frame == base:
                return chain
            if frame not in self.parents:
                return None
            frame, step = self.parents[frame]
            chain = step @ chain
        return None


class Health:
    """/diagnostics: what was not in order, what was refused, and the figures of each radar."""

    FIGURES = {"inlier share": "inlier_share", "median residual (m/s)": "residual", "rate (Hz)": "rate",
               "returns": "returns", "returns accepted": "accepted",
               "yaw correction of the mount (rad)": "yaw", "yaw of the mount learnt by the filter (rad)": "learnt"}

    def __init__(self):
        self.reports, self.refusals, self.radars = [], {}, {}

    def on_diagnostics(self, message, bag_time):
        time = seconds(message.header.stamp) or bag_time
        for status in message.status:
            values = {value.key: value.value for value in status.values}
            self.reports.append((time, status.name, status.level, status.message))
            for key, value in values.items():
                if key.endswith(" refused") and value.isdigit() and int(value) > 0:
                    self.refusals[status.name] = (int(value), values.get("last refusal", ""))
            match = re.search(r": radar (.+)$", status.name)
            if match and "inlier share" in values:
                self.add_radar(match.group(1), time, values)

    def add_radar(self, name, time, values):
        radar = self.radars.setdefault(name, {"frame": "", "series": Series(9)})
        radar["frame"] = values.get("frame", "") or radar["frame"]
        row = []
        for key, short in self.FIGURES.items():
            numbers = re.findall(r"[-+]?\d[\d.eE+-]*|nan|inf", values.get(key, "").replace("+-", " "))
            numbers = [float(number) for number in numbers[:2 if short in ("yaw", "learnt") else 1]]
            row += numbers + [math.nan] * ((2 if short in ("yaw", "learnt") else 1) - len(numbers))
        if values.get("frame"):  # else it has not read a scan yet
            radar["series"].add(time, row)

    def finish(self):
        for radar in self.radars.values():
            radar["series"].finish()

    def warnings(self, start):
        """(level, input, latest text, reports, of how many, first and last time) of what was not in order from start on.
        Texts that differ in their numbers count as one."""
        totals, found = {}, {}
        for time, name, level, text in self.reports:
            if time < start:
                continue
            totals[name] = totals.get(name, 0) + 1
            if level > 0:
                key = (name, level, re.sub(r"[\d.]+", "#", text))
                first, count = found.get(key, (time, 0, 0, ""))[:2]
                found[key] = (first, count + 1, time, text)
        rows = [(level, name, text, count, totals[name], first, last)
                for (name, level, _), (first, count, last, text) in found.items()]
        return sorted(rows, key=lambda row: (-row[0], -row[3], row[1]))


class Content:
    """All that a report shows but the film."""

    def __init__(self, recording, reference=""):
        self.recording = recording
        self.motion, self.sweeps, self.returns = Motion(), Sweeps(), Returns()
        self.objects, self.frames, self.health = Objects(), Frames(), Health()
        self.reference = self.find_reference(reference)
        self.reference_name = "truth" if self.reference == REFERENCE else "reference"
        if not recording.has("ego/twist"):
            raise ReportError(no_twist(recording))
        recording.read({
            "ego/twist": self.motion.on_twist, "ego/twist_raw": self.motion.on_raw_twist,
            "odom": self.motion.on_odometry, "ego/status": self.sweeps.on_status,
            "radar/static": lambda message, _: self.returns.add(message, False),
            "radar/dynamic": lambda message, _: self.returns.add(message, True),
            "dynamic/objects": self.objects.on_objects, "/diagnostics": self.health.on_diagnostics,
            "/tf": self.frames.on_transforms, "/tf_static": self.frames.on_transforms,
            **({self.reference: self.motion.on_reference} if self.reference else {})})
        for part in (self.motion, self.sweeps.series, self.returns, self.objects, self.health):
            part.finish()
        if len(self.motion.twists) < 2:
            raise ReportError(f"{recording.title()}: fewer than two twists on {recording.topic('ego/twist')}")
        self.mounts = {frame: self.frames.mount(self.motion.base_frame, frame) for frame in self.returns.frames}
        self.ages = {name: self.ages_of(name) for name in AGED if recording.has(name)}
        if not is_live(self.ages["ego/twist"]):
            self.ages = {}

    def find_reference(self, given):
        kinds = ("nav_msgs/Odometry", "geometry_msgs/TwistStamped", "geometry_msgs/TwistWithCovarianceStamped")
        if not given:
            return REFERENCE if self.recording.has(REFERENCE) else ""
        topic = self.recording.topic(given)
        if self.recording.types.get(topic) not in kinds:
            raise ReportError(f"{self.recording.title()}: no reference on {topic}; odometries and twists at hand: "
                              f"{', '.join(self.recording.of_type(*kinds)) or 'none'}")
        return topic

    def ages_of(self, name):
        """s from each stamp to the recording of its message."""
        return np.array([time - stamp for stamp, time in self.recording.stamps(name)])

    def radar_name(self, frame):
        return next((name for name, radar in self.health.radars.items() if radar["frame"] == frame), frame)


def is_live(ages):
    """Twists that are recorded at their very stamps are of offline processing, and with clocks a day apart none tell."""
    return EXACT_AGE < abs(np.median(ages)) < 86400


def no_twist(recording):
    others = [topic for topic in recording.counts if topic.endswith("/ego/twist")]
    text = f"{recording.title()}: no {recording.topic('ego/twist')}, which EgoVelocity publishes"
    if others:
        return f"{text}; but {', '.join(others)}: say --namespace {others[0][:-len('/ego/twist')] or '/'}"
    return f"{text}: record the outputs, or say ego/twist:=TOPIC; topics at hand: {', '.join(sorted(recording.counts)) or 'none'}"
