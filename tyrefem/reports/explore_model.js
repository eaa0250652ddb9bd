"use strict";
/* A tyre at any setting: the same arithmetic as tyrefem/realtime/setting_tyre.py, on typed arrays.
   Numbers of a page and of Python agree to rounding; tests/explore compares them in a browser. */
const ATMOSPHERE = 101325.0, KELVIN = 273.15, STANDSTILL = 1e-6;

/* Arrays of the page: {name: {shape, type, data (base64)}} as Float64Array with a shape. */
function decoded(stored) {
  const arrays = {};
  for (const [name, { shape, type, data }] of Object.entries(stored)) {
    const text = atob(data), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    const kinds = { f8: Float64Array, f4: Float32Array, i2: Int16Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array };
    const values = new kinds[type](bytes.buffer);
    arrays[name] = type === "f4" ? Float64Array.from(values) : values;
    arrays[name].shape = shape;
  }
  return arrays;
}

/* Lagrange weights at u for values at 0, 1, ..., width - 1. */
function lagrange(u, width, w) {
  if (width === 4) {
    const a = u - 1, b = u - 2, c = u - 3;
    w[0] = a * b * c / -6; w[1] = u * b * c / 2; w[2] = u * a * c / -2; w[3] = u * a * b / 6;
  } else if (width === 3) {
    w[0] = (u - 1) * (u - 2) / 2; w[1] = u * (2 - u); w[2] = u * (u - 1) / 2;
  } else if (width === 2) {
    w[0] = 1 - u; w[1] = u;
  } else {
    w[0] = 1;
  }
}

/* Values on even axes: cubic through the four nearest points of every axis. `axes`: [[low, high], ...]. */
function lookUp(table, shape, axes, place) {
  const dimensions = place.length;
  let count = 1;
  for (let d = dimensions; d < shape.length; d++) count *= shape[d];
  let rows = [[0, 1]];
  for (let d = 0; d < dimensions; d++) {
    const n = shape[d], w = [0, 0, 0, 0];
    let first = 0, width = 1;
    if (n > 1) {
      const u = (place[d] - axes[d][0]) / (axes[d][1] - axes[d][0]) * (n - 1);
      width = Math.min(4, n);
      first = Math.min(Math.max(Math.trunc(u) - 1, 0), n - width);
      lagrange(u - first, width, w);
    } else {
      w[0] = 1;
    }
    const next = [];
    for (const [row, weight] of rows) {
      for (let k = 0; k < width; k++) next.push([row * n + first + k, weight * w[k]]);
    }
    rows = next;
  }
  const values = new Float64Array(count);
  for (const [row, weight] of rows) {
    const begin = row * count;
    for (let i = 0; i < count; i++) values[i] += weight * table[begin + i];
  }
  return values;
}

function axesOf(array) {
  const width = array.shape[1], axes = [];
  for (let d = 0; d < array.shape[0]; d++) axes.push([array[d * width], array[d * width + 1]]);
  return axes;
}

/* Product of n entries of a, from a place on, and of b, from another. */
function dotFrom(a, from, b, to, n) {
  let p = 0, q = 0, r = 0, s = 0, i = 0;
  for (; i + 3 < n; i += 4) {
    p += a[from + i] * b[to + i]; q += a[from + i + 1] * b[to + i + 1];
    r += a[from + i + 2] * b[to + i + 2]; s += a[from + i + 3] * b[to + i + 3];
  }
  for (; i < n; i++) p += a[from + i] * b[to + i];
  return p + q + (r + s);
}
function dot(a, from, b, n) { return dotFrom(a, from, b, 0, n); }

/* y = A x, A row by row. */
function times(A, rows, columns, x, y) {
  for (let i = 0; i < rows; i++) y[i] = dot(A, i * columns, x, columns);
}

/* L with L L' = W in the lower triangle of W, L' in L's upper one; false if W is not positive. Only whole rows are read. */
function factored(W, n) {
  for (let i = 0; i < n; i++) {
    const row = i * n;
    for (let j = 0; j < i; j++) {
      const value = (W[row + j] - dotFrom(W, row, W, j * n, j)) / W[j * n + j];
      W[row + j] = value;
      W[j * n + i] = value;
    }
    const square = W[row + i] - dotFrom(W, row, W, row, i);
    if (!(square > 0)) return false;
    W[row + i] = Math.sqrt(square);
  }
  return true;
}

/* x := (L L')^-1 x */
function solved(W, n, x) {
  for (let k = 0; k < n; k++) x[k] = (x[k] - dot(W, k * n, x, k)) / W[k * n + k];
  for (let k = n - 1; k >= 0; k--) x[k] = (x[k] - dotFrom(W, k * n + k + 1, x, k + 1, n - k - 1)) / W[k * n + k];
}

class SettingTyre {
  constructor(arrays, about) {
    this.arrays = arrays;
    this.about = about;
    this.size = arrays.rates.length;
    this.count = this.size + arrays.capacity.length;
    this.hasGas = arrays.gas.length > 0;
    this.samples = arrays.loss_row.length;
    this.exchanges = arrays.sink.shape[0];
    this.lagging = [];
    for (let i = 0; i < arrays.lag.length; i++) if (arrays.lag[i] > 0) this.lagging.push(i);
    this.filmAxes = axesOf(arrays.film_axes);
    this.heatAxes = axesOf(arrays.heat_axes);
    this.bendAxes = axesOf(arrays.bend_axes);
    this.hotParts = [];
    let first = 0;
    for (const [name, count] of about.hot) {
      this.hotParts.push([name, first, first + count]);
      first += count;
    }
    this.hotCount = first;
    this.times = [0];
    this.first = [0];
    for (let i = 0; i < arrays.step_lengths.length; i++) {
      this.times.push(this.times[i] + arrays.step_lengths[i]);
      if (i && arrays.step_phases[i] !== arrays.step_phases[i - 1]) this.first.push(i);
    }
    this.end = this.times[this.times.length - 1];
  }

  /* Name of a sensor's highest temperature; a sensor named as a region leaves the plain name to the region. */
  highestName(sensor) {
    return this.hotParts.some(([region]) => region === sensor) ? `${sensor}_sensor_max_degC` : `${sensor}_max_degC`;
  }

  /* Places of numbers in the box: 0 and 1 are its ends. */
  place(numbers) {
    const { low, high, log } = this.arrays;
    return Array.from(numbers, (x, i) => log[i] > 0
      ? Math.log(x / low[i]) / Math.log(high[i] / low[i]) : (x - low[i]) / (high[i] - low[i]));
  }

  /* March the drive at a setting. */
  solve(numbers) {
    const c = new Coefficients(this, numbers), a = this.arrays, n = this.count, steps = a.step_lengths.length;
    const states = new Float64Array((steps + 1) * n), late = new Float64Array((steps + 1) * this.lagging.length);
    const y = states.subarray(0, n), lags = this.lagging;
    for (let i = 0; i < this.size; i++) y[i] = c.initial * a.even[i];
    for (let i = this.size; i < n; i++) y[i] = c.lumpedStart[i - this.size];
    for (let k = 0; k < lags.length; k++) late[k] = c.initial;
    let elapsed = 0;
    for (let number = 0; number < steps; number++) {
      const h = a.step_lengths[number], phase = a.step_phases[number];
      if (number && phase !== a.step_phases[number - 1]) elapsed = 0;
      const before = states.subarray(number * n, (number + 1) * n), after = states.subarray((number + 1) * n, (number + 2) * n);
      c.step(h, c.inputsAt(phase, elapsed), c.inputsAt(phase, elapsed + h), before, after);
      for (let k = 0; k < lags.length; k++) {
        const lag = a.lag[lags[k]], row = lags[k] * n;
        const read = dot(a.read, row, before, n), ahead = dot(a.read, row, after, n), behind = lag * (ahead - read) / h;
        late[(number + 1) * lags.length + k] = ahead - behind + (late[number * lags.length + k] - read + behind) * Math.exp(-h / lag);
      }
      elapsed += h;
    }
    return new Solution(this, c, states, late);
  }
}

class Coefficients {
  constructor(tyre, numbers) {
    const a = tyre.arrays, m = tyre.size, n = tyre.count;
    this.tyre = tyre;
    const width = a.input_constant.length;
    this.inputs = Float64Array.from(a.input_constant);
    for (let k = 0; k < numbers.length; k++) {
      for (let i = 0; i < width; i++) this.inputs[i] += numbers[k] * a.input_slopes[k * width + i];
    }
    this.initial = this.inputs[width - 1];
    const place = tyre.place(numbers);
    const bodies = Float64Array.from(a.middle_bodies), share = new Float64Array(bodies.length);
    this.loss = Float64Array.from(a.loss_table);
    this.lossWidth = a.loss_table.shape[1];
    this.heatFactor = new Float64Array(tyre.samples).fill(1);
    this.sinkAddend = new Float64Array(tyre.exchanges);
    this.filmFactor = new Float64Array(a.speeds.length * tyre.exchanges).fill(1);
    this.standingFactor = new Float64Array(tyre.exchanges).fill(1);
    const capacity = new Float64Array(a.capacity.length).fill(1);
    const targets = {
      bodies, films: this.filmFactor, standing: this.standingFactor, heat: this.heatFactor, capacities: capacity,
    };
    for (const [number, part] of tyre.about.factors) {
      const table = a[`factor_${number}_${part}`];
      const factor = lookUp(table, table.shape, [[0, 1]], [place[number]]);
      if (part === "sinks") {
        for (let i = 0; i < factor.length; i++) this.sinkAddend[i] += factor[i];
      } else if (part === "loss") {
        const columns = table.shape[2], zones = table.shape[1];
        for (let z = 0; z < zones; z++) {
          for (let i = 0; i < this.lossWidth; i++) this.loss[z * this.lossWidth + i] *= factor[z * columns + (columns > 1 ? i : 0)];
        }
      } else {
        const target = targets[part];
        for (let i = 0; i < factor.length; i++) target[i] *= factor[i];
      }
    }
    for (let i = 0; i < share.length; i++) share[i] = bodies[i] / a.middle_bodies[i] - 1;
    this.K = new Float64Array(n * n);
    for (let i = 0; i < m; i++) this.K[i * n + i] = a.rates[i];
    const regions = a.middle_bodies.shape[0];
    const addPart = (to, part, from, factor) => {
      if (factor === 0) return;
      for (let i = 0; i < m; i++) {
        for (let j = 0; j < m; j++) to[i * n + j] += factor * part[from + i * m + j];
      }
    };
    this.M = null;
    for (let r = 0; r < regions; r++) {
      for (let d = 0; d < 2; d++) addPart(this.K, a.stiffness_parts, (r * 2 + d) * m * m, share[r * 3 + d]);
      if (share[r * 3 + 2] !== 0) {
        if (!this.M) {
          this.M = new Float64Array(n * n);
          for (let i = 0; i < m; i++) this.M[i * n + i] = 1;
        }
        addPart(this.M, a.mass_parts, r * m * m, share[r * 3 + 2]);
      }
    }
    this.mass = new Float64Array(n).fill(1);
    for (let i = m; i < n; i++) this.mass[i] = a.capacity[i - m] * capacity[i - m];
    this.lumpedStart = Array.from(a.lumped_start, (start) => Number.isNaN(start) ? this.initial : start);
    this.airStart = tyre.hasGas ? this.lumpedStart[0] : a.held[0];
    if (tyre.hasGas) {
      this.mass[m] = (a.gas[0] + a.gas[1] * (this.inputs[2] + ATMOSPHERE) / (this.airStart + KELVIN)) * capacity[0];
    }
    if (this.M) for (let i = m; i < n; i++) this.M[i * n + i] = this.mass[i];
    this.key = this.motion = "";
    this.A = new Float64Array(n * n);
    this.U = new Float64Array(n * n);
    this.sinks = new Float64Array(4 * n);
    for (const name of ["u", "v", "rate", "guess", "constant"]) this[name] = new Float64Array(n);
    for (const name of ["made", "later"]) this[name] = new Float64Array(tyre.samples);
  }

  inputsAt(phase, elapsed) {
    const share = elapsed / this.tyre.arrays.durations[phase], begin = phase * 10, now = new Float64Array(5);
    for (let i = 0; i < 5; i++) now[i] = this.inputs[begin + i] + (this.inputs[begin + 5 + i] - this.inputs[begin + i]) * share;
    return now;
  }

  bend(load, pressure) {
    const a = this.tyre.arrays;
    return lookUp(a.bend_table, a.bend_table.shape, this.tyre.bendAxes, [Math.sqrt(load), pressure])[0];
  }

  films(speed, load, pressure) {
    const a = this.tyre.arrays, count = this.tyre.exchanges;
    if (speed < STANDSTILL) {
      return Float64Array.from(a.film_standing, (film, j) => film * this.standingFactor[j]);
    }
    const root = Math.sqrt(speed);
    const films = lookUp(a.film_table, a.film_table.shape, this.tyre.filmAxes, [root, this.bend(load, pressure), pressure]);
    const factor = lookUp(this.filmFactor, [a.speeds.length, count], [this.tyre.filmAxes[0]], [root]);
    for (let j = 0; j < count; j++) films[j] *= factor[j];
    return films;
  }

  /* Heat per unit of tan delta at the samples, W/m3. */
  heat(speed, load, pressure) {
    const a = this.tyre.arrays;
    const heat = lookUp(a.heat_table, a.heat_table.shape, this.tyre.heatAxes, [this.bend(load, pressure), pressure]);
    for (let i = 0; i < heat.length; i++) heat[i] *= speed * this.heatFactor[i];
    return heat;
  }

  /* Heat at the samples: tan delta from its table, times what one unit of it makes. */
  makeHeat(heat, y, made) {
    const a = this.tyre.arrays, m = this.tyre.size, cold = a.loss_axis[0], spacing = a.loss_axis[1], width = this.lossWidth;
    for (let i = 0; i < heat.length; i++) {
      let place = (dot(a.at_samples, i * m, y, m) - cold) / spacing;
      place = Math.min(Math.max(place, 0), width - 1.001);
      const left = Math.trunc(place), row = a.loss_row[i] * width + left, below = this.loss[row];
      made[i] = heat[i] * (below + (place - left) * (this.loss[row + 1] - below));
    }
  }

  prepare(h, speed, load, pressure) {
    const motion = `${speed} ${load} ${pressure}`, key = `${h} ${motion}`;
    if (this.key === key) return;
    const n = this.tyre.count, A = this.A, U = this.U;
    if (this.motion !== motion) this.surround(speed, load, pressure);
    this.motion = motion;
    const share = GAMMA * h;
    for (let i = 0; i < n * n; i++) U[i] = share * A[i];
    if (this.M) {
      for (let i = 0; i < n * n; i++) U[i] += this.M[i];
    } else {
      for (let i = 0; i < n; i++) U[i * n + i] += this.mass[i];
    }
    if (!factored(U, n)) throw new Error("the matrix of a step is not positive");
    this.key = key;
  }

  /* Films, sinks and heat of a motion. */
  surround(speed, load, pressure) {
    const tyre = this.tyre, a = tyre.arrays, n = tyre.count, films = this.films(speed, load, pressure), A = this.A;
    A.set(this.K);
    this.sinks.fill(0);
    for (let j = 0; j < tyre.exchanges; j++) {
      const film = films[j], begin = j * n * n;
      for (let i = 0; i < n * n; i++) A[i] += film * a.exchange[begin + i];
      for (let k = 0; k < 4; k++) {
        const sink = film * (a.sink[j * 4 + k] + (k ? 0 : this.sinkAddend[j]));
        for (let i = 0; i < n; i++) this.sinks[k * n + i] += sink * a.exchange_load[j * n + i];
      }
    }
    this.heatNow = this.heat(speed, load, pressure);
  }

  surroundings(inputs, heat) {
    const s = this.sinks, n = this.tyre.count;
    for (let i = 0; i < n; i++) heat[i] = s[i] + s[n + i] * inputs[3] + s[2 * n + i] * inputs[4] + s[3 * n + i] * this.initial;
  }

  /* result += h sum_j b_j (W^-1 M)^j W^-1 rate; `rate` is used up. */
  addTerms(h, weights, rate, result) {
    const n = this.tyre.count;
    for (let j = 0; j < weights.length; j++) {
      if (j) {
        if (this.M) {
          times(this.M, n, n, rate, this.v);
          rate.set(this.v);
        } else {
          for (let i = this.tyre.size; i < n; i++) rate[i] *= this.mass[i];
        }
      }
      solved(this.U, n, rate);
      const weight = h * weights[j];
      for (let i = 0; i < n; i++) result[i] += weight * rate[i];
    }
  }

  /* The state after h seconds. */
  step(h, first, last, y, after) {
    const tyre = this.tyre, a = tyre.arrays, n = tyre.count, m = tyre.size, rate = this.rate, constant = this.constant;
    this.prepare(h, (first[0] + last[0]) / 2, (first[1] + last[1]) / 2, (first[2] + last[2]) / 2);
    this.surroundings(first, constant);
    times(this.A, n, n, y, this.u);
    for (let i = 0; i < n; i++) rate[i] = constant[i] - this.u[i];
    this.makeHeat(this.heatNow, y, this.made);
    for (let i = 0; i < m; i++) rate[i] += dot(a.heating, i * tyre.samples, this.made, tyre.samples);
    after.set(y);
    this.addTerms(h, PHI, rate, after);
    this.makeHeat(this.heatNow, after, this.later);
    for (let i = 0; i < tyre.samples; i++) this.later[i] -= this.made[i];
    this.surroundings(last, rate);
    for (let i = 0; i < n; i++) rate[i] -= constant[i];
    for (let i = 0; i < m; i++) rate[i] += dot(a.heating, i * tyre.samples, this.later, tyre.samples);
    this.addTerms(h, PHI_2, rate, after);
  }

  /* Heat of hysteresis by region, whole tyre, W. */
  generated(y, inputs) {
    const a = this.tyre.arrays, samples = this.tyre.samples, made = new Float64Array(samples);
    this.makeHeat(this.heat(inputs[0], inputs[1], inputs[2]), y, made);
    const powers = new Float64Array(a.zone_power.shape[0]);
    times(a.zone_power, powers.length, samples, made, powers);
    return powers;
  }

  /* Heat lost through films, whole tyre, W. */
  lost(y, inputs) {
    const a = this.tyre.arrays, n = this.tyre.count, films = this.films(inputs[0], inputs[1], inputs[2]);
    const lost = new Float64Array(this.tyre.about.lost.length);
    for (let j = 0; j < lost.length; j++) {
      const sink = a.sink[j * 4] + a.sink[j * 4 + 1] * inputs[3] + a.sink[j * 4 + 2] * inputs[4] + a.sink[j * 4 + 3] * this.initial + this.sinkAddend[j];
      lost[j] = -films[j] * (dot(a.exchange_rows, j * n, y, n) + a.exchange_areas[j] * sink);
    }
    return lost;
  }
}

class Solution {
  constructor(tyre, coefficients, states, late) {
    Object.assign(this, { tyre, coefficients, states, late, times: tyre.times, first: tyre.first });
  }

  phase(t) {
    let number = 0;
    while (number + 1 < this.first.length && this.times[this.first[number + 1]] < t - 1e-9) number++;
    return number;
  }

  inputs(t) {
    const number = this.phase(t), elapsed = t - this.times[this.first[number]];
    return this.coefficients.inputsAt(number, Math.min(Math.max(elapsed, 0), this.tyre.arrays.durations[number]));
  }

  /* First step and weights of the cubic through four steps of the phase. */
  weights(t) {
    const number = this.phase(t), low = this.first[number];
    const high = number + 1 < this.first.length ? this.first[number + 1] : this.times.length - 1;
    const count = Math.min(4, high - low + 1);
    let place = low;
    while (place < this.times.length - 1 && this.times[place + 1] <= t) place++;
    const begin = Math.min(Math.max(place - 1, low), high - count + 1), weights = [];
    for (let i = 0; i < count; i++) {
      let weight = 1;
      for (let j = 0; j < count; j++) {
        if (i !== j) weight *= (t - this.times[begin + j]) / (this.times[begin + i] - this.times[begin + j]);
      }
      weights.push(weight);
    }
    return [begin, weights];
  }

  state(t) {
    const [begin, weights] = this.weights(t), n = this.tyre.count, y = new Float64Array(n);
    for (let k = 0; k < weights.length; k++) {
      for (let i = 0; i < n; i++) y[i] += weights[k] * this.states[(begin + k) * n + i];
    }
    return y;
  }

  readings(t, y = this.state(t)) {
    const a = this.tyre.arrays, n = this.tyre.count, read = [], [begin, weights] = this.weights(t), lags = this.tyre.lagging;
    for (let i = 0; i < this.tyre.about.read.length; i++) read.push(dot(a.read, i * n, y, n));
    for (let k = 0; k < lags.length; k++) {
      let value = 0;
      for (let i = 0; i < weights.length; i++) value += weights[i] * this.late[(begin + i) * lags.length + k];
      read[lags[k]] = value;
    }
    return read;
  }

  /* Everything that is shown at a time: name -> value (degC, Pa, N, W). */
  at(t) {
    const tyre = this.tyre, c = this.coefficients, y = this.state(t), inputs = this.inputs(t), values = {};
    this.readings(t, y).forEach((value, i) => { values[tyre.about.read[i]] = value; });
    const air = tyre.hasGas ? y[tyre.size] : c.airStart;
    values["contained-air"] = air;
    let hottest = -Infinity;
    for (const [name, from, to] of tyre.hotParts) {
      let highest = -Infinity;
      for (let i = from; i < to; i++) {
        const value = dot(tyre.arrays.hot, i * tyre.size, y, tyre.size);
        if (value > highest) highest = value;
        if (value > hottest) { hottest = value; values.hottest_place = i; values.hottest_region = name; }
      }
      values[`${name} max`] = highest;
    }
    values.hottest = hottest;
    values.gas_pressure = (inputs[2] + ATMOSPHERE) * (air + KELVIN) / (c.airStart + KELVIN) - ATMOSPHERE;
    const made = c.generated(y, inputs), lost = c.lost(y, inputs);
    let sum = 0, left = 0;
    made.forEach((value, i) => { values[tyre.about.heat[i]] = value; sum += value; });
    lost.forEach((value, i) => { values[tyre.about.lost[i]] = value; left += value; });
    values.stored = sum - left;
    values.generated = sum;
    values["lost and stored"] = left + values.stored;
    values.rolling_resistance = inputs[0] >= STANDSTILL ? sum / inputs[0] : 0;
    values.rolling_resistance_coefficient = inputs[1] > 0 ? values.rolling_resistance / inputs[1] : 0;
    return values;
  }

  /* The numbers that limits may name: name -> value. */
  answers() {
    if (this.known) return this.known;
    const tyre = this.tyre, n = tyre.count, m = tyre.size, values = { hottest_degC: -Infinity }, count = this.times.length;
    for (const [name, from, to] of tyre.hotParts) {
      let highest = -Infinity;
      for (let k = 0; k < count; k++) {
        const y = this.states.subarray(k * n, k * n + m);
        for (let i = from; i < to; i++) {
          const value = dot(tyre.arrays.hot, i * m, y, m);
          if (value > highest) highest = value;
        }
      }
      values[`${name}_max_degC`] = highest;
      values.hottest_degC = Math.max(values.hottest_degC, highest);
    }
    const end = this.at(tyre.end), lags = tyre.lagging;
    tyre.about.read.forEach((name, i) => {
      let highest = -Infinity;
      const lag = lags.indexOf(i);
      for (let k = 0; k < count; k++) {
        const value = lag < 0 ? dot(tyre.arrays.read, i * n, this.states.subarray(k * n, k * n + n), n) : this.late[k * lags.length + lag];
        if (value > highest) highest = value;
      }
      values[`${name}_degC`] = end[name];
      values[tyre.highestName(name)] = highest;
    });
    values["contained-air_degC"] = end["contained-air"];
    let air = this.coefficients.airStart;
    if (tyre.hasGas) for (let k = 0; k < count; k++) air = Math.max(air, this.states[k * n + m]);
    values["contained-air_max_degC"] = air;
    values.gas_pressure_Pa = end.gas_pressure;
    const rolls = this.at(this.rollingTime());
    values.rolling_resistance_N = rolls.rolling_resistance;
    values.rolling_resistance_coefficient = rolls.rolling_resistance_coefficient;
    this.known = values;
    return values;
  }

  /* End of the rolling phase with most heat: there the rolling resistance is stated. Of a phase that ends at rest or
     off the road it is the last reading before its end. */
  rollingTime() {
    let best = -1, time = 0;
    const n = this.tyre.count, c = this.coefficients, durations = this.tyre.arrays.durations;
    const highOf = (number) => number + 1 < this.first.length ? this.first[number + 1] : this.times.length - 1;
    const rolling = [];
    this.first.forEach((low, number) => {
      const start = c.inputsAt(number, 0), end = c.inputsAt(number, durations[number]);
      if (!(Math.max(start[0], end[0]) >= STANDSTILL && Math.max(start[1], end[1]) > 0)) return;
      const stops = end[0] < STANDSTILL || end[1] <= 0;
      const stated = stops ? this.tyre.arrays.last_readings[number] : this.times[highOf(number)];
      if (stated > this.times[low] + 1e-6) rolling.push([number, stated]);
    });
    for (const [number, stated] of rolling) {
      const low = this.first[number], high = highOf(number);
      if (rolling.length === 1) return stated;
      let heat = 0, before = 0;
      for (let i = low; i <= high; i++) {
        const inputs = c.inputsAt(number, this.times[i] - this.times[low]);
        const power = c.generated(this.states.subarray(i * n, i * n + n), inputs).reduce((a, b) => a + b, 0);
        if (i > low) heat += (power + before) / 2 * (this.times[i] - this.times[i - 1]);
        before = power;
      }
      if (heat > best) { best = heat; time = stated; }
    }
    return time;
  }
}
