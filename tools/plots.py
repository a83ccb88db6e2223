# SPDX-License-Identifier: BSD-3-Clause
"""Draw the diagrams of docs/background/gallery.md as SVG, without dependencies."""
import html
import math

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]  # Okabe and Ito
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 560, 340, 64, 12, 16, 46


def ticks(low, high, most=6):
    """Return round numbers between two values."""
    raw = (high - low) / most or 1
    power = 10 ** math.floor(math.log10(raw))
    step = next(k * power for k in (1, 2, 5, 10) if k * power >= raw * 0.999)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


class Plot:
    """Axes with points, lines and rectangles; each series has an entry of the legend."""

    def __init__(self, x_label, y_label, x, y, log_y=False):
        self.x, self.y, self.log = x, y, log_y
        self.labels, self.body, self.legend = (x_label, y_label), [], []

    def at(self, x, y):
        if self.log:
            y, (low, high) = math.log10(y), map(math.log10, self.y)
        else:
            low, high = self.y
        return (LEFT + (x - self.x[0]) / (self.x[1] - self.x[0]) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - (y - low) / (high - low) * (HEIGHT - TOP - BOTTOM))

    def colour(self, name):
        if name not in self.legend:
            self.legend.append(name)
        return COLOURS[self.legend.index(name) % len(COLOURS)]

    def points(self, name, pairs, size=3):
        colour = self.colour(name)
        self.body += ['<circle cx="%.1f" cy="%.1f" r="%g" fill="%s" fill-opacity=".7"/>' % (*self.at(*p), size, colour)
                      for p in pairs]

    def line(self, name, pairs, dash=""):
        self.body.append('<polyline fill="none" stroke="%s" stroke-width="1.5" stroke-dasharray="%s" points="%s"/>' % (
            self.colour(name), dash, " ".join("%.1f,%.1f" % self.at(*p) for p in pairs)))

    def boxes(self, name, sizes):
        """Draw rectangles (x0, x1, height) from the lower axis."""
        colour = self.colour(name)
        for x0, x1, height in sizes:
            a, b = self.at(x0, self.y[0]), self.at(x1, min(height, self.y[1]))
            self.body.append('<rect x="%.1f" y="%.1f" width="%.1f" height="%.1f" fill="%s" fill-opacity=".55"/>' % (
                a[0], b[1], b[0] - a[0], a[1] - b[1], colour))

    def text(self, x, y, text):
        a = self.at(x, y)
        self.body.append('<text x="%.1f" y="%.1f" text-anchor="middle">%s</text>' % (*a, html.escape(text)))

    def svg(self, x_ticks=None):
        out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d" font-family="sans-serif" font-size="12">' % (
            WIDTH, HEIGHT), '<rect width="100%" height="100%" fill="white"/>']
        low, high = self.y
        rows = [10.0 ** k for k in range(math.ceil(math.log10(low)), math.floor(math.log10(high)) + 1)] if self.log \
            else ticks(low, high)
        for value in rows:
            x, y = self.at(self.x[0], value)
            out.append('<path d="M%d %.1fH%d" stroke="#ddd"/><text x="%d" y="%.1f" text-anchor="end">%g</text>' % (
                LEFT, y, WIDTH - RIGHT, LEFT - 6, y + 4, round(value, 12)))
        for value, name in x_ticks or [(v, "%g" % round(v, 12)) for v in ticks(*self.x, most=8)]:
            x, y = self.at(value, low)
            out.append('<path d="M%.1f %dv5" stroke="black"/><text x="%.1f" y="%d" text-anchor="middle">%s</text>' % (
                x, HEIGHT - BOTTOM, x, HEIGHT - BOTTOM + 18, html.escape(name)))
        out += self.body
        out.append('<path d="M%d %dV%dH%d" fill="none" stroke="black"/>' % (LEFT, TOP, HEIGHT - BOTTOM, WIDTH - RIGHT))
        out.append('<text x="%d" y="%d" text-anchor="middle">%s</text>' % (
            (LEFT + WIDTH - RIGHT) // 2, HEIGHT - 8, html.escape(self.labels[0])))
        out.append('<text transform="translate(14 %d) rotate(-90)" text-anchor="middle">%s</text>' % (
            (TOP + HEIGHT - BOTTOM) // 2, html.escape(self.labels[1])))
        for k, name in enumerate(self.legend):
            out.append('<rect x="%d" y="%d" width="10" height="10" fill="%s"/><text x="%d" y="%d">%s</text>' % (
                WIDTH - 170, TOP + 4 + 16 * k, COLOURS[k % len(COLOURS)], WIDTH - 155, TOP + 13 + 16 * k,
                html.escape(name)))
        return "\n".join(out + ["</svg>"]) + "\n"


def histogram(series, x_label, bins=40, low=None, high=None):
    """Return the histogram of named lists of values; values beyond the bounds are in the outermost bins."""
    values = [v for _, one in series for v in one]
    low = min(values) if low is None else low
    high = max(values) if high is None else high
    counts = []
    for name, one in series:
        count = [0] * bins
        for v in one:
            count[min(bins - 1, max(0, int((v - low) / (high - low) * bins)))] += 1
        counts.append((name, [100 * c / len(one) for c in count]))
    plot = Plot(x_label, "share, %", (low, high), (0, max(max(c) for _, c in counts) * 1.1))
    width = (high - low) / bins
    for name, count in counts:
        plot.boxes(name, [(low + k * width, low + (k + 1) * width, c) for k, c in enumerate(count) if c])
    return plot.svg()
