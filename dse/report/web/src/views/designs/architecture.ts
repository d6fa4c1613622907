// What compared designs are made of and what hangs on what, as boxes and lines; the layout comes from Python.
import { el } from "../../dom";
import type { Configuration, Picture } from "../../study";
import { allocationTables } from "../shared/allocation";
import { seriesColour } from "./colouring";
import { configurationOf, type Model, nameOf } from "./model";

const BOX = 34;
const STRETCH = 1.2;
const EDGE = 8;
const CHARACTERS = 26;
const LARGEST = 1.2;

export function createArchitectures(model: Model): HTMLElement {
  const box = el("div", { class: "architectures" });
  const details = el(
    "details",
    { open: true },
    el("summary", {}, "What they are made of"),
    box,
    el("p", { class: "hint" }, "Coloured: not the same in all designs compared; dashed: part of the bench."),
  );
  const draw = (): void => {
    const { study } = model.store;
    const shown = model.choices.picked.map((design) => study.configurations[configurationOf(model, design)]!);
    const distinct = [...new Set(shown)];
    details.hidden = !shown.some(({ parts }) => parts.length);
    box.replaceChildren(...distinct.map((configuration) => figureOf(model, configuration, shown)));
  };
  model.subscribe((changed) => {
    if (changed.has("picked") || changed.has("theme")) draw();
  });
  draw();
  return details;
}

function figureOf(model: Model, configuration: Configuration, shown: Configuration[]): HTMLElement {
  const { study } = model.store;
  const names = model.choices.picked
    .filter((_, index) => shown[index] === configuration)
    .map((design) => nameOf(model, design))
    .join(", ");
  const picture = study.pictures[configuration.picture];
  const others = shown.map((other) => partsOf(study.pictures[other.picture], other));
  const differs = (path: string, component: string): boolean => others.some((parts) => parts.get(path) !== component);
  const drawn = picture
    ? draw(picture, configuration, differs, seriesColour(shown.indexOf(configuration)))
    : el("p", { class: "muted" }, "Its structure is not drawn.");
  const tables = allocationTables(configuration);
  return el("figure", {}, el("figcaption", {}, el("b", {}, names), el("code", {}, configuration.id)), drawn, ...tables);
}

function partsOf(picture: Picture | undefined, { parts }: Configuration): Map<string, string> {
  return new Map(picture?.parts.map(([path], index) => [path, parts[index]!]) ?? []);
}

function draw(
  { parts, links, width, height }: Picture,
  configuration: Configuration,
  differs: (path: string, component: string) => boolean,
  colour: string,
): Element {
  const middles = parts.map(([, , middle]) => middle);
  const top = Math.min(...middles) * STRETCH - BOX / 2 - EDGE;
  const bottom = Math.max(...middles) * STRETCH + BOX / 2 + EDGE;
  const said = parts
    .map(([path], index) => `${path}${configuration.parts[index] ? `: ${configuration.parts[index]}` : ""}`)
    .join(", ");
  const svg = shape("svg", {
    viewBox: `0 ${top} ${width} ${Math.min(bottom, height * STRETCH + EDGE) - top}`,
    role: "img",
    "aria-label": said,
    class: "architecture",
  });
  svg.style.maxWidth = `${LARGEST * width}px`;
  for (const [a, b] of links) svg.append(shape("path", { class: "link", d: line(parts[a]!, parts[b]!) }));
  parts.forEach(([path, x, middle, wide], index) => {
    const component = configuration.parts[index]!;
    const y = middle * STRETCH;
    const box = shape("rect", {
      x,
      y: y - BOX / 2,
      width: wide,
      height: BOX,
      rx: 4,
      class: component ? "part" : "part bench",
    });
    if (differs(path, component)) {
      box.classList.add("differs");
      box.style.stroke = colour;
    }
    const text = (said: string, dy: number, kind: string): Element => {
      const node = shape("text", { x: x + wide / 2, y: y + dy, "text-anchor": "middle", class: kind });
      node.textContent = said.length > CHARACTERS ? `${said.slice(0, CHARACTERS - 1)}\u2026` : said;
      return node;
    };
    svg.append(
      box,
      ...(component ? [text(path, -4, "path"), text(component, 10, "component")] : [text(path, 4, "component")]),
    );
  });
  return svg;
}

/** From the right edge of the left one to the left edge of the other; within a column around the right. */
function line(one: Picture["parts"][number], other: Picture["parts"][number]): string {
  const [a, b] = one[1] <= other[1] ? [one, other] : [other, one];
  const [y0, y1] = [a[2] * STRETCH, b[2] * STRETCH];
  const right = a[1] + a[3];
  if (b[1] < right) return `M${right} ${y0} C${right + 22} ${y0} ${b[1] + b[3] + 22} ${y1} ${b[1] + b[3]} ${y1}`;
  const bend = (b[1] - right) / 2;
  return `M${right} ${y0} C${right + bend} ${y0} ${b[1] - bend} ${y1} ${b[1]} ${y1}`;
}

function shape<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number>,
): SVGElementTagNameMap[K] {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}
