"""Recomputes what the model observer expects people to answer: of rigid bumps, and of a simulated hand's strokes.

Lengths are in m; forces are in N.
"""
import math
import re
import numpy as np
from recomputed_checks import check
from recomputed_models import HALF, axis_steps

MIL = 25.4e-6  # m
EDGE, LEVELS, PATH, WEBER, LAPSE = 0.7347, 7.228, 0.0604, 0.07, 0.02  # 1: kappa, g, w, W, lambda
PICTURES = ("flat", "two_poly", "three_poly", "cylinder")


def bumps_at(x, radius, facets):
    """m, 1, 1: height, slope and the cylinder's slope of bumps at x; 0 facets are the cylinder."""
    inside, some = abs(x) < HALF, np.maximum(facets, 1)
    x, opening = np.where(inside, x, 0), np.arcsin(HALF / radius)
    facet = np.minimum((np.arcsin(x / radius) + opening) // (2 * opening / some), some - 1)
    middle = (2 * facet + 1 - some) * opening / some
    circle = np.sqrt(radius**2 - x**2)
    plane = (radius * np.cos(opening / some) - x * np.sin(middle)) / np.cos(middle)  # over the cylinder's axis
    height = np.where(facets > 0, plane, circle) - np.sqrt(radius**2 - HALF**2)
    round_slope = np.where(inside, -x / circle, 0)
    return np.where(inside, height, 0), np.where(facets > 0, np.where(inside, -np.tan(middle), 0), round_slope), \
        round_slope


def cues(x, force, path):
    """1: how far force and path jump over 0.1 mm at the crest, the shares of the width about it that are level, and the
    steepest force: `force` is F_x / F_z, `path` -dz/dx, at x."""
    steepest = abs(force).max()
    jumps = [abs(np.subtract(*np.interp([5e-5, -5e-5], x, values))) for values in (force, path)]

    def level(values):
        area = 0
        for side in (x >= 0, x < 0):
            way = np.concatenate([[0], np.sort(abs(x[side]))])
            felt = np.concatenate([[np.interp(0, x, values)], values[side] if x[side][0] >= 0 else values[side][::-1]])
            share = np.maximum(0, 1 - np.maximum.accumulate(abs(felt)) / (WEBER * steepest))
            area += ((share[1:] + share[:-1]) / 2 * np.diff(way)).sum()
        return max(0, area / (2 * HALF) - WEBER / 2)  # less what a ramp has
    levels = [level(values) for values in (force, path)] if steepest else [0, 0]
    return np.array([*jumps, *levels, steepest])


def answers(cue):
    """%: of each picture, by a race of edges against level tops after a bump was felt (Poisson)."""
    force_jump, path_jump, force_level, path_level, steepest = cue
    edges = (force_jump + PATH * path_jump + WEBER) / EDGE
    levels = LEVELS * (force_level + PATH * path_level)
    felt, none = 1 - math.exp(-(steepest / WEBER)**2 / 2), math.exp(-edges - levels)
    won = felt * (1 - none) / (edges + levels)
    shares = np.array([1 - felt, won * edges, won * levels, felt * none])
    return 100 * ((1 - LAPSE) * shares + LAPSE / 4)


def rigid(radius, facets, shaded):
    """%: the answers where the path is the nominal surface."""
    x = HALF * np.linspace(-1, 1, 5001)[1:-1]
    _, slope, round_slope = bumps_at(x, radius, facets)
    return answers(cues(x, -round_slope if shaded else -slope, -slope))


def pressed(x, z, radius, facets, shaded):
    """N: along x and z at places in bumps of 1000 N/m; plane and cylinder each press alone (shaders/README.md, L2)."""
    height, slope, round_slope = bumps_at(x, radius, facets)
    tilt, over = np.where(shaded, round_slope, slope), z + np.sqrt(radius**2 - HALF**2)
    facet = np.maximum(height - z, 0) / np.hypot(1, tilt)
    inside = np.maximum(radius / np.hypot(x, over) - 1, 0)
    both = ((inside * x, inside * over + np.maximum(-z, 0)), (-facet * tilt, facet))
    return [1000 * np.where(facets > 0, of_facet, of_circle) for of_circle, of_facet in zip(*both)]


def stroked(radius, facets, shaded):
    """%: the answers of four strokes of 1 N and 0.1 m/s, a sample a millisecond, on bumps of 1000 N/m."""
    count, reach = 1525, 1.5 * HALF
    target = reach * (4 * abs((np.arange(count + 1) * 1e-4 / (4 * reach) + 0.5) % 1 - 0.5) - 1)
    across, upright = axis_steps(3, 500, 1e-3), axis_steps(3, 0, 1e-3)
    x, z, along, up, kept = target[0] + 0 * radius, 0 * radius, 0 * radius, 0 * radius, []
    for i in range(count):
        fx, fz = pressed(x, z, radius, facets, shaded)
        kept.append((x, z, fx, fz))
        off, push, down = x - target[i], fx + 2 * (target[i + 1] - target[i]) * 1000, fz - 1
        x, along = (row[0] * off + row[1] * along + row[2] * push for row in across)
        x, z, up = x + target[i], z + upright[0, 1:] @ [up, down], upright[1, 1:] @ [up, down]
    return [answers(np.mean(list(map(pass_cues, passes(case))), 0)) for case in np.moveaxis(np.array(kept), 2, 0)]


def passes(samples):
    """Of rows (x, z, F_x, F_z) those of each way from one side of the bump to the other."""
    side = np.where(abs(samples[:, 0]) > HALF, np.sign(samples[:, 0]), 0)
    beside = np.flatnonzero(side)
    return [samples[i:j] for i, j in zip(beside[:-1], beside[1:]) if side[i] == -side[j]]


def pass_cues(way):
    """Of what is felt on one, from left to right."""
    way = way[way[:, 3] > 0]
    way = way if way[-1, 0] > way[0, 0] else way[::-1]
    way = way[np.concatenate([[True], way[1:, 0] > np.maximum.accumulate(way[:-1, 0])])]
    x, z, fx, fz = way.T
    inside = abs(x[1:]) <= HALF
    return cues(x[1:][inside], (fx / fz)[1:][inside], -(np.diff(z) / np.diff(x))[inside])


def check_perception(rows, needed):
    """perception/answers.csv and facets.csv, by the published numbers of the observer (host/experiment/observer.h)."""
    stimuli = []
    for row in rows:
        facets = re.search(r"facets-(\d+)", row["case"])
        radius = MIL * float(re.search(r"radius-(\d+)mil", row["case"])[1])
        stimuli.append((radius, int(facets[1]) if facets else 0, "reference" in row["case"]))
    table = lambda words: np.array([[float(row[f"{name}{words}_percent"]) for name in PICTURES] for row in rows])
    strokes, limits = np.array(stroked(*map(np.array, zip(*stimuli)))), np.array([rigid(*one) for one in stimuli])
    largest = lambda values: abs(values).max()
    for words, own, most in (("", strokes, 0.01), ("_rigid", limits, 0.2)):
        check(f"answers{words} to {len(rows)} stimuli, %: largest difference", 0, largest(table(words) - own), 0, most)
    moved = [float(row["moved_points"]) for row in rows]
    check("how far stiffness moves them, points: largest difference", 0,
          largest(moved - abs(strokes - limits).sum(1) / 2), 0, 0.2)
    for row in needed:
        radius, least, shaded = 1e-3 * float(row["radius_mm"]), int(row["facets"]), row["shading"] == "shaded"
        apart = [abs(rigid(radius, facets, shaded) - rigid(radius, 0, False)).sum() / 2
                 for facets in range(least - 1, 129)]
        name = f"{row['radius_mm']} mm, {row['shading']}, points from the cylinder's answers"
        check(f"{name} of {least - 1} facets", 5, apart[0], 5 - 0.1, 100)
        check(f"{name} of {least} and more", 5, max(apart[1:]), 0, 5 + 0.1)
