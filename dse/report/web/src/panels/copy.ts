// A text that is shown when it is opened, and a button that copies it.
import { el } from "../dom";
import { copyText } from "../save";

export function copyParts(
  id: string,
  title: string,
  button: string,
  text: () => string,
  open = false,
  toggled: (open: boolean) => void = () => {},
): [HTMLElement, HTMLElement] {
  const shown = el("pre", { id, tabindex: 0, "aria-label": title });
  const said = el("span", { class: "muted", role: "status" });
  const fill = (): string => {
    shown.textContent = text();
    return shown.textContent;
  };
  // A key that opens it is a click, too; the event "toggle" comes later.
  const summary = el("summary", { click: () => void fill() }, title);
  const details = el("details", { class: "yaml", open, toggle: () => toggled(details.open) }, summary, shown);
  if (open) fill();
  const copy = el(
    "button",
    {
      id: `copy-${id}`,
      type: "button",
      click: () => {
        details.open = true;
        void copyText(fill(), shown).then((done) => {
          said.textContent = done ? "copied" : "selected: press Ctrl+C";
        });
      },
    },
    button,
  );
  return [details, el("div", { class: "copy" }, said, copy)];
}
