#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""A proposed ignore_mask is the bonnet, and neither a car that drives ahead nor what would not move anyway."""
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import rosbag
import rospy
from PIL import Image as Picture
from radar_dot.msg import Flow
from sensor_msgs.msg import Image

TOOL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/propose_ignore_mask.py")
ROWS, COLUMNS, SCALE = 60, 100, 4  # of the grid; px of the image per px of it


def image_of(vectors, stamp):
    image = Image(height=ROWS, width=COLUMNS, encoding="32FC2", step=8 * COLUMNS,
                  data=vectors.astype("<f4").tobytes())
    image.header.stamp = stamp
    return image


class ProposeIgnoreMask(unittest.TestCase):
    def run_on(self, pairs, motion):
        """A drive in which the bonnet fills the ten lowest rows."""
        with tempfile.TemporaryDirectory() as folder:
            bag, output = os.path.join(folder, "drive.bag"), os.path.join(folder, "mask.png")
            with rosbag.Bag(bag, "w") as file:
                for i in range(pairs):
                    stamp = rospy.Time(10 + i)
                    expected = np.zeros((ROWS, COLUMNS, 2))
                    expected[20:, :, 1] = motion  # the sky above is far away
                    flow = expected + 0.1
                    flow[50:] = 0.05
                    flow[30:40, 40:60] = 0.0  # a car ahead
                    flow[25:50, 80:] *= i % 2  # a wall without texture, every other time
                    expected[45, 10] = np.nan
                    message = Flow(image_width=SCALE * COLUMNS, image_height=SCALE * ROWS,
                                   flow=image_of(flow, stamp))
                    message.header.stamp = stamp
                    file.write("/dynamic/expected_flow", image_of(expected, stamp), stamp)
                    file.write("/flow", message, stamp)
            result = subprocess.run([sys.executable, TOOL, bag, "--output", output], stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, universal_newlines=True)
            mask = np.array(Picture.open(output)) if result.returncode == 0 else None
            return result, mask

    def test_the_bonnet_is_found(self):
        result, mask = self.run_on(20, motion=3.0)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(mask.shape, (ROWS, COLUMNS))
        self.assertTrue((mask[50:] == 255).all())
        self.assertTrue((mask[:49] == 0).all(), "one row of margin")
        self.assertIn("18.3 %", result.stdout)

    def test_a_vehicle_that_stands_tells_nothing(self):
        result, _ = self.run_on(20, motion=0.5)
        self.assertEqual(result.returncode, 1)
        self.assertIn("show a motion of 4.0 px", result.stderr)


if __name__ == "__main__":
    unittest.main()
