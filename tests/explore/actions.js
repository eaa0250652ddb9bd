/* Somebody uses the page; what it then shows. */
const E = window.explore, out = {}, $ = (id) => document.getElementById(id), text = (id) => $(id).textContent;
/* Charts and texts follow a setting at once; the spoken sentence waits for half a second. */
const settle = async (longer = 60) => { await frame(); await frame(); await wait(longer); };
/* Until something is so: as long as it takes, on a slow machine too. */
const until = async (so) => { for (let tries = 0; tries < 2400 && !so(); tries++) await wait(25); };
await settle();
out.first = { badge: text("badge"), command: text("command"), toml: text("toml"), tiles: text("tiles"), over: document.querySelectorAll(".tile.over").length };
/* A key moves a slider by a hundredth of its range. */
const slider = $("slider-0"), before = E.state.numbers[0];
slider.focus();
slider.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true, cancelable: true }));
await settle(900);
out.key = { moved: E.state.numbers[0] - before, value: Number(slider.value), spoken: slider.getAttribute("aria-valuetext"), live: text("live"), field: slider.closest(".slider").querySelector("input[type=number]").value };
slider.dispatchEvent(new KeyboardEvent("keydown", { key: "End", bubbles: true, cancelable: true }));
await settle();
out.end = E.state.numbers[0];
out.hot = { over: document.querySelectorAll(".tile.over").length, rows: document.querySelectorAll(".limit-row.over").length, badge: $("badge").className };
/* A typed number outside the box. */
const field = slider.closest(".slider").querySelector("input[type=number]");
field.value = "31.5";
field.dispatchEvent(new Event("change"));
await settle();
out.outside = { number: E.state.numbers[0], badge: text("badge"), kind: $("badge").className, note: text("note-0"), row: slider.closest(".slider").className, spoken: slider.getAttribute("aria-valuetext"), error: document.querySelector(".tile .error").textContent };
/* A typed temperature below zero, in a box above zero; a length or speed has no such value. */
const typed = async (i, value) => { const each = $(`slider-${i}`).closest(".slider").querySelector("input[type=number]"); each.value = value; each.dispatchEvent(new Event("change")); await settle(); return E.state.numbers[i]; };
const ambient = E.data.numbers.findIndex((number) => number.key === "drive.ambient");
out.frost = [await typed(ambient, "-5"), await typed(ambient, "0"), await typed(0, "-5")];
/* A setting without a solution: what still stands there is of another setting. */
await typed(0, "1e9");
out.unsolved = { badge: text("badge"), faded: Number(getComputedStyle(document.querySelector(".numbers")).opacity), sliders: Number(getComputedStyle(document.querySelector(".sliders")).opacity), command: text("command"), pins: ["pin-a", "pin-b"].map((id) => $(id).disabled) };
$("theme").click();
$("theme").click();
out.unsolved.later = text("badge");
await typed(0, "31.5");
out.solved = Number(getComputedStyle(document.querySelector(".numbers")).opacity);
out.pinsAgain = ["pin-a", "pin-b"].map((id) => $(id).disabled);
/* Copied texts, at a setting where every number has moved. */
E.data.numbers.forEach((number, i) => E.setNumber(i, number.low + 0.3 * (number.high - number.low)));
await settle();
out.copied = { command: text("command"), toml: text("toml"), numbers: E.state.numbers.slice() };
out.written = E.data.numbers.map((number, i) => E.written(number, E.state.numbers[i]));
/* Two settings. */
$("pin-a").click();
E.setNumber(0, E.data.numbers[0].high);
$("pin-b").click();
await settle();
out.pins = { shown: !$("pins-body").hidden, rows: [...document.querySelectorAll("#pins-table tr")].map((row) => [...row.children].map((cell) => cell.textContent)), note: text("difference-note"), hottest: [E.state.pins.A, E.state.pins.B].map((pin) => pin.solution.answers().hottest_degC), ghosts: document.querySelectorAll("#history-chart .ghost").length };
/* The envelope: along its line the hottest place is at its limit. */
await until(() => E.state.envelopeDone);
out.envelope = E.state.envelope.filter(([, root]) => root.at !== null).map(([u, root]) => {
  const numbers = E.state.numbers.slice();
  numbers[E.state.axes[0]] = u;
  numbers[E.state.axes[1]] = root.at;
  return E.tyre.solve(numbers).answers().hottest_degC;
});
out.envelopeDone = E.state.envelopeDone;
out.axes = E.state.axes;
/* Time: the range input, and the play button. */
$("time").value = 500;
$("time").dispatchEvent(new Event("input"));
out.time = { state: E.state.time, clock: text("clock") };
$("play").click();
await wait(1500);
out.played = E.state.time;
$("play").click();
out.paused = !E.state.playing;
/* A measured run. */
const run = $("run");
out.runs = [...run.options].map((option) => option.textContent);
run.value = "0";
run.dispatchEvent(new Event("change"));
await settle();
out.measured = { numbers: E.state.numbers.slice(), residuals: E.residuals(E.state.run, "deep"), points: document.querySelectorAll("#history-chart circle").length, cells: [...document.querySelectorAll("#readings tr")].map((row) => row.textContent) };
$("reset").click();
await settle();
out.reset = { numbers: E.state.numbers.slice(), start: E.data.numbers.map((number) => number.start), command: text("command") };
out.touch = getComputedStyle(document.querySelector("#history-chart svg")).touchAction;
out.unnamed = [...document.querySelectorAll("input, select, button, canvas, svg")].filter((each) => {
  const label = each.id && document.querySelector(`label[for="${each.id}"]`);
  return !(each.getAttribute("aria-label") || label || each.closest("label") || each.textContent.trim());
}).map((each) => each.outerHTML.slice(0, 120));
out.canvas = $("section").getAttribute("aria-label");
out.coloured = (() => { const canvas = $("section"), data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data, seen = new Set(); for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 250) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2]); return seen.size; })();
return out;
