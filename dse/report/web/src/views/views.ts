// The views, in the order of their tabs; the first that suits a study is shown first.
import { designsView } from "./designs/designs";
import { figuresView } from "./figures";
import { plotView } from "./plot";
import { runsView } from "./runs";
import { studyView } from "./study";
import type { View } from "./view";

export const VIEWS: readonly View[] = [plotView, designsView, runsView, figuresView, studyView];
