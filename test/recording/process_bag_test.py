#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
#
# process_bag gives what the live nodelets give, always the same, and says what is wrong with its input.
#     process_bag_test.py SOURCE_FOLDER SIMULATOR CONVERTER
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import genpy
import rosbag
import yaml

SOURCE, SIMULATOR, CONVERTER = [os.path.realpath(path) for path in sys.argv[1:4]]
PROCESS_BAG = os.path.join(SOURCE, "scripts", "process_bag")
CONFIG = os.path.join(SOURCE, "config", "simulation.yaml")
IMAGES = ["/cam_front/image/compressed", "/cam_front/camera_info"]
RADARS = ["/radar_" + name for name in ("front", "front_left", "front_right", "back_left", "back_right")]
PATIENCE = 60.0  # s


def free_port():
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def messages(path, *topics):
    """By topic: {stamp: message}."""
    found = {topic: {} for topic in topics}
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages(list(topics)):
            found[topic][message.header.stamp.to_nsec()] = message
    return found


class ProcessBagTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        subprocess.check_call([SIMULATOR, "--output", os.path.join(cls.folder, "drive"), "--scenarios", "oncoming",
                               "--duration", "3", "--lidar-rate", "2", "--ground-truth", "keyframes", "--width", "320",
                               "--height", "180", "--quiet"])
        subprocess.check_call([CONVERTER, "--dataroot", os.path.join(cls.folder, "drive"), "--version", "v1.0-sim",
                               "--output", cls.folder, "--quiet"])
        cls.drive = next(os.path.join(cls.folder, name) for name in os.listdir(cls.folder) if name.endswith(".bag"))
        cls.output = cls.path("out.bag")
        cls.text = cls.process(cls.drive, "--output", cls.output, "--six-panel")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def process(cls, *arguments, code=0):
        environment = {key: value for key, value in os.environ.items() if key != "ROS_MASTER_URI"}
        run = subprocess.run([PROCESS_BAG, "--config", CONFIG] + list(arguments), env=environment, timeout=10 * PATIENCE,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        assert run.returncode == code, run.stdout
        return run.stdout

    def wait_until(self, condition):
        end = time.time() + PATIENCE
        while not condition():
            self.assertLess(time.time(), end)
            time.sleep(0.02)

    def part_of_drive(self, name, keep):
        """A bag with the messages for which keep(topic, time since the start) holds."""
        path = self.path(name)
        with rosbag.Bag(self.drive) as bag, rosbag.Bag(path, "w") as part:
            begin = bag.get_start_time()
            for topic, message, stamp, header in bag.read_messages(return_connection_header=True):
                if keep(topic, stamp.to_sec() - begin):
                    part.write(topic, message, stamp, connection_header=header)
        return path

    def test_every_output_has_the_stamps_of_its_inputs(self):
        inputs = messages(self.drive, "/radar_front", IMAGES[0])
        outputs = messages(self.output, "/ego/twist", "/ego/status", "/odom", "/dynamic/mask", "/dynamic/objects",
                           "/radar/static", "/overlay/mask/compressed", "/overlay/six_panel/compressed")
        scans = {stamp for topic in RADARS for stamp in messages(self.drive, topic)[topic]}
        images = sorted(inputs[IMAGES[0]])
        for topic, found in outputs.items():
            stamps = images if topic == "/dynamic/mask" or topic.startswith("/overlay") else scans
            self.assertTrue(found, topic)
            self.assertLessEqual(set(found), set(stamps), topic)
        # The first image has none before it; look_back starts with the second pair, but gives each a mask.
        self.assertEqual(sorted(outputs["/dynamic/mask"]), images[:-1])
        self.assertEqual(len(outputs["/ego/twist"]), len(outputs["/odom"]))
        truth = messages(self.drive, "/ground_truth/odom")["/ground_truth/odom"]
        errors = []
        for stamp, twist in outputs["/ego/twist"].items():
            nearest = min(truth, key=lambda other: abs(other - stamp))
            errors.append(abs(twist.twist.twist.linear.x - truth[nearest].twist.twist.linear.x))
        self.assertLess(sum(errors) / len(errors), 0.1)
        self.assertIn("/ego/twist", self.text)
        # What is neither image nor cloud comes along.
        with rosbag.Bag(self.output) as bag:
            topics = bag.get_type_and_topic_info().topics
        self.assertIn("/ground_truth/odom", topics)
        self.assertIn("/tf_static", topics)
        self.assertNotIn("/radar_front", topics)
        self.assertNotIn("/flow", topics)

    def test_the_same_recording_gives_the_same_bytes(self):
        again = self.path("again.bag")
        self.process(self.drive, "--output", again, "--six-panel")
        with open(self.output, "rb") as first, open(again, "rb") as second:
            self.assertEqual(first.read(), second.read())

    def test_a_recording_in_parts_and_compressed_is_the_same(self):
        parts = [self.part_of_drive("radars.bag", lambda topic, _: topic in RADARS),
                 self.part_of_drive("others.bag", lambda topic, _: topic not in RADARS)]
        subprocess.check_call(["rosbag", "compress", "--bz2", "-q", parts[1]])
        output = self.path("parts_out.bag")
        self.process(*parts, "--output", output, "--topics", "ego/twist,dynamic/mask")
        expected, found = [messages(bag, "/ego/twist", "/dynamic/mask") for bag in (self.output, output)]
        self.assertEqual(expected["/ego/twist"], found["/ego/twist"])
        self.assertEqual({stamp: mask.data for stamp, mask in expected["/dynamic/mask"].items()},
                         {stamp: mask.data for stamp, mask in found["/dynamic/mask"].items()})

    def test_live_nodelets_say_the_same(self):
        live, offline = self.path("live.bag"), self.path("short_out.bag")
        short = self.part_of_drive("short.bag", lambda _, seconds: seconds < 1.0)
        self.process(short, "--output", offline)
        port = str(free_port())
        environment = dict(os.environ, ROS_MASTER_URI="http://localhost:" + port, ROS_HOSTNAME="localhost",
                           ROS_LOG_DIR=self.path("log"))
        launch = ["roslaunch", "-p", port, os.path.join(SOURCE, "launch", "replay.launch"), "bag:=" + short,
                  "config:=" + CONFIG, "rotation_source:=radar", "start_at_source:=false", "delay:=4.0",
                  "rate:=0.1"]  # no answer comes later than the next input
        quiet = {"env": environment, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        started = []
        try:
            started.append(subprocess.Popen(["rosmaster", "--core", "-p", port], **quiet))
            self.wait_until(lambda: socket.socket().connect_ex(("localhost", int(port))) == 0)
            started.append(subprocess.Popen(["rosbag", "record", "-O", live, "/ego/twist", "/dynamic/mask"],
                                            start_new_session=True, **quiet))
            self.wait_until(lambda: os.path.exists(live + ".active"))
            subprocess.run(launch, timeout=PATIENCE, check=False, **quiet)
            os.killpg(started[1].pid, signal.SIGINT)  # the recorder is a child of its front end
            self.wait_until(lambda: os.path.exists(live))
        finally:
            for process in started:
                process.terminate()
                process.wait()
        topics = ["/ego/twist", "/dynamic/mask"]
        expected, found = messages(offline, *topics), messages(live, *topics)
        for topic in topics:
            self.assertGreater(len(found[topic]), 5)
            self.assertEqual(sorted(expected[topic]), sorted(found[topic]), topic)
        for stamp, twist in found["/ego/twist"].items():
            other = expected["/ego/twist"][stamp].twist.twist
            for one, two in ((twist.twist.twist.linear.x, other.linear.x), (twist.twist.twist.linear.y, other.linear.y),
                             (twist.twist.twist.angular.z, other.angular.z)):
                self.assertAlmostEqual(one, two, delta=1e-9)
        for stamp, mask in found["/dynamic/mask"].items():
            self.assertTrue(mask.data == expected["/dynamic/mask"][stamp].data, stamp)
        self.assertTrue(any(any(mask.data) for mask in found["/dynamic/mask"].values()))

    def test_mounts_and_calibration_come_from_files_where_the_recording_lacks_them(self):
        bare = self.part_of_drive("bare.bag", lambda topic, _: not topic.startswith("/tf") and topic != IMAGES[1])
        with rosbag.Bag(self.drive) as bag:
            mounts = [entry for _, message, _ in bag.read_messages(["/tf_static"]) for entry in message.transforms]
            camera = next(message for _, message, _ in bag.read_messages([IMAGES[1]]))
        launch = self.path("mounts.launch")
        with open(launch, "w") as file:
            file.write("<launch>")
            for i, mount in enumerate(mounts):
                place, turn = mount.transform.translation, mount.transform.rotation
                numbers = (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w)
                file.write('<node pkg="tf2_ros" type="static_transform_publisher" name="mount_{}" args="{} {} {}"/>'.format(
                    i, " ".join(map(repr, numbers)), mount.header.frame_id, mount.child_frame_id))
            file.write('<arg name="config"/><include file="{}/launch/radar_dot.launch" pass_all_args="true"/></launch>'.format(
                SOURCE))
        info = self.path("camera.yaml")
        with open(info, "w") as file:
            file.write("image_width: {}\nimage_height: {}\ndistortion_model: plumb_bob\n".format(
                camera.width, camera.height))
            for name, values in (("distortion_coefficients", camera.D), ("camera_matrix", camera.K),
                                 ("rectification_matrix", camera.R), ("projection_matrix", camera.P)):
                file.write("{}: {{data: {}}}\n".format(name, list(values)))
        output = self.path("bare_out.bag")
        self.process(bare, "--output", output, "--launch", launch, "--camera-info", IMAGES[1] + "=" + info)
        expected, found = [messages(bag, "/ego/twist", "/dynamic/mask") for bag in (self.output, output)]
        self.assertEqual(expected["/ego/twist"], found["/ego/twist"])
        self.assertEqual(sorted(expected["/dynamic/mask"]), sorted(found["/dynamic/mask"]))

    def test_a_file_of_mounts(self):
        radars = self.part_of_drive("no_tf.bag", lambda topic, _: topic in RADARS)
        file = self.path("mounts.yaml")
        with open(file, "w") as mounts:
            for name, x, y, yaw in (("front", 3.4, 0.0, 0.0), ("back_left", -0.6, 0.6, 3.1)):
                mounts.write("- {{parent: base_link, child: radar_{}, x: {}, y: {}, z: 0.5, yaw: {}}}\n".format(
                    name, x, y, yaw))
        output = self.path("tf_out.bag")
        text = self.process(radars, "--output", output, "--topics", "radar", "--tf", file)
        transforms = {}
        with rosbag.Bag(output) as bag:
            for _, message, _ in bag.read_messages(["/tf_static"]):
                transforms.update({entry.child_frame_id: entry.transform for entry in message.transforms})
        self.assertEqual(transforms["radar_back_left"].translation.y, 0.6)
        # half the angle of 3.1 rad about z
        self.assertAlmostEqual(transforms["radar_back_left"].rotation.z, 0.999784, places=5)
        self.assertIn("no transform from 'radar_front_left'", text)  # the summary names what is still missing

    def test_a_part_of_the_recording(self):
        output = self.path("part_out.bag")
        self.process(self.drive, "--output", output, "--topics", "radar", "--start", "1", "--duration", "1")
        with rosbag.Bag(self.drive) as bag:
            begin = genpy.Time.from_sec(bag.get_start_time()).to_nsec()
        stamps = [(stamp - begin) * 1e-9 for stamp in messages(output, "/ego/twist")["/ego/twist"]]
        self.assertGreater(min(stamps), 0.8)
        self.assertLess(max(stamps), 2.1)
        self.assertGreater(len(stamps), 8)

    def test_what_is_wrong_is_said_and_leaves_nothing(self):
        output = self.path("never.bag")
        text = self.process(self.path("none.bag"), "--output", output, code=1)
        self.assertIn("none.bag: there is no such file", text)
        text = self.process(self.drive, "--output", output, "--topics", "ego/twisted", code=1)
        self.assertIn("no nodelet publishes /ego/twisted", text)
        self.assertIn("/ego/twist_raw", text)
        text = self.process(self.drive, "--output", self.output, code=1)
        self.assertIn("exists already", text)
        text = self.process(self.drive, "--output", output, "wrong:=1", code=1)
        self.assertIn("wrong", text)
        text = self.process(self.drive, "--output", output, "--tf", CONFIG, code=1)
        self.assertIn("a mount is {parent", text)
        self.assertFalse([name for name in os.listdir(self.folder) if name.startswith("never")])

    def test_an_interrupt_ends_it_cleanly(self):
        output = self.path("interrupted.bag")
        process = subprocess.Popen([PROCESS_BAG, self.drive, "--config", CONFIG, "--output", output],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                                   start_new_session=True)
        self.wait_until(lambda: any(name.startswith("interrupted.bag.partial") for name in os.listdir(self.folder)))
        os.killpg(process.pid, signal.SIGINT)
        text, _ = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 130, text)
        self.assertIn("interrupted", text)
        self.assertNotIn("Traceback", text)
        self.assertFalse([name for name in os.listdir(self.folder) if name.startswith("interrupted")])

    def test_mount_yaws_are_read_at_the_start_and_written_at_the_end(self):
        with open(CONFIG) as file:
            config = yaml.safe_load(file)
        for radar in config["ego_velocity"]["radars"].values():
            radar["mount_yaw_correction"] = 0.02
        saved = config["ego_velocity"]["mount_yaws_file"] = self.path("yaws.yaml")
        with open(self.path("turned.yaml"), "w") as file:
            yaml.safe_dump(config, file)
        with open(saved, "w") as file:
            yaml.safe_dump({name: {"yaw": -0.02, "std": 0.002} for name in config["ego_velocity"]["radars"]}, file)
        output = self.path("turned.bag")
        turned = ["--config", self.path("turned.yaml"), "--topics", "radar", self.drive]
        self.process("--output", output, *turned)
        right, corrected = [messages(path, "/ego/twist_raw")["/ego/twist_raw"] for path in (self.output, output)]
        self.assertEqual(sorted(right), sorted(corrected))
        for stamp, message in right.items():
            self.assertAlmostEqual(message.twist.twist.linear.y, corrected[stamp].twist.twist.linear.y, 6)
        with open(saved) as file:
            learnt = yaml.safe_load(file)
        self.assertEqual(sorted(learnt), sorted(config["ego_velocity"]["radars"]))
        for mount in learnt.values():
            self.assertAlmostEqual(mount["yaw"], -0.02, delta=0.006)
            self.assertLess(mount["std"], 0.002)

        with open(saved, "w") as file:
            file.write("front: {yaw: left}\n")
        text = self.process("--output", self.path("refused.bag"), *turned)
        self.assertIn("yaws.yaml:1: front/yaw is 'left'", text)
        with open(saved) as file:
            self.assertEqual(file.read(), "front: {yaw: left}\n")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
