// A run in three dimensions: the page beside this one, the one that the server makes, or the command that makes one.
import { el } from "../dom";
import { copyText } from "../save";
import type { Study } from "../study";

/** Nothing for a run that cannot be seen. */
export function replaying(study: Study, run: number): HTMLElement[] {
  const { scenes } = study;
  if (!scenes || !study.done[run]) return [];
  const number = study.number[run]!;
  const link = (href: string): HTMLElement[] => [
    el(
      "p",
      { class: "replay" },
      el("a", { id: "replay", href, target: "_blank", rel: "noopener" }, `3-D replay of run ${number}`),
    ),
  ];
  if (document.getElementById("live")) return link(`replay/${number}`);
  if (scenes.made.has(number)) return link(`replays/run_${number}.html`);
  const command = el("code", { tabindex: 0 }, `dse report ${scenes.study} --replay ${number}`);
  const said = el("span", { class: "muted", role: "status" });
  const copy = el(
    "button",
    {
      id: "copy-replay",
      type: "button",
      click: () =>
        void copyText(command.textContent!, command).then(
          (done) => (said.textContent = done ? "copied" : "selected: press Ctrl+C"),
        ),
    },
    "Copy",
  );
  return [el("p", { class: "replay" }, el("span", { class: "muted" }, "3-D replay: "), command, copy, said)];
}
