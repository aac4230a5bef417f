#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Two vehicles with the same names of topics and frames, each in its namespace: neither sees the other."""
import math
import struct
import threading
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import TwistWithCovarianceStamped
from nav_msgs.msg import Odometry
from radar_dot.msg import MovingObjects
from sensor_msgs.msg import PointCloud2, PointField
from tf2_msgs.msg import TFMessage

SPEEDS = {"left": 5.0, "right": 12.0}  # m/s
TIMEOUT = 60.0  # s
OUTPUTS = {"ego/twist": TwistWithCovarianceStamped, "odom": Odometry, "tf": TFMessage, "tf_static": TFMessage,
           "dynamic/objects": MovingObjects}
# What is common by the conventions of ROS.
COMMON = ("/rosout", "/rosout_agg", "/diagnostics")


def cloud_at(speed):
    """What stands still, seen from a vehicle that drives straight ahead."""
    cloud = PointCloud2(height=1, width=60, point_step=16, row_step=960, is_dense=True)
    cloud.header.stamp, cloud.header.frame_id = rospy.Time.now(), "radar"
    cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(("x", "y", "z", "doppler"))]
    azimuths = [-1.0 + i / 30.0 for i in range(60)]
    cloud.data = b"".join(struct.pack("<4f", 20 * math.cos(a), 20 * math.sin(a), 0.0, -speed * math.cos(a)) for a in azimuths)
    return cloud


class Namespaces(unittest.TestCase):
    def setUp(self):
        self.lock, self.seen = threading.Lock(), {}
        for side in SPEEDS:
            for topic, kind in OUTPUTS.items():
                rospy.Subscriber(f"{side}/{topic}", kind, self.keep, (side, topic), queue_size=10)
        self.clouds = {side: rospy.Publisher(side + "/radar/points", PointCloud2, queue_size=10) for side in SPEEDS}
        self.timer = rospy.Timer(rospy.Duration(1 / 13), self.scan)

    def keep(self, message, key):
        with self.lock:
            self.seen.setdefault(key, []).append(message)

    def scan(self, _):
        for side, publisher in self.clouds.items():
            publisher.publish(cloud_at(SPEEDS[side]))

    def test_each_vehicle_has_its_own(self):
        end = time.monotonic() + TIMEOUT
        wanted = {(side, topic) for side in SPEEDS for topic in OUTPUTS}
        while time.monotonic() < end:
            with self.lock:
                if wanted <= set(self.seen) and all(len(self.seen[side, "odom"]) > 10 for side in SPEEDS):
                    break
            time.sleep(0.1)
        self.timer.shutdown()
        with self.lock:
            self.assertEqual(wanted - set(self.seen), set())
            for side, speed in SPEEDS.items():
                for twist in self.seen[side, "ego/twist"]:
                    self.assertAlmostEqual(twist.twist.twist.linear.x, speed, delta=0.1, msg=side)
                poses = self.seen[side, "odom"]
                seconds = (poses[-1].header.stamp - poses[0].header.stamp).to_sec()
                driven = poses[-1].pose.pose.position.x - poses[0].pose.pose.position.x
                self.assertAlmostEqual(driven / seconds, speed, delta=0.2, msg=side)
        topics = [topic for topic, _ in rospy.get_published_topics() if not topic.startswith(("/left/", "/right/"))]
        self.assertEqual(set(topics) - set(COMMON), set())


if __name__ == "__main__":
    rospy.init_node("namespaces_test")
    rostest.rosrun("radar_dot", "namespaces_test", Namespaces)
