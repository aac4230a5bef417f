#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Prints what the radars of a bag of nuscenes_to_bag need: for bags of simulate_drive the value of an ego_velocity
parameter in config/simulation.yaml, for others that in config/nuscenes.yaml. replay.launch asks it.
"""
import argparse
import os
import struct
import sys

import rospkg
import yaml


def header(file):
    """The fields of the next header, or of the next record's; quicker than the module rosbag is imported."""
    data, fields = file.read(struct.unpack("<I", file.read(4))[0]), {}
    while data:
        length = struct.unpack("<I", data[:4])[0]
        key, _, value = data[4:4 + length].partition(b"=")
        fields[key.decode()] = value
        data = data[4 + length:]
    return fields


def vehicle_of(path):
    """That of the log, as nuscenes_to_bag writes it beside /tf_static; empty where nothing says it.
    @throws ValueError where this is no complete bag"""
    with open(path, "rb") as file:
        if file.readline() != b"#ROSBAG V2.0\n":
            raise ValueError("is no bag")
        index = struct.unpack("<Q", header(file)["index_pos"])[0]
        if not index:
            raise ValueError("was not closed: rosbag reindex mends it")
        file.seek(index)
        while file.peek(1):
            record = header(file)
            if record["op"] != b"\x07":  # connections come first
                return ""
            length = file.read(4)
            end = file.tell() + struct.unpack("<I", length)[0]
            if record["topic"] == b"/tf_static":
                file.seek(-4, os.SEEK_CUR)  # the data of a connection are a header, too
                return header(file).get("vehicle", b"").decode()
            file.seek(end)
    return ""


def main():
    parser = argparse.ArgumentParser(prog="replay_parameter.py", description=__doc__)
    parser.add_argument("bag")
    parser.add_argument("parameter", help="of ego_velocity, e.g. doppler_scale; or vehicle: that of the bag")
    arguments = parser.parse_args()
    try:
        vehicle = vehicle_of(arguments.bag)
        if arguments.parameter == "vehicle":
            print(vehicle or "unknown")
            return
        name = "simulation.yaml" if vehicle == "simulated" else "nuscenes.yaml"
        with open(os.path.join(rospkg.RosPack().get_path("radar_dot"), "config", name), encoding="utf-8") as file:
            print(yaml.safe_load(file)["ego_velocity"][arguments.parameter])
    except OSError as error:
        sys.exit(f"{arguments.bag}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"{arguments.bag}: {error}")
    except (KeyError, struct.error):
        sys.exit(f"{arguments.bag}: is damaged, or {arguments.parameter} is in neither configuration")


if __name__ == "__main__":
    main()
