# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Dynamic masks beside the true ones."""
import io
import os
import re

import numpy as np
from PIL import Image as Picture

from .recording import ReportError, seconds

TRUTH = "/ground_truth/dynamic_mask/compressed"


def microseconds(stamp):
    return round(1e6 * stamp)


class TrueMasks:
    """PNG images, 255 where something moves, by stamp: those of a folder, named as images of nuScenes are
    (..._<stamp in us>.png), else those of the recording."""

    def __init__(self, recording, folder=""):
        self.files, self.encoded = {}, {}
        if folder:
            self.find_files(folder)
        elif recording.has(TRUTH):
            for message in recording.messages(TRUTH):
                self.encoded[microseconds(seconds(message.header.stamp))] = bytes(message.data)
        self.source = folder or TRUTH

    def find_files(self, folder):
        try:
            names = os.listdir(folder)
        except OSError as error:
            raise ReportError(f"--true-masks: {folder}: {error.strerror}")
        for name in names:
            stamp = re.search(r"_(\d+)\.png$", name)
            if stamp:
                self.files[int(stamp.group(1))] = os.path.join(folder, name)
        if not self.files:
            raise ReportError(f"--true-masks: {folder}: no file is named ..._<stamp in us>.png")

    def __len__(self):
        return len(self.files) or len(self.encoded)

    def has(self, stamp):
        return microseconds(stamp) in (self.files or self.encoded)

    def at(self, stamp):
        """Image of 8 bit; None where there is none of this stamp."""
        key = microseconds(stamp)
        source = self.files[key] if key in self.files else io.BytesIO(self.encoded[key]) if key in self.encoded else None
        return None if source is None else Picture.open(source).convert("L")


class MaskScore:
    """Pixels of all masks that have a truth, and how much of each image moves by its stamp: truly where that is known
    of any, else as masked."""

    def __init__(self, recording, truth):
        self.count = self.compared = self.both = self.marked = self.moving = 0
        self.fractions = {}
        for message in recording.messages("dynamic/mask"):
            stamp, shape = seconds(message.header.stamp), (message.height, message.width)
            mask = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step or message.width)[:, :message.width] > 0
            self.count += 1
            true = truth.at(stamp)
            if true is not None:
                true = np.asarray(true.resize(shape[::-1], Picture.NEAREST)) > 0
                self.compared += 1
                self.both += np.count_nonzero(mask & true)
                self.marked += np.count_nonzero(mask)
                self.moving += np.count_nonzero(true)
                self.fractions[stamp] = true.mean()
            elif not len(truth):
                self.fractions[stamp] = mask.mean()

    def iou(self):
        return self.both / max(1, self.marked + self.moving - self.both)

    def precision(self):
        return self.both / self.marked if self.marked else float("nan")

    def recall(self):
        return self.both / self.moving if self.moving else float("nan")
