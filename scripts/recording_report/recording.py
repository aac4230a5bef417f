# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""One recording out of one or several bags, whose topics go by the names of docs/nodes.md."""
import os
import struct

import rosbag


class ReportError(Exception):
    """One line for the user."""


def seconds(stamp):
    return stamp.secs + 1e-9 * stamp.nsecs


def open_bag(path):
    try:
        return rosbag.Bag(path)
    except rosbag.ROSBagUnindexedException:
        raise ReportError(f"{path}: not closed when it was recorded: rosbag reindex repairs it")
    except (OSError, rosbag.ROSBagException) as error:
        raise ReportError(f"{path}: {getattr(error, 'strerror', None) or error}")


class Recording:
    """names: topics that replace those of docs/nodes.md, by the names there; namespace: of all others."""

    def __init__(self, paths, names=None, namespace="/"):
        self.paths = paths
        self.names, self.namespace = names or {}, "/" + namespace.strip("/")
        self.bags = [open_bag(path) for path in paths]
        self.types, self.counts = {}, {}
        for bag in self.bags:
            for topic, info in bag.get_type_and_topic_info().topics.items():
                self.types[topic] = info.msg_type
                self.counts[topic] = self.counts.get(topic, 0) + info.message_count

    def title(self):
        return ", ".join(os.path.basename(path) for path in self.paths)

    def topic(self, name):
        """The topic that goes by this name, whether or not the bags have it."""
        given = self.names.get(name, name)
        return given if given.startswith("/") else os.path.join(self.namespace, given)

    def has(self, name):
        return self.topic(name) in self.counts

    def of_type(self, *types):
        return sorted(topic for topic, kind in self.types.items() if kind in types)

    def read(self, handlers):
        """Calls the handler of each name with (message, time in the bag in s), bag by bag in the order of time."""
        by_topic = {self.topic(name): handler for name, handler in handlers.items()}
        topics = [topic for topic in by_topic if topic in self.counts]
        for bag in self.bags if topics else []:
            for topic, message, time in bag.read_messages(topics=topics):
                by_topic[topic](message, seconds(time))

    def messages(self, name):
        for bag in self.bags:
            for _, message, _ in bag.read_messages(topics=[self.topic(name)]):
                yield message

    def stamps(self, name):
        """(stamp, time in the bag) in s of all messages, which start with a header and are not decoded."""
        for bag in self.bags:
            for _, raw, time in bag.read_messages(topics=[self.topic(name)], raw=True):
                secs, nsecs = struct.unpack_from("<II", raw[1], 4)
                yield secs + 1e-9 * nsecs, seconds(time)
