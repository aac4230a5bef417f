# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""The page of a report: one HTML file that needs nothing beside it."""
import datetime
import html
import re

import numpy as np

from . import plots, scores, velocity_chart
from .extraction import COMPONENTS

CSS = """
:root { --ink: #1b1f24; --soft: #57606a; --line: #dde2e7; --blue: #1f5fa8; --paper: #ffffff; --ground: #f5f7f9; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
       font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 0 24px 48px; }
header { padding: 36px 0 8px; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 1.25rem; margin: 0 0 4px; }
h3 { font-size: 1.05rem; margin: 18px 0 0; }
.story table { margin: 0; }
.story tr:last-child > * { border-bottom: none; }
.story th { white-space: nowrap; width: 9rem; vertical-align: top; }
header p { margin: 0; color: var(--soft); }
nav { margin: 18px 0 0; font-size: 0.92rem; }
nav a { display: inline-block; margin: 0 18px 4px 0; color: var(--blue); text-decoration: none; }
nav a:hover { text-decoration: underline; }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 22px 26px;
          margin-top: 20px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(215px, 1fr)); gap: 12px; margin-top: 20px; }
.tile { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 12px 16px; }
.tile b { display: block; font-size: 1.45rem; line-height: 1.3; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 0.86rem; }
figure { margin: 12px 0 0; }
figure + figure { margin-top: 26px; }
figure img, figure video { display: block; max-width: 100%; height: auto; margin: 0 auto; border-radius: 4px; }
figure img.plot { width: 100%; }
figcaption, .note { color: var(--soft); font-size: 0.92rem; max-width: 80ch; margin: 6px 0 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 14px 0 2px; font-size: 0.92rem; width: 100%; }
th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--soft); font-weight: 600; vertical-align: bottom; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
td.number { white-space: nowrap; }
.level { display: inline-block; padding: 0 8px; border-radius: 9px; font-size: 0.8rem; font-weight: 600; }
.level1 { background: #fff3d6; color: #7a4d00; }
.level2, .level3 { background: #fde2e4; color: #96121d; }
.good { color: #1a7f37; }
details { margin-top: 12px; }
summary { cursor: pointer; color: var(--blue); }
pre { background: var(--ground); border: 1px solid var(--line); border-radius: 6px; padding: 12px; overflow-x: auto;
      font-size: 0.84rem; }
ul.missing { padding-left: 20px; margin: 8px 0 0; }
code { font-size: 0.92em; overflow-wrap: anywhere; }
footer { color: var(--soft); font-size: 0.86rem; margin-top: 24px; }
@media print { body { background: white; } nav { display: none; } section { break-inside: avoid; } }
"""
LEVELS = {1: "WARN", 2: "ERROR", 3: "STALE"}
MOST_WARNINGS = 40
START_UP = 1.0  # s after the first twist, the period of the diagnostics: "nothing received yet" says nothing then


def escaped(text):
    return html.escape(str(text))


def tile(value, unit, label):
    return f'<div class="tile"><b>{escaped(value)}{f" {escaped(unit)}" if unit else ""}</b><span>{escaped(label)}</span></div>'


def table(head, rows, numbers=()):
    """Rows of HTML; numbers: columns to the right."""
    def cells(tag, row):
        return "".join(f'<{tag}{" class=number" if i in numbers else ""}>{cell}</{tag}>' for i, cell in enumerate(row))

    return ('<div class="scroll"><table><thead><tr>' + cells("th", head) + "</tr></thead><tbody>"
            + "".join(f"<tr>{cells('td', row)}</tr>" for row in rows) + "</tbody></table></div>")


def figure(uri, caption, alt):
    return f'<figure><img class="plot" alt="{escaped(alt)}" src="{uri}"><figcaption>{caption}</figcaption></figure>'


def with_code(text):
    """HTML of a text with `code`."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escaped(text))


def decimals(value, digits, scale=1.0):
    return f"{round(scale * value, digits) + 0.0:.{digits}f}" if np.isfinite(value) else "–"  # + 0.0: no -0.0


class Page:
    """Sections in the order of reading; what the bag does not hold is noted at the end."""

    def __init__(self, content, film, film_error, config=None, panels=None, masks=None, reports=(), title="",
                 summary=(), steps=()):
        """panels: (data URI, stamp); reports: of scores.load(); summary: of summary.lines(); steps: what to try next."""
        self.content, self.film, self.film_error, self.config = content, film, film_error, config
        self.panels, self.masks, self.reports = panels, masks, reports
        self.title, self.summary, self.steps = title or content.recording.title(), summary, steps
        self.sections, self.missing = [], []

    def add(self, anchor, title, *parts):
        self.sections.append((anchor, title, "".join(parts)))

    def lack(self, what, topic):
        self.missing.append(f"<li>{escaped(what)}: needs <code>{escaped(topic)}</code></li>")

    def topic(self, name):
        return self.content.recording.topic(name)

    def tiles(self):
        motion, sweeps = self.content.motion, self.content.sweeps
        speeds = np.hypot(motion.twists.rows[:, 0], motion.twists.rows[:, 1])
        result = [tile(decimals(motion.duration(), 1), "s", "duration"),
                  tile(decimals(motion.distance(), 1), "m", "distance"),
                  tile(decimals(speeds.mean(), 2), "m/s", "mean speed"),
                  tile(decimals(speeds.max(), 2), "m/s", "top speed"),
                  tile(decimals((len(motion.twists) - 1) / motion.duration(), 1), "Hz", "rate of ego/twist")]
        if len(sweeps.series):
            result.append(tile(decimals(100 * sweeps.series.rows[:, 2].mean(), 1), "%", "sweeps with an estimate"))
            result.append(tile(decimals(100 * np.nanmean(sweeps.shares()), 1), "%", "inliers among the returns"))
        for name, _, absolute, _, _ in motion.errors()[:1]:
            result.append(tile(decimals(absolute, 3), "m/s", f"mean error of {name}"))
        return f'<div class="tiles">{"".join(result)}</div>'

    def motion(self):
        motion = self.content.motion
        errors = motion.errors()
        caption = (f"The {self.content.reference_name} (dashed) should stay within the band of three standard deviations"
                   if errors else "The band is three standard deviations wide to either side")
        parts = [figure(plots.motion(self.content),
                        f"{caption}; where the line is missing the radars do not observe that component.",
                        "forward speed, sideslip and yaw rate over time")]
        if errors:
            rows = [[f"{name} ({'rad/s' if name == COMPONENTS[2] else 'm/s'})", decimals(bias, 4),
                     decimals(absolute, 4), decimals(rms, 4), decimals(100 * inside, 1)]
                    for name, bias, absolute, rms, inside in errors]
            parts.append(table([f"error against the {self.content.reference_name}", "mean", "mean absolute", "root mean square",
                                "within 3&sigma; (%)"], rows, range(1, 5)))
            parts.append('<p class="note">Mean: what is wrong all the time, as by a scale. Mean absolute: how far off to expect '
                         "it. Within 3&sigma;: about 99.7 % where the stated uncertainty is right. The "
                         f"{self.content.reference_name} is <code>{escaped(self.topic(self.content.reference))}</code>, "
                         "taken as the velocity of the same frame, interpolated at the stamps of the twists.</p>")
        else:
            self.lack("Errors against a reference", self.content.reference or "/ground_truth/odom, or --reference")
        self.add("motion", "Motion", *parts)

    def path(self):
        if len(self.content.motion.poses) < 2:
            self.lack("The path", self.topic("odom"))
            return
        aligned = self.content.motion.aligned_reference()
        caption = "The driven path, seen from above."
        if aligned:
            caption = (f"The driven path, seen from above, with the {self.content.reference_name} laid on its first pose: "
                       f"at the end they are {aligned[1]:.2f} m apart after {self.content.motion.distance():.1f} m.")
        self.add("path", "Path", figure(plots.path(self.content), caption, "path from above"))

    def pictures(self):
        if not self.film:
            self.lack(f"The film ({self.film_error})", f"{self.topic('overlay/mask/compressed')}, or an image "
                      f"(image:=TOPIC) with {self.topic('dynamic/mask')}")
            return
        film = self.film
        part = (f"{film.length:.1f} s of {film.whole_length:.1f} s" if film.whole_length > film.length + 0.05
                else f"{film.length:.1f} s")
        caption = "What moves independently is marked in magenta"
        if film.truths:
            held = "" if film.truths == film.frames else ", which stays until the next one"
            caption = (f"Left: {caption[0].lower()}{caption[1:]} by radar_dot. Right: what truly moves, in green, in each of "
                       f"{film.truths} annotated images{held}. Look for green without magenta (missed) and magenta without "
                       "green (false)")
        if self.content.recording.topic("overlay/mask") in film.source:
            caption += ". Hatched: no depth or flow, so neither marked nor counted as static"
        caption += f". {part}, {film.frames} frames of <code>{escaped(film.source)}</code>."
        if film.kind:
            shown = (f'<video controls autoplay muted loop playsinline preload="metadata" width="{film.size[0]}" '
                     f'height="{film.size[1]}" src="{film.uri}"></video>')
        else:
            shown = f'<img alt="frames of the film" src="{film.uri}">'
            caption += f" A few frames instead of the video: {escaped(film.note)}."
        self.add("film", "What moves in the images", f"<figure>{shown}<figcaption>{caption}</figcaption></figure>")

    def six_panels(self):
        if not self.panels:
            if self.film:
                self.lack("The six panels", self.topic("overlay/six_panel/compressed") + " (process_bag --six-panel)")
            return
        uri, stamp = self.panels
        self.add("panels", "How a mask comes about", f'<figure><img alt="six panels" src="{uri}"><figcaption>The image in '
                 f"which most moves, at {stamp - self.content.motion.start():.1f} s. Above: the mask in the image; the residual "
                 "between the observed flow and that of a static world, from which the mask is made; that expected flow, by "
                 "the radars' velocity and the depth. Below: the depth; the radar returns, static and dynamic; the flow "
                 "observed between the two images.</figcaption></figure>")

    def scores(self):
        """Tables of the evaluators, each with a sentence on how to read it."""
        parts, truth = [], self.content.reference_name
        for name, report, kind in self.reports:
            if kind == "velocity":
                rows = [[escaped(label), *(decimals(value, 3) for value in values)]
                        for label, *values in scores.velocity_rows(report)]
                head = ["estimator", "|v &minus; v<sub>true</sub>| (m/s)", "vx (m/s)", "vy (m/s)", "yaw rate (rad/s)"]
                parts.append(f"<h3>Velocity</h3>{table(head, rows, range(1, 5))}")
                parts.append('<p class="note">Mean errors, the smaller the better; compare the first column. The paper\'s four '
                             "estimators have a planar model without yaw rate, which errs wherever the vehicle turns.</p>")
                chart = plots.finished(velocity_chart.draw(velocity_chart.rows_of(report)))
                parts.append(figure(chart, f"The first column by scene (<code>{escaped(name)}</code>).",
                                    "error of each estimator of the velocity"))
        rows = []
        if self.masks and self.masks.compared:
            rows.append(["those of the recording, as in the film", decimals(self.masks.iou(), 3), decimals(self.masks.precision(), 3),
                         decimals(self.masks.recall(), 3), self.masks.compared])
        for name, report, kind in self.reports:
            if kind == "masks":
                *values, count = scores.mask_row(report)
                rows.append([f"{escaped(scores.mask_label(report))} (<code>{escaped(name)}</code>)",
                             *(decimals(value, 3) for value in values), count])
        if rows:
            parts.append(f"<h3>Masks</h3>{table(['masks', 'IoU', 'precision', 'recall', 'images'], rows, range(1, 5))}")
            parts.append('<p class="note">Pixels of all images together. Precision: how much of what is marked moves. Recall: how '
                         "much of what moves is marked. IoU: what is both over what is either, 1 where every pixel is "
                         "right; without learned segmentation 0.3 to 0.5 is good.</p>")
        for name, report, kind in self.reports:
            rows = [[escaped(kind), int(count), decimals(recall, 0, 100), decimals(seen, 0, 100), decimals(position, 2),
                     decimals(velocity, 2)] for kind, count, recall, seen, position, velocity in scores.object_rows(report)]
            if rows:
                head = ["moving objects", "annotated", "found (%)", "of those with returns (%)", "position off by (m)",
                        "velocity off by (m/s)"]
                parts.append(f"<h3>Objects</h3>{table(head, rows, range(1, 6))}")
                parts.append('<p class="note">Annotated movers in each keyframe, and how many a track stands on, by radar: '
                             "pedestrians return little, which the radar hears only close by.</p>")
        if parts:
            self.add("scores", f"Compared with the {truth}", *parts)

    def next_steps(self):
        content, steps = self.content, list(self.steps)
        if not content.reference:
            steps.append("Give a reference, so that errors are shown: `--reference TOPIC`, an odometry or twists of the same frame.")
        if not self.film:
            steps.append("Add a camera: `process_bag` with `camera:=NAME`, see docs/recordings.md.")
        turned = [name for name, radar in sorted(content.health.radars.items()) if len(radar["series"])
                  and abs(radar["series"].rows[-1, 5]) > max(0.005, 3 * radar["series"].rows[-1, 6])]
        if turned:
            steps.append(f"The mounts of {', '.join(turned)} seem to be turned: `calibrate_radars` finds by how much, see "
                         "docs/calibration.md.")
        if steps:
            items = "".join(f"<li>{with_code(step)}</li>" for step in steps)
            self.add("next", "What to try next", f"<ul>{items}</ul>")

    def surroundings(self):
        content = self.content
        if not len(content.returns.rows):
            reason = f" ({content.returns.left_out})" if content.returns.left_out else ""
            self.lack(f"Returns and residuals{reason}", f"{self.topic('radar/static')}, {self.topic('radar/dynamic')}")
            return
        unmounted = [frame for frame, mount in content.mounts.items() if mount is None]
        if unmounted:
            self.lack("Top views of the radars in " + ", ".join(unmounted),
                      f"/tf_static from {content.motion.base_frame}")
        if not len(content.objects.rows):
            self.lack("Tracked objects", self.topic("dynamic/objects"))
        parts = []
        world, now = plots.surroundings(content), plots.snapshot(content)
        if world:
            parts.append(figure(world, "All returns of the drive where the odometry puts them: static ones should draw "
                                "walls and parked cars once and sharply, dynamic ones should lie along the green "
                                "tracks.", "map of returns and tracks"))
        if now:
            time = plots.busiest_moment(content)[0] - content.motion.start()
            parts.append(figure(now, f"The busiest moment, {time:.1f} s, around the vehicle; each arrow reaches as far "
                                "as its object moves over ground in one second.", "one sweep and its objects"))
        if parts:
            self.add("surroundings", "Static and dynamic returns", *parts)

    def radars(self):
        content, parts = self.content, []
        if content.health.radars:
            rows = []
            for name, radar in sorted(content.health.radars.items()):
                series = radar["series"].rows
                if not len(series):
                    continue
                median = np.nanmedian(series[:, :5], axis=0)
                last = series[-1]
                rows.append([escaped(name), escaped(radar["frame"]), decimals(median[2], 1), decimals(median[3], 0),
                             decimals(median[4], 0), decimals(median[0], 0, 100), decimals(median[1], 3),
                             *(f"{decimals(yaw, 1, 1e3)} &plusmn; {decimals(sigma, 1, 1e3)}" if np.isfinite(sigma)
                               else "–" for yaw, sigma in (last[5:7], last[7:9]))])
            parts.append(table(["radar", "frame", "Hz", "returns", "accepted", "inliers (%)", "residual (m/s)",
                                "yaw correction (mrad)", "learnt yaw (mrad)"], rows, range(2, 9)))
            parts.append('<p class="note">Medians over the drive; yaws as last reported, with 1&sigma;: what the returns '
                         "say the mount is turned by against the other radars, and what the filter has learnt of it.</p>")
            parts.append(figure(plots.radars(content), "A radar with fewer inliers than the others, or with a yaw correction "
                                "that stays away from zero by more than its band, has a turned mount.",
                                "yaw corrections and inliers over time"))
        else:
            self.lack("Mounts and inliers of each radar", "/diagnostics")
        if len(content.returns.rows):
            parts.append(figure(plots.residuals(content), "The median of the static returns should be flat at zero at "
                                "all azimuths (of the radar's own frame): a slope or a wave is a turned mount, an offset "
                                "a wrong scale or a delay.", "residual over azimuth of each radar"))
        if parts:
            self.add("radars", "Radars and mounts", *parts)

    def sweeps(self):
        sweeps = self.content.sweeps
        if not len(sweeps.series):
            self.lack("Outcome of every sweep", self.topic("ego/status"))
            return
        total = len(sweeps.series)
        refused = sum(sweeps.reasons.values())
        text = f'<p class="good">All {total} sweeps gave an estimate.</p>'
        if refused:
            rows = [[escaped(reason), count, decimals(100 * count / total, 1)]
                    for reason, count in sorted(sweeps.reasons.items(), key=lambda item: -item[1])]
            text = (f"<p>{refused} of {total} sweeps were refused.</p>"
                    + table(["reason", "sweeps", "%"], rows, (1, 2)))
        self.add("sweeps", "Sweeps", text, figure(
            plots.sweeps(self.content), "The share of accepted returns that agree with the estimate, and their numbers: "
            "few inliers or few returns are where estimates get uncertain.", "inliers and returns over time"))

    def diagnostics(self):
        health, start = self.content.health, self.content.motion.start()
        if not health.reports:
            self.lack("Warnings and refusals", "/diagnostics")
            return
        rows = [[f'<span class="level level{level}">{LEVELS.get(level, level)}</span>', escaped(name), escaped(text),
                 f"{count} of {total}", f"{first - start:.1f} – {last - start:.1f}"]
                for level, name, text, count, total, first, last in health.warnings(start + START_UP)]
        if rows:
            parts = [table(["level", "what", "latest text", "reports", "time&nbsp;(s)"], rows[:MOST_WARNINGS], (3, 4))]
            if len(rows) > MOST_WARNINGS:
                parts.append(f'<p class="note">{len(rows) - MOST_WARNINGS} more are left out.</p>')
        else:
            parts = ['<p class="good">No warning and no error.</p>']
        if health.refusals:
            parts.append(table(["input", "refused", "last reason"],
                               [[escaped(name), count, escaped(reason)]
                                for name, (count, reason) in sorted(health.refusals.items())], (1,)))
        else:
            parts.append('<p class="good">No message was refused.</p>')
        parts.append(f'<p class="note">Reports of <code>/diagnostics</code>, one per second and input, from {START_UP:g} s '
                     "after the first twist on; texts that differ in numbers alone count as one.</p>")
        self.add("diagnostics", "Warnings and refusals", *parts)

    def latency(self):
        ages = self.content.ages
        if not ages:
            self.missing.append("<li>Latency: the outputs are recorded at their own stamps, as in offline processing"
                                "</li>")
            return
        rows = [[escaped(name), len(values), *(decimals(np.percentile(values, q), 1, 1e3) for q in (50, 95, 100))]
                for name, values in ages.items() if len(values)]
        self.add("latency", "Latency", table(["output", "messages", "median (ms)", "95 % (ms)", "largest (ms)"], rows,
                                             range(1, 5)),
                 figure(plots.ages(self.content), "Time from the stamp of the measurement to the recording of the output "
                        "(box: middle half, whiskers: 5 to 95 %); in a replay it is as coarse as the clock, and may be "
                        "just below zero.", "ages of the outputs"))

    def about(self):
        recording = self.content.recording
        rows = [[f"<code>{escaped(topic)}</code>", escaped(recording.types[topic]), count]
                for topic, count in sorted(recording.counts.items())]
        parts = []
        if self.missing:
            parts.append(f'<p>Left out, because the bag does not hold it:</p><ul class="missing">'
                         f'{"".join(self.missing)}</ul>')
        parts.append("<details><summary>Topics of the bag</summary>"
                     + table(["topic", "type", "messages"], rows, (2,)) + "</details>")
        if self.config:
            parts.append(f"<details><summary>Configuration: {escaped(self.config[0])}</summary><pre>"
                         f"{escaped(self.config[1])}</pre></details>")
        self.add("about", "About this report", *parts)

    def build(self):
        for part in (self.pictures, self.motion, self.path, self.surroundings, self.six_panels, self.scores, self.radars,
                     self.sweeps, self.diagnostics, self.latency, self.next_steps, self.about):
            part()
        motion = self.content.motion
        date = datetime.datetime.utcfromtimestamp(motion.start()).strftime("%Y-%m-%d %H:%M:%S UTC")
        title = self.title
        story = "".join(f"<tr><th>{escaped(label)}</th><td>{escaped(text)}</td></tr>" for label, text in self.summary)
        story = story and f'<section class="story"><table>{story}</table></section>'
        links = "".join(f'<a href="#{anchor}">{escaped(name)}</a>' for anchor, name, _ in self.sections)
        body = "".join(f'<section id="{anchor}"><h2>{escaped(name)}</h2>{inner}</section>'
                       for anchor, name, inner in self.sections)
        return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
                f'content="width=device-width, initial-scale=1"><title>radar_dot: {escaped(title)}</title>'
                f'<link rel="icon" href="data:,"><style>{CSS}</style></head><body><main><header><h1>{escaped(title)}</h1>'
                f"<p>{escaped(date)}, times from there on; velocity in the frame "
                f"<code>{escaped(motion.base_frame)}</code></p><nav>{links}</nav></header>"
                f"{story}{self.tiles()}{body}<footer>Made by radar_dot report.</footer></main></body></html>\n")
