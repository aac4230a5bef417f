#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# The launch files load with each of their arguments, and every input of a nodelet that comes from outside has one.
import os
import unittest

from roslaunch.arg_dump import get_args
from roslaunch.config import ROSLaunchConfig
from roslaunch.xmlloader import XmlLoader

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "launch")
FILES = ["radar.launch", "radar_dot.launch", "replay.launch"]
VALUES = {"mask_frame": "current", "threads": "3", "rate": "2.0", "delay": "0.5", "pair_interval": "0.5"}

# By nodelet, what it subscribes to of other nodes, and the argument for it.
VELOCITY = {"rotation/imu": "imu", "rotation/odom": "odometry"}
MASKED = {"dynamic/mask": "mask", "camera_info": "camera_info"}
RADAR = {"ego_velocity": {**VELOCITY, **MASKED}, "odometry": VELOCITY,
         "moving_objects": {**MASKED, "flow": "flow", "odom": "pose"}}
IMAGES = {"image": "image", "image/compressed": "image", "camera_info": "camera_info"}
CAMERA = {"decode_image": IMAGES, "optical_flow": IMAGES, "overlay": {**IMAGES, "flow": "flow"},
          "depth": {**IMAGES, "lidar": "lidar", "depth/input": "depth_input"},
          "static_world": {**IMAGES, "depth/input": "depth_input", "points": "points"},
          "dynamic_segmentation": {**VELOCITY, "camera_info": "camera_info", "flow": "flow"}}


def arguments(name):
    return get_args([os.path.join(FOLDER, name)])


def load(name, **values):
    if "bag" in arguments(name):
        values.setdefault("bag", "scene.bag")
    config = ROSLaunchConfig()
    XmlLoader(resolve_anon=False).load(os.path.join(FOLDER, name), config, verbose=False,
                                       argv=["%s:=%s" % value for value in values.items()])
    return config


def remaps(config):
    return {node.name: dict(node.remap_args) for node in config.nodes}


class LaunchFilesTest(unittest.TestCase):
    def test_each_argument(self):
        for name in FILES:
            given = {argument: default for argument, (_, default) in arguments(name).items() if argument != "config"}
            for argument, default in given.items():
                value = VALUES.get(argument, {"true": "false", "false": "true"}.get(default, "elsewhere"))
                with self.subTest(file=name, argument=argument):
                    config = load(name, **{argument: value})
                    self.assertFalse(config.config_errors)
                    self.assertIn("ego_velocity", remaps(config))

    def test_each_input_has_an_argument(self):
        for name, nodelets in (("radar.launch", RADAR), ("radar_dot.launch", {**RADAR, **CAMERA})):
            known = set(arguments(name))
            topics = {argument: "my/" + argument
                      for inputs in nodelets.values() for argument in inputs.values() if argument in known}
            found = remaps(load(name, **topics))
            for nodelet, inputs in nodelets.items():
                for topic, argument in inputs.items():
                    if argument == "mask" and argument not in known:
                        continue  # radar_dot.launch makes it
                    expected = topics[argument] + ("/compressed" if topic == "image/compressed" else "")
                    self.assertEqual(found[nodelet].get(topic), expected, (name, nodelet))

    def test_the_camera_names_what_has_no_argument(self):
        found = remaps(load("radar_dot.launch", camera="left"))
        self.assertEqual(found["optical_flow"]["image"], "left/image")
        self.assertEqual(found["decode_image"]["image/compressed"], "left/image/compressed")
        for nodelet in ("ego_velocity", "moving_objects", "depth"):
            self.assertEqual(found[nodelet]["camera_info"], "left/camera_info", nodelet)
        # What is not given is left to a remapping around the include.
        self.assertEqual(set(found["odometry"]), set())

    def test_a_manager_that_stands_still_keeps_its_nodelets(self):
        # After 4 s without a sign of it, `nodelet load` would take its nodelet away, for good.
        for name in FILES:
            loads = [node.args for node in load(name).nodes if node.args.startswith("load ")]
            self.assertTrue(loads, name)
            self.assertTrue(all(words.endswith(" --no-bond") for words in loads), (name, loads))

    def test_what_needs_little_of_an_image_decodes_it_itself(self):
        names = ["/optical_flow/image_transport", "/depth/image_transport"]
        for values, expected in (({}, "compressed"), ({"compressed": "false"}, None),
                                 ({"flow_model": "raft.pt", "depth_model": "just.pt"}, None)):
            params = load("radar_dot.launch", **values).params
            self.assertEqual([params[name].value if name in params else None for name in names], 2 * [expected])

    def test_replay_takes_the_topics_of_the_bag(self):
        found = remaps(load("replay.launch"))
        for nodelet in ("ego_velocity", "odometry", "dynamic_segmentation"):
            self.assertEqual(found[nodelet]["rotation/odom"], "/ground_truth/odom", nodelet)
            self.assertEqual(found[nodelet]["rotation/imu"], "/can/imu", nodelet)

    def test_an_ekf_owns_the_transform(self):
        for name in FILES[:2]:
            self.assertIs(load(name, publish_tf="false").params["/odometry/publish_tf"].value, False)
            self.assertNotIn("/odometry/publish_tf", load(name).params)


if __name__ == "__main__":
    unittest.main()
