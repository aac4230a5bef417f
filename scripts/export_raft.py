#!/usr/bin/python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a TorchScript file of RAFT, the optical flow network, for the flow of this package.

    export_raft.py --model small --weights raft-small.pth --output raft_small.pt
    export_raft.py --model large --weights torchvision --output raft_large.pt

Weights: `torchvision` downloads torchvision's own; a file is a state dict with torchvision's names or with
those of the authors (princeton-vl/RAFT). The output takes two images, float32 (1, 3, height, width), RGB
0..255, sides multiples of 8 and 128 or more, and returns the flow from the first to the second, float32
(1, 2, height, width), px: right, down. It is written only when its flow equals torchvision's. Needs
python3-torch and python3-torchvision (apt).
"""
import argparse
import copy
import pathlib
import re
import sys
from typing import List, Tuple

try:
    import torch
    import torchvision.models.optical_flow as optical_flow
    from torch import Tensor, nn
    from torch.nn import functional
    from torch.nn.utils.fusion import fuse_conv_bn_eval
    from torchvision.models.optical_flow._utils import upsample_flow
    from torchscript_export import (ExportError, fill, median_milliseconds, one_line, read_state_dict,
                                    save_verified, size_argument)
except ImportError as missing:
    sys.exit(f"export_raft: {missing}; install python3-torch and python3-torchvision (apt)")

LARGEST_DIFFERENCE = 1e-3  # px, from torchvision's flow
MOTION = (6, -3)  # px right and down, of the images made for the verification

# From the authors' names to torchvision's, first match only; those of the encoders then need ENCODER_NAMES.
NAMES = ((r"^update_block\.encoder\.convc(\d)\.", r"update_block.motion_encoder.convcorr\1.0."),
         (r"^update_block\.encoder\.convf(\d)\.", r"update_block.motion_encoder.convflow\1.0."),
         (r"^update_block\.encoder\.conv\.", "update_block.motion_encoder.conv.0."),
         (r"^update_block\.gru\.conv([zrq])(\d)\.", r"update_block.recurrent_block.convgru\2.conv\1."),
         (r"^update_block\.gru\.conv([zrq])\.", r"update_block.recurrent_block.convgru1.conv\1."),
         (r"^update_block\.mask\.0\.", "mask_predictor.convrelu.0."),
         (r"^update_block\.mask\.2\.", "mask_predictor.conv."),
         (r"^fnet\.", "feature_encoder."),
         (r"^cnet\.", "context_encoder."))
ENCODER_NAMES = ((r"_encoder\.conv1\.", "_encoder.convnormrelu.0."),
                 (r"_encoder\.norm1\.", "_encoder.convnormrelu.1."),
                 (r"_encoder\.conv2\.", "_encoder.conv."),
                 (r"(layer\d\.\d)\.conv(\d)\.", r"\1.convnormrelu\2.0."),
                 (r"(layer\d\.\d)\.norm([12])\.", r"\1.convnormrelu\2.1."),
                 # The authors' residual block holds this norm twice: by its own name and inside downsample.
                 (r"(layer\d\.\d)\.norm3\.", r"\1.downsample.1."))


def renamed(name, names):
    for pattern, replacement in names:
        name, count = re.subn(pattern, replacement, name)
        if count:
            return name
    return name


def torchvision_name(name):
    """torchvision's name of a weight of the authors' RAFT, small or large."""
    name = renamed(name, NAMES)
    in_encoder = name.startswith(("feature_encoder.", "context_encoder."))
    return renamed(name, ENCODER_NAMES) if in_encoder else name


def torchvision_state(state, own_names, path):
    """The state dict under torchvision's names, whichever of the two it came with."""
    named = {}
    for name, tensor in state.items():
        target = name if name in own_names else torchvision_name(name)
        if target in named and not torch.equal(named[target], tensor):
            raise ExportError(f"{path}: {name} and another weight, both for {target}, differ; "
                              "the file is damaged or not RAFT's")
        named[target] = tensor
    return named


class InstanceNorm(nn.Module):
    """As nn.InstanceNorm2d, in place and without leaving the channels-last layout, where that is slow."""

    def __init__(self, eps: float):
        super().__init__()
        self.eps = eps

    def forward(self, x: Tensor) -> Tensor:
        x.sub_(x.mean(dim=[2, 3], keepdim=True))
        squares = torch.zeros([x.shape[0], x.shape[1], 1, 1], dtype=x.dtype, device=x.device)
        for rows in x.split(32, 2):  # the squares of the whole image would be one more large allocation
            squares += (rows * rows).sum(dim=[2, 3], keepdim=True)
        return x.mul_(torch.rsqrt(squares / (x.shape[2] * x.shape[3]) + self.eps))


class ResidualBlock(nn.Module):
    """A residual or bottleneck block of torchvision's RAFT, with the sum in place."""

    def __init__(self, block):
        super().__init__()
        self.convolutions = nn.Sequential(
            *(child for name, child in block.named_children() if name.startswith("convnormrelu")))
        self.downsample = block.downsample

    def forward(self, x: Tensor) -> Tensor:
        return self.convolutions(x).add_(self.downsample(x)).relu_()


def inference_encoder(encoder):
    """torchvision's encoder with faster norms: batch norm goes into the convolution before it."""
    for parent in [module for module in encoder.modules() if isinstance(module, nn.Sequential)]:
        for index, child in enumerate(parent):
            if isinstance(child, nn.InstanceNorm2d):
                parent[index] = InstanceNorm(child.eps)
            elif isinstance(child, nn.BatchNorm2d):
                parent[index - 1] = fuse_conv_bn_eval(parent[index - 1], child)
                parent[index] = nn.Identity()
    layers = (encoder.layer1, encoder.layer2, encoder.layer3)
    blocks = [ResidualBlock(block) for layer in layers for block in layer]
    return nn.Sequential(encoder.convnormrelu, *blocks, encoder.conv)


def convolution(like, weights, biases):
    """One convolution that gives the outputs of several over the same input."""
    weight = torch.cat(weights)
    result = nn.Conv2d(weight.shape[1], weight.shape[0], like.kernel_size, padding=like.padding,
                       bias=bool(biases))
    result.weight = nn.Parameter(weight.detach())
    if biases:
        result.bias = nn.Parameter(torch.cat(biases).detach())
    return result


class ConvGRU(nn.Module):
    """Convolutional gated recurrent unit over [hidden state, context, motion].

    The context stays the same in all iterations, so its share of the convolutions is computed once.
    """

    def __init__(self, gru, context_channels: int):
        super().__init__()
        self.hidden: int = gru.convz.out_channels
        context = slice(self.hidden, self.hidden + context_channels)

        def changing(conv):
            return torch.cat([conv.weight[:, :context.start], conv.weight[:, context.stop:]], 1)

        self.gates = convolution(gru.convz, [changing(gru.convz), changing(gru.convr)], [])
        self.candidate = convolution(gru.convz, [changing(gru.convq)], [])
        parts = (gru.convz, gru.convr, gru.convq)
        self.context = convolution(gru.convz, [conv.weight[:, context] for conv in parts],
                                   [conv.bias for conv in parts])

    def forward(self, hidden: Tensor, motion: List[Tensor], gates_context: Tensor,
                candidate_context: Tensor) -> Tensor:
        gates = self.gates(torch.cat([hidden] + motion, 1)).add_(gates_context).sigmoid_()
        update, reset = torch.split(gates, [self.hidden, self.hidden], 1)
        candidate = self.candidate(torch.cat([reset * hidden] + motion, 1)).add_(candidate_context).tanh_()
        return hidden + update * (candidate - hidden)


class CorrelationPyramid(nn.Module):
    """Correlation of every cell of one feature map with every cell of the other, at several resolutions."""

    def __init__(self, block):
        super().__init__()
        self.levels: int = block.num_levels
        self.side: int = 2 * block.radius + 1
        offsets = torch.linspace(-block.radius, block.radius, self.side)
        # As torchvision orders them: the horizontal offset changes slowest.
        window = torch.stack(torch.meshgrid(offsets, offsets, indexing="ij")).view(2, 1, -1)
        self.register_buffer("window", window)

    def forward(self, features1: Tensor, features2: Tensor) -> List[Tensor]:
        features1 = features1 / features1.shape[1] ** 0.5
        pyramid: List[Tensor] = []
        for level in range(self.levels):
            if level > 0:  # the mean of correlations is the correlation with the mean
                features2 = functional.avg_pool2d(features2, 2, 2)
            pyramid.append(self.correlate(features1, features2))
        return pyramid

    def correlate(self, features1: Tensor, features2: Tensor) -> Tensor:
        """(cells of the first, 1, height, width of the second).

        A convolution with the second's cells as kernels gives that in the channels-last layout, and is faster
        than the matrix product of most BLAS libraries.
        """
        kernels = features2.permute(0, 2, 3, 1).reshape(-1, features2.shape[1], 1, 1)
        volume = functional.conv2d(features1, kernels).permute(0, 2, 3, 1)
        return volume.reshape(-1, 1, features2.shape[2], features2.shape[3])

    @torch.jit.export
    def lookup(self, pyramid: List[Tensor], coordinates: Tensor) -> Tensor:
        """Windows around coordinates (2, height, width), in channels-last layout."""
        height, width = coordinates.shape[1], coordinates.shape[2]
        centres = coordinates.reshape(2, -1, 1)
        windows: List[Tensor] = []
        for level, volume in enumerate(pyramid):
            grid = torch.empty([2, height * width, self.side * self.side], dtype=volume.dtype,
                               device=volume.device)
            for axis in range(2):  # to the -1..1 of grid_sample
                scale = 2.0 / (volume.shape[3 - axis] - 1)
                torch.add(self.window[axis] * scale - 1.0, centres[axis], alpha=scale / 2.0 ** level,
                          out=grid[axis])
            sampled = functional.grid_sample(
                volume, grid.permute(1, 2, 0).view(-1, self.side, self.side, 2), mode="bilinear",
                padding_mode="zeros", align_corners=True)
            windows.append(sampled.view(1, height, width, -1))
        return torch.cat(windows, 3).permute(0, 3, 1, 2)


class RaftInference(nn.Module):
    """torchvision's RAFT for inference: the same flow, in less time.

    Only the last flow is brought to full size; convolutions run in the channels-last layout.
    """

    def __init__(self, raft, iterations: int):
        super().__init__()
        raft = copy.deepcopy(raft)
        update = raft.update_block
        gru = update.recurrent_block
        self.iterations = iterations
        self.hidden: int = update.hidden_state_size
        self.context_channels: int = raft.context_encoder.output_dim - self.hidden
        self.feature_encoder = inference_encoder(raft.feature_encoder)
        self.context_encoder = inference_encoder(raft.context_encoder)
        self.correlation = CorrelationPyramid(raft.corr_block)
        self.motion = update.motion_encoder
        self.units = nn.ModuleList(
            [ConvGRU(unit, self.context_channels) for unit in gru.children()])  # one in small, two in large
        self.flow_head = update.flow_head
        self.mask_predictor = raft.mask_predictor
        self.requires_grad_(False)
        self.to(memory_format=torch.channels_last)

    def prepare(self, image: Tensor) -> Tensor:
        return (image * (2.0 / 255.0)).sub_(1.0).contiguous(memory_format=torch.channels_last)

    def context_shares(self, context: Tensor) -> List[Tuple[Tensor, Tensor]]:
        shares: List[Tuple[Tensor, Tensor]] = []
        for unit in self.units:
            gates, candidate = torch.split(unit.context(context), [2 * self.hidden, self.hidden], 1)
            shares.append((gates.contiguous(memory_format=torch.channels_last),
                           candidate.contiguous(memory_format=torch.channels_last)))
        return shares

    def motion_features(self, flow: Tensor, correlation: Tensor) -> List[Tensor]:
        flow = flow.contiguous(memory_format=torch.channels_last)
        correlation = self.motion.convcorr2(self.motion.convcorr1(correlation))
        flow_features = self.motion.convflow2(self.motion.convflow1(flow))
        return [self.motion.conv(torch.cat([correlation, flow_features], 1)), flow]

    def next_hidden(self, hidden: Tensor, motion: List[Tensor],
                    shares: List[Tuple[Tensor, Tensor]]) -> Tensor:
        for index, unit in enumerate(self.units):
            hidden = unit(hidden, motion, shares[index][0], shares[index][1])
        return hidden

    def forward(self, image1: Tensor, image2: Tensor) -> Tensor:
        if (image1.shape != image2.shape or image1.dim() != 4 or image1.shape[0] != 1 or image1.shape[1] != 3
                or image1.shape[2] % 8 != 0 or image1.shape[3] % 8 != 0 or min(image1.shape[2:]) < 128):
            raise ValueError("two images (1, 3, height, width) are needed, sides multiples of 8, 128 or more")
        first = self.prepare(image1)
        features = self.feature_encoder(first)
        pyramid = self.correlation(features, self.feature_encoder(self.prepare(image2)))
        hidden, context = torch.split(self.context_encoder(first),
                                      [self.hidden, self.context_channels], 1)
        hidden = torch.tanh(hidden)
        shares = self.context_shares(torch.relu(context))
        height, width = features.shape[2], features.shape[3]
        rows = torch.arange(height, dtype=features.dtype, device=features.device).view(-1, 1)
        columns = torch.arange(width, dtype=features.dtype, device=features.device)
        cells = torch.stack([columns.expand(height, width), rows.expand(height, width)])
        flow = torch.zeros_like(cells)[None]
        for _ in range(self.iterations):
            motion = self.motion_features(flow, self.correlation.lookup(pyramid, cells + flow[0]))
            hidden = self.next_hidden(hidden, motion, shares)
            flow = flow + self.flow_head(hidden).contiguous()
        if self.mask_predictor is None:
            return upsample_flow(flow)
        return upsample_flow(flow, self.mask_predictor(hidden).contiguous())


def textured_pair(size):
    """Two images RGB 0..255 whose whole content moves by MOTION."""
    width, height = size
    margin = 16
    generator = torch.Generator().manual_seed(1)
    canvas = torch.zeros(1, 3, height + 2 * margin, width + 2 * margin)
    for cell in (4, 16, 64):  # coarse and fine texture
        cells = [side // cell + 2 for side in canvas.shape[2:]]
        noise = torch.rand(1, 3, *cells, generator=generator)
        canvas += functional.interpolate(noise, size=list(canvas.shape[2:]), mode="bicubic",
                                         align_corners=False)
    canvas = (canvas / 3.0).clamp(0.0, 1.0) * 255.0

    def cut(right, down):
        top, left = margin - down, margin - right
        return canvas[:, :, top:top + height, left:left + width].contiguous()

    return cut(0, 0), cut(*MOTION)


def verify(raft, module, iterations, size):
    """Compares the module with torchvision's network; returns what there is to say about it."""
    images = textured_pair(size)
    with torch.inference_mode():
        expected = raft(*(image / 127.5 - 1.0 for image in images), num_flow_updates=iterations)[-1]
        flow = module(*images)
        if flow.shape != expected.shape:
            raise ExportError(f"the exported flow has shape {tuple(flow.shape)}, "
                              f"not {tuple(expected.shape)}; nothing was written")
        difference = (flow - expected).abs().max().item()
        if not difference <= LARGEST_DIFFERENCE:  # so that NaN is refused
            raise ExportError(f"the exported flow differs by {difference:.2g} px from torchvision's, more "
                              f"than {LARGEST_DIFFERENCE} px; nothing was written")
        duration = median_milliseconds(lambda: module(*images))
    error = (flow - torch.tensor(MOTION, dtype=flow.dtype).view(1, 2, 1, 1)).norm(dim=1).mean().item()
    return (f"largest difference from torchvision's flow: {difference:.2g} px\n"
            f"mean end-point error on a texture moved by {MOTION}: {error:.2f} px\n"
            f"{duration:.0f} ms per pair of {size[0]}x{size[1]}, CPU threads: {torch.get_num_threads()}")


def load_raft(model, weights):
    """torchvision's network with its weights, and a line about them."""
    make, kinds = {"small": (optical_flow.raft_small, optical_flow.Raft_Small_Weights),
                   "large": (optical_flow.raft_large, optical_flow.Raft_Large_Weights)}[model]
    if weights == "torchvision":
        kind = kinds.DEFAULT
        try:
            raft = make(weights=kind, progress=False)
        except (OSError, RuntimeError) as error:
            raise ExportError(f"torchvision's weights cannot be downloaded ({one_line(error)}); fetch "
                              f"{kind.url} elsewhere and give that file as --weights") from None
        return raft.eval(), f"torchvision's {kind}: all {len(raft.state_dict())} weights used"
    raft = make(weights=None)
    state = torchvision_state(read_state_dict(weights), set(raft.state_dict()), weights)
    count = fill(raft, state, weights)
    return raft.eval(), f"{weights}: all {count} weights used"


def export(raft, iterations, size, output):
    """Writes the TorchScript file; returns what the verification says."""
    module = torch.jit.script(RaftInference(raft, iterations).eval())
    report = []
    save_verified(module, output, lambda loaded: report.append(verify(raft, loaded, iterations, size)))
    return report[0]


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", choices=("small", "large"), default="small")
    parser.add_argument("--weights", required=True, help="'torchvision', or the file of a state dict")
    parser.add_argument("--iterations", type=int, default=8, help="flow updates inside the file (default: 8)")
    parser.add_argument("--size", type=size_argument(128, 8), default=(640, 360),
                        help="of the verification's images (default: 640x360); the output takes any")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args(argv)
    if arguments.iterations < 1:
        parser.error("--iterations must be 1 or more")
    try:
        raft, weights = load_raft(arguments.model, arguments.weights)
        report = export(raft, arguments.iterations, arguments.size, arguments.output)
    except ExportError as error:
        sys.exit(f"export_raft: {error}")
    print(f"{weights}\n{report}")
    print(f"{arguments.output}: RAFT {arguments.model}, {arguments.iterations} iterations; "
          f"made by PyTorch {torch.__version__}, loads in libtorch of this version or newer")


if __name__ == "__main__":
    main()
