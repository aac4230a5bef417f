#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the report: of a bag that is made here, with values known without it. What needs ffmpeg or Chromium skips
visibly where they are not installed."""
import base64
import html.parser
import io
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np
import rosbag
import rospy
from PIL import Image as Picture
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import TransformStamped, TwistWithCovarianceStamped
from nav_msgs.msg import Odometry
from radar_dot.msg import EgoStatus, MovingObject, MovingObjects
from sensor_msgs.msg import CompressedImage, Image, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts")
sys.path.insert(0, SCRIPTS)
from recording_report import extraction, film, masks, page, scores, velocity_chart  # noqa: E402
from recording_report.recording import Recording, ReportError  # noqa: E402

START, COUNT, PERIOD = 1700000000.0, 101, 0.1  # s, twists, s
AGE = 0.04  # s
REFUSED, CHROMIUM = 4, next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)


def stamped(message, time, frame):
    message.header.stamp, message.header.frame_id = rospy.Time.from_sec(time), frame
    return message


def twist(time, vx, kind=TwistWithCovarianceStamped, frame="base_link"):
    message = stamped(kind(), time, frame)
    message.twist.twist.linear.x, message.twist.twist.angular.z = vx, 0.1
    covariance = np.zeros((6, 6))
    np.fill_diagonal(covariance, [0.01, 1e6, 1e6, 1e6, 1e6, 0.0001])  # vy: not observed
    message.twist.covariance = covariance.ravel().tolist()
    return message


def odometry(time, vx, x, y, yaw, frame):
    message = twist(time, vx, Odometry, frame)
    message.child_frame_id = "base_link"
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def cloud(time, residual):
    rows = np.array([[10.0, y, 0.0, residual] for y in range(-10, 11)] + [[math.nan] * 4], ">f4")
    fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(("x", "y", "z", "residual"))]
    return stamped(PointCloud2(height=1, width=len(rows), fields=fields, is_bigendian=True, point_step=16,
                               row_step=rows.nbytes, data=rows.tobytes()), time, "radar")


def diagnostics(time):
    values = [("clouds refused", "7"), ("last refusal", "its stamp is <zero>"), ("frame", "radar"), ("rate (Hz)", "10"),
              ("inlier share", "0.80"), ("median residual (m/s)", "0.050"), ("returns", "40"), ("returns accepted", "30"),
              ("yaw correction of the mount (rad)", "0.0123 +- 0.0021"),
              ("yaw of the mount learnt by the filter (rad)", "0.0100 +- 0.0010")]
    status = DiagnosticStatus(DiagnosticStatus.WARN, "ego_velocity: radar front", "7 clouds refused", "",
                              [KeyValue(*value) for value in values])
    return stamped(DiagnosticArray(status=[status]), time, "")


def jpeg(colour):
    stream = io.BytesIO()
    Picture.new("RGB", (800, 450), colour).save(stream, "JPEG")
    return stream.getvalue()


def mask():
    pixels = np.zeros((450, 800), np.uint8)
    pixels[:, 400:] = 255
    return Image(height=450, width=800, encoding="mono8", step=800, data=pixels.tobytes())


def true_mask(stream):
    """All but the left quarter: two thirds of it are masked."""
    pixels = np.zeros((450, 800), np.uint8)
    pixels[:, 200:] = 255
    Picture.fromarray(pixels).save(stream, "PNG")


def compressed_truth():
    stream = io.BytesIO()
    true_mask(stream)
    return CompressedImage(format="png", data=stream.getvalue())


VELOCITY = {"mae": {"A1": 0.3, "A2": 0.41, "B1": 0.5, "B2": None},
            "causal": {"filter": {"velocity_mae": 0.03, "vx_mae": 0.02, "vy_mae": 0.01, "yaw_rate_mae": 0.004}},
            "models": {"planar_yaw": {"velocity_mae": 0.05, "vx_mae": 0.04, "vy_mae": 0.02, "yaw_rate_mae": 0.009}}}
SCORES = {  # by the file: reports of evaluate_ego_velocity, evaluate_segmentation and evaluate_bag
    "velocity.json": {"scenes": [{"scene": "one", **VELOCITY}], "overall": VELOCITY},
    "paper.json": {"parameters": {"options": {"pairs": "keyframes"}, "dynamic_segmentation": {"score": "paper"}},
                   "scenes": [], "overall": {"iou": 0.25, "precision": 0.5, "recall": 0.3, "frames": 20}},
    "recording.json": {"scenes": [], "overall": {"compared": 5, "objects": {
        "movers_vehicle": 10, "recall_vehicle": 0.8, "recall_of_seen_vehicle": 0.9, "position_mae_vehicle": 1.5,
        "velocity_mae_vehicle": 0.5, "movers_cycle": 0}}},
}


def write_bag(path):
    """Driven at 4 to 6 m/s, 50 m ahead; the truth is 0.1 m/s slower, turned by 90 degrees, and ends 0.5 m short. Every
    second image has a true mask."""
    with rosbag.Bag(path, "w") as bag:
        def write(topic, message, age=AGE):
            bag.write(topic, message, message.header.stamp + rospy.Duration.from_sec(age))

        mount = stamped(TransformStamped(child_frame_id="radar"), START, "base_link")
        mount.transform.translation.x, mount.transform.rotation.w = 3.5, 1.0
        bag.write("/tf_static", TFMessage([mount]), mount.header.stamp)
        for i in range(COUNT):
            time, vx = START + PERIOD * i, 4.0 + 0.02 * i
            write("/ego/twist", twist(time, vx))
            write("/odom", odometry(time, vx, 0.5 * i, 2.0, 0.0, "odom"))
            write("/ground_truth/odom", odometry(time, vx - 0.1, 100.0, 0.495 * i, math.pi / 2, "map"), 0.0)
            write("/radar/static", cloud(time, 0.02))
            write("/radar/dynamic", cloud(time, 3.0))
            status = EgoStatus(return_count=100, inlier_count=80)
            if i < REFUSED:
                status = EgoStatus(status=EgoStatus.TOO_FEW_RETURNS, reason="3 returns are <too few>", return_count=100,
                                   inlier_count=80)
            write("/ego/status", stamped(status, time, "base_link"))
            mover = MovingObject(id=1, detections=5)
            mover.position.x, mover.velocity.x = 20.0 + i, 10.0
            write("/dynamic/objects", stamped(MovingObjects(objects=[mover]), time, "odom"))
            if i % 10 == 0:
                write("/diagnostics", diagnostics(time))
            if i % 2 == 0:
                write("/cam/image/compressed", stamped(CompressedImage(format="jpeg", data=jpeg((20, 90, 20))), time, "cam"))
                write("/dynamic/mask", stamped(mask(), time, "cam"), 0.2)
                if i % 4 == 0:
                    write(masks.TRUTH, stamped(compressed_truth(), time, "cam"))
                    write("/overlay/six_panel/compressed", stamped(CompressedImage(format="jpeg", data=jpeg((9, 9, 90))),
                                                                   time, "cam"), 0.3)


class Parsed(html.parser.HTMLParser):
    """Links and sources, the tiles by label, and the rows of the tables."""

    def __init__(self, text):
        super().__init__()
        self.sources, self.tiles, self.rows, self.path = [], {}, [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.sources += [(tag, value) for key, value in attributes if key in ("src", "href", "poster", "data")]
        if tag not in ("meta", "link", "img"):
            self.path.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        self.path.pop()

    def handle_data(self, data):
        if self.path[-2:] == ["div", "b"]:
            self.value = data
        elif self.path[-2:] == ["div", "span"]:
            self.tiles[data] = self.value
        elif "tr" in self.path:
            self.rows[-1][-1] += data


def content_of(uri):
    kind, text = uri.split(";base64,", 1)
    return kind[len("data:"):], base64.b64decode(text, validate=True)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.bag, cls.path = (os.path.join(cls.folder.name, name) for name in ("a <drive>.bag", "report.html"))
        write_bag(cls.bag)
        files = []
        for name, report in SCORES.items():
            files.append(os.path.join(cls.folder.name, name))
            with open(files[-1], "w", encoding="utf-8") as file:
                json.dump(report, file)
        cls.story = subprocess.run(
            [sys.executable, os.path.join(SCRIPTS, "report"), cls.bag, "--output", cls.path, "--title", "A <drive>", "--about",
             "simulated bend: to the <left>", "--next", "Say `more` <b>", "--scores", *files], check=True,
            stdout=subprocess.PIPE, encoding="utf-8").stdout
        with open(cls.path, encoding="utf-8") as file:
            cls.text = file.read()
        cls.parsed = Parsed(cls.text)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def row(self, first):
        return next(row for row in self.parsed.rows if row[0] == first)

    def test_needs_nothing_beside_it(self):
        for tag, source in self.parsed.sources:
            self.assertRegex(source, r"^(#[a-z]+$|data:)", tag)
        self.assertNotRegex(self.text, r"@import|url\(|https?://|file:")
        for text in ("<drive>", "<left>", " <b>"):
            self.assertNotIn(text, self.text)  # escaped

    def test_plots_decode(self):
        plots = [source for tag, source in self.parsed.sources if tag == "img"]
        kinds = [content_of(plot)[0] for plot in plots]
        self.assertEqual(kinds.count("image/jpeg"), 1)  # the six panels
        # motion, path, map, snapshot, velocity, radars, residuals, sweeps, ages
        self.assertEqual(kinds.count("image/svg+xml"), 9)
        for plot in plots:
            kind, content = content_of(plot)
            if kind == "image/jpeg":
                continue
            for element in xml.etree.ElementTree.fromstring(content).iter():
                for key, value in element.attrib.items():
                    if key.endswith("href"):
                        self.assertRegex(value, "^(#|data:image/png;base64,)")

    def test_values(self):
        tiles = self.parsed.tiles
        self.assertEqual(tiles["duration"], "10.0 s")
        self.assertEqual(tiles["distance"], "50.0 m")
        self.assertEqual(tiles["mean speed"], "5.00 m/s")
        self.assertEqual(tiles["top speed"], "6.00 m/s")
        self.assertEqual(tiles["rate of ego/twist"], "10.0 Hz")
        self.assertEqual(tiles["sweeps with an estimate"], "96.0 %")
        self.assertEqual(tiles["inliers among the returns"], "80.0 %")
        self.assertEqual(tiles["mean error of vx"], "0.100 m/s")
        self.assertEqual(self.row("vx (m/s)")[1:], ["0.1000", "0.1000", "0.1000", "100.0"])  # 3 sigma are 0.3 m/s
        self.assertEqual(self.row("yaw rate (rad/s)")[1:], ["0.0000", "0.0000", "0.0000", "100.0"])
        self.assertFalse([row for row in self.parsed.rows if row[0] == "vy (m/s)"])
        self.assertIn("0.50 m apart after 50.0 m", self.text)

    def test_the_story(self):
        """The lines of the terminal, which the page has at its top."""
        lines = dict(line.split(":", 1) for line in self.story.splitlines())
        lines = {key: value.strip() for key, value in lines.items()}
        self.assertEqual(lines["simulated"], "bend: to the <left>; 50 m in 10.0 s")
        self.assertEqual(lines["estimated"], "101 velocities out of 101 radar sweeps, 51 masks of moving pixels, 1 tracked objects")
        self.assertEqual(lines["forward speed"], "wrong by 0.100 m/s on average, at a mean speed of 5.0 m/s")
        self.assertEqual(lines["drift"], "1.00 % of the way: 0.50 m off after 50 m")
        self.assertEqual(lines["masks"], "IoU 0.67 with the true masks of 26 images (precision 1.00, recall 0.67)")
        self.assertEqual(lines["comparison"], "velocity off by 0.030 m/s, by the paper's planar estimators 0.300 m/s at best")
        self.assertEqual(list(lines)[-1], "report")
        for label, text in lines.items():
            if label != "report":
                self.assertEqual(self.row(label)[1], text)
        self.assertIn("<li>Say <code>more</code> &lt;b&gt;</li>", self.text)

    def test_scores(self):
        self.assertEqual(self.row("radar_dot: filtered")[1:], ["0.030", "0.020", "0.010", "0.004"])
        self.assertEqual(self.row("A1: static returns")[1:], ["0.300", "–", "–", "–"])
        self.assertFalse([row for row in self.parsed.rows if row[0].startswith("B2")])
        self.assertEqual(self.row("those of the recording, as in the film")[1:], ["0.667", "1.000", "0.667", "26"])
        self.assertEqual(self.row("pairs of keyframes, the paper's score (paper.json)")[1:], ["0.250", "0.500", "0.300", "20"])
        self.assertEqual(self.row("vehicle")[1:], ["10", "80", "90", "1.50", "0.50"])
        for text, wanted in (("{}", "overall"), ("[]", "TypeError"), ("{", "Decode"), ('{"overall": {}}', "neither models")):
            path = os.path.join(self.folder.name, "no_report.json")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            with self.assertRaisesRegex(ReportError, f"--scores: .*no_report.json: not a JSON report of.*{wanted}"):
                scores.load([path])

    def test_the_chart_names_the_package_first_and_hides_nothing(self):
        """The legend is beside the bars, whatever their number."""
        for count in (1, 2, 7, 40):
            report = {"scenes": [{"scene": f"scene-{i:04}", **VELOCITY} for i in range(count)], "overall": VELOCITY}
            drawn = velocity_chart.draw(velocity_chart.rows_of(report))
            drawn.canvas.draw()
            (axes,) = drawn.axes
            legend = axes.get_legend()
            self.assertEqual([text.get_text().split(":")[0] for text in legend.get_texts()],
                             ["radar_dot", "radar_dot", "A2", "A1", "B2", "B1"])
            box = legend.get_window_extent()
            self.assertGreaterEqual(box.x0, axes.get_window_extent().x1 - 1)
            self.assertLessEqual(box.x1, drawn.bbox.x1 + 1)
            velocity_chart.plt.close(drawn)

    def test_true_masks_of_a_folder(self):
        folder = os.path.join(self.folder.name, "truth")
        os.mkdir(folder)
        with self.assertRaisesRegex(ReportError, "--true-masks: .*truth: no file is named"):
            masks.TrueMasks(None, folder)
        true_mask(os.path.join(folder, f"drive__CAM_FRONT__{round(1e6 * START)}.png"))
        truth = masks.TrueMasks(None, folder)
        self.assertTrue(truth.has(START))
        self.assertFalse(truth.has(START + 0.2))
        self.assertAlmostEqual(np.asarray(truth.at(START)).mean() / 255, 0.75)
        self.assertEqual(masks.MaskScore(Recording([self.bag]), truth).compared, 1)

    def test_tables(self):
        self.assertEqual(self.row("front"), ["front", "radar", "10.0", "40", "30", "80", "0.050", "12.3 ± 2.1", "10.0 ± 1.0"])
        self.assertEqual(self.row("3 returns are <too few>")[1:], ["4", "4.0"])
        self.assertEqual(self.row("WARN")[1:4], ["ego_velocity: radar front", "7 clouds refused", "10 of 10"])
        self.assertEqual(self.row("ego_velocity: radar front")[1:], ["7", "its stamp is <zero>"])
        self.assertEqual(self.row("ego/twist")[1:], ["101", "40.0", "40.0", "40.0"])
        self.assertEqual(self.row("dynamic/mask")[1:3], ["51", "200.0"])

    def test_map(self):
        content = extraction.Content(Recording([self.bag]))
        base = content.returns.in_base(content.mounts)
        last = extraction.in_world(base, content.returns.rows[:, 0], content.motion.poses)[-21]
        np.testing.assert_allclose(last, [0.5 * 100 + 3.5 + 10.0, 2.0 - 10.0])

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is not installed")
    def test_film(self):
        (source,) = [source for tag, source in self.parsed.sources if tag == "video"]
        kind, content = content_of(source)
        self.assertEqual((kind, content[4:8]), ("video/mp4", b"ftyp"))
        self.assertIn("51 frames of <code>/cam/image/compressed and /dynamic/mask</code>", self.text)
        self.assertIn("in each of 26 annotated images, which stays until the next one", self.text)

    def test_the_truth_is_beside_the_mask(self):
        recording = Recording([self.bag])
        truth = masks.TrueMasks(recording)
        stamps = [START, START + 0.2]  # the second has no truth of its own
        frames = film.frames_of(recording, "/cam/image/compressed", stamps, film.read_masks(recording, stamps))
        frames = [np.asarray(frame).astype(int) for _, frame in film.beside_truth(
            frames, recording, "/cam/image/compressed", stamps[:1], truth)]
        self.assertEqual(len(frames), 2)
        for frame in frames:
            self.assertEqual(frame.shape, (360, 1280, 3))
            for x, channel in ((160, 1), (480, 0), (640 + 80, 1), (640 + 480, 1)):  # plain, magenta, plain, green
                self.assertEqual(np.argmax(frame[180, x]), channel)
            self.assertGreater(frame[180, 640 + 480, 1], frame[180, 640 + 80, 1] + 20)

    def test_strip_without_ffmpeg(self):
        which, film.shutil.which = film.shutil.which, lambda name: None
        try:
            made = film.make(Recording([self.bag]))
        finally:
            film.shutil.which = which
        kind, content = content_of(made.uri)
        picture = np.asarray(Picture.open(io.BytesIO(content)))
        self.assertEqual((kind, made.kind, picture.shape), ("image/jpeg", "", (2 * 360, 3 * 640, 3)))
        self.assertLess(picture[180, 160, 0], 60)  # half of each image is marked
        self.assertGreater(picture[180, 480, 0], 100)

    def test_what_is_not_there_is_named(self):
        path = os.path.join(self.folder.name, "twists.bag")
        with rosbag.Bag(path, "w") as bag:
            for i in range(3):
                message = twist(START + i, 1.0)
                bag.write("/car/ego/twist", message, message.header.stamp)
        with self.assertRaisesRegex(ReportError, "twists.bag: no /ego/twist.*say --namespace /car$"):
            extraction.Content(Recording([path]))
        content = extraction.Content(Recording([path], namespace="car"))
        text = page.Page(content, None, "no pictures", None).build()
        self.assertNotIn("<h2>Path", text)
        for topic in ("/car/odom", "/car/ego/status", "/car/radar/static", "/car/overlay/mask/compressed", "/diagnostics"):
            self.assertIn(f"needs <code>{topic}", text)
        self.assertIn("<li>Latency:", text)  # the stamps are those of the recording

    def test_errors_are_one_line(self):
        for arguments, wanted in ((["nothing.bag"], "nothing.bag: No such file"), ([__file__], "report_test.py: ")):
            with self.assertRaisesRegex(ReportError, wanted):
                Recording(arguments)
        with self.assertRaisesRegex(ReportError, "no reference on /gps; odometries and twists at hand: /ego/twist, /gr"):
            extraction.Content(Recording([self.bag]), "gps")
        path = os.path.join(self.folder.name, "inputs.bag")
        with rosbag.Bag(path, "w") as bag:
            bag.write("/imu", TFMessage())
        with self.assertRaisesRegex(ReportError, "inputs.bag: no /a, .*topics at hand: /imu$"):
            extraction.Content(Recording([path], {"ego/twist": "/a"}))

    @unittest.skipUnless(CHROMIUM, "Chromium is not installed")
    def test_in_a_browser(self):
        """A copy of the page tells what the browser made of it."""
        probe = """<script>
          const errors = [];
          addEventListener("error", event => errors.push(String(event.message || event.target.outerHTML.slice(0, 80))), true);
          addEventListener("load", async () => {
            const films = [...document.querySelectorAll("video")];
            await Promise.all(films.map(film => film.readyState > 0 ? null
              : new Promise(done => ["loadedmetadata", "error"].forEach(name => film.addEventListener(name, done)))));
            const images = [...document.images].map(image => image.complete && image.naturalWidth);
            const wide = document.documentElement.scrollWidth - innerWidth;
            document.body.textContent = "RES" + "ULT" + JSON.stringify({errors, images, wide, films: films.map(
              film => [film.videoWidth, film.videoHeight, film.duration])}) + "END";
          });</script>"""
        copy = os.path.join(self.folder.name, "probed.html")
        with open(copy, "w", encoding="utf-8") as file:
            file.write(self.text.replace("<head>", "<head>" + probe, 1))
        done = subprocess.run(
            [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr",
             f"--user-data-dir={self.folder.name}/profile", "--window-size=1200,900", "--timeout=120000", "--dump-dom",
             "file://" + copy], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=240, encoding="utf-8")
        self.assertTrue("RESULT" in done.stdout, done.stderr[-2000:])
        result = json.loads(done.stdout.split("RESULT")[1].split("END")[0])
        self.assertEqual(result["errors"], [])
        self.assertNotIn("CONSOLE", done.stderr)
        self.assertEqual(len(result["images"]), 10 if shutil.which("ffmpeg") else 11)
        self.assertTrue(all(width > 0 for width in result["images"]), result["images"])
        self.assertLessEqual(result["wide"], 0)  # nothing to scroll sideways
        if shutil.which("ffmpeg"):
            ((width, height, duration),) = result["films"]
            self.assertEqual((width, height), (1280, 360))
            self.assertAlmostEqual(duration, 10.2, delta=0.3)


if __name__ == "__main__":
    unittest.main(verbosity=2, warnings="ignore")
