#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# The launch files load with each of their arguments, and every input of a nodelet that comes from outside has one.
import os
import sys
import tempfile
import unittest
from unittest import mock

import rosbag
from roslaunch import rlutil
from roslaunch.core import RLException
from roslaunch.arg_dump import get_args
from roslaunch.config import ROSLaunchConfig
from roslaunch.loader import Loader
from roslaunch.xmlloader import XmlLoader
import rospy
from tf2_msgs.msg import TFMessage

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "launch")
FILES = ["radar.launch", "radar_dot.launch", "replay.launch"]
VALUES = {"mask_frame": "current", "vehicle": os.path.join(FOLDER, "..", "rviz", "vehicle.urdf"), "threads": "3", "rate": "2.0", "delay": "0.5", "pair_interval": "0.5"}

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


PARAM_VALUE = Loader.param_value
# Bags of simulate_drive say so, beside /tf_static.
FOLDER_OF_BAGS = tempfile.TemporaryDirectory()
SIMULATED, REAL = (os.path.join(FOLDER_OF_BAGS.name, name + " drive.bag") for name in ("simulated", "real"))


def setUpModule():
    for path, vehicle in ((SIMULATED, b"simulated"), (REAL, b"n008")):
        with rosbag.Bag(path, "w") as bag:
            header = {"topic": "/tf_static", "type": "tf2_msgs/TFMessage", "vehicle": vehicle, "latching": "1",
                      "md5sum": TFMessage._md5sum, "message_definition": TFMessage._full_text}
            bag.write("/tf_static", TFMessage(), rospy.Time(1), connection_header=header)


def arguments(name):
    return get_args([os.path.join(FOLDER, name)])


def load(name, **values):
    if "bag" in arguments(name):
        values.setdefault("bag", REAL)
    config = ROSLaunchConfig()
    XmlLoader(resolve_anon=False).load(os.path.join(FOLDER, name), config, verbose=False,
                                       argv=["%s:=%s" % value for value in values.items()])
    return config


def remaps(config):
    return {node.name: dict(node.remap_args) for node in config.nodes}


def without_commands(loader, verbose, name, kind, *sources):
    """Loader.param_value, where values of commands do not matter."""
    return 0 if sources[-1] else PARAM_VALUE(loader, verbose, name, kind, *sources)


class LaunchFilesTest(unittest.TestCase):
    @mock.patch.object(Loader, "param_value", without_commands)
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

    def test_cameras_have_namespaces_and_share_the_vehicle(self):
        for around in ("/", "/car/"):
            config = load("radar_dot.launch", cameras="left,right", namespace=around, image="rect", imu="/imu")
            nodes = {node.namespace + node.name: node for node in config.nodes}
            for camera in ("left", "right"):
                for nodelet in CAMERA:
                    node = nodes["/%s/%s" % (camera, nodelet)]
                    self.assertTrue(node.args.endswith(" %sradar_dot_manager --no-bond" % around), node.args)
                    found = dict(node.remap_args)
                    for topic in ("ego/twist", "radar/static", "radar/dynamic", "rotation/odom"):
                        self.assertEqual(found[topic], around + topic, nodelet)
                    self.assertEqual([found["lidar"], found["rotation/imu"]], [around + "lidar_top", "/imu"])
                    # Nothing else leaves the namespace.
                    self.assertEqual(found["image"], "rect")
                    self.assertTrue({"flow", "depth", "dynamic/mask", "ego/twist_refined"}.isdisjoint(found))
                self.assertEqual(config.params["/%s/optical_flow/preset" % camera].value, "live")
            self.assertEqual(len(nodes), 4 + 2 * len(CAMERA))
            found = dict(nodes["/moving_objects"].remap_args)
            for topic in ("dynamic/mask", "dynamic/expected_flow", "depth", "flow", "camera_info"):
                self.assertEqual(found[topic], "left/" + topic)
            self.assertEqual(dict(nodes["/ego_velocity"].remap_args)["dynamic/mask"], "left/dynamic/mask")

    def test_a_camera_may_differ_from_the_others(self):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("dynamic_segmentation: {memory: 1.0, ignore_mask: a}\n"
                       "right: {dynamic_segmentation: {ignore_mask: b}}\n")
            file.flush()
            params = load("radar_dot.launch", cameras="left,right", config=file.name).params
        for camera, ignored in (("left", "a"), ("right", "b")):
            section = "/%s/dynamic_segmentation/" % camera
            self.assertEqual([params[section + name].value for name in ("memory", "ignore_mask")], [1.0, ignored])

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
            self.assertEqual(found[nodelet]["rotation/odom"], "ground_truth/odom", nodelet)
            self.assertEqual(found[nodelet]["rotation/imu"], "can/imu", nodelet)

    def test_replay_is_complete(self):
        with mock.patch.object(sys, "argv", ["roslaunch", "bag:=" + REAL]):
            self.assertIsNone(rlutil.check_roslaunch(os.path.join(FOLDER, "replay.launch")))

    def test_simulated_drives_go_without_the_corrections_of_real_radars(self):
        names = ["/ego_velocity/doppler_scale", "/ego_velocity/bearing_delay"]
        own = os.path.join(FOLDER, "..", "config", "nuscenes.yaml")
        for values, expected in (({"bag": REAL}, [1.0035, 0.038]), ({"bag": SIMULATED}, [1.0, 0.0]),
                                 ({"bag": SIMULATED, "config": own}, [1.0035, 0.038])):
            params = load("replay.launch", **values).params
            self.assertEqual([params[name].value for name in names], expected)

    def test_files_may_be_relative(self):
        with mock.patch.dict(os.environ, PWD=FOLDER_OF_BAGS.name):
            config = load("replay.launch", bag=os.path.relpath(REAL), pictures="pictures", flow_model="raft.pt",
                          depth_model="/just.pt")
        values = {name: param.value for name, param in config.params.items()}
        self.assertEqual(values["/save_pictures/folder"], FOLDER_OF_BAGS.name + "/pictures")
        self.assertEqual(values["/optical_flow/flow_model"], FOLDER_OF_BAGS.name + "/raft.pt")
        self.assertEqual(values["/depth/depth_model"], "/just.pt")
        player = next(node for node in config.nodes if node.name == "player")
        self.assertTrue(player.args.endswith(" '%s/%s'" % (FOLDER_OF_BAGS.name, os.path.relpath(REAL))), player.args)

    def test_a_bag_that_cannot_be_read_ends_the_launch(self):
        for bag in ("nowhere.bag", __file__):
            with self.assertRaises((RLException, ValueError)):
                load("replay.launch", bag=bag)

    def test_a_replay_in_a_namespace(self):
        config = load("replay.launch", ns="left", rviz="true")
        self.assertEqual({node.namespace for node in config.nodes}, {"/left/"})
        for node in config.nodes:
            self.assertEqual(dict(node.remap_args)["/tf"], "tf", node.name)
        player = next(node for node in config.nodes if node.name == "player")
        self.assertIn(" --prefix=/left ", player.args)
        self.assertEqual(dict(player.remap_args)["clock"], "/clock")
        # Layouts of rviz name topics as the namespace has them.
        for layout in os.listdir(os.path.join(FOLDER, "..", "rviz")):
            with open(os.path.join(FOLDER, "..", "rviz", layout)) as file:
                self.assertNotRegex(file.read(), r"Topic: /", layout)

    def test_a_wrong_name_reaches_the_nodelet_which_refuses_it(self):
        config = load("radar_dot.launch", mask_frame="next")
        self.assertEqual(config.params["/optical_flow/direction"].value, "mask_frame:=next")

    def test_an_ekf_owns_the_transform(self):
        for name in FILES[:2]:
            self.assertIs(load(name, publish_tf="false").params["/odometry/publish_tf"].value, False)
            self.assertNotIn("/odometry/publish_tf", load(name).params)


if __name__ == "__main__":
    unittest.main()
