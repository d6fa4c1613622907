// The views, in the order of their tabs; the first that suits a study is shown first.
import { figuresView } from "./figures";
import { plotView } from "./plot";
import { runsView } from "./runs";
import { studyView } from "./study";
import type { View } from "./view";

export const VIEWS: readonly View[] = [plotView, runsView, figuresView, studyView];
