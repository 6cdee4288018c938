#!/usr/bin/env python3
"""final-scenes.py FOLDER DATA makes what scripts/final-pictures puts about its models: stages (a floor that rises
behind the scene), cameras, and skies with softboxes. The same files on every run."""
import json
import math
import os
import struct
import sys

if "--help" in sys.argv:
    print(__doc__)
    sys.exit()
folder, data = sys.argv[1:3]

# Of each axis that points up: right, forward and up, as a camera at azimuth 0 has them.
FRAMES = {'y': ((1, 0, 0), (0, 0, -1), (0, 1, 0)), 'z': ((1, 0, 0), (0, 1, 0), (0, 0, 1))}


def place(frame, right, forward, up):
    return tuple(right * r + forward * f + up * u for r, f, u in zip(*frame))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def turned(azimuth, elevation):
    """Right, forward and up of where a camera stands, seen from what it looks at."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return math.sin(a) * math.cos(e), -math.cos(a) * math.cos(e), math.sin(e)


def camera(name, up, target, distance, azimuth, elevation, fov, size, shift=(0, 0)):
    """A camera that looks at target; fov is across the shorter side, shift moves the picture by parts of its size."""
    frame = FRAMES[up]
    back = place(frame, *turned(azimuth, elevation))
    eye = [t + distance * b for t, b in zip(target, back)]
    right = place(frame, math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0)
    forward = [-b for b in back]
    down = [forward[1] * right[2] - forward[2] * right[1], forward[2] * right[0] - forward[0] * right[2],
            forward[0] * right[1] - forward[1] * right[0]]
    rows = [[*row, -dot(row, eye)] for row in (right, down, forward)] + [[0, 0, 0, 1]]
    focal = 0.5 * min(size) / math.tan(math.radians(fov) / 2)
    with open(os.path.join(folder, name + '.json'), 'w', encoding='utf-8') as file:
        json.dump({'width': size[0], 'height': size[1], 'fx': focal, 'fy': focal,
                   'cx': (0.5 + shift[0]) * size[0], 'cy': (0.5 + shift[1]) * size[1], 'world_to_camera': rows}, file)


def stage(name, up, center, azimuth, front, back, bend, wall, half_width, color):
    """A floor through center, `front` towards the camera and `back` away from it, which bends up into a wall."""
    frame = FRAMES[up]
    a = math.radians(azimuth)
    profile = [(-front + (front + back) * k / 64, 0) for k in range(65)]
    turns = [math.pi * k / 96 for k in range(1, 49)]
    profile += [(back + bend * math.sin(turn), bend - bend * math.cos(turn)) for turn in turns]
    profile += [(back + bend, bend + wall)]
    lines, n = [], 48
    for depth, height in profile:
        for k in range(n + 1):
            side = half_width * (2 * k / n - 1)
            at = place(frame, side * math.cos(a) - depth * math.sin(a), side * math.sin(a) + depth * math.cos(a),
                       height)
            lines.append('v ' + ' '.join('%.7g' % (c + x) for c, x in zip(center, at)) + ' %g %g %g' % color)
    for i in range(len(profile) - 1):
        for k in range(n):
            v = i * (n + 1) + k + 1
            lines.append('f %d %d %d %d' % (v, v + 1, v + n + 2, v + n + 1))
    with open(os.path.join(folder, name + '.obj'), 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines) + '\n')


def sky(name, up, zenith, horizon, ground, boxes, size=(512, 256)):
    """Light by direction: a sky over a ground, and discs of light: (right, forward, up), radius in degrees, colour."""
    width, height = size
    boxes = [([c / math.sqrt(dot(d, d)) for c in d], math.radians(radius), color) for d, radius, color in boxes]
    rows = []
    for y in range(height):
        up_part = math.cos(math.pi * (y + 0.5) / height)
        around = math.sqrt(1 - up_part * up_part)
        fade = min(1, max(0, up_part)) ** 0.5
        base = [z * fade + h * (1 - fade) for z, h in zip(zenith, horizon)] if up_part > 0 else ground
        row = []
        for x in range(width):
            angle = 2 * math.pi * ((x + 0.5) / width - 0.5)
            direction = (around * math.sin(angle), around * math.cos(angle), up_part)
            pixel = list(base)
            for center, radius, color in boxes:
                off = math.acos(max(-1, min(1, dot(center, direction)))) / radius
                part = min(1, max(0, (1.1 - off) / 0.2))
                pixel = [p + part * c for p, c in zip(pixel, color)]
            row += pixel
        rows.append(struct.pack('<%df' % len(row), *row))
    with open(os.path.join(folder, name + '.pfm'), 'wb') as file:
        file.write(b'PF\n%d %d\n-1.0\n' % size + b''.join(reversed(rows)))


def join(name, mesh, color, base):
    """The mesh DATA/MESH, all of one colour, on the stage `base`, as one file: a hybrid is made of one."""
    with open(os.path.join(data, mesh), encoding='utf-8') as file:
        rows = [line.split() for line in file]
    lines = ['v ' + ' '.join(row[1:4]) + ' %g %g %g' % color for row in rows if row[:1] == ['v']]
    n = len(lines)
    lines += ['f ' + ' '.join(row[1:4]) for row in rows if row[:1] == ['f']]
    with open(os.path.join(folder, base + '.obj'), encoding='utf-8') as file:
        for row in map(str.split, file):
            lines.append('f %d %d %d %d' % tuple(int(i) + n for i in row[1:]) if row[0] == 'f' else ' '.join(row))
    with open(os.path.join(folder, name + '.obj'), 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines) + '\n')


def main():
    os.makedirs(folder, exist_ok=True)
    dim = (0.05, 0.05, 0.05)
    camera('lion', 'z', (-2.72, 3.5, 0.1), 8.2, 33, 2, 21, (720, 720))
    sky('lion-sky', 'z', (0.25, 0.3, 0.38), (0.2, 0.22, 0.25), (0.1, 0.09, 0.07),
        [((-0.6, -0.85, 0.8), 9, (48, 41, 31)), ((0.5, 0.9, 0.5), 14, (9, 10, 12))])
    stage('nefertiti-stage', 'z', (0, 0, -247.2), 20, 900, 420, 260, 900, 1600, (0.36, 0.4, 0.46))
    camera('nefertiti', 'z', (-14, 0, -12), 1750, 24, 6, 19, (640, 720))
    sky('nefertiti-sky', 'z', (0.09, 0.12, 0.17), (0.06, 0.07, 0.1), dim,
        [((-0.9, -0.75, 0.8), 15, (15.5, 12.6, 9)), ((1, 0.35, 0.5), 14, (4, 5.4, 8))])
    camera('terrain', 'y', (-0.02, 0.1, 0), 6, 112, 20, 10, (1000, 560))
    stage('terrain-stage', 'y', (0, -0.0003, 0), 0, 4, 4, 0.1, 0.01, 4, (0.0706, 0.1843, 0.3373))
    sky('terrain-sky', 'y', (0.3, 0.42, 0.65), (0.6, 0.55, 0.5), dim, [((-0.75, 0.25, 0.42), 3, (620, 470, 300))])
    stage('gyroid-stage', 'y', (0, -0.998, 0), 33, 5, 2.6, 1.6, 5, 7, (0.78, 0.74, 0.68))
    camera('gyroid', 'y', (0, -0.12, 0), 10, 33, 20, 21, (720, 680))
    sky('gyroid-sky', 'y', (0.3, 0.34, 0.4), (0.25, 0.25, 0.25), dim,
        [((-0.35, -0.75, 0.9), 12, (36, 31, 25)), ((1, -0.3, 0.3), 14, (6, 6.5, 8))])
    stage('hybrid-stage', 'y', (-0.017, 0.0333, 0), 12, 0.4, 0.16, 0.1, 0.4, 0.5, (0.22, 0.34, 0.36))
    if os.path.exists(os.path.join(data, 'bunny.obj')):
        join('hybrid', 'bunny.obj', (0.93, 0.84, 0.7), 'hybrid-stage')
    camera('hybrid', 'y', (-0.018, 0.105, 0), 0.62, 12, 13, 18.6, (720, 640))
    sky('hybrid-sky', 'y', (0.14, 0.17, 0.2), (0.12, 0.13, 0.14), dim,
        [((-0.9, -0.6, 0.9), 13, (23, 19.5, 15)), ((1, 0.4, 0.5), 14, (4, 5, 6.5))])
    camera('cloud', 'z', (636612, 849215, 440), 3300, 357, 34, 10.9, (800, 384))
    sky('cloud-sky', 'z', (0.5, 0.6, 0.75), (0.5, 0.5, 0.5), dim, [((-0.8, 0.2, 0.45), 3, (600, 500, 370))])
    stage('spot-stage', 'y', (0, -0.735, 0.2), 215, 4, 1.8, 1.4, 4, 6, (0.75, 0.62, 0.5))
    camera('spot', 'y', (0, 0.06, 0.1), 7.5, 215, 9, 18, (720, 640))
    sky('spot-sky', 'y', (0.3, 0.34, 0.42), (0.25, 0.25, 0.26), dim,
        [((-0.7, 0.9, 0.9), 12, (30, 26.5, 21)), ((0.9, -0.3, 0.4), 14, (4, 5, 6.6))])


main()
