// What the reader saves: pictures, tables of runs, and text for the clipboard.
import { columnsOf } from "./columns";
import { el } from "./dom";
import type { Store } from "./store";
import { axisLabel } from "./study";
import { WORDS } from "./verdicts";

/** Hands *content* to the reader as a file. */
export function download(name: string, content: Blob): void {
  const address = URL.createObjectURL(content);
  el("a", { href: address, download: name }).click();
  // Only after the browser took it.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Whether *text* is in the clipboard; a page opened from disk may not reach it, then *shown* is selected instead. */
export async function copyText(text: string, shown: HTMLElement): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection()?.selectAllChildren(shown);
    return false;
  }
}

/** The runs within the brushes: numbers with all their digits, choices, verdicts at the thresholds shown. */
export function csvOf(store: Store): string {
  const { study } = store;
  const { each, overall } = store.judgement();
  const within = store.within();
  const places = [...new Set(study.configurations.flatMap(({ choices }) => choices.map(([place]) => place)))];
  const chosen = study.configurations.map(({ choices }) => new Map(choices));
  const columns = columnsOf(study);
  const head = [
    "run",
    "configuration",
    ...places,
    ...columns.map(axisLabel),
    ...study.requirements.map(({ title }) => title),
    "verdict",
  ];
  const rows = [head.map(cell).join()];
  for (let run = 0; run < study.size; run++) {
    if (within && !within[run]) continue;
    const configuration = study.configuration[run]!;
    rows.push(
      [
        study.number[run],
        cell(study.configurations[configuration]!.id),
        ...places.map((place) => cell(chosen[configuration]!.get(place) ?? "")),
        ...columns.map(({ values }) => (Number.isNaN(values[run]!) ? "" : values[run])),
        ...each.map((marks) => WORDS[marks[run]!]),
        WORDS[overall[run]!],
      ].join(),
    );
  }
  return `${rows.join("\r\n")}\r\n`;
}

/** *text* as a field of a CSV file; one that begins like a formula would be run by a spreadsheet. */
export function cell(text: string): string {
  const safe = /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replace(/"/g, '""')}"` : safe;
}
