// A view: what a tab of the page shows. Its panels are made when it is first opened.
import type { Store } from "../store";
import type { Study } from "../study";

export interface View {
  /** In the fragment of the address. */
  readonly name: string;
  readonly title: string;
  /** Whether the study has anything for it. */
  suits(study: Study): boolean;
  create(store: Store): HTMLElement;
}
