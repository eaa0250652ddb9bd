/* Numbers and the errors beside them: bars, readings, tiles. */
const text = (cell) => cell.textContent.trim();
const bars = [...document.querySelectorAll("#bars tr")].map((row) => { const cells = [...row.children]; return [text(cells[0]), text(cells.at(-2)), text(cells.at(-1))]; });
const readings = [...document.querySelectorAll("#readings tr")].map((row) => [...row.children].map(text));
return { badge: text(document.getElementById("badge")), bars, readings, tiles: [...document.querySelectorAll(".tile")].map(text), certified: Object.fromEntries([...document.querySelectorAll("#errors div")].map((row) => [...row.children].map(text))) };
