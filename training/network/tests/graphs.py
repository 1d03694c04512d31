"""Graphs of a network of integers that an inference library runs."""

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from vesalius_network.quantise import CHANNELS, ZERO

WEIGHT_ZERO = 128  # of the graph's unsigned weights


class _Graph:
    """Nodes and constants, and the names and sizes of the pictures: 0 the channels, n what convolution n - 1 makes."""

    def __init__(self):
        self.nodes, self.constants = [], []
        self.pictures, self.halvings = ["channels"], [0]

    def constant(self, value):
        self.constants.append(numpy_helper.from_array(np.asarray(value), f"constant{len(self.constants)}"))
        return self.constants[-1].name

    def node(self, kind, *inputs, **attributes):
        """Inputs are names or constants."""
        names = [i if isinstance(i, str) else self.constant(i) for i in inputs]
        out = f"{kind}{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, names, [out], out, **attributes))
        return out

    def add_picture(self, name, halvings):
        self.pictures.append(name)
        self.halvings.append(halvings)

    def enlarged(self, picture, halvings):
        if self.halvings[picture] == halvings:
            return self.pictures[picture]
        how = {"mode": "nearest", "coordinate_transformation_mode": "asymmetric", "nearest_mode": "floor"}
        return self.node("Resize", self.pictures[picture], "", np.float32([1, 1, 2, 2]), **how)

    def model(self, kind, answers):
        """Returns the model that says these pictures."""
        shape = ["n", CHANNELS, "height", "width"]
        inputs = [helper.make_tensor_value_info("channels", kind, shape)]
        outputs = [helper.make_empty_tensor_value_info(self.pictures[answer]) for answer in answers]
        graph = helper.make_graph(self.nodes, "network", inputs, outputs, self.constants)
        opset = [helper.make_opsetid("", 17)]
        return helper.make_model(graph, opset_imports=opset, ir_version=8)


def _of_channels(values):
    return np.asarray(values, np.float32)[:, None, None]


def _form(layer):
    side = layer.weights.shape[-1]
    return {"strides": [layer.stride] * 2, "pads": [side // 2] * 4}


def exact_graph(convolutions, answers):
    """Returns a model of the arithmetic of network.h: bytes in, whole numbers out. Weights are unsigned in it, since with
    signed ones the library's sums of two products stop at 16 bits on processors without VNNI."""
    graph = _Graph()
    for layer in convolutions:
        source, form = graph.pictures[layer.input], _form(layer)
        if layer.input == 0:
            around = np.int64([0, 0, *form["pads"][:2], 0, 0, *form["pads"][2:]])
            source, form["pads"] = graph.node("Pad", source, around, np.uint8(ZERO)), [0] * 4
        weights = (layer.weights.astype(np.int16) + WEIGHT_ZERO).astype(np.uint8)
        sums = graph.node("ConvInteger", source, weights, np.uint8(0), np.uint8(WEIGHT_ZERO), **form)
        y = graph.node("Mul", graph.node("Cast", sums, to=TensorProto.FLOAT), _of_channels(layer.scale))
        y = graph.node("Add", y, _of_channels(layer.offset))
        halvings = graph.halvings[layer.input] + layer.stride - 1
        if layer.added:
            added = graph.node("Cast", graph.enlarged(layer.added, halvings), to=TensorProto.FLOAT)
            y = graph.node("Add", y, graph.node("Mul", added, np.float32(layer.added_scale)))
        low, high = (-32768, 32767) if layer.wide else (0, 255)
        y = graph.node("Clip", graph.node("Round", y), np.float32(low), np.float32(high))
        graph.add_picture(y if layer.wide else graph.node("Cast", y, to=TensorProto.UINT8), halvings)
    return graph.model(TensorProto.UINT8, answers)


def real_graph(convolutions, answers):
    """Returns a model of the same in real numbers, nothing rounded. It reads channels less ZERO. Results have units in
    which what is added needs no scale."""
    graph, units = _Graph(), [1.0]
    for layer in convolutions:
        units.append(units[layer.added] / layer.added_scale if layer.added else 1.0)
        weights = layer.weights * layer.scale[:, None, None, None]
        offset = layer.offset if layer.input else layer.offset + ZERO * weights.sum((1, 2, 3))
        weights, offset = weights * (units[-1] / units[layer.input]), offset * units[-1]
        y = graph.node("Conv", graph.pictures[layer.input], np.float32(weights), np.float32(offset), **_form(layer))
        halvings = graph.halvings[layer.input] + layer.stride - 1
        if layer.added:
            y = graph.node("Add", y, graph.enlarged(layer.added, halvings))
        graph.add_picture(y if layer.wide else graph.node("Relu", y), halvings)
    return graph.model(TensorProto.FLOAT, answers)
