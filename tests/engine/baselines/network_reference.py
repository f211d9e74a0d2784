#!/usr/bin/env python3
"""The forward pass of both networks in plain numpy, for the numbers of network_test.cpp.

    python3 tests/engine/baselines/network_reference.py

Parameters and image are formulas; the order of the parameters is that of Network::parameters(): from
the last layer to the first, of each its weights and then its offsets.
"""
import numpy as np


def parameters(count):
    return 0.02 + 0.1 * np.sin(0.37 * np.arange(count)) ** 2


class Reader:
    """Hands out what a layer needs, from the last layer to the first."""

    def __init__(self, sizes):
        values = parameters(sum(sizes))
        ends = np.cumsum(sizes)
        self.parts = [values[e - s:e] for s, e in zip(sizes, ends)]

    def take(self):
        return self.parts.pop()


def conv(x, values, filters, rows, columns, stride=1):
    weights = values[:-filters].reshape(filters, x.shape[0], rows, columns)
    padded = np.pad(x, ((0, 0), (rows // 2,) * 2, (columns // 2,) * 2))
    width = (x.shape[2] + stride - 1) // stride
    out = np.zeros((filters, x.shape[1], width))
    for r in range(x.shape[1]):
        for c in range(width):
            window = padded[:, r:r + rows, c * stride:c * stride + columns]
            out[:, r, c] = np.tensordot(weights, window, 3)
    return out + values[-filters:, None, None]


def depthwise(x, values, stride):
    k = x.shape[0]
    weights = values[:9 * k].reshape(k, 3, 3)
    padded = np.pad(x, ((0, 0), (1, 1), (1, 1)))
    width = (x.shape[2] + stride - 1) // stride
    out = np.zeros((k, x.shape[1], width))
    for r in range(x.shape[1]):
        for c in range(width):
            out[:, r, c] = (weights * padded[:, r:r + 3, c * stride:c * stride + 3]).sum((1, 2))
    return out + values[9 * k:, None, None]


def norm(x, values):
    scale, offset, mean, variance = (part[:, None, None] for part in values.reshape(4, -1))
    return scale * (x - mean) / np.sqrt(variance + 1e-5) + offset


def pool(x, rows, columns):
    k, height, width = x.shape
    x = x[:, :height // rows * rows, :width // columns * columns]
    return x.reshape(k, height // rows, rows, width // columns, columns).max((2, 4))


def full(x, values, outputs):
    weights = values.reshape(-1, outputs)
    return x.reshape(-1) @ weights[:-1] + weights[-1]


def relu(x):
    return np.maximum(x, 0)


def image(shape):
    return np.cos(0.7 * np.arange(np.prod(shape))).reshape(shape)


def lenet(classes, shape):
    c, width = shape[0], shape[2]
    flat = 64 * (width // 2 // 2 // 2)
    p = Reader([(128 + 1) * classes, (flat + 1) * 128, 64 * (32 * 9 + 1), 32 * (16 * 15 + 1),
                16 * (c * 15 + 1)])
    x = pool(relu(conv(image(shape), p.take(), 16, 3, 5)), 1, 2)
    x = pool(relu(conv(x, p.take(), 32, 3, 5)), 1, 2)
    x = pool(relu(conv(x, p.take(), 64, 3, 3)), 5, 2)
    return full(relu(full(x, p.take(), 128)), p.take(), classes)


def mobilenet(classes, shape):
    blocks = [(32, 64, 1), (64, 128, 2), (128, 128, 1), (128, 256, 2)]
    sizes = [(256 + 1) * classes]
    for inner, outer, _ in reversed(blocks):
        sizes += [4 * outer, outer * (inner + 1), 4 * inner, inner * 10]
    sizes += [4 * 32, 32 * (shape[0] * 9 + 1)]
    p = Reader(sizes)
    x = conv(image(shape), p.take(), 32, 3, 3, 2)
    x = relu(norm(x, p.take()))
    for inner, outer, stride in blocks:
        x = depthwise(x, p.take(), stride)
        x = relu(norm(x, p.take()))
        x = conv(x, p.take(), outer, 1, 1)
        x = relu(norm(x, p.take()))
    return full(x.mean((1, 2)), p.take(), classes)


np.set_printoptions(precision=9)
print("lenet", lenet(3, (2, 5, 21)))
print("mobilenet", mobilenet(3, (2, 5, 21)))
