// A small menu in a panel's heading: what can be taken out of it, and the command that makes the same.
import { el } from "../dom";
import { createMenu } from "../menu";
import { copyText, csvOf, download, pictureOf } from "../save";
import type { Store } from "../store";

export interface Saved {
  /** Of the files, without an ending. */
  name: string;
  /** Titles and layers of the picture; empty if there is none. */
  picture: () => [string, HTMLCanvasElement[]][];
  /** What the command is for. */
  purpose: string;
  /** What makes the same outside of the page; DIR is the study's folder. */
  command: () => string;
}

export function savingMenu(store: Store, { name, picture, purpose, command }: Saved): HTMLElement {
  const said = el("span", { class: "muted", role: "status" });
  const shown = el("code", { tabindex: 0 }, command());
  const item = (text: string, title: string, click: () => void): HTMLElement => el("button", { type: "button", title, click }, text);
  const savePicture = (): void => {
    const parts = picture().filter(([, layers]) => layers[0]?.width);
    if (!parts.length) return void (said.textContent = "There is nothing to draw.");
    void pictureOf(parts).then((blob) => download(`${name}.png`, blob));
  };
  const sheet = el(
    "div",
    {},
    item("Picture (PNG)", "As it is shown now", savePicture),
    item("Runs (CSV)", "Every run within the brushes, with verdicts at the thresholds shown", () => download(`${name}.csv`, new Blob([csvOf(store)], { type: "text/csv" }))),
    el("p", { class: "muted" }, purpose),
    shown,
    item("Copy the command", "To the clipboard", () => void copyText(command(), shown).then((done) => (said.textContent = done ? "copied" : "selected: press Ctrl+C"))),
    said,
  );
  return createMenu(`save-${name}`, "Save", `Save or copy: ${name}`, sheet, () => (shown.textContent = command()));
}

/** *text* as one word of a shell's command line. */
export function quoted(text: string): string {
  return /^[\w./:@%+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`;
}
