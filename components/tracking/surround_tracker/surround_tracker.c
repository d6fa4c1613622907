#include "surround_tracker.h"

#include "../kalman_tracker/kalman_tracker_code.h"
#include "../kalman_tracker/filter_code.h"
