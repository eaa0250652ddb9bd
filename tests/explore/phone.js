/* Sizes and contrasts of the page in a phone's frame, light and dark. */
while (!document.getElementById("phone").contentWindow.explore) await wait(50);
await wait(500);
const inner = document.getElementById("phone").contentDocument, root = inner.documentElement, view = inner.defaultView;
const wide = [...inner.querySelectorAll("main > *")].filter((each) => each.getBoundingClientRect().right > root.clientWidth + 1).map((each) => each.className);
const channel = (c) => { const s = c / 255; return s <= 0.03928 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; };
const light = (text) => { const [r, g, b] = text.match(/\d+/g).map(Number); return 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b); };
const contrast = () => { const card = inner.querySelector(".sliders"), label = inner.querySelector(".slider label"), quiet = inner.querySelector(".quiet:not([hidden])"); const back = light(view.getComputedStyle(card).backgroundColor);
  return [label, quiet].map((each) => { const front = light(view.getComputedStyle(each).color); return (Math.max(front, back) + 0.05) / (Math.min(front, back) + 0.05); }); };
const result = { scroll: root.scrollWidth, client: root.clientWidth, wide, sticky: view.getComputedStyle(inner.querySelector(".section")).position, height: inner.querySelector("#section").clientHeight, light: [root.dataset.theme, ...contrast()] };
inner.getElementById("theme").click();
await wait(600);
return { ...result, dark: [root.dataset.theme, ...contrast()] };
