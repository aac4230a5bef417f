#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Optical flow of RAFT-small for the image pairs of a nuScenes dataroot, as files for evaluate_segmentation.

    raft_flow.py --dataroot DIR --scenes scene-0103 --weights raft_small.pth --output FLOWS
    evaluate_segmentation --dataroot DIR --scenes scene-0103 --flow files --flow-directory FLOWS

Every file is called like the first image of its pair and holds the flow in KITTI's 16-bit form, px of the working
size: (value - 2^15) / 64, third channel = valid. Weights are a state dict of torchvision's raft_small, or of the
authors' RAFT (princeton-vl). Needs python3-torch, python3-torchvision, python3-numpy, python3-pil (apt).
"""
import argparse
import json
import pathlib
import re
import struct
import sys
import zlib

import numpy as np


def load_table(dataroot, version, name):
    path = dataroot / version / f"{name}.json"
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"raft_flow: {path}: {error}")


def image_pairs(arguments):
    """(first, second) paths of consecutive keyframes, or of a keyframe and the next image, that are on disk."""
    tables = {name: load_table(arguments.dataroot, arguments.version, name)
              for name in ("scene", "sample", "sample_data", "calibrated_sensor", "sensor")}
    channels = {row["token"]: row["channel"] for row in tables["sensor"]}
    channel_of = {row["token"]: channels[row["sensor_token"]] for row in tables["calibrated_sensor"]}
    scene_names = {row["token"]: row["name"] for row in tables["scene"]}
    unknown = set(arguments.scenes) - set(scene_names.values())
    if unknown:
        sys.exit(f"raft_flow: no scene {', '.join(sorted(unknown))} in {arguments.dataroot}")
    scene_of = {row["token"]: scene_names[row["scene_token"]] for row in tables["sample"]}
    by_scene = {}
    for row in tables["sample_data"]:
        scene = scene_of.get(row["sample_token"])
        if channel_of[row["calibrated_sensor_token"]] != arguments.channel:
            continue
        if scene and (not arguments.scenes or scene in arguments.scenes):
            by_scene.setdefault(scene, []).append(row)
    pairs = []
    for rows in by_scene.values():
        rows.sort(key=lambda row: row["timestamp"])
        if arguments.pairs == "keyframes":
            rows = [row for row in rows if row["is_key_frame"]]
        for first, second in zip(rows, rows[1:]):
            paths = [arguments.dataroot / row["filename"] for row in (first, second)]
            if first["is_key_frame"] and all(path.exists() for path in paths):
                pairs.append(paths)
    return pairs


def torchvision_key(key):
    """Name in torchvision's raft_small of a weight of the authors' RAFT-small."""
    key = re.sub(r"^module\.", "", key)
    block = {"update_block.encoder.convc1": "update_block.motion_encoder.convcorr1.0",
             "update_block.encoder.convf1": "update_block.motion_encoder.convflow1.0",
             "update_block.encoder.convf2": "update_block.motion_encoder.convflow2.0",
             "update_block.encoder.conv.": "update_block.motion_encoder.conv.0.",
             "update_block.gru.convz": "update_block.recurrent_block.convgru1.convz",
             "update_block.gru.convr": "update_block.recurrent_block.convgru1.convr",
             "update_block.gru.convq": "update_block.recurrent_block.convgru1.convq"}
    for authors, torchvision in block.items():
        if key.startswith(authors):
            return torchvision + key[len(authors):]
    key = key.replace("fnet.", "feature_encoder.").replace("cnet.", "context_encoder.")
    match = re.match(r"(\w+_encoder)\.(.*)", key)
    if not match:
        return key
    encoder, rest = match.groups()
    rest = re.sub(r"^conv1\.", "convnormrelu.0.", rest)
    rest = re.sub(r"^norm1\.", "convnormrelu.1.", rest)
    rest = re.sub(r"^conv2\.", "conv.", rest)
    rest = re.sub(r"^(layer\d\.\d)\.conv(\d)\.", r"\1.convnormrelu\2.0.", rest)
    rest = re.sub(r"^(layer\d\.\d)\.norm([123])\.", r"\1.convnormrelu\2.1.", rest)
    return f"{encoder}.{rest}"


def load_model(path):
    import torch
    from torchvision.models.optical_flow import raft_small
    model = raft_small(weights=None)
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)  # a pickle could run anything otherwise
    except Exception as error:  # torch raises many kinds for a file that is not its own
        sys.exit(f"raft_flow: {path}: cannot be read as a state dict: {error}")
    own = model.state_dict()
    mapped = {key if key in own else torchvision_key(key): value for key, value in state.items()}
    missing, unused = sorted(set(own) - set(mapped)), sorted(set(mapped) - set(own))
    if missing or unused:
        sys.exit(f"raft_flow: {path}: is not RAFT-small; missing: {missing[:4]}, not used: {unused[:4]}")
    model.load_state_dict(mapped)
    print(f"{path}: all {len(own)} weights used")
    return model.eval()


def write_flow(path, flow):
    """flow: (2, height, width) px. 16-bit PNG with three channels, which PIL cannot write."""
    code = np.empty(flow.shape[1:] + (3,), ">u2")
    scaled = np.rint(flow * 64.0 + 32768.0)
    valid = np.isfinite(scaled).all(axis=0) & (np.abs(flow) < 511.0).all(axis=0)
    code[..., 0] = np.where(valid, scaled[0], 0)
    code[..., 1] = np.where(valid, scaled[1], 0)
    code[..., 2] = valid
    height, width = code.shape[:2]
    rows = np.zeros((height, 1 + width * 6), np.uint8)
    rows[:, 1:] = code.reshape(height, -1).view(np.uint8)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 16, 2, 0, 0, 0)
    unfinished = path.with_suffix(".part")
    unfinished.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                           chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b""))
    unfinished.replace(path)


def load_image(path, size):
    import torch
    from PIL import Image
    image = np.asarray(Image.open(path).convert("RGB").resize(size, Image.BOX), np.float32)
    return torch.from_numpy(image / 127.5 - 1.0).permute(2, 0, 1)[None]


def size_of(text):
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    size = tuple(int(part) for part in match.groups()) if match else (0, 0)
    if min(size) < 128 or size[0] % 8 or size[1] % 8:
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT with sides of 128 or more, multiples of 8")
    return size


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dataroot", type=pathlib.Path, required=True)
    parser.add_argument("--version", default="v1.0-mini")
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=[], help="comma-separated; default: all")
    parser.add_argument("--channel", default="CAM_FRONT")
    parser.add_argument("--pairs", choices=("keyframes", "next"), default="keyframes")
    parser.add_argument("--max-pairs", type=int, default=0, help="0 = all")
    parser.add_argument("--weights", type=pathlib.Path, required=True)
    parser.add_argument("--size", type=size_of, default=(640, 360), help="working size (default: 640x360)")
    parser.add_argument("--iterations", type=int, default=12)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    if arguments.iterations < 1 or arguments.max_pairs < 0:
        parser.error("--iterations must be 1 or more, --max-pairs 0 or more")
    import torch
    pairs = image_pairs(arguments)[:arguments.max_pairs or None]
    if not pairs:
        sys.exit(f"raft_flow: no image pairs of {arguments.channel} are under {arguments.dataroot}")
    model = load_model(arguments.weights)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for number, (first, second) in enumerate(pairs, 1):
        with torch.no_grad():
            flow = model(load_image(first, arguments.size), load_image(second, arguments.size),
                         num_flow_updates=arguments.iterations)[-1]
        write_flow(arguments.output / (first.stem + ".png"), flow[0].numpy())
        print(f"\r{number} of {len(pairs)}", end="", file=sys.stderr, flush=True)
    print(f"\n{len(pairs)} flows in {arguments.output}", file=sys.stderr)


if __name__ == "__main__":
    main()
