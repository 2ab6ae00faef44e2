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

// "My device": the stable stiffness of a sampled wall for the sliders' numbers, and its place on the maps of stability.

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

class Device {
  constructor(element, loop) {
    this.element = d3.select(element);
    const form = this.element.append("form").attr("class", "controls").attr("autocomplete", "off").on("submit", () => d3.event.preventDefault());
    this.values = {};
    for (const [name, one] of Object.entries(DEVICE)) {
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
    this.table.append("thead").append("tr").selectAll("th").data(["limit of K", "N/m", "K is of it"]).enter().append("th").attr("scope", "col")
      .classed("n", (_, i) => i > 0).text((word) => word);
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
    const rows = [...new Set([0, 1, delay])].map((samples) => ["a wall comes to rest below; force " + late(samples), criticalStiffness(mass, b, period, samples)]);
    rows.push(["the grip's spring holds a probe on that shaded cylinder below", heldStiffness(spring, radius, slope, depth)]);
    rows.push(["a wall is passive with any hand below (the device's own damping alone); force " + late(delay), passiveStiffness(damping, period, delay)]);
    const cells = this.table.select("tbody").selectAll("tr").data(rows).join("tr").selectAll("td")
      .data(([words, limit]) => [words, numberText(limit, 4), numberText(100 * stiffness / limit, 3) + " %"]).join("td");
    cells.classed("n", (_, i) => i > 0).text((text) => text);
    const critical = criticalStiffness(mass, b, period, delay), passive = passiveStiffness(damping, period, delay), held = heldStiffness(spring, radius, slope, depth);
    this.verdict.text(numberText(stiffness, 3) + " N/m on a wall " + (stiffness >= critical ? "does not come to rest: it is above"
      : stiffness > passive ? "comes to rest, but is not passive: it is below" : "is passive (below " + numberText(passive, 4) + " N/m) and comes to rest: it is below") + " the limit of " + numberText(critical, 4) + " N/m. On the shaded cylinder the grip "
      + (stiffness < held ? "holds the probe up to " : "does not hold the probe: it does so up to ") + numberText(held, 4) + " N/m.");
    this.mark();
  }

  // A cross on every map over stiffness and damping; none where it would be outside.
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
    d3.select("#device-note").text("Wall: a mass with damping on a plane, its force held from sample to sample; the grip adds its damping. Shaded cylinder: the force turns as the probe slips aside, and the grip's spring alone pulls it back; damping and rate do not matter. The sliders begin with the hand of the scene in the viewer, else with the default one, and at the rim of the paper's bump." +
      (maps ? ` A cross marks it on ${marked} of ${maps} map${maps === 1 ? "" : "s"} over stiffness and damping, whose mass and rate are their own.` : ""));
  }
}

function startDevice() {
  const section = document.getElementById("device"), volumes = document.getElementById("volumes");
  if (section)
    new Device(section, volumes && JSON.parse(volumes.textContent).cases.map((one) => one.loop).find((loop) => loop));
}

startDevice();
