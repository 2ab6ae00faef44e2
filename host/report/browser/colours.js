// Colours of the page, numbers and scales.

const LIGHT = { paper: "#ffffff", ink: "#1b1f24", quiet: "#555c66", grid: "#e2e5e9", s0: "#0062ad", s1: "#c2410c", focus: "#b3174f" };
let printing = false;

// The page's colours as they are now; on paper always the light ones.
function palette() {
  if (printing)
    return LIGHT;
  const style = getComputedStyle(document.documentElement), result = {};
  for (const name of Object.keys(LIGHT))
    result[name] = style.getPropertyValue(name === "focus" ? "--focus" : "--plot-" + name).trim() || LIGHT[name];
  return result;
}

// 256 colours of one of d3's maps.
function colourTable(map) {
  return d3.range(256).map((i) => { const { r, g, b } = d3.rgb(map(i / 255)); return [r, g, b]; });
}

// Numbers with a true minus sign and as many digits as they need, never an exponent without superscripts.
function numberText(value, digits = 3) {
  if (value === null || value === undefined)
    return "–";
  if (!Number.isFinite(value))
    return "no number";
  if (value === 0)
    return "0";
  const size = Math.abs(value);
  let text;
  if (size >= 1e-3 && size < 1e5) {
    text = size.toFixed(Math.min(Math.max(digits - 1 - Math.floor(Math.log10(size)), 0), 12));
  } else {
    const [mantissa, exponent] = size.toExponential(digits - 1).split("e");
    text = mantissa + "×10" + [...String(Number(exponent))].map((c) => c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]).join("");
  }
  return (value < 0 ? "−" : "") + text;
}

// Round numbers within [low, high], about `most` of them.
const roundTicks = (low, high, most) => d3.ticks(low, high, Math.max(0.75 * most, 1)).map((value) => ({ value, text: tickText(value) }));

// A canvas of `height` CSS px and its own width, cleared, to be drawn on in CSS px.
function prepare(canvas, height) {
  const width = Math.max(canvas.clientWidth || canvas.parentElement.clientWidth, 120), ratio = window.devicePixelRatio || 1;
  canvas.style.height = height + "px";
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = palette().paper;
  context.fillRect(0, 0, width, height);
  context.font = "11px system-ui, 'DejaVu Sans', Verdana, sans-serif";
  return { context, width, height };
}

// How a number becomes a colour: [r, g, b], or null for the paper.
class ColourScale {
  constructor(table, low, high, label) {
    Object.assign(this, { table, low, high: high > low ? high : low + 1, label });
  }

  rgb(value) {
    if (value === null)
      return null;
    if (!Number.isFinite(value))
      return [255, 0, 200];
    const t = Math.min(Math.max((value - this.low) / (this.high - this.low), 0), 1);
    return this.table[Math.round(t * (this.table.length - 1))];
  }

  draw(canvas) {
    const { context, width } = prepare(canvas, 50), colours = palette(), left = 14, right = width - 14;
    for (let x = left; x < right; ++x) {
      context.fillStyle = "rgb(" + this.rgb(this.low + (x - left) / (right - left) * (this.high - this.low)).join() + ")";
      context.fillRect(x, 2, 1.5, 12);
    }
    context.strokeStyle = context.fillStyle = colours.ink;
    context.strokeRect(left + 0.5, 2.5, right - left - 1, 12);
    context.textAlign = "center";
    for (const tick of roundTicks(this.low, this.high, Math.min(8, width / 60))) {
      const x = left + (tick.value - this.low) / (this.high - this.low) * (right - left), half = context.measureText(tick.text).width / 2;
      context.fillRect(x - 0.5, 14, 1, 4);
      context.fillText(tick.text, Math.min(Math.max(x, half), width - half), 29);
    }
    context.fillText(this.label, width / 2, 45);
  }
}
