#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""What config/plotjuggler.xml, config/radar_dot.perspective, config/diagnostics.yaml and rviz/ look at is what the
nodelets publish, by docs/nodes.md, the definitions of the messages and the sources."""
import ast
import json
import pathlib
import re
import unittest
import xml.etree.ElementTree

import genpy.message
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
NUMBERS = r"u?int(8|16|32|64)|float(32|64)|bool"


def published():
    """Types by topic, of the tables in docs/nodes.md."""
    types = {}
    tables = re.split(r"^### ", (ROOT / "docs" / "nodes.md").read_text(encoding="utf-8"), flags=re.M)
    for table in (table for table in tables if table.startswith("Published")):
        for names, kind in re.findall(r"^\| (`[^|]+`) \| ([a-z]\w+/\w+) \|", table, flags=re.M):
            types.update({"/" + name: kind for name in re.findall(r"`([^`]+)`", names)})
    return types


class ViewsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.types = published()
        cls.common = (ROOT / "src" / "nodelets" / "common" / "stream_nodelet.cpp").read_text(encoding="utf-8")
        cls.sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*nodelet*.cpp"))

    def check_topic(self, topic, kind=None):
        self.assertIn(topic, self.types)
        self.assertIn(f'"{topic[1:]}"', self.sources)
        if kind:
            self.assertEqual(self.types[topic], kind)

    def check_number(self, path):
        topic = max((one for one in self.types if path.startswith(one + "/")), key=len, default=path)
        self.check_topic(topic)
        kind = self.types[topic]
        for field in path[len(topic) + 1:].split("/"):
            message = genpy.message.get_message_class(kind)
            self.assertIsNotNone(message, f"{path}: {kind} has no fields")
            self.assertIn(field, message.__slots__, f"{path}: {kind}")
            kind = message._slot_types[message.__slots__.index(field)]
        self.assertRegex(kind, f"^({NUMBERS})$", path)

    def test_plotjuggler(self):
        root = xml.etree.ElementTree.parse(ROOT / "config" / "plotjuggler.xml").getroot()
        topics = root.find(".//selected_topics").get("value").split(";")
        self.assertEqual([topic.get("name") for topic in root.findall(".//topic")], topics)  # of other versions of it
        for topic in topics:
            self.check_topic(topic)
        curves = root.findall(".//curve")
        self.assertGreater(len(curves), 10)
        for curve in curves:
            for key in ("curve_x", "curve_y") if curve.get("curve_x") else ("name",):
                self.check_number(curve.get(key))
                self.assertTrue(curve.get(key).startswith(tuple(topic + "/" for topic in topics)), curve.get(key))
        for splitter in root.iter("DockSplitter"):
            self.assertEqual(int(splitter.get("count")), len(splitter))
            self.assertEqual(len(splitter.get("sizes").split(";")), len(splitter))

    def test_rqt(self):
        perspective = json.loads((ROOT / "config" / "radar_dot.perspective").read_text(encoding="utf-8"))
        manager = perspective["groups"]["pluginmanager"]
        running = ast.literal_eval(manager["keys"]["running-plugins"]["repr"])
        groups = {f"plugin__{name.replace('/', '__')}__{i}" for name, serials in running.items() for i in serials}
        self.assertEqual(groups, set(manager["groups"]))
        for name, group in manager["groups"].items():
            keys = {key: ast.literal_eval(value["repr"]) for key, value in group["groups"]["plugin"]["keys"].items()}
            for path in keys.get("topics", []):
                self.check_number(path)
            if "ImageView" in name:
                self.check_topic(keys["topic"], "sensor_msgs/Image")

    def test_diagnostics(self):
        launch = "".join(path.read_text() for path in (ROOT / "launch").glob("*.launch"))
        tree = yaml.safe_load((ROOT / "config" / "diagnostics.yaml").read_text(encoding="utf-8"))
        names = [name for analyzer in tree["analyzers"]["radar_dot"]["analyzers"].values() for name in analyzer["contains"]]
        self.assertGreater(len(names), 10)
        for name in names:
            node, status = name.split(": ")
            self.assertTrue(not node or f'name="{node}"' in launch, name)
            self.assertIn(f'"{status}', self.sources + self.common, name)

    def test_rviz(self):
        outside = {"ground_truth/boxes"}  # of a bag of nuscenes_to_bag
        for layout in (ROOT / "rviz").glob("*.rviz"):
            displays = yaml.safe_load(layout.read_text(encoding="utf-8"))
            topics = [value for display in displays["Visualization Manager"]["Displays"]
                      for key, value in display.items() if key.endswith("Topic")]
            self.assertGreater(len(topics), 3)
            for topic in set(topics) - outside:
                self.check_topic("/" + topic)
            geometry = displays["Window Geometry"]
            self.assertLessEqual((geometry["Width"], geometry["Height"]), (1600, 900))
            state = bytes.fromhex(geometry["QMainWindow State"])
            for panel in set(geometry) - {"Width", "Height", "X", "Y", "QMainWindow State", "Hide Left Dock", "Hide Right Dock"}:
                self.assertIn(panel.encode("utf-16-be"), state, layout.name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
