# SPDX-License-Identifier: BSD-3-Clause
"""Pixel-based inverse lithography with PyTorch: gradient descent on the pixels of a mask, so that
the printed shapes equal the drawn ones. README.md of this folder has the method."""
import numpy as np
import torch
from opcflow import ACTIVE, POLY, Step, gates_input, integer, metric, output, real

PIXEL = 8       # nm
SUBPIXELS = 2   # rows of rectangles in a pixel
MARGIN = 600    # nm of clear field around the layout


def source_points(sigma, n=9):
    """Return points of a disc-shaped source, in units of NA / wavelength."""
    axis = np.linspace(-1, 1, n) * (1 - 1 / n) * sigma
    x, y = np.meshgrid(axis, axis)
    inside = np.hypot(x, y) <= sigma
    return np.stack([x[inside], y[inside]], axis=1)


class Imaging:
    """Images of masks by Abbe's method: the intensities of all source points are added. They are
    computed at every fourth pixel, which their band allows, and interpolated to all pixels."""

    def __init__(self, shape, wavelength, na, sigma):
        self.shape, self.small = shape, tuple(max(1, n // 4) for n in shape)
        self.rows, self.columns = (np.rint(np.fft.fftfreq(n) * n).astype(int) for n in self.small)
        fy, fx = np.meshgrid(*(k / (n * PIXEL) * wavelength / na for k, n in
                               zip((self.rows, self.columns), shape)), indexing="ij")
        self.pupils = torch.stack([
            torch.from_numpy((np.hypot(fx + x, fy + y) <= 1).astype(np.float32))
            for x, y in source_points(sigma)])

    def __call__(self, mask):
        """Return the intensity at the pixels of a mask with transmission 0 to 1; the clear field
        has 1."""
        low = torch.fft.fft2(mask)[self.rows][:, self.columns]
        scale = np.prod(self.small) / np.prod(self.shape)
        fields = torch.fft.ifft2(self.pupils * low) * scale
        spectrum = torch.fft.fft2((fields.abs() ** 2).mean(dim=0)) / scale
        whole = torch.zeros(self.shape, dtype=spectrum.dtype)
        whole[self.rows[:, None], self.columns] = spectrum
        return torch.fft.ifft2(whole).real


def raster(shapes, grid, box, shape):
    """Return the covered fraction of each pixel by rectilinear polygons, exact along both axes."""
    x0, y0 = box
    edges = np.zeros((shape[0] + 1, shape[1] + 1))
    ys, xs = np.arange(shape[0]) * PIXEL, np.arange(shape[1] + 1) * PIXEL
    for p in range(len(shapes)):
        points = shapes[p] * grid - (x0, y0)
        for (xa, ya), (xb, yb) in zip(points, np.roll(points, -1, axis=0)):
            if xa != xb:
                continue
            rows = np.clip((max(ya, yb) - ys) / PIXEL, 0, 1) - np.clip((min(ya, yb) - ys) / PIXEL,
                                                                     0, 1)
            right = np.clip((xs + PIXEL - xa) / PIXEL, 0, 1)  # part of a pixel right of the edge
            edges[:-1] += np.sign(yb - ya) * np.outer(rows, right)
    return np.abs(edges[:-1, :-1]).clip(0, 1)


class Ilt(Step):
    """Mask by pixel-based inverse lithography with PyTorch"""

    version = "0.1.0"
    gates = gates_input("transistors")
    file = output("the mask, CIF with the layers CP and CA", preset="mask.cif")
    iterations = integer("iterations for each layer", preset=60, at_least=1)
    wavelength = real("wavelength", unit="nm", preset="193 nm", above=0)
    na = real("numerical aperture", preset="0.75", above=0)
    sigma = real("radius of the source", preset="0.75", above=0)
    threshold = real("intensity at the edges of printed poly", preset="0.40394", above=0)
    active_threshold = real("intensity at the edges of printed active", preset="0.27115", above=0)
    steepness = real("slope of the resist's sigmoid", preset="100", above=0)
    gate_weight = real("weight of errors at transistors; elsewhere 1", preset="20", above=0)
    loss = metric("weighted squared error of the printed poly, divided by the weighted area")

    def run(self):
        torch.manual_seed(0)
        optics = self.wavelength, self.na, self.sigma
        grid = self.gates.grid
        x0, y0, x1, y1 = self.gates.extent * grid + MARGIN * np.array([-1, -1, 1, 1])
        shape = tuple(int(np.ceil((b - a) / PIXEL / 32)) * 32 for a, b in ((y0, y1), (x0, x1)))
        imaging = Imaging(shape, *optics)
        parts = ["DS 1 1 10;", "9 %s;" % self.gates.name]
        layers = (POLY, "CP", self.threshold), (ACTIVE, "CA", self.active_threshold)
        for number, (layer, name, level) in enumerate(layers):
            drawn = raster(self.gates.drawn[layer], grid, (x0, y0), shape)
            weight = self.weights((x0, y0), shape)
            mask, loss = self.optimise(drawn, weight, imaging, level, number)
            if layer == POLY:
                self.metric("loss", loss)
            parts += ["L %s;" % name, *rectangles(mask, x0, y0)]
        with open(self.output_path(self.file), "w") as f:
            f.write("\n".join([*parts, "DF;", "C 1;", "E", ""]))

    def weights(self, corner, shape):
        """Return the weights of pixels: `gate_weight` at transistors and within 40 nm, else 1."""
        weight = np.ones(shape, np.float32)
        for box in self.gates.box * self.gates.grid - np.tile(corner, 2):
            xa, ya, xb, yb = np.rint((box + [-40, -40, 40, 40]) / PIXEL).astype(int)
            weight[ya:yb, xa:xb] = self.gate_weight
        return torch.from_numpy(weight)

    def optimise(self, drawn, weight, imaging, level, number):
        """Return the density of dark pixels, and the error of the printed shape. The pixels are
        a sigmoid of free values, smoothed so that no feature is smaller than about 40 nm."""
        target = torch.from_numpy(drawn).float()
        values = (2 * target - 1).clone().requires_grad_(True)
        smooth = gaussian(imaging.shape, 12 / PIXEL)
        best = torch.optim.Adam([values], lr=0.05)
        for i in range(self.iterations):
            best.zero_grad()
            dark = self.dark(values, smooth, 4 + 16 * i / self.iterations)
            printed = torch.sigmoid(self.steepness * (level - imaging(1 - dark)))
            loss = (weight * (printed - target) ** 2).sum() / (weight * target).sum()
            loss.backward()
            best.step()
            self.progress(number * self.iterations + i + 1, 2 * self.iterations)
        return self.dark(values, smooth, 20).detach().numpy(), float(loss.detach())

    @staticmethod
    def dark(values, smooth, contrast):
        blurred = torch.fft.ifft2(torch.fft.fft2(values) * smooth).real
        return torch.sigmoid(contrast * blurred)


def gaussian(shape, radius):
    """Return the transform of a Gaussian with a standard deviation of `radius` pixels."""
    fy, fx = np.meshgrid(*(np.fft.fftfreq(n) for n in shape), indexing="ij")
    return torch.from_numpy(np.exp(-2 * (np.pi * radius) ** 2 * (fx ** 2 + fy ** 2))).float()


def edges(row):
    """Return the edges of the dark parts of a row, in pixels. A part is where the row exceeds 0.5;
    grey pixels beside a part add to its width, so that its area does not change."""
    dark = np.flatnonzero(np.diff(np.concatenate([[0], row > 0.5, [0]])))
    begin, end = dark[::2], dark[1::2]
    between = (end[:-1] + begin[1:] + 1) // 2
    low = np.maximum(np.concatenate([[0], between]), begin - 3)
    high = np.minimum(np.concatenate([between, [len(row)]]), end + 3)
    middle, area = (begin + end) // 2, np.concatenate([[0], np.cumsum(row)])
    return np.stack([middle - (area[middle] - area[low]), middle + area[high] - area[middle]], 1)


def rectangles(dark, x0, y0):
    """Return rectangles of CIF in nm that cover the dark part of the mask, in rows of PIXEL /
    SUBPIXELS nm, interpolated from the rows of pixels."""
    ny, step = len(dark), PIXEL / SUBPIXELS
    y = (np.arange(ny * SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    low = np.clip(np.floor(y).astype(int), 0, ny - 2)
    part = (y - low)[:, None]
    rows = dark[low] * (1 - part) + dark[low + 1] * part
    found, begun = [], {}
    for k in range(len(rows) + 1):
        runs = set()
        if k < len(rows):
            runs = {tuple(run) for run in np.rint(edges(rows[k]) * PIXEL).astype(int).tolist()}
        found += [(run[0], begun.pop(run), run[1], k) for run in set(begun) - runs]
        begun.update({run: k for run in runs - set(begun)})
    return ["P %d %d %d %d %d %d %d %d;" % (xa, ya, xb, ya, xb, yb, xa, yb) for xa, ya, xb, yb in
            ((round(x0 + a), round(y0 + b * step), round(x0 + c), round(y0 + d * step))
             for a, b, c, d in sorted(found))]
