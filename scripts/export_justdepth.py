#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a TorchScript file of a JustDepth network (radar and camera to depth) for the depth of this package.

    export_justdepth.py --checkout JustDepth --checkpoint justdepth.ckpt --output justdepth.pt

This runs the code of the checkout: use only one you trust. The output takes an image, float32
(1, 3, height, width): RGB / 255, less ImageNet's mean, over its standard deviation, of a 1600x900 picture
without its top 4 rows; and the radar, float32 (1, 1, 1, width): per image column the depth in the camera (m)
of the nearest return there, 0 = none. It returns the depth, float32 (1, 1, height, width), m. A network that
takes something else needs a factory of your own, in the checkout, that adapts it. The output is written only
when it gives what the network gives on inputs it was not traced with. Needs python3-torch (apt) and what the
checkout needs.
"""
import argparse
import importlib
import json
import pathlib
import sys
import warnings

try:
    import torch
    from torch import nn
    from torchscript_export import (ExportError, fill, median_milliseconds, one_line, read_state_dict,
                                    save_verified, size_argument)
except ImportError as missing:
    sys.exit(f"export_justdepth: {missing}; install python3-torch (apt)")

LARGEST_DIFFERENCE = 1e-3  # m, plus 1e-4 of the depth


class DepthNetwork(nn.Module):
    """The network with nothing but the depth as its output."""

    def __init__(self, network, output_key):
        super().__init__()
        self.network = network
        self.output_key = output_key

    def forward(self, image, radar):
        output = self.network(image, radar)
        if self.output_key:
            if not isinstance(output, dict) or self.output_key not in output:
                raise ExportError(f"the network returns no dict with the key '{self.output_key}'; "
                                  "see --output-key")
            return output[self.output_key]
        return output[0] if isinstance(output, (tuple, list)) and output else output


def load_network(checkout, model, arguments):
    """What FACTORY(**arguments) of the checkout's MODULE makes."""
    module_name, _, factory_name = model.partition(":")
    if not checkout.is_dir():
        raise ExportError(f"{checkout}: is not a folder; --checkout needs that of the network's code")
    sys.path.insert(0, str(checkout))
    try:
        module = importlib.import_module(module_name)
        network = getattr(module, factory_name)(**arguments)
    except (Exception, SystemExit) as error:  # anything, since it is anyone's code
        raise ExportError(f"{checkout}: {model} with {json.dumps(arguments)} failed "
                          f"({type(error).__name__}: {one_line(error)}); see --model and --arguments, and "
                          "install what the checkout needs") from None
    if not isinstance(network, nn.Module):
        raise ExportError(f"{checkout}: {model} made a {type(network).__name__}, not a torch.nn.Module")
    return network


def seeded_inputs(size, seed, share, device, contrast=1.0):
    """An image, and radar returns of 2 to 80 m in that share of the columns."""
    width, height = size
    generator = torch.Generator().manual_seed(seed)
    image = contrast * torch.randn(1, 3, height, width, generator=generator)
    depth = 2.0 + 78.0 * torch.rand(1, 1, 1, width, generator=generator)
    filled = torch.rand(1, 1, 1, width, generator=generator) < share
    return image.to(device), (depth * filled).to(device)


def run(network, inputs, what):
    """The depth for these inputs; refuses anything but a depth for every pixel."""
    try:
        depth = network(*inputs)
    except ExportError:
        raise
    except Exception as error:  # anything, since it is anyone's code
        raise ExportError(f"{what} failed on an image {tuple(inputs[0].shape)} and radar "
                          f"{tuple(inputs[1].shape)} ({type(error).__name__}: {one_line(error)})") from None
    if not isinstance(depth, torch.Tensor):
        raise ExportError(f"{what} returns a {type(depth).__name__}, not a tensor; see --output-key")
    expected = (1, 1, *inputs[0].shape[2:])
    if tuple(depth.shape) != expected or depth.dtype != torch.float32:
        raise ExportError(f"{what} returns {tuple(depth.shape)} {depth.dtype}, not a depth of {expected} "
                          f"{torch.float32}; see --output-key")
    if not torch.isfinite(depth).all():
        raise ExportError(f"{what} returns depths that are not finite")
    return depth


def verify(network, module, size, device):
    """Compares the traced module with the network on inputs it was not traced with; returns a report."""
    largest = 0.0
    cases = {"other values": (2, 0.2, 1.0), "no radar return": (3, 0.0, 1.0),
             "a return in every column": (4, 1.0, 1.0), "a grey image": (5, 0.2, 0.0)}
    with torch.no_grad():
        for case, (seed, share, contrast) in cases.items():
            inputs = seeded_inputs(size, seed, share, device, contrast)
            expected = run(network, inputs, "the network")
            depth = run(module, inputs, "the traced network")
            largest = max(largest, (depth - expected).abs().max().item())
            if not torch.allclose(depth, expected, rtol=1e-4, atol=LARGEST_DIFFERENCE):
                raise ExportError(f"the traced network differs from the network by {largest:.2g} m on inputs "
                                  f"it was not traced with ({case}): its steps depend on the data, or on "
                                  "chance; nothing was written")
        duration = median_milliseconds(lambda: module(*inputs), runs=3, warm_up=2)
    return (f"largest difference from the network on {len(cases)} inputs it was not traced with: "
            f"{largest:.2g} m\n"
            f"{duration:.0f} ms per image of {size[0]}x{size[1]} on {device}, "
            f"CPU threads: {torch.get_num_threads()}")


def export(network, size, device, output):
    """Writes the TorchScript file; returns what there is to say about it."""
    try:
        device = torch.device(device)
        network.to(device)
    except Exception as error:  # PyTorch raises many kinds for a device that is not there
        raise ExportError(f"--device {device}: {one_line(error)}") from None
    inputs = seeded_inputs(size, 1, 0.2, device)
    with torch.no_grad(), warnings.catch_warnings(record=True) as cautions:
        warnings.simplefilter("always")
        run(network, inputs, "the network")
        try:
            module = torch.jit.trace(network, inputs, check_trace=False)
        except Exception as error:  # PyTorch raises many kinds for what it cannot trace
            raise ExportError(f"the network cannot be traced ({one_line(error)})") from None
    steps = [f"{pathlib.Path(caution.filename).name}:{caution.lineno}" for caution in cautions
             if issubclass(caution.category, torch.jit.TracerWarning)]
    # Most of these are harmless, such as a check of a shape; the comparison tells.
    report = [f"steps that might depend on the data: {len(steps)}, the first at {steps[0]}"] if steps else []
    save_verified(module, output, lambda loaded: report.append(verify(network, loaded, size, device)))
    if f'value="{device}' in str(module.inlined_graph):
        report.append(f"the network makes tensors of its own: the output runs on {device.type} only")
    return "\n".join(report)


def arguments_object(text):
    try:
        value = json.loads(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}' is not JSON: {error}") from None
    if not isinstance(value, dict):
        raise argparse.ArgumentTypeError(f"'{text}' is not a JSON object, say {{\"channels\": 64}}")
    return value


def model_argument(text):
    module, _, factory = text.partition(":")
    if not module or not factory:
        raise argparse.ArgumentTypeError(f"'{text}' is not MODULE:FACTORY")
    return text


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--checkout", type=pathlib.Path, required=True, help="folder of the network's code")
    parser.add_argument("--model", type=model_argument, default="model:justdepth",
                        help="MODULE:FACTORY, what in the checkout makes the network (default: %(default)s)")
    parser.add_argument("--arguments", type=arguments_object, default={},
                        help="keyword arguments of the factory, a JSON object")
    parser.add_argument("--checkpoint", type=pathlib.Path, required=True, help="the network's weights")
    parser.add_argument("--trust-checkpoint", action="store_true",
                        help="let the checkpoint run code, for one with more than tensors and numbers in it")
    parser.add_argument("--output-key", help="key of the depth, where the network returns a dict")
    parser.add_argument("--size", type=size_argument(1, 1), default=(1600, 896),
                        help="of the image (default: 1600x896); a traced network may take no other")
    parser.add_argument("--device", default="cpu",
                        help="where the output will run: cpu or cuda (default: cpu)")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    try:
        network = load_network(arguments.checkout, arguments.model, arguments.arguments)
        # Before eval(), which in JustDepth drops the part that only training needs.
        state = read_state_dict(arguments.checkpoint, arguments.trust_checkpoint,
                                "; if you trust it and it holds more: --trust-checkpoint")
        count = fill(network, state, arguments.checkpoint)
        network = DepthNetwork(network.eval(), arguments.output_key).eval()
        report = export(network, arguments.size, arguments.device, arguments.output)
    except ExportError as error:
        sys.exit(f"export_justdepth: {error}")
    print(f"{arguments.checkpoint}: all {count} weights used\n{report}")
    print(f"{arguments.output}: made by PyTorch {torch.__version__}, "
          "loads in libtorch of this version or newer")


if __name__ == "__main__":
    main()
