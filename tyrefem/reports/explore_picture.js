/* The section on a canvas: every pixel knows its triangle, so that a new field costs three products a pixel. */
const SHOWN_LEVELS = 9;

/* Steps 1, 2, 5 x 10^k that give about `count` intervals. */
function niceStep(span, count) {
  const raw = Math.max(span, 1e-9) / count, power = 10 ** Math.floor(Math.log10(raw)), part = raw / power;
  return (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10) * power;
}

/* A name that leaves room for the rest. */
const LONGEST = 30;
function cut(name) { return name.length > LONGEST ? `${name.slice(0, LONGEST - 1)}…` : name; }

class FieldModes {
  constructor(stored) {
    const kinds = decoded({ points: stored.points, triangles: stored.triangles, modes: stored.modes, low: stored.low, step: stored.step, turn: stored.turn, hot: stored.hot });
    this.points = kinds.points;
    this.triangles = kinds.triangles;
    this.hot = kinds.hot;
    this.turn = kinds.turn;
    const [count, size] = kinds.modes.shape;
    this.count = count;
    this.size = size;
    this.modes = new Float32Array(count * size);
    for (let i = 0; i < count; i++) {
      for (let k = 0; k < size; k++) this.modes[i * size + k] = kinds.low[k] + kinds.step[k] * kinds.modes[i * size + k];
    }
    this.amplitudes = new Float64Array(size);
  }

  /* Temperatures at all nodes for a state, degC. */
  field(state, result = new Float32Array(this.count)) {
    const { size, count, modes, amplitudes } = this;
    times(this.turn, size, size, state, amplitudes);
    for (let i = 0; i < count; i++) {
      const row = i * size;
      let a = 0, b = 0, c = 0, d = 0, k = 0;
      for (; k + 3 < size; k += 4) {
        a += modes[row + k] * amplitudes[k]; b += modes[row + k + 1] * amplitudes[k + 1];
        c += modes[row + k + 2] * amplitudes[k + 2]; d += modes[row + k + 3] * amplitudes[k + 3];
      }
      for (; k < size; k++) a += modes[row + k] * amplitudes[k];
      result[i] = a + b + c + d;
    }
    return result;
  }
}

class SectionPicture {
  /* modes: FieldModes; stored: data.picture; options: {sensors, colours, small} */
  constructor(canvas, modes, stored, options) {
    Object.assign(this, { canvas, modes, mirror: stored.mirror, regions: stored.regions, sensors: options.sensors || [], small: Boolean(options.small) });
    this.outlines = stored.outlines.map((line) => decoded({ line }).line);
    this.colours = options.colours;
    this.context = canvas.getContext("2d");
    let [low, high, left, right] = [Infinity, -Infinity, Infinity, -Infinity];
    const p = modes.points;
    for (let i = 0; i < modes.count; i++) {
      low = Math.min(low, p[2 * i]); high = Math.max(high, p[2 * i]);
      left = Math.min(left, p[2 * i + 1]); right = Math.max(right, p[2 * i + 1]);
    }
    this.range = { low, high, left: this.mirror ? -Math.max(right, -left) : left, right: this.mirror ? Math.max(right, -left) : right };
    this.raster = document.createElement("canvas");
    this.showContours = true;
    this.showLabels = true;
  }

  /* Fit to the canvas's size on the page; the map from pixels to triangles is made here. */
  resize(width, dark) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2), r = this.range;
    const plain = this.small || width < 560, bar = this.small ? 6 : plain ? 44 : 52;
    this.context.font = "11.5px system-ui, sans-serif";
    const widest = (names) => Math.max(0, ...names.map((name) => this.context.measureText(name).width));
    const left = plain ? 8 : 20 + widest(this.regions.map((region) => cut(region.name))), right = plain ? 8 : 62 + widest(this.sensors.map((sensor) => cut(sensor.name)));
    this.margins = { left, right: right + bar, top: 10, bottom: this.small ? 6 : 10 };
    const across = r.right - r.left, up = r.high - r.low;
    const most = this.small ? 320 : plain ? Math.max(170, Math.min(0.31 * window.innerHeight, 290)) : Math.max(420, Math.min(640, 0.72 * window.innerHeight));
    this.scale = Math.min((width - this.margins.left - this.margins.right) / across, (most - this.margins.top - this.margins.bottom) / up);
    const height = Math.round(up * this.scale + this.margins.top + this.margins.bottom);
    this.width = width;
    this.height = height;
    this.barWidth = bar;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.height = `${height}px`;
    this.ratio = ratio;
    this.dark = dark;
    this.offset = this.margins.left + (width - this.margins.left - this.margins.right - across * this.scale) / 2;
    this.makeRaster();
  }

  x(z) { return this.offset + (z - this.range.left) * this.scale; }
  y(r) { return this.margins.top + (this.range.high - r) * this.scale; }

  makeRaster() {
    const { points, triangles } = this.modes, r = this.range;
    /* A half section is rastered once and drawn twice. */
    let lowest = Infinity, highest = -Infinity;
    for (let i = 0; i < this.modes.count; i++) {
      lowest = Math.min(lowest, points[2 * i + 1]);
      highest = Math.max(highest, points[2 * i + 1]);
    }
    this.rasterLeft = lowest;
    this.rasterSpan = highest - lowest;
    const fine = this.scale * Math.min(this.ratio, 1.5);
    const width = Math.max(2, Math.ceil(this.rasterSpan * fine)), height = Math.max(2, Math.ceil((r.high - r.low) * fine));
    this.raster.width = width;
    this.raster.height = height;
    this.image = this.raster.getContext("2d").createImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    const owner = new Int32Array(width * height).fill(-1), w0 = new Float32Array(width * height), w1 = new Float32Array(width * height);
    const count = triangles.length / 3;
    for (let t = 0; t < count; t++) {
      const i = triangles[3 * t], j = triangles[3 * t + 1], k = triangles[3 * t + 2];
      const xi = (points[2 * i + 1] - lowest) * fine, yi = (r.high - points[2 * i]) * fine;
      const xj = (points[2 * j + 1] - lowest) * fine, yj = (r.high - points[2 * j]) * fine;
      const xk = (points[2 * k + 1] - lowest) * fine, yk = (r.high - points[2 * k]) * fine;
      const area = (xj - xi) * (yk - yi) - (xk - xi) * (yj - yi);
      if (Math.abs(area) < 1e-12) continue;
      const top = Math.max(0, Math.floor(Math.min(yi, yj, yk) - 0.5)), bottom = Math.min(height - 1, Math.ceil(Math.max(yi, yj, yk)));
      const first = Math.max(0, Math.floor(Math.min(xi, xj, xk) - 0.5)), last = Math.min(width - 1, Math.ceil(Math.max(xi, xj, xk)));
      for (let y = top; y <= bottom; y++) {
        for (let x = first; x <= last; x++) {
          const px = x + 0.5, py = y + 0.5;
          const b = ((px - xi) * (yk - yi) - (xk - xi) * (py - yi)) / area, c = ((xj - xi) * (py - yi) - (px - xi) * (yj - yi)) / area, a = 1 - b - c;
          /* A little over the edge: no gaps at the rim of the section. */
          if (a < -0.02 || b < -0.02 || c < -0.02) continue;
          const place = y * width + x;
          if (owner[place] >= 0 && Math.min(a, b, c) < 0) continue;
          owner[place] = t;
          w0[place] = a;
          w1[place] = b;
        }
      }
    }
    let inside = 0;
    for (let i = 0; i < owner.length; i++) if (owner[i] >= 0) inside++;
    this.place = new Int32Array(inside);
    this.corner = new Int32Array(3 * inside);
    this.share = new Float32Array(2 * inside);
    let n = 0;
    for (let i = 0; i < owner.length; i++) {
      if (owner[i] < 0) continue;
      this.place[n] = i;
      for (let k = 0; k < 3; k++) this.corner[3 * n + k] = triangles[3 * owner[i] + k];
      this.share[2 * n] = w0[i];
      this.share[2 * n + 1] = w1[i];
      n++;
    }
    this.owner = owner;
    this.fine = fine;
  }

  /* Draw a field between two colours; `marks`: {readings, hottest: [r, z, text]}. */
  draw(field, low, high, marks = {}, palette = this.colours) {
    const { place, corner, share, pixels } = this, scale = 255 / Math.max(high - low, 1e-9);
    for (let n = 0, k = 0, m = 0; n < place.length; n++, k += 3, m += 2) {
      const a = share[m], b = share[m + 1], T = a * field[corner[k]] + b * field[corner[k + 1]] + (1 - a - b) * field[corner[k + 2]];
      const colour = (T - low) * scale;
      pixels[place[n]] = palette[colour < 0 ? 0 : colour > 255 ? 255 : colour | 0];
    }
    const raster = this.raster.getContext("2d");
    raster.putImageData(this.image, 0, 0);
    const c = this.context, top = this.y(this.range.high), height = (this.range.high - this.range.low) * this.scale;
    this.field = field;
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    c.clearRect(0, 0, this.width, this.height);
    c.imageSmoothingEnabled = true;
    c.drawImage(this.raster, this.x(this.rasterLeft), top, this.raster.width / this.fine * this.scale, this.raster.height / this.fine * this.scale);
    if (this.mirror) {
      c.save();
      c.translate(2 * this.x(0), 0);
      c.scale(-1, 1);
      c.drawImage(this.raster, this.x(this.rasterLeft), top, this.raster.width / this.fine * this.scale, this.raster.height / this.fine * this.scale);
      c.restore();
    }
    const levels = this.levels(field, marks.step);
    if (this.showContours) this.drawContours(field, levels);
    this.drawOutlines();
    if (!this.small) {
      this.drawBar(low, high, palette, levels, top, height, marks.limit);
      if (this.showLabels && this.width >= 560) this.drawRegions();
      this.drawSensors(marks.readings || {});
    }
    if (marks.hottest) this.drawHottest(...marks.hottest);
  }

  levels(field, step) {
    let low = Infinity, high = -Infinity;
    for (const T of field) { if (T < low) low = T; if (T > high) high = T; }
    this.lowest = low;
    this.highest = high;
    if (!(high - low > 0.01)) return [];
    const width = step || niceStep(high - low, SHOWN_LEVELS), levels = [];
    for (let level = Math.ceil(low / width) * width; level < high; level += width) levels.push(level);
    this.step = width;
    return levels;
  }

  /* Marching triangles: all isotherms in one path. */
  drawContours(field, levels) {
    const { points, triangles } = this.modes, c = this.context, paths = new Path2D();
    if (!levels.length) return;
    const step = levels.length > 1 ? levels[1] - levels[0] : 1, first = levels[0];
    for (let t = 0; t < triangles.length; t += 3) {
      const i = triangles[t], j = triangles[t + 1], k = triangles[t + 2], a = field[i], b = field[j], d = field[k];
      const low = Math.min(a, b, d), high = Math.max(a, b, d);
      for (let n = Math.max(0, Math.ceil((low - first) / step)); n < levels.length && levels[n] < high; n++) {
        const level = levels[n];
        let begun = false;
        for (const [p, q, u, v] of [[i, j, a, b], [j, k, b, d], [k, i, d, a]]) {
          if ((u < level) === (v < level)) continue;
          const part = (level - u) / (v - u);
          const x = this.x(points[2 * p + 1] + part * (points[2 * q + 1] - points[2 * p + 1])), y = this.y(points[2 * p] + part * (points[2 * q] - points[2 * p]));
          if (begun) paths.lineTo(x, y); else paths.moveTo(x, y);
          begun = true;
        }
      }
    }
    c.lineWidth = 0.9;
    c.strokeStyle = "rgba(255, 255, 255, 0.55)";
    c.stroke(paths);
    if (this.mirror) {
      c.save();
      c.translate(2 * this.x(0), 0);
      c.scale(-1, 1);
      c.stroke(paths);
      c.restore();
    }
  }

  drawOutlines() {
    const c = this.context, sides = this.mirror ? [1, -1] : [1];
    c.strokeStyle = this.dark ? "rgba(230, 235, 240, .6)" : "rgba(25, 30, 35, .62)";
    c.lineWidth = this.small ? 0.6 : 0.85;
    c.lineJoin = "round";
    c.beginPath();
    for (const side of sides) {
      for (const line of this.outlines) {
        for (let i = 0; i < line.length; i += 2) {
          const x = this.x(side * line[i + 1]), y = this.y(line[i]);
          if (i) c.lineTo(x, y); else c.moveTo(x, y);
        }
      }
    }
    c.stroke();
  }

  ink(quiet) { return this.dark ? (quiet ? "#98a2ac" : "#e6e9ec") : quiet ? "#5d6670" : "#1c2126"; }

  drawBar(low, high, palette, levels, top, height, limit) {
    const c = this.context, x = this.width - this.barWidth + 8, wide = 10, whole = Math.min(height, this.height - top - 6);
    for (let i = 0; i < whole; i++) {
      const value = palette[Math.round(255 * (1 - i / whole))];
      c.fillStyle = `rgb(${value & 255}, ${value >> 8 & 255}, ${value >> 16 & 255})`;
      c.fillRect(x, top + i, wide, 1.5);
    }
    c.font = "11px system-ui, sans-serif";
    c.textBaseline = "middle";
    c.textAlign = "left";
    const step = niceStep(high - low, Math.max(3, Math.min(8, whole / 38)));
    for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + 1e-9; value += step) {
      const y = top + whole * (1 - (value - low) / (high - low));
      c.fillStyle = this.ink(true);
      c.fillText(Number(value.toFixed(6)).toString(), x + wide + 5, Math.min(Math.max(y, 7), this.height - 7));
    }
    c.strokeStyle = "rgba(255, 255, 255, .75)";
    c.lineWidth = 0.9;
    c.beginPath();
    if (this.showContours) {
      for (const level of levels) {
        const y = top + whole * (1 - (level - low) / (high - low));
        if (y > top && y < top + whole) { c.moveTo(x, y); c.lineTo(x + wide, y); }
      }
    }
    c.stroke();
    if (limit !== undefined && limit > low && limit < high) {
      const y = top + whole * (1 - (limit - low) / (high - low));
      c.fillStyle = this.dark ? "#ff8a80" : "#b3261e";
      c.beginPath(); c.moveTo(x - 2, y); c.lineTo(x - 8, y - 4); c.lineTo(x - 8, y + 4); c.fill();
    }
  }

  /* Places of labels on one side: as near to their points as they fit. */
  spread(labels, gap) {
    labels.sort((a, b) => a.y - b.y);
    const top = 12, bottom = this.height - 10;
    labels.forEach((label, i) => { label.at = Math.max(label.y, i ? labels[i - 1].at + gap : top); });
    for (let i = labels.length - 1, limit = bottom; i >= 0; i--) {
      labels[i].at = Math.min(labels[i].at, limit);
      limit = labels[i].at - gap;
    }
    return labels;
  }

  drawRegions() {
    const c = this.context, side = this.mirror ? -1 : 1, edge = this.x(this.range.left) - 8;
    const labels = this.regions.map((region) => ({ text: cut(region.name.replaceAll("-", " ")), x: this.x(side * Math.abs(region.z)), y: this.y(region.r) }));
    if (!this.mirror) labels.forEach((label, i) => { label.x = this.x(this.regions[i].z); });
    c.font = "11.5px system-ui, sans-serif";
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const label of this.spread(labels, 14)) {
      c.strokeStyle = this.dark ? "rgba(230, 235, 240, .38)" : "rgba(25, 30, 35, .35)";
      c.lineWidth = 0.8;
      c.beginPath(); c.moveTo(edge + 3, label.at); c.lineTo(label.x, label.y); c.stroke();
      c.fillStyle = this.ink(true);
      c.fillText(label.text, edge, label.at);
    }
  }

  drawSensors(readings) {
    const c = this.context, edge = this.x(this.range.right) + 10, wide = this.showLabels && this.width >= 560;
    const labels = this.sensors.map((sensor) => ({ ...sensor, x: this.x(sensor.z), y: this.y(sensor.r) }));
    c.textAlign = "left";
    c.textBaseline = "middle";
    if (wide) {
      for (const label of this.spread(labels, 15)) {
        c.strokeStyle = this.dark ? "rgba(230, 235, 240, .38)" : "rgba(25, 30, 35, .35)";
        c.lineWidth = 0.8;
        c.beginPath(); c.moveTo(edge - 3, label.at); c.lineTo(label.x, label.y); c.stroke();
        c.font = "11.5px system-ui, sans-serif";
        c.fillStyle = this.ink(true);
        const value = readings[label.name];
        c.fillText(cut(label.name.replaceAll("-", " ")), edge + 40, label.at);
        c.font = "600 11.5px system-ui, sans-serif";
        c.fillStyle = this.ink(false);
        if (value !== undefined) c.fillText(value.toFixed(1), edge + 1, label.at);
      }
    }
    for (const label of labels) {
      c.beginPath(); c.arc(label.x, label.y, 4, 0, 7);
      c.fillStyle = label.colour; c.fill();
      c.lineWidth = 1.6; c.strokeStyle = "#fff"; c.stroke();
    }
  }

  drawHottest(r, z, text) {
    const c = this.context, x = this.x(this.mirror ? -Math.abs(z) : z), y = this.y(r), size = this.small ? 5 : 8;
    c.beginPath();
    for (let i = 0; i < 10; i++) {
      const angle = Math.PI * (i / 5 - 0.5), length = i % 2 ? 0.42 * size : size;
      c.lineTo(x + length * Math.cos(angle), y + length * Math.sin(angle));
    }
    c.closePath();
    c.fillStyle = "#fff"; c.fill();
    c.lineWidth = 1.1; c.strokeStyle = "#1c2126"; c.stroke();
    if (!text || this.small) return;
    c.font = "600 12px system-ui, sans-serif";
    c.textBaseline = "middle";
    const width = c.measureText(text).width, right = x + 12 + width < this.x(this.range.right);
    c.textAlign = right ? "left" : "right";
    c.lineWidth = 3;
    c.lineJoin = "round";
    c.strokeStyle = this.dark ? "rgba(19, 22, 26, .8)" : "rgba(255, 255, 255, .88)";
    c.strokeText(text, x + (right ? 12 : -12), y - 13);
    c.fillStyle = this.ink(false);
    c.fillText(text, x + (right ? 12 : -12), y - 13);
  }

  /* Temperature under a point of the canvas, and its (r, z) in mm; null outside the section. */
  under(px, py) {
    let z = (px - this.offset) / this.scale + this.range.left;
    const r = this.range.high - (py - this.margins.top) / this.scale;
    if (this.mirror && (z < this.rasterLeft || z > this.rasterLeft + this.rasterSpan)) z = -z;
    const x = Math.floor((z - this.rasterLeft) * this.fine), y = Math.floor((this.range.high - r) * this.fine);
    if (x < 0 || y < 0 || x >= this.raster.width || y >= this.raster.height || !this.field) return null;
    const t = this.owner[y * this.raster.width + x];
    if (t < 0) return null;
    const { points, triangles } = this.modes, i = triangles[3 * t], j = triangles[3 * t + 1], k = triangles[3 * t + 2];
    const area = (points[2 * j + 1] - points[2 * i + 1]) * (points[2 * k] - points[2 * i]) - (points[2 * k + 1] - points[2 * i + 1]) * (points[2 * j] - points[2 * i]);
    const b = ((z - points[2 * i + 1]) * (points[2 * k] - points[2 * i]) - (points[2 * k + 1] - points[2 * i + 1]) * (r - points[2 * i])) / area;
    const c = ((points[2 * j + 1] - points[2 * i + 1]) * (r - points[2 * i]) - (z - points[2 * i + 1]) * (points[2 * j] - points[2 * i])) / area;
    return { r, z, temperature: (1 - b - c) * this.field[i] + b * this.field[j] + c * this.field[k] };
  }
}
