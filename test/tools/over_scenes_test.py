#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/over_scenes on small simulated scenes: over_scenes_test.py TOOLS Locally, or WithSlurm, which brings up a
Slurm of its own."""
import atexit
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

TOOLS = os.path.abspath(sys.argv.pop(1))
SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts", "over_scenes")
SCENES = ["scene-0004", "scene-0005", "scene-0001"]  # in the order of the tables, which is not that of their names
VERSION = ["--version", "v1.0-sim"]
RADARS = ["--doppler-scale", "1.0035"]


def tool(name, *arguments):
    subprocess.run([os.path.join(TOOLS, name)] + list(arguments), check=True, stdout=subprocess.DEVNULL)


def without_times(report):
    """Of one object of figures; where there are times, they are among the sums."""
    times = [key for key in report if key == "seconds" or key.startswith("ms_")]
    return {key: value for key, value in report.items() if key not in times and not (times and key == "sums")}


def figures(file):
    with open(file) as stream:
        report = json.load(stream)
    report["scenes"] = [without_times(scene) for scene in report["scenes"]]
    report["overall"] = without_times(report["overall"])
    return report


class OverScenes(unittest.TestCase):
    how = ["--jobs", "2"]

    @classmethod
    def setUpClass(cls):
        folder = tempfile.mkdtemp()
        atexit.register(shutil.rmtree, folder, True)
        cls.folder = folder
        cls.dataroot = os.path.join(folder, "sim")
        tool("simulate_drive", "--output", cls.dataroot, "--scenarios", "oncoming,car_park,crossing", "--duration", "1",
             "--width", "160", "--height", "90", "--frames", "pairs", "--lidar-rate", "2")

    def setUp(self):
        self.output = tempfile.mkdtemp(dir=self.folder)

    def path(self, *names):
        return os.path.join(self.output, *names)

    def run_script(self, name, *options, scenes=None, path=""):
        environment = dict(os.environ, PATH=path + TOOLS + ":" + os.environ["PATH"])
        command = [SCRIPT, name, "--dataroot", self.dataroot, "--output", self.output] + VERSION + self.how
        command += ["--scenes", scenes] if scenes else []
        return subprocess.run(command + ["--"] + list(options), env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=240)

    def one_run(self, name, *options):
        file = self.path("one.json")
        tool(name, "--dataroot", self.dataroot, "--scenes", ",".join(SCENES), "--json", file, "--csv",
             self.path("one.csv"), *(VERSION + list(options)))
        return figures(file)

    def text(self, *names):
        with open(self.path(*names)) as file:
            return file.read()

    def broken_scene(self):
        """A file of scene-0005 that no tool can read, until it is moved back."""
        folder = os.path.join(self.dataroot, "samples", "RADAR_FRONT")
        file = os.path.join(folder, sorted(name for name in os.listdir(folder) if "scene-0005" in name)[0])
        shutil.copy(file, self.path("whole"))
        with open(file, "w") as stream:
            stream.write("404 Not Found")
        self.addCleanup(shutil.copy, self.path("whole"), file)
        return file

    def test_failed_scenes_are_listed_and_done_by_the_next_run(self):
        broken = self.broken_scene()
        result = self.run_script("evaluate_ego_velocity", *RADARS)
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertIn("over_scenes: scene-0005: evaluate_ego_velocity: ", result.stdout)
        self.assertIn("1 of 3 scenes have no result", result.stdout)
        self.assertEqual([scene["scene"] for scene in figures(self.path("results.json"))["scenes"]],
                         ["scene-0004", "scene-0001"])
        before = os.stat(self.path("scenes", "scene-0004.json")).st_mtime_ns
        shutil.copy(self.path("whole"), broken)
        result = self.run_script("evaluate_ego_velocity", *RADARS)
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("3 scenes, 1 of them without a result", result.stdout)
        self.assertEqual(os.stat(self.path("scenes", "scene-0004.json")).st_mtime_ns, before)
        self.assertEqual(figures(self.path("results.json")), self.one_run("evaluate_ego_velocity", *RADARS))
        self.assertEqual(self.text("results.csv"), self.text("one.csv"))


class Locally(OverScenes):
    def test_the_merged_report_is_that_of_one_run(self):
        for name, options in [("evaluate_objects", RADARS), ("evaluate_depth", RADARS),
                              ("evaluate_flow", ["--pairs", "next"]),
                              ("evaluate_segmentation", ["--pairs", "next", "--ablation"])]:
            with self.subTest(name):
                self.output = tempfile.mkdtemp(dir=self.folder)
                result = self.run_script(name, *options)
                self.assertEqual(result.returncode, 0, result.stdout)
                merged, one = figures(self.path("results.json")), self.one_run(name, *options)
                self.assertEqual([scene["scene"] for scene in merged["scenes"]], SCENES)
                self.assertEqual(len(merged.pop("ablation", [])), len(one.pop("ablation", [])))
                self.assertEqual(merged, one)

    def test_bags_and_what_is_left_out_of_them(self):
        os.remove(self.broken_scene())
        # Another program of this name is not GNU parallel: xargs takes its place.
        with open(self.path("parallel"), "w") as file:
            file.write("#!/bin/sh\necho another parallel\n")
        os.chmod(self.path("parallel"), 0o755)
        result = self.run_script("nuscenes_to_bag", "--channels", "RADAR_FRONT", scenes="scene-0001,scene-0005",
                                 path=self.output + ":")
        self.assertEqual(result.returncode, 3, result.stdout)
        self.assertIn("left out: scene-0005 (sensor files): not on disk: RADAR_FRONT 1 of", result.stdout)
        self.assertEqual(sorted(name for name in os.listdir(self.output) if name.endswith(".bag")),
                         ["scene-0001.bag", "scene-0005.bag"])
        again = self.run_script("nuscenes_to_bag", "--channels", "RADAR_FRONT", scenes="scene-0001")
        self.assertEqual(again.returncode, 0, again.stdout)
        self.assertIn("1 scenes, 0 of them without a result", again.stdout)

    def test_results_that_do_not_go_together_are_not_merged(self):
        self.assertEqual(self.run_script("evaluate_ego_velocity", scenes="scene-0001").returncode, 0)
        result = self.run_script("evaluate_ego_velocity", *RADARS)
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds results of other options", result.stdout)
        other = self.path("other.json")
        tool("evaluate_ego_velocity", "--dataroot", self.dataroot, "--scenes", "scene-0004", "--json", other,
             *(VERSION + RADARS))
        merge = [os.path.join(TOOLS, "evaluate_ego_velocity"), "--merge", self.path("results.json")]
        for file, part in [(other, "parameters differ"), (self.path("results.json"), "also stands in")]:
            result = subprocess.run(merge[:2] + [merge[2] + "," + file], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                    universal_newlines=True)
            self.assertEqual(result.returncode, 1)
            self.assertIn(part, result.stderr)
        merge[0] = os.path.join(TOOLS, "evaluate_objects")
        result = subprocess.run(merge, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertIn("is a result of evaluate_ego_velocity", result.stderr)


CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=8000
PartitionName=test Nodes=ALL Default=YES State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def wait_for(what, is_there, seconds=60):
    end = time.time() + seconds
    while not is_there():
        if time.time() > end:
            raise AssertionError("no " + what + " within {} s".format(seconds))
        time.sleep(0.1)


os.environ["PATH"] += ":/usr/sbin:/sbin"
MISSING = [name for name in ["munged", "slurmctld", "slurmd", "sbatch", "sinfo"] if not shutil.which(name)]


@unittest.skipIf(MISSING, "not installed: " + ", ".join(MISSING))
@unittest.skipIf(os.getuid() != 0, "slurmd runs jobs as root alone")
class WithSlurm(OverScenes):
    how = ["--slurm", "--sbatch", "--cpus-per-task=1"]

    @classmethod
    def setUpClass(cls):
        super(WithSlurm, cls).setUpClass()
        # Names of sockets are short.
        slurm = tempfile.mkdtemp(prefix="slurm", dir="/tmp")
        cls.daemons = []
        atexit.register(shutil.rmtree, slurm, True)
        atexit.register(cls.end)
        for name in ["state", "spool"]:
            os.mkdir(os.path.join(slurm, name))
        os.chmod(slurm, 0o755)
        key = os.path.join(slurm, "munge.key")
        with open(os.open(key, os.O_CREAT | os.O_WRONLY, 0o400), "wb") as file:
            file.write(os.urandom(1024))
        os.environ["SLURM_CONF"] = os.path.join(slurm, "slurm.conf")
        host = socket.gethostname().split(".")[0]
        with open(os.environ["SLURM_CONF"], "w") as file:
            file.write(CONFIGURATION.format(folder=slurm, host=host, user="root", ports=free_ports(2)))
        cls.log = open(os.path.join(slurm, "log"), "w+")
        cls.start("munged", "--foreground", "--force", "--key-file=" + key, "--socket=" + slurm + "/munge.socket",
                  "--pid-file=" + slurm + "/munged.pid", "--log-file=" + slurm + "/munged.log",
                  "--seed-file=" + slurm + "/munged.seed")
        wait_for("munge", lambda: os.path.exists(slurm + "/munge.socket"))
        cls.start("slurmctld", "-D")
        cls.start("slurmd", "-D", "-N", host)
        wait_for("idle node", lambda: b"idle" in subprocess.run(
            ["sinfo", "--noheader", "--format=%T"], stdout=subprocess.PIPE, stderr=cls.log).stdout)

    @classmethod
    def start(cls, *command):
        cls.daemons.append(subprocess.Popen(command, stdout=cls.log, stderr=cls.log))

    @classmethod
    def end(cls):
        for daemon in reversed(cls.daemons):
            daemon.terminate()
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
        cls.daemons = []

    @classmethod
    def tearDownClass(cls):
        cls.end()


del OverScenes  # is no test by itself

if __name__ == "__main__":
    done = unittest.main(verbosity=2, exit=False).result
    sys.exit(1 if not done.wasSuccessful() else 77 if len(done.skipped) == done.testsRun else 0)
