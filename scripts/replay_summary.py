#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Listens to a replay and prints, when it ends, what the nodelets published and how far it is from /ground_truth/odom.

Subscribes: ego/twist, ego/status, odom, ground_truth/odom. Speeds in m/s, distances in m.
"""
import bisect
import math
import threading

import rospy
from geometry_msgs.msg import TwistWithCovarianceStamped
from nav_msgs.msg import Odometry
from radar_dot.msg import EgoStatus


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


class Summary:
    def __init__(self):
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
            position = message.pose.pose.position
            self.poses.append((message.header.stamp.to_sec(), position.x, position.y))

    def on_truth(self, message):
        with self.lock:
            position = message.pose.pose.position
            self.truth.add(message.header.stamp.to_sec(), (position.x, position.y, message.twist.twist.linear.x))

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
        errors = [abs(speed - true[2]) for time, speed in self.twists for true in [self.truth.at(time)] if true]
        if errors:
            yield f"forward speed error   {sum(errors) / len(errors):.3f} m/s (mean, against /ground_truth/odom)"
        ends = [(pose, true) for pose in self.poses for true in [self.truth.at(pose[0])] if true]
        if ends:
            truth = self.truth.values
            distance = sum(math.dist(a[:2], b[:2]) for a, b in zip(truth[::10], truth[10::10]))
            pose, true = ends[-1]
            error = math.hypot(pose[1] - true[0], pose[2] - true[1])
            yield f"odometry end error    {error:.2f} m after {distance:.0f} m"

    def report(self):
        with self.lock:
            print("replay summary\n  " + "\n  ".join(self.lines()), flush=True)


def main():
    rospy.init_node("replay_summary")
    summary = Summary()
    rospy.on_shutdown(summary.report)
    rospy.spin()


if __name__ == "__main__":
    main()
