/* Charts as SVG: histories, envelope. */
const SVG = "http://www.w3.org/2000/svg";

function shape(parent, name, attributes = {}, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

function ticksOf(low, high, count) {
  const step = niceStep(high - low, count), ticks = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + 1e-9 * step; value += step) ticks.push(Number(value.toPrecision(12)));
  return ticks;
}

/* Seconds in the unit in which people read a drive's length. */
function timeUnit(end) {
  return end <= 180 ? [1, "s"] : end <= 3 * 3600 ? [60, "min"] : [3600, "h"];
}

class Axes {
  constructor(host, height, label) {
    this.host = host;
    this.height = height;
    this.svg = document.createElementNS(SVG, "svg");
    this.svg.setAttribute("role", "img");
    this.svg.setAttribute("aria-label", label);
    host.append(this.svg);
    this.margins = { left: 42, right: 12, top: 20, bottom: 34 };
  }

  begin([x0, x1], [y0, y1], xTitle, yTitle) {
    this.width = Math.max(260, this.host.clientWidth || 600);
    Object.assign(this, { x0, x1, y0, y1 });
    const { left, right, top, bottom } = this.margins;
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.svg.setAttribute("height", this.height);
    this.svg.replaceChildren();
    this.inner = { left, top, right: this.width - right, bottom: this.height - bottom };
    this.back = shape(this.svg, "g");
    for (const value of ticksOf(y0, y1, Math.max(2, this.height / 45))) {
      shape(this.svg, "line", { class: "grid", x1: left, x2: this.inner.right, y1: this.y(value), y2: this.y(value) });
      shape(this.svg, "text", { x: left - 6, y: this.y(value) + 3.5, "text-anchor": "end" }, String(value));
    }
    for (const value of ticksOf(x0, x1, Math.max(3, this.width / 90))) {
      shape(this.svg, "line", { class: "grid", x1: this.x(value), x2: this.x(value), y1: top, y2: this.inner.bottom });
      shape(this.svg, "text", { x: this.x(value), y: this.inner.bottom + 14, "text-anchor": "middle" }, String(value));
    }
    shape(this.svg, "text", { x: this.inner.right, y: this.height - 4, "text-anchor": "end" }, xTitle);
    shape(this.svg, "text", { x: left - 6, y: 10 }, yTitle);
  }

  x(value) { return this.inner.left + (value - this.x0) / (this.x1 - this.x0) * (this.inner.right - this.inner.left); }
  y(value) { return this.inner.bottom - (value - this.y0) / (this.y1 - this.y0) * (this.inner.bottom - this.inner.top); }

  path(points, attributes) {
    const text = points.map(([x, y], i) => `${i ? "L" : "M"}${this.x(x).toFixed(1)} ${this.y(y).toFixed(1)}`).join("");
    return shape(this.svg, "path", { d: text, ...attributes });
  }
}

/* Times at which histories are drawn: those of the steps, and more between long ones. */
function shownTimes(tyre) {
  const times = [0];
  for (let i = 1; i < tyre.times.length; i++) {
    const before = tyre.times[i - 1], parts = Math.ceil((tyre.times[i] - before) / (tyre.end / 80));
    for (let k = 1; k <= parts; k++) times.push(before + (tyre.times[i] - before) * k / parts);
  }
  return times;
}

class HistoryChart {
  constructor(host, tyre, onTime) {
    this.tyre = tyre;
    this.axes = new Axes(host, 250, "Temperatures of the sensors over time");
    this.times = shownTimes(tyre);
    [this.divisor, this.unit] = timeUnit(tyre.end);
    const move = (event) => {
      const box = this.axes.svg.getBoundingClientRect(), x = (event.clientX - box.left) * this.axes.width / box.width;
      const part = (x - this.axes.inner.left) / (this.axes.inner.right - this.axes.inner.left);
      onTime(Math.min(Math.max(part, 0), 1) * tyre.end);
    };
    this.axes.svg.addEventListener("pointerdown", (event) => { this.axes.svg.setPointerCapture(event.pointerId); move(event); });
    this.axes.svg.addEventListener("pointermove", (event) => { if (event.buttons) move(event); });
    this.axes.svg.style.cursor = "ew-resize";
    /* A finger that moves across moves the time; up and down it scrolls the page. */
    this.axes.svg.style.touchAction = "pan-y";
  }

  /* Histories of a solution: name -> temperatures at `times`. */
  series(solution) {
    const tyre = this.tyre, series = {};
    for (const name of [...tyre.about.read, "contained-air"]) series[name] = [];
    for (const t of this.times) {
      const y = solution.state(t);
      solution.readings(t, y).forEach((value, i) => series[tyre.about.read[i]].push(value));
      series["contained-air"].push(tyre.hasGas ? y[tyre.size] : solution.coefficients.airStart);
    }
    return series;
  }

  /* lines: [{name, colour, dashed}]; ghosts: [series]; run: measured; limits: [degC] */
  draw(series, lines, ghosts, run, limits, time) {
    let low = Infinity, high = -Infinity;
    const take = (values) => { for (const value of values) if (value !== null) { low = Math.min(low, value); high = Math.max(high, value); } };
    for (const { name } of lines) {
      take(series[name]);
      for (const ghost of ghosts) take(ghost[name]);
      if (run && run.readings[name]) take(run.readings[name]);
    }
    if (low === Infinity) [low, high] = [0, 1];
    for (const limit of limits) if (limit < high + 0.35 * (high - low)) take([limit]);
    const edge = Math.max(0.06 * (high - low), 1), axes = this.axes;
    axes.begin([0, this.tyre.end / this.divisor], [low - edge, high + edge], `time, ${this.unit}`, "°C");
    for (const limit of limits) if (limit <= high + edge) axes.path([[0, limit], [axes.x1, limit]], { class: "limit" });
    for (const start of this.tyre.first.slice(1)) {
      const x = axes.x(this.tyre.times[start] / this.divisor);
      shape(axes.svg, "line", { class: "axis", x1: x, x2: x, y1: axes.inner.top, y2: axes.inner.bottom });
    }
    const points = (values) => values.map((value, i) => [this.times[i] / this.divisor, value]);
    for (const { name, colour } of lines) for (const ghost of ghosts) axes.path(points(ghost[name]), { class: "line ghost", stroke: `var(${colour})` });
    for (const { name, colour, dashed } of lines) {
      axes.path(points(series[name]), { class: "line", stroke: `var(${colour})`, ...(dashed ? { "stroke-dasharray": "6 4" } : {}) });
    }
    if (run) {
      for (const { name, colour } of lines) {
        const values = run.readings[name];
        if (!values) continue;
        const every = Math.max(1, Math.ceil(values.length / 60));
        for (let i = 0; i < values.length; i += every) {
          if (values[i] === null || run.times[i] > this.tyre.end) continue;
          shape(axes.svg, "circle", { cx: axes.x(run.times[i] / this.divisor).toFixed(1), cy: axes.y(values[i]).toFixed(1), r: 2.4, fill: "var(--card)", stroke: `var(${colour})`, "stroke-width": 1.2 });
        }
      }
    }
    this.cursor = shape(axes.svg, "line", { class: "cursor", y1: axes.inner.top, y2: axes.inner.bottom });
    this.moveTo(time);
  }

  moveTo(time) {
    if (!this.cursor) return;
    const x = this.axes.x(time / this.divisor);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
  }
}

/* The line along which the worst limit is just met, over two numbers; found in slices, so that the page stays quick. */
class Envelope {
  constructor(margin, count = 13) {
    this.margin = margin;
    this.count = count;
    this.ticket = 0;
  }

  /* Points [u, {at, safe, safeBelow}]: where the margin is 0 over v, or on which side the whole column lies. */
  start(numbers, x, y, box, done) {
    const ticket = ++this.ticket, points = [];
    const at = (u, v) => {
      const setting = numbers.slice();
      setting[x] = u;
      setting[y] = v;
      return this.margin(setting);
    };
    const column = (u) => this.root((v) => at(u, v), box.y[0], box.y[1]);
    let number = 0;
    const slice = () => {
      if (ticket !== this.ticket) return;
      const began = performance.now();
      while (number < this.count && performance.now() - began < 14) {
        const u = box.x[0] + (box.x[1] - box.x[0]) * number / (this.count - 1), root = column(u);
        const before = points.length ? points[points.length - 1] : null;
        if (before && (before[1].at === null) !== (root.at === null)) this.leave(at, before, [u, root], box, points);
        points.push([u, root]);
        number++;
      }
      done(points, number >= this.count);
      if (number < this.count) setTimeout(slice, 12);
    };
    slice();
  }

  /* The place where the line leaves the box through its upper or lower edge, between two columns. */
  leave(at, before, after, box, points) {
    const [inside, beyond] = before[1].at !== null ? [before, after] : [after, before];
    const edge = inside[1].safeBelow === beyond[1].safe ? box.y[1] : box.y[0];
    const root = this.root((u) => at(u, edge), before[0], after[0]);
    if (root.at !== null) points.push([root.at, { at: edge, safeBelow: inside[1].safeBelow }]);
  }

  /* Place of the sign change between the ends: {at, safe, safeBelow}; margin > 0 is beyond the limit. */
  root(f, low, high) {
    let a = low, b = high, fa = f(a), fb = f(b);
    const below = fa <= 0;
    if (below === (fb <= 0)) return { at: null, safe: below };
    for (let k = 0; k < 7 && Math.abs(b - a) > 2e-4 * Math.abs(high - low); k++) {
      /* Illinois' false position keeps the bracket. */
      let c = (a * fb - b * fa) / (fb - fa);
      if (!(c > Math.min(a, b) && c < Math.max(a, b))) c = (a + b) / 2;
      const fc = f(c);
      if (Math.abs(fc) < 1e-3) return { at: c, safeBelow: below };
      if ((fc <= 0) === (fa <= 0)) { a = c; fa = fc; fb /= 2; } else { b = c; fb = fc; fa /= 2; }
    }
    return { at: (a + b) / 2, safeBelow: below };
  }
}

class EnvelopeChart {
  constructor(host) {
    this.axes = new Axes(host, 250, "Safe envelope");
    this.axes.margins.left = 50;
  }

  /* points: [[u, {at, safe, safeBelow}]]; here: [u, v]; pins: [[u, v, name]] */
  draw(points, box, here, over, pins, titles, finished) {
    const axes = this.axes, wide = (pair, at) => {
      const span = pair[1] - pair[0], low = Math.min(pair[0], at), high = Math.max(pair[1], at);
      return [low - 0.02 * span, high + 0.02 * span];
    };
    axes.begin(wide(box.x, here[0]), wide(box.y, here[1]), titles[0], titles[1]);
    axes.back.remove();
    const back = document.createElementNS(SVG, "g");
    axes.svg.prepend(back);
    const top = axes.y(box.y[1]), bottom = axes.y(box.y[0]);
    for (let i = 0; i + 1 < points.length; i++) {
      const [[u, first], [w, second]] = [points[i], points[i + 1]], a = axes.x(u), b = axes.x(w);
      if (first.at === null || second.at === null) {
        const whole = first.at === null ? first : second;
        shape(back, "rect", { class: whole.safe ? "safe" : "unsafe", x: a, width: b - a, y: top, height: bottom - top });
      } else {
        const ya = axes.y(first.at), yb = axes.y(second.at), below = first.safeBelow;
        shape(back, "polygon", { class: below ? "unsafe" : "safe", points: `${a},${top} ${b},${top} ${b},${yb} ${a},${ya}` });
        shape(back, "polygon", { class: below ? "safe" : "unsafe", points: `${a},${ya} ${b},${yb} ${b},${bottom} ${a},${bottom}` });
      }
    }
    let stretch = [];
    for (const [u, root] of [...points, [0, { at: null }]]) {
      if (root.at !== null) stretch.push([u, root.at]);
      else { if (stretch.length > 1) axes.path(stretch, { class: "edge" }); stretch = []; }
    }
    shape(axes.svg, "rect", { class: "axis", fill: "none", x: axes.x(box.x[0]), y: axes.y(box.y[1]), width: axes.x(box.x[1]) - axes.x(box.x[0]), height: axes.y(box.y[0]) - axes.y(box.y[1]) });
    const x = axes.x(here[0]), y = axes.y(here[1]);
    shape(axes.svg, "line", { class: "cross", x1: axes.inner.left, x2: axes.inner.right, y1: y, y2: y });
    shape(axes.svg, "line", { class: "cross", x1: x, x2: x, y1: axes.inner.top, y2: axes.inner.bottom });
    for (const [u, v, name] of pins) {
      shape(axes.svg, "circle", { cx: axes.x(u), cy: axes.y(v), r: 4, fill: "none", stroke: "var(--quiet)", "stroke-width": 1.5 });
      shape(axes.svg, "text", { x: axes.x(u) + 7, y: axes.y(v) - 5 }, name);
    }
    shape(axes.svg, "circle", { class: over ? "here over" : "here", cx: x, cy: y, r: 6.5 });
    this.axes.svg.style.opacity = finished ? 1 : 0.75;
  }
}
