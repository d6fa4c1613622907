/* kalman_tracker for seven sensors: the number of scans is a constant of its code, as each adds two states to the filter. */
#ifndef SURROUND_TRACKER_H
#define SURROUND_TRACKER_H

#define TRACKER_SCANS 7

#include "../kalman_tracker/kalman_tracker.h"

#endif
