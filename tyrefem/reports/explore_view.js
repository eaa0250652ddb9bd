/* The page: sliders, time, results, limits, two settings, texts to copy. */
const DATA = JSON.parse(document.getElementById("data").textContent);
const { GAMMA, PHI, PHI_2 } = DATA.constants;
const COLOURS = ["--c0", "--c1", "--c2", "--c3", "--c4", "--c5", "--c6", "--c7"];
/* Sliders go beyond the box by this part of it. */
const BEYOND = 0.08;
const $ = (id) => document.getElementById(id);

function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "text") element.textContent = value;
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/* A number with so many digits after the point, without a minus before zero. */
function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text;
}
function significant(value, digits = 2) {
  if (!(Math.abs(value) > 0)) return "0";
  return String(Number(value.toPrecision(digits)));
}
function short(name) { return name.replaceAll("-", " "); }

const tyre = new SettingTyre(decoded(DATA.arrays), DATA.about);
const modes = new FieldModes(DATA.picture);
const colourTable = (() => {
  const bytes = Uint8Array.from(atob(DATA.picture.colours), (c) => c.charCodeAt(0)), table = new Uint32Array(256);
  for (let i = 0; i < 256; i++) table[i] = 255 << 24 | bytes[3 * i + 2] << 16 | bytes[3 * i + 1] << 8 | bytes[3 * i];
  return table;
})();
const differenceTable = (() => {
  const table = new Uint32Array(256), ends = [[33, 102, 172], [247, 247, 247], [178, 24, 43]];
  for (let i = 0; i < 256; i++) {
    const part = i / 127.5, [from, to] = part < 1 ? [ends[0], ends[1]] : [ends[1], ends[2]], u = part < 1 ? part : part - 1;
    const [r, g, b] = from.map((value, k) => Math.round(value + (to[k] - value) * u));
    table[i] = 255 << 24 | b << 16 | g << 8 | r;
  }
  return table;
})();
const errors = DATA.certificate.errors;
const lines = [...tyre.about.read.map((name, i) => ({ name, colour: COLOURS[i % COLOURS.length], dashed: i >= COLOURS.length })), { name: "contained-air", colour: "--quiet", dashed: true }]
  .map((line) => ({ ...line, shown: true }));

const state = {
  numbers: DATA.numbers.map((number) => number.start), time: tyre.end, solution: null, failure: "", field: null, run: null, pins: {}, playing: false,
  limits: DATA.limits.map((limit) => ({ ...limit })), axes: DATA.axes.slice(), envelope: [], envelopeDone: false, scale: null,
};

/* ---- the box ---- */

function outside(number, value) {
  const near = 1e-9 * Math.max(Math.abs(number.low), Math.abs(number.high));
  return value < number.low - near || value > number.high + near;
}
function ends(number) {
  const beyond = BEYOND * (number.high - number.low), positive = number.low > 0;
  return [positive ? Math.max(number.low - beyond, 0.5 * number.low) : number.low === 0 ? 0 : number.low - beyond, number.high + beyond];
}
function digitsOf(number) {
  return Math.max(0, Math.min(6, 2 - Math.floor(Math.log10((number.high - number.low) || 1))));
}
function shownNumber(number, value) { return number.nominal !== null ? value.toFixed(2) : String(Number(value.toFixed(digitsOf(number)))); }

/* Text of a number as in a study file: a quantity, a number, or a table of rows. */
function written(number, value) {
  const nine = (x) => String(Number(x.toPrecision(9)));
  const scaled = (nominal, factor) => {
    if (Array.isArray(nominal)) {
      return nominal.length && nominal.every((row) => Array.isArray(row) && row.length)
        ? nominal.map((row) => [row[0], ...scaled(row.slice(1), factor)]) : nominal.map((entry) => scaled(entry, factor));
    }
    if (typeof nominal === "number") return Number(nine(nominal * factor));
    const match = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)$/s.exec(nominal);
    return `${nine(Number(match[1]) * factor)}${match[2]}`;
  };
  if (number.nominal !== null) return scaled(number.nominal, Number(nine(value)));
  return number.unit ? `${nine(value)} ${number.unit}` : Number(nine(value));
}
function literal(value) {
  if (Array.isArray(value)) return `[${value.map(literal).join(", ")}]`;
  if (value !== null && typeof value === "object") return `{${Object.entries(value).map(([key, each]) => `${/^[\w-]+$/.test(key) ? key : JSON.stringify(key)} = ${literal(each)}`).join(", ")}}`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

/* ---- sliders ---- */

const rows = [];

function makeSliders() {
  const groups = new Map();
  DATA.numbers.forEach((number, i) => {
    if (!groups.has(number.group)) {
      const group = make("fieldset", { class: "group" }, make("legend", { text: number.group }));
      groups.set(number.group, group);
      $("sliders").append(group);
    }
    const [low, high] = ends(number), step = 10 ** -digitsOf(number);
    const range = make("input", { type: "range", id: `slider-${i}`, min: low, max: high, step: "any", "aria-describedby": `note-${i}` });
    const field = make("input", { type: "number", step, "aria-label": `${number.label}, ${number.symbol || "number"}` });
    const note = make("div", { class: "note", id: `note-${i}`, hidden: true });
    const share = (x) => 100 * (x - low) / (high - low);
    range.style.setProperty("--track", `linear-gradient(90deg, var(--warn-soft) ${share(number.low)}%, var(--line) ${share(number.low)}% ${share(number.high)}%, var(--warn-soft) ${share(number.high)}%)`);
    const own = make("span", { class: "own", title: "the study’s own" });
    const where = Math.min(Math.max(share(number.start), 0), 100);
    own.style.left = `calc(${where}% + ${8 - 0.16 * where}px)`;
    const row = make("div", { class: "slider" }, make("label", { for: `slider-${i}`, text: number.label, title: number.key }),
      make("span", { class: "value" }, field, make("span", { class: "unit", text: number.symbol })), make("div", { class: "track" }, own, range), note);
    /* Arrow keys move by a hundredth of the box, with shift by a tenth; Home and End go to its ends. */
    range.addEventListener("keydown", (event) => {
      const moves = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };
      let value = null;
      if (event.key in moves) value = state.numbers[i] + moves[event.key] * (event.shiftKey ? 10 : 1) * (number.high - number.low) / 100;
      else if (event.key === "Home") value = number.low;
      else if (event.key === "End") value = number.high;
      if (value === null) return;
      event.preventDefault();
      setNumber(i, Math.min(Math.max(value, low), high));
    });
    range.addEventListener("input", () => setNumber(i, Number(range.value)));
    /* Only temperatures may be below zero where the box is above it. */
    const positive = number.low > 0 && !number.symbol.startsWith("°");
    field.addEventListener("change", () => {
      const value = Number(field.value);
      if (field.value.trim() === "" || !Number.isFinite(value) || (positive && value <= 0)) showNumber(i);
      else setNumber(i, value);
    });
    row.addEventListener("dblclick", (event) => { if (event.target !== field) setNumber(i, number.start); });
    groups.get(number.group).append(row);
    rows.push({ row, range, field, note });
  });
}

function showNumber(i) {
  const number = DATA.numbers[i], value = state.numbers[i], { row, range, field, note } = rows[i], out = outside(number, value);
  const text = `${shownNumber(number, value)} ${number.symbol}`;
  range.value = value;
  range.setAttribute("aria-valuetext", out ? `${text}, outside the certified box` : text);
  if (document.activeElement !== field || Number(field.value) !== value) field.value = shownNumber(number, value);
  row.classList.toggle("outside", out);
  note.hidden = !out;
  note.textContent = out ? `outside ${shownNumber(number, number.low)} to ${shownNumber(number, number.high)} ${number.symbol}: not certified` : "";
}

let due = false;
function setNumber(i, value) {
  if (state.numbers[i] === value) return;
  state.numbers[i] = value;
  later();
}
/* One computation a frame, however many events come. */
function later() {
  if (due) return;
  due = true;
  requestAnimationFrame(() => { due = false; update(); });
}

/* ---- computing and drawing ---- */

let section, histories, envelopeChart;
const isDark = () => document.documentElement.dataset.theme === "dark";

function update() {
  DATA.numbers.forEach((_, i) => showNumber(i));
  try {
    const solution = tyre.solve(state.numbers);
    if (!Number.isFinite(solution.states[solution.states.length - 1])) throw new Error("no finite temperatures");
    state.solution = solution;
    state.failure = "";
  } catch (error) { state.failure = error.message; }
  const failed = state.failure !== "";
  document.querySelector("main").classList.toggle("unsolved", failed);
  for (const id of ["pin-a", "pin-b"]) $(id).disabled = failed;
  showBadge();
  if (failed) { showTexts(); return; }
  drawTime();
  if (!restDue) restDue = setTimeout(drawRest, 0);
}

/* The section and its numbers come first; charts and texts follow as soon as no slider waits. */
let restDue = 0;
function drawRest() {
  clearTimeout(restDue);
  restDue = 0;
  state.series = histories.series(state.solution);
  drawHistories();
  showResiduals();
  showTexts();
  drawEnvelope();
  startEnvelope();
  announce();
}

function drawAll() {
  showBadge();
  drawTime();
  drawRest();
}

/* What depends on the shown time. */
function drawTime() {
  const t = state.time, values = state.solution.at(t), [divisor, unit] = timeUnit(tyre.end);
  state.values = values;
  state.field = modes.field(state.solution.state(t), state.field || undefined);
  const place = values.hottest_place, limit = state.limits.find((each) => each.answer === "hottest_degC");
  fitColours(false);
  section.draw(state.field, state.scale[0], state.scale[1], {
    readings: values, limit: limit && limit.below !== null ? limit.below : undefined,
    hottest: [modes.hot[2 * place], modes.hot[2 * place + 1], `${values.hottest.toFixed(1)} °C`],
  });
  section.canvas.setAttribute("aria-label", `Temperature of the section at ${fixed(t / divisor, 1)} ${unit}: from ${section.lowest.toFixed(1)} to ${values.hottest.toFixed(1)} degrees Celsius; hottest in the ${values.hottest_region}, ${DATA.picture.where[place]}`);
  $("clock").textContent = `${fixed(t / divisor, divisor > 1 ? 1 : 0)} ${unit}`;
  $("time").value = 1000 * t / tyre.end;
  $("time").setAttribute("aria-valuetext", $("clock").textContent);
  const number = state.solution.phase(t), inputs = state.solution.inputs(t);
  $("phase").textContent = `${DATA.phases.length > 1 ? `${DATA.phases[number].name}: ` : ""}${fixed(inputs[0] * 3.6, 1)} km/h, ${fixed(inputs[1] / 1e3, 2)} kN, ambient ${fixed(inputs[3], 1)} °C, road ${fixed(inputs[4], 1)} °C; isotherms every ${significant(section.step || 0)} K`;
  showTiles(values);
  showReadings(values);
  showBudget(values);
  histories.moveTo(t);
}

/* Colours from the coldest start to above the hottest of the drive; kept while a setting fits, so that hotter looks hotter. */
function fitColours(anew) {
  const answers = state.solution.answers();
  let low = Infinity;
  for (const T of state.field) if (T < low) low = T;
  low = Math.min(low, state.solution.coefficients.initial);
  const high = answers.hottest_degC;
  if (anew || !state.scale) {
    const step = niceStep(high - low, 6);
    state.scale = [Math.floor(low / step) * step, Math.ceil((high + (anew ? 0 : 0.15 * (high - low))) / step) * step];
  }
  if (low < state.scale[0]) state.scale[0] = Math.floor(low / 5) * 5;
  if (high > state.scale[1]) state.scale[1] = Math.ceil(high / 5) * 5;
}

function errorAt(name, numbers, scale = 1) { return errors[name] === undefined ? "" : DATA.numbers.some((number, i) => outside(number, numbers[i])) ? "?" : significant(errors[name] / scale, 1); }
function errorOf(name) { return anyOutside() ? "± ?" : errors[name] === undefined ? "" : `± ${significant(errors[name], 1)}`; }
function anyOutside() { return DATA.numbers.some((number, i) => outside(number, state.numbers[i])); }

function showBadge() {
  const out = DATA.numbers.filter((number, i) => outside(number, state.numbers[i])), badge = $("badge");
  badge.className = out.length || state.failure ? "badge outside" : "badge";
  badge.textContent = state.failure ? `No solution at this setting: ${state.failure}` : out.length
    ? `Outside the certified box (${out.map((number) => number.label).join("; ")}): the errors are not known`
    : `certified: hottest ± ${significant(errors.hottest, 2)} K, anywhere ± ${significant(DATA.certificate.field, 2)} K`;
}

/* ---- limits ---- */

/* Largest excess over the limits, in parts of the limit's size; <= 0: all are kept. */
function excess(answers) {
  let worst = -Infinity;
  for (const { answer, below, above } of state.limits) {
    const value = answers[answer], size = answer.endsWith("_degC") ? 1 : Math.max(Math.abs(below ?? above), 1e-9) / 100;
    if (value === undefined) continue;
    if (below !== null && below !== undefined) worst = Math.max(worst, (value - below) / size);
    if (above !== null && above !== undefined) worst = Math.max(worst, (above - value) / size);
  }
  return worst;
}
function broken(limit, value) {
  return (limit.below !== null && limit.below !== undefined && value > limit.below) || (limit.above !== null && limit.above !== undefined && value < limit.above);
}

const WORDS = { hottest_degC: "hottest point", "contained-air_degC": "contained air at the end", gas_pressure_Pa: "contained air’s pressure", rolling_resistance_N: "rolling resistance", rolling_resistance_coefficient: "rolling resistance coefficient" };
function answerWords(name) {
  if (WORDS[name]) return WORDS[name];
  if (name.endsWith("_max_degC")) return `${short(name.slice(0, -9))}, highest`;
  if (name.endsWith("_degC")) return `${short(name.slice(0, -5))}, at the end`;
  return short(name);
}
function answerUnit(name) { return name.endsWith("_degC") ? "°C" : name.endsWith("_Pa") ? "Pa" : name.endsWith("_N") ? "N" : ""; }
function answerText(name, value) { return name.endsWith("coefficient") ? value.toFixed(5) : name.endsWith("_Pa") ? significant(value, 5) : value.toFixed(1); }

function showLimits() {
  const host = $("limits"), answers = state.solution ? state.solution.answers() : {};
  if (host.childElementCount !== state.limits.length + 1) {
    host.replaceChildren();
    state.limits.forEach((limit, i) => {
      const kind = limit.below !== null && limit.below !== undefined ? "below" : "above";
      const field = make("input", { type: "number", step: "any", value: limit[kind], "aria-label": `${answerWords(limit.answer)} ${kind}, ${answerUnit(limit.answer)}` });
      field.addEventListener("input", () => {
        if (field.value.trim() === "" || !Number.isFinite(Number(field.value))) return;
        limit[kind] = Number(field.value);
        limit.given = true;
        drawAll();
        startEnvelope();
      });
      const drop = make("button", { class: "plain", type: "button", text: "×", "aria-label": `Remove the limit of ${answerWords(limit.answer)}` });
      drop.addEventListener("click", () => { state.limits.splice(i, 1); host.replaceChildren(); drawAll(); startEnvelope(); });
      host.append(make("div", { class: "limit-row" }, make("span", {}, make("span", { text: `${answerWords(limit.answer)} ${kind}` }), " ", make("span", { class: "error now" })), field, make("span", { class: "unit", text: answerUnit(limit.answer) }), drop));
    });
    const choice = make("select", { "aria-label": "Add a limit" }, make("option", { value: "", text: "add a limit …" }));
    for (const name of Object.keys(answers)) if (!state.limits.some((limit) => limit.answer === name)) choice.append(make("option", { value: name, text: answerWords(name) }));
    choice.addEventListener("change", () => {
      if (!choice.value) return;
      state.limits.push({ answer: choice.value, below: Number(significant(answers[choice.value], 3)), above: null, given: true });
      host.replaceChildren();
      drawAll();
      startEnvelope();
    });
    host.append(choice);
  }
  state.limits.forEach((limit, i) => {
    const value = answers[limit.answer], row = host.children[i];
    row.classList.toggle("over", broken(limit, value));
    row.querySelector(".now").textContent = limit.given ? `now ${answerText(limit.answer, value)} ${answerUnit(limit.answer)}` : `as hot as the study itself; now ${answerText(limit.answer, value)} °C`;
  });
}

/* ---- results ---- */

const tiles = {};
function makeTiles() {
  for (const [key, label, wide] of [["hottest", "Hottest point"], ["drive", "Highest of the drive"], ["resistance", "Rolling resistance"], ["air", "Contained air"]]) {
    const tile = make("div", { class: wide ? "tile wide" : "tile" }, make("div", { class: "label", text: label }), make("div", { class: "big" }), make("div", { class: "note" }));
    tiles[key] = tile;
    $("tiles").append(tile);
  }
}
function fill(key, big, unit, error, note, over) {
  const [, value, words] = tiles[key].children;
  value.replaceChildren(big, " ", make("small", { text: unit }), " ", make("span", { class: "error", text: error }));
  words.textContent = note;
  tiles[key].classList.toggle("over", over);
}
function limited(...names) {
  const answers = state.solution.answers();
  return state.limits.some((limit) => names.includes(limit.answer) && broken(limit, answers[limit.answer]));
}
function showTiles(values) {
  const answers = state.solution.answers(), limit = state.limits.find((each) => each.answer === "hottest_degC" && each.below !== null);
  const regions = tyre.hotParts.map(([name]) => name), hottest = regions.reduce((a, b) => answers[`${a}_max_degC`] >= answers[`${b}_max_degC`] ? a : b);
  fill("hottest", values.hottest.toFixed(1), "°C", errorOf("hottest"), `${values.hottest_region}, ${DATA.picture.where[values.hottest_place]}`, Boolean(limit) && values.hottest > limit.below);
  fill("drive", answers.hottest_degC.toFixed(1), "°C", errorOf("hottest_degC"), limit ? (answers.hottest_degC > limit.below ? `${(answers.hottest_degC - limit.below).toFixed(1)} K over the limit of ${significant(limit.below, 4)} °C, in the ${short(hottest)}` : `${(limit.below - answers.hottest_degC).toFixed(1)} K below ${significant(limit.below, 4)} °C; in the ${short(hottest)}`) : `in the ${short(hottest)}`, limited("hottest_degC", ...regions.map((name) => `${name}_max_degC`)));
  fill("resistance", values.rolling_resistance.toFixed(1), "N", errorOf("rolling_resistance"), `coefficient ${values.rolling_resistance_coefficient.toFixed(5)} ${errorOf("rolling_resistance_coefficient")}, hysteresis`, limited("rolling_resistance_N", "rolling_resistance_coefficient"));
  const { unit, pascal } = DATA.pressure;
  fill("air", values["contained-air"].toFixed(1), "°C", errorOf("contained-air"), `${significant(values.gas_pressure / pascal, 4)} ${unit} gauge ${anyOutside() ? "± ?" : `± ${significant(errors.gas_pressure / pascal, 1)}`}`, limited("contained-air_degC", "gas_pressure_Pa"));
}

const readingRows = {};
function makeReadings() {
  lines.forEach((line) => {
    const box = make("input", { type: "checkbox", checked: true }), swatch = make("span", { class: "swatch" });
    swatch.style.background = `var(${line.colour})`;
    box.addEventListener("change", () => { line.shown = box.checked; drawHistories(); });
    const sensor = DATA.sensors.find((each) => each.name === line.name);
    const row = make("tr", { title: sensor ? sensor.where : "" }, make("td", { class: "word" }, make("label", {}, box, swatch, short(line.name))), make("td"), make("td", { class: "error" }), make("td"), make("td", { class: "error" }), ...[0, 1, 2].map(() => make("td", { class: "residual" })));
    readingRows[line.name] = row;
    $("readings").append(row);
  });
}
function showReadings(values) {
  const answers = state.solution.answers();
  for (const { name } of lines) {
    const cells = readingRows[name].children, highestName = state.solution.tyre.highestName(name), highest = answers[highestName];
    cells[1].textContent = values[name].toFixed(1);
    cells[2].textContent = errorOf(name).replace("± ", "");
    cells[3].textContent = highest.toFixed(1);
    cells[4].textContent = errorOf(highestName).replace("± ", "");
    cells[3].classList.toggle("over", limited(highestName));
    cells[1].classList.toggle("over", limited(`${name}_degC`));
  }
}
function showResiduals() {
  for (const { name } of lines) {
    const cells = readingRows[name].children;
    const off = state.run ? residuals(state.run, name) : null;
    [off && off.mean, off && off.rms, off && off.largest].forEach((value, k) => { cells[5 + k].textContent = value === null || value === undefined ? "" : `${k !== 1 && value > 0 ? "+" : ""}${fixed(value, 2)} K`; });
  }
  $("readings").closest("table").classList.toggle("no-runs", !state.run);
}
/* Measured minus computed of one sensor: mean, rms and largest, K. */
function residuals(run, name) {
  const measured = run.readings[name], index = tyre.about.read.indexOf(name);
  if (!measured) return null;
  let count = 0, sum = 0, squares = 0, largest = 0;
  measured.forEach((value, i) => {
    const t = run.times[i];
    if (value === null || t < 0 || t > tyre.end) return;
    const y = state.solution.state(t), computed = index < 0 ? (tyre.hasGas ? y[tyre.size] : state.solution.coefficients.airStart) : state.solution.readings(t, y)[index], off = value - computed;
    count++; sum += off; squares += off * off;
    if (Math.abs(off) > Math.abs(largest)) largest = off;
  });
  return count ? { mean: sum / count, rms: Math.sqrt(squares / count), largest, count } : null;
}

const barRows = new Map();
function barRow(name, label, colour) {
  const bar = make("i"), mark = make("b", { hidden: true }), value = make("td"), error = make("td", { class: "error" });
  bar.style.background = colour;
  const row = make("tr", {}, make("th", { scope: "row", text: label }), make("td", { class: "bar-cell" }, make("div", { class: "bar" }, bar, mark)), value, error);
  barRows.set(name, { bar, mark, value, error });
  return row;
}
function headRow(key, label) {
  const value = make("td"), error = make("td", { class: "error" });
  barRows.set(key, { value, error });
  return make("tr", { class: "head" }, make("th", { scope: "rowgroup", colspan: 2, text: label }), value, error);
}
function makeBars() {
  const host = $("bars");
  host.append(headRow("resistance", "Rolling resistance"), barRow("rolling_resistance", "of hysteresis", "var(--c1)"), headRow("generated", "Generated"));
  for (const name of tyre.about.heat) host.append(barRow(name, short(name.slice(11)), "var(--c1)"));
  host.append(headRow("lost and stored", "Lost and stored"));
  for (const name of tyre.about.lost) host.append(barRow(name, short(name.slice(6)), "var(--c2)"));
  host.append(barRow("stored", "stored in the tyre", "var(--c0)"));
}
function showBudget(values) {
  if (!state.own) state.own = { resistance: values.rolling_resistance };
  const most = Math.max(values.generated, ...[...tyre.about.lost, "stored"].map((name) => Math.abs(values[name])), 1e-9), force = values.rolling_resistance, own = state.ownResistance;
  const scale = Math.max(force, own || 0, 1e-9) * 1.1;
  for (const name of [...tyre.about.heat, ...tyre.about.lost, "stored"]) {
    const { bar, value, error } = barRows.get(name);
    bar.style.width = `${Math.min(100, 100 * Math.abs(values[name]) / most)}%`;
    bar.style.opacity = values[name] < 0 ? 0.45 : 1;
    value.textContent = `${fixed(values[name], most < 10 ? 2 : most < 1000 ? 1 : 0)} W`;
    error.textContent = errorOf(name);
  }
  const row = barRows.get("rolling_resistance");
  row.bar.style.width = `${100 * force / scale}%`;
  row.mark.hidden = !own;
  if (own) row.mark.style.left = `${100 * own / scale}%`;
  row.value.textContent = `${force.toFixed(1)} N`;
  row.error.textContent = errorOf("rolling_resistance");
  barRows.get("resistance").value.textContent = "";
  for (const name of ["generated", "lost and stored"]) {
    const { value, error } = barRows.get(name);
    value.textContent = `${fixed(values[name], most < 10 ? 2 : 0)} W`;
    error.textContent = errorOf(name);
  }
  $("budget-note").textContent = `whole tyre, at ${$("clock").textContent}; mark: the study’s own`;
}

/* ---- histories, measured runs ---- */

function drawHistories() {
  const temperatures = state.limits.filter((limit) => limit.answer.endsWith("_degC") && limit.below !== null).map((limit) => limit.below);
  histories.draw(state.series, lines.filter((line) => line.shown), Object.values(state.pins).map((pin) => pin.series), state.run, temperatures, state.time);
}
function makeRuns() {
  const runs = DATA.measured.runs;
  if (!runs.length) return;
  const choice = make("select", { id: "run", "aria-label": "Measured run" }, make("option", { value: "", text: "no measured run" }));
  runs.forEach((run, i) => choice.append(make("option", { value: i, text: `measured: ${run.name}${run.hold_out ? " (held out)" : ""}` })));
  choice.addEventListener("change", () => {
    state.run = choice.value === "" ? null : runs[Number(choice.value)];
    if (state.run) for (const [i, value] of Object.entries(state.run.numbers)) state.numbers[Number(i)] = value;
    update();
  });
  $("runs").append(choice);
}

/* ---- envelope ---- */

let envelope, envelopeTimer = 0;
function boxOf() {
  const [x, y] = state.axes.map((i) => DATA.numbers[i]);
  return { x: [x.low, x.high], y: [y.low, y.high] };
}
function startEnvelope() {
  const key = JSON.stringify([state.numbers.map((value, i) => state.axes.includes(i) ? 0 : value), state.limits, state.axes]);
  if (key === state.envelopeKey) return;
  state.envelopeKey = key;
  clearTimeout(envelopeTimer);
  envelope.ticket++;
  state.envelopeDone = false;
  envelopeTimer = setTimeout(() => {
    const [x, y] = state.axes;
    envelope.start(state.numbers, x, y, boxOf(), (points, done) => {
      if (done || points.length > 1) { state.envelope = points.slice(); state.envelopeDone = done; }
      drawEnvelope();
    });
  }, 140);
}
function drawEnvelope() {
  const [x, y] = state.axes, titles = state.axes.map((i) => `${DATA.numbers[i].label}, ${DATA.numbers[i].symbol}`), over = excess(state.solution.answers()) > 0;
  const pins = Object.entries(state.pins).map(([name, pin]) => [pin.numbers[x], pin.numbers[y], name]);
  envelopeChart.draw(state.limits.length ? state.envelope : [], boxOf(), [state.numbers[x], state.numbers[y]], over, pins, titles, state.envelopeDone);
  const words = state.limits.length ? `This setting ${over ? "breaks a limit" : "keeps the limits"}.` : "No limit.";
  envelopeChart.axes.svg.setAttribute("aria-label", `Safe envelope over ${titles.join(" and ")}. ${words}`);
  showLimits();
}
function makeAxes() {
  ["axis-x", "axis-y"].forEach((id, k) => {
    DATA.numbers.forEach((number, i) => $(id).append(make("option", { value: i, text: number.label })));
    $(id).value = state.axes[k];
    $(id).addEventListener("change", () => {
      const chosen = Number($(id).value);
      if (state.axes[1 - k] === chosen) { state.axes[1 - k] = state.axes[k]; $(k ? "axis-x" : "axis-y").value = state.axes[1 - k]; }
      state.axes[k] = chosen;
      state.envelope = [];
      startEnvelope();
      drawEnvelope();
    });
  });
}

/* ---- two settings ---- */

let pinPictures;
function pin(name) {
  /* The setting may have changed since the last frame. */
  if (due) update();
  if (state.failure) return;
  if (restDue) drawRest();
  state.pins[name] = { numbers: state.numbers.slice(), solution: state.solution, series: state.series, time: state.time };
  drawPins();
  drawHistories();
  drawEnvelope();
}
function drawPins() {
  const { A, B } = state.pins;
  $("pins-empty").hidden = Boolean(A || B);
  $("pins-body").hidden = !(A || B);
  $("unpin").disabled = !(A || B);
  if (!(A || B)) return;
  pinPictures = pinPictures || ["canvas-a", "canvas-b", "canvas-d"].map((id) => new SectionPicture($(id), modes, DATA.picture, { colours: colourTable, small: true }));
  const fields = [A, B].map((each) => each && modes.field(each.solution.state(each.time), new Float32Array(modes.count)));
  const values = [A, B].map((each) => each && { ...each.solution.at(each.time), ...each.solution.answers() });
  pinPictures.forEach((picture) => picture.resize(picture.canvas.parentElement.clientWidth || 300, isDark()));
  fields.forEach((field, i) => {
    const canvas = pinPictures[i].canvas;
    if (!field) { pinPictures[i].context.clearRect(0, 0, canvas.width, canvas.height); return; }
    const place = values[i].hottest_place;
    pinPictures[i].draw(field, state.scale[0], state.scale[1], { hottest: [modes.hot[2 * place], modes.hot[2 * place + 1]] });
    canvas.setAttribute("aria-label", `Setting ${"AB"[i]}: hottest ${values[i].hottest.toFixed(1)} degrees Celsius`);
  });
  const last = pinPictures[2], note = $("difference-note");
  if (A && B) {
    const difference = fields[1].map((value, i) => value - fields[0][i]);
    let most = 0.05;
    for (const value of difference) most = Math.max(most, Math.abs(value));
    last.draw(difference, -most, most, {}, differenceTable);
    note.textContent = `B − A: blue colder, red hotter, up to ${significant(most, 2)} K`;
  } else {
    last.context.clearRect(0, 0, last.canvas.width, last.canvas.height);
    note.textContent = "B − A";
  }
  const table = $("pins-table");
  table.replaceChildren();
  const add = (label, a, b, digits, unit, error = "", scale = 1) => {
    const cell = (value) => make("td", { text: value === undefined ? "" : `${fixed(value, digits)} ${unit}` });
    table.append(make("tr", {}, make("td", { class: "word", text: label }), cell(a), cell(b), make("td", { text: a === undefined || b === undefined ? "" : `${b > a ? "+" : ""}${fixed(b - a, digits)} ${unit}` }), make("td", { class: "error", text: [A, B].some((each) => each && errorAt(error, each.numbers) === "?") ? "?" : errorAt(error, (A || B).numbers, scale) })));
  };
  DATA.numbers.forEach((number, i) => {
    const [a, b] = [A, B].map((each) => each && each.numbers[i]);
    if ((a !== undefined && b !== undefined && a !== b) || (!(A && B) && (a ?? b) !== number.start)) add(number.label, a, b, digitsOf(number), number.symbol);
  });
  const both = (key, scale = 1) => values.map((each) => each && each[key] / scale);
  add("hottest at that time", ...both("hottest"), 1, "°C", "hottest");
  add("highest of the drive", ...both("hottest_degC"), 1, "°C", "hottest_degC");
  for (const { name } of lines) add(short(name), ...both(name), 1, "°C", name);
  add("rolling resistance of the drive", ...both("rolling_resistance_N"), 1, "N", "rolling_resistance_N");
  add("its coefficient", ...both("rolling_resistance_coefficient"), 5, "", "rolling_resistance_coefficient");
  add("contained air’s pressure", ...both("gas_pressure", DATA.pressure.pascal), 1, DATA.pressure.unit, "gas_pressure", DATA.pressure.pascal);
  for (const name of [...tyre.about.heat, "generated", ...tyre.about.lost, "stored", "lost and stored"]) add(short(name), ...both(name), 1, "W", name);
}

/* ---- texts ---- */

function showTexts() {
  const changed = DATA.numbers.map((number, i) => [number, state.numbers[i]]).filter(([number, value]) => value !== number.start);
  const quoted = (text) => /[^\w.,:=/+-]/.test(text) ? `'${text.replaceAll("'", "'\\''")}'` : text;
  // What was changed of the study's file before the page was made comes first.
  const flags = [...Object.entries(DATA.changes), ...changed.map(([number, value]) => [number.key, written(number, value)])];
  $("command").textContent = [`tyrefem run ${quoted(DATA.argument)}`, ...flags.map(([key, value]) => `    --set ${quoted(`${key}=${typeof value === "string" ? value : literal(value)}`)}`)].join(" \\\n");
  let text = DATA.toml;
  DATA.numbers.forEach((number, i) => { text = text.replace(`"@${i}@"`, () => literal(written(number, state.numbers[i]))); });
  $("toml").textContent = text.trim();
}
function makeErrors() {
  const cells = [["anywhere in the section, any time", `${significant(DATA.certificate.field)} K`]];
  const add = (name, unit, words = short(name)) => { if (errors[name] !== undefined) cells.push([words, `${significant(errors[name])} ${unit}`]); };
  for (const name of [...tyre.about.read, "contained-air", "hottest"]) add(name, "K");
  for (const [region] of tyre.hotParts) add(`${region} max`, "K", `${short(region)}, its highest`);
  add("gas_pressure", "Pa", WORDS.gas_pressure_Pa);
  add("rolling_resistance", "N", WORDS.rolling_resistance_N);
  for (const name of [...tyre.about.heat, "generated", ...tyre.about.lost, "stored", "lost and stored"]) add(name, "W");
  for (const [name, value] of cells) $("errors").append(make("div", {}, make("dt", { text: name }), make("dd", { text: value })));
}
let spoken = 0;
/* A sentence for screen readers, when the sliders rest. */
function announce() {
  clearTimeout(spoken);
  spoken = setTimeout(() => {
    const v = state.values;
    $("live").textContent = `Hottest ${v.hottest.toFixed(1)} degrees in the ${short(v.hottest_region)}; rolling resistance ${v.rolling_resistance.toFixed(1)} newton. ${excess(state.solution.answers()) > 0 ? "A limit is broken. " : ""}${anyOutside() ? "Outside the certified box." : ""}`;
  }, 500);
}

/* ---- time ---- */

function setTime(t) {
  state.time = Math.min(Math.max(t, 0), tyre.end);
  drawTime();
}
function play(on) {
  state.playing = on;
  $("play").textContent = on ? "❚❚" : "▶";
  $("play").setAttribute("aria-label", on ? "Pause" : "Play the drive");
  if (!on) return;
  if (state.time >= tyre.end) state.time = 0;
  let before = performance.now();
  const tick = (now) => {
    if (!state.playing) return;
    setTime(state.time + (now - before) / 9000 * tyre.end);
    before = now;
    if (state.time >= tyre.end) play(false); else requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

/* ---- the page ---- */

function theme(dark) {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  if (section) layout();
}
function layout() {
  const colours = getComputedStyle(document.documentElement);
  section.sensors = DATA.sensors.map((sensor, i) => ({ ...sensor, colour: colours.getPropertyValue(COLOURS[i % COLOURS.length]).trim() }));
  section.resize(section.canvas.parentElement.clientWidth, isDark());
  if (!state.solution) return;
  drawAll();
  drawPins();
}

function begin() {
  const wanted = matchMedia("(prefers-color-scheme: dark)");
  theme(wanted.matches);
  wanted.addEventListener("change", () => theme(wanted.matches));
  $("theme").addEventListener("click", () => theme(!isDark()));
  makeSliders();
  makeTiles();
  makeReadings();
  makeBars();
  makeRuns();
  makeAxes();
  makeErrors();
  section = new SectionPicture($("section"), modes, DATA.picture, { colours: colourTable });
  histories = new HistoryChart($("history-chart"), tyre, setTime);
  envelopeChart = new EnvelopeChart($("envelope-chart"));
  envelope = new Envelope((numbers) => {
    try { return excess(tyre.solve(numbers).answers()); } catch { return Infinity; }
  });
  layout();
  const own = tyre.solve(DATA.numbers.map((number) => number.start));
  state.ownResistance = own.answers().rolling_resistance_N;
  update();
  drawPins();
  $("time").addEventListener("input", () => { play(false); setTime(Number($("time").value) / 1000 * tyre.end); });
  $("play").addEventListener("click", () => play(!state.playing));
  $("reset").addEventListener("click", () => { state.numbers = DATA.numbers.map((number) => number.start); later(); });
  $("contours").addEventListener("change", () => { section.showContours = $("contours").checked; drawTime(); });
  $("labels").addEventListener("change", () => { section.showLabels = $("labels").checked; drawTime(); });
  $("fit").addEventListener("click", () => { fitColours(true); drawAll(); drawPins(); });
  $("pin-a").addEventListener("click", () => pin("A"));
  $("pin-b").addEventListener("click", () => pin("B"));
  $("unpin").addEventListener("click", () => { state.pins = {}; drawPins(); drawAll(); });
  document.querySelector("form").addEventListener("submit", (event) => event.preventDefault());
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", async () => {
      const source = $(button.dataset.copy);
      try { await navigator.clipboard.writeText(source.textContent); } catch {
        const selection = getSelection();
        selection.selectAllChildren(source);
        document.execCommand("copy");
        selection.removeAllRanges();
      }
      button.textContent = "copied";
      setTimeout(() => { button.textContent = "copy"; }, 1500);
    });
  }
  const canvas = section.canvas, pointer = $("pointer");
  canvas.addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect(), place = section.under(event.clientX - box.left, event.clientY - box.top);
    pointer.hidden = !place;
    if (!place) return;
    pointer.textContent = `${place.temperature.toFixed(1)} °C`;
    pointer.style.left = `${event.clientX - box.left}px`;
    pointer.style.top = `${event.clientY - box.top}px`;
  });
  canvas.addEventListener("pointerleave", () => { pointer.hidden = true; });
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; layout(); } });
}

begin();
/* For tests and for people with a console: everything that the page computes. */
window.explore = { tyre, modes, state, data: DATA, setNumber, setTime, update, section, residuals, pin, written, envelope, drawRest };
