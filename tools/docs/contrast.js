// Opens each page of the site in a frame and says which words have too little contrast with what is behind them
// (WCAG 2.1: at least 4.5, at least 3 where they are large). `pages` is an array of addresses.

function parsed(colour) {
  const [red, green, blue, alpha = 1] = colour.match(/[\d.]+/g).map(Number);
  return { rgb: [red, green, blue], alpha };
}

function over(top, below) {
  return top.rgb.map((value, i) => value * top.alpha + below[i] * (1 - top.alpha));
}

function behind(element) {
  const layers = [];
  for (let at = element; at; at = at.parentElement) {
    const layer = parsed(getComputedStyle(at).backgroundColor);
    layers.push(layer);
    if (layer.alpha === 1) break;
  }
  return layers.reduceRight((below, layer) => over(layer, below), [255, 255, 255]);
}

function opacity(element) {
  return element ? Number(getComputedStyle(element).opacity) * opacity(element.parentElement) : 1;
}

function luminance(rgb) {
  const [red, green, blue] = rgb.map(value => {
    const part = value / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(element) {
  const below = behind(element);
  const colour = parsed(getComputedStyle(element).color);
  const [light, dark] = [over({ rgb: colour.rgb, alpha: colour.alpha * opacity(element) }, below), below]
    .map(luminance).sort((a, b) => b - a);
  return (light + 0.05) / (dark + 0.05);
}

function wanted(element) {
  const style = getComputedStyle(element);
  const size = parseFloat(style.fontSize);
  return size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700) ? 3 : 4.5;
}

// Whether a reader sees the words of an element; some are for screen readers alone, a pixel large.
function isSeen(element) {
  return !["SCRIPT", "STYLE", "NOSCRIPT"].includes(element.tagName) && element.checkVisibility({ checkVisibilityCSS: true }) &&
    element.getBoundingClientRect().width > 1;
}

// What is hard to read: a line for each kind of element and its first words.
function hardToRead(document) {
  const found = new Map();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    const words = walker.currentNode.textContent.trim();
    if (!words || !isSeen(element)) continue;
    const kind = `${element.tagName.toLowerCase()}.${element.className}`;
    const measured = contrast(element);
    if (measured < wanted(element) && !found.has(kind)) found.set(kind, `${measured.toFixed(2)}: ${kind}: ${words.slice(0, 40)}`);
  }
  return [...found.values()];
}

async function checkAll(pages) {
  const frame = document.createElement("iframe");
  frame.width = "1280";
  frame.height = "900";
  document.body.append(frame);
  const scheme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const lines = [];
  for (const page of pages) {
    await new Promise(loaded => {
      frame.onload = loaded;
      frame.src = page;
    });
    for (const line of hardToRead(frame.contentDocument)) lines.push(`${page} ${scheme} ${line}`);
  }
  frame.remove();
  document.body.textContent = `checked ${pages.length} ${scheme}\n${lines.join("\n")}`;
}
