// A test drive: choose a car and a road, drive it, see what came of it.
import { el } from "./dom";
import { showDrive } from "./drive/cockpit";
import { type Bench, type Order, showDealership } from "./drive/dealership";
import { showLoading } from "./drive/loading";
import { ask, connect, type Drive, type Ended, readChoices } from "./drive/messages";
import { buildBoards, showEnding } from "./drive/result";
import { buildRoster, buildSeats } from "./drive/world";
import { startTheme } from "./theme";

const page = document.getElementById("drive")!;
const { benches, shared } = JSON.parse(document.getElementById("document")!.textContent!) as {
  benches: Bench[];
  shared?: boolean;
};

startTheme();
const order = ordered();
if (benches.length) choose();
else
  page.replaceChildren(
    el(
      "p",
      { class: "problem" },
      "No bench can be driven: no bench has a component that implements the interface 'driver'.",
    ),
  );
window.addEventListener("hashchange", () => {
  if (!page.querySelector(".dealership")) return;
  Object.assign(order, ordered(), { driver: order.driver });
  choose();
});

/** What a shared link says. */
function ordered(): Order {
  const asked = new URLSearchParams(location.hash.slice(1));
  const named = benches.find(({ name }) => name === asked.get("bench")) ?? benches[0];
  return { bench: named?.name ?? "", chosen: readChoices(asked.get("chosen") ?? ""), driver: "" };
}

function choose(): void {
  show("dealership");
  const beside = shared ? el("div", { class: "beside" }, buildSeats(watch), buildBoards()) : buildBoards();
  showDealership(page, benches, order, drive, beside);
}

async function drive(): Promise<void> {
  await join(finished, loaded);
}

function watch(seat: number): Promise<void> {
  return join(choose, (over) => connect({ watch: String(seat) }, over));
}

/** Shows the drive that *open* gives, until it is over; nothing if it gives none. */
async function join(
  after: (ended: Ended) => void,
  open: (over: (ended: Ended) => void) => Promise<Drive | null>,
): Promise<void> {
  let stop = (): void => undefined;
  let isShown = true;
  const driven = await open((ended) => {
    stop();
    if (isShown) after(ended);
  });
  if (!driven) return;
  show("drive");
  try {
    stop = showDrive(page, driven);
    if (driven.seat !== undefined) page.querySelector(".panels")?.prepend(buildRoster(driven));
    page.querySelector(".drive")?.classList.toggle("watching", driven.watched !== undefined);
  } catch (error) {
    isShown = false;
    driven.leave();
    const canWebGl = Boolean(document.createElement("canvas").getContext("webgl2"));
    finished({
      why: "lost",
      text: canWebGl ? `The scene cannot be shown: ${String(error)}` : "This browser or machine has no WebGL",
      drive: null,
      verdicts: [],
    });
  }
}

/** A drive that can be shown; null if nobody wanted to wait for it. */
async function loaded(over: (ended: Ended) => void): Promise<Drive | null> {
  const loading = showLoading(page);
  try {
    const { drive: token } = await ask<{ drive: string }>("/drive/start", order, loading.signal);
    loading.step(1);
    return await connect({ drive: token }, over, loading.signal);
  } catch (error) {
    if (!loading.signal.aborted) throw error;
    choose();
    return null;
  } finally {
    loading.close();
  }
}

function finished(ended: Ended): void {
  show("ending");
  const again = (): void => {
    drive().catch((error: Error) => finished({ why: "crashed", text: error.message, drive: null, verdicts: [] }));
  };
  showEnding(page, ended, again, choose);
}

function show(what: string): void {
  document.documentElement.dataset.shows = what;
  window.scrollTo(0, 0);
}
