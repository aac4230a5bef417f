# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Detection, cluster and object lists of radar drivers as rows of a cloud, without a ROS graph: for
radar_lists_to_cloud. TABLE says for each message type where its values are; KEYS says how an entry is written."""
import ast
import collections
import difflib
import operator

import numpy as np
from sensor_msgs import point_cloud2

KEYS = {
    "list": "where the message keeps its returns, a list or a PointCloud2; without it the message is one return, or "
            "its fields are arrays with one element per return",
    "x, y, z": "m: x ahead, y to the left, z up (0)",
    "range, azimuth, elevation": "instead of x, y, z: m; rad, positive to the left; rad, positive upwards (0)",
    "doppler": "range rate, m/s, positive when the range grows, not compensated for the motion of the vehicle",
    "vx, vy, vz": "instead of doppler: velocity relative to the radar, m/s; its component along the line of sight "
                  "is taken, in the plane without vz",
    "rcs, snr": "further fields of the cloud, dBsm and dB; a field that is nan throughout is left out of it",
    "ambig_state, invalid_state, pdh0": "the same: states of Continental radars, on which EgoVelocity filters",
    "valid": "only returns for which this is true are taken",
    "header": "where the header is (header), in the message or in its returns",
    "id": "a scan has several messages, and ends when this does not grow",
    "group": "a scan has several messages, and ends when this changes",
    "pause": "s (0.05 with id or group): a scan has several messages, and ends when none comes for this long",
    "latest": "true: of the messages of a scan the last one has all returns",
    "appended": "true: the driver appends each scan to the list of the previous one; the first message is skipped",
    "note": "logged at start",
    "refused": "why this type is not converted",
}
OPTIONAL = ("rcs", "snr", "ambig_state", "invalid_state", "pdh0")
TEXTS = ("note", "refused")
PLAIN = ("list", "header", "pause", "latest", "appended") + TEXTS  # not expressions

TRACKED = "filtered by the tracker of the radar, hence correlated and delayed"
CLUSTERS = TRACKED + ": prefer its cluster mode"
CHECK_SIGN = "the sign of its velocity is not documented: set ~doppler_scale to -1 where approaching is positive"
_CLUSTER, _OBJECT = "cluster_general.cluster_", "object_general.obj_"
_ARS40X = {
    "x": "position.pose.position.x", "y": "position.pose.position.y",
    "vx": "relative_velocity.twist.linear.x", "vy": "relative_velocity.twist.linear.y", "rcs": ["rcs", "nan"],
}
_ARS430 = {
    # Of the two hypotheses of a detection the more probable one; older messages have it alone, and the range in posX.
    "list": "Detections", "range": ["Range", "posX"],
    "azimuth": ["-where(Prob0 >= Prob1, AzAng0, AzAng1)", "-AzAng"], "doppler": "VrelRad",
    "rcs": ["where(Prob0 >= Prob1, RCS0, RCS1)", "RCS"], "snr": "SNR", "group": "TimeStamp",
}
_SICK = {"list": "targets", "header": "targets.header", "x": "x", "y": "y", "z": "z", "doppler": "vrad",
         "note": CHECK_SIGN}
_ARBE_RANGE = "((Points.range_bin - PcMetadata.range_offset) * PcMetadata.PcResolution.range_resolution)"
_ARBE_RIGHT = "(Points.azimuth_signed_bin * PcMetadata.PcResolution.azimuth_coefficient)"  # sine of the angle
_ARBE_UP = "(Points.elevation_signed_bin * PcMetadata.PcResolution.elevation_coefficient)"

TABLE = {
    # Continental ARS408, SRR308
    "ars_40X/ClusterList": {**_ARS40X, "list": "clusters", "ambig_state": "ambig_state",
                            "invalid_state": "invalid_state", "pdh0": "prob_of_exist"},
    "ars_40X/ObjectList": {**_ARS40X, "list": "objects", "valid": "(meas_state != 3) & (meas_state != 4)",
                           "note": CLUSTERS},  # 3: predicted, 4: deleted
    "radar_conti/ClusterList": {
        "list": "clusters", "appended": True, "x": _CLUSTER + "distlong.data", "y": _CLUSTER + "distlat.data",
        "vx": _CLUSTER + "vrellong.data", "vy": _CLUSTER + "vrellat.data", "rcs": _CLUSTER + "rcs.data",
        "ambig_state": "code(cluster_quality.cluster_ambigstate.data)",
        "invalid_state": "code(cluster_quality.cluster_invalidstate.data)",
        "pdh0": "code(cluster_quality.cluster_pdh0.data)"},
    "radar_conti/ObjectList": {
        "list": "objects", "appended": True, "x": _OBJECT + "distlong.data", "y": _OBJECT + "distlat.data",
        "vx": _OBJECT + "vrellong.data", "vy": _OBJECT + "vrellat.data", "rcs": _OBJECT + "rcs.data",
        # The driver publishes after every CAN frame.
        "group": "header.stamp", "latest": True, "pause": 0.2, "note": CLUSTERS},
    "nuscenes2bag/RadarObjects": {
        "list": "objects", "x": "pose.x", "y": "pose.y", "z": "pose.z", "vx": "vx", "vy": "vy", "rcs": "rcs",
        "ambig_state": "ambig_state", "invalid_state": "invalid_state", "pdh0": "pdh0"},
    # Continental ARS430, ARS548
    "ars430_ros_publisher/RadarPacket": _ARS430,
    "radar_driver/RadarPacket": _ARS430,
    "ars548_msg/DetectionList": {"list": "detection_array", "x": "f_x", "y": "f_y", "z": "f_z",
                                 "doppler": "f_RangeRate", "rcs": "s_RCS"},
    "ars548_msg/ObjectList": {"refused": "its objects have velocities over ground, at corners of boxes in the frame "
                                         "of the vehicle; take the DetectionList"},
    # Aptiv (Delphi); names of the messages since 3.2.0, and before. Their angles grow to the right.
    "delphi_esr_msgs/EsrTrack": {
        "range": ["range", "track_range"], "azimuth": ["-radians(angle)", "-radians(track_angle)"],
        "doppler": ["range_rate", "track_range_rate"], "id": ["id", "track_id", "track_ID"], "pause": 0.025,
        "valid": [f"({s} == 1) | ({s} == 2) | ({s} == 3) | ({s} == 5)" for s in ("status", "track_status")],
        "note": TRACKED},  # new, updated, merged; without those that are absent or coast
    "delphi_mrr_msgs/MrrDetection": {"range": "range", "azimuth": "-azimuth", "doppler": "range_rate",
                                     "valid": "(valid_level != 0) & (host_veh_clutter == 0)", "id": "detection_id",
                                     "pause": 0.025},
    "delphi_srr_msgs/SrrTrack": {
        "range": ["can_tx_detect_range", "CAN_TX_DETECT_RANGE"],
        "azimuth": ["-radians(can_tx_detect_angle)", "-radians(CAN_TX_DETECT_ANGLE)"],
        "doppler": ["can_tx_detect_range_rate", "CAN_TX_DETECT_RANGE_RATE"],
        "rcs": ["can_tx_detect_amplitude", "CAN_TX_DETECT_AMPLITUDE"],
        "valid": ["can_tx_detect_status", "CAN_TX_DETECT_STATUS"], "pause": 0.015},
    # Texas Instruments
    "ti_mmwave_rospkg/RadarScan": {"x": "x", "y": "y", "z": "z", "doppler": "velocity", "id": "point_id",
                                   "pause": 0.02},
    # Others
    "ainstein_radar_msgs/RadarTargetArray": {
        "list": "targets", "range": "range", "azimuth": "radians(azimuth)", "elevation": "radians(elevation)",
        "doppler": "speed", "snr": "snr", "note": CHECK_SIGN.replace("not documented", "not the same for all models")},
    "arbe_msgs/arbeNewPcMsg": {
        "header": "RosHeader", "x": f"{_ARBE_RANGE} * sqrt(1 - {_ARBE_RIGHT}**2 - {_ARBE_UP}**2)",
        "y": f"-{_ARBE_RANGE} * {_ARBE_RIGHT}", "z": f"{_ARBE_RANGE} * {_ARBE_UP}",
        "doppler": "Points.doppler_signed_bin * PcMetadata.PcResolution.doppler_resolution",
        "note": CHECK_SIGN + "; its frame_id is no frame: set ~frame_id"},
    "off_highway_radar_msgs/Objects": {
        "list": "objects", "x": "a.position.x", "y": "a.position.y", "vx": "a.velocity.linear.x",
        "vy": "a.velocity.linear.y", "rcs": "b.rcs", "valid": "a.valid",
        "note": TRACKED + "; velocities are relative only while the radar is not told that of the vehicle"},
    "radar_pa_msgs/radar_msg": {"list": "data_A", "range": "distance", "azimuth": "angle", "doppler": "velocity",
                                "rcs": "power", "valid": "is_target", "note": CHECK_SIGN},
    "sick_scan/RadarScan": _SICK,
    "sick_scan_xd/RadarScan": _SICK,
}


class ListError(Exception):
    """An entry or a message that cannot be used, and why."""


def _codes(texts):
    """Numbers that a driver put into strings: as digits, or as the character with that code."""
    return np.array([int(text) if text.isdigit() else ord(text) if len(text) == 1 else np.nan
                     for text in np.ravel(texts)])


FUNCTIONS = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt, "hypot": np.hypot, "radians": np.radians,
             "where": np.where, "abs": np.abs, "code": _codes, "nan": np.nan}


class Expression(ast.NodeTransformer):
    """Arithmetic over fields such as a.position.x, for all returns at once."""

    ALLOWED = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Constant, ast.operator, ast.unaryop, ast.cmpop)

    def __init__(self, text):
        self.text, self.paths = str(text), []
        try:
            tree = self.visit(ast.parse(self.text, mode="eval"))
        except SyntaxError as error:
            raise ListError(f"'{text}' is no expression: {error.msg}")
        self.program = compile(ast.fix_missing_locations(tree), self.text, "eval")

    def __call__(self, column):
        """column(path): values of all returns."""
        values = {f"path{i}": column(path) for i, path in enumerate(self.paths)}
        return eval(self.program, {"__builtins__": {}, **FUNCTIONS, **values})

    def generic_visit(self, node):
        if not isinstance(node, self.ALLOWED) or len(getattr(node, "ops", [])) > 1:
            raise ListError(f"'{self.text}' may have fields, numbers, + - * / **, comparisons of two, & | and "
                            f"{', '.join(sorted(FUNCTIONS))} only")
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            power = node.right.value if isinstance(node.right, ast.Constant) else None
            if not isinstance(power, (int, float)) or abs(power) > 4:
                raise ListError(f"'{self.text}' has a power that is no number up to 4")
        return super().generic_visit(node)

    def visit_Call(self, node):
        if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS or node.keywords:
            return self.generic_visit(node)
        node.args = [self.visit(argument) for argument in node.args]
        return node

    def visit_Name(self, node):
        if getattr(node, "id", None) == "nan":
            return node
        names, owner = [], node
        while isinstance(owner, ast.Attribute):
            names, owner = [owner.attr] + names, owner.value
        if not isinstance(owner, ast.Name):
            return self.generic_visit(owner)
        path = ".".join([owner.id] + names)
        if path not in self.paths:
            self.paths.append(path)
        return ast.Name(id=f"path{self.paths.index(path)}", ctx=ast.Load())

    visit_Attribute = visit_Name


class Entry:
    """How to read one message type."""

    def __init__(self, message_type, changes=None):
        """changes: keys that replace those of TABLE, or an entry for a type that is not in it; "" removes a key."""
        self.type = message_type
        keys = {**TABLE.get(message_type, {}), **(changes or {})}
        keys = {key: value for key, value in keys.items() if value != ""}
        known = [name for names in KEYS for name in names.split(", ")]
        for key in keys:
            if key not in known:
                near = difflib.get_close_matches(key, known, 1)
                raise ListError(f"{self.type}: unknown key '{key}'" + (f"; is '{near[0]}' meant?" if near else ""))
        if not keys:
            raise ListError(f"{self.type} is not in the table; describe it in ~entry, see --help. The table has "
                            + ", ".join(name for name in TABLE if "refused" not in TABLE[name]))
        if "refused" in keys:
            raise ListError(f"{self.type} is not converted: {keys['refused']}")
        self.note = keys.get("note", "")
        self.keys = {key: value for key, value in keys.items() if key in PLAIN}
        self.expressions = {
            key: [Expression(text) for text in (value if isinstance(value, list) else [value])]
            for key, value in keys.items() if key not in PLAIN}
        for either, other in ((("x", "y"), ("range", "azimuth")), (("doppler",), ("vx", "vy"))):
            if not (set(either) <= set(keys) or set(other) <= set(keys)):
                raise ListError(f"{self.type}: the entry lacks {' and '.join(either)}, or {' and '.join(other)}")

    @property
    def collects(self):
        """A scan has several messages."""
        return any(key in self.keys or key in self.expressions for key in ("id", "group", "pause"))

    def elements(self, message):
        if "list" not in self.keys:
            return [message]
        try:
            elements = operator.attrgetter(self.keys["list"])(message)
        except AttributeError:
            raise ListError(f"{self.type}: no '{self.keys['list']}' (list) in the message, which has "
                            f"{', '.join(message.__slots__)}")
        if getattr(elements, "_type", "") == "sensor_msgs/PointCloud2":
            return point_cloud2.read_points_list(elements)
        return elements

    def header(self, message):
        """None: it has none, nor have its returns."""
        for owner in [message, *self.elements(message)[:1]]:
            try:
                return operator.attrgetter(self.keys.get("header", "header"))(owner)
            except AttributeError:
                pass
        return None

    def value(self, key, pairs):
        """Of all pairs of a return and its message, by the first expression of the key whose fields exist."""
        def column(path):
            get = operator.attrgetter(path)
            try:
                values = [get(element) for element, _ in pairs]
            except AttributeError:
                values = [get(message) for _, message in pairs]
            return np.array([np.frombuffer(value, np.uint8) if isinstance(value, bytes) else value
                             for value in values])

        for expression in self.expressions[key]:
            try:
                return expression(column)
            except AttributeError:
                pass
        fields = ", ".join(getattr(pairs[0][0], "__slots__", None) or getattr(pairs[0][0], "_fields", []))
        raise ListError(f"{self.type}: no '{self.expressions[key][0].text}' ({key}) in a return, which has {fields}")

    def rows(self, messages):
        """Names of the fields, and one row of float32 per return of the messages, which make one scan."""
        pairs = [(element, message) for message in messages for element in self.elements(message)]

        def value(key, otherwise=0.0):
            return self.value(key, pairs) if key in self.expressions else otherwise

        with np.errstate(all="ignore"):
            if "range" in self.expressions:
                length, azimuth, elevation = value("range"), value("azimuth"), value("elevation")
                x = length * np.cos(elevation) * np.cos(azimuth)
                y, z = length * np.cos(elevation) * np.sin(azimuth), length * np.sin(elevation)
            else:
                x, y, z = value("x"), value("y"), value("z")
            if "doppler" in self.expressions:
                doppler = value("doppler")
            else:
                vz, height = (value("vz"), z) if "vz" in self.expressions else (0.0, 0.0)
                doppler = (x * value("vx") + y * value("vy") + height * vz) / np.sqrt(x**2 + y**2 + height**2)
        columns = {"x": x, "y": y, "z": z, "doppler": doppler}
        columns.update({key: value(key) for key in OPTIONAL if key in self.expressions})
        *values, valid = np.broadcast_arrays(*columns.values(), value("valid", 1.0))
        rows = np.stack([column.ravel() for column in values], axis=1).astype(np.float32)
        rows = rows[valid.ravel() != 0]
        kept = [name not in OPTIONAL or not len(rows) or not np.isnan(rows[:, i]).all()
                for i, name in enumerate(columns)]
        return [name for name, keep in zip(columns, kept) if keep], rows[:, kept]


Scan = collections.namedtuple("Scan", "stamp frame_id names rows")


class Collector:
    """Puts together what belongs to one scan."""

    def __init__(self, entry):
        self.entry = entry
        self.pause = float(entry.keys.get("pause", 0.05))
        self.messages, self.first, self.last, self.marks = [], None, None, None
        self.previous = None  # list of the message before, where the driver appends to it

    def add(self, message, stamp, arrival, frame_id=""):
        """Scans that end with this message, or by it."""
        if self.entry.keys.get("appended") and not self._take_new(message):
            return []
        marks = {key: self.entry.value(key, [(message, message)])[0] for key in ("id", "group")
                 if key in self.entry.expressions}
        ended = []
        if self.messages and (abs((stamp - self.last[0]).to_sec()) > self.pause or self._ends(marks)):
            ended = self.flush()
        if not self.messages:
            self.first = (stamp, frame_id)
        self.messages.append(message)
        self.last, self.marks = (stamp, arrival), marks
        return ended if self.entry.collects else ended + self.flush()

    def late(self, now):
        """Scans that have ended because nothing more came."""
        return self.flush() if self.messages and (now - self.last[1]).to_sec() > self.pause else []

    def flush(self):
        messages, self.messages = self.messages[-1:] if "latest" in self.entry.keys else self.messages, []
        return [Scan(*self.first, *self.entry.rows(messages))] if messages else []

    def _ends(self, marks):
        return any(mark <= self.marks[key] if key == "id" else mark != self.marks[key]
                   for key, mark in marks.items())

    def _take_new(self, message):
        """Leaves in the message what was not in the previous one; False for the first one."""
        elements, previous = self.entry.elements(message), self.previous
        self.previous = list(elements)
        if previous and len(elements) >= len(previous) and elements[len(previous) - 1] == previous[-1]:
            del elements[:len(previous)]
        return previous is not None
