# SPDX-License-Identifier: BSD-3-Clause
"""A resist whose threshold is a small neural network of the image. README.md of this folder has
the method."""
import numpy as np
from opcflow import Resist, file, integer, real

RADII = 200.0, 60.0  # nm: of the maximum intensity and of the slope, as in resist.vtr


def gaussian_mean(values, spacing, radius):
    """Return the mean over a Gaussian window with a standard deviation of half the radius."""
    fy, fx = np.meshgrid(*(np.fft.fftfreq(n, d) for n, d in zip(values.shape, spacing)),
                         indexing="ij")
    window = np.exp(-2 * (np.pi * radius / 2) ** 2 * (fx ** 2 + fy ** 2))
    return np.fft.ifft2(np.fft.fft2(values) * window).real


def features(values, frame):
    """Return the maximum intensity and the slope near each node, shape (ny, nx, 2)."""
    spacing = frame[3] / values.shape[0], frame[2] / values.shape[1]
    maximum = gaussian_mean(values ** 8, spacing, RADII[0]).clip(0) ** 0.125
    around = np.pad(values, 1, mode="wrap")  # the frame is periodic
    dy, dx = (d[1:-1, 1:-1] for d in np.gradient(around, *spacing))
    slope = gaussian_mean(dx ** 2 + dy ** 2, spacing, RADII[1]).clip(0) ** 0.5
    return np.stack([maximum, 100 * slope], axis=-1)


class Network:
    """A network with one hidden layer of tanh units."""

    def __init__(self, inputs, units, seed=1):
        random = np.random.default_rng(seed)
        self.shapes = (inputs, units), (units,), (units,), (1,)
        self.weights = 0.5 * random.standard_normal(sum(int(np.prod(s)) for s in self.shapes))

    def parts(self, weights):
        sizes = np.cumsum([np.prod(s) for s in self.shapes])[:-1].astype(int)
        return [w.reshape(s) for w, s in zip(np.split(weights, sizes), self.shapes)]

    def __call__(self, x):
        first, bias, second, constant = self.parts(self.weights)
        return np.tanh(x @ first + bias) @ second + constant[0]

    def jacobian(self, x):
        """Return the derivatives by all weights, shape (samples, weights)."""
        first, bias, second, _ = self.parts(self.weights)
        hidden = np.tanh(x @ first + bias)
        inner = (1 - hidden ** 2) * second
        return np.hstack([(x[:, :, None] * inner[:, None, :]).reshape(len(x), -1), inner, hidden,
                          np.ones((len(x), 1))])

    def train(self, x, y, iterations):
        """Minimise the squared error by the method of Levenberg and Marquardt. Returns the root
        of the mean square error."""
        damping, error = 1.0, y - self(x)
        for _ in range(iterations):
            j, before = self.jacobian(x), self.weights
            normal = j.T @ j
            self.weights = before + np.linalg.solve(normal + damping * np.eye(len(normal)),
                                                    j.T @ error)
            better = y - self(x)
            if (better ** 2).sum() < (error ** 2).sum():
                error, damping = better, damping / 3
            else:
                self.weights, damping = before, damping * 4
        return float(np.sqrt((error ** 2).mean()))


class Learned(Resist):
    """Threshold by a neural network that learns from measured thresholds"""

    version = "0.1.0"
    table = file("thresholds: CSV with the columns maximum, slope (1/nm) and threshold",
                 required=True)
    units = integer("hidden units", preset=6, at_least=1)
    iterations = integer("largest number of training steps", preset=200, at_least=1)
    limit = real("largest allowed error of the thresholds of the table", preset="0.005", above=0)

    def prepare(self, scanner):
        rows = np.genfromtxt(self.table, delimiter=",", names=True)
        x = np.stack([rows["maximum"], 100 * rows["slope"]], axis=1)
        self.centre, self.spread = x.mean(axis=0), x.std(axis=0)
        self.network = Network(2, self.units)
        error = self.network.train((x - self.centre) / self.spread, rows["threshold"],
                                   self.iterations)
        print("%d thresholds, root mean square error of the network %.5f" % (len(x), error))
        if error > self.limit:
            raise ValueError("the network has an error of %.4f, expected at most %g: use more "
                             "units" % (error, self.limit))

    def level(self, layer, image):
        x = (features(image.values.astype(float), image.frame) - self.centre) / self.spread
        # Beyond the table, the network would extrapolate: use the nearest features.
        return self.network(x.clip(-2.5, 2.5)) - image.values
