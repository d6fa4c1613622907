// Elements are built here and nowhere else: text goes in as text, so nothing a user named can become markup.
import { enlarge } from "./enlarge";

type Child = Node | string | null | undefined | false;
type Listener = (event: never) => void;
type Attributes = Record<string, string | number | boolean | Listener | undefined>;

export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (typeof value === "function") node.addEventListener(name, value as EventListener);
    else node.setAttribute(name, value === true ? "" : String(value));
  }
  append(node, ...children);
  return node;
}

export function append(node: Element, ...children: Child[]): void {
  for (const child of children) if (child || child === "") node.append(child as Node | string);
}

/** A panel with a heading, which can be enlarged until it fills the window. */
export function card(name: string, title: string, ...children: Child[]): HTMLElement {
  const id = `heading-${name}`;
  let back: (() => void) | null = null;
  const button = el("button", {
    class: "enlarge",
    type: "button",
    click: () => {
      if (back) return back();
      back = enlarge(panel, () => {
        back = null;
        tell();
        button.focus();
      });
      tell();
    },
  });
  const tell = (): void => {
    button.textContent = back ? "\u2715" : "\u2922";
    button.title = back ? "Back (Esc)" : "Enlarge";
    button.setAttribute("aria-label", `${back ? "Back from" : "Enlarge"} ${title}`);
  };
  tell();
  const bar = el("div", { class: "bar" }, el("h2", { id }, title), el("div", { class: "tools" }, button));
  const panel = el("section", { class: `card ${name}`, "aria-labelledby": id }, bar, ...children);
  return panel;
}

/** Puts *tools* into the heading of a card. */
export function addTools(panel: HTMLElement, ...tools: HTMLElement[]): HTMLElement {
  panel.querySelector(".bar .tools")!.prepend(...tools);
  return panel;
}

export function field(text: string, control: HTMLElement): HTMLElement {
  return el("label", { class: "field" }, el("span", {}, text), control);
}

export function choose(options: [string, string][], value: string, change: (value: string) => void): HTMLSelectElement {
  const select = el("select", { change: () => change(select.value) });
  for (const [key, text] of options) select.append(el("option", { value: key }, text));
  select.value = value;
  return select;
}
