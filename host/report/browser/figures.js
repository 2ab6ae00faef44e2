// Figures of studies: scatters, cells and bars of the rows of a table, drawn by d3.

const WIDTH = 720, NARROWEST = 300, HEIGHT = 440, PLOT = { left: 74, right: 16, top: 12, bottom: 46 }; // px
const MARKS = [d3.symbolCircle, d3.symbolSquare, d3.symbolTriangle, d3.symbolDiamond, d3.symbolCross, d3.symbolStar, d3.symbolWye];
const SERIES_COLOURS = 8, MOST_LABELS = 8, MOST_MARKS = 100;

// The same colour and mark for the same name everywhere: on the page and, of known names (picture/colours.cpp), in pictures.
const styles = new Map(Object.entries(KNOWN_SERIES)), FIRST_UNKNOWN = 32, known = styles.size;
function styleOf(name) {
  if (!styles.has(name))
    styles.set(name, FIRST_UNKNOWN + styles.size - known);
  const i = styles.get(name);
  return { colour: "var(--plot-s" + (i % SERIES_COLOURS) + ")", symbol: MARKS[i % MARKS.length] };
}

// Rows of a table as objects, those that a figure shows.
function rowsOf(study, table, where) {
  const found = study.tables.find((one) => one.name === table);
  if (!found)
    return [];
  const names = found.columns.map((column) => column.name);
  const text = (cell) => cell === null ? "" : String(cell);
  return found.rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i]])))
    .filter((row) => Object.entries(where || {}).every(([column, word]) => text(row[column]) === word));
}

function unitOf(study, table, column) {
  const found = study.tables.find((one) => one.name === table);
  const one = found && found.columns.find((each) => each.name === column);
  return one && one.unit && one.unit !== "1" ? " " + one.unit : "";
}

// What a row is, for who points at its mark.
function rowText(study, table, row, wanted) {
  return wanted.filter((name, i) => name && wanted.indexOf(name) === i && row[name] !== null && row[name] !== undefined && row[name] !== "")
    .map((name) => name.replace(/_/g, " ") + ": " + (typeof row[name] === "number" ? numberText(row[name], 3) : row[name]) + unitOf(study, table, name))
    .join("\n");
}

// A linear axis spans a thousandth of its largest number at least, so that ticks differ in few digits.
function scaleOf(axis, values, range) {
  let [low, high] = d3.extent(values);
  if (low === undefined)
    [low, high] = axis.logarithmic ? [1, 10] : [0, 1];
  if (axis.logarithmic) {
    const pad = Math.max((high / low) ** 0.04, 1.1);
    return d3.scaleLog().domain([low / pad, high * pad]).range(range);
  }
  const least = 1e-3 * Math.max(Math.abs(low), Math.abs(high)), middle = (low + high) / 2;
  if (high > low && high - low < least)
    [low, high] = [middle - least / 2, middle + least / 2];
  const pad = (high - low) * 0.05 || Math.abs(high) * 0.1 || 1;
  return d3.scaleLinear().domain([low >= 0 ? Math.max(0, low - pad) : low - pad, high + pad]).nice().range(range);
}

// Ticks with a number: of a logarithmic axis the powers of ten, and 2 and 5 times these where the range is short.
function ticksOf(scale, axis, most, values = []) {
  if (!axis.logarithmic) {
    const all = scale.ticks(Math.max(2, Math.floor(most))), whole = values.every(Number.isInteger) ? all.filter(Number.isInteger) : [];
    return whole.length > 1 ? whole : all; // nothing lies between what is counted
  }
  const [low, high] = scale.domain(), decades = Math.log10(high / low), all = [];
  const every = Math.max(1, Math.ceil(decades / most));
  for (let power = Math.ceil(Math.log10(low) - 1); power <= Math.log10(high); power += 1)
    for (const times of decades < 1.5 ? [1, 2, 5] : decades < 3 ? [1, 3] : [1])
      if (times * 10 ** power >= low && times * 10 ** power <= high && power % every === 0)
        all.push(times * 10 ** power);
  if (all.length < 2) // less than a decade between them
    return d3.scaleLinear().domain([low, high]).ticks(Math.max(2, Math.floor(most)));
  return all;
}

// Text of an SVG axis: 10 to a power has the power raised, as numbers have everywhere on the page.
const tickText = (value) => value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e5)
  ? numberText(value, 5).replace(/\.?0+×/, "×").replace(/^(−?)1×/, "$1") : String(+value.toPrecision(6)).replace("-", "−");

// As wide as there is room, so that words keep their size.
const widthIn = (element) => Math.max(NARROWEST, Math.min(WIDTH, element.clientWidth || WIDTH));

// A label in one line, or in two where it is longer than `room`, px.
function inLines(label, room) {
  if (label.length * 6.8 <= room || !label.includes(" "))
    return [label];
  const spaces = [...label.matchAll(/ /g)].map((space) => space.index), cut = spaces.sort((a, b) => Math.abs(a - label.length / 2) - Math.abs(b - label.length / 2))[0];
  return [label.slice(0, cut), label.slice(cut + 1)];
}

class FigureFrame {
  // `left`, `below`: px that words on the left and below take.
  constructor(element, figure, { height = figure.height || HEIGHT, left = PLOT.left, below = PLOT.bottom } = {}) {
    Object.assign(this, { figure, height, left, width: widthIn(element), bottom: height - below });
    this.right = this.width - PLOT.right;
    this.svg = d3.select(element).append("svg").attr("viewBox", `0 0 ${this.width} ${height}`).attr("role", "img")
      .attr("aria-label", figure.title).attr("class", "plot").attr("font-family", "system-ui, 'DejaVu Sans', Verdana, sans-serif");
    this.legend = d3.select(element).append("div").attr("class", "legend");
    this.clip = "clip-" + Math.random().toString(36).slice(2);
    this.svg.append("clipPath").attr("id", this.clip).append("rect").attr("x", this.left).attr("y", PLOT.top)
      .attr("width", this.right - this.left).attr("height", this.bottom - PLOT.top);
  }

  drawAxes(x, y, xTicks, yTicks, text = tickText) {
    const { svg, figure, left, bottom, right } = this, grid = svg.append("g");
    for (const value of xTicks) {
      const at = x(value) + (x.bandwidth ? x.bandwidth() / 2 : 0);
      if (!x.bandwidth)
        grid.append("line").attr("class", "grid").attr("x1", at).attr("x2", at).attr("y1", PLOT.top).attr("y2", bottom);
      const words = text(value), half = 3.8 * String(words).length; // px: none is cut at the right border
      grid.append("text").attr("class", "tick").attr("x", Math.min(at, this.width - half)).attr("y", bottom + 16)
        .attr("text-anchor", "middle").text(words);
    }
    for (const value of yTicks) {
      const at = y(value) + (y.bandwidth ? y.bandwidth() / 2 : 0);
      if (!y.bandwidth)
        grid.append("line").attr("class", "grid").attr("x1", left).attr("x2", right).attr("y1", at).attr("y2", at);
      grid.append("text").attr("class", "tick").attr("x", left - 7).attr("y", at + 4).attr("text-anchor", "end").text(text(value));
    }
    svg.append("rect").attr("class", "frame").attr("x", left).attr("y", PLOT.top).attr("width", right - left)
      .attr("height", bottom - PLOT.top);
    svg.append("text").attr("class", "axis").attr("x", (left + right) / 2).attr("y", this.height - 8).attr("text-anchor", "middle").text(figure.x.label);
    const lines = inLines(figure.y.label, bottom - PLOT.top);
    lines.forEach((line, i) => svg.append("text").attr("class", "axis").attr("text-anchor", "middle").text(line)
      .attr("transform", `translate(${15 * (i + 1) - 4 * (lines.length - 1)},${(PLOT.top + bottom) / 2}) rotate(-90)`));
    this.body = svg.append("g").attr("clip-path", `url(#${this.clip})`);
  }

  addLegend(name, draw) {
    const entry = this.legend.append("span");
    draw(entry.append("svg").attr("width", 26).attr("height", 14).attr("viewBox", "-13 -7 26 14"));
    entry.append("span").text(name);
  }
}

function drawLine(target, points, x, y, colour, dash, width = 1.6) {
  target.append("path").attr("fill", "none").attr("stroke", colour).attr("stroke-width", width).attr("stroke-dasharray", dash)
    .attr("d", d3.line().defined(([, b]) => b !== null && Number.isFinite(b)).x(([a]) => x(a)).y(([, b]) => y(b))(points));
}

// Signs of a legend and of the plot: a line, a mark.
const drawKey = (key, colour, dash, width) => drawLine(key, [[-12, 0], [12, 0]], (v) => v, (v) => v, colour, dash, width);
const addMark = (target, symbol, size = 46) => target.append("path").attr("d", d3.symbol().type(symbol).size(size)());

// [x, y, low, high]
function drawBand(target, points, x, y) {
  target.append("path").attr("fill", "var(--plot-ink)").attr("fill-opacity", 0.16).attr("d", d3.area().x(([a]) => x(a)).y0(([, , low]) => y(low)).y1(([, , , high]) => y(high))(points));
}

// Lines of numbers, null where missing, against a place: [{name, values, colour, dash}].
function drawProfile(element, places, lines, label, placeLabel) {
  element.replaceChildren();
  const frame = new FigureFrame(element, { title: label + " along the stroke", x: { label: placeLabel }, y: { label } }, { height: 270 }), values = lines.flatMap((line) => line.values);
  const x = scaleOf({}, [0, places[places.length - 1]], [frame.left, frame.right]), y = scaleOf({}, [0, ...values.filter((value) => value !== null)], [frame.bottom, PLOT.top]);
  frame.drawAxes(x, y, ticksOf(x, {}, frame.width / 90), ticksOf(y, {}, 5));
  for (const line of lines) {
    drawLine(frame.body, line.values.map((value, i) => [places[i], value]), x, y, line.colour, line.dash, 2);
    frame.addLegend(line.name, (key) => drawKey(key, line.colour, line.dash, 2));
  }
}

const CURVE_DASHES = [null, "7 4", "2 3", "8 3 2 3", "1 5"];

function drawScatter(element, study, figure) {
  const canShow = (axis, value) => typeof value === "number" && (!axis.logarithmic || value > 0);
  const all = rowsOf(study, figure.table, figure.where);
  const shown = (some) => some.filter((row) => canShow(figure.x, row[figure.x.column]) && canShow(figure.y, row[figure.y.column]));
  const rows = shown(all), spanned = figure.span ? shown(rowsOf(study, figure.table, figure.span)) : rows;
  const curves = figure.curves.map((curve) => ({ ...curve, points: rowsOf(study, curve.table, curve.where)
    .filter((row) => canShow(figure.x, row[curve.x]) && canShow(figure.y, row[curve.y]))
    .map((row) => [row[curve.x], row[curve.y], ...(curve.low ? [row[curve.low], row[curve.high]] : [])]) })).filter((curve) => curve.points.length);
  const spread = (axis, column) => spanned.map((row) => row[column]).filter((value) => canShow(axis, value));
  const frame = new FigureFrame(element, figure);
  const x = scaleOf(figure.x, [...spanned.map((row) => row[figure.x.column]), ...curves.flatMap((c) => c.points.map((p) => p[0])), ...spread(figure.x, figure.x_low), ...spread(figure.x, figure.x_high)],
    [frame.left, frame.right]);
  const y = scaleOf(figure.y, [...spanned.map((row) => row[figure.y.column]), ...curves.flatMap((c) => c.points.flatMap((p) => p.slice(1))), ...spread(figure.y, figure.low), ...spread(figure.y, figure.high)],
    [frame.bottom, PLOT.top]);
  const valuesOf = (axis) => spanned.map((row) => row[axis.column]);
  frame.drawAxes(x, y, ticksOf(x, figure.x, frame.width / 90, valuesOf(figure.x)), ticksOf(y, figure.y, 7, valuesOf(figure.y)));
  const names = d3.set(rows, (row) => row[figure.series] === undefined || row[figure.series] === null ? "" : row[figure.series]).values();
  // A curve of a series' name, or of that and more, is that series' own; others differ by their dashes.
  let plain = 0;
  const over = []; // lines with a band are drawn last, over thinner ones
  curves.forEach((curve, i) => {
    const own = names.includes(curve.label), of = own ? curve.label : names.find((name) => name && curve.label.startsWith(name + ", "));
    if (curve.low)
      drawBand(frame.body, curve.points, x, y);
    const dash = curve.dashed ? CURVE_DASHES[1 + i % 4] : of ? null : CURVE_DASHES[plain++ % 5];
    const style = [of ? styleOf(of).colour : "var(--plot-ink)", dash, curve.low ? 2 : 1.2], draw = () => drawLine(frame.body, curve.points, x, y, ...style);
    if (curve.low)
      over.push(draw);
    else
      draw();
    if (!own)
      frame.addLegend(curve.label, (key) => {
        if (curve.low)
          drawBand(key, [[-12, 0, -5, 5], [12, 0, -5, 5]], (v) => v, (v) => v);
        drawKey(key, ...style);
      });
  });
  const coloured = {}; // how many lines of a colour there are: they differ by their dashes
  for (const name of names) {
    const style = styleOf(name), dash = CURVE_DASHES[(coloured[style.colour] = (coloured[style.colour] ?? -1) + 1) % 5], own = rows.filter((row) => !figure.series || String(row[figure.series] || "") === name);
    const at = (row) => [x(row[figure.x.column]), y(row[figure.y.column])];
    if (figure.joined)
      drawLine(frame.body, own.map((row) => [row[figure.x.column], row[figure.y.column]]), x, y, style.colour, dash, over.length ? 0.9 : undefined);
    for (const row of own) {
      const [px, py] = at(row);
      const whisker = (axis, low, high, line) => {
        if (canShow(axis, row[low]) && canShow(axis, row[high]))
          frame.body.append("path").attr("stroke", style.colour).attr("fill", "none").attr("stroke-width", 1.3).attr("d", line(row[low], row[high]));
      };
      whisker(figure.y, figure.low, figure.high, (a, b) => `M${px - 3},${y(a)}h6m-3,0V${y(b)}m-3,0h6`);
      whisker(figure.x, figure.x_low, figure.x_high, (a, b) => `M${x(a)},${py - 3}v6m0,-3H${x(b)}m0,-3v6`);
      const pick = figure.picks && figure.picks.includes(row[figure.pick]);
      addMark(frame.body, figure.shape ? styleOf(String(row[figure.shape])).symbol : style.symbol).attr("class", "mark").classed("pick", pick).classed("line", figure.joined && own.length > MOST_MARKS)
        .attr("tabindex", pick ? 0 : -1).attr("role", pick ? "button" : null).attr("transform", `translate(${px},${py})`)
        .attr("fill", style.colour).attr("stroke", "var(--plot-paper)").attr("stroke-width", 0.7)
        .datum(() => ({ study, figure, row }))
        .append("title").text(rowText(study, figure.table, row, ["way", figure.label, figure.series, figure.shape, figure.x.column, figure.y.column, figure.low, figure.high,
          ...study.tables.find((one) => one.name === figure.table).columns.slice(0, 12).map((column) => column.name)]));
    }
    if (figure.series)
      frame.addLegend(name, (key) => {
        if (figure.joined)
          drawKey(key, style.colour, dash);
        if (figure.shape)
          key.append("rect").attr("x", -6).attr("y", -6).attr("width", 12).attr("height", 12).attr("fill", style.colour);
        else
          addMark(key, style.symbol).attr("fill", style.colour);
      });
  }
  if (figure.shape)
    for (const name of new Set(rows.map((row) => String(row[figure.shape]))))
      frame.addLegend(name, (key) => addMark(key, styleOf(name).symbol).attr("fill", "var(--plot-quiet)"));
  over.forEach((draw) => draw());
  placeLabels(frame, rows.filter((row) => figure.label && row[figure.label]).map((row) =>
    ({ text: String(row[figure.label]), x: x(row[figure.x.column]), y: y(row[figure.y.column]) })),
  [...rows.map((row) => [x(row[figure.x.column]), y(row[figure.y.column])]), ...curves.flatMap((curve) => curve.points.map(([a, b]) => [x(a), y(b)]))]);
  if (rows.length < all.length)
    d3.select(element).append("p").attr("class", "note").text(`The table has ${all.length} rows; ${all.length - rows.length} without a number for this figure.`);
}

// Names next to the marks that have one, where there is room: the others show theirs when pointed at.
function placeLabels(frame, labels, marks) {
  const taken = [];
  const covers = (box) => box.x < frame.left + 2 || box.x + box.w > frame.right - 2 || box.y < PLOT.top + 1 || box.y + box.h > frame.bottom - 1 || taken.some((other) => box.x < other.x + other.w && other.x < box.x + box.w &&
    box.y < other.y + other.h && other.y < box.y + box.h) || marks.some(([mx, my]) => mx > box.x - 4 && mx < box.x + box.w + 4 && my > box.y - 4 && my < box.y + box.h + 4);
  let placed = 0;
  for (const label of labels) {
    const w = 6.1 * label.text.length, h = 13;
    for (const [dx, dy] of [[9, -6.5], [-9 - w, -6.5], [9, -20], [9, 8], [-9 - w, -20], [-9 - w, 8]]) {
      const box = { x: label.x + dx, y: label.y + dy, w, h };
      if (placed < MOST_LABELS && !covers(box)) {
        taken.push(box);
        frame.svg.append("text").attr("class", "label").attr("x", box.x).attr("y", box.y + 10).text(label.text);
        ++placed;
        break;
      }
    }
  }
}

// What distinguishes words in print without colours: nothing, a dot, a stroke, a cross.
function markWord(body, number, x, y, reach) {
  if (number === 0 || 4 * reach < 5)
    return;
  const path = number === 1 ? `M${x - reach / 2},${y}a${reach / 2},${reach / 2} 0 1,0 ${reach},0a${reach / 2},${reach / 2} 0 1,0 ${-reach},0z`
    : `M${x - reach},${y + reach}L${x + reach},${y - reach}` + (number === 3 ? `M${x - reach},${y - reach}L${x + reach},${y + reach}` : "");
  body.append("path").attr("class", "word-mark").attr("d", path);
}

// Of cells at even steps or ratios: a scale through their middles, for round ticks; null for others.
function evenScale(band, sorted) {
  const middle = (value) => band(value) + band.bandwidth() / 2, ends = [sorted[0], sorted[sorted.length - 1]];
  const fits = (scale) => sorted.every((value) => Math.abs(scale(value) - middle(value)) < 0.1 * band.step());
  const scales = [d3.scaleLinear(), ...ends[0] > 0 ? [d3.scaleLog()] : []].map((scale) => scale.domain(ends).range(ends.map(middle)));
  return sorted.length > 2 && scales.find(fits) || null;
}

function drawCells(element, study, figure) {
  const whole = (where) => rowsOf(study, figure.table, where).filter((row) => row[figure.x.column] !== null && row[figure.y.column] !== null);
  const rows = whole(figure.where), spanned = figure.span ? whole(figure.span) : rows;
  // Numbers rise; words stand in the order of the rows, from the left and from the top.
  const valuesOf = (column) => [...new Set(spanned.map((row) => row[column]))], isWord = (values) => typeof values[0] === "string";
  const inOrder = (values, turned) => isWord(values) ? turned ? values.reverse() : values : values.sort((a, b) => a - b);
  const xs = inOrder(valuesOf(figure.x.column)), ys = inOrder(valuesOf(figure.y.column), true), words = isWord(ys), below = PLOT.bottom + (isWord(xs) ? 30 : 0); // where words do not fit they slant
  const frame = new FigureFrame(element, figure, !words ? { below }
    : { below, height: PLOT.top + below + 20 * ys.length, left: Math.min(0.6 * widthIn(element), 14 + 7 * d3.max(ys, (name) => name.length)) });
  const x = d3.scaleBand().domain(xs).range([frame.left, frame.right]), y = d3.scaleBand().domain(ys).range([frame.bottom, PLOT.top]);
  const some = (all, most) => all.filter((_, i) => i % Math.ceil(all.length / most) === 0);
  const evenX = isWord(xs) ? null : evenScale(x, xs), evenY = words ? null : evenScale(y, ys);
  frame.drawAxes(evenX || x, evenY || y, evenX ? ticksOf(evenX, { logarithmic: evenX.base }, frame.width / 90) : isWord(xs) ? xs : some(xs, frame.width / 75),
    evenY ? ticksOf(evenY, { logarithmic: evenY.base }, 7) : words ? ys : some(ys, 9), (value) => typeof value !== "number" ? value : evenX && evenY ? tickText(value) : numberText(value, 2));
  if (isWord(xs) && x.bandwidth() < 7 * d3.max(xs, (name) => name.length))
    frame.svg.selectAll(".tick").filter(function () { return this.getAttribute("text-anchor") === "middle"; }).attr("text-anchor", "end")
      .attr("transform", function () { return `rotate(-30 ${this.getAttribute("x")} ${frame.bottom + 12})`; });
  const values = spanned.map((row) => row[figure.value]).filter((value) => value !== null);
  let colour, marked = null;
  if (values.some((value) => typeof value === "string")) {
    const words = figure.value_words.length ? figure.value_words : [...new Set(values)];
    colour = (value) => "var(--plot-s" + words.indexOf(value) % SERIES_COLOURS + ")";
    marked = (body, word, left, top, width, height) => markWord(body, words.indexOf(word) % 4, left + width / 2, top + height / 2, Math.min(width, height, 14) / 4);
    words.forEach((word) => frame.addLegend(word, (key) => {
      key.append("rect").attr("x", -11).attr("y", -6).attr("width", 22).attr("height", 12).attr("fill", colour(word));
      marked(key, word, -11, -6, 22, 12);
    }));
  } else {
    const limit = figure.value_limit || d3.max(values, Math.abs) || 1, both = values.some((value) => value < 0);
    const low = figure.value_logarithmic ? Math.max(d3.min(values.filter((value) => value > 0)) || limit / 10, limit * 1e-12) : both ? -limit : 0;
    const share = figure.value_logarithmic ? d3.scaleLog().domain([low, limit]).clamp(true) : d3.scaleLinear().domain([low, limit]).clamp(true);
    colour = (value) => both ? d3.interpolateRdBu(1 - share(value)) : d3.interpolateViridis(share(Math.max(value, low)));
    const key = frame.legend.append("span").attr("class", "ramp");
    key.append("span").text(numberText(low, 2));
    const bar = key.append("svg").attr("width", 160).attr("height", 12);
    d3.range(80).forEach((i) => bar.append("rect").attr("x", 2 * i).attr("width", 2.5).attr("height", 12)
      .attr("fill", both ? d3.interpolateRdBu(1 - i / 79) : d3.interpolateViridis(i / 79)));
    key.append("span").text(numberText(limit, 2) + (figure.value_label ? "  " + figure.value_label : ""));
  }
  for (const row of rows.filter((one) => one[figure.value] !== null))
    frame.body.append("rect").attr("class", "mark").attr("x", x(row[figure.x.column])).attr("y", y(row[figure.y.column])).attr("width", x.bandwidth() + 0.3)
      .attr("height", y.bandwidth() + 0.3).attr("fill", colour(row[figure.value])).datum(() => ({ study, figure, row }))
      .append("title").text(rowText(study, figure.table, row, [figure.value, figure.x.column, figure.y.column]));
  if (marked)
    for (const row of rows.filter((one) => one[figure.value] !== null))
      marked(frame.body, row[figure.value], x(row[figure.x.column]), y(row[figure.y.column]), x.bandwidth(), y.bandwidth());
  // Curves lie between the middles of cells.
  const along = (band, sorted) => d3.scaleLinear().domain(sorted).range(sorted.map((value) => band(value) + band.bandwidth() / 2));
  frame.body.node().place = { x: along(x, xs), y: along(y, ys), columns: [figure.x.column, figure.y.column] };
  const lines = [...figure.curves].sort((a, b) => (a.dashed || false) - (b.dashed || false)); // the first that is not dashed is solid
  const solid = lines.length && !lines[0].dashed ? 0 : 1;
  figure.curves.forEach((curve) => {
    const points = rowsOf(study, curve.table, curve.where).map((row) => [row[curve.x], row[curve.y]])
      .filter(([a, b]) => a !== null && b !== null && a >= xs[0] && a <= xs[xs.length - 1] && b >= ys[0] && b <= ys[ys.length - 1]);
    const dash = CURVE_DASHES[(lines.indexOf(curve) + solid) % CURVE_DASHES.length];
    if (points.length)
      drawLine(frame.body, points, along(x, xs), along(y, ys), "var(--plot-ink)", dash, 1.8);
    frame.addLegend(curve.label, (key) => drawKey(key, "var(--plot-ink)", dash, 1.8));
  });
}

function drawBars(element, study, figure) {
  const rows = rowsOf(study, figure.table, figure.where).filter((row) => typeof row[figure.y.column] === "number");
  const names = [...new Set(rows.map((row) => String(row[figure.x.column])))], series = [...new Set(rows.map((row) => String(row[figure.series] || "")))];
  const ofName = d3.nest().key((row) => String(row[figure.x.column])).map(rows), most = d3.max(ofName.values(), (some) => some.length) || 1;
  // Bars lie. Words stand on the left where they have room, else above their bars.
  const needed = 12 + 7.4 * d3.max(names, (name) => name.length), above = needed > Math.min(260, element.clientWidth / 2) ? 14 : 0;
  // `figure.height`: low, with thin bars, but higher where there are many.
  const bar = figure.height ? 7 : 14, height = Math.max(figure.height || 160, PLOT.top + PLOT.bottom + names.length * (10 + bar * most + above));
  const frame = new FigureFrame(element, { ...figure, x: figure.y, y: { label: "" } }, { height, left: above ? 12 : Math.max(needed, PLOT.left) });
  const values = rows.flatMap((row) => [row[figure.y.column], row[figure.low], row[figure.high]]).filter((value) => typeof value === "number" && (!figure.y.logarithmic || value > 0));
  const x = scaleOf(figure.y, figure.y.logarithmic ? values : [0, ...values], [frame.left, frame.right]);
  const y = d3.scaleBand().domain(names).range([PLOT.top, frame.bottom]).padding(0.25), thick = (y.bandwidth() - above) / most;
  frame.drawAxes(x, y, ticksOf(x, figure.y, frame.width / 110), above ? [] : names, (value) => typeof value === "number" ? tickText(value) : value);
  if (above)
    names.forEach((name) => frame.body.append("text").attr("class", "tick").attr("x", frame.left + 4).attr("y", y(name) + 10).text(name));
  for (const row of rows) {
    const own = ofName.get(String(row[figure.x.column])), style = styleOf(String(row[figure.series] || figure.title));
    const top = y(String(row[figure.x.column])) + above + (y.bandwidth() - above - own.length * thick) / 2 + own.indexOf(row) * thick;
    const at = x(row[figure.y.column]), middle = top + thick / 2;
    // A logarithmic axis has no zero for a bar to begin at: a mark alone.
    const mark = figure.y.logarithmic
      ? addMark(frame.body, style.symbol, 60).attr("transform", `translate(${at},${middle})`)
      : frame.body.append("rect").attr("x", Math.min(x(0), at)).attr("y", top).attr("width", Math.max(Math.abs(at - x(0)), 1)).attr("height", Math.max(thick - 1, 1));
    mark.attr("class", "mark").attr("fill", style.colour).datum(() => ({ study, figure, row }))
      .append("title").text(rowText(study, figure.table, row, [figure.x.column, figure.series, figure.y.column, figure.low, figure.high]));
    if (typeof row[figure.low] === "number" && typeof row[figure.high] === "number")
      frame.body.append("path").attr("stroke", "var(--plot-ink)").attr("fill", "none")
        .attr("d", `M${x(row[figure.low])},${middle - 3}v6m0,-3H${x(row[figure.high])}m0,-3v6`);
  }
  if (series.length > 1)
    series.forEach((name) => frame.addLegend(name, (key) => (figure.y.logarithmic ? addMark(key, styleOf(name).symbol)
      : key.append("rect").attr("x", -11).attr("y", -6).attr("width", 22).attr("height", 12)).attr("fill", styleOf(name).colour)));
}

const DRAW = { scatter: drawScatter, cells: drawCells, bars: drawBars };

// Saving: the SVG with the page's colours put in, a PNG of it at twice the size, or the rows that it shows.
function save(name, address) {
  const link = Object.assign(document.createElement("a"), { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
}

const STYLED = ["fill", "stroke", "stroke-width", "stroke-dasharray", "font-size", "font-weight"];

function wholeSvg(element, figure) {
  const plots = [...element.querySelectorAll("svg.plot")], legend = [...element.querySelectorAll(".legend")].pop(), colours = palette();
  const names = [...legend.querySelectorAll(":scope > span")].map((one) => one.textContent).filter((text) => text);
  const text = (x, y, words, size) => `<text x="${x}" y="${y}" font-size="${size}" fill="${colours.ink}">${words.replace(/&/g, "&amp;").replace(/</g, "&lt;")}</text>`;
  const whole = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  let width = 0, height = 0, titles = text(8, -8, figure.title, 14);
  for (const svg of plots) { // one below the other
    const plot = svg.cloneNode(true), from = svg.querySelectorAll("*"), to = plot.querySelectorAll("*"), [, , w, h] = svg.getAttribute("viewBox").split(" ").map(Number);
    from.forEach((one, i) => STYLED.forEach((property) => to[i].setAttribute(property, getComputedStyle(one)[property])));
    if (plots.length > 1)
      titles += text(8, (height += 20) - 6, svg.getAttribute("aria-label"), 12);
    Object.entries({ y: height, width: w, height: h }).forEach(([name, value]) => plot.setAttribute(name, value));
    whole.append(plot);
    height += h;
    width = Math.max(width, w);
  }
  whole.setAttribute("viewBox", `0 -26 ${width} ${height + 30 + 16 * Math.ceil(names.length / 4)}`);
  whole.setAttribute("font-family", "system-ui, 'DejaVu Sans', Verdana, sans-serif");
  whole.insertAdjacentHTML("afterbegin", `<rect x="0" y="-26" width="100%" height="100%" fill="${colours.paper}"/>` + titles);
  legend.querySelectorAll(":scope > span > svg").forEach((key, i) => {
    const group = document.createElementNS("http://www.w3.org/2000/svg", "g"), x = 20 + (i % 4) * width / 4, y = height + 8 + 16 * Math.floor(i / 4);
    group.setAttribute("transform", `translate(${x},${y})`);
    [...key.children].forEach((part) => {
      const clone = part.cloneNode(true);
      STYLED.forEach((property) => clone.setAttribute(property, getComputedStyle(part)[property]));
      group.append(clone);
    });
    group.insertAdjacentHTML("beforeend", text(18, 4, names[i] || "", 11));
    whole.append(group);
  });
  return new XMLSerializer().serializeToString(whole);
}

function savePng(name, text) {
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement("canvas"), [, , width, height] = /viewBox="([^"]*)"/.exec(text)[1].split(" ").map(Number);
    Object.assign(canvas, { width: 2 * width, height: 2 * height });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    save(name, canvas.toDataURL("image/png"));
  };
  image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(text);
}

function csvText(study, figure) {
  const columns = study.tables.find((one) => one.name === figure.table).columns.map((column) => column.name);
  return d3.csvFormat(rowsOf(study, figure.table, figure.where), columns) + "\n";
}

// `alone`: without caption and buttons. Returns what draws another figure in its place.
function drawFigure(element, study, figure, alone = false) {
  const title = document.createElement("h4"), canvas = element.appendChild(document.createElement("div"));
  element.prepend(title);
  let width = 0;
  const draw = () => {
    if (canvas.clientWidth === width)
      return;
    width = canvas.clientWidth;
    title.textContent = figure.title;
    canvas.replaceChildren();
    try {
      const words = figure.panels ? [...new Set(rowsOf(study, figure.table, figure.where).map((row) => row[figure.panels]))] : [];
      canvas.classList.toggle("panels", words.length > 1);
      canvas.append(...words.map(() => document.createElement("div"))); // all, before the width of any is asked for
      words.forEach((word, i) => {
        canvas.children[i].append(Object.assign(document.createElement("h5"), { textContent: word }));
        DRAW[figure.kind](canvas.children[i], study, { ...figure, title: word, where: { ...figure.where, [figure.panels]: String(word) }, span: figure.where, height: 300 });
      });
      if (!words.length)
        DRAW[figure.kind](canvas, study, figure);
    } catch (error) {
      canvas.textContent = "This figure cannot be drawn: " + error.message;
    }
  };
  const another = (one) => {
    figure = one;
    width = 0;
    draw();
  };
  draw();
  window.addEventListener("resize", draw);
  if (alone)
    return another;
  const caption = element.appendChild(document.createElement("figcaption"));
  caption.append(figure.caption + " ");
  const actions = { SVG: () => save(figure.name + ".svg", "data:image/svg+xml;charset=utf-8," + encodeURIComponent(wholeSvg(canvas, figure))),
    PNG: () => savePng(figure.name + ".png", wholeSvg(canvas, figure)),
    CSV: () => save(figure.name + ".csv", "data:text/csv;charset=utf-8," + encodeURIComponent(csvText(study, figure))) };
  for (const [name, act] of Object.entries(actions)) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: name, className: "save", title: "save this figure as " + name });
    button.addEventListener("click", act);
    caption.append(button);
  }
  return another;
}

// Below a figure, of the mark that is picked in it or chosen by name, the figures linked to it.
function linkFigures(element, study, figure) {
  const linked = study.figures.filter((one) => figure.linked.includes(one.name)), span = (one) => Object.fromEntries(Object.entries(one.where).filter(([name]) => name !== figure.pick));
  if (linked.length)
    figure.picks = [...new Set(rowsOf(study, linked[0].table, span(linked[0])).map((row) => row[figure.pick]))];
  drawFigure(element, study, figure);
  if (!linked.length)
    return;
  const panel = d3.select(element.closest(".answer") || element).append("div").attr("class", "linked"), draws = [];
  const choice = panel.append("label").text("Click a ringed mark, or choose here, to see where it errs and the force along a stroke: ").append("select");
  choice.selectAll("option").data(["", ...figure.picks]).enter().append("option").attr("value", (word) => word).text((word) => word || "none chosen");
  const show = (word) => {
    choice.property("value", word);
    linked.forEach((one, i) => {
      const shown = { ...one, title: one.title.replace(one.where[figure.pick], word), where: { ...one.where, [figure.pick]: word }, span: span(one), height: 300 };
      if (draws[i])
        draws[i](shown);
      else
        draws[i] = drawFigure(panel.append("figure").node(), study, shown);
    });
  };
  choice.on("change", () => choice.property("value") && show(choice.property("value")));
  const take = (event) => {
    const mark = event.target.closest(".pick");
    if (mark && (event.type === "click" || event.key === "Enter"))
      show(d3.select(mark).datum().row[figure.pick]);
  };
  ["click", "keydown"].forEach((type) => element.addEventListener(type, take));
}
