#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""What README and docs/ show exists: links, anchors and pictures, the commands with their options, the arguments of the
launch files. docs_test.py BIN, the folder with the tools that are built."""
import functools
import pathlib
import re
import shlex
import subprocess
import sys
import unittest

from roslaunch.arg_dump import get_args

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1))
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").glob("*.md")])
LAUNCH_FILES = ["radar.launch", "radar_dot.launch", "replay.launch"]
# Options and launch arguments of programs that are not ours, in commands shown beside ours.
FOREIGN = {"--no-bond", "--benchmark_repetitions", "--benchmark_report_aggregates_only", "--build", "--clock", "--datafile",
           "--gtest_filter", "--install", "frame_id", "odom_topic", "visual_odometry"}
FENCE = re.compile(r"^( *)```(\w*)\n(.*?)^ *```", flags=re.M | re.S)


def text_of(page):
    return page.read_text(encoding="utf-8")


def prose_of(page):
    return FENCE.sub("", text_of(page))


def anchors(page):
    """As GitHub makes them of headings."""
    slugs = []
    for heading in re.findall(r"^#+ +(.*)$", FENCE.sub("", text_of(page)), flags=re.M):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
        slug = re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")
        slugs.append(slug if slug not in slugs else f"{slug}-{slugs.count(slug)}")
    return slugs


def commands(page):
    """Words of each command in shell blocks and in the text between them."""
    blocks = [block for _, language, block in FENCE.findall(text_of(page)) if language in ("sh", "bash")]
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    lines += re.findall(r"`([^`\n]+)`", prose_of(page))
    for line in lines:
        try:
            words = shlex.split(line, comments=True)
        except ValueError:  # prose
            continue
        command = []
        for word in words + [";"]:
            if re.fullmatch(r"[;&|]+|[<>]+.*|[({})]", word):
                if command:
                    yield command
                command = []
            else:
                command.append(word)


@functools.lru_cache(maxsize=None)
def options_of(program):
    """The options that a program of ours knows, or None where there is no such program."""
    script = ROOT / "scripts" / program
    if script.is_file():  # sooner read than run: some need minutes of imports
        options = set(re.findall(r"--[a-z][\w-]*", text_of(script)))
    elif (BIN / program).is_file():
        helped = subprocess.run([str(BIN / program), "--help"], stdout=subprocess.PIPE, check=True)
        options = set(re.findall(r"--[a-z][\w-]*", helped.stdout.decode().replace("--[no-]", "--")))
    else:
        return None
    return options | {option.replace("--", "--no-", 1) for option in options}


def arguments_of(launch_file):
    return set(get_args([str(ROOT / "launch" / launch_file)]))


class DocsTest(unittest.TestCase):
    def test_the_readme_is_one_screen(self):
        text = text_of(ROOT / "README.md")
        self.assertLessEqual(len(text.splitlines()), 150)
        self.assertLessEqual(len(text.encode()), 10000)

    def test_links_lead_somewhere(self):
        found = 0
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", prose_of(page)):
                if re.match(r"[a-z]+:", target):
                    continue
                found += 1
                file, _, anchor = target.partition("#")
                path = (page.parent / file).resolve() if file else page
                with self.subTest(page=page.name, target=target):
                    self.assertTrue(path.exists())
                    if anchor:
                        self.assertIn(anchor, anchors(path))
        self.assertGreater(found, 100)

    def test_shell_blocks_parse(self):
        blocks = [(page.name, block) for page in PAGES for _, language, block in FENCE.findall(text_of(page))
                  if language in ("sh", "bash")]
        self.assertGreater(len(blocks), 10)
        for page, block in blocks:
            parsed = subprocess.run(["bash", "-n"], input=block.encode(), stderr=subprocess.PIPE, check=False)
            self.assertEqual(parsed.returncode, 0, f"{page}: {block}\n{parsed.stderr.decode()}")

    def test_programs_and_their_options_exist(self):
        found = set()
        for page in PAGES:
            for words in commands(page):
                if words[:2] == ["rosrun", "radar_dot"] and len(words) > 2:
                    program, rest = words[2], words[3:]
                elif re.fullmatch(r"(\$\w+/|devel/lib/radar_dot/|(\./)?scripts/)[\w.]+", words[0]):
                    program, rest = words[0].split("/")[-1], words[1:]
                else:
                    continue
                with self.subTest(page=page.name, command=" ".join(words)):
                    known = options_of(program)
                    self.assertIsNotNone(known, "there is no such program")
                    for word in rest:
                        if word.startswith("--") and len(word) > 2:
                            self.assertTrue(word.split("=")[0] in known, word)
                    found.add(program)
        self.assertGreater(len(found), 15, found)

    def test_options_in_the_text_exist(self):
        known = set(FOREIGN)
        for program in [path.name for folder in (BIN, ROOT / "scripts") for path in folder.iterdir() if path.is_file()]:
            known |= options_of(program)
        for page in PAGES:
            for code in re.findall(r"`([^`\n]+)`", prose_of(page)):
                for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", code):
                    with self.subTest(page=page.name, code=code):
                        self.assertTrue(option in known, option)

    def test_arguments_of_launch_files_exist(self):
        every = set().union(*map(arguments_of, LAUNCH_FILES))
        for page in PAGES:
            for words in commands(page):
                if words[0] == "roslaunch" and words[1:2] == ["radar_dot"]:
                    known = arguments_of(words[2])
                elif "process_bag" in words or re.match(r"[a-z]\w*:=", words[0]):
                    known = every
                else:
                    continue  # remappings of a node
                for word in words:
                    with self.subTest(page=page.name, command=" ".join(words), argument=word):
                        if re.match(r"[a-z]\w*:=", word):
                            self.assertTrue(word.split(":=")[0] in known | FOREIGN)

    def test_all_arguments_of_launch_files_are_described(self):
        text = text_of(ROOT / "docs" / "nodes.md")
        section = text[text.index("\n## Launch files"):]
        section = section[:section.index("\n## ", 1)]
        described = {}
        for part in re.split(r"\n(?=`\w+\.launch`)", section)[1:]:
            rows = re.findall(r"^\| (`[^|]+`) \|", part, flags=re.M)
            described[re.match(r"`([\w.]+)`", part).group(1)] = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
        self.assertEqual(set(described), set(LAUNCH_FILES))
        radar = described["radar.launch"]
        self.assertEqual(radar, arguments_of("radar.launch"))
        self.assertEqual(described["radar_dot.launch"] | radar - {"mask"}, arguments_of("radar_dot.launch"))
        self.assertEqual(described["replay.launch"], arguments_of("replay.launch"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
