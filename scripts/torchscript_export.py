# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""What export_raft.py and export_justdepth.py share: state dicts in, verified TorchScript files out."""
import argparse
import re
import statistics
import time

import torch

# Where training code puts the weights when it saves more than them.
NESTED_UNDER = ("state_dict", "model_state_dict", "model", "network", "net")


class ExportError(Exception):
    """Says in one line what is wrong with which file and how to correct it."""


def one_line(error):
    """The first line of an error's text; PyTorch adds whole stack traces."""
    return (str(error).strip() or type(error).__name__).splitlines()[0]


def is_state_dict(value):
    return isinstance(value, dict) and bool(value) and all(
        isinstance(key, str) and isinstance(tensor, torch.Tensor) for key, tensor in value.items())


def read_state_dict(path, trusted=False, advice=""):
    """Weights by name, on the CPU, without the `module.` that parallel training puts before every name.

    A checkpoint is a pickle, which could run any code: unless trusted, nothing but plain values is read.
    """
    try:
        content = torch.load(path, map_location="cpu", weights_only=not trusted)
    except OSError as error:
        raise ExportError(f"{path}: {error.strerror or error}") from None
    except Exception as error:  # torch raises many kinds for a file that is not its own
        reason = one_line(error).split("WeightsUnpickler error: ")[-1]
        raise ExportError(f"{path}: cannot be read as a state dict ({reason}); "
                          f"it must be a file of torch.save(network.state_dict(), ...){advice}") from None
    if isinstance(content, dict) and not is_state_dict(content):
        content = next((content[key] for key in NESTED_UNDER if is_state_dict(content.get(key))), content)
    if not is_state_dict(content):
        raise ExportError(f"{path}: holds no state dict (tensors by name), neither at the top nor under "
                          f"{', '.join(NESTED_UNDER)}; save network.state_dict()")
    return {re.sub(r"^module\.", "", name): tensor for name, tensor in content.items()}


def some(names):
    names = sorted(names)
    return ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")


def fill(network, state, path):
    """Puts every tensor of the state dict into the network and leaves none of the network's unfilled."""
    own = network.state_dict()
    complaints = []
    if missing := set(own) - set(state):
        complaints.append(f"missing: {some(missing)}")
    if unused := set(state) - set(own):
        complaints.append(f"not used: {some(unused)}")
    if other := {name for name in set(own) & set(state) if own[name].shape != state[name].shape}:
        complaints.append("of another shape: " + some(
            f"{name} {tuple(state[name].shape)}, not {tuple(own[name].shape)}" for name in other))
    if complaints:
        raise ExportError(f"{path}: are not this network's weights; {'; '.join(complaints)}")
    network.load_state_dict(state)
    return len(own)


def save_verified(module, output, verify):
    """Writes the module, lets verify(module read back) raise, and only then gives the file its name."""
    unfinished = output.with_name(output.name + ".part")
    try:
        try:
            module.save(str(unfinished))
        except (RuntimeError, OSError) as error:
            raise ExportError(f"{output}: cannot be written ({one_line(error)})") from None
        verify(torch.jit.load(str(unfinished)))
        unfinished.replace(output)
    finally:
        unfinished.unlink(missing_ok=True)


def median_milliseconds(call, runs=5, warm_up=3):
    """TorchScript optimises itself during its first calls, so those do not count."""
    durations = []
    for _ in range(warm_up + runs):
        start = time.perf_counter()
        call()
        durations.append(time.perf_counter() - start)
    return 1e3 * statistics.median(durations[warm_up:])


def size_argument(smallest, multiple):
    """Parser of WIDTHxHEIGHT arguments."""
    def parse(text):
        match = re.fullmatch(r"(\d+)x(\d+)", text)
        size = tuple(int(part) for part in match.groups()) if match else (0, 0)
        if min(size) < smallest or any(side % multiple for side in size):
            raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT with sides of {smallest} or more"
                                             + (f", multiples of {multiple}" if multiple > 1 else ""))
        return size
    return parse
