// The views, in the order of their tabs; the first that suits a study is shown first.

import { plotted } from "../plane/plane";
import { conditionsView } from "./conditions/conditions";
import { designsView } from "./designs/designs";
import { figuresView } from "./figures";
import { overviewView } from "./overview/overview";
import { pairView } from "./pair/pair";
import { plotView } from "./plot";
import { runsView } from "./runs";
import { sheetView } from "./sheet/sheet";
import { simulateView } from "./simulate";
import { studyView } from "./study";
import { understandingView } from "./understanding/understanding";
import type { View } from "./view";

// A study with a plane opens at its plot: that picture says in a glance what the overview says in sentences.
const withoutPlane: View = { ...overviewView, suits: (study) => overviewView.suits(study) && !plotted(study) };
const withPlane: View = { ...overviewView, suits: (study) => overviewView.suits(study) && plotted(study) };

export const VIEWS: readonly View[] = [
  withoutPlane,
  plotView,
  simulateView,
  withPlane,
  designsView,
  pairView,
  sheetView,
  understandingView,
  conditionsView,
  runsView,
  figuresView,
  studyView,
];
