// A small sheet that opens below a button, and closes when the reader goes elsewhere.
import { el } from "./dom";

/** *opened* is called when the sheet opens, before it is seen. */
export function createMenu(
  id: string,
  text: string,
  label: string,
  sheet: HTMLElement,
  opened: () => void = () => undefined,
): HTMLDetailsElement {
  const summary = el("summary", { id, "aria-label": label, click: () => menu.open || opened() }, text);
  sheet.classList.add("sheet-menu");
  const menu = el("details", { class: "menu" }, summary, sheet);
  const elsewhere = (event: Event): void => {
    if (!menu.isConnected) return document.removeEventListener("pointerdown", elsewhere);
    if (!menu.contains(event.target as Node)) menu.open = false;
  };
  menu.addEventListener("toggle", () => {
    if (menu.open) document.addEventListener("pointerdown", elsewhere);
    else document.removeEventListener("pointerdown", elsewhere);
  });
  menu.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !menu.open) return;
    event.preventDefault();
    menu.open = false;
    summary.focus();
  });
  menu.addEventListener("focusout", (event) => {
    const next = event.relatedTarget as Node | null;
    if (next && !menu.contains(next)) menu.open = false;
  });
  return menu;
}
