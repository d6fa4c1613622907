// A small menu in a panel's heading: what can be taken out of it, and the command that makes the same.
import { addTools, el } from "../dom";
import { createMenu } from "../menu";
import { type Part, partsIn, pngOf, svgOf } from "../plot/sheet";
import { copyText, csvOf, download } from "../save";
import type { Store } from "../store";

export interface Saved {
  /** Of the files, without an ending. */
  name: string;
  /** Parts of the picture, below each other; empty if there is none. */
  picture: () => Part[];
  /** What the command is for. */
  purpose: string;
  /** What makes the same outside of the page; DIR is the study's folder. Empty where nothing does. */
  command: () => string;
}

export function savingMenu(store: Store, { name, picture, purpose, command }: Saved): HTMLElement {
  const said = el("span", { class: "muted", role: "status" });
  const shown = el("code", { tabindex: 0 }, command());
  const item = (text: string, title: string, click: () => void): HTMLElement =>
    el("button", { type: "button", title, click }, text);
  const savePicture = (ending: string, made: (parts: Part[], room: number) => Blob | Promise<Blob>): void => {
    const parts = picture().filter(({ width, height }) => width && height);
    if (!parts.length) {
      said.textContent = "There is nothing to draw.";
      return;
    }
    void Promise.resolve(made(parts, menu.closest(".card")?.clientWidth ?? 0)).then((blob) =>
      download(`${name}.${ending}`, blob),
    );
  };
  const sheet = el(
    "div",
    {},
    item("Picture (PNG)", "As it is shown now", () => savePicture("png", pngOf)),
    item("Picture (SVG)", "As it is shown now, as lines and text", () => savePicture("svg", svgOf)),
    item("Runs (CSV)", "Every run within the brushes, with verdicts at the thresholds shown", () =>
      download(`${name}.csv`, new Blob([csvOf(store)], { type: "text/csv" })),
    ),
    ...(command()
      ? [
          el("p", { class: "muted" }, purpose),
          shown,
          item(
            "Copy the command",
            "To the clipboard",
            () =>
              void copyText(command(), shown).then(
                (done) => (said.textContent = done ? "copied" : "selected: press Ctrl+C"),
              ),
          ),
        ]
      : []),
    said,
  );
  const menu = createMenu(
    `save-${name}`,
    "Save",
    `Save or copy: ${name}`,
    sheet,
    () => (shown.textContent = command()),
  );
  return menu;
}

export const IN_PRINT = "In print, as SVG or PDF, with DIR the study\u2019s folder:";

/** *panel* with a menu that saves all that is painted in it; *figure* draws the same in print, "" if none does. */
export function withSaving(store: Store, panel: HTMLElement, name: string, figure: string): HTMLElement {
  return addTools(
    panel,
    savingMenu(store, {
      name,
      picture: () => partsIn(panel),
      purpose: IN_PRINT,
      command: () => figure && `dse figure DIR --only ${figure} --format svg`,
    }),
  );
}

/** *text* as one word of a shell's command line. */
export function quoted(text: string): string {
  return /^[\w./:@%+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`;
}
