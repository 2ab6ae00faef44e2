// The viewer: two cases, a slice, a cursor, a stroke; how it is moved and started.

const byId = (id) => document.getElementById(id);
const PROFILE_SAMPLES = 300, HANDLE = 14; // px about an end of the stroke that take hold of it

// Words that are read aloud when they change.
function say(id, words) {
  if (byId(id).textContent !== words)
    byId(id).textContent = words;
}

class Viewer {
  constructor(about) {
    this.cases = about.cases;
    this.surfaces = about.surfaces;
    this.tables = { sequential: colourTable(d3.interpolateViridis), second: colourTable(d3.interpolatePlasma), diverging: colourTable((t) => d3.interpolateRdBu(1 - t)),
      cyclic: colourTable(d3.interpolateRainbow) };
    this.state = { quantity: "direction", arrows: true, axis: 1, point: null, strokes: [null, null, null], follows: true, depth: 1e-3 };
    this.panes = { a: new Pane(byId("pane-a")), b: new Pane(byId("pane-b")), d: new Pane(byId("pane-d")) };
    this.space = new Space(this);
  }

  async start() {
    const [a, b] = this.firstPair();
    for (const [id, chosen] of [["case-a", a], ["case-b", b]]) {
      this.cases.forEach((one, i) => byId(id).add(new Option(one.name, i, i === chosen, i === chosen)));
      byId(id).addEventListener("change", () => this.load().catch((error) => { byId("viewer-status").textContent = error.message; }));
    }
    byId("case-b").parentElement.hidden = this.cases.length === 1;
    if (!this.cases.some((one) => one.compared))
      document.querySelectorAll(".compared, #quantity option").forEach((one) => (one.className || COMPARED.includes(one.value)) && one.remove());
    byId("axis-" + AXES[this.state.axis]).checked = true;
    await this.load();
    this.listen();
  }

  // One shape without shading and with, if possible; else two cases that differ in shading alone. Of several pairs that
  // whose directions err most differently.
  firstPair() {
    const plain = (one) => one.name.replace(/_?shading-(none|reference|height_map|morgenbesser|barycentric|two_pass|mean_value)/, ""), bare = (one) => /shading-none/.test(one.name);
    const apart = (a, b) => Math.abs((a.error_deg || 0) - (b.error_deg || 0));
    for (const wanted of [(a, b) => bare(a) && !bare(b), () => true]) {
      let best = null, most = -1;
      for (let i = 0; i < this.cases.length; ++i)
        for (let k = 0; k < this.cases.length; ++k) {
          const [a, b] = [this.cases[i], this.cases[k]];
          if (i !== k && plain(a) === plain(b) && wanted(a, b) && apart(a, b) > most)
            [best, most] = [[i, k], apart(a, b)];
        }
      if (best)
        return best;
    }
    return [0, Math.min(1, this.cases.length - 1)];
  }

  async load() {
    const chosen = ["case-a", "case-b"].map((id) => Number(byId(id).value));
    const [a, b] = await Promise.all(chosen.map((i) => volume(this.cases, i)));
    if (chosen[0] !== Number(byId("case-a").value) || chosen[1] !== Number(byId("case-b").value))
      return; // another choice was made meanwhile
    this.a = b.alike(1) ? a : a.spread(b);
    this.b = b.spread(this.a);
    if (!this.state.point)
      this.state.point = this.a.typical(this.b);
    this.settle();
    byId("viewer-status").textContent = "";
    byId("viewer-body").hidden = false;
    this.draw();
    await this.space.load();
  }

  // The cursor to A's nearest sample where it lies outside of A or A has but one, and always across the slice. Strokes
  // that leave A are made anew.
  settle() {
    const { axis, point, strokes } = this.state, { a } = this;
    for (const one of [0, 1, 2])
      if (one === axis || a.size[one] === 1 || !a.within(one, point[one]))
        point[one] = a.position(one, a.nearest(one, point[one]));
    strokes.forEach((ends, across) => {
      const plane = slicePlane(across);
      if (ends && !ends.every((end) => end.every((value, c) => a.within(plane[c], value))))
        strokes[across] = null;
    });
  }

  get plane() {
    return slicePlane(this.state.axis);
  }

  // Ends of the stroke in the slice's plane (m), kept for each axis.
  get stroke() {
    const { strokes, axis } = this.state;
    if (!strokes[axis]) {
      const middle = this.state.point, along = this.a.size[this.plane[0]] > 1 ? 0 : 1, [low, high] = this.a.edges(this.plane[along]);
      strokes[axis] = [0.12, 0.88].map((part) => this.plane.map((one, c) => c === along ? low + part * (high - low) : middle[one]));
    }
    return strokes[axis];
  }

  // Where it leads, in the slice's plane (m): along A's surface at a depth where that is known and asked for, else straight.
  get strokeLine() {
    const { stroke } = this, height = this.state.follows ? this.surfaceOfSlice() : null;
    return d3.range(PROFILE_SAMPLES + 1).map((i) => {
      const [u, v] = stroke[0].map((from, c) => from + i / PROFILE_SAMPLES * (stroke[1][c] - from));
      return [u, height ? height(u) - this.state.depth : v];
    });
  }

  // The height of A's surface, z over x (m), in a slice across y; null where the page does not have it.
  surfaceOfSlice() {
    const { about } = this.a, { axis, point } = this.state, { nominal } = about.surface === undefined ? {} : this.surfaces[about.surface];
    if (axis !== 1 || !nominal)
      return null;
    const share = (point[1] - about.origin_m[1]) / Math.max(about.spacing_m[1] * (about.full[1] - 1), Number.MIN_VALUE);
    const row = nominal.z[Math.round(Math.min(Math.max(share, 0), 1) * (nominal.z.length - 1))];
    const height = d3.scaleLinear(nominal.x, row).clamp(true);
    return (x) => nominal.unit_m * height(x / nominal.unit_m);
  }

  // True where errors against [compare] are shown, and not forces.
  get showsErrors() {
    return COMPARED.includes(this.state.quantity);
  }

  value(volume_, at) {
    const { quantity } = this.state, f = volume_.sample(at);
    if (this.showsErrors)
      return volume_.comparedSample(at, quantity);
    if (quantity === "magnitude")
      return length(f) === 0 ? null : length(f);
    if (quantity === "direction")
      return direction(f, this.plane);
    return length(f) === 0 ? null : f[AXES.indexOf(quantity)];
  }

  // What A and B have where A has its samples, of the slice; empty where B has nothing.
  pairs(index, sample, between) {
    const { a, b } = this, pairs = [];
    const alike = [0, 1, 2].every((axis) => a.size[axis] === b.size[axis] && a.first[axis] === b.first[axis] && a.pitch[axis] === b.pitch[axis]);
    a.eachInSlice(this.plane, index, (at) => {
      const other = alike ? sample(b, at) : between(b, [0, 1, 2].map((axis) => a.position(axis, at[axis])));
      pairs.push(other === null ? null : [sample(a, at), other]);
    });
    return (at) => pairs[at[this.plane[0]] + a.size[this.plane[0]] * at[this.plane[1]]];
  }

  differenceValue(pair) {
    const { quantity } = this.state;
    if (this.showsErrors)
      return !pair || pair[0] === null || pair[1] === pair[0] ? null : pair[1] - pair[0];
    if (!pair || quantity === "direction")
      return pair ? angleBetween(...pair) : null;
    const change = less(pair[1], pair[0]);
    const value = quantity === "magnitude" ? length(change) : change[AXES.indexOf(quantity)];
    return value === 0 ? null : value;
  }

  sharedScale(indexA, indexB) {
    const { quantity } = this.state, { sequential, diverging } = this.tables, size = Math.max(this.a.largest, this.b.largest) || 1;
    const largest = (value) => { // of both slices
      let most = 0;
      for (const [one, index] of [[this.a, indexA], [this.b, indexB]])
        one.eachInSlice(this.plane, index, (at) => { most = Math.max(most, Math.abs(value(one, at) || 0)); });
      return most;
    };
    if (quantity === "magnitude")
      return new ColourScale(sequential, 0, size, "force magnitude / N");
    if (this.showsErrors) {
      const most = largest((one, at) => one.comparedSample(at, quantity));
      return quantity === "angle" ? new ColourScale(this.tables.second, 0, Math.max(most, 0.2), "angle between force and normal of the shape of [compare] / deg")
        : new ColourScale(diverging, -(most || 1), most || 1, "|F| less K times the depth below the shape of [compare] / N");
    }
    if (quantity !== "direction")
      return new ColourScale(diverging, -size, size, "force along " + quantity + " / N");
    // Within a quarter turn of the upward axis the sign is what one looks for; beyond it the colours go round, too.
    const most = Math.max(1, largest((one, at) => direction(one.sample(at), this.plane)));
    return most > 90 ? new ColourScale(this.tables.cyclic, -180, 180, this.directionLabel())
      : new ColourScale(diverging, -most, most, this.directionLabel());
  }

  directionLabel() {
    const [right, up] = this.plane.map((a) => AXES[a]);
    return "direction / deg, from +" + up + " towards +" + right;
  }

  differenceScale(pair, index) {
    let most = 0;
    this.a.eachInSlice(this.plane, index, (at) => {
      const value = this.differenceValue(pair(at));
      if (value !== null && Number.isFinite(value))
        most = Math.max(most, Math.abs(value));
    });
    const { quantity } = this.state, { sequential, second, diverging } = this.tables;
    if (quantity === "direction")
      most = Math.max(most, 0.2); // less is the page's rounding
    const label = { magnitude: "size of the difference of forces / N", direction: "angle between the forces / deg", angle: "difference of the direction errors / deg",
      error: "difference of the force errors / N" }[quantity] ||
      "difference along " + quantity + " / N";
    return quantity === "magnitude" || quantity === "direction" ? new ColourScale(quantity === "direction" ? second : sequential, 0, most || 1, label)
      : new ColourScale(diverging, -(most || 1), most || 1, label);
  }

  draw() {
    const { axis, point, quantity, arrows } = this.state, { a, b, plane } = this;
    const indexA = a.nearest(axis, point[axis]), indexB = b.nearest(axis, point[axis]), forces = this.pairs(indexA, (one, at) => one.sample(at), (one, point_) => one.force(point_));
    const pair = this.showsErrors ? this.pairs(indexA, (one, at) => one.comparedSample(at, quantity), (one, point_) => one.comparedAt(point_, quantity)) : forces;
    const scale = this.scale = this.sharedScale(indexA, indexB), differenceScale = this.differenceScale(pair, indexA);
    const shared = { plane, arrows, stroke: () => this.strokeLine, cursor: () => plane.map((one) => point[one]) };
    for (const [pane, volume_, index] of [[this.panes.a, a, indexA], [this.panes.b, b, indexB]])
      pane.show({ ...shared, volume: volume_, index, scale, cell: (at) => this.value(volume_, at), force: (at) => volume_.sample(at),
        arrowScale: Math.max(a.largest, b.largest), equalArrows: quantity === "direction" });
    const change = (at) => forces(at) && less(forces(at)[1], forces(at)[0]);
    let largest = 0;
    a.eachInSlice(plane, indexA, (at) => { largest = Math.max(largest, length(change(at) || [0, 0, 0]) || 0); });
    this.panes.d.show({ ...shared, volume: a, index: indexA, scale: differenceScale, cell: (at) => this.differenceValue(pair(at)), force: change,
      arrowScale: largest, equalArrows: false });
    scale.draw(byId("scale"));
    differenceScale.draw(byId("scale-d"));
    byId("scale-d").style.visibility = this.panes.d.blank ? "hidden" : "";
    this.drawTitles(indexA, indexB);
    this.drawNotes(indexA);
    this.drawReadout();
    this.drawStroke();
    this.space.draw();
  }

  // Only the cursor or the stroke moved.
  mark(strokeToo) {
    Object.values(this.panes).forEach((pane) => pane.mark());
    this.drawReadout();
    this.space.mark();
    if (strokeToo)
      this.drawStroke();
  }

  drawTitles(index, indexB) {
    const { axis } = this.state, text = byId("slice-text"), slider = byId("slice");
    const [place, placeB] = [[this.a, index], [this.b, indexB]].map(([one, i]) => AXES[axis] + " = " + numberText(1e3 * one.position(axis, i), 4) + " mm");
    for (const [name, volume_] of [["a", this.a], ["b", this.b]]) {
      const { about } = volume_, thinned = about.stride.some((s, a) => s > 1 && !volume_.alike(a));
      const link = Object.assign(document.createElement("a"), { href: about.address, textContent: about.name });
      byId("title-" + name).replaceChildren(name.toUpperCase() + ": ", link,
        thinned ? " (every " + about.stride.map((s, a) => volume_.alike(a) ? 1 : s).join("×") + ". sample)" : "",
        name === "b" && placeB !== place ? ", at " + placeB : "");
      byId("pane-" + name).setAttribute("aria-label", name.toUpperCase() + ", " + about.name + ", slice across " + AXES[axis]);
    }
    byId("pane-d").setAttribute("aria-label", "Difference of B and A, slice across " + AXES[axis]);
    slider.max = this.a.size[axis] - 1;
    slider.value = index;
    slider.disabled = byId("slice-back").disabled = byId("slice-on").disabled = this.a.size[axis] < 2;
    text.value = this.a.alike(axis) && this.b.alike(axis) ? "any y: no force depends on it"
      : place + " (" + (index + 1) + " of " + this.a.size[axis] + ")";
    slider.setAttribute("aria-valuetext", text.value);
  }

  // Why the slice has no forces to compare; empty where it has.
  whyApart(index) {
    const { a, b } = this, { axis } = this.state, whole = apart(a, b);
    if (whole !== undefined)
      return "These two cases have no common places: A has " + a.places(whole) + ", B has " + b.places(whole) + ".";
    const missed = [0, 1, 2].find((one) => {
      const indices = one === axis ? [index] : Array.from({ length: a.size[one] }, (_, i) => i);
      return !indices.some((i) => b.has(one, a.position(one, i)));
    });
    if (missed === undefined)
      return "";
    return "No sample of A in this slice is a place of B, which has " + b.places(missed) + "." +
      (a.force(b.typical(a)) ? " With A and B exchanged they can be compared." : "");
  }

  // What a picture without colours means.
  drawNotes(index) {
    const { quantity } = this.state, force = quantity === "direction" ? "No force lies in this slice." : "No force in this slice.";
    const blank = (one) => !this.showsErrors ? force : one.compared ? "No contact of at most " + numberText(one.about.compared.depth_mm, 3) + " mm in this slice." : "The scene of this case has no [compare].";
    const same = quantity === "direction" ? "Nowhere in this slice do both cases have a force."
      : this.showsErrors ? "No difference of both errors in this slice." : "No difference " + (quantity === "magnitude" ? "" : "along " + quantity + " ") + "in this slice.";
    for (const [name, words] of [["a", blank(this.a)], ["b", blank(this.b)], ["d", this.whyApart(index) || same]])
      say("note-" + name, this.panes[name].blank ? words : "");
  }

  drawReadout() {
    const { point, axis } = this.state, forces = [this.a, this.b].map((one) => one.force(point)), both = forces[0] && forces[1];
    byId("read-place").textContent = "At " + AXES.map((name, a) => name + " = " + numberText(1e3 * point[a], 4) + " mm").join(", ");
    const out = (f) => length(f) ? Math.asin(f[axis] / length(f)) * DEGREES : null;
    const errors = [this.a, this.b].map((one) => COMPARED.map((name) => one.comparedAt(point, name))), columns = document.querySelectorAll("th.compared").length;
    const row = (name, f, angles, compared) => {
      const tr = document.createElement("tr"), head = Object.assign(document.createElement("th"), { scope: "row", textContent: name });
      tr.append(head, ...[...(f ? [length(f), ...f, ...angles] : Array(6).fill(null)), ...compared.slice(0, columns)].map((value) =>
        Object.assign(document.createElement("td"), { className: "n", textContent: numberText(value, 4) })));
      return tr;
    };
    const rows = ["A", "B"].map((name, i) => row(name, forces[i], forces[i] && [direction(forces[i], this.plane), out(forces[i])], errors[i]));
    const last = row("B − A", both && less(forces[1], forces[0]), both && [angleBetween(...forces), null],
      errors[0].map((error, i) => error === null || errors[1][i] === null ? null : errors[1][i] - error));
    last.children[1].title = "length of the difference of both vectors";
    last.children[6].title = "angle between the two forces";
    byId("read-rows").replaceChildren(...rows, last);
    const missing = ["A", "B"].filter((_, i) => !forces[i]), axisApart = missing.length ? apart(this.a, this.b) : undefined;
    const froms = [...new Set([this.a, this.b].filter((one) => one.compared).map((one) => one.about.compared.from))];
    const depths = [...new Set([this.a, this.b].filter((one) => one.compared).map((one) => numberText(one.about.compared.depth_mm, 3)))];
    byId("compared-note").textContent = froms.length ? "Errors are against " + froms.join("; ") + ", of contacts at most " + depths.join(" or ") + " mm deep; the files have the deeper ones, too." : "";
    say("read-note", axisApart !== undefined ? this.whyApart() : missing.length ? missing.join(" and ") + " has no values here." : "");
  }

  drawStroke() {
    const { plane } = this, { point } = this.state, known = this.surfaceOfSlice() !== null, line = this.strokeLine;
    const distances = [], forces = { a: [], b: [] };
    let before = null;
    for (const place of line) {
      const at = [...point];
      plane.forEach((axis, c) => { at[axis] = place[c]; });
      distances.push(before ? distances[distances.length - 1] + 1e3 * Math.hypot(place[0] - before[0], place[1] - before[1]) : 0);
      before = place;
      forces.a.push(this.a.force(at));
      forces.b.push(this.b.force(at));
    }
    const why = (all, values) => all.every((f) => f === null) ? " has no values here" : values.every((value) => value === null) ? ": no force lies in the slice" : "";
    const lines = (number) => [["A", "a", "var(--plot-s0)", null], ["B", "b", "var(--plot-s1)", CURVE_DASHES[1]]].map(([name, key, colour, dash]) => {
      const values = forces[key].map((f) => f && number(f));
      return { name: name + why(forces[key], values), colour, dash, values };
    });
    drawProfile(byId("profile-size"), distances, lines(length), "|F| / N", "distance from end 1 / mm");
    drawProfile(byId("profile-direction"), distances, lines((f) => direction(f, plane)), this.directionLabel(), "distance from end 1 / mm");
    byId("stroke-follow").hidden = !known;
    document.querySelectorAll(".u-name").forEach((one) => { one.textContent = AXES[plane[0]]; });
    document.querySelectorAll(".v-name").forEach((one) => { one.textContent = AXES[plane[1]]; });
    for (const end of [0, 1])
      for (const c of [0, 1]) {
        const input = byId("stroke-" + end + "-" + c);
        input.disabled = known && this.state.follows && c === 1;
        if (document.activeElement !== input)
          input.value = (1e3 * line[end * PROFILE_SAMPLES][c]).toFixed(2);
      }
  }

  // How it is moved: by pointer, by keys, by its fields.

  moveSlice(steps) {
    const { axis, point } = this.state, index = this.a.nearest(axis, point[axis]) + steps;
    point[axis] = this.a.position(axis, Math.min(Math.max(index, 0), this.a.size[axis] - 1));
    this.draw();
  }

  moveCursor(axis, steps) {
    const { point } = this.state, [low, high] = this.a.edges(axis);
    const step = this.a.size[axis] > 1 ? this.a.pitch[axis] : this.a.about.spacing_m[axis];
    point[axis] = Math.min(Math.max(point[axis] + steps * step, low), high);
    this.mark(false);
  }

  setStroke(end, place) {
    this.stroke[end] = place.map((value, c) => {
      const [low, high] = this.a.edges(this.plane[c]);
      return Math.min(Math.max(value, low), high);
    });
    this.mark(true);
  }

  onKey(event) {
    const steps = event.shiftKey ? 10 : 1, [u, v] = this.plane, { point } = this.state;
    const moves = { ArrowLeft: () => this.moveCursor(u, -steps), ArrowRight: () => this.moveCursor(u, steps),
      ArrowDown: () => this.moveCursor(v, -steps), ArrowUp: () => this.moveCursor(v, steps),
      PageUp: () => this.moveSlice(steps), PageDown: () => this.moveSlice(-steps),
      1: () => this.setStroke(0, [point[u], point[v]]), 2: () => this.setStroke(1, [point[u], point[v]]) };
    if (moves[event.key] && !event.ctrlKey && !event.altKey && !event.metaKey) {
      moves[event.key]();
      event.preventDefault();
    }
  }

  onPointer(pane, event) {
    const box = pane.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top, place = pane.place(x, y);
    if (event.type === "pointerdown") {
      const line = this.strokeLine;
      this.held = [0, PROFILE_SAMPLES].map((i) => line[i]).findIndex((end) => Math.hypot(pane.at(end)[0] - x, pane.at(end)[1] - y) < HANDLE);
      if (this.held >= 0)
        pane.canvas.setPointerCapture(event.pointerId);
    }
    if (event.type === "pointerup" || event.type === "pointercancel")
      this.held = -1;
    this.plane.forEach((axis, c) => { this.state.point[axis] = place[c]; });
    if (this.held >= 0)
      this.setStroke(this.held, place);
    else
      this.mark(false);
  }

  listen() {
    this.held = -1;
    byId("quantity").addEventListener("change", (event) => { this.state.quantity = event.target.value; this.draw(); });
    byId("arrows").addEventListener("change", (event) => { this.state.arrows = event.target.checked; this.draw(); });
    byId("slice").addEventListener("input", (event) => this.moveSlice(event.target.value - this.a.nearest(this.state.axis, this.state.point[this.state.axis])));
    byId("slice-back").addEventListener("click", () => this.moveSlice(-1));
    byId("slice-on").addEventListener("click", () => this.moveSlice(1));
    AXES.forEach((name, axis) => byId("axis-" + name).addEventListener("change", () => { this.state.axis = axis; this.settle(); this.draw(); }));
    for (const end of [0, 1])
      for (const c of [0, 1])
        byId("stroke-" + end + "-" + c).addEventListener("input", (event) => {
          const place = [...this.stroke[end]];
          place[c] = event.target.valueAsNumber / 1e3;
          if (Number.isFinite(place[c]))
            this.setStroke(end, place);
        });
    byId("follows").addEventListener("change", (event) => { this.state.follows = event.target.checked; this.mark(true); });
    byId("depth").addEventListener("input", (event) => {
      if (Number.isFinite(event.target.valueAsNumber)) {
        this.state.depth = event.target.valueAsNumber / 1e3;
        this.mark(true);
      }
    });
    for (const pane of Object.values(this.panes)) {
      pane.canvas.addEventListener("keydown", (event) => this.onKey(event));
      for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"])
        pane.canvas.addEventListener(type, (event) => this.onPointer(pane, event));
    }
    new IntersectionObserver((seen, watch) => {
      if (seen.some((one) => one.isIntersecting)) {
        watch.disconnect();
        this.space.start();
      }
    }, { rootMargin: "200px" }).observe(byId("space-box"));
    document.querySelectorAll("#viewer form").forEach((form) => form.addEventListener("submit", (event) => event.preventDefault()));
    window.addEventListener("resize", () => this.draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }
}

// The viewer is started. On paper everything is unfolded and light.
let viewer = null;

function printWhole(begins) {
  printing = begins;
  for (const one of document.querySelectorAll(begins ? "details:not([open])" : "details[data-folded]")) {
    one.open = begins;
    one.toggleAttribute("data-folded", begins);
  }
  if (viewer && viewer.a)
    viewer.draw();
}

async function startViewer() {
  const about = byId("volumes"), status = byId("viewer-status");
  addEventListener("beforeprint", () => printWhole(true));
  addEventListener("afterprint", () => printWhole(false));
  if (!about)
    return;
  if (typeof DecompressionStream === "undefined") {
    status.textContent = "This browser cannot unpack the volumes: it lacks DecompressionStream, which browsers have since 2023. " +
      "The EXR files next to this page hold them.";
    return;
  }
  viewer = new Viewer(JSON.parse(about.textContent));
  try {
    status.textContent = "Unpacking …";
    await viewer.start();
    status.textContent = "";
    document.documentElement.dataset.viewer = "ready";
  } catch (error) {
    status.textContent = "The viewer cannot start: " + error.message;
  }
}

startViewer();
