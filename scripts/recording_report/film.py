# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""A short film of the images with what moves marked, beside what truly moves where that is known: as a video by
ffmpeg, without it as a strip of frames; and the six panels of one moment."""
import io
import os
import shutil
import subprocess
import tempfile

import numpy as np
from PIL import Image as Picture

from .plots import data_uri
from .recording import seconds

LONGEST = 20.0  # s
WIDEST = 640  # px, of one image
WIDEST_PANELS = 1680  # px
MOST_FRAMES_PER_SECOND = 15.0
STRIP = 6  # frames
MARK = np.array([232, 30, 140])  # RGB of what moves
TRULY = np.array([30, 160, 70])  # RGB of what truly moves
ENCODERS = (  # at most 2.5 Mbit/s: 6 MB
    ("video/mp4", "mp4", ["-c:v", "libx264", "-preset", "veryfast", "-crf", "25", "-maxrate", "2500k", "-bufsize",
                          "5000k", "-movflags", "+faststart"]),
    ("video/webm", "webm", ["-c:v", "libvpx", "-crf", "20", "-b:v", "2000k", "-deadline", "good", "-cpu-used", "4"]),
)
ENCODINGS = {"rgb8": ("RGB", "RGB", 3), "bgr8": ("RGB", "BGR", 3), "rgba8": ("RGBA", "RGBA", 4),
             "bgra8": ("RGBA", "BGRA", 4), "mono8": ("L", "L", 1), "8UC1": ("L", "L", 1)}


class FilmError(Exception):
    """Why there is no film."""


class Film:
    """kind: of the data URI, "" where it is a strip of frames; source: the topics it is made of; truths: frames that
    have a true mask of their own."""

    def __init__(self, uri, kind, source, frames, length, truths, size, whole_length, note=""):
        self.uri, self.kind, self.source, self.frames, self.length = uri, kind, source, frames, length
        self.truths, self.size, self.whole_length, self.note = truths, size, whole_length, note


def picture_of(message):
    """Of an Image or CompressedImage."""
    if not hasattr(message, "encoding"):
        picture = Picture.open(io.BytesIO(message.data))
        picture.draft("RGB", (WIDEST, WIDEST))  # JPEG: decoded at no more than what is needed
        return picture
    if message.encoding not in ENCODINGS:
        raise FilmError(f"images of encoding '{message.encoding}' are not shown")
    mode, raw_mode, channels = ENCODINGS[message.encoding]
    size = (message.width, message.height)
    return Picture.frombuffer(mode, size, message.data, "raw", raw_mode, message.step or channels * size[0], 1)


def scaled(picture, size=None, resample=Picture.BILINEAR):
    if size is None:
        width = min(WIDEST, picture.width)
        size = (width // 2 * 2, round(picture.height * width / picture.width) // 2 * 2)  # encoders want even sizes
    return picture if picture.size == size else picture.resize(size, resample)


def image_topic(recording):
    """The name given as image, else the camera of the masks; compressed before raw."""
    if "image" in recording.names:
        return "image"
    topics = recording.of_type("sensor_msgs/CompressedImage", "sensor_msgs/Image")
    topics = sorted((topic for topic in topics if topic.endswith(("/image/compressed", "/image"))),
                    key=lambda topic: not topic.endswith("/compressed"))
    if not topics:
        return None
    frame = next((mask.header.frame_id for mask in recording.messages("dynamic/mask")), None)
    own = [topic for topic in topics if frame in (None, next(recording.messages(topic)).header.frame_id)]
    return (own or topics)[0]


def window(recording, name, start):
    stamps = np.array([stamp for stamp, _ in recording.stamps(name)])
    if not len(stamps):
        raise FilmError(f"nothing on {recording.topic(name)}")
    first = stamps.min() + start
    stamps = np.unique(stamps[(stamps >= first) & (stamps <= first + LONGEST)])
    if len(stamps) < 2:
        raise FilmError(f"fewer than two frames on {recording.topic(name)} from {start:g} s on")
    rate = (len(stamps) - 1) / (stamps[-1] - stamps[0])
    return stamps[::max(1, int(np.ceil(rate / MOST_FRAMES_PER_SECOND - 0.1)))]


def read_masks(recording, stamps):
    wanted, masks = set(stamps), {}
    for message in recording.messages("dynamic/mask"):
        if seconds(message.header.stamp) in wanted:
            masks[seconds(message.header.stamp)] = scaled(picture_of(message).convert("L"), None, Picture.NEAREST)
    return masks


def marked(picture, mask, colour=MARK):
    pixels = np.array(picture)
    moves = np.asarray(scaled(mask, picture.size, Picture.NEAREST)) > 0
    pixels[moves] = 0.5 * pixels[moves] + 0.5 * colour
    return Picture.fromarray(pixels)


def frames_of(recording, name, stamps, masks, size=None):
    """(stamp, image)"""
    wanted = set(stamps)
    for message in recording.messages(name):
        stamp = seconds(message.header.stamp)
        if stamp not in wanted:
            continue
        wanted.remove(stamp)
        picture = scaled(picture_of(message).convert("RGB"), size)
        size = picture.size
        yield stamp, marked(picture, masks[stamp]) if stamp in masks else picture


def beside_truth(frames, recording, image, stamps, truth):
    """The frames, each with the latest annotated image up to it on its right."""
    annotated, following, right = None, None, None
    for stamp, left in frames:
        if annotated is None:
            right = Picture.new("RGB", left.size, (40, 44, 48))
            annotated = frames_of(recording, image, stamps, {}, left.size)
            following = next(annotated, None)
        while following and following[0] <= stamp:
            right = marked(following[1], truth.at(following[0]), TRULY)
            following = next(annotated, None)
        both = Picture.new("RGB", (2 * left.width, left.height))
        both.paste(left, (0, 0))
        both.paste(right, (left.width, 0))
        yield stamp, both


def source_of(recording, start):
    """(name of the topic of pictures, stamps, masks by stamp, what they are made of)."""
    for overlay in ("overlay/mask/compressed", "overlay/mask"):
        if recording.has(overlay):
            return overlay, window(recording, overlay, start), {}, recording.topic(overlay)
    image = image_topic(recording)
    if not image or not recording.has(image):
        raise FilmError("no pictures")
    if not recording.has("dynamic/mask"):
        return image, window(recording, image, start), {}, f"{recording.topic(image)}, without masks"
    both = {stamp for stamp, _ in recording.stamps(image)}
    stamps = np.array([stamp for stamp in window(recording, "dynamic/mask", start) if stamp in both])
    if len(stamps) < 2:
        raise FilmError(f"no image on {recording.topic(image)} has the stamp of a mask on "
                        f"{recording.topic('dynamic/mask')}")
    return image, stamps, read_masks(recording, stamps), (
        f"{recording.topic(image)} and {recording.topic('dynamic/mask')}")


def encode(raw, size, rate, folder):
    """(kind, bytes) of the first encoder that this ffmpeg has."""
    for kind, ending, options in ENCODERS:
        path = os.path.join(folder, "film." + ending)
        done = subprocess.run(
            ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r",
             f"{rate:.4f}", "-i", raw, "-an", "-pix_fmt", "yuv420p", *options, path], stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if done.returncode == 0:
            with open(path, "rb") as file:
                return kind, file.read()
    raise FilmError("ffmpeg: " + (done.stderr.decode(errors="replace").strip().splitlines() or ["failed"])[-1])


def strip(frames):
    """(JPEG, size) of a few frames, three abreast where they are no pairs."""
    width, height = frames[0].size
    columns = min(len(frames), 3 if width <= WIDEST else 1)
    sheet = Picture.new("RGB", (width * columns, height * -(-len(frames) // columns)), "white")
    for i, frame in enumerate(frames):
        sheet.paste(frame, (i % columns * width, i // columns * height))
    stream = io.BytesIO()
    sheet.save(stream, "JPEG", quality=80)
    return stream.getvalue(), sheet.size


def make(recording, truth=None, start=0.0):
    name, stamps, masks, source = source_of(recording, start)
    length = stamps[-1] - stamps[0]
    image = image_topic(recording)
    images = {stamp for stamp, _ in recording.stamps(image)} if image and truth else ()
    annotated = [stamp for stamp in stamps if stamp in images and truth.has(stamp)]

    def frames(wanted):
        found = frames_of(recording, name, wanted, masks)
        return beside_truth(found, recording, image, annotated, truth) if annotated else found

    all_stamps = [stamp for stamp, _ in recording.stamps(name)]
    facts = (source, len(stamps), length, len(annotated))
    whole = max(all_stamps) - min(all_stamps)
    note = "ffmpeg is not installed"
    if shutil.which("ffmpeg"):
        with tempfile.TemporaryDirectory() as folder:
            raw = os.path.join(folder, "film.rgb")
            with open(raw, "wb") as file:
                for _, frame in frames(stamps):
                    size = frame.size
                    file.write(frame.tobytes())
            try:
                kind, content = encode(raw, size, (len(stamps) - 1) / length, folder)
                return Film(data_uri(kind, content), kind, *facts, size, whole)
            except FilmError as error:
                note = str(error)
    chosen = stamps[np.unique(np.linspace(0, len(stamps) - 1, STRIP).astype(int))]
    content, size = strip([frame for _, frame in frames(chosen)])
    return Film(data_uri("image/jpeg", content), "", *facts, size, whole, note)


def six_panels(recording, fractions):
    """(data URI, stamp) of the panels at the image where most moves; None without panels."""
    name = next((name for name in ("overlay/six_panel/compressed", "overlay/six_panel") if recording.has(name)), None)
    stamps = [stamp for stamp, _ in recording.stamps(name)] if name else []
    if not stamps:
        return None
    wanted = max(stamps, key=lambda stamp: fractions.get(stamp, -1.0))
    message = next(one for one in recording.messages(name) if seconds(one.header.stamp) == wanted)
    picture = (Picture.open(io.BytesIO(message.data)) if not hasattr(message, "encoding")
               else picture_of(message)).convert("RGB")
    picture.thumbnail((WIDEST_PANELS, WIDEST_PANELS))
    stream = io.BytesIO()
    picture.save(stream, "JPEG", quality=88)
    return data_uri("image/jpeg", stream.getvalue()), wanted
