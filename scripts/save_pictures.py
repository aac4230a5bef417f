#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Saves two pictures of a replay when it ends: the six panels and the mask over the image, at the annotated image
with the most moving pixels (without annotation: at the image with the largest mask).

Subscribes: overlay/six_panel, overlay/mask, dynamic/mask, ground_truth/dynamic_mask/compressed.
Parameter: ~folder, where six_panel.png and mask_overlay.png go; made where it is not there.
"""
import argparse
import io
import os
import sys
import threading

import numpy as np
import rospy
from PIL import Image as Picture
from sensor_msgs.msg import CompressedImage, Image

KEPT_SHARES = 40  # latest annotations; pictures come later than the annotation of their image
KEPT_PICTURES = 6  # latest pictures of each kind; they are large
KINDS = {"six_panel": "six_panel.png", "overlay": "mask_overlay.png"}


class Saver:
    def __init__(self, folder):
        self.folder = folder
        self.lock = threading.Lock()
        self.recent = {kind: {} for kind in KINDS}
        self.shares = {}  # share of moving pixels, by stamp
        self.annotated = False
        self.best_share, self.best = -1.0, {}
        large = {"queue_size": 10, "buff_size": 1 << 26}
        self.subscribers = [
            rospy.Subscriber("overlay/six_panel", Image, lambda m: self.on_picture("six_panel", m), **large),
            rospy.Subscriber("overlay/mask", Image, lambda m: self.on_picture("overlay", m), **large),
            rospy.Subscriber("dynamic/mask", Image, self.on_mask, **large),
            rospy.Subscriber("ground_truth/dynamic_mask/compressed", CompressedImage, self.on_truth, queue_size=50),
        ]

    def on_picture(self, kind, message):
        with self.lock:
            self.keep(self.recent[kind], message.header.stamp.to_nsec(), message, KEPT_PICTURES)
            self.choose(message.header.stamp.to_nsec())

    def on_mask(self, message):
        if self.annotated:
            return
        mask = np.frombuffer(message.data, np.uint8)
        self.on_share(message.header.stamp.to_nsec(), float(np.count_nonzero(mask)) / max(1, mask.size))

    def on_truth(self, message):
        mask = np.array(Picture.open(io.BytesIO(message.data)))
        with self.lock:
            if not self.annotated:
                self.annotated, self.best_share = True, -1.0
                self.shares.clear()
        self.on_share(message.header.stamp.to_nsec(), float(np.count_nonzero(mask)) / mask.size)

    def on_share(self, stamp, share):
        with self.lock:
            self.keep(self.shares, stamp, share, KEPT_SHARES)
            self.choose(stamp)

    @staticmethod
    def keep(messages, stamp, value, kept):
        messages[stamp] = value
        while len(messages) > kept:
            del messages[min(messages)]

    def choose(self, stamp):
        if stamp not in self.shares or any(stamp not in recent for recent in self.recent.values()):
            return
        if self.shares[stamp] > self.best_share:
            self.best_share = self.shares[stamp]
            self.best = {kind: recent[stamp] for kind, recent in self.recent.items()}

    def save(self):
        with self.lock:
            if not self.best:
                print("no picture to save: nothing came on overlay/six_panel and overlay/mask", file=sys.stderr)
                return
            for kind, message in self.best.items():
                pixels = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
                Picture.fromarray(pixels[:, :, ::-1]).save(os.path.join(self.folder, KINDS[kind]))


def main():
    argparse.ArgumentParser(
        prog="save_pictures.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="A ROS node: names and parameters as for any other, e.g. _folder:=$PWD").parse_args(rospy.myargv()[1:])
    try:
        rospy.init_node("save_pictures")
        folder = rospy.get_param("~folder", "")
        os.makedirs(folder, exist_ok=True)
    except (rospy.exceptions.ROSInitException, OSError) as error:
        sys.exit(f"save_pictures: {error}")
    saver = Saver(folder)
    rospy.on_shutdown(saver.save)
    rospy.spin()


if __name__ == "__main__":
    main()
