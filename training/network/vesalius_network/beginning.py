"""What a training begins with: weights, or the network of integers in a model file (docs/formats.md)."""

from pathlib import Path

import numpy as np
import torch
from torch import nn

from .body import read_body
from .errors import InputError
from .model_file import read_network, read_sections
from .nets import CONFIGS, Network
from .quantise import EPSILON, HEAD_UNITS, STEPS, WIDE_STEPS, ZERO, layers_of
from .weights import load

# What 1 of a result stands for where nothing tells it. Later layers undo what this changes.
UNIT = 1 / STEPS
# Kernels before a normalisation grow to about this while they learn, which makes the same rate a smaller step.
GROWN = 0.13
WEIGHTS = ".npz"  # ending of their names; all else is a model


def _alike(layer, convolution):
    outputs, inputs, side, _ = layer.weight.shape
    inputs = convolution.weights.shape[1] if layer.source < 0 else inputs
    same_source = (layer.source + 1, layer.stride, layer.wide) == (convolution.input, convolution.stride, convolution.wide)
    return same_source and convolution.weights.shape == (outputs, inputs, side, side)


def _config_of(convolutions, parts, place):
    """Returns the configuration whose network has these convolutions, perhaps without the parts' centres, and its layers."""
    for config in CONFIGS:
        layers, *_ = layers_of(Network(CONFIGS[config], parts).state_dict())
        without = sum(not layer.name.startswith("joints") for layer in layers)
        if len(convolutions) in (without, len(layers)) and all(map(_alike, layers, convolutions)):
            return config, layers[: len(convolutions)]
    raise InputError(f"{place}: expected a network of config {' or '.join(CONFIGS)}")


def _unit_of(i, layers, convolutions, units):
    """Returns what 1 of a layer's result stands for, a number or one for each output."""
    layer = layers[i]
    if layer.wide:
        return HEAD_UNITS.get(layer.name, UNIT / WIDE_STEPS)
    of_another = layer.added is not None and not layers[layer.added].wide
    return units[layer.added] / convolutions[i].added_scale if of_another else UNIT


def _in_numbers(layer, convolution, before, unit):
    """Returns a convolution's weights [outputs, inputs, side, side] and offsets in real numbers, where 1 of what it reads
    stands for `before`."""
    kernel = convolution.weights.astype(np.float64)
    scale, offset = convolution.scale.astype(np.float64), convolution.offset.astype(np.float64)
    if layer.source < 0:
        offset = offset + ZERO * kernel.sum((1, 2, 3)) * scale
        kernel = kernel[:, [0, 2, 3, 4]]  # of nearness in coarse steps, and the rest: the inputs of quantise._of_channels
    return kernel * (scale * unit / before)[:, None, None, None], offset * unit


def state_of(convolutions, parts, place):
    """Returns the configuration of a network of integers, and parameters of nets.Network that say nearly the same: those of
    the parts' centres only if it has them. Normalisations change nothing (see `settle`)."""
    config, layers = _config_of(convolutions, parts, place)
    units, state = [], {}
    for i, (layer, convolution) in enumerate(zip(layers, convolutions)):
        unit = _unit_of(i, layers, convolutions, units)
        units.append(unit)
        weight, bias = _in_numbers(layer, convolution, UNIT if layer.source < 0 else units[layer.source], unit)
        weight, bias = torch.from_numpy(weight).float(), torch.from_numpy(bias).float()
        shared = layer.added is not None and layers[layer.added].wide  # the normalisation, with what is added
        grown = GROWN / float(weight.square().mean().sqrt()) if layer.normalisation and not shared else 1.0
        state[f"{layer.name}.weight"] = weight * grown
        if norm := layer.normalisation:
            none = torch.zeros_like(bias)
            state |= {f"{norm}.weight": none + 1 / grown, f"{norm}.bias": none if shared else bias}
            state |= {f"{norm}.running_mean": none, f"{norm}.running_var": none + 1 - EPSILON}
        if shared or layer.name in HEAD_UNITS:
            state[f"{layer.name}.bias"] = bias
    return config, state


@torch.no_grad()
def settle(network, inputs):
    """Gives the normalisations the statistics of what the network makes of the inputs [n, 4, h, w], and changes their
    weights so that it says the same. Training takes away each batch's own statistics, so it has to know them."""
    statistics, hooks = {}, []

    def measure(norm, arguments):
        x = arguments[0]
        statistics[norm] = x.mean((0, 2, 3)), x.var((0, 2, 3), unbiased=False)

    for module in network.modules():
        if isinstance(module, nn.BatchNorm2d):
            hooks.append(module.register_forward_pre_hook(measure))
    network.eval()(inputs)
    for hook in hooks:
        hook.remove()
    for norm, (mean, var) in statistics.items():
        scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
        norm.bias += scale * (mean - norm.running_mean)
        norm.weight.copy_(scale * torch.sqrt(var + norm.eps))
        norm.running_mean.copy_(mean)
        norm.running_var.copy_(var)


def _read_model(path):
    """Returns what a model file says of its network, as weights.load does, and parameters of it."""
    try:
        sections = read_sections(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    if "network" not in sections:
        raise InputError(f"{path}: expected a model with a network")
    text, (made_from, content) = sections["body"][1].decode(), sections["network"]
    body = read_body(text, path)
    config, state = state_of(read_network(content, path)[0], body.parts, path)
    return {"config": config, "classes": body.classes, "made_from": made_from, "body": text}, state


def begin_from(network, config, body, path, some_inputs):
    """Takes over the weights of a file, or those of a model's network, for which `some_inputs()` [n, 4, h, w] are looked at.
    The heads of one for another body begin anew, and so do those that it has not. Returns a text about it."""
    path = Path(path)
    of_model = path.suffix != WEIGHTS
    about, state = _read_model(path) if of_model else load(path)
    if about["config"] != config:
        raise InputError(f"{path}: a network of config {about['config']}, expected {config}")
    names = read_body(about["body"], path).names
    same = names == body.names and about["classes"] == body.classes
    anew = () if same else tuple(HEAD_UNITS)
    state = {name: value for name, value in state.items() if not (anew and name.startswith(anew))}
    missing = network.load_state_dict(state, strict=False).missing_keys
    anew += ("joints",) if of_model and "joints.1.weight" not in state else ()
    needed = [name for name in missing if "num_batches" not in name and not (anew and name.startswith(anew))]
    if needed:
        raise InputError(f"{path}: expected the weights {needed[0]}")
    if of_model:
        settle(network, some_inputs())
    return about["made_from"] + ("" if same else "; another body, its heads began anew")
