#!/usr/bin/env python3
"""Recorded paths that aim at the corners, edges, diagonals and faces of a mesh: aim.py MESH.obj PATHS STEPS SEED > OUT.csv

From each place the next is another feature, or the same one, off it by 1e-7 to 10 mm in any direction, or by nothing. The mesh is in
mm, the paths in m, a millisecond a step."""
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


def main(mesh, paths, steps, seed):
    draw = random.Random(int(seed))
    corners, facets = read(mesh)
    print("path,t,x,y,z")
    for path in range(int(paths)):
        aim = feature(draw, corners, facets)
        for step in range(int(steps)):
            if draw.random() < 0.5:
                aim = blend(aim, feature(draw, corners, facets), draw.choice([1, 1, draw.random()]))
            off = 0 if draw.random() < 0.1 else 10 ** draw.uniform(-7, 1)
            place = [(at + off * draw.uniform(-1, 1)) * 1e-3 for at in aim]
            print(f"{path},{step * 1e-3:.3f}," + ",".join(f"{at:.10g}" for at in place))


main(*sys.argv[1:])
