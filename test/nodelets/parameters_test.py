#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# The parameters of the nodelets: each of those that can change is changed, and what is invalid is rejected.
import math
import os
import re
import subprocess
import sys
import time
import unittest

import roslib.packages
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from dynamic_reconfigure import DynamicReconfigureCallbackException
from dynamic_reconfigure.client import Client
from dynamic_reconfigure.encoding import encode_config
from dynamic_reconfigure.srv import Reconfigure
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Image

TIMEOUT = 20.0  # s
MOST = 2**31 - 1  # the largest integer that a message carries
RADARS = {"front": {"topic": "radar_front"}, "rear": {"topic": "radar_rear"}}


def wait_until(condition, what):
    end = time.monotonic() + TIMEOUT
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("waited in vain until " + what)
        time.sleep(0.02)


def number_text(number):
    text = repr(number)
    return text[:-2] if text.endswith(".0") else text


def another(parameter, value):
    """A valid value near by, so that rules between parameters hold as well; a text without choices is kept:
    which files, devices and backends there are depends on the machine."""
    if parameter["type"] == "bool":
        return not value
    if parameter["type"] == "int":
        return value + 1 if value < parameter["max"] else value - 1
    if parameter["type"] == "double":
        if math.isinf(value):
            return math.copysign(1.0, value)
        if math.isinf(parameter["max"]):
            return value + 0.25
        if value < parameter["max"]:
            return value + 1e-3 * (parameter["max"] - value)
        return value - 1e-3 * (value - parameter["min"])
    if parameter["edit_method"]:
        choices = [choice["value"] for choice in eval(parameter["edit_method"])["enum"]]
        return next(choice for choice in choices if choice != value)
    return value + ", 7" if re.fullmatch(r"\d+(, \d+)*", value) else value


def invalid(parameter):
    """Values outside the range."""
    if parameter["type"] == "int":
        return [limit for limit in (parameter["min"] - 1, parameter["max"] + 1) if abs(limit) <= MOST]
    if parameter["type"] == "double":
        below, above = parameter["min"], parameter["max"]
        return [value for value in (below - max(1.0, abs(below)), above + max(1.0, abs(above)), math.nan)
                if not math.isinf(value)]
    if parameter["edit_method"]:
        return ["no such choice"]
    return []


class ParametersTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lines = []
        cls.reports = {}
        cls.log = rospy.Subscriber("/rosout", Log, cls.lines.append, queue_size=1000)
        cls.diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, cls.note)
        rospy.wait_for_service("manager/load_nodelet", TIMEOUT)
        wait_until(lambda: any(connection.callerid_pub == "/manager" for connection in cls.log.impl.connections),
                   "the log of the manager is heard")

    @classmethod
    def note(cls, message):
        for status in message.status:
            cls.reports[status.name] = status

    def load(self, nodelet, name, **parameters):
        if rospy.has_param("/" + name):
            rospy.delete_param("/" + name)
        if parameters:
            rospy.set_param("/" + name, parameters)
        # It unloads the nodelet when it ends.
        loader = subprocess.Popen(roslib.packages.find_node("nodelet", "nodelet") +
                                  ["load", "radar_dot/" + nodelet, "manager", "__name:=" + name])
        self.addCleanup(lambda: (loader.terminate(), loader.wait(TIMEOUT)))
        client = Client("/" + name, timeout=TIMEOUT)
        self.addCleanup(client.close)
        return client

    def refusal(self, client, changes):
        call = rospy.ServiceProxy(client.name + "/set_parameters", Reconfigure)
        try:
            call(encode_config(changes))
        except rospy.ServiceException as error:
            return str(error)
        return "accepted"

    def logged(self, level, text):
        return any(line.level == level and text in line.msg for line in self.lines)

    def expect_report(self, name, level, text):
        def is_so():
            status = self.reports.get(name)
            return status is not None and status.level == level and text in status.message
        wait_until(is_so, "{} is {}: {}; but it is {}".format(name, level, text, self.reports.get(name)))

    def change(self, client, parameter, start):
        name = parameter["name"]
        value = another(parameter, start)
        self.assertEqual(client.update_configuration({name: value})[name], value)
        wait_until(lambda: client.get_configuration(timeout=TIMEOUT)[name] == value, name + " was published")
        for wrong in invalid(parameter):
            text = self.refusal(client, {name: wrong})
            self.assertIn("{} is ".format(name), text)
            self.assertIn("must be ", text)
            for limit in (parameter["min"], parameter["max"]):
                if parameter["type"] in ("int", "double") and not math.isinf(limit) and limit != MOST:
                    self.assertIn(number_text(limit), text)
        self.assertEqual(client.update_configuration({})[name], value)
        self.assertEqual(client.update_configuration({name: start})[name], start)

    def change_each(self, client):
        parameters = client.get_parameter_descriptions(timeout=TIMEOUT)
        start = client.get_configuration(timeout=TIMEOUT)
        problems = []
        for parameter in parameters:
            try:
                self.change(client, parameter, start[parameter["name"]])
            except (AssertionError, DynamicReconfigureCallbackException) as error:
                problems.append("{}/{}: {}".format(client.name, parameter["name"], error))
        self.assertEqual(problems, [])
        self.assertEqual(client.update_configuration({}), start)
        return len(parameters)

    def test_every_parameter_of_every_nodelet(self):
        clients = [self.load("EgoVelocity", "ego_velocity", radars=RADARS),
                   self.load("Odometry", "odometry"),
                   self.load("OpticalFlow", "optical_flow"),
                   self.load("Depth", "depth"),
                   self.load("DynamicSegmentation", "dynamic_segmentation"),
                   self.load("MovingObjects", "moving_objects"),
                   self.load("Overlay", "overlay"),
                   self.load("StaticWorld", "static_world")]
        # With subscribers the nodelets have inputs to connect and to leave.
        topics = ("dynamic/mask", "depth", "overlay/six_panel", "static/mask")
        subscribers = [rospy.Subscriber(topic, Image) for topic in topics]
        for client in clients:
            self.assertGreater(self.change_each(client), 3, client.name)
        for subscriber in subscribers:
            subscriber.unregister()

    def test_a_misspelt_parameter_is_named(self):
        self.load("EgoVelocity", "misspelt", radars=RADARS, modle="planar")
        wait_until(lambda: self.logged(
            Log.WARN, "'/misspelt/modle' is no parameter of this nodelet; did you mean 'model'?"),
            "the misspelt parameter was named")

    def test_a_radar_whose_topic_is_no_name_is_left_out(self):
        odd = "/hyphen/radars/radar-odd/topic has 'radar-front': "
        client = self.load("EgoVelocity", "hyphen", radars=dict(RADARS, **{"radar-odd": {"topic": "radar-front"}}))
        self.expect_report("hyphen: configuration", DiagnosticStatus.ERROR, odd)
        client.update_configuration({"threshold": 0.7})
        self.expect_report("hyphen: radar front", DiagnosticStatus.ERROR, "")
        self.assertIn(odd, self.reports["hyphen: configuration"].message)

    def test_a_topic_of_depth_that_is_no_name_is_left_out(self):
        client = self.load("Depth", "hyphen_depth", radar_topics=["radar-front", "radar/static"],
                           network_radar_topics=["my radar"])
        subscriber = rospy.Subscriber("depth", Image)
        self.expect_report("hyphen_depth: depth", DiagnosticStatus.ERROR, "/hyphen_depth/radar_topics has 'radar-front': ")
        self.assertIn("/hyphen_depth/network_radar_topics has 'my radar': ",
                      self.reports["hyphen_depth: depth"].message)
        self.expect_report("hyphen_depth: input radar/static", DiagnosticStatus.OK, "")
        self.assertEqual(client.update_configuration({"max_depth": 80.0})["max_depth"], 80.0)
        subscriber.unregister()

    def test_a_backend_that_is_not_there(self):
        for nodelet, name, report in [("OpticalFlow", "flow", "flow"), ("Depth", "depth", "depth")]:
            node = "lost_" + name
            client = self.load(nodelet, node, working_width=320, device="cpu",
                               **{name + "_backend": "nowhere", name + "_model": "/nowhere.pt"})
            in_use = client.get_configuration(timeout=TIMEOUT)
            self.assertEqual(in_use["working_width"], 320)
            self.assertNotEqual(in_use[name + "_backend"], "nowhere")
            self.assertEqual(in_use["device"], "auto")
            self.assertEqual(in_use[name + "_model"], "")
            self.expect_report("{}: {}".format(node, report), DiagnosticStatus.ERROR, "nowhere")
            self.assertIn("nowhere", self.refusal(client, {name + "_backend": "nowhere", "working_width": 640}))
            self.assertEqual(client.get_configuration(timeout=TIMEOUT)["working_width"], 320)
            client.update_configuration({"working_width": 640})
            wait_until(lambda: "nowhere" not in self.reports["{}: {}".format(node, report)].message,
                       "the error was cleared")

    def test_a_rejected_scale_disables_the_estimation(self):
        client = self.load("EgoVelocity", "unscaled", radars=RADARS, doppler_scale=0)
        text = "estimation disabled until the parameters are corrected"
        self.expect_report("unscaled: configuration", DiagnosticStatus.ERROR, text)
        self.assertIn("doppler_scale is 0", self.reports["unscaled: configuration"].message)
        wait_until(lambda: self.logged(Log.ERROR, text), "it was logged")
        client.update_configuration({"threshold": 0.7})
        self.expect_report("unscaled: configuration", DiagnosticStatus.ERROR, text + ": doppler_scale")
        client.update_configuration({"doppler_scale": -1.0})
        self.expect_report("unscaled: configuration", DiagnosticStatus.OK, "2 radars")

    def test_the_topic_of_robot_localization_is_there(self):
        self.load("EgoVelocity", "fused", radars=RADARS)
        with open(os.path.join(roslib.packages.get_pkg_dir("radar_dot"), "config", "robot_localization.yaml")) as file:
            topic = "/" + yaml.safe_load(file)["twist0"]
        wait_until(lambda: [topic, "geometry_msgs/TwistWithCovarianceStamped"] in rospy.get_published_topics(),
                   topic + " is published")


if __name__ == "__main__":
    rospy.init_node("parameters_test")
    rostest.rosrun("radar_dot", "parameters_test", ParametersTest, sys.argv)
