// What is seen while a drive is made: what is done now, for how long already, and a way to leave it.
import { el } from "../dom";

const STEPS = ["The car is put together and its parts are built", "The drive starts"];

export interface Loading {
  /** Aborted by who does not want to wait. */
  signal: AbortSignal;
  step(number: number): void;
  close(): void;
}

export function showLoading(page: HTMLElement): Loading {
  const leave = new AbortController();
  const items = STEPS.map((step) => el("li", {}, step));
  const seconds = el("output", {});
  const bar = el("progress", { "aria-label": "The drive is prepared" });
  const cancel = el("button", { type: "button", click: () => leave.abort() }, "Cancel");
  const dialog = el(
    "dialog",
    { class: "loading", "aria-label": "The drive is prepared" },
    el("ol", {}, ...items),
    bar,
    el("p", {}, seconds, " A car that was built before starts at once."),
    cancel,
  );
  const began = performance.now();
  const tell = (): void => {
    seconds.textContent = `${Math.floor((performance.now() - began) / 1000)} s.`;
  };
  const clock = window.setInterval(tell, 500);
  dialog.addEventListener("cancel", () => leave.abort());
  page.append(dialog);
  dialog.showModal();
  tell();
  const step = (number: number): void =>
    items.forEach((item, i) => {
      item.className = i < number ? "done" : i === number ? "now" : "";
    });
  step(0);
  return {
    signal: leave.signal,
    step,
    close: () => {
      clearInterval(clock);
      dialog.close();
      dialog.remove();
    },
  };
}
