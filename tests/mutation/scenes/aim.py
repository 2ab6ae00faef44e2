#!/usr/bin/env python3
"""Recorded paths that aim at the corners, edges, diagonals and faces of a mesh: aim.py MESH.obj METRES PATHS STEPS SEED SNAP > OUT.csv

From each place the next is another feature, or the same one, off it by 1e-8 to 0.3 of the mesh's size in any direction, or by nothing.
METRES is the mesh's unit. SNAP: of the places this share is taken to multiples of 1/64 unit, where heights above planes of such a mesh
are exact, and moves to them may be along one axis alone. A millisecond a step."""
import random
import sys


def read(path):
    corners, facets = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            corners.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            facets.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return corners, facets


def blend(one, other, share):
    return [a + (b - a) * share for a, b in zip(one, other)]


def feature(draw, corners, facets):
    facet = draw.choice(facets)
    place = corners[draw.choice(facet)]
    kind = draw.randrange(4)
    if kind > 0:  # an edge or a diagonal, then a place of the facet
        place = blend(place, corners[draw.choice(facet)], draw.choice([0.5, 0.25, draw.random()]))
    if kind > 1:
        place = blend(place, corners[draw.choice(facet)], draw.random())
    return place


def main(mesh, metres, paths, steps, seed, snap):
    draw = random.Random(int(seed))
    corners, facets = read(mesh)
    size = max(abs(at) for corner in corners for at in corner)
    print("path,t,x,y,z")
    for path in range(int(paths)):
        aim = place = feature(draw, corners, facets)
        for step in range(int(steps)):
            if draw.random() < 0.5:
                aim = blend(aim, feature(draw, corners, facets), draw.choice([1, 1, draw.random()]))
            off = 0 if draw.random() < 0.1 else size * 10 ** draw.uniform(-8, -0.5)
            last, place = place, [at + off * draw.uniform(-1, 1) for at in aim]
            if draw.random() < float(snap):
                place = [round(64 * at) / 64 for at in place]
                if draw.random() < 0.3:
                    axis = draw.randrange(3)
                    place = [new if i == axis else round(64 * old) / 64 for i, (new, old) in enumerate(zip(place, last))]
            print(f"{path},{step * 1e-3:.3f}," + ",".join(f"{at * float(metres):.10g}" for at in place))


main(*sys.argv[1:])
