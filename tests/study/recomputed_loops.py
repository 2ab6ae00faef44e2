"""Recomputes couplings, limits over one quantity at a time, kicks that friction lets die out, and swings at edges.

Lengths are in m; forces are over K, in m, unless their unit is said.
"""
import math
import numpy as np
from recomputed_checks import all_near, check, place_of
from recomputed_models import MASS, angles, axis_steps, least_growing, own_surfaces, powered, size, slope_of, unit

OWN = {"damping": 3.0, "grip": 500.0, "period": 1e-3, "mass": MASS, "delay": 0, "lag": 0.0}  # SI: the studies' hand
PASSIVE = 2 * OWN["damping"] / OWN["period"]  # N/m: of a wall (Colgate & Schenkel 1994)
DOWN = np.array([0.0, 0, 1])
CHANGING = {("bump of 2 facets", "foot", "1", "5000"), ("shaded bump of 2 facets", "foot", "1", "1000"),
            ("shaded bump of 2 facets", "foot", "2", "5000"),
            ("height map of a bump", "foot", "0.2", "5000")}  # of loop_edges.csv, by depth, mm, and stiffness, N/m


# A sampled loop near its place of rest.

def device_steps(damping, spring, period, mass, lag):
    """Over a sample, the rows of place, speed and the device's own force F by these and by the force that it is given
    (N s/m, N/m, s, kg, s): F' = (given - F) / lag."""
    if not lag:
        (xx, xv, xf), (vx, vv, vf) = axis_steps(damping, spring, period, mass)
        return np.array([[xx, xv, 0, xf], [vx, vv, 0, vf], [0, 0, 0, 1]])
    rates = np.array([[0, 1, 0, 0], [-spring / mass, -damping / mass, 1 / mass, 0], [0, 0, -1 / lag, 1 / lag], [0] * 4])
    return powered(rates * period)[:3]


def holds_at(slope, direction):
    """The usual ways to be held: on all sides, down, against the force; where the surface supports that by a fifth."""
    presses = [along for along in (DOWN, direction) if min(along @ direction, along @ slope @ along) >= 0.2]
    return [0 * DOWN, *presses]


def radii(slopes, along, stiffness, hand, coupling=None):
    """The largest sizes of eigenvalues of loops near rest, of places, speeds, the device's own force, forces under way
    and the lag l of a coupling = (k / (N/m), b / (N s/m), filter / s, directions of the force).

    A coupling's tool, without mass, is at the depth t where K t = k (D - t) + b (D - t - l) / (T + filter), D the
    probe's; l follows D - t by T / (T + filter) a sample; the force is K t along the law's."""
    count, delay, pressed = len(slopes), hand["delay"], along.any(1)
    last = np.where(pressed[:, None], along, DOWN)
    first = unit(np.cross(last, np.where(abs(last[:, :1]) < 0.5, [1, 0, 0], [0, 1, 0])))
    frame = np.stack([first, np.cross(last, first), last], -1)
    column, stiffness = lambda values: np.reshape(np.broadcast_to(values, count), (-1, 1, 1)), np.array(stiffness)
    turned = -np.swapaxes(frame, 1, 2) @ slopes @ frame
    maps = np.zeros((count, *2 * [9 + 3 * delay + (coupling is not None)]))
    answer = np.zeros((count, 3, maps.shape[1]))
    answer[:, :, :3] = column(stiffness) * turned
    if coupling is not None:
        spring, damper, filtering, directions = coupling
        late, kept = damper / (hand["period"] + filtering), filtering / (hand["period"] + filtering)
        of_depth, of_lag = ((of / (stiffness + spring + late)) for of in (spring + late, -late))  # what t is of D and l
        direction, share = np.swapaxes(frame, 1, 2) @ directions[..., None], spring / (stiffness + spring)
        deeper = np.swapaxes(direction, 1, 2) @ turned
        answer[:, :, :3] = column(stiffness * share) * turned + column(
            stiffness * (of_depth - share)) * direction @ deeper
        answer[:, :, -1:] = column(stiffness * of_lag) * direction
        maps[:, -1:, :3] = (1 - kept) * column(1 - of_depth) * deeper
        maps[:, -1, -1] = kept - (1 - kept) * of_lag
    under_way = 9 + np.arange(3 * delay)
    maps[:, under_way[:-3], under_way[3:]] = 1
    if delay:
        maps[:, under_way[-3:]], answer = answer, np.tile(np.eye(maps.shape[1])[9:12], (count, 1, 1))
    device = {key: hand[key] for key in ("damping", "period", "mass", "lag")}
    steps = np.tile(device_steps(spring=hand["grip"], **device), (count, 3, 1, 1))
    steps[pressed, 2] = device_steps(spring=0, **device)
    for axis, row in np.ndindex(3, 3):
        maps[:, 3 * row + axis, axis:9:3] = steps[:, axis, row, :3]
        maps[:, 3 * row + axis] += steps[:, axis, row, 3:] * answer[:, axis]
    return abs(np.linalg.eigvals(maps)).max(1)


def wall_limit(hand):
    """N/m: where a loop on a wall begins to grow."""
    wall = np.diag(DOWN)[None]
    grows = lambda stiffness: radii(wall, DOWN[None], stiffness, hand) > 1 + 1e-10
    return least_growing(grows, 8 * hand["damping"] / hand["period"])


# Virtual couplings.

def around(row, force_at):
    """Of a row's place the force's slope and direction."""
    at = place_of(row)
    return bent(force_at(row["surface"], at, 1e-3 * float(row["depth_mm"])), at)


def bent(force, at):
    """1: a force's slope at a place, and its direction."""
    return slope_of(force, at[None]), unit(force(at[None]))[0]


def loops_on(name, limits, force_at):
    """Of the places of loop_limits.csv on a surface, each once, held in each usual way: slopes, ways, directions."""
    loops = {}
    for row in (row for row in limits if row["surface"] == name and row["limit_N_per_m"]):
        slope, direction = around(row, force_at)
        for along in holds_at(slope, direction):
            loops.setdefault((*np.round(slope, 5).flat, *np.round(along, 5)), (slope, along, direction))
    return [np.array(column) for column in zip(*loops.values())]


def couplings_rest(loops, scene, springs, dampers, filtering):
    """Of couplings, N/m and N s/m, to a scene, N/m, whether they rest in all loops."""
    slopes, along, directions = (np.tile(one, (len(springs), *[1] * (one.ndim - 1))) for one in loops)
    each = [np.repeat(values, len(loops[0])) for values in (springs, dampers)]
    grow = radii(slopes, along, scene, OWN, (*each, filtering, directions)) > 1 + 1e-10
    return ~grow.reshape(len(springs), -1).any(1)


def check_couplings(rows, limits):
    """loop_couplings.csv: each rests at all places of loop_limits.csv; stiffer ones do not, or they are not passive: in
    line with the scene stiffer than Colgate & Schenkel's 2 b / T; and no damper up to m / T lets one rest that is 2 %
    stiffer."""
    force_at, wrong, passive, stiffer = own_surfaces(), [], [], []
    loops = {name: loops_on(name, limits, force_at) for name in dict.fromkeys(row["surface"] for row in rows)}
    for row in rows:
        scene, spring, damper = (float(row[name]) for name in (
            "scene_N_per_m", "coupling_N_per_m", "coupling_N_s_per_m"))
        given = loops[row["surface"]], scene
        shares, filtering = np.array([0.3, 0.6, 0.9, 0.97, 0.999, 1.002, 1.1]), 1e-3 * float(row["filter_ms"])
        rest = couplings_rest(*given, shares * spring, np.full(7, damper), filtering)
        if row["weakest"]:
            wrong.append((rest != (shares < 1)).any())
        else:
            wrong.append(not rest[:5].all())
            passive.append((float(row["displayed_N_per_m"]), PASSIVE))
        if row["coupling"] == "safe":
            continue
        springs, dampers = (grid.ravel() for grid in np.meshgrid(
            np.geomspace(1.02 * spring, 32 * PASSIVE, 6), [0, *np.geomspace(1, MASS / OWN["period"], 60)]))
        some = couplings_rest([one[:4] for one in given[0]], scene, springs, dampers, filtering)
        if some.any():
            some[some] = couplings_rest(*given, springs[some], dampers[some], filtering)
        stiffer.append(some.any())
    shown = [(float(row["displayed_N_per_m"]),
              1 / (1 / float(row["scene_N_per_m"]) + 1 / float(row["coupling_N_per_m"]))) for row in rows]
    check(f"{len(rows)} couplings: how many do not begin to grow there", 0, sum(wrong), 0, 0)
    check(f"{len(stiffer)} stiffest ones: how many another damper makes 2 % stiffer", 0, sum(stiffer), 0, 0)
    all_near("displayed through couplings, N/m", *zip(*shown), 1e-9)
    all_near("displayed through those that impacts limit, N/m", *zip(*passive), 1e-9)


# The limit over one quantity at a time.

def worst_places(limits):
    """By surface and kind the row with the hand's own lowest limit."""
    worst = {}
    for row in (row for row in limits if row["hand"] == "own" and row["limit_N_per_m"]):
        best = worst.setdefault((row["surface"], row["kind"]), row)
        if float(row["limit_N_per_m"]) < float(best["limit_N_per_m"]):
            worst[row["surface"], row["kind"]] = row
    return worst


def turn_of(slope, direction):
    """1: depth over the radius by which the force turns: of how its direction turns across it the eigenvalue that is
    largest in size, times depth."""
    across = np.eye(3) - np.outer(direction, direction)
    values = np.linalg.eigvalsh(-across @ (slope + slope.T) @ across / 2)
    return values[abs(values).argmax()]


def grip_limit(slope, along, grip):
    """N/m: the least K > 0 where the grip's springs and K times the slope are singular together."""
    springs, points, degree = np.eye(3) - np.outer(along, along), np.arange(-2, 3), 2 if along.any() else 3
    over = np.roots(np.polyfit(points, [np.linalg.det(x * springs + slope) for x in points], degree))  # k_g / K
    over = over.real[(abs(over.imag) < 1e-6) & (over.real > 1e-6)]
    return grip / over.max() if len(over) else math.nan


def hand_of(row):
    """The studies' hand with what the row varies."""
    value, varied = float(row["value"]), row["varied"]
    changed = {"rate": {"period": 1 / value}, "delay": {"delay": int(value)}} if value else {}
    return {**OWN, **({varied: value} if varied in ("mass", "grip", "damping", "lag") else changed.get(varied, {}))}


def misplaced(rows, places, hand):
    """How many rows' limits are not where the loop of a hand begins to grow in one of the ways to be held there."""
    loops = [(i, *place, along) for i, place in enumerate(places) for along in holds_at(*place)]
    which, slopes, _, along = (np.array(column) for column in zip(*loops))
    most = 8 * hand["damping"] / hand["period"] / (0.5 + hand["delay"])
    limit = np.array([float(row["limit_N_per_m"] or most) for row in rows])
    grow = lambda share: np.bincount(which, radii(slopes, along, share * limit[which], hand) > 1 + 1e-10) > 0
    rests = ~np.any([grow(share) for share in (0.3, 0.6, 0.9, 0.9995)], 0)
    return (~rests | ~grow(1.0005) & [row["limit_N_per_m"] != "" for row in rows]).sum()


def pressed_to(force, at, normal, depth):
    """The place along a normal where the force is `depth`, m."""
    for _ in range(60):
        at = at - 0.5 * (depth - size(force(at[None])[0])) * normal
    return at


def deeper_places(rows, there, force_at):
    """Of rows of one place at several depths: where they lie along a normal, which the table lacks; it is the force's
    direction, straight up, or else that of the tilt by which the fewest limits are off."""
    at, depths = place_of(there), [1e-3 * float(row["depth_mm"]) for row in rows]
    force = force_at(there["surface"], at, 1e-3 * float(there["depth_mm"]))
    best = len(rows) + 1, None
    for normal in (bent(force, at)[1], DOWN, *([math.sin(tilt), 0, math.cos(tilt)] for tilt in np.arange(-1, 1, 0.01))):
        places = [bent(force, pressed_to(force, at, np.array(normal), depth)) for depth in depths]
        off = misplaced(rows, places, OWN)
        best = min(best, (off, places), key=lambda one: one[0])
        if not off:
            break
    return best[1]


def check_atlas(rows, limits, name):
    """loop_atlas.csv, at the worst places of each kind in loop_limits.csv."""
    force_at, worst, groups, off, pairs = own_surfaces(), worst_places(limits), {}, 0, {}
    for row in rows:
        key = (row["surface"], row["kind"]) if row["varied"] == "depth" else ()
        if row["varied"] not in ("quantum", "friction"):
            groups.setdefault((tuple(hand_of(row).items()), key), []).append(row)
    for (hand, key), some in groups.items():
        hand = dict(hand)
        places = deeper_places(some, worst[key], force_at) if key else [
            around(worst[row["surface"], row["kind"]], force_at) for row in some]
        off += misplaced(some, places, hand)
        wall, period, damping = wall_limit(hand), hand["period"], hand["damping"]
        for row, (slope, direction) in zip(some, places):
            limit, turn = float(row["limit_N_per_m"] or math.nan), turn_of(slope, direction)
            along = next((one for one in holds_at(slope, direction) if fits(row["hold"], one)), 0 * DOWN)
            own = {"b_T_over_m_1": damping * period / hand["mass"], "kg_T_over_b_1": hand["grip"] * period / damping,
                   "delay_samples": hand["delay"], "lag_over_T_1": hand["lag"] / period, "d_over_R_1": turn,
                   "K_T_over_b_1": limit * period / damping, "of_wall_1": limit / wall,
                   "grip_limit_N_per_m": grip_limit(slope, along, hand["grip"]),
                   "K_d_over_kg_R_1": limit * turn / hand["grip"], "simulated_N_per_m": limit}
            for column, value in own.items():
                if column == "grip_limit_N_per_m":
                    off += math.isnan(value) != (row[column] == "")
                if row[column] and row["limit_N_per_m"]:
                    pairs.setdefault(column, []).append((float(row[column]), value))
    count = sum(map(len, groups.values()))
    check(f"{name}, {count} limits over one quantity: how many are not where loops begin to grow", 0, off, 0, 0)
    for column, both in pairs.items():
        share = {"simulated_N_per_m": 0.01, "grip_limit_N_per_m": 2e-3, "K_d_over_kg_R_1": 2e-3}.get(column, 5e-4)
        all_near(f"{name}, {column}", *zip(*both), share, 1 if column == "d_over_R_1" else 1e-3)


def fits(hold, along):
    """Whether a press is the one of these words."""
    tilt = math.degrees(math.acos(min(1, along[2]))) if along.any() else math.nan
    return hold == ("on all sides" if math.isnan(tilt) else "down" if tilt < 0.06 else
                    f"{tilt:.0f} deg from straight down")


# Friction: of steps of the measured position, and of kicks.

def rubbed(place, speed, force, springs, damping, friction, step):
    """m, m/s: of axes after a part of a sample, s, in which friction, N, is constant against each axis' speed."""
    push, loss = force - springs * (place + step / 2 * speed), step * damping / (2 * MASS)
    way = np.where(speed, np.sign(speed), np.sign(push) * (abs(push) > friction))
    after = np.where(way, ((1 - loss) * speed + step / MASS * (push - friction * way)) / (1 + loss), 0)
    turns = speed * after < 0
    ran = np.where(turns, speed / np.where(turns, speed - after, 1), 1)
    after = np.where(turns, 0, after)
    return place + step * ran * (speed + after) / 2, after


def rounded_rest(stiffness, quantum, friction, kick):
    """Whether a hand comes to rest on a wall that it presses midway between two steps of its measured position, m."""
    still, steps = 0 * stiffness, 13500
    place, speed, early, late, low, high = still - kick, still, still, still, still + np.inf, still - np.inf
    for step in range(steps):
        seen = (np.floor(place / quantum) + 0.5) * quantum
        for _ in range(4):
            place, speed = rubbed(place, speed, -stiffness * seen, 0, OWN["damping"], friction, OWN["period"] / 4)
        place = np.clip(place, -1, 1)
        if steps // 4 <= step < steps // 2:
            early = np.maximum(early, abs(speed))
        if step >= steps - steps // 4:
            late, low, high = np.maximum(late, abs(speed)), np.minimum(low, seen), np.maximum(high, seen)
    return (late < 0.75 * early) | (high - low < quantum / 2) | (late == 0)


def check_rounded(rows, name, kick=1e-3):
    """loop_atlas.csv on a flat wall: 2 f_c / quantum (Abbott & Okamura 2005), or K_crit with the damping b + 4 f_c /
    (pi w kick), w = sqrt(K / m), of friction's describing function; and stepped."""
    rows = [row for row in rows if row["varied"] in ("quantum", "friction")]
    column = lambda key: np.array([float(row[key] or math.nan) for row in rows])
    value, limit, stepped = (column(key) for key in ("value", "limit_N_per_m", "simulated_N_per_m"))
    of_step = np.array([row["varied"] == "quantum" for row in rows])
    quantum, friction = np.where(of_step, value, 1e-5), np.where(of_step, 0.05, value)
    damping = OWN["damping"] + 4 * friction / (math.pi * np.sqrt(limit / MASS) * kick)
    slides = [wall_limit({**OWN, "damping": b}) for b in damping]
    all_near(f"{name}, limits with friction and steps", limit, np.minimum(2 * friction / quantum, slides), 5e-4)
    all_near(f"{name}, f_c T / (b quantum)", column("fc_T_over_b_quantum_1"), friction / quantum * 1e-3 / 3, 1e-9)
    found = ~np.isnan(stepped)
    rest = rounded_rest(np.outer([0.97, 1.03], stepped[found]), quantum[found], friction[found], kick)
    check(f"{name}, {found.sum()} of them stepped: how many do not turn within 3 %", 0,
          (rest != [[True], [False]]).any(0).sum(), 0, 0)


def dying_kick(slope, way, along, row):
    """m: of a kick straight down, by harmonic balance of a swing A along the force w, held, late and against friction:
    m w^2 = k_g (1 - (w along)^2) + K s cos p, K s sin(p) A = 4 f (|w_x| + |w_y| + |w_z|) / pi, with the hold's s =
    sin(w T / 2) / (w T / 2) and p = w T (1/2 + delay)."""
    samples = 0.5 + int(row["delay_samples"])
    held = float(row["stiffness_N_per_m"]) * way @ slope @ way
    grip = float(row["grip_N_per_m"]) * (1 - (way @ along)**2)
    turn = math.sqrt((held + grip) / MASS) * OWN["period"]
    for _ in range(200):
        gain = math.sin(turn / 2) / (turn / 2)
        turn = math.sqrt((grip + held * gain * math.cos(samples * turn)) / MASS) * OWN["period"]
    return 4 * float(row["friction_N"]) * abs(way).sum() / (math.pi * held * gain * math.sin(samples * turn) * way[2])


def kicks_grow(slopes, kicks, stiffness, grips, friction, delays, turn):
    """Whether kicks straight down grow, of linear loops without damping whose w T is `turn` or more."""
    place, samples, parts = kicks[:, None] * [0, 0, -1], int(24 / turn**2), int(50 * turn)
    speed, forces, early, late = 0 * place, [0 * place] * 3, 0 * kicks, 0 * kicks
    for sample in range(samples):
        forces = [-stiffness[:, None] * (slopes @ place[..., None])[..., 0], *forces[:2]]
        given = np.array(forces)[delays.astype(int), np.arange(len(kicks))]
        for _ in range(parts):
            place, speed = rubbed(place, speed, given, grips, 0, friction[:, None], OWN["period"] / parts)
        if samples // 4 <= sample < samples // 2:
            early = np.maximum(early, size(speed))
        if sample >= samples - samples // 4:
            late = np.maximum(late, size(speed))
    return late > early


def check_basins(rows, limits):
    """loop_basins.csv: the closed form, and loops stepped with the slope at the place, of whose depth a kick is a
    hundredth at most."""
    worst, force_at, own, off = worst_places(limits), own_surfaces(), [], 0
    for row in rows:
        row["along"] = DOWN * (row["hold"] == "down")
        row["slope"], way = around(worst[row["surface"], row["kind"]], force_at)
        own.append(1e6 * dying_kick(row["slope"], way, row["along"], row))
    all_near("kicks by closed form, um", [float(row["kick_um"]) for row in rows], own, 1e-3)
    stepped = [row for row in rows if row["stepped_um"]]
    for least, most in ((0.15, 1), (0.09, 0.15), (0, 0.09)):
        some = [row for row in stepped if least <= float(row["w_T_1"]) < most]
        column = lambda name, some=some: np.array([float(row[name]) for row in some])
        slopes, along = (np.array([row[name] for row in some]) for name in ("slope", "along"))
        loops = (slopes, 1e-6 * column("stepped_um"), column("stiffness_N_per_m"),
                 column("grip_N_per_m")[:, None] * (1 - along), column("friction_N"), column("delay_samples"))
        bent_so, kicks, *rest = (np.concatenate([part, part]) for part in loops)
        shares = np.repeat([0.97, 1.03], len(some))
        off += (kicks_grow(bent_so, shares * kicks, *rest, min(column("w_T_1"))) != (shares > 1)).sum()
    check(f"{len(stepped)} stepped kicks: how many do not turn from dying to growing within 3 %", 0, off, 0, 0)


# Swings at edges.

def sides_of(force, at, depth):
    """m: the forces on both sides of a jump across x, a ten-thousandth of the depth apart from it."""
    return [force(at + side * 1e-4 * depth[:, None] * [1, 0, 0]) for side in (-1, 1)]


def swings(force, at, depth, stiffness):
    """m: of loops that begin a tenth of the depth too deep on a jump, pressed against the mean of the forces on both
    sides: between the farthest places in the last quarter of 400 times in which damping takes all speed, along the axis
    of the most; and from where they rest to the middle of these. NaN where a probe went three depths away."""
    steps = int(400 / -math.expm1(-OWN["damping"] * OWN["period"] / MASS))
    maps = np.array([axis_steps(OWN["damping"], grip, OWN["period"]) for grip in (OWN["grip"], OWN["grip"], 0)])
    rest, kick = sum(sides_of(force, at, depth)) / 2, 0.1 * depth[:, None] * [0.25, 0.15, -1]
    aside, speed, low, high, stays = kick, 0 * kick, kick + np.inf, kick - np.inf, depth > 0
    for step in range(steps):
        stays &= size(aside - kick * [1, 1, 0]) <= 3 * depth
        aside[~stays] = speed[~stays] = 0
        push = stiffness[:, None] * (force(at + aside) - rest)
        if step >= steps - steps // 4:
            low, high = np.minimum(low, aside), np.maximum(high, aside)
        aside, speed = (maps[:, k, 0] * aside + maps[:, k, 1] * speed + maps[:, k, 2] * push for k in (0, 1))
    return [np.where(stays, length, math.nan) for length in ((high - low).max(1), size(high + low) / 2)]


def state_of(swing, moved, depth):
    """As the table has it."""
    if math.isnan(swing):
        return "unstable"
    return "limit cycle" if swing > 1e-6 * depth else "slid aside" if moved > 0.1 * depth else "stable"


def check_edges(rows):
    """loop_edges.csv but for meshes, whose god-object stays on a face beyond its edge. Of a swing that changes where it
    begins up to 0.1 um aside the table's is to be among such ones, or a fifth beyond."""
    force_at, random, pairs, off, many = own_surfaces(), np.random.default_rng(6), [], [], 40
    rows = [row for row in rows if "mesh" not in row["surface"]]
    for name in dict.fromkeys(row["surface"] for row in rows):
        some = [row for row in rows if row["surface"] == name]
        moves = [(row["surface"], row["kind"], row["depth_mm"], row["stiffness_N_per_m"]) in CHANGING for row in some]
        which = np.repeat(np.arange(len(some)), np.where(moves, many, 1))
        at, force = np.array([place_of(row) for row in some]), force_at(name, place_of(some[0]), 0)
        depth, stiffness = (np.array([float(row[key]) for row in some]) for key in ("depth_mm", "stiffness_N_per_m"))
        pairs += zip([float(row["jump_deg"]) for row in some], angles(*sides_of(force, at, 1e-3 * depth)))
        begin = at[which] + random.uniform(-1e-7, 1e-7, (len(which), 3)) * np.array(moves)[which, None]
        swing, moved = swings(force, begin, 1e-3 * depth[which], stiffness[which])
        for i, row in enumerate(some):
            own, table = np.array([swing[which == i], moved[which == i]]), np.array(
                [float(row[key] or math.nan) / 1e6 for key in ("swing_um", "moved_um")])
            apart = np.nansum(abs(table - own[:, 0])) > 5e-4 * np.nansum(table)
            different = apart or row["state"] != state_of(*own[:, 0], 1e-3 * depth[i])
            off.append(not 0.8 * np.nanmin(own[0]) <= table[0] <= 1.2 * np.nanmax(own[0]) if moves[i] else different)
    all_near("jumps at edges, deg", *zip(*pairs), 1e-3)
    check(f"{len(off)} swings at edges, of which 0.1 um changes {len(CHANGING)}: how many are off", 0, sum(off), 0, 0)
