#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of export_raft.py and export_justdepth.py. Skips without PyTorch and torchvision; the test with
trained weights also without the data folder that RADAR_DOT_SHARED names (default: shared, beside the
checkout).
"""
import contextlib
import io
import os
import pathlib
import sys
import tempfile
import textwrap
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SHARED = pathlib.Path(os.environ.get("RADAR_DOT_SHARED", HERE.parents[2] / "shared"))
TRAINED_SMALL = SHARED / "models" / "raft_small" / "raft-small-kitti.pth"
sys.path.insert(0, str(HERE.parents[1] / "scripts"))
try:
    import torch
    from torchvision.models.optical_flow import raft_small
except ImportError as error:
    missing = f"{error}; these tests need python3-torch and python3-torchvision"
else:
    missing = ""
    import export_justdepth
    import export_raft
    import torchscript_export

NETWORKS = '''
    import torch
    from torch import nn


    class Network(nn.Module):
        def __init__(self, channels=4, kind="tuple"):
            super().__init__()
            self.kind = kind
            self.image = nn.Conv2d(3, channels, 3, padding=1)
            self.radar = nn.Conv1d(1, channels, 5, padding=2)
            self.depth = nn.Conv2d(channels, 1, 3, padding=1)
            self.confidence = nn.Conv2d(channels, 1, 1)

        def eval(self):
            super().eval()
            self.confidence = nn.Identity()
            return self

        def forward(self, image, radar, get_confidence=True):
            features = torch.relu(self.image(image) + self.radar(radar.squeeze(2)).unsqueeze(2))
            depth = self.depth(features)
            if self.kind == "dict":
                return {"depth": depth}
            if self.kind == "depends on data" and radar.sum() > 0:
                depth = depth + 1.0
            if self.kind == "half size":
                return depth[:, :, ::2]
            if self.kind == "own tensor":
                return depth + torch.ones(1)
            if self.kind == "not finite":
                return depth / 0.0
            return depth, self.confidence(features)


    def no_network():
        return 5
'''


def quietly(function, *arguments):
    """What it printed."""
    with contextlib.redirect_stdout(io.StringIO()) as output:
        function(*arguments)
    return output.getvalue()


class InFolder(unittest.TestCase):
    program = ""

    def setUp(self):
        torch.manual_seed(1)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.output = self.folder / "network.pt"

    def save(self, content):
        path = self.folder / "weights.pth"
        torch.save(content, path)
        return path

    def assert_refuses(self, main, arguments, *words):
        """One line, that holds the words, and no file left behind."""
        with self.assertRaises(SystemExit) as refusal:
            quietly(main, [str(argument) for argument in arguments])
        message = str(refusal.exception)
        self.assertNotIn("\n", message)
        for word in (self.program, *words):
            self.assertIn(str(word), message)
        self.assertEqual(list(self.folder.glob("network.pt*")), [])


def authors_large_state():
    """Names and shapes of the authors' large RAFT, with random values."""
    state = {}

    def convolution(name, outputs, inputs, height, width=None):
        state[name + ".weight"] = 0.02 * torch.randn(outputs, inputs, height, width or height)
        state[name + ".bias"] = 0.1 * torch.randn(outputs)

    def norm(name, channels):
        state.update({f"{name}.weight": torch.rand(channels) + 0.5, f"{name}.bias": torch.randn(channels),
                      f"{name}.running_mean": torch.randn(channels),
                      f"{name}.running_var": torch.rand(channels) + 0.5,
                      f"{name}.num_batches_tracked": torch.tensor(7)})

    for encoder, batch_norm in (("fnet", False), ("cnet", True)):
        convolution(f"{encoder}.conv1", 64, 3, 7)
        convolution(f"{encoder}.conv2", 256, 128, 1)
        if batch_norm:
            norm(f"{encoder}.norm1", 64)
        for layer, (inputs, outputs) in enumerate(((64, 64), (64, 96), (96, 128)), 1):
            for block in (f"{encoder}.layer{layer}.0", f"{encoder}.layer{layer}.1"):
                convolution(f"{block}.conv1", outputs, inputs if block.endswith("0") else outputs, 3)
                convolution(f"{block}.conv2", outputs, outputs, 3)
                for index in (1, 2) if batch_norm else ():
                    norm(f"{block}.norm{index}", outputs)
            if layer > 1:
                block = f"{encoder}.layer{layer}.0"
                convolution(f"{block}.downsample.0", outputs, inputs, 1)
                if batch_norm:  # one norm under two names
                    norm(f"{block}.norm3", outputs)
                    twice = [name for name in state if name.startswith(f"{block}.norm3.")]
                    state.update({name.replace("norm3", "downsample.1"): state[name] for name in twice})
    for name, *shape in (("encoder.convc1", 256, 324, 1), ("encoder.convc2", 192, 256, 3),
                         ("encoder.convf1", 128, 2, 7), ("encoder.convf2", 64, 128, 3),
                         ("encoder.conv", 126, 256, 3), ("flow_head.conv1", 256, 128, 3),
                         ("flow_head.conv2", 2, 256, 3), ("mask.0", 256, 128, 3), ("mask.2", 576, 256, 1)):
        convolution(f"update_block.{name}", *shape)
    for gate in "zrq":
        convolution(f"update_block.gru.conv{gate}1", 128, 384, 1, 5)
        convolution(f"update_block.gru.conv{gate}2", 128, 384, 5, 1)
    return state


def flow_difference(raft, module, size, iterations):
    images = export_raft.textured_pair(size)
    with torch.inference_mode():
        expected = raft(*(image / 127.5 - 1.0 for image in images), num_flow_updates=iterations)[-1]
        return (module(*images) - expected).abs().max().item()


@unittest.skipIf(missing, missing)
class RaftWeights(InFolder):
    program = "export_raft"

    def arguments(self, weights, *others):
        return ["--weights", weights, "--size", "128x128", "--iterations", "1", "--output", self.output,
                *others]

    def test_every_weight_of_the_authors_large_network_finds_its_place(self):
        state = authors_large_state()
        path = self.save({"state_dict": {"module." + name: tensor for name, tensor in state.items()}})
        raft, line = export_raft.load_raft("large", path)
        loaded = raft.state_dict()
        self.assertIn(f"all {len(loaded)} weights used", line)
        for authors, torchvisions in (
                ("cnet.norm1.running_var", "context_encoder.convnormrelu.1.running_var"),
                ("cnet.layer2.0.norm2.bias", "context_encoder.layer2.0.convnormrelu2.1.bias"),
                ("cnet.layer3.0.norm3.weight", "context_encoder.layer3.0.downsample.1.weight"),
                ("fnet.layer3.1.conv1.weight", "feature_encoder.layer3.1.convnormrelu1.0.weight"),
                ("fnet.conv2.weight", "feature_encoder.conv.weight"),
                ("update_block.encoder.convc2.bias", "update_block.motion_encoder.convcorr2.0.bias"),
                ("update_block.gru.convr2.weight", "update_block.recurrent_block.convgru2.convr.weight"),
                ("update_block.gru.convq1.weight", "update_block.recurrent_block.convgru1.convq.weight"),
                ("update_block.flow_head.conv2.weight", "update_block.flow_head.conv2.weight"),
                ("update_block.mask.0.weight", "mask_predictor.convrelu.0.weight"),
                ("update_block.mask.2.bias", "mask_predictor.conv.bias")):
            self.assertTrue(torch.equal(state[authors], loaded[torchvisions]), authors)

    def test_a_norm_that_differs_under_its_two_names_is_refused(self):
        state = authors_large_state()
        state["cnet.layer2.0.norm3.bias"] = state["cnet.layer2.0.norm3.bias"] + 1.0
        path = self.save(state)
        self.assert_refuses(export_raft.main, self.arguments(path, "--model", "large"), path, "differ")

    def test_weights_too_many_too_few_or_of_another_shape_are_refused_by_name(self):
        state = raft_small(weights=None).state_dict()
        path = self.save({**state, "extra.weight": torch.zeros(1)})
        self.assert_refuses(export_raft.main, self.arguments(path), path, "not used: extra.weight")
        del state["feature_encoder.conv.bias"]
        self.assert_refuses(export_raft.main, self.arguments(self.save(state)),
                            "missing: feature_encoder.conv.bias")
        state["feature_encoder.conv.bias"] = torch.zeros(3)
        self.assert_refuses(export_raft.main, self.arguments(self.save(state)),
                            "of another shape: feature_encoder.conv.bias (3,), not (128,)")

    def test_weights_of_the_other_size_are_refused(self):
        path = self.save(raft_small(weights=None).state_dict())
        self.assert_refuses(export_raft.main, self.arguments(path, "--model", "large"),
                            "missing: ", "of another shape: ")

    def test_what_is_no_state_dict_is_refused(self):
        self.assert_refuses(export_raft.main, self.arguments(self.save({"epoch": 3})), "no state dict")
        self.assert_refuses(export_raft.main, self.arguments(self.save(raft_small(weights=None))),
                            "cannot be read")
        text = self.folder / "text.pth"
        text.write_text("weights")
        self.assert_refuses(export_raft.main, self.arguments(text), text, "cannot be read")
        self.assert_refuses(export_raft.main, self.arguments(self.folder / "none.pth"), "No such file")

    def test_an_output_that_cannot_be_written_is_refused(self):
        path = self.save(raft_small(weights=None).state_dict())
        arguments = self.arguments(path)
        arguments[arguments.index(self.output)] = self.folder / "nowhere" / "raft.pt"
        self.assert_refuses(export_raft.main, arguments, "nowhere", "cannot be written")

    @unittest.skipUnless(TRAINED_SMALL.exists(), f"{TRAINED_SMALL} is absent")
    def test_trained_weights_find_the_motion_of_a_texture(self):
        output = quietly(export_raft.main, ["--weights", str(TRAINED_SMALL), "--size", "256x192",
                                            "--iterations", "6", "--output", str(self.output)])
        self.assertIn("all 106 weights used", output)
        module = torch.jit.load(str(self.output))
        with torch.inference_mode():
            flow = module(*export_raft.textured_pair((256, 192)))
        error = (flow - torch.tensor(export_raft.MOTION).view(1, 2, 1, 1)).norm(dim=1).median().item()
        self.assertLess(error, 0.5)


@unittest.skipIf(missing, missing)
class RaftModule(InFolder):
    def exported(self, raft, iterations):
        export_raft.export(raft, iterations, (128, 128), self.output)
        return torch.jit.load(str(self.output))

    def test_small_equals_torchvision_at_any_size(self):
        raft = raft_small(weights=None).eval()
        module = self.exported(raft, 2)
        for size in ((128, 128), (232, 136), (128, 184)):
            self.assertLess(flow_difference(raft, module, size, 2), 1e-3, size)

    def test_large_equals_torchvision(self):
        path = self.save(authors_large_state())
        raft, _ = export_raft.load_raft("large", path)
        module = self.exported(raft, 2)
        self.assertLess(flow_difference(raft, module, (152, 136), 2), 1e-3)

    def test_no_device_is_fixed_in_the_file_and_freezing_keeps_the_flow(self):
        raft = raft_small(weights=None).eval()
        module = self.exported(raft, 1)
        self.assertNotIn('value="cpu"', str(module.inlined_graph))
        self.assertLess(flow_difference(raft, torch.jit.freeze(module.eval()), (136, 128), 1), 1e-3)

    def test_images_the_network_cannot_take_are_refused(self):
        module = self.exported(raft_small(weights=None).eval(), 1)
        for height, width in ((132, 128), (120, 128)):
            image = torch.zeros(1, 3, height, width)
            with self.assertRaisesRegex(Exception, "multiples of 8, 128 or more"):
                module(image, image)

    def test_a_flow_that_differs_is_not_written(self):
        raft = raft_small(weights=None).eval()
        other = raft_small(weights=None).eval()
        module = torch.jit.script(export_raft.RaftInference(other, 1).eval())
        with self.assertRaisesRegex(torchscript_export.ExportError, "differs by .* px"):
            torchscript_export.save_verified(
                module, self.output, lambda loaded: export_raft.verify(raft, loaded, 1, (128, 128)))
        self.assertEqual(list(self.folder.iterdir()), [])


@unittest.skipIf(missing, missing)
class JustDepth(InFolder):
    program = "export_justdepth"

    def setUp(self):
        super().setUp()
        self.checkout = self.folder / "checkout"
        self.checkout.mkdir()
        (self.checkout / "radar_dot_test_networks.py").write_text(textwrap.dedent(NETWORKS))
        self.network = export_justdepth.load_network(self.checkout, "radar_dot_test_networks:Network", {})
        self.path = self.save({"network": self.network.state_dict(), "clock": {"epoch": 3}})

    def arguments(self, kind="tuple", model="radar_dot_test_networks:Network", **others):
        options = {"checkout": self.checkout, "model": model, "arguments": f'{{"kind": "{kind}"}}',
                   "checkpoint": self.path, "size": "64x48", "output": self.output, **others}
        return [str(word) for name, value in options.items()
                for word in ("--" + name.replace("_", "-"), value)]

    def assert_exports(self, arguments):
        output = quietly(export_justdepth.main, arguments)
        inputs = export_justdepth.seeded_inputs((64, 48), 9, 0.2, "cpu")
        with torch.no_grad():
            depth = torch.jit.load(str(self.output))(*inputs)
            expected = self.network(*inputs)[0]
        self.assertEqual(tuple(depth.shape), (1, 1, 48, 64))
        self.assertLess((depth - expected).abs().max().item(), 1e-3)
        return output

    def test_the_depth_alone_is_exported(self):
        output = self.assert_exports(self.arguments())
        self.assertIn("all 8 weights used", output)
        self.assertNotIn("only", output)

    def test_the_depth_of_a_dict_is_exported(self):
        self.assert_exports(self.arguments("dict", output_key="depth"))
        self.output.unlink()
        self.assert_refuses(export_justdepth.main, self.arguments("dict"), "returns a dict", "--output-key")
        self.assert_refuses(export_justdepth.main, self.arguments("dict", output_key="range"), "'range'")

    def test_a_device_fixed_by_the_trace_is_told(self):
        output = quietly(export_justdepth.main, self.arguments("own tensor"))
        self.assertIn("runs on cpu only", output)

    def test_steps_that_depend_on_the_data_are_refused(self):
        self.assert_refuses(export_justdepth.main, self.arguments("depends on data"), "no radar return",
                            "depend on the data")

    def test_another_shape_or_a_depth_that_is_not_finite_is_refused(self):
        self.assert_refuses(export_justdepth.main, self.arguments("half size"), "(1, 1, 24, 64)",
                            "(1, 1, 48, 64)")
        self.assert_refuses(export_justdepth.main, self.arguments("not finite"), "not finite")

    def test_what_makes_no_network_is_refused(self):
        for model, word in (("radar_dot_test_absent:Network", "No module named"),
                            ("radar_dot_test_networks:Absent", "Absent"),
                            ("radar_dot_test_networks:no_network", "unexpected keyword")):
            self.assert_refuses(export_justdepth.main, self.arguments(model=model), self.checkout, word)
        self.assert_refuses(export_justdepth.main, self.arguments(
            model="radar_dot_test_networks:no_network", arguments="{}"), "not a torch.nn.Module")
        self.assert_refuses(export_justdepth.main, self.arguments(checkout=self.folder / "none"),
                            "not a folder")

    def test_other_weights_are_refused(self):
        state = self.network.state_dict()
        del state["radar.bias"]
        self.save(state)
        self.assert_refuses(export_justdepth.main, self.arguments(), self.path, "missing: radar.bias")

    def test_a_checkpoint_with_more_than_tensors_needs_trust(self):
        self.save({"network": self.network.state_dict(), "schedule": pathlib.PurePosixPath("any")})
        self.assert_refuses(export_justdepth.main, self.arguments(), self.path, "--trust-checkpoint")
        self.assert_exports(self.arguments() + ["--trust-checkpoint"])

    def test_a_device_that_is_not_there_is_refused(self):
        self.assert_refuses(export_justdepth.main, self.arguments(device="nothing"), "--device nothing")


if __name__ == "__main__":
    unittest.main()
