// The list of studies and their comparison, as the server has written them: theme, and news while something runs.
import { answered } from "./live/requests";
import { startTheme } from "./theme";

const EVERY = 3000;
const AGAIN = 1000; // ms until a server that is busy is asked once more

document.addEventListener("DOMContentLoaded", () => {
  follow(document.getElementById("theme") as HTMLButtonElement);
  requireTwo();
  const wanted = document.querySelector<HTMLElement>("[data-replay]");
  if (wanted) void awaitReplay(wanted);
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
    document.documentElement.dataset.theme = theme;
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

/** Has the server make a replay, says how far it is, and shows it. */
async function awaitReplay(wanted: HTMLElement): Promise<void> {
  const address = `/replay?${new URLSearchParams({ study: wanted.dataset.study!, run: wanted.dataset.replay! })}`;
  const told = document.getElementById("replay-told")!;
  const began = performance.now();
  const seconds = (): string => `${Math.round((performance.now() - began) / 1000)} s`;
  const looking = setInterval(() => {
    void fetch(address)
      .then(answered)
      .then(
        (now) =>
          (told.textContent = `${(now as { told: string }).told || "waiting for the simulation to begin"} \u00b7 ${seconds()}`),
      )
      .catch(() => undefined);
  }, AGAIN);
  try {
    let answer = await fetch(address, { method: "POST", headers: { "content-type": "application/json" }, body: "{}" });
    while (answer.status === 429) {
      await new Promise((done) => setTimeout(done, AGAIN));
      answer = await fetch(address, { method: "POST", headers: { "content-type": "application/json" }, body: "{}" });
    }
    await answered(answer);
    location.reload();
  } catch (error) {
    clearInterval(looking);
    told.hidden = true;
    wanted.querySelector("progress")!.hidden = true;
    const problem = document.getElementById("replay-problem")!;
    problem.hidden = false;
    problem.textContent = error instanceof TypeError ? "the server does not answer" : (error as Error).message;
  }
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
