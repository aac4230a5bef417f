#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Listens to a replay and prints, when it ends, what the nodelets published and how far it is from /ground_truth/odom.

Subscribes: ego/twist, ego/status, odom, ground_truth/odom; with ~masks also dynamic/mask and
ground_truth/dynamic_mask/compressed. Speeds in m/s, distances in m.
Parameter: ~masks, whether masks are compared as well.
"""
import argparse
import bisect
import io
import math
import sys
import threading

import numpy as np
import rospy
from PIL import Image as Picture
from geometry_msgs.msg import TwistWithCovarianceStamped
from nav_msgs.msg import Odometry
from radar_dot.msg import EgoStatus
from sensor_msgs.msg import CompressedImage, Image


class Track:
    """Values by stamp, linearly interpolated."""

    def __init__(self):
        self.times, self.values = [], []

    def add(self, time, value):
        if self.times and time <= self.times[-1]:
            return
        self.times.append(time)
        self.values.append(value)

    def at(self, time):
        i = bisect.bisect_left(self.times, time)
        if i == 0 or i == len(self.times):
            return None
        share = (time - self.times[i - 1]) / (self.times[i] - self.times[i - 1])
        return [(1 - share) * a + share * b for a, b in zip(self.values[i - 1], self.values[i])]


class Masks:
    """Dynamic masks beside the annotated ones."""

    KEPT = 40  # annotations that wait for their mask

    def __init__(self):
        self.lock = threading.Lock()
        self.truths, self.latencies = {}, []
        self.both = self.either = self.compared = 0
        self.subscribers = [
            rospy.Subscriber("dynamic/mask", Image, self.on_mask, queue_size=20, buff_size=1 << 26),
            rospy.Subscriber("ground_truth/dynamic_mask/compressed", CompressedImage, self.on_truth, queue_size=50),
        ]

    def on_truth(self, message):
        truth = np.array(Picture.open(io.BytesIO(message.data))) > 0
        with self.lock:
            self.truths[message.header.stamp.to_nsec()] = truth
            while len(self.truths) > self.KEPT:
                del self.truths[min(self.truths)]

    def on_mask(self, message):
        latency = (rospy.Time.now() - message.header.stamp).to_sec()
        with self.lock:
            self.latencies.append(latency)
            truth = self.truths.pop(message.header.stamp.to_nsec(), None)
            if truth is None or truth.shape != (message.height, message.width):
                return
            mask = np.frombuffer(message.data, np.uint8).reshape(truth.shape) > 0
            self.both += np.count_nonzero(mask & truth)
            self.either += np.count_nonzero(mask | truth)
            self.compared += 1

    def lines(self):
        with self.lock:
            yield f"masks published       {len(self.latencies)}"
            if self.latencies:
                yield f"mask age (median)     {1e3 * sorted(self.latencies)[len(self.latencies) // 2]:.0f} ms after its image"
            if self.compared and self.either:
                yield f"mask IoU              {self.both / self.either:.3f} over {self.compared} annotated images"


class Summary:
    def __init__(self, masks=None):
        self.masks = masks
        self.lock = threading.Lock()
        self.truth, self.twists, self.poses = Track(), [], []
        self.sweeps, self.refused, self.inliers, self.returns, self.computation = 0, {}, 0, 0, []
        self.subscribers = [
            rospy.Subscriber("ego/twist", TwistWithCovarianceStamped, self.on_twist, queue_size=1000),
            rospy.Subscriber("ego/status", EgoStatus, self.on_status, queue_size=1000),
            rospy.Subscriber("odom", Odometry, self.on_odometry, queue_size=1000),
            rospy.Subscriber("ground_truth/odom", Odometry, self.on_truth, queue_size=5000),
        ]

    def on_twist(self, message):
        with self.lock:
            self.twists.append((message.header.stamp.to_sec(), message.twist.twist.linear.x))

    def on_status(self, message):
        with self.lock:
            self.sweeps += 1
            if message.status != EgoStatus.OK:
                self.refused[message.reason] = self.refused.get(message.reason, 0) + 1
            self.inliers += message.inlier_count
            self.returns += message.return_count
            self.computation.append(message.computation_time)

    def on_odometry(self, message):
        with self.lock:
            self.poses.append((message.header.stamp.to_sec(), *self.pose(message)))

    def on_truth(self, message):
        with self.lock:
            self.truth.add(message.header.stamp.to_sec(), (message.twist.twist.linear.x, *self.pose(message)))

    @staticmethod
    def pose(message):
        """x, y, and cosine and sine of the yaw."""
        position, q = message.pose.pose.position, message.pose.pose.orientation
        yaw = math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))
        return position.x, position.y, math.cos(yaw), math.sin(yaw)

    @staticmethod
    def seen_from(start, pose):
        """Position in the frame of another pose."""
        x, y, (cosine, sine) = pose[0] - start[0], pose[1] - start[1], start[2:]
        return cosine * x + sine * y, cosine * y - sine * x

    def lines(self):
        yield f"sweeps estimated      {self.sweeps}"
        yield f"twists published      {len(self.twists)}"
        yield f"refused               {sum(self.refused.values())}"
        for reason, times in sorted(self.refused.items()):
            yield f"                      {times} x {reason}"
        if self.returns:
            yield f"inlier share          {self.inliers / self.returns:.3f}"
        if self.computation:
            yield f"computation (median)  {1e3 * sorted(self.computation)[len(self.computation) // 2]:.3f} ms per sweep"
        errors = [abs(speed - true[0]) for time, speed in self.twists for true in [self.truth.at(time)] if true]
        if errors:
            yield f"forward speed error   {sum(errors) / len(errors):.3f} m/s (mean, against /ground_truth/odom)"
        pairs = [(pose[1:], true[1:]) for pose in self.poses for true in [self.truth.at(pose[0])] if true]
        if pairs:
            truth = self.truth.values
            distance = sum(math.dist(a[1:3], b[1:3]) for a, b in zip(truth[::10], truth[10::10]))
            # The odometry may start at zero, whatever the frame of the truth.
            error = math.dist(*[self.seen_from(first, last) for first, last in zip(pairs[0], pairs[-1])])
            yield f"odometry end error    {error:.2f} m after {distance:.0f} m"
        if self.masks:
            yield from self.masks.lines()

    def report(self):
        with self.lock:
            print("replay summary\n  " + "\n  ".join(self.lines()), flush=True)


def main():
    argparse.ArgumentParser(
        prog="replay_summary.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="A ROS node: names and parameters as for any other, e.g. _masks:=true").parse_args(rospy.myargv()[1:])
    try:
        rospy.init_node("replay_summary")
    except rospy.exceptions.ROSInitException as error:  # interrupted, e.g. as another node has failed
        sys.exit(f"replay_summary: {error}")
    summary = Summary(Masks() if rospy.get_param("~masks", False) else None)
    rospy.on_shutdown(summary.report)
    rospy.spin()


if __name__ == "__main__":
    main()
