// A panel that fills the window, until Escape.
let leave: (() => void) | null = null;

/** Has *panel* fill the window; what is behind it can be neither reached nor read out. *left* is called when it is back. */
export function enlarge(panel: HTMLElement, left: () => void): () => void {
  leave?.();
  const behind: HTMLElement[] = [];
  for (let node: HTMLElement = panel; node.parentElement && node !== document.body; node = node.parentElement) {
    for (const other of node.parentElement.children) {
      if (other === node || !(other instanceof HTMLElement) || other.inert || other.id === "announcement") continue;
      other.inert = true;
      behind.push(other);
    }
  }
  const leaveByKey = (event: KeyboardEvent): void => {
    if (event.key === "Escape" && !event.defaultPrevented) leave?.();
  };
  panel.classList.add("enlarged");
  document.addEventListener("keydown", leaveByKey);
  leave = () => {
    leave = null;
    panel.classList.remove("enlarged");
    document.removeEventListener("keydown", leaveByKey);
    for (const other of behind) other.inert = false;
    left();
  };
  return leave;
}
