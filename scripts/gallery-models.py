#!/usr/bin/env python3
"""gallery-models.py FOLDER makes what scripts/gallery draws beside the shared data: low-poly meshes, a forest as a lidar
sees it, and one small cloud in ten dialects of text. The same files on every run."""
import math
import os
import random
import struct
import sys

if "--help" in sys.argv:
    print(__doc__)
    sys.exit()
folder = sys.argv[1]
chance = random.Random(19)


def write(name, text):
    with open(os.path.join(folder, name), 'w') as file:
        file.write(text)


def write_mesh(name, vertices, faces):
    lines = ['v %.6g %.6g %.6g' % vertex for vertex in vertices]
    lines += ['f ' + ' '.join(str(i + 1) for i in face) for face in faces]
    write(name, '\n'.join(lines) + '\n')


def revolve(profile, n):
    """A solid of revolution about y: profile is (radius, height) from bottom to top."""
    vertices = [(r * math.cos(2 * math.pi * k / n), h, r * math.sin(2 * math.pi * k / n)) for r, h in profile
                for k in range(n)]
    faces = [(a * n + k, (a + 1) * n + k, (a + 1) * n + (k + 1) % n, a * n + (k + 1) % n)
             for a in range(len(profile) - 1) for k in range(n)]
    faces.append(tuple(range(n)))
    faces.append(tuple(reversed(range((len(profile) - 1) * n, len(profile) * n))))
    return vertices, faces


def low_poly():
    cube = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    write_mesh('cube.obj', cube, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    write_mesh('vase.obj', *revolve([(0.5, 0), (0.9, 0.5), (1, 1), (0.6, 1.8), (0.35, 2.2), (0.6, 2.6)], 12))
    write_mesh('rook.obj', *revolve([(1, 0), (1, 0.3), (0.6, 0.5), (0.5, 2), (0.8, 2.2), (0.8, 2.8)], 8))
    gear = [((1 if k % 4 < 2 else 0.8) * math.cos(math.pi * k / 20), (1 if k % 4 < 2 else 0.8) * math.sin(math.pi * k / 20))
            for k in range(40)]
    vertices = [(x, y, z) for z in (0.0, 0.3) for x, y in gear]
    sides = [(k, (k + 1) % 40, 40 + (k + 1) % 40, 40 + k) for k in range(40)]
    write_mesh('gear.obj', vertices, sides + [tuple(reversed(range(40))), tuple(range(40, 80))])
    ground = [(x, y, 0.8 * math.sin(0.9 * x) * math.cos(0.7 * y)) for y in range(12) for x in range(12)]
    write_mesh('hills-z-up.obj', ground, [(y * 12 + x, y * 12 + x + 1, y * 12 + x + 13, y * 12 + x + 12)
                                          for y in range(11) for x in range(11)])


def height(x, y):
    return 3 * math.sin(x / 17) + 2 * math.cos(y / 23)


def forest_points():
    """Ground, and trees whose crowns are hit everywhere inside: x, y, z, intensity, classification."""
    points = []
    for _ in range(60000):
        x, y = chance.uniform(0, 100), chance.uniform(0, 100)
        points.append((x, y, height(x, y) + chance.gauss(0, 0.03), chance.randint(90, 130), 2))
    for _ in range(90):
        x, y, tall = chance.uniform(4, 96), chance.uniform(4, 96), chance.uniform(8, 22)
        base, wide = height(x, y), 0.22 * tall
        for _ in range(int(60 * tall)):
            up = chance.uniform(0.25, 1)
            reach = wide * (1 - up) ** 0.6 * chance.random() ** 0.4
            turn = chance.uniform(0, 2 * math.pi)
            points.append((x + reach * math.cos(turn), y + reach * math.sin(turn), base + up * tall,
                           chance.randint(20, 70), 5))
        for _ in range(25):
            points.append((x + chance.gauss(0, 0.1), y + chance.gauss(0, 0.1), base + chance.uniform(0, 0.3) * tall,
                           chance.randint(60, 90), 4))
    return points


def write_las(name, points):
    """LAS 1.2, point format 0, in millimetres."""
    low = [min(p[k] for p in points) for k in range(3)]
    high = [max(p[k] for p in points) for k in range(3)]
    header = struct.pack('<4sHHIHH8sBB32s32sHHHIIBHI5I', b'LASF', 0, 0, 0, 0, 0, b'', 1, 2, b'', b'', 1, 2026, 227, 227,
                         0, 0, 20, len(points), len(points), 0, 0, 0, 0)
    header += struct.pack('<3d3d', 0.001, 0.001, 0.001, 500000.0, 4200000.0, 0.0)
    world = [(low[k] + (500000.0, 4200000.0, 0.0)[k], high[k] + (500000.0, 4200000.0, 0.0)[k]) for k in range(3)]
    for bottom, top in world:
        header += struct.pack('<2d', top, bottom)
    with open(os.path.join(folder, name), 'wb') as file:
        file.write(header)
        for x, y, z, intensity, kind in points:
            file.write(struct.pack('<3iHBBbBH', round(1000 * x), round(1000 * y), round(1000 * z), intensity * 256, 9,
                                   kind, 0, 0, 0))


def dialects():
    """A coloured bowl of 2,000 points."""
    rows = []
    for i in range(2000):
        turn, r = 2.399963 * i, math.sqrt(i / 2000)
        x, y = r * math.cos(turn), r * math.sin(turn)
        rows.append((x, y, r * r, int(255 * r), int(127 + 127 * x), int(127 + 127 * y)))
    def table(separator, head='', columns=(0, 1, 2, 3, 4, 5), comma=False, tail=''):
        lines = [separator.join(('%.5f' if k < 3 else '%d') % row[k] for k in columns) for row in rows]
        text = head + '\n'.join(lines) + '\n' + tail
        return text.replace('.', ',') if comma else text
    write('text-plain.xyz', table(' '))
    write('text-header.csv', table(',', 'X,Y,Z,R,G,B\n'))
    write('text-quoted.csv', table(',', '"X","Y","Z","Red","Green","Blue"\n'))
    write('text-semicolon.txt', table(';', 'x;y;z;r;g;b\n'))
    write('text-tabs.txt', table('\t', 'x\ty\tz\tr\tg\tb\n'))
    write('text-order.csv', table(',', 'r,g,b,z,y,x\n', (3, 4, 5, 2, 1, 0)))
    write('text-cloudcompare.asc', table(' ', '//X Y Z R G B\n2000\n'))
    write('text-bom.csv', '\ufeff' + table(',', 'x,y,z,red,green,blue\n'))
    write('text-decimal-comma.txt', table(';', 'x;y;z\n', (0, 1, 2), True))
    write('text-five-columns.txt', table(' ', '', (0, 1, 2, 3, 4)))
    write('text-count-off.pts', table(' ', '2003\n'))


low_poly()
write_las('forest.las', forest_points())
dialects()
