#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/benchmark in a repository of its own, whose build makes a program that says what the tree says."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = os.path.join(os.path.dirname(__file__), "..", "..", "scripts", "benchmark")

BUILD = """#!/bin/sh
mkdir -p "$RADAR_DOT_BUILD/benchmark"
cat > "$RADAR_DOT_BUILD/benchmark/toy_benchmark" <<PROGRAM
#!/bin/sh
echo $(cat "$(dirname "$0")/../name") >> "$LOG"
echo '{"benchmarks": [{"name": "Toy", "real_time": $(cat "$(dirname "$0")/../time"), "time_unit": "us"},
                      {"name": "Same", "real_time": 7, "time_unit": "ms"}]}'
PROGRAM
chmod +x "$RADAR_DOT_BUILD/benchmark/toy_benchmark"
"""


@unittest.skipUnless(shutil.which("git"), "git is not installed")
class BenchmarkTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.tree = os.path.join(self.folder, "tree")
        os.makedirs(os.path.join(self.tree, "scripts"))
        shutil.copy(SCRIPT, os.path.join(self.tree, "scripts"))
        self.write("scripts/build", BUILD)
        os.chmod(os.path.join(self.tree, "scripts", "build"), 0o755)
        self.write("time", "2.0")
        self.write("name", "then")
        self.git("init", "--quiet")
        self.git("add", ".")
        self.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "--quiet", "-m", "first")
        self.write("time", "3.0")
        self.write("name", "now")

    def write(self, name, text):
        with open(os.path.join(self.tree, name), "w") as file:
            file.write(text)

    def git(self, *arguments):
        subprocess.run(["git", "-C", self.tree] + list(arguments), check=True)

    def run_script(self, *arguments):
        environment = dict(os.environ, LOG=os.path.join(self.folder, "log"))
        environment.pop("RADAR_DOT_BUILD", None)
        return subprocess.run([os.path.join(self.tree, "scripts", "benchmark")] + list(arguments), env=environment,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)

    def test_both_revisions_run_in_turn(self):
        for _ in range(2):  # again, where the worktree exists
            result = self.run_script("--against", "HEAD", "--runs", "3")
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(re.search(r"^Toy +2 us +3 us +1\.50  1\.50  1\.50  slower$", result.stdout, re.M), result.stdout)
        self.assertTrue(re.search(r"^Same +7 ms +7 ms +1\.00  1\.00  1\.00$", result.stdout, re.M), result.stdout)
        with open(os.path.join(self.folder, "log")) as file:
            self.assertEqual(file.read().split(), ["then", "now", "now", "then", "then", "now"] * 2)

    def test_an_unknown_revision_is_refused(self):
        result = self.run_script("--against", "nowhere")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no revision nowhere", result.stderr)


if __name__ == "__main__":
    unittest.main()
