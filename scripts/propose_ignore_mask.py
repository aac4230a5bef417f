#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Proposes an ignore_mask: where the vehicle sees itself, the image does not move while a static world would.

Reads a bag with flow and dynamic/expected_flow, made without an ignore_mask:
process_bag DRIVE --config FILE --output BAG --topics flow,dynamic/expected_flow
"""
import argparse
import sys

import numpy as np
import rosbag
from PIL import Image as Picture

LEAST_MOTION = 4.0  # px of the image, of a static world
STILL = 0.25        # of that motion: less is none
OFTEN = 0.8         # of the pairs that say something
LEAST_PAIRS = 10    # of those
MARGIN = 0.01       # of the width, around what was found: flow there is that of both sides


def vectors_of(image):
    """Row, column, (u, v) of a 32FC2 image."""
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    return rows[:, :8 * image.width].copy().view("<f4").reshape(image.height, image.width, 2)


def pairs_of(path, flow_topic, expected_topic):
    """Length of the expected flow, px of the image, and of the flow as a fraction of it."""
    waiting = {}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages([flow_topic, expected_topic]):
            other = waiting.pop(message.header.stamp, None)
            if other is None:
                waiting[message.header.stamp] = message
                continue
            flow, expected = (message, other) if topic == flow_topic else (other, message)
            length = np.linalg.norm(vectors_of(expected), axis=2)
            with np.errstate(all="ignore"):
                fraction = np.linalg.norm(vectors_of(flow.flow), axis=2) / length
            yield length * flow.image_width / flow.flow.width, fraction


def grown(mask):
    """By a pixel to all sides."""
    wide = np.pad(mask, 1)
    return wide[1:-1, 1:-1] | wide[:-2, 1:-1] | wide[2:, 1:-1] | wide[1:-1, :-2] | wide[1:-1, 2:]


def at_border(mask):
    """The regions that reach the border: a car that drives ahead does not move in the image either."""
    reached = mask.copy()
    reached[1:-1, 1:-1] = False
    while True:
        more = grown(reached) & mask
        if (more == reached).all():
            return reached
        reached = more


def propose(pairs):
    told = still = 0
    for length, fraction in pairs:
        tells = length > LEAST_MOTION  # False for NaN
        told = told + tells
        still = still + (tells & (fraction < STILL))
    if not np.any(np.asarray(told) >= LEAST_PAIRS):
        raise ValueError("fewer than {} pairs of flow and expected flow show a motion of {} px: it takes a drive of a "
                         "minute or so, with turns".format(LEAST_PAIRS, LEAST_MOTION))
    mask = at_border((told >= LEAST_PAIRS) & (still >= OFTEN * told))
    for _ in range(round(MARGIN * mask.shape[1]) if mask.any() else 0):
        mask = grown(mask)
    return mask


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag")
    parser.add_argument("--output", default="ignore_mask.png", help="image to write (default: %(default)s)")
    parser.add_argument("--flow", default="/flow", metavar="TOPIC", help="default: %(default)s")
    parser.add_argument("--expected", default="/dynamic/expected_flow", metavar="TOPIC", help="default: %(default)s")
    arguments = parser.parse_args()
    try:
        mask = propose(pairs_of(arguments.bag, arguments.flow, arguments.expected))
        Picture.fromarray(np.where(mask, 255, 0).astype(np.uint8)).save(arguments.output)
    except (OSError, ValueError, rosbag.ROSBagException) as error:
        sys.exit("propose_ignore_mask.py: {}: {}".format(arguments.bag, error))
    print("{}: {:.1f} % of the image; look at it before you use it".format(arguments.output, 100.0 * mask.mean()))


if __name__ == "__main__":
    main()
