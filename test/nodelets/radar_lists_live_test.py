#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""radar_lists_to_cloud on messages of types that have no package here."""
import queue
import time
import unittest

import numpy as np
import rospy
import rostest
from radar_lists_test import DOPPLERS, MESSAGES, PLACES, make
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import PointCloud2

TIMEOUT = 20.0  # s


class Live(unittest.TestCase):
    def publish_until(self, topic, case, found):
        """Sends scans, once somebody listens; found() ends it."""
        publisher = rospy.Publisher(topic, type(make(case)), queue_size=100)
        end = time.monotonic() + TIMEOUT
        while True:
            if publisher.get_num_connections() > 0:
                for message in MESSAGES[case][0](case):
                    publisher.publish(message)
            try:
                return found()
            except queue.Empty:
                self.assertLess(time.monotonic(), end, "waited in vain for what follows from " + topic)

    def test_tracks_become_one_cloud(self):
        clouds = queue.Queue()
        rospy.Subscriber("esr/points", PointCloud2, clouds.put)
        begin = rospy.Time.now()

        def whole_scan():
            """On a machine that is busy elsewhere a scan may be torn, for these tracks have no stamps."""
            cloud = clouds.get(timeout=0.1)
            while cloud.width != 3:
                cloud = clouds.get(timeout=0.1)
            return cloud
        cloud = self.publish_until("esr/tracks", "delphi_esr_msgs/EsrTrack", whole_scan)
        self.assertEqual(cloud.header.frame_id, "radar_front")
        self.assertTrue(begin < cloud.header.stamp <= rospy.Time.now())
        self.assertEqual([field.name for field in cloud.fields], ["x", "y", "z", "doppler"])
        self.assertEqual((cloud.height, cloud.width, cloud.point_step, cloud.row_step), (1, 3, 16, 48))
        expected = [(*place, 0.0, -doppler) for place, doppler in zip(PLACES, DOPPLERS)]
        np.testing.assert_allclose(np.frombuffer(cloud.data, np.float32).reshape(3, 4), expected, atol=1e-3)

    def test_a_list_without_a_frame_is_an_error(self):
        errors = queue.Queue()
        rospy.Subscriber("/rosout", Log, lambda log: log.level == Log.ERROR and errors.put(log))
        error = self.publish_until("ainstein/targets", "ainstein_radar_msgs/RadarTargetArray",
                                   lambda: errors.get(timeout=0.1))
        self.assertEqual(error.name, "/frameless")
        self.assertIn("/ainstein/targets", error.msg)
        self.assertIn("~frame_id", error.msg)


if __name__ == "__main__":
    rospy.init_node("radar_lists_live_test")
    rostest.rosrun("radar_dot", "radar_lists_live_test", Live)
