// Studies: what each found, its figures, its tables on demand, and "my device" among them.

const MOST_ON_PAPER = 200; // rows of a table

function tableElement(table) {
  const details = document.createElement("details"), rows = table.rows.length;
  details.append(Object.assign(document.createElement("summary"), { textContent: (table.title || table.name) + ` (${rows} row${rows === 1 ? "" : "s"})` }));
  const fill = () => {
    if (details.querySelector("table"))
      return;
    const box = d3.select(details).append("div").attr("class", "wide").attr("tabindex", 0).attr("role", "region").attr("aria-label", table.title);
    const whole = box.append("table"), number = (column) => column.unit !== "";
    whole.append("thead").append("tr").selectAll("th").data(table.columns).enter().append("th").attr("scope", "col").attr("title", (c) => c.meaning)
      .classed("n", number).html("").each(function (column) {
        this.append(column.name);
        if (column.unit && column.unit !== "1")
          this.append(Object.assign(document.createElement("small"), { textContent: column.unit }));
      });
    whole.append("tbody").selectAll("tr").data(table.rows).enter().append("tr").selectAll("td").data((row) => row).enter().append("td")
      .classed("n", (_, i) => number(table.columns[i])).text((cell) => cell === null ? "–" : typeof cell !== "number" ? cell : Number.isInteger(cell) && Math.abs(cell) < 1e15 ? String(cell).replace("-", "−") : numberText(cell, 5));
  };
  details.addEventListener("toggle", () => details.open && fill());
  addEventListener("beforeprint", () => rows <= MOST_ON_PAPER && fill());
  return details;
}

// Tables come by columns, those of few different cells as these and whereabouts they are.
function unpacked(study) {
  study.tables.forEach((table) => {
    table.rows = d3.transpose(table.cells.map((cells) => cells.of ? cells.at.map((i) => cells.of[i]) : cells));
  });
  return study;
}

function startStudies() {
  document.querySelectorAll("script.study").forEach((script) => {
    const study = unpacked(JSON.parse(script.textContent)), element = (name, ...path) => document.getElementById(script.id + name);
    const linked = study.figures.flatMap((figure) => figure.linked);
    study.figures.filter((figure) => !linked.includes(figure.name))
      .forEach((figure, i) => linkFigures(element(i === 0 ? "-hero" : "-figures").appendChild(document.createElement("figure")), study, figure));
    const glance = element("-glance"), shown = glance && (study.figures.find((one) => one.name === glance.dataset.figure) || study.figures[0]);
    if (shown)
      drawFigure(glance, study, { ...shown, height: 300, picks: [] }, true);
    study.tables.forEach((table) => element("-tables").append(tableElement(table)));
  });
  document.documentElement.dataset.figures = "ready";
}

startStudies();

// "My device": the stable stiffness of a sampled wall for the sliders' numbers, and its place in the diagrams of stability.

// `low` to `high` in steps of the logarithm, or of 1; `factor` times the number shown is SI.
const DEVICE = {
  mass: { label: "mass m", unit: "kg", low: 0.01, high: 2, value: 0.1, factor: 1 },
  damping: { label: "damping b", unit: "N s/m", low: 0.05, high: 50, value: 1, factor: 1 },
  grip: { label: "damping of the grip", unit: "N s/m", low: 0, high: 20, step: 0.1, value: 2, factor: 1 },
  spring: { label: "spring of the grip", unit: "N/m", low: 20, high: 5000, value: 500, factor: 1 },
  period: { label: "period T", unit: "ms", low: 0.1, high: 10, value: 1, factor: 1e-3 },
  delay: { label: "delay", unit: "samples", low: 0, high: 5, step: 1, value: 0, factor: 1 },
  radius: { label: "radius of what is pressed", unit: "mm", low: 1, high: 1000, value: 15.24, factor: 1e-3 },
  slope: { label: "its slope there", unit: "deg", low: 0, high: 85, step: 0.01, value: 56.44, factor: Math.PI / 180 },
  depth: { label: "depth", unit: "mm", low: 0.05, high: 10, value: 2, factor: 1e-3 },
  stiffness: { label: "stiffness K", unit: "N/m", low: 10, high: 1e5, value: 1000, factor: 1 },
};

// N/m: K at which a mass with damping on a wall, its force sampled, held and `delay` samples late, just does not come to
// rest. With z = exp(i t) on the unit circle, 1 + K z^-delay (p z + s) / ((z - 1) (z - A)) = 0 has a positive root K at the
// least stiffness that any t gives; q, p, r as in x' = x + q v + p F, v' = A v + r F, and s = q r - p A.
function criticalStiffness(mass, damping, period, delay) {
  const lost = -Math.expm1(-damping * period / mass), kept = 1 - lost;
  const q = mass / damping * lost, p = (period - q) / damping, s = q * lost / damping - p * kept;
  const root = (t) => {
    const [c, d] = [Math.cos(t), Math.sin(t)], times = ([a, b], [x, y]) => [a * x - b * y, a * y + b * x];
    const above = times(times([c - 1, d], [c - kept, d]), [Math.cos(delay * t), Math.sin(delay * t)]), below = [p * c + s, p * d];
    const size = below[0] ** 2 + below[1] ** 2, [re, im] = times(above, [below[0], -below[1]]);
    return [-re / size, -im / size];
  };
  const steps = 4000, at = (i) => Math.PI * 10 ** (6 * (i / steps - 1));
  let least = Math.max(root(Math.PI)[0], 0) || Infinity; // of opposite sign from sample to sample
  for (let i = 0; i < steps; ++i) {
    let [low, high] = [at(i), at(i + 1)];
    if (root(low)[1] > 0 === root(high)[1] > 0 || i + 1 === steps && Math.abs(root(high)[1]) < 1e-9 * Math.abs(root(high)[0]))
      continue;
    for (let halving = 0; halving < 60; ++halving) {
      const middle = (low + high) / 2;
      [low, high] = root(low)[1] > 0 === root(middle)[1] > 0 ? [middle, high] : [low, middle];
    }
    const stiffness = root(low)[0];
    if (stiffness > 0)
      least = Math.min(least, stiffness);
  }
  return least;
}

// N/m: below it the wall gives no energy whatever holds it, so that no hand's damping counts (Colgate & Schenkel).
function passiveStiffness(damping, period, delay) {
  return damping / (period * (0.5 + delay));
}

// N/m: above it the grip's spring does not hold a probe that is pressed onto a shaded cylinder: the force K depth turns
// faster with x than the spring pulls back, K depth R / (R^2 - x^2) = spring. Neither damping nor rate helps.
function heldStiffness(spring, radius, slope, depth) {
  return spring * radius * Math.cos(slope) ** 2 / depth;
}

// An axis of a hand over a period in which a force holds: place and speed after it, of place, speed and force (newtons).
function axisMap(mass, damping, spring, period) {
  const a = damping / 2 / mass, square = spring / mass - a * a, w = Math.sqrt(Math.abs(square)), e = Math.exp(-a * period);
  if (!(spring > 0)) {
    const lost = -Math.expm1(-damping * period / mass), q = mass / damping * lost;
    return { xx: 1, xv: q, xf: (period - q) / damping, vx: 0, vv: 1 - lost, vf: lost / damping };
  }
  const t = w * period, c = square > 0 ? Math.cos(t) : Math.cosh(t), s = w > 0 ? (square > 0 ? Math.sin(t) : Math.sinh(t)) / w : period;
  const xx = e * (c + a * s);
  return { xx, xv: e * s, xf: (1 - xx) / spring, vx: -e * s * spring / mass, vv: e * (c - a * s), vf: e * s / mass };
}

// A loop near a place where a probe rests, linearised: whether it grows at a stiffness, N/m. `along`: the direction in
// which the hand presses, its spring acts across; on all sides if it is 0. `slope`: -dF/dp for 1 N/m, columns first.
class RestingLoop {
  constructor({ mass, damping, grip, spring, period, delay }, { along, slope }) {
    const pressed = along.some((one) => one !== 0), unit = (v) => v.map((one) => one / Math.hypot(...v));
    const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    if (pressed) {
      const first = unit(cross(along, Math.abs(along[0]) < 0.5 ? [1, 0, 0] : [0, 1, 0]));
      axes = [first, cross(along, first), along];
    }
    const times = (v) => [0, 1, 2].map((i) => slope[i] * v[0] + slope[3 + i] * v[1] + slope[6 + i] * v[2]);
    const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    this.pull = axes.map((to) => axes.map((from) => -dot(to, times(from)))); // m of force over K for a metre of place
    this.maps = [0, 1, 2].map((i) => axisMap(mass, damping + grip, i === 2 && pressed ? 0 : spring, period));
    this.unit = mass / period / period, this.period = period, this.delay = delay;
  }

  // Rows of (places, speeds times the period, forces under way over mass / period^2).
  matrix(stiffness) {
    const { pull, maps, unit, period, delay } = this, size = 6 + 3 * delay, map = new Float64Array(size * size);
    const answer = (row, factor, i) => pull[i].forEach((one, j) => map[row * size + j] += factor * stiffness / unit * one);
    maps.forEach(({ xx, xv, xf, vx, vv, vf }, i) => {
      map[i * size + i] = xx, map[i * size + 3 + i] = xv / period;
      map[(3 + i) * size + i] = vx * period, map[(3 + i) * size + 3 + i] = vv;
      for (const [row, factor] of [[i, unit * xf], [3 + i, period * unit * vf]])
        if (delay === 0)
          answer(row, factor, i);
        else
          map[row * size + 6 + i] += factor;
      for (let age = 0; age + 1 < delay; ++age)
        map[(6 + 3 * age + i) * size + 9 + 3 * age + i] = 1;
      if (delay > 0)
        answer(6 + 3 * (delay - 1) + i, 1, i);
    });
    return map;
  }

  // By powers: none grows if one has a norm below 1, and if the trace of one is larger than its rows are many some do.
  grows(stiffness) {
    const size = 6 + 3 * this.delay;
    let map = this.matrix(stiffness), norm = 0;
    for (let squaring = 0; squaring < 26; ++squaring) {
      let trace = norm = 0;
      const square = new Float64Array(size * size);
      for (let i = 0; i < size; ++i) {
        let sum = 0;
        for (let j = 0; j < size; ++j) {
          const one = map[i * size + j];
          sum += Math.abs(one);
          if (one !== 0)
            for (let k = 0; k < size; ++k)
              square[i * size + k] += one * map[j * size + k];
        }
        norm = Math.max(norm, sum), trace += map[i * size + i];
      }
      if (2 * norm < 1 || !(Math.abs(trace) <= 2 * size))
        return !(2 * norm < 1);
      map = square;
    }
    return norm > 1;
  }
}

// The place of the least stiffness, N/m, at which a hand's loop grows, up to `most`; it has that as `limit`.
function weakest(hand, places, most) {
  let least = null, below = most;
  for (const place of places) {
    const loop = new RestingLoop(hand, place);
    if (!loop.grows(below))
      continue;
    let low = 1e-4 * below, high = low;
    while (!loop.grows(high) && high < below)
      [low, high] = [high, Math.min(1.15 * high, below)];
    while (high > 1.0002 * low) {
      const middle = Math.sqrt(low * high);
      [low, high] = loop.grows(middle) ? [low, middle] : [middle, high];
    }
    below = high, least = { ...place, limit: high };
  }
  return least;
}

class Device {
  constructor(element, { loop, weak, scene }) {
    this.scene = scene;
    this.unknown = !weak; // the scene's surface: its file was not there
    this.weak = weak || [];
    this.element = d3.select(element);
    const form = this.element.append("form").attr("class", "controls").attr("autocomplete", "off").on("submit", () => d3.event.preventDefault());
    this.values = {};
    for (const [name, one] of Object.entries(DEVICE)) {
      if (this.scene && ["radius", "slope", "depth"].includes(name))
        continue; // the scene has them
      const start = loop && Number.isFinite(loop[name]) ? loop[name] / one.factor : one.value;
      const label = form.append("label").text(one.label + " "), output = label.append("output").attr("for", "device-" + name);
      const [to, from] = one.step ? [(v) => v, (v) => v] : [Math.log10, (v) => 10 ** v];
      label.append("input").attr("type", "range").attr("id", "device-" + name).attr("min", to(one.low)).attr("max", to(one.high))
        .attr("step", one.step || "any").property("value", to(Math.min(Math.max(start, one.low), one.high)))
        .on("input", (_, i, nodes) => { this.take(name, from(Number(nodes[i].value)), output); this.draw(); });
      this.take(name, Math.min(Math.max(start, one.low), one.high), output);
    }
    this.verdict = this.element.append("p").attr("id", "device-verdict").attr("role", "status");
    this.table = this.element.append("div").attr("class", "readout").append("table").attr("id", "device-limits");
    this.table.append("thead").append("tr").selectAll("th")
      .data(["stable below", "held as usual, N/m", "pressed anyhow, N/m", "K is of the lower", "where it gives way"]).enter().append("th")
      .attr("scope", "col").classed("n", (_, i) => i > 0 && i < 4).text((word) => word);
    this.table.append("tbody");
    this.element.append("p").attr("class", "note").attr("id", "device-note");
    this.draw();
    window.addEventListener("resize", () => this.mark());
  }

  take(name, value, output) {
    this.values[name] = value * DEVICE[name].factor;
    output.text(numberText(value, 3) + " " + DEVICE[name].unit);
  }

  draw() {
    const { mass, damping, grip, spring, period, delay, radius, slope, depth, stiffness } = this.values, b = damping + grip;
    const late = (samples) => samples === 0 ? "at once" : samples === 1 ? "one sample late" : samples + " samples late";
    const passive = passiveStiffness(damping, period, delay), critical = criticalStiffness(mass, b, period, delay);
    const cylinder = this.scene ? Infinity : heldStiffness(spring, radius, slope, depth), most = 8 * passiveStiffness(b, period, delay);
    const surfaces = [...new Set(this.weak.map((one) => one.surface))].map((name) => {
      const places = this.weak.filter((one) => one.surface === name), usual = weakest(this.values, places.filter((one) => one.usual), most);
      const pressed = usual && weakest(this.values, places, 0.99 * usual.limit);
      return { name, usual, pressed, least: pressed || usual };
    });
    const where = (one) => one.place + ", " + numberText(1e3 * one.depth_m, 2) + " mm deep, " + (one.usual ? "held " : "pressed ") + one.held;
    const row = (words, usual, pressed, place) =>
      [words, numberText(usual, 4), pressed ? numberText(pressed, 4) : "", numberText(100 * stiffness / (pressed || usual), 3) + " %", place];
    const rows = [...[...new Set([0, 1, delay])].map((samples) => row("a wall; force " + late(samples), criticalStiffness(mass, b, period, samples), 0, "")),
      row("a wall, whatever holds the device (passive); force " + late(delay), passive, 0, ""),
      ...(this.scene ? [] : [row("a shaded cylinder of that radius, slope and depth", cylinder, 0, "the grip's spring gives way")]),
      ...surfaces.map(({ name, usual, pressed, least }) =>
        usual ? row(name, usual.limit, pressed && pressed.limit, where(least)) : [name, "none found", "", "", ""])];
    const cells = this.table.select("tbody").selectAll("tr").data(rows).join("tr").selectAll("td").data((one) => one).join("td");
    cells.classed("n", (_, i) => i > 0 && i < 4).text((text) => text);
    const limit = (one) => (one.usual ? "held " : "pressed ") + one.held + ", it is stable below " + numberText(one.limit, 4) + " N/m, which is "
      + numberText(one.limit * one.depth_m, 2) + " N " + numberText(1e3 * one.depth_m, 2) + " mm deep";
    const limited = surfaces.filter((one) => one.least), unstable = limited.filter((one) => stiffness >= one.least.limit);
    const worst = limited.reduce((low, one) => low && low.least.limit <= one.least.limit ? low : one, null);
    this.verdict.text(numberText(stiffness, 3) + " N/m on a wall is " + (stiffness >= critical ? "unstable: it is stable below "
      : stiffness > passive ? "stable, though not with any hand (passive, below " + numberText(passive, 4) + " N/m): this one is below "
        : "stable with any hand (passive, below " + numberText(passive, 4) + " N/m), with this one below ") + numberText(critical, 4) + " N/m. " + (worst
        ? (surfaces.length === 1 ? (unstable.length ? "Unstable" : "Stable") + " on " + worst.name
          : (unstable.length ? "Unstable on " + unstable.length : "Stable on all") + " of " + surfaces.length + " surfaces; the lowest limit is that on " + worst.name)
          + ": " + limit(worst.least) + "."
        : this.unknown ? "The limits of the scene's surface are not here: its file was not found when this page was made. forceshade study stability SCENE has them."
          : this.scene ? "On the scene's surface no lower limit was found."
          : "On the shaded cylinder the grip " + (stiffness < cylinder ? "holds the probe up to " : "does not hold the probe: it does so up to ") + numberText(cylinder, 4) + " N/m."));
    this.mark();
  }

  // A cross in every diagram over stiffness and damping; none where it would be outside.
  mark() {
    const at = { stiffness_N_per_m: this.values.stiffness, damping_N_s_per_m: this.values.damping + this.values.grip };
    let maps = 0, marked = 0;
    document.querySelectorAll("svg.plot g").forEach((body) => {
      const { x, y, columns } = body.place || { columns: [] };
      if (!columns.length || !columns.every((name) => name in at))
        return;
      ++maps;
      const within = [x, y].every((scale, i) => at[columns[i]] >= scale.domain()[0] && at[columns[i]] <= scale.domain()[scale.domain().length - 1]);
      const place = within ? [x(at[columns[0]]), y(at[columns[1]])] : null;
      marked += within;
      d3.select(body).selectAll(".device").data(place ? [0, 1] : []).join("path").attr("class", "device").attr("d", place && `M${place[0] - 9},${place[1]}h18m-9,-9v18`);
    });
    d3.select("#device-note").text("Wall: a mass with damping on a plane, its force held from sample to sample; the grip adds its damping. " + (this.weak.length
      ? "On a surface: the linearised loop at the places where it gives way first, away from jumps of the direction, for the sliders' hand" + (this.scene ? "; of several scenes the first with shading and the first without. " : ". Pressed: in any direction that the surface supports, not only straight down or against its force. ") : "") + (this.scene
      ? "The sliders begin with the scene's hand."
      : "Shaded cylinder: the force turns as the probe slips aside, and the grip's spring alone pulls it back; damping and rate do not matter. The sliders begin with the default hand, at the rim of the paper's bump.") +
      (maps ? ` A cross marks it on ${maps > 1 ? marked + " of " + maps + " diagrams" : marked ? "the diagram" : "no diagram"} over stiffness and damping, drawn for a mass and a rate that may be others.` : ""));
  }
}

function startDevice() {
  const data = document.getElementById("device-data");
  if (data)
    new Device(data.parentElement, JSON.parse(data.textContent));
}

startDevice();
