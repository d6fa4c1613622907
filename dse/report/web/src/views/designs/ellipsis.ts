// Names of any length in places that have room for some words.
import { el } from "../../dom";

const MOST = 80;

/** *text* as it stands, or its beginning with the whole of it as a title. */
export function short(text: string): HTMLElement | string {
  return text.length > MOST ? el("span", { title: text }, `${text.slice(0, MOST - 1)}\u2026`) : text;
}
