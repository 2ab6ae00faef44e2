// Volumes: unpacked from the page, sampled anywhere.

const AXES = ["x", "y", "z"], COMPARED = ["angle", "error"];

// Of the largest force, where a hand touches, in a volume that does not state it.
const SHALLOW = 0.2;

// Value of each half.
const HALVES = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const exponent = (bits >> 10) & 31, fraction = bits & 1023;
    const size = exponent === 31 ? (fraction ? NaN : Infinity)
      : exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
    values[bits] = bits & 0x8000 ? -size : size;
  }
  return values;
})();

async function inflate(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// The components of vectors, or numbers, packed row by row (host/report/sections.h).
function components(planes, width, scale, each = 3) {
  const count = planes.length / (2 * each);
  return Array.from({ length: each }, (_, c) => {
    const values = new Float32Array(count), high = planes.subarray(2 * c * count), low = high.subarray(count);
    for (let i = 0, half = 0; i < count; ++i) {
      half = ((i % width ? half : 0) + (high[i] << 8) + low[i]) & 0xffff;
      values[i] = HALVES[half] * scale;
    }
    return values;
  });
}

class Volume {
  // `compared`: {angle, error}, deg and N from the shape of [compare], NaN where there is none; null without one.
  constructor(about, planes, compared = null) {
    this.about = about;
    this.size = about.size;
    this.compared = compared;
    const count = this.size[0] * this.size[1] * this.size[2];
    if (planes.length !== 6 * count)
      throw new Error("the volume of " + about.name + " is damaged");
    this.components = components(planes, this.size[0], about.scale_N);
    // Place of the first sample and distance to the next; one y that stands for all is in the middle and as wide as all.
    this.first = [0, 1, 2].map((a) => this.alike(a) ? about.origin_m[a] + (about.full[a] - 1) / 2 * about.spacing_m[a]
      : about.origin_m[a]);
    this.pitch = [0, 1, 2].map((a) => about.spacing_m[a] * (this.alike(a) ? about.full[a] : about.stride[a]));
    this.largest = 0;
    for (let i = 0; i < count; ++i) {
      const size = Math.hypot(this.components[0][i], this.components[1][i], this.components[2][i]);
      if (size > this.largest && Number.isFinite(size))
        this.largest = size;
    }
  }

  // True if the field does not depend on that coordinate: it has one sample for all.
  alike(axis) {
    return axis === 1 && this.about.alike_in_y;
  }

  // Where this field is the same at every y: itself at the other one's y.
  spread(other) {
    if (!this.alike(1))
      return this;
    const [size, first, pitch] = ["size", "first", "pitch"].map((name) => [this[name][0], other[name][1], this[name][2]]);
    return Object.assign(Object.create(this), { size, first, pitch });
  }

  position(axis, index) {
    const position = this.first[axis] + index * this.pitch[axis];
    return Math.abs(position) < 1e-9 * this.pitch[axis] ? 0 : position; // but for rounding
  }

  edges(axis) {
    return [this.first[axis] - this.pitch[axis] / 2, this.first[axis] + (this.size[axis] - 0.5) * this.pitch[axis]];
  }

  within(axis, position) {
    const t = (position - this.first[axis]) / this.pitch[axis];
    return t >= -0.5 - 1e-9 && t <= this.size[axis] - 0.5 + 1e-9;
  }

  // True if it has values at that coordinate.
  has(axis, position) {
    return this.alike(axis) || this.within(axis, position);
  }

  // In words: "y = 0.4350 mm".
  places(axis) {
    const name = AXES[axis], [low, high] = [0, this.size[axis] - 1].map((i) => numberText(1e3 * this.position(axis, i), 4));
    return this.alike(axis) ? "any " + name : low === high ? name + " = " + low + " mm" : name + " from " + low + " to " + high + " mm";
  }

  // A sample near the surface whose force differs most in direction from another field's, of equal ones that closest to
  // the middle; of the whole field where none is near the surface.
  typical(other) {
    const middle = [0, 1, 2].map((a) => this.position(a, Math.floor((this.size[a] - 1) / 2)));
    const [nx, ny] = this.about.size, at = (i) => [i % nx, Math.floor(i / nx) % ny, Math.floor(i / nx / ny)].map((index, a) => this.position(a, index));
    for (const most of [this.about.touched_N ?? SHALLOW * this.largest, Infinity]) {
      let found = null, widest = -Infinity;
      for (let i = 0; i < this.components[0].length; ++i) {
        const force = this.components.map((values) => values[i]), size = Math.hypot(...force);
        if (!(size > 0 && size <= most))
          continue;
        const place = at(i), there = other.force(place), off = place.map((one, a) => (one - middle[a]) / this.pitch[a]);
        const turn = (there && Math.hypot(...there) > 0 ? angleBetween(force, there) : 0) - 1e-3 * Math.hypot(...off);
        if (turn > widest)
          [found, widest] = [place, turn];
      }
      if (found)
        return found.map((place, a) => this.alike(a) ? middle[a] : place);
    }
    return middle;
  }

  nearest(axis, position) {
    const index = Math.round((position - this.first[axis]) / this.pitch[axis]);
    return Math.min(Math.max(index, 0), this.size[axis] - 1);
  }

  place(index) {
    const [nx, ny] = this.about.size;
    return index[0] + nx * ((this.alike(1) ? 0 : index[1]) + ny * index[2]);
  }

  sample(index) {
    const i = this.place(index);
    return this.components.map((values) => values[i]);
  }

  // How far a sample is from the shape of [compare], "angle" in deg or "error" in N; null where neither is touched, and
  // deeper than compare.depth.
  comparedSample(index, name) {
    const value = this.compared ? this.compared[name][this.place(index)] : NaN;
    return Number.isNaN(value) ? null : value;
  }

  // Every sample of a slice through `visit`.
  eachInSlice(plane, index, visit) {
    const at = [index, index, index];
    for (let row = 0; row < this.size[plane[1]]; ++row)
      for (let column = 0; column < this.size[plane[0]]; ++column) {
        at[plane[0]] = column;
        at[plane[1]] = row;
        visit(at, row, column);
      }
  }

  // The samples around a place, [index, weight] each; null outside of the grid.
  around(point) {
    const low = [0, 0, 0], part = [0, 0, 0];
    for (let a = 0; a < 3; ++a) {
      const t = (point[a] - this.first[a]) / this.pitch[a];
      if (!this.has(a, point[a]))
        return null;
      const inside = Math.min(Math.max(t, 0), this.size[a] - 1);
      low[a] = Math.min(Math.floor(inside), Math.max(this.size[a] - 2, 0));
      part[a] = inside - low[a];
    }
    return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => {
      let weight = 1;
      const index = low.map((i, a) => {
        const up = (corner >> a) & 1;
        weight *= up ? part[a] : 1 - part[a];
        return i + up;
      });
      return [index, weight];
    }).filter(([, weight]) => weight > 0);
  }

  // Between samples magnitude and direction are linear, each by itself: what shading keeps, a stroke shows. Null outside
  // of the grid.
  force(point) {
    const sum = [0, 0, 0], around = this.around(point);
    let size = 0;
    for (const [index, weight] of around || []) {
      const force = this.sample(index), own = length(force);
      size += weight * own;
      if (own > 0)
        force.forEach((value, c) => { sum[c] += weight * value / own; });
    }
    const whole = length(sum);
    return !around ? null : whole > 0 ? sum.map((value) => value / whole * size) : sum;
  }

  // Between samples linear; null where one of them has none.
  comparedAt(point, name) {
    const values = (this.around(point) || []).map(([index, weight]) => [this.comparedSample(index, name), weight]);
    return !values.length || values.some(([value]) => value === null) ? null : d3.sum(values, ([value, weight]) => value * weight);
  }
}

const volumes = new Map();

async function unpackVolume(about, part) {
  const compared = about.compared ? {} : null;
  for (const name of compared ? COMPARED : [])
    [compared[name]] = components(await part(name), about.size[0], about.compared[name], 1);
  return new Volume(about, await part("volume"), compared);
}

// Of the i-th case, unpacked once.
function volume(cases, i) {
  if (!volumes.has(i))
    volumes.set(i, unpackVolume(cases[i], (name) => inflate(document.getElementById(name + "-" + i).textContent)));
  return volumes.get(i);
}

// Some paths of the i-th case, {steps, paths, rate_Hz, force, position, proxy}, these each three components; null where
// the case has none.
async function paths(cases, i) {
  const about = cases[i].paths;
  if (!about)
    return null;
  const [steps, count] = about.size, all = { steps, count, rate: about.rate_Hz };
  for (const name of Object.keys(about.scale))
    all[name] = components(await inflate(document.getElementById("path-" + name + "-" + i).textContent), steps, about.scale[name]);
  for (const name of ["position", "proxy"])
    if (about.origin_m && all[name]) // places are measured from there
      all[name] = all[name].map((values, axis) => Float64Array.from(values, (value) => about.origin_m[axis] + value));
  return all;
}

// Along which axis two volumes lie apart; undefined if they have common places.
function apart(a, b) {
  return [0, 1, 2].find((axis) => {
    const [one, other] = [a.edges(axis), b.edges(axis)];
    return !a.alike(axis) && !b.alike(axis) && (one[1] < other[0] || other[1] < one[0]);
  });
}

// The slice's axes: what is drawn to the right and upwards.
function slicePlane(axis) {
  return axis === 0 ? [1, 2] : axis === 1 ? [0, 2] : [0, 1];
}

const DEGREES = 180 / Math.PI;
const length = (f) => Math.hypot(f[0], f[1], f[2]);
const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

// deg from the slice's upward axis towards its rightward one; null where no force lies in the slice.
function direction(f, plane) {
  const u = f[plane[0]], v = f[plane[1]];
  return u === 0 && v === 0 ? null : Math.atan2(u, v) * DEGREES;
}

// deg between two forces; null where one is zero.
function angleBetween(a, b) {
  if (length(a) === 0 || length(b) === 0)
    return null;
  const cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  return Math.atan2(length(cross), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * DEGREES;
}
