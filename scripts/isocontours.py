#!/usr/bin/env python3
"""An SVG of the contours of a splat in a bad case, large, tilted and near (PAS, Fig. 2): true, by the method `conic`, whose
outline is exact, and by the affine approximation: scripts/isocontours.py > OUT.svg"""

import math

CENTER = (0.0, -0.3, 1.5)
U_AXIS = (0.45, 0.0, 0.0)  # a standard deviation along each of the splat's two axes
V_AXIS = (0.0, 0.12, 0.75)
CUTOFF = 1.5
LEVELS = (0.5, 1.0, 1.5)
SIDE, SCALE = 260, 120
INK = "#1f5fa8"


def place(u, v):
    return [c + u * a + v * b for c, a, b in zip(CENTER, U_AXIS, V_AXIS)]


def project(point):
    return point[0] / point[2], point[1] / point[2]


def circle(radius, n=180):
    return [(radius * math.cos(2 * math.pi * i / n), radius * math.sin(2 * math.pi * i / n)) for i in range(n)]


def true_contour(radius):
    return [project(place(u, v)) for u, v in circle(radius)]


def affine_contour(radius):
    """By the derivative of the projection at the splat's centre."""
    x, y, z = CENTER
    center = project(CENTER)
    columns = [((a[0] - x / z * a[2]) / z, (a[1] - y / z * a[2]) / z) for a in (U_AXIS, V_AXIS)]
    return [(center[0] + u * columns[0][0] + v * columns[1][0], center[1] + u * columns[0][1] + v * columns[1][1])
            for u, v in circle(radius)]


def conic_contour(radius):
    """The true outline, drawn smaller about its own centre, which is the mean of opposite points of an ellipse."""
    outline = true_contour(CUTOFF)
    low = [min(point[axis] for point in outline) for axis in (0, 1)]
    high = [max(point[axis] for point in outline) for axis in (0, 1)]
    center = [(a + b) / 2 for a, b in zip(low, high)]
    return [tuple(c + (p - c) * radius / CUTOFF for p, c in zip(point, center)) for point in outline]


def draw_panel(left, title, contour):
    lines = [f'<text x="{left + SIDE / 2}" y="18" text-anchor="middle">{title}</text>']
    for radius in LEVELS:
        for shape, style in ((true_contour, 'stroke="#bbb" stroke-width="3"'), (contour, f'stroke="{INK}"')):
            points = " ".join(f"{left + SIDE / 2 + SCALE * x:.1f},{125 - SCALE * y:.1f}" for x, y in shape(radius))
            lines.append(f'<polygon points="{points}" fill="none" {style}/>')
    return "\n".join(lines)


def main():
    print(f'<svg xmlns="http://www.w3.org/2000/svg" width="{3 * SIDE}" height="330" font-family="sans-serif" font-size="13">'
          f'\n<rect width="{3 * SIDE}" height="330" fill="#fff"/>')
    for i, (title, contour) in enumerate((("exact (ray)", true_contour), ("conic", conic_contour), ("affine", affine_contour))):
        print(draw_panel(i * SIDE, title, contour))
    print("</svg>")


if __name__ == "__main__":
    main()
