// The list of studies and their comparison, as the server has written them: theme, and news while something runs.
import { startTheme } from "./theme";

const EVERY = 3000;

document.addEventListener("DOMContentLoaded", () => {
  follow(document.getElementById("theme") as HTMLButtonElement);
  requireTwo();
  if (document.querySelector("[data-running]")) setTimeout(() => void refresh(), EVERY);
});
let theme = startTheme();

function follow(button: HTMLButtonElement): void {
  const name = (): void => {
    button.textContent = theme === "dark" ? "Light mode" : "Dark mode";
  };
  button.hidden = false;
  button.addEventListener("click", () => {
    theme = theme === "dark" ? "light" : "dark";
    document.documentElement.dataset["theme"] = theme;
    name();
  });
  name();
}

/** What is ticked stays ticked: only the cells of studies that are still there change. */
async function refresh(): Promise<void> {
  try {
    if (!document.hidden) {
      const answer = await fetch("/");
      const fresh = new DOMParser().parseFromString(await answer.text(), "text/html");
      const ticked = new Set([...boxes()].filter(({ checked }) => checked).map(({ value }) => value));
      const focused = (document.activeElement as HTMLInputElement | null)?.value;
      const table = fresh.querySelector("table.studies");
      if (answer.ok && table) document.querySelector("table.studies")!.replaceWith(document.adoptNode(table));
      for (const box of boxes()) {
        box.checked = ticked.has(box.value);
        if (focused && box.value === focused) box.focus();
      }
      requireTwo();
    }
  } catch {
    // The server may have been stopped; the next try tells.
  }
  setTimeout(() => void refresh(), EVERY);
}

function boxes(): NodeListOf<HTMLInputElement> {
  return document.querySelectorAll<HTMLInputElement>('input[name="study"]');
}

function requireTwo(): void {
  const button = document.querySelector<HTMLButtonElement>('button[type="submit"]');
  const count = (): void => {
    if (button) button.disabled = [...boxes()].filter(({ checked }) => checked).length < 2;
  };
  for (const box of boxes()) box.addEventListener("change", count);
  count();
}
