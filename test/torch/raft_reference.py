#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Flow of torchvision's own RAFT-small for two images, as float32 (2, height, width) in row-major order.

    raft_reference.py WEIGHTS ITERATIONS FIRST.png SECOND.png OUTPUT
"""
import pathlib
import sys

import numpy as np
import torch
from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import export_raft  # noqa: E402  (for its reading of weights)


def load_image(path):
    image = np.asarray(Image.open(path).convert("RGB"), np.float32)
    return torch.from_numpy(image / 127.5 - 1.0).permute(2, 0, 1)[None]


def main():
    weights, iterations, first, second, output = sys.argv[1:]
    model, _ = export_raft.load_raft("small", weights)
    with torch.no_grad():
        flow = model.eval()(load_image(first), load_image(second), num_flow_updates=int(iterations))[-1]
    flow[0].numpy().astype("<f4").tofile(output)


if __name__ == "__main__":
    main()
